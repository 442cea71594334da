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

/* Holds of all parts; the array is the caller's. */
static struct message **hold_parts(const struct gathered_region *gathered) {
    struct message **parts = memory_get(gathered->count, sizeof *parts);
    for (uint32_t i = 0; i < gathered->count; i++)
        parts[i] = message_hold(gathered->parts[i]);
    return parts;
}

void region_arrivals_finish(struct region_arrivals *arrivals) {
    free(arrivals->shaders);
    *arrivals = (struct region_arrivals){0};
}

static void count_shader(struct region_arrivals *arrivals, uint32_t shader, uint32_t samples) {
    size_t i = 0;
    while (i < arrivals->count && arrivals->shaders[i].shader != shader)
        i++;
    if (i == arrivals->count) {
        arrivals->shaders = memory_grow(arrivals->shaders, &arrivals->capacity, ++arrivals->count,
                                        sizeof *arrivals->shaders);
        arrivals->shaders[i] = (struct shader_samples){shader, 0};
    }
    arrivals->shaders[i].samples += samples;
}

static bool count_part(const struct message *part, uint32_t samples,
                       struct region_arrivals *arrivals, struct status *status) {
    struct region_view view;
    if (!region_open(part->bytes, part->length, samples, &view, status))
        return false;
    for (uint32_t first = 0, at = 1; at <= view.head.sample_count; at++)
        if (at == view.head.sample_count || view.shader[at] != view.shader[first]) {
            count_shader(arrivals, view.shader[first], at - first);
            first = at;
        }
    return true;
}

/* Counts the samples of the parts that `whole` was composed of, unless each of them is in it. */
static bool count_arrivals(struct message *const *parts, uint32_t count, uint32_t samples,
                           const struct message *whole, struct region_arrivals *arrivals,
                           struct status *status) {
    uint64_t arrived = 0;
    for (uint32_t i = 0; i < count; i++)
        arrived += region_sample_count(parts[i]->bytes, parts[i]->length);
    bool ok = true;
    if (arrived > region_sample_count(whole->bytes, whole->length))
        for (uint32_t i = 0; ok && i < count; i++)
            ok = count_part(parts[i], samples, arrivals, status);
    return ok;
}

bool region_gather_add(struct region_gather *gather, const struct node_event *event,
                       uint32_t expected, uint32_t samples, uint32_t self, struct message **whole,
                       struct region_arrivals *arrivals, struct status *status) {
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
    struct message **parts = hold_parts(gathered);
    *whole = region_compose_all(gathered->parts, expected, samples, header->frame, header->region,
                                self, status);
    gathered->count = 0; /* the parts are used up */
    gathered_finish(gathered);
    *gathered = gather->regions[--gather->count];
    const bool ok = *whole && count_arrivals(parts, expected, samples, *whole, arrivals, status);
    for (uint32_t i = 0; i < expected; i++)
        message_release(parts[i]);
    free(parts);
    if (ok)
        return true;
    message_release(*whole);
    *whole = NULL;
    region_arrivals_finish(arrivals);
    return status_prefix(status, "frame %u, region %u", header->frame, header->region);
}
