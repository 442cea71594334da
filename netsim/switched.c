/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/switched.h"

#include <stdlib.h>
#include <string.h>

/* A direction of a node's port. */
struct port {
    ticks free_at; /* as seen by senders: what arrives occupies it a hop later */
    ticks busy;    /* in this frame */
};

/* What made a move begin when it did, and where that chain of moves of the region began. */
struct origin {
    ticks begin;
    enum strategy_hold hold;
    uint32_t holder; /* entry of the work list */
};

struct switched {
    struct schedule *schedule;
    ticks hop, word;
    uint32_t rendering_nodes, shading_nodes, frame;
    struct port *out, *in; /* rendering nodes; in: also shading nodes behind them */
    ticks busiest;         /* of all ports, in this frame */
    /* of the region at hand: words to the shading node, and in all; by rank */
    int64_t arriving_words, sent_words;
    ticks *ready, *next_ready, *released;
    struct origin *origin, *next_origin;
};

void *switched_create(const struct machine *machine, schedule_plan *plan, uint32_t rendering_nodes,
                      uint32_t shading_nodes) {
    struct switched *s = memory_get(1, sizeof *s);
    s->schedule = schedule_create(plan, rendering_nodes, (uint32_t)machine_region_samples(machine));
    s->hop = machine->composition_hop;
    s->word = machine->composition_word;
    s->rendering_nodes = rendering_nodes;
    s->shading_nodes = shading_nodes;
    s->out = memory_get(rendering_nodes, sizeof *s->out);
    s->in = memory_get((size_t)rendering_nodes + shading_nodes, sizeof *s->in);
    s->ready = memory_get(rendering_nodes, sizeof(ticks));
    s->next_ready = memory_get(rendering_nodes, sizeof(ticks));
    s->released = memory_get(rendering_nodes, sizeof(ticks));
    s->origin = memory_get(rendering_nodes, sizeof *s->origin);
    s->next_origin = memory_get(rendering_nodes, sizeof *s->next_origin);
    return s;
}

void switched_destroy(void *state) {
    struct switched *s = state;
    if (!s)
        return;
    schedule_destroy(s->schedule);
    free(s->out);
    free(s->in);
    free(s->ready);
    free(s->next_ready);
    free(s->released);
    free(s->origin);
    free(s->next_origin);
    free(s);
}

static void begin_region(struct switched *s, const struct strategy_region *region) {
    const uint32_t nodes = s->rendering_nodes;
    if (region->frame != s->frame) {
        s->frame = region->frame;
        s->busiest = 0;
        for (uint32_t i = 0; i < nodes; i++)
            s->out[i].busy = 0;
        for (uint32_t i = 0; i < nodes + s->shading_nodes; i++)
            s->in[i].busy = 0;
    }
    for (uint32_t rank = 0; rank < nodes; rank++) {
        s->ready[rank] = region->earliest;
        s->released[rank] = 0;
        s->origin[rank] = (struct origin){region->earliest, STRATEGY_HELD_BY_GEOMETRY, 0};
    }
    s->arriving_words = s->sent_words = 0;
    for (uint32_t w = 0; w < region->work_count; w++) {
        const uint32_t rank = schedule_rank(s->schedule, region->work[w].node, region->region);
        if (region->ready[w] > s->ready[rank]) {
            s->ready[rank] = region->ready[w];
            s->origin[rank] = (struct origin){region->ready[w], STRATEGY_HELD_BY_RASTER, w};
        }
    }
    memcpy(s->next_ready, s->ready, nodes * sizeof(ticks));
    memcpy(s->next_origin, s->origin, nodes * sizeof *s->origin);
}

static void end_step(struct switched *s) {
    memcpy(s->ready, s->next_ready, s->rendering_nodes * sizeof(ticks));
    memcpy(s->origin, s->next_origin, s->rendering_nodes * sizeof *s->origin);
}

static void occupy(struct switched *s, struct port *port, ticks end, ticks duration) {
    port->free_at = end;
    port->busy = ticks_add(port->busy, duration);
    s->busiest = ticks_max(s->busiest, port->busy);
}

/* One move; returns when all of it has left. */
static ticks move(struct switched *s, const struct strategy_region *region,
                  const struct schedule_move *m, struct origin *origin) {
    const bool is_final = m->to == SCHEDULE_SHADING;
    const uint32_t nodes = s->rendering_nodes;
    struct port *out = &s->out[schedule_node(s->schedule, m->from, region->region)];
    struct port *in = is_final ? &s->in[nodes + region->shading_node]
                               : &s->in[schedule_node(s->schedule, m->to, region->region)];
    const int64_t payload = ticks_multiply(m->end - m->first, region->words);
    const int64_t words = payload ? payload : 1;
    const ticks duration = ticks_multiply(s->word, words);
    const ticks links = ticks_max(out->free_at, in->free_at);
    const ticks room = is_final && region->room > s->hop ? region->room - s->hop : 0;
    ticks begin = s->ready[m->from];
    *origin = s->origin[m->from];
    if (links > begin) {
        begin = links;
        *origin = (struct origin){begin, STRATEGY_HELD_BY_LINK, 0};
    }
    if (room > begin) {
        begin = room;
        *origin = (struct origin){begin, STRATEGY_HELD_BY_ROOM, 0};
    }
    const ticks end = ticks_add(begin, duration);
    occupy(s, out, end, duration);
    occupy(s, in, end, duration);
    s->released[m->from] = ticks_max(s->released[m->from], end);
    s->sent_words = ticks_add(s->sent_words, words);
    s->arriving_words = ticks_add(s->arriving_words, is_final ? words : 0);
    return end;
}

void switched_compose(void *state, const struct strategy_region *region,
                      struct strategy_times *times) {
    struct switched *s = state;
    const struct schedule *schedule = s->schedule;
    begin_region(s, region);
    const ticks busiest = s->busiest;
    struct origin last = {0};
    ticks end = 0;
    uint32_t step = 0;
    for (size_t i = 0; i < schedule->count; i++) {
        const struct schedule_move *m = &schedule->moves[i];
        struct origin origin;
        if (m->step != step)
            end_step(s);
        step = m->step;
        const ticks left = move(s, region, m, &origin), there = ticks_add(left, s->hop);
        if (m->to == SCHEDULE_SHADING && left > end) {
            end = left;
            last = origin;
        } else if (m->to != SCHEDULE_SHADING && there > s->next_ready[m->to]) {
            s->next_ready[m->to] = there;
            s->next_origin[m->to] = origin;
        }
    }
    times->begin = last.begin;
    times->end = end;
    times->arrival = ticks_add(end, s->hop);
    times->busy = s->busiest - busiest;
    times->arriving_words = s->arriving_words;
    times->sent_words = s->sent_words;
    times->hold = last.hold;
    times->holder = last.holder;
    for (uint32_t w = 0; w < region->work_count; w++)
        times->released[w] =
            s->released[schedule_rank(s->schedule, region->work[w].node, region->region)];
}
