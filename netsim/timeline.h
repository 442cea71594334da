/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TIMELINE_H
#define TIMELINE_H

#include "netsim/strategy.h"

/* What the timing model solved, as a list of activities with the reason for each begin: which
 * earlier activity it had to wait for. From it follow the idle time of every resource with its
 * reason, and the critical path of a frame. Entered by the model (timing_model_record); costs
 * memory for every activity, so only for those who ask. */

/* X(NAME, name in reports): an activity of one serial resource */
#define TIMELINE_KINDS(X)                                                                          \
    X(GEOMETRY, "geometry") /* a frame over the geometry network */                                \
    X(RASTER, "raster")     /* a region on a rendering node */                                     \
    X(TRANSFER, "transfer") /* a region over the composition network */                            \
    X(SHADING, "shading")   /* a region on a shading node */                                       \
    X(COLOURS, "colours")   /* of a region into the framebuffer */
enum timeline_kind {
#define TIMELINE_KIND_ENUM(name, text) TIMELINE_##name,
    TIMELINE_KINDS(TIMELINE_KIND_ENUM)
#undef TIMELINE_KIND_ENUM
        TIMELINE_KIND_COUNT,
    TIMELINE_HOPS = TIMELINE_KIND_COUNT /* of a critical path: on the way between two nodes */
};

/* X(NAME, what the resource waited for before the activity, key in JSON) */
#define TIMELINE_WAITS(X)                                                                          \
    X(NOTHING, "nothing", "nothing")    /* busy until then with its activity before */             \
    X(GEOMETRY, "geometry", "geometry") /* primitives still on the geometry network */             \
    X(FRAME_BUFFER, "a frame buffer", "frame_buffer")                                              \
    X(REGION_BUFFER, "a region buffer", "region_buffer")                                           \
    X(RASTER, "raster", "raster")       /* of a rendering node */                                  \
    X(UPSTREAM, "upstream", "upstream") /* the region on its way over the network */               \
    X(SHADING, "shading", "shading")                                                               \
    X(NO_WORK, "no more work", "no_work") /* the resource has nothing left to do */
enum timeline_wait {
#define TIMELINE_WAIT_ENUM(name, text, key) TIMELINE_WAIT_##name,
    TIMELINE_WAITS(TIMELINE_WAIT_ENUM)
#undef TIMELINE_WAIT_ENUM
        TIMELINE_WAIT_COUNT
};
const char *timeline_kind_name(int kind); /* TIMELINE_HOPS too */
const char *timeline_wait_name(enum timeline_wait wait);
const char *timeline_wait_key(enum timeline_wait wait);

#define TIMELINE_NONE UINT32_MAX

struct timeline_activity {
    uint8_t kind, wait;
    uint32_t node; /* rendering or shading node; of a transfer its shading node */
    uint32_t frame, region;
    ticks begin, end;
    /* The activity that let this one begin; what lies between its end and this begin are hops of
     * the network, counted back where a transfer begins before the node that it reaches last is
     * ready. TIMELINE_NONE: the beginning of time. */
    uint32_t cause;
};

struct timeline_frame {
    ticks begin, end; /* from the end of the frame before to its own */
    uint32_t last;    /* the activity that ended it; TIMELINE_NONE: the end of the frame before */
};

struct timeline;
struct timeline *timeline_create(const struct machine *machine, uint32_t rendering_nodes,
                                 uint32_t shading_nodes);
void timeline_destroy(struct timeline *timeline);
/* What was entered; belongs to the timeline. */
const struct timeline_activity *timeline_activities(const struct timeline *timeline, size_t *count);
const struct timeline_frame *timeline_frames(const struct timeline *timeline, uint32_t *count);

/* The critical path of a frame: steps that follow one another without a gap from the end of the
 * frame before to its own end, so that their durations add up to the frame time exactly. */
struct timeline_step {
    int kind; /* enum timeline_kind, or TIMELINE_HOPS */
    uint32_t node, frame, region;
    ticks begin, end; /* hops may count back, by no more than the chain is long */
};
/* The array is the caller's. */
struct timeline_step *timeline_critical_path(const struct timeline *timeline, uint32_t frame,
                                             size_t *count);

/* How a resource spent the time of one frame: busy and idle by reason, which add up to it. */
struct timeline_use {
    ticks busy;
    ticks idle[TIMELINE_WAIT_COUNT];
};
/* Resources in this order: geometry network, rendering nodes, composition network, shading nodes,
 * framebuffer. */
uint32_t timeline_resource_count(const struct timeline *timeline);
uint32_t timeline_resource_of(const struct timeline *timeline, enum timeline_kind kind,
                              uint32_t node);
/* All frames, [frame * timeline_resource_count() + resource]; the caller's. */
struct timeline_use *timeline_uses(const struct timeline *timeline);

/* For the timing model. */
struct timeline_region {
    const struct strategy_region *composed;
    const struct strategy_times *times;
    ticks shading_begin, shading_end, colour_begin; /* not for a token */
    ticks end; /* colours, or the token, are in the framebuffer */
};
void timeline_begin_frame(struct timeline *timeline, ticks begin, ticks end);
void timeline_add_region(struct timeline *timeline, const struct timeline_region *region);
void timeline_end_frame(struct timeline *timeline, ticks end);

#endif
