/* SPDX-License-Identifier: Apache-2.0 */
#ifndef EXECUTION_COUNTS_H
#define EXECUTION_COUNTS_H

#include "base/simd_operations.h"
#include "shaders/simd/shader_module.h"

#include <stddef.h>
#include <stdint.h>

/* How often the SIMD array would issue each block of one shader over one region, put together from
 * what the vectors of samples report: a loop runs as long as any sample needs it (PF
 * section 6.1.4). */
struct execution_counts {
    struct shader_counters counters; /* first: what generated code sees */
    const struct shader_module *module;
    struct trip_entry {
        uint64_t key, trips;
        uint32_t block, generation;
    } * entries; /* open addressing; entries of older generations are free */
    size_t capacity, used;
    uint32_t generation;
};

void execution_counts_init(struct execution_counts *counts, const struct shader_module *module);
void execution_counts_finish(struct execution_counts *counts);
/* Begins a new region. */
void execution_counts_reset(struct execution_counts *counts);
/* Operations of the shared stream since the last reset: several shaders run it together. */
void execution_counts_shared_operations(const struct execution_counts *counts,
                                        uint64_t operations[SIMD_OPERATION_COUNT]);
/* Adds the operations issued since the last reset, by operation and by stream; the shared stream is
 * left out. */
void execution_counts_add_operations(const struct execution_counts *counts,
                                     uint64_t operations[SIMD_OPERATION_COUNT],
                                     uint64_t streams[SHADER_STREAM_COUNT]);

#endif
