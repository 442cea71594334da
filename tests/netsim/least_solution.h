/* SPDX-License-Identifier: Apache-2.0 */
#ifndef LEAST_SOLUTION_H
#define LEAST_SOLUTION_H

#include "base/status.h"
#include "base/ticks.h"

#include <stdlib.h>

/* Rules of time as a graph: a variable for each begin, "this begins no earlier than that plus so
 * much" for each rule, and the least solution, found by relaxing until nothing moves. It shares no
 * code with the timing model and knows nothing of its order of evaluation. */

struct rule {
    int later, earlier;
    ticks delay;
};

struct graph {
    struct rule *rules;
    size_t count, capacity;
    ticks *at; /* of each variable, once solved */
    int variables;
};

static inline void rule(struct graph *g, int later, int earlier, ticks delay) {
    g->rules = memory_grow(g->rules, &g->capacity, g->count + 1, sizeof *g->rules);
    g->rules[g->count++] = (struct rule){later, earlier, delay};
}

static inline void graph_solve(struct graph *g) {
    g->at = memory_get((size_t)g->variables, sizeof *g->at);
    for (bool moved = true; moved;) {
        moved = false;
        for (size_t i = 0; i < g->count; i++) {
            const ticks least = g->at[g->rules[i].earlier] + g->rules[i].delay;
            if (g->at[g->rules[i].later] < least) {
                g->at[g->rules[i].later] = least;
                moved = true;
            }
        }
    }
}

static inline void graph_finish(struct graph *g) {
    free(g->rules);
    free(g->at);
}

#endif
