/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/timeline.h"

#include <stdlib.h>

/* Critical path and use of resources, read off a finished timeline. */

struct path {
    struct timeline_step *steps;
    size_t count, capacity;
    ticks at; /* end of the last step */
};

/* Appends a step from where the path is; none of no length. */
static void path_add(struct path *path, int kind, const struct timeline_activity *activity,
                     ticks duration) {
    if (!duration)
        return;
    path->steps = memory_grow(path->steps, &path->capacity, path->count + 1, sizeof *path->steps);
    path->steps[path->count++] = (struct timeline_step){
        kind, activity->node, activity->frame, activity->region, path->at, path->at + duration};
    path->at += duration;
}

struct timeline_step *timeline_critical_path(const struct timeline *timeline, uint32_t frame,
                                             size_t *count) {
    size_t activity_count;
    uint32_t frame_count, *chain = NULL;
    const struct timeline_activity *all = timeline_activities(timeline, &activity_count);
    const struct timeline_frame window = timeline_frames(timeline, &frame_count)[frame];
    size_t length = 0, capacity = 0;
    for (uint32_t a = window.last; a != TIMELINE_NONE; a = all[a].cause) {
        chain = memory_grow(chain, &capacity, length + 1, sizeof *chain);
        chain[length++] = a;
        if (all[a].begin <= window.begin)
            break;
    }
    /* Forward again. A transfer is noted at its first sender, which begins some hops before the
     * node that was late is ready: seen from that node, it and what follows it without a gap come
     * so much later. So where the next activity's begin lies before the end of the path, the path
     * just goes on; hops appear where it lies behind. */
    struct path path = {.at = window.begin};
    for (size_t i = length; i-- > 0;) {
        const struct timeline_activity *activity = &all[chain[i]];
        ticks duration = activity->end - activity->begin;
        if (activity->begin > path.at)
            path_add(&path, TIMELINE_HOPS, activity, activity->begin - path.at);
        else if (i == length - 1) /* began in the frame before */
            duration = ticks_max(activity->end - window.begin, 0);
        path_add(&path, activity->kind, activity, duration);
    }
    if (length)
        path_add(&path, TIMELINE_HOPS, &all[chain[0]], window.end - path.at);
    free(chain);
    *count = path.count;
    return path.steps;
}

/* Where one resource is on its way through the frames. */
struct cursor {
    ticks free_at;
    uint32_t frame;
};

/* Adds what of [begin, end) falls into each frame to *(ticks *)((char *)use + offset). */
static void spread(struct timeline_use *uses, size_t resources, size_t resource,
                   const struct timeline_frame *frames, uint32_t frame_count, struct cursor *cursor,
                   ticks begin, ticks end, int wait) {
    while (cursor->frame < frame_count && frames[cursor->frame].end <= begin)
        cursor->frame++;
    for (uint32_t f = cursor->frame; f < frame_count && frames[f].begin < end; f++) {
        const ticks from = ticks_max(begin, frames[f].begin),
                    to = end < frames[f].end ? end : frames[f].end;
        struct timeline_use *use = &uses[f * resources + resource];
        if (to > from)
            *(wait < 0 ? &use->busy : &use->idle[wait]) += to - from;
    }
}

struct timeline_use *timeline_uses(const struct timeline *timeline) {
    size_t count;
    uint32_t frame_count;
    const struct timeline_activity *all = timeline_activities(timeline, &count);
    const struct timeline_frame *frames = timeline_frames(timeline, &frame_count);
    const size_t resources = timeline_resource_count(timeline);
    struct timeline_use *uses = memory_get(frame_count * resources, sizeof *uses);
    struct cursor *cursors = memory_get(resources, sizeof *cursors);
    for (size_t a = 0; a < count; a++) {
        const size_t resource =
            timeline_resource_of(timeline, (enum timeline_kind)all[a].kind, all[a].node);
        struct cursor *cursor = &cursors[resource];
        spread(uses, resources, resource, frames, frame_count, cursor, cursor->free_at,
               all[a].begin, all[a].wait);
        spread(uses, resources, resource, frames, frame_count, cursor,
               ticks_max(all[a].begin, cursor->free_at), all[a].end, -1);
        cursor->free_at = ticks_max(cursor->free_at, all[a].end);
    }
    const ticks last = frame_count ? frames[frame_count - 1].end : 0;
    for (size_t resource = 0; resource < resources; resource++)
        spread(uses, resources, resource, frames, frame_count, &cursors[resource],
               cursors[resource].free_at, last, TIMELINE_WAIT_NO_WORK);
    free(cursors);
    return uses;
}
