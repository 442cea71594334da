/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REGION_EXCHANGE_H
#define REGION_EXCHANGE_H

#include "netsim/schedule.h"
#include "nodes/node.h"
#include "nodes/protocol.h"

/* Messages that came before the node knew what to do with them. */
struct early_messages {
    struct node_event *events;
    size_t count, capacity;
};
void early_messages_add(struct early_messages *early, const struct node_event *event);
/* Empties the list, releasing what is in it. */
void early_messages_finish(struct early_messages *early);

/* Regions under way at a rendering node of a switched network: sends parts of what it has and
 * composes what it receives, step by step as the schedule says (netsim/schedule.h). Several regions
 * are under way at once; parts that come before their region is begun here are kept. */
struct region_exchange;

/* `schedule` must outlive it. */
struct region_exchange *region_exchange_create(const struct schedule *schedule, uint32_t node);
void region_exchange_destroy(struct region_exchange *exchange);

/* Whether another region may be begun, or so many are under way that others must come first. */
bool region_exchange_has_room(const struct region_exchange *exchange);
/* Begins a region that goes to a shading node with what the node itself has of it; takes the hold
 * over. */
bool region_exchange_begin(struct region_exchange *exchange, uint32_t frame, uint32_t region,
                           uint32_t shading_node, struct message *own, struct node_outputs *outputs,
                           struct status *status);
/* A part from another rendering node. */
bool region_exchange_receive(struct region_exchange *exchange, const struct node_event *event,
                             struct node_outputs *outputs, struct status *status);
/* For people: the oldest region under way and the node it waits for; false when there is none. */
bool region_exchange_waits_for(const struct region_exchange *exchange, uint32_t *frame,
                               uint32_t *region, uint32_t *node);

/* Composes all messages of one region (holds taken over) into one; NULL when one is damaged. */
struct message *region_compose_all(struct message **parts, size_t count, uint32_t samples,
                                   uint32_t frame, uint32_t region, uint32_t sender,
                                   struct status *status);

/* Samples that came to a shading node, by shader ID. Empty: as many as the region has composed. */
struct region_arrivals {
    struct shader_samples {
        uint32_t shader, samples;
    } * shaders;
    size_t count, capacity;
};

/* Parts of regions that come together at a shading node. */
struct region_gather {
    struct gathered_region {
        uint32_t frame, region, count;
        struct message **parts;
        uint32_t *senders;
    } * regions;
    size_t count, capacity;
};
void region_gather_finish(struct region_gather *gather);
void region_arrivals_finish(struct region_arrivals *arrivals);
/* Adds a part; when it is the last of `expected`, *whole is the composed region and `arrivals` (of
 * which the list is filled in when parts overlap) what it was composed of, both the caller's;
 * otherwise NULL. Fails when a node sends the same part twice. */
bool region_gather_add(struct region_gather *gather, const struct node_event *event,
                       uint32_t expected, uint32_t samples, uint32_t self, struct message **whole,
                       struct region_arrivals *arrivals, struct status *status);

#endif
