/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/region_exchange.h"

#include <stdlib.h>

void early_messages_add(struct early_messages *early, const struct node_event *event) {
    early->events =
        memory_grow(early->events, &early->capacity, early->count + 1, sizeof *early->events);
    early->events[early->count] = *event;
    early->events[early->count++].message = message_hold(event->message);
}

void early_messages_finish(struct early_messages *early) {
    for (size_t i = 0; i < early->count; i++)
        message_release(early->events[i].message);
    free(early->events);
    *early = (struct early_messages){0};
}

/* Two messages into one. */
static struct message *compose_two(const struct message *a, const struct message *b,
                                   uint32_t samples, uint32_t frame, uint32_t region,
                                   uint32_t sender, struct status *status) {
    struct region_view view_a, view_b;
    if (!region_open(a->bytes, a->length, samples, &view_a, status) ||
        !region_open(b->bytes, b->length, samples, &view_b, status))
        return NULL;
    return region_compose(&view_a, &view_b, frame, region, sender);
}

struct message *region_compose_all(struct message **parts, size_t count, uint32_t samples,
                                   uint32_t frame, uint32_t region, uint32_t sender,
                                   struct status *status) {
    bool ok = true;
    while (ok && count > 1) { /* neighbours, then neighbours of those: each is copied log times */
        const size_t half = (count + 1) / 2;
        for (size_t i = 0; i < half; i++) {
            struct message *a = parts[2 * i];
            struct message *b = 2 * i + 1 < count ? parts[2 * i + 1] : NULL;
            parts[i] = a;
            if (!b)
                continue;
            parts[i] = ok ? compose_two(a, b, samples, frame, region, sender, status) : NULL;
            ok = ok && parts[i];
            message_release(a);
            message_release(b);
        }
        count = half;
    }
    for (size_t i = 0; !ok && i < count; i++)
        message_release(parts[i]);
    return ok ? parts[0] : NULL;
}

static void gathered_finish(struct gathered_region *gathered) {
    for (uint32_t i = 0; i < gathered->count; i++)
        message_release(gathered->parts[i]);
    free(gathered->parts);
    free(gathered->senders);
}

void region_gather_finish(struct region_gather *gather) {
    for (size_t i = 0; i < gather->count; i++)
        gathered_finish(&gather->regions[i]);
    free(gather->regions);
}

static struct gathered_region *find_or_add(struct region_gather *gather, uint32_t frame,
                                           uint32_t region, uint32_t expected) {
    for (size_t i = 0; i < gather->count; i++)
        if (gather->regions[i].frame == frame && gather->regions[i].region == region)
            return &gather->regions[i];
    gather->regions =
        memory_grow(gather->regions, &gather->capacity, gather->count + 1, sizeof *gather->regions);
    struct gathered_region *added = &gather->regions[gather->count++];
    *added =
        (struct gathered_region){frame, region, 0, memory_get(expected, sizeof(struct message *)),
                                 memory_get(expected, sizeof(uint32_t))};
    return added;
}

bool region_gather_add(struct region_gather *gather, const struct node_event *event,
                       uint32_t expected, uint32_t samples, uint32_t self, struct message **whole,
                       struct status *status) {
    const struct wire_header *header = &event->header;
    char name[NODE_NAME_BYTES];
    *whole = NULL;
    struct gathered_region *gathered = find_or_add(gather, header->frame, header->region, expected);
    for (uint32_t i = 0; i < gathered->count; i++)
        if (gathered->senders[i] == header->sender)
            return status_fail(status, STATUS_INVALID,
                               "%s sent its part of frame %u, region %u twice",
                               node_address_name(node_address_unpack(header->sender), name),
                               header->frame, header->region);
    gathered->senders[gathered->count] = header->sender;
    gathered->parts[gathered->count++] = message_hold(event->message);
    if (gathered->count < expected)
        return true;
    *whole = region_compose_all(gathered->parts, expected, samples, header->frame, header->region,
                                self, status);
    gathered->count = 0; /* the parts are used up */
    gathered_finish(gathered);
    *gathered = gather->regions[--gather->count];
    return *whole || status_prefix(status, "frame %u, region %u", header->frame, header->region);
}
