/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/netsim/event_simulation.h"

#include <assert.h>
#include <stdlib.h>

enum event_kind {
    GEOMETRY_SENT, /* a frame's last word left the geometry network */
    RASTER_DONE,   /* a node has rastered a region */
    TRANSFER_DONE, /* a region's last word left the first node */
    REGION_HERE,   /* ... reached its shading node */
    SHADING_DONE,
    COLOURS_BEGIN, /* reach the framebuffer */
    COLOURS_DONE,
};

struct event {
    ticks at;
    uint64_t sequence; /* equal times: first scheduled, first served */
    enum event_kind kind;
    int node, frame, region;
};

enum { REGIONS_ALL = CASE_FRAMES * CASE_REGIONS_MAX, CREDITS_MAX = REGIONS_ALL + 8 };

/* Times at which tokens become available, first in, first out. */
struct tokens {
    ticks at[CREDITS_MAX];
    int first, count;
};

struct rendering_agent {
    int job; /* number of the region it is at, through all frames; its work there may be none */
    bool is_busy;
    ticks free_since;
    struct tokens credits;
    ticks geometry[CASE_FRAMES];
    int geometry_frames; /* received */
};

struct shading_agent {
    bool is_busy;
    ticks free_since;
    struct tokens credits, queue; /* queue: arrivals */
    int waiting[REGIONS_ALL], waiting_first, waiting_count;
};

struct simulation {
    const struct timing_case *c;
    struct event heap[4096];
    int heap_count;
    uint64_t sequence;
    struct rendering_agent rendering[CASE_NODES_MAX];
    struct shading_agent shading[CASE_NODES_MAX];
    /* geometry network */
    int geometry_next;
    bool geometry_is_busy;
    ticks geometry_free_since;
    struct tokens frame_credits;
    int reports[CASE_FRAMES]; /* who is through with the frame's primitives */
    ticks report_latest[CASE_FRAMES];
    /* the chain */
    int transfer; /* number of the region it is at */
    bool link_is_busy;
    ticks link_free_since;
    int ready_count[REGIONS_ALL];    /* nodes with work that have it rastered */
    ticks ready_latest[REGIONS_ALL]; /* as seen from the first node: less the hops in between */
    ticks geometry_at_head[CASE_FRAMES];
    /* framebuffer */
    int colour_turn; /* the region whose colours come next */
    bool framebuffer_is_busy;
    ticks framebuffer_free_since;
    ticks colours_here[REGIONS_ALL]; /* -1: not yet */
    int done[CASE_FRAMES];
    ticks latest[CASE_FRAMES];
};

static void put_token(struct tokens *tokens, ticks at) {
    assert(tokens->first + tokens->count < CREDITS_MAX);
    tokens->at[tokens->first + tokens->count++] = at;
}

static ticks take_token(struct tokens *tokens) {
    assert(tokens->count);
    tokens->count--;
    return tokens->at[tokens->first++];
}

static bool is_before(const struct event *a, const struct event *b) {
    return a->at != b->at ? a->at < b->at : a->sequence < b->sequence;
}

static void schedule(struct simulation *s, struct event event) {
    int at = s->heap_count++;
    event.sequence = s->sequence++;
    for (; at && is_before(&event, &s->heap[(at - 1) / 2]); at = (at - 1) / 2)
        s->heap[at] = s->heap[(at - 1) / 2];
    s->heap[at] = event;
}

static struct event next_event(struct simulation *s) {
    const struct event first = s->heap[0], last = s->heap[--s->heap_count];
    int at = 0;
    for (int child; (child = 2 * at + 1) < s->heap_count; at = child) {
        child += child + 1 < s->heap_count && is_before(&s->heap[child + 1], &s->heap[child]);
        if (is_before(&last, &s->heap[child]))
            break;
        s->heap[at] = s->heap[child];
    }
    s->heap[at] = last;
    return first;
}

static ticks later(ticks a, ticks b) {
    return a > b ? a : b;
}

static int region_total(const struct simulation *s) {
    return CASE_FRAMES * (int)s->c->regions_per_frame;
}

static const struct timing_region *region_at(const struct simulation *s, int n) {
    return &s->c->regions[n / (int)s->c->regions_per_frame][n % (int)s->c->regions_per_frame];
}

static int frame_at(const struct simulation *s, int n) {
    return n / (int)s->c->regions_per_frame;
}

static int home_of(const struct simulation *s, int n) {
    const int k = n % (int)s->c->regions_per_frame;
    return s->c->is_assigned ? (int)s->c->shading_node[frame_at(s, n)][k]
                             : k % (int)s->c->shading_nodes;
}

/* Triangles of node i in a region, -1 when it has no work there. */
static int64_t triangles_of(const struct simulation *s, int n, int i) {
    const struct timing_region *region = region_at(s, n);
    for (uint32_t w = 0; w < region->work_count; w++)
        if ((int)region->work[w].node == i)
            return region->work[w].triangles;
    return -1;
}

/* --- geometry network: sends a frame when a frame buffer is free on every node --- */

static void start_geometry(struct simulation *s) {
    const int f = s->geometry_next;
    if (s->geometry_is_busy || f == CASE_FRAMES || !s->frame_credits.count)
        return;
    const ticks begin = later(s->geometry_free_since, take_token(&s->frame_credits));
    const ticks words = (ticks)((s->c->geometry_bytes[f] + 3) / 4);
    s->geometry_is_busy = true;
    s->geometry_next++;
    schedule(s, (struct event){.at = begin + words * s->c->machine.geometry_word,
                               .kind = GEOMETRY_SENT,
                               .frame = f});
}

/* A node (or the network itself) is through with the primitives of a frame. */
static void report_frame(struct simulation *s, int f, ticks at) {
    s->report_latest[f] = later(s->report_latest[f], at);
    if (++s->reports[f] == (int)s->c->rendering_nodes + 1) {
        put_token(&s->frame_credits, s->report_latest[f]);
        start_geometry(s);
    }
}

/* --- rendering nodes --- */

/* Goes on to the node's next region with work, reporting the frames it leaves behind. */
static void skip_regions_without_work(struct simulation *s, int i) {
    struct rendering_agent *node = &s->rendering[i];
    while (node->job < region_total(s) && triangles_of(s, node->job, i) < 0) {
        if (frame_at(s, node->job) >= node->geometry_frames)
            return; /* not yet known what is in it */
        node->job++;
        if (node->job % (int)s->c->regions_per_frame == 0)
            report_frame(s, frame_at(s, node->job - 1), node->free_since);
    }
}

static void start_raster(struct simulation *s, int i) {
    struct rendering_agent *node = &s->rendering[i];
    if (node->is_busy)
        return;
    skip_regions_without_work(s, i);
    if (node->job == region_total(s) || frame_at(s, node->job) >= node->geometry_frames ||
        !node->credits.count)
        return;
    ticks begin = later(node->free_since, take_token(&node->credits));
    begin = later(begin, node->geometry[frame_at(s, node->job)]);
    const ticks cost =
        s->c->machine.raster_region + triangles_of(s, node->job, i) * s->c->machine.raster_triangle;
    node->is_busy = true;
    schedule(
        s, (struct event){.at = begin + cost, .kind = RASTER_DONE, .node = i, .region = node->job});
}

/* --- the chain: moves the next region when every node that has some of it will be ready as the
 * transfer passes, and its shading node has room --- */

static void start_transfer(struct simulation *s) {
    const int n = s->transfer;
    const struct machine *m = &s->c->machine;
    if (s->link_is_busy || n == region_total(s) ||
        s->rendering[0].geometry_frames <= frame_at(s, n))
        return;
    const struct timing_region *region = region_at(s, n);
    struct tokens *credits = &s->shading[home_of(s, n)].credits;
    if (s->ready_count[n] < (int)region->work_count || (region->words && !credits->count))
        return;
    ticks begin = later(s->link_free_since, s->geometry_at_head[frame_at(s, n)]);
    begin = later(begin, s->ready_latest[n]);
    if (region->words)
        begin =
            later(begin, take_token(credits) -
                             m->composition_hop * ((ticks)s->c->rendering_nodes + home_of(s, n)));
    const ticks length = region->words ? m->composition_word * m->region_width * m->region_height *
                                             (ticks)region->words
                                       : m->composition_word;
    s->link_is_busy = true;
    s->transfer++;
    schedule(s, (struct event){.at = begin + length, .kind = TRANSFER_DONE, .region = n});
}

static void transfer_done(struct simulation *s, int n, ticks at) {
    const ticks hop = s->c->machine.composition_hop;
    const struct timing_region *region = region_at(s, n);
    const int j = home_of(s, n);
    s->link_is_busy = false;
    s->link_free_since = at;
    for (uint32_t w = 0; w < region->work_count; w++) {
        const int i = (int)region->work[w].node;
        put_token(&s->rendering[i].credits, at + hop * i);
        start_raster(s, i);
    }
    const ticks here = at + hop * ((ticks)s->c->rendering_nodes + j);
    if (region->words) {
        schedule(s, (struct event){.at = here, .kind = REGION_HERE, .node = j, .region = n});
    } else {
        const int f = frame_at(s, n);
        s->latest[f] = later(s->latest[f], here + hop * ((ticks)s->c->shading_nodes - j));
        s->done[f]++;
    }
    start_transfer(s);
}

/* --- shading nodes --- */

static void start_shading(struct simulation *s, int j) {
    struct shading_agent *node = &s->shading[j];
    if (node->is_busy || !node->waiting_count)
        return;
    const int n = node->waiting[node->waiting_first++];
    node->waiting_count--;
    node->is_busy = true;
    schedule(s, (struct event){.at = later(node->free_since, take_token(&node->queue)) +
                                     region_at(s, n)->shading,
                               .kind = SHADING_DONE,
                               .node = j,
                               .region = n});
}

/* --- framebuffer: takes colours in the order of regions --- */

static void start_colours(struct simulation *s) {
    const struct machine *m = &s->c->machine;
    while (s->colour_turn < region_total(s) && !region_at(s, s->colour_turn)->words)
        s->colour_turn++;
    if (s->framebuffer_is_busy || s->colour_turn == region_total(s) ||
        s->colours_here[s->colour_turn] < 0)
        return;
    const int n = s->colour_turn++;
    s->framebuffer_is_busy = true;
    schedule(s, (struct event){.at = later(s->framebuffer_free_since, s->colours_here[n]) +
                                     m->composition_word * m->region_width * m->region_height *
                                         m->colour_words,
                               .kind = COLOURS_DONE,
                               .node = home_of(s, n),
                               .region = n});
}

static void handle(struct simulation *s, const struct event *event) {
    const ticks hop = s->c->machine.composition_hop;
    const int n = event->region, i = event->node;
    const ticks way = hop * ((ticks)s->c->shading_nodes - i);
    switch (event->kind) {
    case GEOMETRY_SENT:
        s->geometry_is_busy = false;
        s->geometry_free_since = event->at;
        s->geometry_at_head[event->frame] = event->at;
        s->latest[event->frame] = event->at;
        for (uint32_t node = 0; node < s->c->rendering_nodes; node++)
            s->rendering[node].geometry[s->rendering[node].geometry_frames++] = event->at;
        report_frame(s, event->frame, event->at);
        for (uint32_t node = 0; node < s->c->rendering_nodes; node++)
            start_raster(s, (int)node);
        start_transfer(s);
        start_geometry(s);
        break;
    case RASTER_DONE:
        s->rendering[i].is_busy = false;
        s->rendering[i].free_since = event->at;
        s->ready_count[n]++;
        s->ready_latest[n] = later(s->ready_latest[n], event->at - hop * i);
        s->rendering[i].job++;
        if (s->rendering[i].job % (int)s->c->regions_per_frame == 0)
            report_frame(s, frame_at(s, n), event->at);
        start_raster(s, i);
        start_transfer(s);
        break;
    case TRANSFER_DONE:
        transfer_done(s, n, event->at);
        break;
    case REGION_HERE:
        put_token(&s->shading[i].queue, event->at);
        s->shading[i].waiting[s->shading[i].waiting_first + s->shading[i].waiting_count++] = n;
        start_shading(s, i);
        break;
    case SHADING_DONE:
        s->shading[i].is_busy = false;
        s->shading[i].free_since = event->at;
        schedule(s, (struct event){
                        .at = event->at + way, .kind = COLOURS_BEGIN, .node = i, .region = n});
        start_shading(s, i);
        break;
    case COLOURS_BEGIN:
        s->colours_here[n] = event->at;
        start_colours(s);
        break;
    case COLOURS_DONE:
        s->framebuffer_is_busy = false;
        s->framebuffer_free_since = event->at;
        s->latest[frame_at(s, n)] = later(s->latest[frame_at(s, n)], event->at);
        s->done[frame_at(s, n)]++;
        put_token(&s->shading[i].credits, event->at - way);
        start_transfer(s);
        start_colours(s);
        break;
    }
}

void simulate_events(const struct timing_case *timing_case, ticks frame_end[CASE_FRAMES]) {
    struct simulation *s = memory_get(1, sizeof *s);
    s->c = timing_case;
    for (int n = 0; n < REGIONS_ALL; n++)
        s->colours_here[n] = s->ready_latest[n] = -1;
    for (int b = 0; b < timing_case->machine.composition_region_buffers; b++) {
        for (uint32_t i = 0; i < timing_case->rendering_nodes; i++)
            put_token(&s->rendering[i].credits, 0);
        for (uint32_t j = 0; j < timing_case->shading_nodes; j++)
            put_token(&s->shading[j].credits, 0);
    }
    for (int b = 0; b < timing_case->machine.geometry_frame_buffers; b++)
        put_token(&s->frame_credits, 0);
    start_geometry(s);
    while (s->heap_count) {
        const struct event event = next_event(s);
        handle(s, &event);
    }
    for (int f = 0; f < CASE_FRAMES; f++) {
        assert(s->done[f] == (int)timing_case->regions_per_frame);
        frame_end[f] = f ? later(s->latest[f], frame_end[f - 1]) : s->latest[f];
    }
    free(s);
}
