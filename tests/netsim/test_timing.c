/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "tests/netsim/least_solution.h"
#include "tests/netsim/timing_cases.h"

#include <stdlib.h>
#include <string.h>

/* The same rules as docs/timing.md written a second time, as a graph. */

static const struct timing_limits limits = {CASE_REGIONS_MAX, 4, 4};

/* Variables: 0 is time zero; then per frame the begin of geometry, and per region the begins of the
 * transfer, of shading, of the colours' arrival, and of raster at each node. */
static void build(struct graph *g, const struct machine *m, const struct timing_case *w,
                  int frame_end[CASE_FRAMES]) {
    int geometry[CASE_FRAMES], transfer[CASE_FRAMES][CASE_REGIONS_MAX],
        shade[CASE_FRAMES][CASE_REGIONS_MAX], colour[CASE_FRAMES][CASE_REGIONS_MAX];
    int raster[CASE_FRAMES][CASE_REGIONS_MAX][CASE_NODES_MAX], end[CASE_FRAMES];
    g->variables = 1;
    for (int f = 0; f < CASE_FRAMES; f++) {
        geometry[f] = g->variables++;
        end[f] = g->variables++;
        for (uint32_t k = 0; k < w->regions_per_frame; k++) {
            transfer[f][k] = g->variables++;
            shade[f][k] = g->variables++;
            colour[f][k] = g->variables++;
            for (uint32_t i = 0; i < w->rendering_nodes; i++)
                raster[f][k][i] = g->variables++;
        }
    }
    const ticks hop = m->composition_hop, colours = m->composition_word * 8192 * m->colour_words;
    const int buffers = (int)m->composition_region_buffers, frames = (int)m->geometry_frame_buffers;
    int last_transfer = 0, last_colour = 0;
    ticks last_length = 0;
    int raster_history[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX],
        raster_transfer[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX],
        raster_count[CASE_NODES_MAX] = {0};
    ticks raster_cost[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX],
        raster_length[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX];
    int shade_history[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX],
        colour_history[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX],
        shade_count[CASE_NODES_MAX] = {0};
    ticks shade_cost[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX];
    for (int f = 0; f < CASE_FRAMES; f++) {
        const ticks g_time = (ticks)((w->geometry_bytes[f] + 3) / 4) * m->geometry_word;
        rule(g, geometry[f], 0, 0);
        if (f)
            rule(g, geometry[f], geometry[f - 1],
                 (ticks)((w->geometry_bytes[f - 1] + 3) / 4) * m->geometry_word);
        rule(g, end[f], geometry[f], g_time);
        if (f)
            rule(g, end[f], end[f - 1], 0);
        for (uint32_t i = 0; f >= frames && i < w->rendering_nodes;
             i++) /* all work of frame f - frames is rastered */
            for (int n = 0; n < raster_count[i]; n++)
                if (raster_history[i][n] < geometry[f - frames + 1])
                    rule(g, geometry[f], raster_history[i][n], raster_cost[i][n]);
        if (f >= frames)
            rule(g, geometry[f], geometry[f - frames],
                 (ticks)((w->geometry_bytes[f - frames] + 3) / 4) * m->geometry_word);
        for (uint32_t k = 0; k < w->regions_per_frame; k++) {
            const struct timing_region *region = &w->regions[f][k];
            const ticks length =
                region->words ? m->composition_word * 8192 * region->words : m->composition_word;
            const uint32_t j = case_shading_node(w, f, k);
            const ticks chain = hop * ((ticks)w->rendering_nodes + j),
                        way = hop * ((ticks)w->shading_nodes - j);
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

static void recurrence_agrees_to_the_tick_with_the_rules_as_a_graph(void **state) {
    (void)state;
    struct rng rng = {2024};
    struct timing_case *w = malloc(sizeof *w);
    for (int round = 0; round < 10000; round++) {
        struct graph graph = {0};
        int end[CASE_FRAMES];
        random_case(&rng, limits, w);
        const struct machine machine = w->machine;
        build(&graph, &machine, w, end);
        graph_solve(&graph);
        struct timing_model *model =
            timing_model_create(&machine, &strategy_chain, w->rendering_nodes, w->shading_nodes);
        ticks before = 0;
        for (int f = 0; f < CASE_FRAMES; f++) {
            struct timing_result result;
            const struct timing_frame frame = case_frame(w, f);
            assert_true(timing_model_add_frame(model, &frame, &result, NULL));
            if (result.end != graph.at[end[f]])
                fail_msg("round %d, frame %d: %lld, by the graph %lld", round, f,
                         (long long)result.end, (long long)graph.at[end[f]]);
            assert_int_equal(result.time, result.end - before);
            assert_true(result.time >= 0);
            before = result.end;
        }
        timing_model_destroy(model);
        graph_finish(&graph);
    }
    free(w);
}

static ticks time_of(const struct machine *machine, const struct timing_case *w) {
    struct timing_model *model =
        timing_model_create(machine, &strategy_chain, w->rendering_nodes, w->shading_nodes);
    struct timing_result result = {0};
    for (int f = 0; f < CASE_FRAMES; f++) {
        const struct timing_frame frame = case_frame(w, f);
        assert_true(timing_model_add_frame(model, &frame, &result, NULL));
    }
    timing_model_destroy(model);
    return result.end;
}

static void less_of_anything_never_takes_longer(void **state) {
    (void)state;
    struct rng rng = {77};
    struct timing_case *w = malloc(sizeof *w);
    for (int round = 0; round < 3000; round++) {
        random_case(&rng, limits, w);
        const struct machine machine = w->machine;
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
            &w->regions[rng_below(&rng, CASE_FRAMES)][rng_below(&rng, w->regions_per_frame)];
        region->shading /= 2;
        assert_true(time_of(&machine, w) <= whole);
    }
    free(w);
}

static void all_times_scale_together(void **state) {
    (void)state;
    struct rng rng = {78};
    struct timing_case *w = malloc(sizeof *w);
    for (int round = 0; round < 1000; round++) {
        random_case(&rng, limits, w);
        const struct machine machine = w->machine;
        const ticks whole = time_of(&machine, w);
        struct machine slower = machine;
        ticks *times[] = {&slower.composition_word, &slower.composition_hop, &slower.geometry_word,
                          &slower.raster_triangle, &slower.raster_region};
        for (size_t i = 0; i < sizeof times / sizeof *times; i++)
            *times[i] *= 7;
        for (int f = 0; f < CASE_FRAMES; f++)
            for (uint32_t k = 0; k < w->regions_per_frame; k++)
                w->regions[f][k].shading *= 7;
        assert_int_equal(time_of(&slower, w), 7 * whole);
    }
    free(w);
}

static void times_past_63_bits_are_refused(void **state) {
    (void)state;
    struct rng rng = {1};
    struct machine machine = random_case_machine(&rng);
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
