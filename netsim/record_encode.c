/* SPDX-License-Identifier: Apache-2.0 */
#include "base/hash.h"
#include "netsim/record.h"
#include "netsim/record_file.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static void put_number(struct wire_writer *writer, uint64_t value) {
    uint8_t bytes[10];
    size_t count = 0;
    for (; value >= 0x80; value >>= 7)
        bytes[count++] = (uint8_t)(value | 0x80);
    bytes[count++] = (uint8_t)value;
    wire_put(writer, bytes, count);
}

static void put_signed(struct wire_writer *writer, int64_t value) {
    put_number(writer, (uint64_t)value << 1 ^ (uint64_t)(value < 0 ? -1 : 0));
}

static void put_string(struct wire_writer *writer, const char *text) {
    const size_t length = strlen(text);
    put_number(writer, length);
    wire_put(writer, text, length + 1);
}

static void put_shaders(struct wire_writer *writer, const struct record_frame *frame) {
    put_number(writer, frame->instance_count);
    for (uint32_t i = 0; i < frame->instance_count; i++) {
        const struct record_instance *instance = &frame->instances[i];
        put_string(writer, instance->name);
        put_string(writer, instance->shader);
        put_number(writer, instance->bound_bytes);
        put_number(writer, instance->parameter_count);
        for (uint32_t p = 0; p < instance->parameter_count; p++) {
            put_string(writer, instance->parameters[p].name);
            put_number(writer, instance->parameters[p].floats);
            put_number(writer, instance->parameters[p].bytes);
            put_number(writer, instance->parameters[p].use);
            put_number(writer, instance->parameters[p].is_geometric);
        }
    }
    put_number(writer, frame->light_count);
    for (uint32_t l = 0; l < frame->light_count; l++)
        put_string(writer, frame->lights[l]);
}

static void put_chunks(struct wire_writer *writer, const struct record_frame *frame) {
    put_number(writer, frame->chunk_count);
    for (uint32_t c = 0; c < frame->chunk_count; c++) {
        const struct record_chunk *chunk = &frame->chunks[c];
        put_number(writer, chunk->instance);
        put_number(writer, chunk->vertices);
        put_number(writer, (uint64_t)chunk->triangles << 1 | chunk->begins_run);
        put_number(writer, chunk->sharing_count);
        for (uint32_t s = 0; s < chunk->sharing_count; s++) {
            put_number(writer, frame->sharing[chunk->first_sharing + s].distance);
            put_number(writer, frame->sharing[chunk->first_sharing + s].vertices);
        }
    }
}

static void put_regions(struct wire_writer *writer, const struct record_frame *frame) {
    for (uint32_t k = 0; k < frame->region_count; k++) {
        const struct record_region *region = &frame->regions[k];
        put_number(writer, region->samples);
        put_number(writer, region->map_bytes);
        put_number(writer, region->entry_count);
        uint32_t before = 0;
        for (uint32_t e = 0; e < region->entry_count; e++) {
            const struct record_entry *entry = &frame->entries[region->first_entry + e];
            put_number(writer, entry->chunk - before);
            put_number(writer, (uint64_t)entry->triangles << 1 | entry->covers);
            before = entry->chunk;
        }
        put_number(writer, region->work_count);
        for (uint32_t w = 0; w < region->work_count; w++) {
            const struct record_work *work = &frame->works[region->first_work + w];
            put_number(writer, work->shader);
            put_number(writer, work->operation_count);
            for (uint32_t o = 0; o < work->operation_count; o++) {
                put_number(writer, frame->operations[work->first_operation + o].operation);
                put_number(writer, frame->operations[work->first_operation + o].count);
            }
        }
    }
}

static void put_machine(struct wire_writer *writer, const struct machine *machine) {
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(machine, values);
    put_string(writer, machine->name);
    put_number(writer, MACHINE_VALUE_COUNT);
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        put_string(writer, machine_parameter_at(i).name);
        put_signed(writer, values[i]);
    }
    put_number(writer, SIMD_OPERATION_COUNT);
    for (int i = 0; i < SIMD_OPERATION_COUNT; i++)
        put_string(writer, machine_parameter_at(MACHINE_PARAMETER_COUNT + i).name);
}

/* The section, or a mark when it is the same as in the frame before, which `last` holds. */
static void put_section(struct wire_writer *writer, struct wire_writer *last,
                        const struct record_frame *frame,
                        void (*put)(struct wire_writer *, const struct record_frame *)) {
    struct wire_writer section = {0};
    put(&section, frame);
    const bool is_same = last->bytes && last->length == section.length &&
                         !memcmp(last->bytes, section.bytes, section.length);
    put_number(writer, !is_same);
    if (!is_same)
        wire_put(writer, section.bytes, section.length);
    free(last->bytes);
    *last = section;
}

static void put_frames(struct wire_writer *writer, const struct run_record *record) {
    static void (*const put[RECORD_SECTION_COUNT])(struct wire_writer *,
                                                   const struct record_frame *) = {
        [RECORD_SECTION_SHADERS] = put_shaders,
        [RECORD_SECTION_CHUNKS] = put_chunks,
        [RECORD_SECTION_REGIONS] = put_regions,
    };
    struct wire_writer last[RECORD_SECTION_COUNT] = {0};
    put_number(writer, record->frame_count);
    for (uint32_t f = 0; f < record->frame_count; f++) {
        const struct record_frame *frame = &record->frames[f];
        put_signed(writer, frame->number);
        put_number(writer, frame->width);
        put_number(writer, frame->height);
        put_number(writer, frame->samples_x);
        put_number(writer, frame->samples_y);
        for (int cause = 0; cause < CAUSE_COUNT; cause++)
            put_number(writer, frame->geometry_bytes[cause]);
        for (int section = 0; section < RECORD_SECTION_COUNT; section++)
            put_section(writer, &last[section], frame, put[section]);
    }
    for (int section = 0; section < RECORD_SECTION_COUNT; section++)
        free(last[section].bytes);
}

static void fill_head(uint8_t *bytes, uint64_t length, size_t packed) {
    const uint32_t magic = RECORD_MAGIC, version = RECORD_VERSION;
    const uint64_t checksum = hash_bytes(bytes + RECORD_HEAD_BYTES, packed, RECORD_VERSION);
    memcpy(bytes + RECORD_AT_MAGIC, &magic, 4);
    memcpy(bytes + RECORD_AT_VERSION, &version, 4);
    memcpy(bytes + RECORD_AT_LENGTH, &length, 8);
    memcpy(bytes + RECORD_AT_CHECKSUM, &checksum, 8);
    const uint64_t head = hash_bytes(bytes, RECORD_AT_HEAD_CHECKSUM, RECORD_VERSION);
    memcpy(bytes + RECORD_AT_HEAD_CHECKSUM, &head, 8);
}

bool record_encode(const struct run_record *record, uint8_t **bytes, size_t *length,
                   struct status *status) {
    struct wire_writer payload = {0};
    put_string(&payload, record->scene);
    put_number(&payload, record->seed);
    put_number(&payload, record->chunk_triangles);
    put_number(&payload, record->fast_math);
    put_machine(&payload, &record->machine);
    put_frames(&payload, record);
    uLongf compressed = compressBound(payload.length);
    *bytes = NULL;
    bool ok = payload.length <= RECORD_LENGTH_MAX;
    if (!ok)
        status_fail(status, STATUS_LIMIT,
                    "the record of %u frames takes %zu bytes, more than %d: record fewer frames",
                    record->frame_count, payload.length, RECORD_LENGTH_MAX);
    ok = ok && (*bytes = memory_try(RECORD_HEAD_BYTES + compressed, 1, status)) != NULL;
    if (ok && compress2(*bytes + RECORD_HEAD_BYTES, &compressed, payload.bytes, payload.length,
                        Z_BEST_SPEED) != Z_OK)
        ok = status_fail(status, STATUS_LIMIT, "no memory to compress the record");
    if (ok) {
        fill_head(*bytes, payload.length, compressed);
        *length = RECORD_HEAD_BYTES + compressed;
    } else {
        free(*bytes);
        *bytes = NULL;
    }
    free(payload.bytes);
    return ok;
}
