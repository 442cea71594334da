/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TIMING_CASES_H
#define TIMING_CASES_H

#include "base/rng.h"
#include "netsim/timing.h"

#include <string.h>

/* Random machines and workloads for the tests of the timing model. */

enum { CASE_FRAMES = 3, CASE_REGIONS_MAX = 12, CASE_NODES_MAX = 9 };

/* What a test allows of them. */
struct timing_limits {
    uint32_t regions, rendering_nodes, shading_nodes;
};

struct timing_case {
    struct machine machine;
    struct timing_region regions[CASE_FRAMES][CASE_REGIONS_MAX];
    struct timing_work work[CASE_FRAMES][CASE_REGIONS_MAX][CASE_NODES_MAX];
    uint64_t geometry_bytes[CASE_FRAMES];
    uint32_t shading_node[CASE_FRAMES][CASE_REGIONS_MAX];
    bool is_assigned; /* by shading_node, instead of k mod s */
    uint32_t regions_per_frame, rendering_nodes, shading_nodes;
};

static inline struct machine random_case_machine(struct rng *rng) {
    struct machine m = {.region_width = 128,
                        .region_height = 64,
                        .composition_word_bytes = 32,
                        .composition_depth_bytes = 4,
                        .composition_shader_id_bytes = 2,
                        .geometry_word_bytes = 4};
    m.rate.per_s = 1000000000;
    m.composition_word = 1 + (ticks)rng_below(rng, 5);
    m.composition_hop = rng_below(rng, 4) ? (ticks)rng_below(rng, 3000) : 0;
    m.geometry_word = 1 + (ticks)rng_below(rng, 5);
    m.raster_triangle = (ticks)rng_below(rng, 400);
    m.raster_region = (ticks)rng_below(rng, 400);
    m.colour_words = 1 + (int64_t)rng_below(rng, 2);
    m.composition_region_buffers = 1 + (int64_t)rng_below(rng, 3);
    m.geometry_frame_buffers = 1 + (int64_t)rng_below(rng, 3);
    return m;
}

static inline void random_case(struct rng *rng, struct timing_limits limits,
                               struct timing_case *c) {
    memset(c, 0, sizeof *c);
    c->machine = random_case_machine(rng);
    c->regions_per_frame = 1 + (uint32_t)rng_below(rng, limits.regions);
    c->rendering_nodes = 1 + (uint32_t)rng_below(rng, limits.rendering_nodes);
    c->shading_nodes = 1 + (uint32_t)rng_below(rng, limits.shading_nodes);
    c->is_assigned = rng_below(rng, 3) == 0;
    for (int f = 0; f < CASE_FRAMES; f++) {
        c->geometry_bytes[f] = rng_below(rng, 5) ? rng_below(rng, 40000) : 0;
        for (uint32_t k = 0; k < c->regions_per_frame; k++) {
            struct timing_region *region = &c->regions[f][k];
            region->words = (uint32_t)rng_below(rng, 4);
            region->shading = region->words ? (ticks)rng_below(rng, 60000) : 0;
            c->shading_node[f][k] = (uint32_t)rng_below(rng, c->shading_nodes);
            for (uint32_t i = 0; i < c->rendering_nodes; i++)
                if (rng_below(rng, 2))
                    c->work[f][k][region->work_count++] =
                        (struct timing_work){i, (uint32_t)rng_below(rng, 200)};
            region->work = c->work[f][k];
        }
    }
}

static inline uint32_t case_shading_node(const struct timing_case *c, int f, uint32_t k) {
    return c->is_assigned ? c->shading_node[f][k] : k % c->shading_nodes;
}

static inline struct timing_frame case_frame(const struct timing_case *c, int f) {
    return (struct timing_frame){c->geometry_bytes[f], c->regions[f], c->regions_per_frame,
                                 c->is_assigned ? c->shading_node[f] : NULL};
}

#endif
