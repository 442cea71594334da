/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SCHEDULE_H
#define SCHEDULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Who sends which samples of a region to whom, and in which step, until all of it lies composed at
 * the region's shading node: what a composition strategy on a switched network comes down to. The
 * live nodes move pixels by it, the timing model prices it.
 *
 * A schedule is for ranks 0..nodes-1. Node i has rank i; when ranks have unequal work, (i + k) mod
 * nodes in region k, so that nodes take turns (our choice). A rank sends the moves of a step from
 * what it had when the step began, and composes what it receives in a step before the next. */

#define SCHEDULE_SHADING UINT32_MAX /* `to`: the shading node of the region */

struct schedule_move {
    uint32_t step, from, to; /* ranks */
    uint32_t first, end;     /* samples of the region; may be none */
};

struct schedule {
    uint32_t nodes, samples, steps;
    bool takes_turns;            /* ranks go round from region to region */
    struct schedule_move *moves; /* by step; within a step in the order in which ports serve them */
    size_t count, capacity;
    uint32_t final_count; /* moves to the shading node */
    /* numbers of the moves of each rank, ascending: [begin[rank], begin[rank + 1]) */
    size_t *send_begin, *receive_begin;
    uint32_t *sends, *receives;
};

/* Fills in the moves of `schedule` for its nodes and samples, by schedule_add and below. */
typedef void schedule_plan(struct schedule *schedule);

struct schedule *schedule_create(schedule_plan *plan, uint32_t nodes, uint32_t samples);
void schedule_destroy(struct schedule *schedule);

static inline uint32_t schedule_rank(const struct schedule *schedule, uint32_t node,
                                     uint32_t region) {
    const uint64_t turn = schedule->takes_turns ? region : 0;
    return (uint32_t)((node + turn) % schedule->nodes);
}
static inline uint32_t schedule_node(const struct schedule *schedule, uint32_t rank,
                                     uint32_t region) {
    const uint32_t turn = schedule->takes_turns ? region % schedule->nodes : 0;
    return (rank + schedule->nodes - turn) % schedule->nodes;
}

/* For plans. Steps must not decrease. */
void schedule_add(struct schedule *schedule, uint32_t step, uint32_t from, uint32_t to,
                  uint32_t first, uint32_t end);
/* Ranks from `ranks` on give all they have to a rank below, in step 0 (ranks >= nodes / 2).
 * Returns the next step. */
uint32_t schedule_fold(struct schedule *schedule, uint32_t ranks);
/* Rounds of exchange among ranks 0..ranks-1, the product of the factors: in each, groups of so
 * many ranks divide their span among themselves; at last each sends its own to the shading node. */
void schedule_rounds(struct schedule *schedule, uint32_t step, uint32_t ranks,
                     const uint32_t *factors, uint32_t factor_count);

#endif
