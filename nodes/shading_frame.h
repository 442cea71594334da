/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADING_FRAME_H
#define SHADING_FRAME_H

#include "nodes/execution_counts.h"
#include "nodes/protocol.h"
#include "nodes/region_exchange.h"
#include "shaders/loader/shader_texts.h"

/* The shader instances and lights of one frame on a shading node, made ready when a region first
 * needs them (contract C4), and kept from frame to frame while their bound parameters stay the same
 * (PF section 6.1.6). */

/* All shaders the host announced, loaded on first use. */
struct shader_table {
    const struct node_services *services;
    struct announced_shader {
        struct message *message;
        struct shader_payload payload;
        const struct shader_module *module;
    } * shaders;
    size_t count, capacity;
};

bool shader_table_announce(struct shader_table *table, struct message *message,
                           struct status *status);
void shader_table_finish(struct shader_table *table);

/* An instance or light with its uniform code run. */
struct prepared_shader {
    struct message *message; /* what `payload` points into */
    struct instance_payload payload;
    const struct shader_module *module; /* NULL until prepared */
    struct shader_matrices *matrices;
    float *uniform;
    struct text_table *texts; /* NULL unless the module makes strings */
    struct execution_counts counts;
    struct shader_light *lights; /* of an instance: those that shine on it, filled when prepared */
    int light_count;
    int light_vectors;  /* of the results of one light */
    int *query_offsets; /* of all lights: light_count * module->query_count */
    bool is_counted;    /* in the region at hand */
};

struct shading_frame {
    bool is_begun, is_complete;
    uint32_t index;
    struct frame_payload frame;
    struct message *frame_message;
    struct region_grid grid;
    struct prepared_shader *instances; /* by shader ID - 1 */
    size_t instance_count, instance_capacity;
    struct prepared_shader *lights;
    size_t light_count, light_capacity;
};

bool shading_frame_add(struct shading_frame *frame, struct message *message, enum wire_kind kind,
                       struct status *status);
/* The instance with this shader ID, ready to shade; fails when there is none or its shader does not
 * load. */
bool shading_frame_instance(struct shading_frame *frame, struct shader_table *table,
                            uint32_t shader_id, struct prepared_shader **instance,
                            struct status *status);
/* Adds to `sums`, of which map_bytes is known, what the samples say that came here of a region with
 * so many composed; loads shaders of hidden ones at most. */
bool shading_frame_sum_arrivals(const struct shading_frame *frame, struct shader_table *table,
                                const struct region_arrivals *arrivals, uint32_t composed,
                                struct region_sums *sums, struct status *status);
/* Moves what is the same in both frames from `old` to `fresh`; returns how many prepared shaders
 * were kept. */
size_t shading_frame_inherit(struct shading_frame *fresh, struct shading_frame *old);
void shading_frame_finish(struct shading_frame *frame);

#endif
