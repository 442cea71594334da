/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/protocol.h"

#include <string.h>

/* Payload of COLOUR: fixed head, raster work, shading work, runs, depth, three colour planes,
 * shader IDs. */
struct colour_head {
    struct region_head region;
    uint32_t shading_work_count;
    uint32_t reserved;
    struct region_sums sums;
};

static size_t shader_bytes(uint32_t samples) {
    return ((size_t)samples * 2 + 3) / 4 * 4;
}

struct colour_draft colour_draft_create(const struct region_view *region,
                                        const struct region_sums *sums, uint32_t work_count) {
    struct colour_head head = {
        .region = region->head, .shading_work_count = work_count, .sums = *sums};
    head.region.slots = 0;
    const uint32_t samples = region->head.sample_count;
    const size_t raster_bytes = region->head.work_count * sizeof *region->work;
    const size_t run_bytes = region->head.run_count * sizeof *region->runs;
    const size_t plane_bytes = (size_t)samples * sizeof(float);
    struct colour_draft draft = {
        .message = message_create(WIRE_HEADER_BYTES + sizeof head + raster_bytes +
                                  work_count * sizeof(struct shading_work) + run_bytes +
                                  4 * plane_bytes + shader_bytes(samples))};
    uint8_t *at = draft.message->bytes + WIRE_HEADER_BYTES;
    draft.work = (struct shading_work *)(at + sizeof head);
    const struct {
        const void *bytes;
        size_t length;
    } parts[] = {{&head, sizeof head},
                 {NULL, work_count * sizeof(struct shading_work)},
                 {region->work, raster_bytes},
                 {region->runs, run_bytes},
                 {region->depth, plane_bytes}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (parts[i].length && parts[i].bytes)
            memcpy(at, parts[i].bytes, parts[i].length);
        else
            memset(at, 0, parts[i].length);
        at += parts[i].length;
    }
    for (int c = 0; c < 3; c++, at += plane_bytes)
        draft.color[c] = (float *)at;
    memset(at, 0, shader_bytes(samples));
    memcpy(at, region->shader, (size_t)samples * 2);
    return draft;
}

struct message *colour_seal(struct colour_draft *draft, uint32_t frame, uint32_t region,
                            uint32_t sender) {
    struct message *message = draft->message;
    wire_seal(message, (struct wire_header){.kind = WIRE_COLOUR,
                                            .frame = frame,
                                            .region = region,
                                            .sender = sender,
                                            .cause = CAUSE_CONTROL});
    *draft = (struct colour_draft){0};
    return message;
}

bool colour_open(const struct message *message, uint32_t region_samples, uint32_t rendering_nodes,
                 struct colour_view *view, struct status *status) {
    if (!wire_verify_payload(message->bytes, message->length, status))
        return false;
    struct wire_reader reader = wire_payload(message->bytes, message->length);
    const struct colour_head *head = wire_get(&reader, sizeof *head);
    if (!head || head->region.sample_count > region_samples ||
        head->region.run_count > head->region.sample_count ||
        head->region.work_count > rendering_nodes ||
        head->sums.arrived_samples < head->region.sample_count ||
        head->sums.arrived_samples > (uint64_t)region_samples * rendering_nodes ||
        head->sums.arrived_map_bytes < head->sums.map_bytes)
        return status_fail(status, STATUS_INVALID,
                           "damaged shaded region message: impossible counts");
    *view = (struct colour_view){.head = head->region, .sums = head->sums};
    view->shading_work_count = head->shading_work_count;
    view->shading_work =
        wire_get_array(&reader, head->shading_work_count, sizeof *view->shading_work);
    view->work = wire_get_array(&reader, head->region.work_count, sizeof *view->work);
    view->runs = wire_get_array(&reader, head->region.run_count, sizeof *view->runs);
    view->depth = wire_get_array(&reader, head->region.sample_count, sizeof(float));
    for (int c = 0; c < 3; c++)
        view->color[c] = wire_get_array(&reader, head->region.sample_count, sizeof(float));
    view->shader = wire_get(&reader, shader_bytes(head->region.sample_count));
    if (!wire_reader_done(&reader, "shaded region", status))
        return false;
    uint64_t next = 0, total = 0;
    for (uint32_t i = 0; i < view->head.run_count; i++) {
        if (view->runs[i].first < next || !view->runs[i].count)
            return status_fail(status, STATUS_INVALID, "damaged shaded region message: runs");
        next = (uint64_t)view->runs[i].first + view->runs[i].count;
        total += view->runs[i].count;
    }
    for (uint32_t i = 0; i < view->head.work_count; i++)
        if (view->work[i].node >= rendering_nodes)
            return status_fail(status, STATUS_INVALID,
                               "damaged shaded region message: node number");
    if (next > region_samples || total != view->head.sample_count)
        return status_fail(status, STATUS_INVALID, "damaged shaded region message: runs");
    return true;
}

ticks shading_work_price(const struct machine *machine, const struct shading_work *work,
                         uint32_t count) {
    ticks total = count ? machine->shading_region : 0;
    for (uint32_t i = 0; i < count; i++)
        for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++)
            total = ticks_add(total, work[i].operations[operation] > INT64_MAX
                                         ? TICKS_MAX
                                         : ticks_multiply(machine->operation[operation],
                                                          (int64_t)work[i].operations[operation]));
    return total;
}
