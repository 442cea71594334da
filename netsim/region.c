/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/region.h"

#include <string.h>

enum {
    REGION_WORK_MAX = 65536,
    REGION_SLOTS_MAX = 16384,
    REGION_WORK_ROOM = 64, /* entries that a message may grow by */
};

static size_t shader_plane_bytes(uint32_t sample_count) {
    return ((size_t)sample_count * 2 + 3) / 4 * 4;
}

bool region_open(const uint8_t *message_bytes, size_t length, uint32_t region_samples,
                 struct region_view *view, struct status *status) {
    if (!wire_verify_payload(message_bytes, length, status))
        return false;
    struct wire_reader reader = wire_payload(message_bytes, length);
    const struct region_head *head = wire_get(&reader, sizeof *head);
    if (!head)
        return status_fail(status, STATUS_INVALID, "damaged region message: no head");
    *view = (struct region_view){.head = *head};
    if (head->sample_count > region_samples || head->run_count > head->sample_count ||
        head->work_count > REGION_WORK_MAX || head->slots > REGION_SLOTS_MAX ||
        head->longest_map < head->slots)
        return status_fail(status, STATUS_INVALID, "damaged region message: impossible counts");
    view->runs = wire_get_array(&reader, head->run_count, sizeof *view->runs);
    view->depth = wire_get_array(&reader, head->sample_count, sizeof *view->depth);
    view->primitive = wire_get_array(&reader, head->sample_count, sizeof *view->primitive);
    view->shader = wire_get(&reader, shader_plane_bytes(head->sample_count));
    view->slots =
        wire_get_array(&reader, (uint64_t)head->slots * head->sample_count, sizeof(float));
    view->work = wire_get_array(&reader, head->work_count, sizeof *view->work);
    if (!wire_reader_done(&reader, "region", status))
        return false;
    uint64_t next = 0, total = 0;
    for (uint32_t i = 0; i < head->run_count; i++) {
        if (view->runs[i].first < next || view->runs[i].count == 0)
            return status_fail(status, STATUS_INVALID, "damaged region message: runs out of order");
        next = (uint64_t)view->runs[i].first + view->runs[i].count;
        total += view->runs[i].count;
    }
    if (next > region_samples || total != head->sample_count)
        return status_fail(status, STATUS_INVALID,
                           "damaged region message: runs outside the region");
    return true;
}

uint32_t region_sample_count(const uint8_t *message_bytes, size_t length) {
    struct wire_reader reader = wire_payload(message_bytes, length);
    const struct region_head *head = wire_get(&reader, sizeof *head);
    return head ? head->sample_count : 0;
}

struct region_draft region_draft_create(struct region_head head) {
    const size_t samples = head.sample_count;
    size_t bytes = WIRE_HEADER_BYTES + sizeof head + head.work_count * sizeof(struct region_work) +
                   head.run_count * sizeof(struct region_run) + samples * 8 +
                   shader_plane_bytes(head.sample_count) + (size_t)head.slots * samples * 4;
    struct region_draft draft = {
        .message = message_create_with_room(bytes, REGION_WORK_ROOM * sizeof(struct region_work)),
        .head = head};
    uint8_t *at = draft.message->bytes + WIRE_HEADER_BYTES;
    memcpy(at, &head, sizeof head);
    at += sizeof head;
    draft.runs = (struct region_run *)at;
    at += head.run_count * sizeof(struct region_run);
    draft.depth = (float *)at;
    at += samples * 4;
    draft.primitive = (uint32_t *)at;
    at += samples * 4;
    draft.shader = (uint16_t *)at;
    if (samples % 2)
        draft.shader[samples] = 0;
    at += shader_plane_bytes(head.sample_count);
    draft.slots = (float *)at;
    at += (size_t)head.slots * samples * sizeof *draft.slots;
    draft.work = (struct region_work *)at;
    return draft;
}

struct region_view region_draft_view(const struct region_draft *draft) {
    return (struct region_view){.head = draft->head,
                                .work = draft->work,
                                .runs = draft->runs,
                                .depth = draft->depth,
                                .primitive = draft->primitive,
                                .shader = draft->shader,
                                .slots = draft->slots};
}

struct message *region_seal(struct region_draft *draft, uint32_t frame, uint32_t region,
                            uint32_t sender) {
    struct message *message = draft->message;
    wire_seal(message, (struct wire_header){.kind = WIRE_REGION,
                                            .frame = frame,
                                            .region = region,
                                            .sender = sender,
                                            .cause = CAUSE_CONTROL});
    *draft = (struct region_draft){0};
    return message;
}
