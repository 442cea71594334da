/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/switched.h"

enum { RADIX_MAX = 8 };

/* Whether `ranks` is a product of factors up to RADIX_MAX; which, the largest first. */
static bool factorize(uint32_t ranks, uint32_t factors[32], uint32_t *count) {
    *count = 0;
    for (uint32_t factor = RADIX_MAX; factor > 1; factor--)
        for (; ranks % factor == 0; ranks /= factor)
            factors[(*count)++] = factor;
    return ranks == 1;
}

/* Groups of up to 8 nodes divide what they hold among themselves, all with all, then groups of
 * those with the same part, and so on; all parts go to the shading node. Nodes above the largest
 * product of such factors first give all they have to another (folding). */
static void plan(struct schedule *schedule) {
    uint32_t factors[32], rounds, ranks = schedule->nodes;
    while (!factorize(ranks, factors, &rounds))
        ranks--;
    schedule_rounds(schedule, schedule_fold(schedule, ranks), ranks, factors, rounds);
}

static void *create(const struct machine *machine, uint32_t rendering_nodes,
                    uint32_t shading_nodes) {
    return switched_create(machine, plan, rendering_nodes, shading_nodes);
}

const struct strategy strategy_radix_k = {
    "radix-k",        "switched: groups of up to 8 divide regions among themselves, in rounds",
    create,           switched_destroy,
    switched_compose, plan};
