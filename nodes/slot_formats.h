/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SLOT_FORMATS_H
#define SLOT_FORMATS_H

#include "nodes/frame_plan.h"

/* How the components of transfer maps travel: as floats, or rounded after interpolation
 * (`sortlast render --parameters`). Fixed-point formats are chosen once a frame for each component
 * of each instance: with as many bits after the point as leave room for the largest value of its
 * vertices. Values between vertices lie between theirs, so none is clamped by more than a
 * step: coordinates and normals end at 1, and a bit for that alone would cost all others one. */
struct slot_formats {
    struct slot_format **instances; /* by shader ID - 1: one for each component of its map */
    size_t instance_count;
};

void slot_formats_choose(const struct scene_frame *frame, const struct frame_plan *plan,
                         enum parameter_precision precision, struct slot_formats *formats);
void slot_formats_finish(struct slot_formats *formats);

/* The format of so many bits that holds values from `lowest` to `highest` (finite), the ends to
 * within a step: unsigned where none is negative. */
struct slot_format slot_format_for(int bits, float lowest, float highest);

/* Rounds to nearest, ties to even; beyond the format to its nearest end; not a number becomes 0 in
 * fixed-point and stays in halves, where infinities stay too. */
void slot_format_round(struct slot_format format, float *values, uint32_t count);

#endif
