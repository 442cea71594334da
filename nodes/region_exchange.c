/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/region_exchange.h"

#include <stdlib.h>
#include <string.h>

enum { REGIONS_UNDER_WAY = 4 };

/* One region at this node. */
struct exchanged_region {
    uint32_t frame, region, rank;
    uint32_t shading_node; /* once begun */
    uint32_t step;
    struct message *held;   /* what the node has by now; NULL: not begun */
    size_t next_send;       /* into schedule->sends */
    size_t next_receive;    /* into schedule->receives */
    struct message **parts; /* by receive of the rank, NULL: not here yet */
};

struct region_exchange {
    const struct schedule *schedule;
    uint32_t node;
    struct exchanged_region *regions; /* in order of arrival */
    size_t count, capacity, begun;
};

struct region_exchange *region_exchange_create(const struct schedule *schedule, uint32_t node) {
    struct region_exchange *exchange = memory_get(1, sizeof *exchange);
    exchange->schedule = schedule;
    exchange->node = node;
    return exchange;
}

static size_t receive_count(const struct region_exchange *exchange, uint32_t rank) {
    const size_t *begin = exchange->schedule->receive_begin;
    return begin[rank + 1] - begin[rank];
}

static void region_finish(const struct region_exchange *exchange, struct exchanged_region *region) {
    message_release(region->held);
    for (size_t i = 0; i < receive_count(exchange, region->rank); i++)
        message_release(region->parts[i]);
    free(region->parts);
}

void region_exchange_destroy(struct region_exchange *exchange) {
    if (!exchange)
        return;
    for (size_t i = 0; i < exchange->count; i++)
        region_finish(exchange, &exchange->regions[i]);
    free(exchange->regions);
    free(exchange);
}

bool region_exchange_has_room(const struct region_exchange *exchange) {
    return exchange->begun < REGIONS_UNDER_WAY;
}

static struct exchanged_region *find_or_add(struct region_exchange *exchange, uint32_t frame,
                                            uint32_t region) {
    for (size_t i = 0; i < exchange->count; i++)
        if (exchange->regions[i].frame == frame && exchange->regions[i].region == region)
            return &exchange->regions[i];
    const struct schedule *schedule = exchange->schedule;
    const uint32_t rank = schedule_rank(schedule, exchange->node, region);
    exchange->regions = memory_grow(exchange->regions, &exchange->capacity, exchange->count + 1,
                                    sizeof *exchange->regions);
    struct exchanged_region *added = &exchange->regions[exchange->count++];
    *added = (struct exchanged_region){
        .frame = frame,
        .region = region,
        .rank = rank,
        .next_send = schedule->send_begin[rank],
        .next_receive = schedule->receive_begin[rank],
        .parts = memory_get(receive_count(exchange, rank), sizeof(struct message *)),
    };
    return added;
}

static uint32_t packed(const struct region_exchange *exchange) {
    return node_address_pack((struct node_address){NODE_RENDERING, exchange->node});
}

/* The samples [first, end) of what the node holds; the work rides along when asked for. */
static struct message *part_of_held(const struct region_exchange *exchange,
                                    const struct exchanged_region *region, uint32_t first,
                                    uint32_t end, bool with_work, struct status *status) {
    struct region_view view;
    if (!region_open(region->held->bytes, region->held->length, exchange->schedule->samples, &view,
                     status))
        return NULL;
    return region_extract(&view, first, end, with_work, region->frame, region->region,
                          packed(exchange));
}

/* Sends what the step says. The last move of a rank takes the work along. */
static bool send_step(struct region_exchange *exchange, struct exchanged_region *region,
                      struct node_outputs *outputs, struct status *status) {
    const struct schedule *schedule = exchange->schedule;
    const size_t end = schedule->send_begin[region->rank + 1];
    for (; region->next_send < end; region->next_send++) {
        const struct schedule_move *move = &schedule->moves[schedule->sends[region->next_send]];
        if (move->step != region->step)
            break;
        const struct node_address to =
            move->to == SCHEDULE_SHADING
                ? (struct node_address){NODE_SHADING, region->shading_node}
                : (struct node_address){NODE_RENDERING,
                                        schedule_node(schedule, move->to, region->region)};
        struct message *part = part_of_held(exchange, region, move->first, move->end,
                                            region->next_send + 1 == end, status);
        if (!part)
            return false;
        node_send(outputs, to, part);
    }
    return true;
}

/* Of what the node holds only what it will still send is kept. */
static bool trim(struct region_exchange *exchange, struct exchanged_region *region,
                 struct status *status) {
    const struct schedule *schedule = exchange->schedule;
    uint32_t first = UINT32_MAX, end = 0;
    for (size_t i = region->next_send; i < schedule->send_begin[region->rank + 1]; i++) {
        const struct schedule_move *move = &schedule->moves[schedule->sends[i]];
        first = move->first < first ? move->first : first;
        end = move->end > end ? move->end : end;
    }
    if (first == 0 && end == schedule->samples)
        return true;
    struct message *kept = part_of_held(exchange, region, first, end, true, status);
    message_release(region->held);
    region->held = kept;
    return kept != NULL;
}

/* 1 composed, 0 something of this step is not here yet, -1 failed. */
static int receive_step(struct region_exchange *exchange, struct exchanged_region *region,
                        struct status *status) {
    const struct schedule *schedule = exchange->schedule;
    const size_t begin = schedule->receive_begin[region->rank];
    const size_t all = schedule->receive_begin[region->rank + 1];
    size_t end = region->next_receive;
    while (end < all && schedule->moves[schedule->receives[end]].step == region->step) {
        if (!region->parts[end - begin])
            return 0;
        end++;
    }
    const size_t count = end - region->next_receive;
    if (!count)
        return 1;
    if (!trim(exchange, region, status))
        return -1;
    struct message **parts = memory_get(count + 1, sizeof *parts);
    parts[0] = region->held;
    memcpy(parts + 1, region->parts + (region->next_receive - begin), count * sizeof *parts);
    memset(region->parts + (region->next_receive - begin), 0, count * sizeof *parts);
    region->held = region_compose_all(parts, count + 1, schedule->samples, region->frame,
                                      region->region, packed(exchange), status);
    region->next_receive = end;
    free(parts);
    return region->held ? 1 : -1;
}

/* Goes on with a region as far as what has arrived allows. */
static bool progress(struct region_exchange *exchange, struct exchanged_region *region,
                     struct node_outputs *outputs, struct status *status) {
    const struct schedule *schedule = exchange->schedule;
    while (region->held && region->next_send < schedule->send_begin[region->rank + 1]) {
        if (!send_step(exchange, region, outputs, status))
            return false;
        const int got = receive_step(exchange, region, status);
        if (got < 0)
            return false;
        if (!got)
            return true;
        region->step++;
    }
    if (!region->held)
        return true;
    region_finish(exchange, region);
    exchange->begun--;
    const size_t index = (size_t)(region - exchange->regions);
    memmove(region, region + 1, (--exchange->count - index) * sizeof *region);
    return true;
}

bool region_exchange_begin(struct region_exchange *exchange, uint32_t frame, uint32_t region,
                           uint32_t shading_node, struct message *own, struct node_outputs *outputs,
                           struct status *status) {
    struct exchanged_region *exchanged = find_or_add(exchange, frame, region);
    exchanged->shading_node = shading_node;
    exchanged->held = own;
    exchange->begun++;
    return progress(exchange, exchanged, outputs, status) ||
           status_prefix(status, "frame %u, region %u", frame, region);
}

bool region_exchange_receive(struct region_exchange *exchange, const struct node_event *event,
                             struct node_outputs *outputs, struct status *status) {
    const struct schedule *schedule = exchange->schedule;
    const struct wire_header *header = &event->header;
    const struct node_address from = node_address_unpack(header->sender);
    char name[NODE_NAME_BYTES];
    struct exchanged_region *region = find_or_add(exchange, header->frame, header->region);
    const uint32_t rank = schedule_rank(schedule, from.index, header->region);
    const size_t begin = schedule->receive_begin[region->rank];
    for (size_t i = region->next_receive; i < schedule->receive_begin[region->rank + 1]; i++) {
        if (schedule->moves[schedule->receives[i]].from != rank || from.role != NODE_RENDERING ||
            region->parts[i - begin])
            continue;
        region->parts[i - begin] = message_hold(event->message);
        return progress(exchange, region, outputs, status) ||
               status_prefix(status, "frame %u, region %u", header->frame, header->region);
    }
    return status_fail(status, STATUS_INVALID,
                       "%s sent a part of frame %u, region %u that is not its to send",
                       node_address_name(from, name), header->frame, header->region);
}

bool region_exchange_waits_for(const struct region_exchange *exchange, uint32_t *frame,
                               uint32_t *region, uint32_t *node) {
    const struct schedule *schedule = exchange->schedule;
    for (size_t i = 0; i < exchange->count; i++) {
        const struct exchanged_region *waits = &exchange->regions[i];
        const size_t begin = schedule->receive_begin[waits->rank];
        for (size_t n = waits->next_receive;
             waits->held && n < schedule->receive_begin[waits->rank + 1]; n++)
            if (!waits->parts[n - begin]) {
                *frame = waits->frame;
                *region = waits->region;
                *node = schedule_node(schedule, schedule->moves[schedule->receives[n]].from,
                                      waits->region);
                return true;
            }
    }
    return false;
}
