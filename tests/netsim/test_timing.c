/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/rng.h"
#include "netsim/timing.h"

#include <stdlib.h>
#include <string.h>

/* The same rules as docs/timing.md written a second time, as a graph: one variable for each begin,
 * "this begins no earlier than that plus so much" for each rule, and the least solution found by
 * relaxing until nothing moves. It shares no code with the recurrence and knows nothing of its
 * order of evaluation. */

struct rule {
    int later, earlier;
    ticks delay;
};

struct graph {
    struct rule *rules;
    size_t count, capacity;
    ticks *at;
    int variables;
};

static void rule(struct graph *g, int later, int earlier, ticks delay) {
    g->rules = memory_grow(g->rules, &g->capacity, g->count + 1, sizeof *g->rules);
    g->rules[g->count++] = (struct rule){later, earlier, delay};
}

static void solve(struct graph *g) {
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

enum { FRAMES = 3, REGIONS_MAX = 12, NODES_MAX = 4 };

struct workload {
    struct timing_region regions[FRAMES][REGIONS_MAX];
    struct timing_work work[FRAMES][REGIONS_MAX][NODES_MAX];
    uint64_t geometry_bytes[FRAMES];
    uint32_t count, r, s;
};

static void random_workload(struct rng *rng, struct workload *w) {
    memset(w, 0, sizeof *w);
    w->count = 1 + (uint32_t)rng_below(rng, REGIONS_MAX);
    w->r = 1 + (uint32_t)rng_below(rng, NODES_MAX);
    w->s = 1 + (uint32_t)rng_below(rng, NODES_MAX);
    for (int f = 0; f < FRAMES; f++) {
        w->geometry_bytes[f] = rng_below(rng, 40000);
        for (uint32_t k = 0; k < w->count; k++) {
            struct timing_region *region = &w->regions[f][k];
            region->words = (uint32_t)rng_below(rng, 4);
            region->shading = region->words ? (ticks)rng_below(rng, 60000) : 0;
            for (uint32_t i = 0; i < w->r; i++)
                if (rng_below(rng, 2))
                    w->work[f][k][region->work_count++] =
                        (struct timing_work){i, (uint32_t)rng_below(rng, 200)};
            region->work = w->work[f][k];
        }
    }
}

/* Variables: 0 is time zero; then per frame the begin of geometry, and per region the begins of the
 * transfer, of shading, of the colours' arrival, and of raster at each node. */
static void build(struct graph *g, const struct machine *m, const struct workload *w,
                  int frame_end[FRAMES]) {
    int geometry[FRAMES], transfer[FRAMES][REGIONS_MAX], shade[FRAMES][REGIONS_MAX],
        colour[FRAMES][REGIONS_MAX];
    int raster[FRAMES][REGIONS_MAX][NODES_MAX], end[FRAMES];
    g->variables = 1;
    for (int f = 0; f < FRAMES; f++) {
        geometry[f] = g->variables++;
        end[f] = g->variables++;
        for (uint32_t k = 0; k < w->count; k++) {
            transfer[f][k] = g->variables++;
            shade[f][k] = g->variables++;
            colour[f][k] = g->variables++;
            for (uint32_t i = 0; i < w->r; i++)
                raster[f][k][i] = g->variables++;
        }
    }
    const ticks hop = m->composition_hop, colours = m->composition_word * 8192 * m->colour_words;
    const int buffers = (int)m->composition_region_buffers, frames = (int)m->geometry_frame_buffers;
    int last_transfer = 0, last_colour = 0;
    ticks last_length = 0;
    int raster_history[NODES_MAX][FRAMES * REGIONS_MAX],
        raster_transfer[NODES_MAX][FRAMES * REGIONS_MAX], raster_count[NODES_MAX] = {0};
    ticks raster_cost[NODES_MAX][FRAMES * REGIONS_MAX],
        raster_length[NODES_MAX][FRAMES * REGIONS_MAX];
    int shade_history[NODES_MAX][FRAMES * REGIONS_MAX],
        colour_history[NODES_MAX][FRAMES * REGIONS_MAX], shade_count[NODES_MAX] = {0};
    ticks shade_cost[NODES_MAX][FRAMES * REGIONS_MAX];
    for (int f = 0; f < FRAMES; f++) {
        const ticks g_time = (ticks)((w->geometry_bytes[f] + 3) / 4) * m->geometry_word;
        rule(g, geometry[f], 0, 0);
        if (f)
            rule(g, geometry[f], geometry[f - 1],
                 (ticks)((w->geometry_bytes[f - 1] + 3) / 4) * m->geometry_word);
        rule(g, end[f], geometry[f], g_time);
        if (f)
            rule(g, end[f], end[f - 1], 0);
        for (uint32_t i = 0; f >= frames && i < w->r;
             i++) /* all work of frame f - frames is rastered */
            for (int n = 0; n < raster_count[i]; n++)
                if (raster_history[i][n] < geometry[f - frames + 1])
                    rule(g, geometry[f], raster_history[i][n], raster_cost[i][n]);
        if (f >= frames)
            rule(g, geometry[f], geometry[f - frames],
                 (ticks)((w->geometry_bytes[f - frames] + 3) / 4) * m->geometry_word);
        for (uint32_t k = 0; k < w->count; k++) {
            const struct timing_region *region = &w->regions[f][k];
            const ticks length =
                region->words ? m->composition_word * 8192 * region->words : m->composition_word;
            const uint32_t j = k % w->s;
            const ticks chain = hop * ((ticks)w->r + j), way = hop * ((ticks)w->s - j);
            const int x = transfer[f][k];
            rule(g, x, geometry[f], g_time);
            rule(g, x, last_transfer, last_length);
            last_transfer = x;
            last_length = length;
            for (uint32_t e = 0; e < region->work_count; e++) {
                const uint32_t i = region->work[e].node;
                const int at = raster[f][k][i], n = raster_count[i]++;
                const ticks cost =
                    m->raster_region + m->raster_triangle * region->work[e].triangles;
                rule(g, at, geometry[f], g_time);
                if (n)
                    rule(g, at, raster_history[i][n - 1], raster_cost[i][n - 1]);
                if (n >= buffers) /* the buffer is free when its transfer has passed this node */
                    rule(g, at, raster_transfer[i][n - buffers],
                         raster_length[i][n - buffers] + hop * i);
                rule(g, x, at, cost - hop * i);
                raster_history[i][n] = at;
                raster_cost[i][n] = cost;
                raster_transfer[i][n] = x;
                raster_length[i][n] = length;
            }
            if (!region->words) {
                rule(g, end[f], x, length + chain + way);
                continue;
            }
            const int n = shade_count[j]++;
            if (n >= buffers) /* colours of the region before the last in this buffer have left the
                                 node */
                rule(g, x, colour_history[j][n - buffers], colours - way - chain);
            rule(g, shade[f][k], x, length + chain);
            if (n)
                rule(g, shade[f][k], shade_history[j][n - 1], shade_cost[j][n - 1]);
            rule(g, colour[f][k], shade[f][k], region->shading + way);
            if (last_colour)
                rule(g, colour[f][k], last_colour, colours);
            rule(g, end[f], colour[f][k], colours);
            last_colour = colour[f][k];
            shade_history[j][n] = shade[f][k];
            shade_cost[j][n] = region->shading;
            colour_history[j][n] = colour[f][k];
        }
        frame_end[f] = end[f];
    }
}

static struct machine random_machine(struct rng *rng) {
    struct machine m = {.region_width = 128,
                        .region_height = 64,
                        .composition_word_bytes = 32,
                        .composition_depth_bytes = 4,
                        .composition_shader_id_bytes = 2,
                        .geometry_word_bytes = 4};
    m.rate.per_s = 1000000000;
    m.composition_word = 1 + (ticks)rng_below(rng, 5);
    m.composition_hop = (ticks)rng_below(rng, 3000);
    m.geometry_word = 1 + (ticks)rng_below(rng, 5);
    m.raster_triangle = (ticks)rng_below(rng, 400);
    m.raster_region = (ticks)rng_below(rng, 400);
    m.colour_words = 1 + (int64_t)rng_below(rng, 2);
    m.composition_region_buffers = 1 + (int64_t)rng_below(rng, 3);
    m.geometry_frame_buffers = 1 + (int64_t)rng_below(rng, 3);
    return m;
}

static void recurrence_agrees_to_the_tick_with_the_rules_as_a_graph(void **state) {
    (void)state;
    struct rng rng = {2024};
    struct workload *w = malloc(sizeof *w);
    for (int round = 0; round < 10000; round++) {
        const struct machine machine = random_machine(&rng);
        struct graph graph = {0};
        int end[FRAMES];
        random_workload(&rng, w);
        build(&graph, &machine, w, end);
        solve(&graph);
        struct timing_model *model = timing_model_create(&machine, &strategy_chain, w->r, w->s);
        ticks before = 0;
        for (int f = 0; f < FRAMES; f++) {
            struct timing_result result;
            const struct timing_frame frame = {w->geometry_bytes[f], w->regions[f], w->count, NULL};
            assert_true(timing_model_add_frame(model, &frame, &result, NULL));
            if (result.end != graph.at[end[f]])
                fail_msg("round %d, frame %d: %lld, by the graph %lld", round, f,
                         (long long)result.end, (long long)graph.at[end[f]]);
            assert_int_equal(result.time, result.end - before);
            assert_true(result.time >= 0);
            before = result.end;
        }
        timing_model_destroy(model);
        free(graph.rules);
        free(graph.at);
    }
    free(w);
}

static ticks time_of(const struct machine *machine, const struct workload *w) {
    struct timing_model *model = timing_model_create(machine, &strategy_chain, w->r, w->s);
    struct timing_result result = {0};
    for (int f = 0; f < FRAMES; f++) {
        const struct timing_frame frame = {w->geometry_bytes[f], w->regions[f], w->count, NULL};
        assert_true(timing_model_add_frame(model, &frame, &result, NULL));
    }
    timing_model_destroy(model);
    return result.end;
}

static void less_of_anything_never_takes_longer(void **state) {
    (void)state;
    struct rng rng = {77};
    struct workload *w = malloc(sizeof *w);
    for (int round = 0; round < 3000; round++) {
        const struct machine machine = random_machine(&rng);
        random_workload(&rng, w);
        const ticks whole = time_of(&machine, w);
        struct machine better = machine;
        better.composition_hop /= 2;
        assert_true(time_of(&better, w) <= whole);
        better = machine;
        better.composition_region_buffers++;
        assert_true(time_of(&better, w) <= whole);
        better = machine;
        better.geometry_frame_buffers++;
        assert_true(time_of(&better, w) <= whole);
        better = machine;
        better.raster_triangle /= 2;
        assert_true(time_of(&better, w) <= whole);
        better = machine;
        better.geometry_word = 1;
        assert_true(time_of(&better, w) <= whole);
        struct timing_region *region =
            &w->regions[rng_below(&rng, FRAMES)][rng_below(&rng, w->count)];
        region->shading /= 2;
        assert_true(time_of(&machine, w) <= whole);
    }
    free(w);
}

static void all_times_scale_together(void **state) {
    (void)state;
    struct rng rng = {78};
    struct workload *w = malloc(sizeof *w);
    for (int round = 0; round < 1000; round++) {
        const struct machine machine = random_machine(&rng);
        random_workload(&rng, w);
        const ticks whole = time_of(&machine, w);
        struct machine slower = machine;
        ticks *times[] = {&slower.composition_word, &slower.composition_hop, &slower.geometry_word,
                          &slower.raster_triangle, &slower.raster_region};
        for (size_t i = 0; i < sizeof times / sizeof *times; i++)
            *times[i] *= 7;
        for (int f = 0; f < FRAMES; f++)
            for (uint32_t k = 0; k < w->count; k++)
                w->regions[f][k].shading *= 7;
        assert_int_equal(time_of(&slower, w), 7 * whole);
    }
    free(w);
}

static void times_past_63_bits_are_refused(void **state) {
    (void)state;
    struct rng rng = {1};
    struct machine machine = random_machine(&rng);
    machine.composition_word = TICKS_MAX / 4096;
    struct timing_region region = {.words = 3};
    const struct timing_frame frame = {0, &region, 1, NULL};
    struct timing_model *model = timing_model_create(&machine, &strategy_chain, 1, 1);
    struct timing_result result;
    struct status status = {0};
    assert_false(timing_model_add_frame(model, &frame, &result, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    timing_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(recurrence_agrees_to_the_tick_with_the_rules_as_a_graph),
        cmocka_unit_test(less_of_anything_never_takes_longer),
        cmocka_unit_test(all_times_scale_together),
        cmocka_unit_test(times_past_63_bits_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
