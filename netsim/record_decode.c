/* SPDX-License-Identifier: Apache-2.0 */
#include "base/hash.h"
#include "netsim/record.h"
#include "netsim/record_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { RECORD_SIDE_MAX = 65536, RECORD_SAMPLES_MAX = 64, RECORD_FLOATS_MAX = 1 << 20 };

/* Memory a record may take when read: a small file could ask for any amount by repetition. */
#define RECORD_MEMORY_MAX ((uint64_t)1 << 30)

/* Reads the payload; past its end everything is 0 and `failed` is set. */
struct decoder {
    struct wire_reader reader;
    uint64_t memory;                               /* taken so far */
    uint32_t operations[SIMD_OPERATION_COUNT * 4]; /* number in the file -> ours */
    uint32_t operation_count;
};

static uint64_t get_number(struct decoder *decoder) {
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
        const uint8_t *byte = wire_get(&decoder->reader, 1);
        if (!byte)
            return 0;
        value |= (uint64_t)(*byte & 0x7f) << shift;
        if (*byte < 0x80)
            return value;
    }
    decoder->reader.failed = true;
    return 0;
}

/* A number from `minimum` to `maximum`; another is damage, and gives `minimum`. */
static uint64_t get_between(struct decoder *decoder, uint64_t minimum, uint64_t maximum) {
    const uint64_t value = get_number(decoder);
    if (value >= minimum && value <= maximum)
        return value;
    decoder->reader.failed = true;
    return minimum;
}

/* The count of things of which each takes at least a byte: never more than are left to read. */
static uint32_t get_count(struct decoder *decoder) {
    const size_t left = decoder->reader.length - decoder->reader.at;
    return (uint32_t)get_between(decoder, 0, left < UINT32_MAX ? left : UINT32_MAX - 1);
}

/* Takes note of `count` items of memory; false when the record asks for too much. */
static bool can_take(struct decoder *decoder, uint64_t count, size_t size) {
    decoder->memory += count * size;
    if (decoder->memory > RECORD_MEMORY_MAX)
        decoder->reader.failed = true;
    return !decoder->reader.failed;
}

/* Zeroed memory for *count items; none and a count of 0 after damage. */
static void *get_memory(struct decoder *decoder, uint32_t *count, size_t size) {
    if (!can_take(decoder, *count, size))
        *count = 0;
    return memory_get(*count, size);
}

static int64_t get_signed(struct decoder *decoder) {
    const uint64_t value = get_number(decoder);
    return (int64_t)(value >> 1 ^ (value & 1 ? UINT64_MAX : 0));
}

/* Never NULL; the caller's. */
static char *get_string(struct decoder *decoder) {
    const uint64_t length = get_count(decoder);
    const char *text = wire_get(&decoder->reader, length + 1);
    if (!text || text[length] || strlen(text) != length) {
        decoder->reader.failed = true;
        text = "";
    }
    return memory_copy_string(text);
}

static void get_shaders(struct decoder *decoder, struct record_frame *frame) {
    frame->instance_count = get_count(decoder);
    frame->instances = get_memory(decoder, &frame->instance_count, sizeof *frame->instances);
    for (uint32_t i = 0; i < frame->instance_count; i++) {
        struct record_instance *instance = &frame->instances[i];
        instance->name = get_string(decoder);
        instance->shader = get_string(decoder);
        instance->bound_bytes = get_number(decoder);
        instance->parameter_count = get_count(decoder);
        instance->parameters =
            get_memory(decoder, &instance->parameter_count, sizeof *instance->parameters);
        uint64_t floats = 0;
        for (uint32_t p = 0; p < instance->parameter_count; p++) {
            instance->parameters[p].name = get_string(decoder);
            instance->parameters[p].floats =
                (uint32_t)get_between(decoder, 0, RECORD_FLOATS_MAX - floats);
            instance->parameters[p].bytes =
                (uint32_t)get_between(decoder, instance->parameters[p].floats,
                                      8 * (uint64_t)instance->parameters[p].floats);
            instance->parameters[p].use =
                (enum record_use)get_between(decoder, 0, RECORD_USE_COUNT - 1);
            instance->parameters[p].is_geometric = get_between(decoder, 0, 1);
            floats += instance->parameters[p].floats;
        }
    }
    frame->light_count = get_count(decoder);
    frame->lights = get_memory(decoder, &frame->light_count, sizeof *frame->lights);
    for (uint32_t l = 0; l < frame->light_count; l++)
        frame->lights[l] = get_string(decoder);
}

/* One chunk, the `before`-th after the one that began its run. */
static void get_chunk(struct decoder *decoder, struct record_frame *frame, uint32_t before) {
    struct record_chunk chunk = {.instance =
                                     (uint32_t)get_between(decoder, 1, frame->instance_count)};
    chunk.vertices = (uint32_t)get_between(decoder, 0, UINT32_MAX);
    const uint64_t triangles = get_between(decoder, 0, 2 * (uint64_t)UINT32_MAX + 1);
    chunk.triangles = (uint32_t)(triangles >> 1);
    chunk.begins_run = triangles & 1;
    if (!chunk.begins_run &&
        (!frame->chunk_count || frame->chunks[frame->chunk_count - 1].instance != chunk.instance))
        decoder->reader.failed = true;
    uint32_t count = get_count(decoder);
    struct record_sharing *sharing = get_memory(decoder, &count, sizeof *sharing);
    uint64_t left = chunk.vertices;
    for (uint32_t s = 0; s < count; s++) {
        sharing[s].distance =
            (uint32_t)get_between(decoder, 1, chunk.begins_run ? 0 : (uint64_t)before + 1);
        sharing[s].vertices = (uint32_t)get_between(decoder, 0, left);
        left -= sharing[s].vertices;
    }
    if (can_take(decoder, 1, sizeof chunk))
        record_add_chunk(frame, chunk, sharing, count);
    free(sharing);
}

static void get_chunks(struct decoder *decoder, struct record_frame *frame) {
    uint32_t before = 0;
    for (uint32_t count = get_count(decoder); count && !decoder->reader.failed; count--) {
        get_chunk(decoder, frame, before);
        before = frame->chunk_count && !frame->chunks[frame->chunk_count - 1].begins_run
                     ? before + 1
                     : 0;
    }
}

static void get_works(struct decoder *decoder, struct record_frame *frame,
                      struct record_region *region) {
    for (uint32_t count = get_count(decoder); count; count--) {
        uint64_t operations[SIMD_OPERATION_COUNT] = {0};
        const uint32_t shader =
            (uint32_t)get_between(decoder, 1, RECORD_SHARED + (uint64_t)frame->light_count);
        if (shader > frame->instance_count && shader < RECORD_SHARED)
            decoder->reader.failed = true;
        for (uint32_t o = get_count(decoder); o; o--) {
            const uint64_t number = get_number(decoder);
            if (number >= decoder->operation_count) {
                decoder->reader.failed = true;
                break;
            }
            operations[decoder->operations[number]] = get_number(decoder);
            can_take(decoder, 1, sizeof(struct record_operation));
        }
        if (!can_take(decoder, 1, sizeof(struct record_work)))
            return;
        record_add_work(frame, region, shader, operations);
    }
}

static void get_regions(struct decoder *decoder, struct record_frame *frame,
                        uint64_t region_samples) {
    /* each region takes at least four bytes */
    if (frame->region_count > (decoder->reader.length - decoder->reader.at) / 4) {
        decoder->reader.failed = true;
        frame->region_count = 0;
    }
    frame->regions = get_memory(decoder, &frame->region_count, sizeof *frame->regions);
    for (uint32_t k = 0; k < frame->region_count && !decoder->reader.failed; k++) {
        struct record_region *region = &frame->regions[k];
        region->samples = (uint32_t)get_between(decoder, 0, region_samples);
        region->map_bytes =
            get_between(decoder, 0, (uint64_t)region->samples * 8 * RECORD_FLOATS_MAX);
        uint64_t before = 0;
        for (uint32_t e = 0, count = get_count(decoder); e < count; e++) {
            const uint64_t step = get_between(decoder, e ? 1 : 0, UINT32_MAX),
                           work = get_between(decoder, 0, 2 * (uint64_t)UINT32_MAX + 1);
            before += step;
            if (!can_take(decoder, 1, sizeof(struct record_entry)) ||
                before >= frame->chunk_count) {
                decoder->reader.failed = true;
                return;
            }
            record_add_entry(
                frame, region,
                (struct record_entry){(uint32_t)before, (uint32_t)(work >> 1), work & 1});
        }
        get_works(decoder, frame, region);
    }
}

static void copy_section(struct record_frame *frame, const struct record_frame *from,
                         enum record_section section) {
    switch (section) {
    case RECORD_SECTION_SHADERS:
        record_copy_shaders(frame, from);
        break;
    case RECORD_SECTION_CHUNKS:
        record_copy_chunks(frame, from);
        break;
    default:
        record_copy_regions(frame, from);
    }
}

static size_t section_bytes(const struct record_frame *frame, enum record_section section) {
    size_t bytes = 0;
    switch (section) {
    case RECORD_SECTION_SHADERS:
        for (uint32_t i = 0; i < frame->instance_count; i++)
            bytes += sizeof *frame->instances +
                     frame->instances[i].parameter_count * (32 + sizeof(struct record_parameter));
        return bytes + frame->light_count * 32;
    case RECORD_SECTION_CHUNKS:
        return frame->chunk_count * sizeof *frame->chunks +
               frame->sharing_count * sizeof *frame->sharing;
    default:
        return frame->region_count * sizeof *frame->regions +
               frame->entry_count * sizeof *frame->entries +
               frame->work_count * sizeof *frame->works +
               frame->operation_count * sizeof *frame->operations;
    }
}

/* A section is as in the frame before, or follows. Whatever refers to an earlier section is only
 * taken over when that is the same too. */
static void get_sections(struct decoder *decoder, struct record_frame *frame,
                         const struct record_frame *before, const struct machine *machine) {
    for (int section = 0; section < RECORD_SECTION_COUNT && !decoder->reader.failed; section++) {
        if (get_between(decoder, 0, 1)) {
            if (section == RECORD_SECTION_SHADERS)
                get_shaders(decoder, frame);
            else if (section == RECORD_SECTION_CHUNKS)
                get_chunks(decoder, frame);
            else
                get_regions(decoder, frame, (uint64_t)machine_region_samples(machine));
            continue;
        }
        const bool fits =
            before &&
            (section == RECORD_SECTION_SHADERS ||
             (before->instance_count <= frame->instance_count &&
              before->light_count <= frame->light_count &&
              (section == RECORD_SECTION_CHUNKS || (before->region_count == frame->region_count &&
                                                    before->chunk_count <= frame->chunk_count))));
        if (!fits)
            decoder->reader.failed = true;
        else if (can_take(decoder, 1, section_bytes(before, (enum record_section)section)))
            copy_section(frame, before, (enum record_section)section);
    }
}

static void get_frames(struct decoder *decoder, struct run_record *record) {
    const struct machine *machine = &record->machine;
    for (uint32_t count = get_count(decoder); count && !decoder->reader.failed; count--) {
        if (!can_take(decoder, 1, sizeof *record->frames))
            return;
        struct record_frame *frame = record_add_frame(record);
        frame->number = (int32_t)get_signed(decoder);
        frame->width = (uint32_t)get_between(decoder, 1, RECORD_SIDE_MAX);
        frame->height = (uint32_t)get_between(decoder, 1, RECORD_SIDE_MAX);
        frame->samples_x = (uint32_t)get_between(decoder, 1, RECORD_SAMPLES_MAX);
        frame->samples_y = (uint32_t)get_between(decoder, 1, RECORD_SAMPLES_MAX);
        const uint64_t columns =
            ((uint64_t)frame->width * frame->samples_x + (uint64_t)machine->region_width - 1) /
            (uint64_t)machine->region_width;
        const uint64_t rows =
            ((uint64_t)frame->height * frame->samples_y + (uint64_t)machine->region_height - 1) /
            (uint64_t)machine->region_height;
        if (columns * rows > UINT32_MAX)
            decoder->reader.failed = true;
        else
            frame->region_count = (uint32_t)(columns * rows);
        for (int cause = 0; cause < CAUSE_COUNT; cause++)
            frame->geometry_bytes[cause] = get_between(decoder, 0, INT64_MAX / CAUSE_COUNT);
        get_sections(decoder, frame, record->frame_count > 1 ? frame - 1 : NULL, machine);
    }
}

static int value_index(const char *name) {
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++)
        if (!strcmp(machine_parameter_at(i).name, name))
            return i;
    return -1;
}

static bool get_machine(struct decoder *decoder, struct run_record *record, struct status *status) {
    int64_t values[MACHINE_VALUE_COUNT] = {0};
    bool found[MACHINE_VALUE_COUNT] = {false}, ok = true;
    char *name = get_string(decoder);
    for (uint32_t count = get_count(decoder); count && ok; count--) {
        char *parameter = get_string(decoder);
        const int64_t value = get_signed(decoder);
        const int index = value_index(parameter);
        if (index >= 0) {
            values[index] = value;
            found[index] = true;
        } else {
            ok = status_fail(status, STATUS_INVALID,
                             "the record knows a machine parameter \"%.60s\" that this program "
                             "does not: read it with the program that wrote it, or record again",
                             parameter);
        }
        free(parameter);
    }
    for (int i = 0; ok && !decoder->reader.failed && i < MACHINE_VALUE_COUNT; i++)
        if (!found[i])
            ok = status_fail(status, STATUS_INVALID,
                             "the record lacks the machine parameter \"%s\" (%s): it was written "
                             "by another version; record again",
                             machine_parameter_at(i).name, machine_parameter_at(i).what);
    ok = ok && !decoder->reader.failed &&
         machine_from_values(name, values, &record->machine, status);
    free(name);
    return ok;
}

static bool get_operations(struct decoder *decoder, struct status *status) {
    bool ok = true;
    for (uint32_t count = get_count(decoder); count && ok; count--) {
        char *name = get_string(decoder);
        const int index = value_index(name) - MACHINE_PARAMETER_COUNT;
        if (index < 0 ||
            decoder->operation_count == sizeof decoder->operations / sizeof *decoder->operations)
            ok = status_fail(status, STATUS_INVALID,
                             "the record counts an operation \"%.60s\" that this program does not "
                             "know: read it with the program that wrote it, or record again",
                             name);
        else
            decoder->operations[decoder->operation_count++] = (uint32_t)index;
        free(name);
    }
    return ok;
}

static bool get_payload(struct decoder *decoder, struct run_record *record, struct status *status) {
    record->scene = get_string(decoder);
    record->seed = get_number(decoder);
    record->chunk_triangles = (uint32_t)get_between(decoder, 1, UINT32_MAX);
    record->fast_math = get_between(decoder, 0, 1);
    if (decoder->reader.failed)
        return wire_reader_done(&decoder->reader, "record", status);
    if (!get_machine(decoder, record, status))
        return decoder->reader.failed ? wire_reader_done(&decoder->reader, "record", status)
                                      : false;
    if (!get_operations(decoder, status))
        return false;
    get_frames(decoder, record);
    return wire_reader_done(&decoder->reader, "record", status);
}

static bool check_head(const uint8_t *bytes, size_t length, uint64_t *payload_length,
                       uint64_t *checksum, struct status *status) {
    uint32_t magic = 0, version = 0;
    uint64_t head = 0;
    if (length >= 4)
        memcpy(&magic, bytes + RECORD_AT_MAGIC, 4);
    if (magic != RECORD_MAGIC)
        return status_fail(status, STATUS_INVALID,
                           "not a record of a run (sortlast render --record writes one)");
    if (length < RECORD_HEAD_BYTES)
        return status_fail(status, STATUS_INVALID, "the record ends within its head");
    memcpy(&version, bytes + RECORD_AT_VERSION, 4);
    memcpy(payload_length, bytes + RECORD_AT_LENGTH, 8);
    memcpy(checksum, bytes + RECORD_AT_CHECKSUM, 8);
    memcpy(&head, bytes + RECORD_AT_HEAD_CHECKSUM, 8);
    if (version != RECORD_VERSION)
        return status_fail(status, STATUS_INVALID,
                           "a record of version %u; this program reads version %d: record again",
                           version, RECORD_VERSION);
    if (head != hash_bytes(bytes, RECORD_AT_HEAD_CHECKSUM, RECORD_VERSION) ||
        *payload_length > RECORD_LENGTH_MAX)
        return status_fail(status, STATUS_INVALID, "the record is damaged: its head");
    return true;
}

/* The payload, checked and unpacked; the caller's. NULL on failure. */
static uint8_t *unpack(const uint8_t *bytes, size_t length, uint64_t *payload_length,
                       struct status *status) {
    uint64_t checksum = 0;
    if (!check_head(bytes, length, payload_length, &checksum, status))
        return NULL;
    uLong packed = length - RECORD_HEAD_BYTES;
    if (checksum != hash_bytes(bytes + RECORD_HEAD_BYTES, packed, RECORD_VERSION)) {
        status_fail(status, STATUS_INVALID,
                    "the record is damaged: its contents do not match their checksum");
        return NULL;
    }
    uint8_t *payload = memory_try(*payload_length + 1, 1, status);
    uLongf unpacked = *payload_length;
    if (payload && (uncompress2(payload, &unpacked, bytes + RECORD_HEAD_BYTES, &packed) != Z_OK ||
                    unpacked != *payload_length || packed != length - RECORD_HEAD_BYTES)) {
        status_fail(status, STATUS_INVALID, "the record is damaged: its contents do not unpack");
        free(payload);
        return NULL;
    }
    return payload;
}

bool record_decode(const char *file, const uint8_t *bytes, size_t length,
                   struct run_record **record, struct status *status) {
    uint64_t payload_length = 0;
    *record = NULL;
    uint8_t *payload = unpack(bytes, length, &payload_length, status);
    bool ok = payload != NULL;
    if (ok) {
        struct decoder *decoder = memory_get(1, sizeof *decoder);
        decoder->reader = (struct wire_reader){.bytes = payload, .length = payload_length};
        *record = memory_get(1, sizeof **record);
        ok = get_payload(decoder, *record, status);
        free(decoder);
    }
    free(payload);
    if (ok)
        return true;
    record_destroy(*record);
    *record = NULL;
    return status_prefix(status, "%s", file);
}

bool record_read_file(const char *path, struct run_record **record, struct status *status) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return status_fail(status, STATUS_NOT_FOUND, "cannot open the record %s", path);
    struct wire_writer contents = {0};
    uint8_t block[65536];
    size_t got;
    while ((got = fread(block, 1, sizeof block, file)) > 0 && contents.length <= RECORD_LENGTH_MAX)
        wire_put(&contents, block, got);
    const bool failed = ferror(file);
    fclose(file);
    const bool ok = failed ? status_fail(status, STATUS_IO, "cannot read the record %s", path)
                           : record_decode(path, contents.bytes, contents.length, record, status);
    free(contents.bytes);
    return ok;
}

bool record_is_file(const char *path) {
    uint32_t magic = 0;
    FILE *file = fopen(path, "rb");
    const bool ok = file && fread(&magic, sizeof magic, 1, file) == 1;
    if (file)
        fclose(file);
    return ok && magic == RECORD_MAGIC;
}
