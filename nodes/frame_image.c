/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/frame_image.h"

#include <math.h>

bool frame_image_create(const struct frame_payload *frame, const struct region_grid *grid,
                        struct frame_image *image, struct status *status) {
    *image = (struct frame_image){.frame = *frame, .grid = *grid};
    if (!image_create((int)frame->width, (int)frame->height, &image->image, status))
        return false;
    static const char *const names[] = {"R", "G", "B", "A", "Z"};
    float **const planes[] = {&image->red, &image->green, &image->blue, &image->alpha, &image->depth};
    for (int i = 0; i < 5; i++) {
        struct image_channel *channel = image_add_channel(image->image, names[i], IMAGE_FLOAT);
        if (!channel)
            return status_fail(status, STATUS_LIMIT, "no memory for a picture of %u x %u pixels",
                               frame->width, frame->height);
        *planes[i] = channel->values;
    }
    struct image_channel *channel = image_add_channel(image->image, "shaderID", IMAGE_UINT);
    if (!channel)
        return status_fail(status, STATUS_LIMIT, "no memory for a picture of %u x %u pixels",
                           frame->width, frame->height);
    image->shader = channel->integers;
    return true;
}

void frame_image_add(struct frame_image *image, uint32_t region, const struct colour_view *colours) {
    const struct region_grid *grid = &image->grid;
    const uint32_t sx = image->frame.samples_x, sy = image->frame.samples_y;
    const float weight = 1.0f / (float)(sx * sy);
    uint32_t x0, y0, at = 0;
    region_grid_origin(grid, region, &x0, &y0);
    for (uint32_t r = 0; r < colours->head.run_count; r++)
        for (uint32_t k = 0; k < colours->runs[r].count; k++, at++) {
            const uint32_t sample = colours->runs[r].first + k;
            const uint32_t x = x0 + sample % grid->region_width, y = y0 + sample / grid->region_width;
            if (x >= grid->samples_wide || y >= grid->samples_high)
                continue;
            const size_t pixel = (size_t)(y / sy) * image->frame.width + x / sx;
            const float red = colours->color[0][at], green = colours->color[1][at],
                        blue = colours->color[2][at];
            image->nan_colours += !(isfinite(red) && isfinite(green) && isfinite(blue));
            image->red[pixel] += red * weight;
            image->green[pixel] += green * weight;
            image->blue[pixel] += blue * weight;
            if (image->alpha[pixel] == 0 || colours->depth[at] < image->depth[pixel]) {
                image->depth[pixel] = colours->depth[at];
                image->shader[pixel] = colours->shader[at];
            }
            image->alpha[pixel] += weight;
        }
}

struct image *frame_image_take(struct frame_image *image) {
    struct image *taken = image->image;
    image->image = NULL;
    return taken;
}

void frame_image_finish(struct frame_image *image) {
    image_destroy(image->image);
    *image = (struct frame_image){0};
}
