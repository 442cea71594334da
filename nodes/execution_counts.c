/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/execution_counts.h"

#include "base/status.h"

#include <stdlib.h>
#include <string.h>

static size_t slot_of(const struct execution_counts *counts, uint32_t block, uint64_t key) {
    uint64_t hash = (key ^ block) * 0x9e3779b97f4a7c15u;
    return (size_t)(hash >> 20) & (counts->capacity - 1);
}

static struct trip_entry *find_entry(struct execution_counts *counts, uint32_t block,
                                     uint64_t key) {
    size_t at = slot_of(counts, block, key);
    for (;; at = (at + 1) & (counts->capacity - 1)) {
        struct trip_entry *entry = &counts->entries[at];
        if (entry->generation != counts->generation || (entry->block == block && entry->key == key))
            return entry;
    }
}

static void grow(struct execution_counts *counts) {
    struct trip_entry *old = counts->entries;
    const size_t old_capacity = counts->capacity;
    counts->capacity = old_capacity ? old_capacity * 2 : 64;
    counts->entries = memory_get(counts->capacity, sizeof *counts->entries);
    for (size_t i = 0; i < old_capacity; i++)
        if (old[i].generation == counts->generation)
            *find_entry(counts, old[i].block, old[i].key) = old[i];
    free(old);
}

static void report_trips(struct shader_counters *counters, uint32_t block, uint64_t key,
                         uint64_t trips) {
    struct execution_counts *counts = (struct execution_counts *)counters;
    if (counts->used * 2 >= counts->capacity)
        grow(counts);
    struct trip_entry *entry = find_entry(counts, block, key);
    if (entry->generation != counts->generation) {
        *entry = (struct trip_entry){key, 0, block, counts->generation};
        counts->used++;
    }
    if (trips > entry->trips) {
        counters->block_executions[block] += trips - entry->trips;
        entry->trips = trips;
    }
}

void execution_counts_init(struct execution_counts *counts, const struct shader_module *module) {
    *counts = (struct execution_counts){.module = module, .generation = 1};
    counts->counters.block_executions = memory_get((size_t)module->block_count, sizeof(uint64_t));
    counts->counters.report_trips = report_trips;
    execution_counts_reset(counts);
}

void execution_counts_finish(struct execution_counts *counts) {
    free(counts->counters.block_executions);
    free(counts->entries);
    *counts = (struct execution_counts){0};
}

void execution_counts_reset(struct execution_counts *counts) {
    memset(counts->counters.block_executions, 0,
           (size_t)counts->module->block_count * sizeof(uint64_t));
    counts->counters.block_executions[0] = 1;
    counts->used = 0;
    counts->generation++;
}

static void add_stream(const struct execution_counts *counts, int stream,
                       uint64_t operations[SIMD_OPERATION_COUNT], uint64_t *total) {
    for (int b = 0; b < counts->module->block_count; b++) {
        const struct shader_block *block = &counts->module->blocks[b];
        const uint64_t executions = counts->counters.block_executions[b];
        for (int operation = 0; operation < SIMD_OPERATION_COUNT && executions; operation++) {
            const uint64_t issued = executions * block->operations[stream][operation];
            operations[operation] += issued;
            *total += issued;
        }
    }
}

void execution_counts_add_operations(const struct execution_counts *counts,
                                     uint64_t operations[SIMD_OPERATION_COUNT],
                                     uint64_t streams[SHADER_STREAM_COUNT]) {
    for (int stream = 0; stream < SHADER_STREAM_COUNT; stream++)
        if (stream != SHADER_SHARED)
            add_stream(counts, stream, operations, &streams[stream]);
}

void execution_counts_shared_operations(const struct execution_counts *counts,
                                        uint64_t operations[SIMD_OPERATION_COUNT]) {
    uint64_t total = 0;
    for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++)
        operations[operation] = 0;
    add_stream(counts, SHADER_SHARED, operations, &total);
}
