/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/protocol.h"

#include <stdio.h>
#include <stdlib.h>

/* The whole-number fields of a frame record in the order they travel. */
enum { RECORD_FIELDS = 27 };

static void record_fields(struct frame_record *r, uint64_t *fields[RECORD_FIELDS]) {
    uint64_t *list[RECORD_FIELDS] = {
        &r->samples_covered,
        &r->samples_total,
        (uint64_t *)&r->start_ps,
        (uint64_t *)&r->end_ps,
        (uint64_t *)&r->time_ps,
        (uint64_t *)&r->start,
        (uint64_t *)&r->end,
        (uint64_t *)&r->time,
        &r->tick_rate,
        &r->composition.depth,
        &r->composition.shader_id,
        &r->composition.parameters,
        &r->composition.padding,
        &r->composition.total,
        &r->composition.sent,
        (uint64_t *)&r->composition.busy_ps,
        &r->geometry.bytes[CAUSE_PRIMITIVES],
        &r->geometry.bytes[CAUSE_BOUND_PARAMETERS],
        &r->geometry.bytes[CAUSE_SHADERS],
        &r->geometry.bytes[CAUSE_CONTROL],
        &r->geometry.total,
        (uint64_t *)&r->geometry.busy_ps,
        &r->framebuffer.bytes,
        (uint64_t *)&r->framebuffer.busy_ps,
        &r->nan_depths,
        &r->nan_colours,
    };
    for (int i = 0; i < RECORD_FIELDS; i++)
        fields[i] = list[i];
}

struct message *frame_record_encode(const struct frame_record *record, uint32_t sender) {
    struct wire_writer writer = {0};
    uint64_t *fields[RECORD_FIELDS];
    record_fields((struct frame_record *)record, fields);
    wire_put_u32(&writer, record->regions);
    wire_put_u32(&writer, record->regions_covered);
    wire_put_u32(&writer, record->bound_by);
    wire_put_u32(&writer, record->rendering_nodes);
    wire_put_u32(&writer, record->shading_nodes);
    for (int i = 0; i < RECORD_FIELDS && fields[i]; i++)
        wire_put_u64(&writer, *fields[i]);
    for (uint32_t i = 0; i < record->rendering_nodes; i++)
        wire_put_u64(&writer, (uint64_t)record->raster_busy_ps[i]);
    for (uint32_t i = 0; i < record->shading_nodes; i++)
        wire_put_u64(&writer, (uint64_t)record->shading_busy_ps[i]);
    wire_put_string(&writer, record->image_path);
    work_record_put(&record->work, &writer);
    return wire_finish(&writer, (struct wire_header){.kind = WIRE_FRAME_DONE,
                                                     .frame = record->frame,
                                                     .sender = sender,
                                                     .cause = CAUSE_CONTROL});
}

static int64_t *read_times(struct wire_reader *reader, uint32_t count) {
    if (count > reader->length / 8) {
        reader->failed = true;
        count = 0;
    }
    int64_t *times = memory_get(count, sizeof *times);
    for (uint32_t i = 0; i < count; i++)
        times[i] = (int64_t)wire_get_u64(reader);
    return times;
}

bool frame_record_decode(const struct message *message, struct frame_record *record,
                         struct status *status) {
    struct wire_reader reader = wire_payload(message->bytes, message->length);
    uint64_t *fields[RECORD_FIELDS];
    *record = (struct frame_record){0};
    record_fields(record, fields);
    record->regions = wire_get_u32(&reader);
    record->regions_covered = wire_get_u32(&reader);
    uint32_t bound_by = wire_get_u32(&reader);
    record->rendering_nodes = wire_get_u32(&reader);
    record->shading_nodes = wire_get_u32(&reader);
    for (int i = 0; i < RECORD_FIELDS && fields[i]; i++)
        *fields[i] = wire_get_u64(&reader);
    record->raster_busy_ps = read_times(&reader, record->rendering_nodes);
    record->shading_busy_ps = read_times(&reader, record->shading_nodes);
    snprintf(record->image_path, sizeof record->image_path, "%s", wire_get_string(&reader));
    work_record_get(&record->work, &reader);
    record->bound_by = (enum timing_resource)(bound_by < TIMING_RESOURCE_COUNT ? bound_by : 0);
    if (wire_reader_done(&reader, "frame done", status))
        return true;
    frame_record_finish(record);
    return false;
}

void frame_record_finish(struct frame_record *record) {
    free(record->raster_busy_ps);
    free(record->shading_busy_ps);
    record->raster_busy_ps = record->shading_busy_ps = NULL;
    work_record_finish(&record->work);
}
