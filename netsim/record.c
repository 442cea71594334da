/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/record.h"

#include <stdlib.h>
#include <string.h>

uint32_t record_instance_floats(const struct record_instance *instance, enum record_use use) {
    uint32_t floats = 0;
    for (uint32_t p = 0; p < instance->parameter_count; p++)
        floats += instance->parameters[p].use == use ? instance->parameters[p].floats : 0;
    return floats;
}

void record_frame_finish(struct record_frame *frame) {
    for (uint32_t i = 0; i < frame->instance_count; i++) {
        struct record_instance *instance = &frame->instances[i];
        for (uint32_t p = 0; p < instance->parameter_count; p++)
            free(instance->parameters[p].name);
        free(instance->parameters);
        free(instance->name);
        free(instance->shader);
    }
    for (uint32_t l = 0; l < frame->light_count; l++)
        free(frame->lights[l]);
    free(frame->instances);
    free(frame->lights);
    free(frame->chunks);
    free(frame->sharing);
    free(frame->regions);
    free(frame->entries);
    free(frame->works);
    free(frame->operations);
    *frame = (struct record_frame){0};
}

void record_destroy(struct run_record *record) {
    if (!record)
        return;
    for (uint32_t f = 0; f < record->frame_count; f++)
        record_frame_finish(&record->frames[f]);
    free(record->frames);
    free(record->scene);
    free(record);
}

struct record_frame *record_add_frame(struct run_record *record) {
    record->frames = memory_grow(record->frames, &record->frame_capacity, record->frame_count + 1,
                                 sizeof *record->frames);
    record->frames[record->frame_count] = (struct record_frame){0};
    return &record->frames[record->frame_count++];
}

void record_add_chunk(struct record_frame *frame, struct record_chunk chunk,
                      const struct record_sharing *sharing, uint32_t sharing_count) {
    frame->chunks = memory_grow(frame->chunks, &frame->chunk_capacity, frame->chunk_count + 1,
                                sizeof *frame->chunks);
    frame->sharing = memory_grow(frame->sharing, &frame->sharing_capacity,
                                 frame->sharing_count + sharing_count, sizeof *frame->sharing);
    chunk.first_sharing = frame->sharing_count;
    chunk.sharing_count = sharing_count;
    for (uint32_t i = 0; i < sharing_count; i++)
        frame->sharing[frame->sharing_count++] = sharing[i];
    frame->chunks[frame->chunk_count++] = chunk;
}

void record_add_entry(struct record_frame *frame, struct record_region *region,
                      struct record_entry entry) {
    frame->entries = memory_grow(frame->entries, &frame->entry_capacity, frame->entry_count + 1,
                                 sizeof *frame->entries);
    if (!region->entry_count++)
        region->first_entry = frame->entry_count;
    frame->entries[frame->entry_count++] = entry;
}

void record_add_work(struct record_frame *frame, struct record_region *region, uint32_t shader,
                     const uint64_t operations[SIMD_OPERATION_COUNT]) {
    struct record_work work = {.shader = shader, .first_operation = frame->operation_count};
    for (uint32_t operation = 0; operation < SIMD_OPERATION_COUNT; operation++) {
        if (!operations[operation])
            continue;
        frame->operations = memory_grow(frame->operations, &frame->operation_capacity,
                                        frame->operation_count + 1, sizeof *frame->operations);
        frame->operations[frame->operation_count++] =
            (struct record_operation){operation, operations[operation]};
    }
    work.operation_count = frame->operation_count - work.first_operation;
    frame->works = memory_grow(frame->works, &frame->work_capacity, frame->work_count + 1,
                               sizeof *frame->works);
    if (!region->work_count++)
        region->first_work = frame->work_count;
    frame->works[frame->work_count++] = work;
}

static struct record_instance copy_instance(const struct record_instance *instance) {
    struct record_instance copy = *instance;
    copy.name = memory_copy_string(instance->name);
    copy.shader = memory_copy_string(instance->shader);
    copy.parameters = memory_get(instance->parameter_count, sizeof *copy.parameters);
    for (uint32_t p = 0; p < instance->parameter_count; p++) {
        copy.parameters[p] = instance->parameters[p];
        copy.parameters[p].name = memory_copy_string(instance->parameters[p].name);
    }
    return copy;
}

static void *copy_array(const void *items, size_t count, size_t size) {
    void *copy = memory_get(count, size);
    if (count)
        memcpy(copy, items, count * size);
    return copy;
}

void record_copy_shaders(struct record_frame *frame, const struct record_frame *from) {
    frame->instance_count = from->instance_count;
    frame->instances = memory_get(from->instance_count, sizeof *frame->instances);
    for (uint32_t i = 0; i < from->instance_count; i++)
        frame->instances[i] = copy_instance(&from->instances[i]);
    frame->light_count = from->light_count;
    frame->lights = memory_get(from->light_count, sizeof *frame->lights);
    for (uint32_t l = 0; l < from->light_count; l++)
        frame->lights[l] = memory_copy_string(from->lights[l]);
}

void record_copy_chunks(struct record_frame *frame, const struct record_frame *from) {
    frame->chunk_count = from->chunk_count;
    frame->sharing_count = from->sharing_count;
    frame->chunks = copy_array(from->chunks, from->chunk_count, sizeof *from->chunks);
    frame->sharing = copy_array(from->sharing, from->sharing_count, sizeof *from->sharing);
}

void record_copy_regions(struct record_frame *frame, const struct record_frame *from) {
    frame->region_count = from->region_count;
    frame->entry_count = from->entry_count;
    frame->work_count = from->work_count;
    frame->operation_count = from->operation_count;
    frame->regions = copy_array(from->regions, from->region_count, sizeof *from->regions);
    frame->entries = copy_array(from->entries, from->entry_count, sizeof *from->entries);
    frame->works = copy_array(from->works, from->work_count, sizeof *from->works);
    frame->operations =
        copy_array(from->operations, from->operation_count, sizeof *from->operations);
}

uint64_t record_primitive_bytes(const struct record_frame *frame, const uint32_t *map_floats,
                                const uint32_t *vertices) {
    uint64_t bytes = 0;
    for (uint32_t c = 0; c < frame->chunk_count; c++) {
        const struct record_chunk *chunk = &frame->chunks[c];
        const uint64_t count = vertices ? vertices[c] : chunk->vertices;
        bytes += count * (12 + 4 * (uint64_t)map_floats[chunk->instance - 1]) +
                 6 * (uint64_t)chunk->triangles;
    }
    return bytes;
}
