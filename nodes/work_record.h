/* SPDX-License-Identifier: Apache-2.0 */
#ifndef WORK_RECORD_H
#define WORK_RECORD_H

#include "base/simd_operations.h"
#include "base/status.h"
#include "netsim/wire.h"
#include "shaders/simd/shader_module.h"

#include <stdbool.h>
#include <stdint.h>

/* What was done for a frame, and for whom: only kept when it is asked for (--explain-work). */

/* Instance numbers have 16 bits, lights count from 65537 on: no number in a message is larger. */
enum { WORK_NUMBER_MAX = 0xffffff };

/* One shader instance, one light, or what all share (shading_work.instance). */
struct instance_work {
    uint32_t instance;
    uint32_t regions;                      /* in which it ran */
    uint64_t samples;                      /* shaded; 0 for lights and what is shared */
    uint64_t streams[SHADER_STREAM_COUNT]; /* instructions the array issued */
    uint64_t operations[SIMD_OPERATION_COUNT];
    char name[64]; /* known to the host, not sent */
    uint32_t module;
};

struct work_record {
    bool is_kept;
    uint64_t rays;            /* cast by all rendering nodes */
    uint64_t composed;        /* samples that passed through a composition, at every hop */
    uint32_t regions_touched; /* by a triangle's rectangle on any node */
    uint32_t count;
    struct instance_work *instances; /* owned; ascending by number when complete */
    size_t capacity;
    uint32_t *places; /* owned; of the entry of each number, from 1; 0: none. NULL: to be made */
    size_t place_count;
};

/* The entry of that number, made when it is missing. */
struct instance_work *work_record_entry(struct work_record *record, uint32_t instance);
void work_record_put(const struct work_record *record, struct wire_writer *writer);
/* Damage shows in the reader. */
void work_record_get(struct work_record *record, struct wire_reader *reader);
/* Sorts the entries by number: instances, what is shared, lights. */
void work_record_sort(struct work_record *record);
void work_record_finish(struct work_record *record);

#endif
