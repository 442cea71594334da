/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TIMING_H
#define TIMING_H

#include "netsim/machine.h"
#include "netsim/strategy.h"

#include <stdbool.h>
#include <stdint.h>

/* The timing model: a max-plus recurrence over regions and frames that turns the costs of a frame
 * into start and end of everything that happened, exactly (docs/timing.md states the equations).
 * Pure: the same costs give the same times however they were obtained. */

struct timing_region {
    /* Whole words a sample of this region takes on the composition network: the longest map among
     * the candidates; 0 when no node offered a candidate, and the region is a token of one word. */
    uint32_t words;
    ticks shading; /* on its shading node; 0 for a token */
    /* Raster work, at most one entry for each rendering node, by ascending number. */
    const struct timing_work *work;
    uint32_t work_count;
};

struct timing_frame {
    uint64_t geometry_bytes; /* everything the geometry network carries for this frame */
    const struct timing_region *regions; /* in order of transfer */
    uint32_t region_count;
    const uint32_t *shading_node; /* of each region; NULL: region k goes to node k mod s */
};

/* Which resource was busy longest in a frame; ties go to the first listed.
 * X(NAME, name in reports) */
#define TIMING_RESOURCES(X)                                                                        \
    X(COMPOSITION, "composition")                                                                  \
    X(GEOMETRY, "geometry")                                                                        \
    X(RASTER, "raster")                                                                            \
    X(SHADING, "shading")                                                                          \
    X(FRAMEBUFFER, "framebuffer")
enum timing_resource {
#define TIMING_RESOURCE_ENUM(name, text) TIMING_##name,
    TIMING_RESOURCES(TIMING_RESOURCE_ENUM)
#undef TIMING_RESOURCE_ENUM
        TIMING_RESOURCE_COUNT
};
const char *timing_resource_name(enum timing_resource resource);

struct timing_result {
    ticks start; /* the frame's first byte enters the geometry network */
    ticks end;   /* its last colour is in the framebuffer */
    ticks time;  /* end minus the end of the frame before (minus 0 for the first): what a viewer
                    waits */
    ticks composition_busy; /* one link of the composition network; latency of hops is not occupancy
                             */
    /* What the composition network is charged, in whole words: what comes into shading nodes, and
     * all that rendering nodes send (what a strategy passes on among them is there besides). */
    int64_t composition_bytes, composition_sent_bytes;
    ticks geometry_busy;
    ticks framebuffer_busy; /* colours arriving */
    enum timing_resource bound_by;
    /* rendering_nodes and shading_nodes entries, owned by the model, valid until the next frame */
    const ticks *raster_busy, *shading_busy;
};

struct timing_model;
struct timeline;

/* Copies the machine. */
struct timing_model *timing_model_create(const struct machine *machine,
                                         const struct strategy *strategy, uint32_t rendering_nodes,
                                         uint32_t shading_nodes);
void timing_model_destroy(struct timing_model *model);
/* From the first frame on, enters everything that happens in the timeline, with its reason
 * (timeline.h); made for as many nodes as the model, and the caller's. */
void timing_model_record(struct timing_model *model, struct timeline *timeline);
/* Adds the next frame. Fails with STATUS_LIMIT when a time passes 63 bits. */
bool timing_model_add_frame(struct timing_model *model, const struct timing_frame *frame,
                            struct timing_result *result, struct status *status);

#endif
