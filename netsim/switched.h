/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SWITCHED_H
#define SWITCHED_H

#include "netsim/schedule.h"
#include "netsim/strategy.h"

/* The timing of strategies that move regions by a schedule over a switched network: every rendering
 * and shading node has one full-duplex port at the rate of the composition network, the switch
 * itself is never the limit, and what is sent arrives one hop latency later. A port serves moves in
 * order of regions, steps and the schedule, without overtaking (docs/timing.md). */
void *switched_create(const struct machine *machine, schedule_plan *plan, uint32_t rendering_nodes,
                      uint32_t shading_nodes);
void switched_destroy(void *state);
void switched_compose(void *state, const struct strategy_region *region,
                      struct strategy_times *times);

#endif
