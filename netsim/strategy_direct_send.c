/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/switched.h"

/* Every rendering node sends what it has of a region straight to the shading node the region
 * belongs to, which composes: one step, and the port of the shading node takes the region once for
 * each rendering node. Regions are the pieces of the picture that direct send deals out. */
static void plan(struct schedule *schedule) {
    for (uint32_t rank = 0; rank < schedule->nodes; rank++)
        schedule_add(schedule, 0, rank, SCHEDULE_SHADING, 0, schedule->samples);
}

static void *create(const struct machine *machine, uint32_t rendering_nodes,
                    uint32_t shading_nodes) {
    return switched_create(machine, plan, rendering_nodes, shading_nodes);
}

const struct strategy strategy_direct_send = {
    "direct-send",    "switched: every rendering node sends to the shading node, which composes",
    create,           switched_destroy,
    switched_compose, plan};
