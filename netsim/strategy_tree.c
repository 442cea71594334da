/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/switched.h"

/* A binomial tree: in step t every rank that is an odd multiple of 2^t sends all it has to the one
 * 2^t below; rank 0 sends the result to the shading node. */
static void plan(struct schedule *schedule) {
    uint32_t step = 0;
    schedule->takes_turns = true;
    for (uint64_t distance = 1; distance < schedule->nodes; distance *= 2, step++)
        for (uint64_t rank = distance; rank < schedule->nodes; rank += 2 * distance)
            schedule_add(schedule, step, (uint32_t)rank, (uint32_t)(rank - distance), 0,
                         schedule->samples);
    schedule_add(schedule, step, 0, SCHEDULE_SHADING, 0, schedule->samples);
}

static void *create(const struct machine *machine, uint32_t rendering_nodes,
                    uint32_t shading_nodes) {
    return switched_create(machine, plan, rendering_nodes, shading_nodes);
}

const struct strategy strategy_tree = {
    "tree",           "switched: pairs compose whole regions, then pairs of pairs",
    create,           switched_destroy,
    switched_compose, plan};
