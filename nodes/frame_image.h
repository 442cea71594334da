/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAME_IMAGE_H
#define FRAME_IMAGE_H

#include "images/image.h"
#include "nodes/protocol.h"

/* The picture of a frame as its regions arrive: channels R G B A (share of samples covered), Z
 * (camera-space depth of the nearest sample, 0 where there is none) and shaderID (of that sample).
 *
 * Samples of a pixel are blended with equal weights. Regions must be added in ascending order, so
 * that sums are the same bits however they arrived (contract C1). */
struct frame_image {
    struct image *image;
    struct frame_payload frame;
    struct region_grid grid;
    float *red, *green, *blue, *alpha, *depth;
    uint32_t *shader;
    bool *is_row_covered; /* by pixel row; only where samples are blended */
    uint64_t nan_colours; /* components of samples that are not finite */
};

/* Without a file to write to (frame->image_path) there is no picture: colours are only checked. */
bool frame_image_create(const struct frame_payload *frame, const struct region_grid *grid,
                        struct frame_image *image, struct status *status);
void frame_image_add(struct frame_image *image, uint32_t region, const struct colour_view *colours);
/* Hands the finished picture over, which must have been wanted. */
struct image *frame_image_take(struct frame_image *image);
void frame_image_finish(struct frame_image *image);

#endif
