/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/timeline.h"

#include <assert.h>
#include <stdlib.h>

/* Buffers of a node and who last held them. */
struct buffer_ring {
    uint32_t *holder; /* activity after which it is free; [node * buffers + buffer] */
    ticks *free_at;
    uint32_t *next; /* [node] */
};

struct timeline {
    struct machine machine;
    uint32_t rendering_nodes, shading_nodes, buffers;
    struct timeline_activity *activities;
    size_t count, capacity;
    struct timeline_frame *frames;
    uint32_t frame_count;
    size_t frame_capacity;
    /* the latest activity of each resource */
    uint32_t geometry, transfer, colours, *raster, *shading;
    struct buffer_ring raster_buffers, shading_buffers;
    uint32_t *release; /* ring of frames: the activity after which their buffers were free */
    ticks frame_end;   /* so far, of the frame being entered */
    uint32_t frame_last;
};

const char *timeline_kind_name(int kind) {
    static const char *const names[] = {
#define TIMELINE_KIND_NAME(name, text) text,
        TIMELINE_KINDS(TIMELINE_KIND_NAME)
#undef TIMELINE_KIND_NAME
            "hops"};
    return names[kind];
}

static const char *const wait_names[][2] = {
#define TIMELINE_WAIT_NAME(name, text, key) {text, key},
    TIMELINE_WAITS(TIMELINE_WAIT_NAME)
#undef TIMELINE_WAIT_NAME
};

const char *timeline_wait_name(enum timeline_wait wait) {
    return wait_names[wait][0];
}

const char *timeline_wait_key(enum timeline_wait wait) {
    return wait_names[wait][1];
}

static uint32_t *indices_create(size_t count) {
    uint32_t *indices = memory_get(count, sizeof *indices);
    for (size_t i = 0; i < count; i++)
        indices[i] = TIMELINE_NONE;
    return indices;
}

static struct buffer_ring ring_create(uint32_t nodes, uint32_t buffers) {
    return (struct buffer_ring){indices_create((size_t)nodes * buffers),
                                memory_get((size_t)nodes * buffers, sizeof(ticks)),
                                memory_get(nodes, sizeof(uint32_t))};
}

static void ring_finish(struct buffer_ring *ring) {
    free(ring->holder);
    free(ring->free_at);
    free(ring->next);
}

struct timeline *timeline_create(const struct machine *machine, uint32_t rendering_nodes,
                                 uint32_t shading_nodes) {
    struct timeline *timeline = memory_get(1, sizeof *timeline);
    timeline->machine = *machine;
    timeline->rendering_nodes = rendering_nodes;
    timeline->shading_nodes = shading_nodes;
    timeline->buffers = (uint32_t)machine->composition_region_buffers;
    timeline->geometry = timeline->transfer = timeline->colours = TIMELINE_NONE;
    timeline->raster = indices_create(rendering_nodes);
    timeline->shading = indices_create(shading_nodes);
    timeline->raster_buffers = ring_create(rendering_nodes, timeline->buffers);
    timeline->shading_buffers = ring_create(shading_nodes, timeline->buffers);
    timeline->release = indices_create((size_t)machine->geometry_frame_buffers);
    return timeline;
}

void timeline_destroy(struct timeline *timeline) {
    if (!timeline)
        return;
    free(timeline->activities);
    free(timeline->frames);
    free(timeline->raster);
    free(timeline->shading);
    ring_finish(&timeline->raster_buffers);
    ring_finish(&timeline->shading_buffers);
    free(timeline->release);
    free(timeline);
}

const struct timeline_activity *timeline_activities(const struct timeline *timeline,
                                                    size_t *count) {
    *count = timeline->count;
    return timeline->activities;
}

const struct timeline_frame *timeline_frames(const struct timeline *timeline, uint32_t *count) {
    *count = timeline->frame_count;
    return timeline->frames;
}

uint32_t timeline_resource_count(const struct timeline *timeline) {
    return timeline->rendering_nodes + timeline->shading_nodes + 3;
}

uint32_t timeline_resource_of(const struct timeline *timeline, enum timeline_kind kind,
                              uint32_t node) {
    switch (kind) {
    case TIMELINE_GEOMETRY:
        return 0;
    case TIMELINE_RASTER:
        return 1 + node;
    case TIMELINE_TRANSFER:
        return 1 + timeline->rendering_nodes;
    case TIMELINE_SHADING:
        return 2 + timeline->rendering_nodes + node;
    default:
        return timeline_resource_count(timeline) - 1;
    }
}

/* Enters an activity and returns its number. */
static uint32_t enter(struct timeline *timeline, struct timeline_activity activity) {
    assert(timeline->count < TIMELINE_NONE);
    activity.frame = timeline->frame_count;
    timeline->activities = memory_grow(timeline->activities, &timeline->capacity,
                                       timeline->count + 1, sizeof *timeline->activities);
    timeline->activities[timeline->count] = activity;
    return (uint32_t)timeline->count++;
}

static bool ends_at(const struct timeline *timeline, uint32_t activity, ticks time) {
    return activity != TIMELINE_NONE && timeline->activities[activity].end == time;
}

void timeline_begin_frame(struct timeline *timeline, ticks begin, ticks end) {
    struct timeline_activity activity = {.kind = TIMELINE_GEOMETRY, .begin = begin, .end = end};
    const uint32_t ring =
        timeline->frame_count % (uint32_t)timeline->machine.geometry_frame_buffers;
    const bool follows = !begin || ends_at(timeline, timeline->geometry, begin);
    activity.wait = follows ? TIMELINE_WAIT_NOTHING : TIMELINE_WAIT_FRAME_BUFFER;
    activity.cause = follows ? timeline->geometry : timeline->release[ring];
    assert(follows || ends_at(timeline, activity.cause, begin));
    timeline->geometry = enter(timeline, activity);
    timeline->frame_end = end;
    timeline->frame_last = timeline->geometry;
}

/* Raster of the region on the node of work entry w. */
static void add_raster(struct timeline *timeline, const struct strategy_region *region,
                       uint32_t w) {
    const uint32_t i = region->work[w].node;
    const struct machine *machine = &timeline->machine;
    const ticks cost = ticks_add(machine->raster_region, ticks_multiply(machine->raster_triangle,
                                                                        region->work[w].triangles));
    const size_t slot = (size_t)i * timeline->buffers + timeline->raster_buffers.next[i];
    struct timeline_activity activity = {.kind = TIMELINE_RASTER,
                                         .node = i,
                                         .region = region->region,
                                         .begin = region->ready[w] - cost,
                                         .end = region->ready[w]};
    if (ends_at(timeline, timeline->raster[i], activity.begin)) {
        activity.wait = TIMELINE_WAIT_NOTHING;
        activity.cause = timeline->raster[i];
    } else if (timeline->raster_buffers.holder[slot] != TIMELINE_NONE &&
               timeline->raster_buffers.free_at[slot] == activity.begin) {
        activity.wait = TIMELINE_WAIT_REGION_BUFFER;
        activity.cause = timeline->raster_buffers.holder[slot];
    } else {
        assert(ends_at(timeline, timeline->geometry, activity.begin));
        activity.wait = TIMELINE_WAIT_GEOMETRY;
        activity.cause = timeline->geometry;
    }
    timeline->raster[i] = enter(timeline, activity);
}

static void add_transfer(struct timeline *timeline, const struct timeline_region *region) {
    const struct strategy_region *composed = region->composed;
    const struct strategy_times *times = region->times;
    const uint32_t j = composed->shading_node;
    struct timeline_activity activity = {.kind = TIMELINE_TRANSFER,
                                         .node = j,
                                         .region = composed->region,
                                         .begin = times->begin,
                                         .end = times->end};
    switch (times->hold) {
    case STRATEGY_HELD_BY_LINK:
        activity.wait = TIMELINE_WAIT_NOTHING;
        activity.cause = timeline->transfer;
        break;
    case STRATEGY_HELD_BY_GEOMETRY:
        activity.wait = TIMELINE_WAIT_GEOMETRY;
        activity.cause = timeline->geometry;
        break;
    case STRATEGY_HELD_BY_RASTER:
        assert(times->holder < composed->work_count);
        activity.wait = TIMELINE_WAIT_RASTER;
        activity.cause = timeline->raster[composed->work[times->holder].node];
        break;
    case STRATEGY_HELD_BY_ROOM:
        activity.wait = TIMELINE_WAIT_REGION_BUFFER;
        activity.cause =
            timeline->shading_buffers
                .holder[(size_t)j * timeline->buffers + timeline->shading_buffers.next[j]];
        break;
    }
    timeline->transfer = enter(timeline, activity);
    struct buffer_ring *ring = &timeline->raster_buffers;
    for (uint32_t w = 0; w < composed->work_count; w++) {
        const uint32_t i = composed->work[w].node;
        const size_t slot = (size_t)i * timeline->buffers + ring->next[i];
        ring->holder[slot] = timeline->transfer;
        ring->free_at[slot] = times->released[w];
        ring->next[i] = (ring->next[i] + 1) % timeline->buffers;
    }
}

static void add_shading(struct timeline *timeline, const struct timeline_region *region) {
    const uint32_t j = region->composed->shading_node, k = region->composed->region;
    const bool is_behind = ends_at(timeline, timeline->shading[j], region->shading_begin);
    timeline->shading[j] =
        enter(timeline, (struct timeline_activity){
                            .kind = TIMELINE_SHADING,
                            .wait = is_behind ? TIMELINE_WAIT_NOTHING : TIMELINE_WAIT_UPSTREAM,
                            .cause = is_behind ? timeline->shading[j] : timeline->transfer,
                            .node = j,
                            .region = k,
                            .begin = region->shading_begin,
                            .end = region->shading_end});
    const bool is_queued = ends_at(timeline, timeline->colours, region->colour_begin);
    timeline->colours =
        enter(timeline, (struct timeline_activity){
                            .kind = TIMELINE_COLOURS,
                            .wait = is_queued ? TIMELINE_WAIT_NOTHING : TIMELINE_WAIT_SHADING,
                            .cause = is_queued ? timeline->colours : timeline->shading[j],
                            .node = j,
                            .region = k,
                            .begin = region->colour_begin,
                            .end = region->end});
    struct buffer_ring *ring = &timeline->shading_buffers;
    ring->holder[(size_t)j * timeline->buffers + ring->next[j]] = timeline->colours;
    ring->next[j] = (ring->next[j] + 1) % timeline->buffers;
}

void timeline_add_region(struct timeline *timeline, const struct timeline_region *region) {
    for (uint32_t w = 0; w < region->composed->work_count; w++)
        add_raster(timeline, region->composed, w);
    add_transfer(timeline, region);
    uint32_t last = timeline->transfer;
    if (region->composed->words) {
        add_shading(timeline, region);
        last = timeline->colours;
    }
    if (region->end > timeline->frame_end) {
        timeline->frame_end = region->end;
        timeline->frame_last = last;
    }
}

void timeline_end_frame(struct timeline *timeline, ticks end) {
    uint32_t release = timeline->geometry;
    for (uint32_t i = 0; i < timeline->rendering_nodes; i++)
        if (timeline->raster[i] != TIMELINE_NONE &&
            timeline->activities[timeline->raster[i]].end > timeline->activities[release].end)
            release = timeline->raster[i];
    timeline->release[timeline->frame_count % (uint32_t)timeline->machine.geometry_frame_buffers] =
        release;
    const ticks begin = timeline->frame_count ? timeline->frames[timeline->frame_count - 1].end : 0;
    timeline->frames = memory_grow(timeline->frames, &timeline->frame_capacity,
                                   timeline->frame_count + 1, sizeof *timeline->frames);
    timeline->frames[timeline->frame_count++] =
        (struct timeline_frame){begin, end, end > begin ? timeline->frame_last : TIMELINE_NONE};
}
