/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAME_PLAN_H
#define FRAME_PLAN_H

#include "nodes/protocol.h"
#include "nodes/shader_library.h"
#include "scenes/scene.h"

/* What the host makes of a frame before it sends it: shader instances (a shader variant with its
 * bound parameters), lights, and which instance each mesh uses. Instances equal in everything are
 * one. */
struct planned_parameter {
    const char *name;
    uint32_t bytes;
};

struct planned_instance {
    char name[64]; /* shader name, numbered when several instances share it */
    const struct shader_variant *variant;
    struct message *message; /* INSTANCE or LIGHT, frame number 0; owned */
    uint64_t bound_bytes;
};

struct frame_plan {
    struct planned_instance *instances; /* shader ID - 1 */
    size_t instance_count, instance_capacity;
    struct planned_instance *lights;
    size_t light_count;
    uint16_t *mesh_instance; /* shader ID of each mesh */
    size_t mesh_count;
};

bool frame_plan_make(const struct scene_frame *frame, struct shader_library *library,
                     struct frame_plan *plan, struct status *status);
void frame_plan_finish(struct frame_plan *plan);

#endif
