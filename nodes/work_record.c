/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/work_record.h"

#include <stdlib.h>
#include <string.h>

static void note_place(struct work_record *record, uint32_t number, uint32_t place) {
    if (number >= record->place_count) {
        const size_t count = ((size_t)number + 1) * 2;
        uint32_t *places = memory_get(count, sizeof *places);
        if (record->place_count)
            memcpy(places, record->places, record->place_count * sizeof *places);
        free(record->places);
        record->places = places;
        record->place_count = count;
    }
    record->places[number] = place + 1;
}

static void forget_places(struct work_record *record) {
    free(record->places);
    record->places = NULL;
    record->place_count = 0;
}

struct instance_work *work_record_entry(struct work_record *record, uint32_t instance) {
    if (!record->places)
        for (uint32_t i = 0; i < record->count; i++)
            note_place(record, record->instances[i].instance, i);
    if (instance < record->place_count && record->places[instance])
        return &record->instances[record->places[instance] - 1];
    record->instances = memory_grow(record->instances, &record->capacity, (size_t)record->count + 1,
                                    sizeof *record->instances);
    note_place(record, instance, record->count);
    struct instance_work *entry = &record->instances[record->count++];
    *entry = (struct instance_work){.instance = instance};
    return entry;
}

void work_record_put(const struct work_record *record, struct wire_writer *writer) {
    wire_put_u32(writer, record->is_kept);
    wire_put_u64(writer, record->rays);
    wire_put_u64(writer, record->composed);
    wire_put_u32(writer, record->regions_touched);
    wire_put_u32(writer, record->count);
    for (uint32_t i = 0; i < record->count; i++) {
        const struct instance_work *entry = &record->instances[i];
        wire_put_u32(writer, entry->instance);
        wire_put_u32(writer, entry->regions);
        wire_put_u64(writer, entry->samples);
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            wire_put_u64(writer, entry->streams[s]);
        for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
            wire_put_u64(writer, entry->operations[o]);
    }
}

void work_record_get(struct work_record *record, struct wire_reader *reader) {
    *record = (struct work_record){.is_kept = wire_get_u32(reader) != 0};
    record->rays = wire_get_u64(reader);
    record->composed = wire_get_u64(reader);
    record->regions_touched = wire_get_u32(reader);
    const uint32_t count = wire_get_u32(reader);
    if (reader->failed || count > reader->length / (8 * SIMD_OPERATION_COUNT)) {
        reader->failed = true;
        return;
    }
    record->instances = memory_get(count, sizeof *record->instances);
    record->count = count;
    record->capacity = count;
    for (uint32_t i = 0; i < count; i++) {
        struct instance_work *entry = &record->instances[i];
        entry->instance = wire_get_u32(reader) & WORK_NUMBER_MAX;
        entry->regions = wire_get_u32(reader);
        entry->samples = wire_get_u64(reader);
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            entry->streams[s] = wire_get_u64(reader);
        for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
            entry->operations[o] = wire_get_u64(reader);
    }
}

static int compare_entries(const void *a, const void *b) {
    const struct instance_work *first = a, *second = b;
    return (first->instance > second->instance) - (first->instance < second->instance);
}

void work_record_sort(struct work_record *record) {
    forget_places(record);
    if (record->count)
        qsort(record->instances, record->count, sizeof *record->instances, compare_entries);
}

void work_record_finish(struct work_record *record) {
    free(record->instances);
    free(record->places);
    *record = (struct work_record){0};
}
