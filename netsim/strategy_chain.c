/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/strategy.h"

#include <stdlib.h>

/* PixelFlow's own (PF section 5.1): the nodes stand in a row, rendering nodes 0..r-1, then shading
 * nodes 0..s-1, and pass a region along, each adding the nearer of its own and the upstream sample.
 * All transmit at once, a hop apart, so the region occupies every link for the same time and one
 * link stands for all. */
struct chain {
    uint32_t rendering_nodes;
    int64_t samples; /* of a region */
    ticks link_free; /* first link, at its sender's end */
    ticks way[];     /* from the first node to rendering node i; at r + j to shading node j */
};

static void *chain_create(const struct machine *machine, uint32_t rendering_nodes,
                          uint32_t shading_nodes) {
    const size_t places = (size_t)rendering_nodes + shading_nodes;
    struct chain *chain = memory_get(1, sizeof *chain + places * sizeof *chain->way);
    chain->rendering_nodes = rendering_nodes;
    chain->samples = machine_region_samples(machine);
    for (size_t i = 0; i < places; i++)
        chain->way[i] = ticks_multiply(machine->composition_hop, (int64_t)i);
    return chain;
}

/* Why the transfer could not begin before `begin`; a link that was busy anyway comes first. */
static void explain(const struct chain *chain, const struct strategy_region *region, ticks begin,
                    ticks room, struct strategy_times *times) {
    times->holder = 0;
    if (begin == chain->link_free)
        times->hold = STRATEGY_HELD_BY_LINK;
    else if (room == begin)
        times->hold = STRATEGY_HELD_BY_ROOM;
    else if (region->earliest == begin)
        times->hold = STRATEGY_HELD_BY_GEOMETRY;
    else {
        times->hold = STRATEGY_HELD_BY_RASTER;
        while (times->holder < region->work_count &&
               region->ready[times->holder] - chain->way[region->work[times->holder].node] != begin)
            times->holder++;
    }
}

static void chain_compose(void *state, const struct strategy_region *region,
                          struct strategy_times *times) {
    struct chain *chain = state;
    const ticks *way = chain->way;
    const struct timing_work *work = region->work;
    const ticks *ready = region->ready;
    ticks *released = times->released;
    const uint32_t count = region->work_count;
    const ticks last = way[chain->rendering_nodes + region->shading_node];
    ticks begin = ticks_max(region->earliest, chain->link_free);
    for (uint32_t w = 0; w < count; w++) /* the transfer passes node i after i hops */
        begin = ticks_max(begin, ready[w] - way[work[w].node]);
    const ticks room = region->room > last ? region->room - last : 0;
    begin = ticks_max(begin, room);
    if (region->wants_hold)
        explain(chain, region, begin, room, times);
    const ticks end = ticks_add(begin, region->transfer);
    for (uint32_t w = 0; w < count; w++)
        released[w] = ticks_add(end, way[work[w].node]);
    chain->link_free = end;
    times->begin = begin;
    times->end = end;
    times->arrival = ticks_add(end, last);
    times->busy = region->transfer;
    times->arriving_words = region->words ? ticks_multiply(chain->samples, region->words) : 1;
    times->sent_words = ticks_multiply(times->arriving_words, chain->rendering_nodes);
}

const struct strategy strategy_chain = {
    "chain",       "PixelFlow's: all nodes in a row, each passes on the nearer of two samples",
    chain_create,  free,
    chain_compose, NULL};
