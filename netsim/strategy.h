/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STRATEGY_H
#define STRATEGY_H

#include "netsim/machine.h"
#include "netsim/schedule.h"

#include <stdbool.h>
#include <stdint.h>

/* Composition strategies: how what the rendering nodes have of a region becomes one region at its
 * shading node. A strategy is the composition stage of the timing model (timing.h): given when each
 * rendering node is ready it says when the region is moved, when it is complete, and when each
 * node's region buffer is free again. It keeps the state of its links from region to region; all
 * else (raster, shading, colours, buffers) is the model's. One file each, listed once in
 * STRATEGIES. */

struct timing_work {
    uint32_t node; /* rendering node */
    uint32_t triangles;
};

/* One region, as the composition stage sees it. */
struct strategy_region {
    uint32_t frame, region; /* region counts within its frame, from 0 */
    uint32_t shading_node;  /* where it goes */
    uint32_t words;         /* a sample of it takes; 0: a token of one word for the whole region */
    ticks transfer;         /* the whole region (or the token) over one link */
    ticks earliest;         /* the frame's geometry is there: nothing moves before */
    ticks room;             /* its shading node has a region buffer free; 0 for a token */
    uint32_t work_count;    /* rendering nodes with work in it, by ascending number */
    const struct timing_work *work;
    const ticks *ready; /* [work_count]: that node has rastered the region */
    bool wants_hold;    /* fill in hold and holder: someone asks for reasons */
};

/* What held up the begin of a region's transfer, the latest of these. */
enum strategy_hold {
    STRATEGY_HELD_BY_LINK, /* a link busy with the region before */
    STRATEGY_HELD_BY_GEOMETRY,
    STRATEGY_HELD_BY_RASTER, /* of node work[holder] */
    STRATEGY_HELD_BY_ROOM,   /* on the shading node */
};

struct strategy_times {
    ticks begin, end; /* of the transfer over the first link, at its sender */
    ticks arrival;    /* all of it, composed, at its shading node */
    ticks busy;       /* by how much this region occupies the busiest link */
    /* Words on the network: into the shading node, and all that rendering nodes send, to each other
     * and to it. They saturate as times do. */
    int64_t arriving_words, sent_words;
    ticks *released; /* [work_count], the caller's array: that node's region buffer is free */
    enum strategy_hold hold;
    uint32_t holder;
};

struct strategy {
    const char *name, *what; /* as options and reports call it; a line of explanation */
    /* State of the links of a cluster of this size, all free at time 0. The machine is copied or
     * used up: it need not outlive the call. */
    void *(*create)(const struct machine *machine, uint32_t rendering_nodes,
                    uint32_t shading_nodes);
    void (*destroy)(void *state);
    /* The next region in order of transfer. Times saturate at TICKS_MAX, never wrap. Must not let
     * less work, room or readiness lead to later times. */
    void (*compose)(void *state, const struct strategy_region *region,
                    struct strategy_times *times);
    /* Who sends what to whom, on a switched network, where every node is one hop from every other;
     * NULL for the chain, where neighbours are. */
    schedule_plan *plan;
};

/* Every strategy; the first is the default. X(name of its structure after strategy_) */
#define STRATEGIES(X) X(chain) X(direct_send) X(binary_swap) X(radix_k) X(tree)

#define STRATEGY_DECLARE(name) extern const struct strategy strategy_##name;
STRATEGIES(STRATEGY_DECLARE)
#undef STRATEGY_DECLARE

/* The i-th strategy, NULL past the last; the strategy of a name, NULL when there is none. */
const struct strategy *strategy_at(int index);
const struct strategy *strategy_find(const char *name);

#endif
