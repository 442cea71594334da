/* SPDX-License-Identifier: Apache-2.0 */
#ifndef WHAT_IF_H
#define WHAT_IF_H

#include "netsim/record.h"
#include "netsim/timeline.h"
#include "netsim/timing.h"

/* What a recorded run would have taken on another cluster: the record's costs, distributed and
 * priced anew, through the timing model. With the record's own machine and seed and the defaults
 * below the times are those of a live run with as many nodes, to the tick. */

/* Which shading node gets a region. X(NAME, name in options) */
#define WHAT_IF_ASSIGNMENTS(X)                                                                     \
    X(ROUND_ROBIN, "round-robin") /* region k to node k mod s */                                   \
    X(BY_COST, "by-cost") /* in order, to the node with the least shading so far in the frame */
enum what_if_assignment {
#define WHAT_IF_ASSIGNMENT_ENUM(name, text) WHAT_IF_##name,
    WHAT_IF_ASSIGNMENTS(WHAT_IF_ASSIGNMENT_ENUM)
#undef WHAT_IF_ASSIGNMENT_ENUM
        WHAT_IF_ASSIGNMENT_COUNT
};

/* X(NAME, name in options): which versions of the mathematical functions are priced */
#define WHAT_IF_MATHS(X)                                                                           \
    X(AS_RECORDED, "recorded")                                                                     \
    X(EXACT, "exact")                                                                              \
    X(FAST, "fast")
enum what_if_math {
#define WHAT_IF_MATH_ENUM(name, text) WHAT_IF_MATH_##name,
    WHAT_IF_MATHS(WHAT_IF_MATH_ENUM)
#undef WHAT_IF_MATH_ENUM
        WHAT_IF_MATH_COUNT
};

/* What travels with each sample instead of the map of its shader instance alone; may be combined.
 */
enum what_if_maps {
    WHAT_IF_MAPS_SPECIFIC = 0,
    WHAT_IF_MAPS_UNION = 1,    /* one map for all: every parameter of every instance of the frame */
    WHAT_IF_MAPS_UNBOUND = 2,  /* nothing is bound: bound parameters travel too, with the vertices
                                  and with the samples */
    WHAT_IF_MAPS_POSITION = 4, /* the surface position travels and is not rebuilt from depth */
};

/* A material parameter bound to an instance instead: it leaves the map, travels once a frame, and
 * is loaded into the pixels a region at a time. What the shader saves when it turns uniform by that
 * is not counted. */
struct what_if_bind {
    const char *instance, *parameter;
};

struct what_if {
    struct machine machine;
    const struct strategy *strategy;
    uint32_t rendering_nodes, shading_nodes;
    uint64_t seed;
    uint32_t chunk_triangles; /* of a chunk, at most: the record's number or a multiple of it; 0:
                                 chunks as recorded */
    enum what_if_assignment assignment;
    const struct run_record *costs; /* assignment by what regions cost there; NULL: by what they
                                       cost here, under this question */
    enum what_if_math math;
    uint32_t maps; /* enum what_if_maps */
    const struct what_if_bind *binds;
    size_t bind_count;
};
/* As recorded, on one node of each kind. */
struct what_if what_if_default(const struct run_record *record);

struct what_if_frame {
    struct timing_result times;
    ticks raster_longest, shading_longest; /* busy time of the busiest node */
    uint64_t geometry_bytes;
    uint32_t regions_covered;
};

struct what_if_result {
    ticks end;                     /* of the last frame: all frames together */
    enum timing_resource bound_by; /* busy longest over all frames */
    struct what_if_frame *frames;  /* the solver's, until its next solve; without the arrays of
                                      node times */
    uint32_t frame_count;
};

/* Holds what solutions of one record can share. The record must outlive it. */
struct what_if_solver;
struct what_if_solver *what_if_solver_create(const struct run_record *record);
void what_if_solver_destroy(struct what_if_solver *solver);
/* `timeline`, when not NULL, is given everything that happens. Fails with STATUS_INVALID when the
 * machine has other regions than the record or chunks cannot be put together from its, with
 * STATUS_LIMIT when a time passes 63 bits. */
bool what_if_solve(struct what_if_solver *solver, const struct what_if *question,
                   struct timeline *timeline, struct what_if_result *result, struct status *status);

/* By cost: the shading node of each region of frame f (from 0; past the last, as the last) of a
 * record, priced on `machine`. */
enum { WHAT_IF_ASSIGNMENT_BYTES = 2 }; /* of a region, on the geometry network (ours) */
void what_if_assign(const struct run_record *record, uint32_t f, const struct machine *machine,
                    uint32_t shading_nodes, uint32_t *node);
/* Can a frame of so many regions of this machine be assigned by it? */
bool what_if_can_assign(const struct run_record *record, uint32_t f, const struct machine *machine,
                        uint32_t region_count, struct status *status);

/* Bytes that travel with each sample of instance i (from 0) of a frame under these maps, the shader
 * ID aside. */
uint32_t what_if_map_bytes(const struct record_frame *frame, uint32_t instance,
                           const struct what_if *question);
/* Shading of one instance (from 0) in the region where it takes longest, without lights and
 * position. */
ticks what_if_longest_shading(const struct record_frame *frame, uint32_t instance,
                              const struct what_if *question);
/* Shading of one region, all shaders present. */
ticks what_if_shading(const struct record_frame *frame, const struct record_region *region,
                      const struct what_if *question);

#endif
