/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PACER_H
#define PACER_H

#include "nodes/node.h"

#include <stdint.h>

/* Paced mode: what a node sends and receives is held back on a real clock, so that the cluster runs
 * at SCALE times the speed of the machine it simulates and wall time times SCALE is to be the
 * solved time (docs/timing.md). One pacer stands between a node and its driver; it knows what
 * passes there, and nothing of the timing model: every wait follows from messages that really
 * arrived.
 *
 *   host            one token bucket for the geometry network: charged bytes, broadcasts once
 *   rendering node  holds a region until its raster work would be done and a raster buffer free;
 *                   one token bucket for its composition link, whole words of the region
 *   shading node    holds colours until the region's priced operations would be done
 *   framebuffer     takes colours in order of regions through one token bucket
 *
 * Buffers are handed back by CREDIT messages: framebuffer to shading node to last rendering node
 * to each one before it. A transfer passes the whole chain at once (cut-through), so a rendering
 * node sends when its transfer begins, and only the last one, whose receiver must have all of it,
 * sends when it ends.
 *
 * Pure but for the clock, which is passed in: nanoseconds of any monotonic clock. */
struct pacer;

#define PACER_SCALE_MIN 1e-9
#define PACER_SCALE_MAX 1e3

/* `is_shaped`: the composition link is throttled by the network below the sockets (tc tbf). A
 * region then goes with a FILLER in front that makes up what the machine would have sent, and the
 * link is free when the shading node tells of its ARRIVAL. For one rendering node: what the network
 * below stores and forwards cannot cut through a chain. */
struct pacer *pacer_create(double scale, bool is_shaped, struct node_address self);
void pacer_destroy(struct pacer *pacer);

/* A message on its way out. True: the pacer took over the hold and gives it back by pacer_next;
 * false: it is not paced, send it now. */
bool pacer_output(struct pacer *pacer, struct node_address to, struct message *message,
                  int64_t now_ns);
/* A message that arrived. True: taken (a credit), or to be given to the node later by pacer_next;
 * false: give it to the node now. */
bool pacer_input(struct pacer *pacer, const struct node_event *event, int64_t now_ns);

/* What is due at `now_ns`, oldest first. */
struct pacer_action {
    bool is_delivery;        /* to the node itself; otherwise to be sent */
    struct node_address to;  /* when sent */
    struct message *message; /* one hold, the caller's */
};
bool pacer_next(struct pacer *pacer, int64_t now_ns, struct pacer_action *action);
/* When pacer_next will next have something as far as is known; INT64_MAX: not before a message
 * arrives. */
int64_t pacer_wake_ns(const struct pacer *pacer);
/* So much is held back that the node should not work ahead. */
bool pacer_is_full(const struct pacer *pacer);
/* Host: when the first charged byte entered the geometry network; INT64_MIN: not yet. */
int64_t pacer_begin_ns(const struct pacer *pacer);

#endif
