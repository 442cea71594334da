/* SPDX-License-Identifier: Apache-2.0 */
#ifndef WORK_NAMES_H
#define WORK_NAMES_H

#include "nodes/frame_plan.h"
#include "nodes/work_record.h"

/* What the numbers of a frame's work_record stand for: the host knows, the framebuffer node does
 * not. */
struct work_names {
    struct instance_work *entries; /* without work; owned */
    uint32_t count;
};

/* The instances and lights of a frame; what was there before goes. */
void work_names_take(struct work_names *names, const struct frame_plan *plan);
/* Those of the frame before, for one that is sent again. */
void work_names_copy(struct work_names *names, const struct work_names *before);
/* Names the entries of a record and adds one without work for each instance or light that did
 * nothing. Does nothing with a record that was not kept. */
void work_names_apply(const struct work_names *names, struct work_record *record);
void work_names_finish(struct work_names *names);

#endif
