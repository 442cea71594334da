/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/switched.h"

/* Pairs of nodes exchange halves of what they hold, in log2 r rounds, until each has its own part
 * of the region composed; all parts go to the shading node. When r is no power of two, those above
 * the largest one below first give all they have to another (folding). */
static void plan(struct schedule *schedule) {
    uint32_t factors[32], rounds = 0, ranks = 1;
    for (; ranks <= schedule->nodes / 2; ranks *= 2)
        factors[rounds++] = 2;
    schedule_rounds(schedule, schedule_fold(schedule, ranks), ranks, factors, rounds);
}

static void *create(const struct machine *machine, uint32_t rendering_nodes,
                    uint32_t shading_nodes) {
    return switched_create(machine, plan, rendering_nodes, shading_nodes);
}

const struct strategy strategy_binary_swap = {
    "binary-swap",    "switched: pairs exchange halves until each has a part composed",
    create,           switched_destroy,
    switched_compose, plan};
