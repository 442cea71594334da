/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/protocol.h"

#include <stdlib.h>

static struct wire_header costs_header(enum wire_kind kind, uint32_t frame, uint32_t sender) {
    return (struct wire_header){
        .kind = kind, .frame = frame, .sender = sender, .cause = CAUSE_CONTROL};
}

struct message *chunk_work_encode(const struct chunk_work *work, size_t count, uint32_t frame,
                                  uint32_t sender) {
    struct wire_writer writer = {0};
    wire_put_u64(&writer, count);
    wire_put(&writer, work, count * sizeof *work);
    return wire_finish(&writer, costs_header(WIRE_CHUNK_WORK, frame, sender));
}

bool chunk_work_decode(const struct message *message, const struct chunk_work **work, size_t *count,
                       struct status *status) {
    struct wire_reader reader = wire_payload(message->bytes, message->length);
    *count = wire_get_u64(&reader);
    *work = wire_get_array(&reader, *count, sizeof **work);
    return wire_reader_done(&reader, "chunk work", status);
}

struct message *region_costs_encode(const struct region_costs *regions, size_t count,
                                    uint32_t frame, uint32_t sender) {
    struct wire_writer writer = {0};
    wire_put_u64(&writer, count);
    for (size_t i = 0; i < count; i++) {
        wire_put_u32(&writer, regions[i].region);
        wire_put_u32(&writer, regions[i].samples);
        wire_put_u64(&writer, regions[i].map_bytes);
        wire_put_u64(&writer, regions[i].work_count);
        wire_put(&writer, regions[i].work, regions[i].work_count * sizeof *regions[i].work);
    }
    return wire_finish(&writer, costs_header(WIRE_REGION_COSTS, frame, sender));
}

bool region_costs_decode(const struct message *message, struct region_costs **regions,
                         size_t *count, struct status *status) {
    enum { REGION_BYTES = 24 };
    struct wire_reader reader = wire_payload(message->bytes, message->length);
    *count = wire_get_u64(&reader);
    if (*count > reader.length / REGION_BYTES)
        return status_fail(status, STATUS_INVALID, "damaged region costs message: count");
    *regions = memory_get(*count, sizeof **regions);
    uint64_t next = 0;
    bool is_ordered = true;
    for (size_t i = 0; i < *count; i++) {
        struct region_costs *costs = &(*regions)[i];
        costs->region = wire_get_u32(&reader);
        costs->samples = wire_get_u32(&reader);
        costs->map_bytes = wire_get_u64(&reader);
        const uint64_t work_count = wire_get_u64(&reader);
        costs->work = wire_get_array(&reader, work_count, sizeof *costs->work);
        costs->work_count = (uint32_t)work_count;
        is_ordered &= costs->region >= next;
        next = (uint64_t)costs->region + 1;
    }
    if (wire_reader_done(&reader, "region costs", status) &&
        (is_ordered || status_fail(status, STATUS_INVALID, "damaged region costs message: order")))
        return true;
    free(*regions);
    *regions = NULL;
    return false;
}
