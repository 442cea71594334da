/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/schedule.h"

#include "base/status.h"

#include <assert.h>
#include <stdlib.h>

void schedule_add(struct schedule *schedule, uint32_t step, uint32_t from, uint32_t to,
                  uint32_t first, uint32_t end) {
    assert(!schedule->count || schedule->moves[schedule->count - 1].step <= step);
    schedule->moves = memory_grow(schedule->moves, &schedule->capacity, schedule->count + 1,
                                  sizeof *schedule->moves);
    schedule->moves[schedule->count++] = (struct schedule_move){step, from, to, first, end};
    schedule->steps = step + 1;
    schedule->final_count += to == SCHEDULE_SHADING;
}

uint32_t schedule_fold(struct schedule *schedule, uint32_t ranks) {
    for (uint32_t rank = ranks; rank < schedule->nodes; rank++)
        schedule_add(schedule, 0, rank, rank - ranks, 0, schedule->samples);
    schedule->takes_turns = ranks < schedule->nodes;
    return schedule->takes_turns;
}

/* Where part `part` of `parts` of a span begins. */
static uint32_t part_begin(uint32_t first, uint32_t end, uint32_t part, uint32_t parts) {
    return first + (uint32_t)((uint64_t)(end - first) * part / parts);
}

void schedule_rounds(struct schedule *schedule, uint32_t step, uint32_t ranks,
                     const uint32_t *factors, uint32_t factor_count) {
    struct span {
        uint32_t first, end;
    } *spans = memory_get(ranks, sizeof *spans);
    uint32_t stride = 1;
    for (uint32_t rank = 0; rank < ranks; rank++)
        spans[rank] = (struct span){0, schedule->samples};
    for (uint32_t round = 0; round < factor_count; round++, step++) {
        const uint32_t k = factors[round];
        for (uint32_t shift = 1; shift < k; shift++) /* in each shift every port sends once */
            for (uint32_t rank = 0; rank < ranks; rank++) {
                const uint32_t member = rank / stride % k, other = (member + shift) % k;
                const struct span span = spans[rank];
                schedule_add(schedule, step, rank, rank - member * stride + other * stride,
                             part_begin(span.first, span.end, other, k),
                             part_begin(span.first, span.end, other + 1, k));
            }
        for (uint32_t rank = 0; rank < ranks; rank++) {
            const uint32_t member = rank / stride % k;
            const struct span span = spans[rank];
            spans[rank] = (struct span){part_begin(span.first, span.end, member, k),
                                        part_begin(span.first, span.end, member + 1, k)};
        }
        stride *= k;
    }
    for (uint32_t rank = 0; rank < ranks; rank++)
        schedule_add(schedule, step, rank, SCHEDULE_SHADING, spans[rank].first, spans[rank].end);
    free(spans);
}

/* Lists the moves of each rank, by counting: begin[rank + 1] is first where the rank's list begins
 * and moves to its end as it fills. */
static void index_moves(const struct schedule *schedule, bool by_sender, size_t **begin,
                        uint32_t **list) {
    size_t *at = memory_get((size_t)schedule->nodes + 2, sizeof *at);
    *list = memory_get(schedule->count, sizeof **list);
    for (size_t m = 0; m < schedule->count; m++) {
        const uint32_t rank = by_sender ? schedule->moves[m].from : schedule->moves[m].to;
        if (rank != SCHEDULE_SHADING)
            at[rank + 2]++;
    }
    for (uint32_t rank = 0; rank < schedule->nodes; rank++)
        at[rank + 2] += at[rank + 1];
    for (size_t m = 0; m < schedule->count; m++) {
        const uint32_t rank = by_sender ? schedule->moves[m].from : schedule->moves[m].to;
        if (rank != SCHEDULE_SHADING)
            (*list)[at[rank + 1]++] = (uint32_t)m;
    }
    *begin = at;
}

struct schedule *schedule_create(schedule_plan *plan, uint32_t nodes, uint32_t samples) {
    struct schedule *schedule = memory_get(1, sizeof *schedule);
    schedule->nodes = nodes;
    schedule->samples = samples;
    plan(schedule);
    assert(schedule->count < UINT32_MAX);
    index_moves(schedule, true, &schedule->send_begin, &schedule->sends);
    index_moves(schedule, false, &schedule->receive_begin, &schedule->receives);
    return schedule;
}

void schedule_destroy(struct schedule *schedule) {
    if (!schedule)
        return;
    free(schedule->moves);
    free(schedule->send_begin);
    free(schedule->receive_begin);
    free(schedule->sends);
    free(schedule->receives);
    free(schedule);
}
