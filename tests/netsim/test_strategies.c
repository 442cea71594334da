/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "netsim/schedule.h"
#include "tests/netsim/least_solution.h"
#include "tests/netsim/timing_cases.h"

#include <stdlib.h>
#include <string.h>

/* ---- every sample of every node reaches the shading node once ---- */

/* Plays a schedule with bit sets in place of pixels: has[rank][sample] says whose samples are
 * composed in it; `nodes` up to 64. */
static void play(const struct schedule *schedule, uint64_t *arrived) {
    const uint32_t nodes = schedule->nodes, samples = schedule->samples;
    const size_t size = (size_t)nodes * samples;
    uint64_t *has = memory_get(size, sizeof *has), *next = memory_get(size, sizeof *next);
    for (uint32_t rank = 0; rank < nodes; rank++)
        for (uint32_t i = 0; i < samples; i++)
            has[(size_t)rank * samples + i] = 1ull << rank;
    memcpy(next, has, size * sizeof *has);
    uint32_t step = 0;
    for (size_t m = 0; m < schedule->count; m++) {
        const struct schedule_move *move = &schedule->moves[m];
        assert_true(move->step >= step && move->first <= move->end && move->end <= samples);
        assert_true(move->from < nodes && move->from != move->to);
        if (move->step != step)
            memcpy(has, next, size * sizeof *has);
        step = move->step;
        for (uint32_t i = move->first; i < move->end; i++) {
            uint64_t *to =
                move->to == SCHEDULE_SHADING ? &arrived[i] : &next[(size_t)move->to * samples + i];
            const uint64_t sent = has[(size_t)move->from * samples + i];
            assert_int_equal(*to & sent, 0); /* nobody's sample is composed twice */
            *to |= sent;
        }
    }
    free(has);
    free(next);
}

static void each_sample_of_each_node_arrives_once(void **state) {
    (void)state;
    enum { SAMPLES = 200 };
    const struct strategy *strategy;
    for (int s = 0; (strategy = strategy_at(s)); s++)
        for (uint32_t nodes = 1; strategy->plan && nodes <= 64; nodes++) {
            struct schedule *schedule = schedule_create(strategy->plan, nodes, SAMPLES);
            uint64_t arrived[SAMPLES] = {0};
            play(schedule, arrived);
            for (int i = 0; i < SAMPLES; i++)
                assert_true(arrived[i] == (nodes == 64 ? ~0ull : (1ull << nodes) - 1));
            schedule_destroy(schedule);
        }
}

/* Steps and what the busiest port of a rendering node sends, in 64ths of a region, as the
 * literature counts them for powers of two. */
static void steps_and_volumes_are_those_of_the_literature(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint32_t nodes, steps, sent; /* sent: by rank 1, in 1/64 of a region */
    } expected[] = {
        {"direct-send", 8, 1, 64},
        {"direct-send", 64, 1, 64},
        {"binary-swap", 8, 4, 56 + 8},
        {"binary-swap", 64, 7, 63 + 1},
        {"radix-k", 8, 2, 56 + 8},
        {"radix-k", 64, 3, 56 + 7 + 1},
        {"tree", 8, 4, 64},
        {"tree", 64, 7, 64},
    };
    for (size_t e = 0; e < sizeof expected / sizeof *expected; e++) {
        struct schedule *schedule =
            schedule_create(strategy_find(expected[e].name)->plan, expected[e].nodes, 6400);
        uint32_t sent = 0;
        for (size_t i = schedule->send_begin[1]; i < schedule->send_begin[2]; i++) {
            const struct schedule_move *move = &schedule->moves[schedule->sends[i]];
            assert_int_equal(move->from, 1);
            sent += move->end - move->first;
        }
        assert_int_equal(schedule->steps, expected[e].steps);
        assert_int_equal(sent, expected[e].sent * 100);
        schedule_destroy(schedule);
    }
}

static void ranks_and_nodes_belong_together_and_take_turns(void **state) {
    (void)state;
    for (uint32_t nodes = 1; nodes < 20; nodes++) {
        struct schedule schedule = {.nodes = nodes};
        for (int turns = 0; turns < 2; turns++) {
            schedule.takes_turns = turns;
            uint32_t first[20] = {0};
            for (uint32_t region = 0; region < 3 * nodes; region++) {
                first[schedule_node(&schedule, 0, region)]++;
                for (uint32_t node = 0; node < nodes; node++)
                    assert_int_equal(
                        schedule_node(&schedule, schedule_rank(&schedule, node, region), region),
                        node);
            }
            for (uint32_t node = 0; node < nodes; node++)
                assert_int_equal(first[node], turns ? 3 : node ? 0 : 3 * nodes);
        }
    }
}

/* ---- times: the rules of docs/timing.md for switched networks, as a graph of "no earlier than",
 * solved by relaxing; it shares the list of moves with the recurrence, and nothing else ---- */

enum { MOVES_MAX = 64 };
static const struct timing_limits limits = {7, CASE_NODES_MAX, 4};

/* The graph has no rule for primitives of frames ahead: every frame has a buffer of its own. */
static void random_case_of_strategies(struct rng *rng, struct timing_case *w) {
    random_case(rng, limits, w);
    w->machine.geometry_frame_buffers = CASE_FRAMES;
}

/* What happened to a port, a node or a buffer, in order; and how long after its variable it was
 * over. */
struct history {
    int at[CASE_FRAMES * CASE_REGIONS_MAX * MOVES_MAX];
    ticks length[CASE_FRAMES * CASE_REGIONS_MAX * MOVES_MAX];
    int count;
};

static void follow(struct graph *g, struct history *history, int variable, ticks length) {
    if (history->count)
        rule(g, variable, history->at[history->count - 1], history->length[history->count - 1]);
    history->at[history->count] = variable;
    history->length[history->count++] = length;
}

struct world {
    struct history out[CASE_NODES_MAX], in[CASE_NODES_MAX + 4], raster[CASE_NODES_MAX], shade[4],
        colour;
    /* sends out of each raster buffer: variables and lengths of one region's moves */
    struct {
        int at[MOVES_MAX], count;
        ticks length[MOVES_MAX];
    } sent[CASE_NODES_MAX][CASE_FRAMES * CASE_REGIONS_MAX];
    int sent_count[CASE_NODES_MAX];
    int shaded[4][CASE_FRAMES * CASE_REGIONS_MAX], shaded_count[4]; /* begin of colours */
};

static uint32_t turned(const struct timing_case *w, const struct schedule *schedule, uint32_t rank,
                       uint32_t k) {
    return schedule->takes_turns ? (rank + w->rendering_nodes * 100 - k) % w->rendering_nodes
                                 : rank;
}

/* Moves of one region: variables first..first + count - 1. */
static void add_moves(struct graph *g, struct world *world, const struct machine *m,
                      const struct timing_case *w, const struct schedule *schedule, int f,
                      uint32_t k, const int raster[CASE_NODES_MAX],
                      const ticks cost[CASE_NODES_MAX], int geometry, ticks geometry_time,
                      int first, ticks colours) {
    const struct timing_region *region = &w->regions[f][k];
    const uint32_t j = case_shading_node(w, f, k);
    ticks length[MOVES_MAX];
    for (size_t i = 0; i < schedule->count; i++) {
        const struct schedule_move *move = &schedule->moves[i];
        const uint32_t from = turned(w, schedule, move->from, k);
        const uint32_t to =
            move->to == SCHEDULE_SHADING ? CASE_NODES_MAX + j : turned(w, schedule, move->to, k);
        const int x = first + (int)i;
        const ticks words = (ticks)(move->end - move->first) * region->words;
        length[i] = m->composition_word * (words ? words : 1);
        rule(g, x, geometry, geometry_time);
        if (raster[from] >= 0)
            rule(g, x, raster[from], cost[from]);
        for (size_t before = 0; before < i; before++)
            if (schedule->moves[before].to == move->from &&
                schedule->moves[before].step < move->step)
                rule(g, x, first + (int)before, length[before] + m->composition_hop);
        follow(g, &world->out[from], x, length[i]);
        follow(g, &world->in[to], x, length[i]);
        const int n = world->shaded_count[j];
        if (move->to == SCHEDULE_SHADING && region->words && n >= m->composition_region_buffers)
            rule(g, x, world->shaded[j][n - m->composition_region_buffers],
                 colours - 2 * m->composition_hop);
    }
    for (uint32_t i = 0; i < w->rendering_nodes; i++)
        if (raster[i] >= 0) {
            const int n = world->sent_count[i]++;
            for (size_t move = 0; move < schedule->count; move++)
                if (turned(w, schedule, schedule->moves[move].from, k) == i) {
                    const int c = world->sent[i][n].count++;
                    world->sent[i][n].at[c] = first + (int)move;
                    world->sent[i][n].length[c] = length[move];
                }
        }
}

static void build(struct graph *g, const struct machine *m, const struct timing_case *w,
                  const struct schedule *schedule, int frame_end[CASE_FRAMES]) {
    struct world *world = memory_get(1, sizeof *world);
    const ticks hop = m->composition_hop, colours = m->composition_word * 8192 * m->colour_words;
    int geometry_before = 0, end_before = 0;
    ticks geometry_before_time = 0;
    g->variables = 1;
    for (int f = 0; f < CASE_FRAMES; f++) {
        const ticks geometry_time = (ticks)((w->geometry_bytes[f] + 3) / 4) * m->geometry_word;
        const int geometry = g->variables++, end = g->variables++;
        rule(g, geometry, geometry_before, geometry_before_time);
        rule(g, end, geometry, geometry_time);
        rule(g, end, end_before, 0);
        for (uint32_t k = 0; k < w->regions_per_frame; k++) {
            const struct timing_region *region = &w->regions[f][k];
            const uint32_t j = case_shading_node(w, f, k);
            int raster[CASE_NODES_MAX];
            ticks cost[CASE_NODES_MAX];
            memset(raster, -1, sizeof raster);
            for (uint32_t e = 0; e < region->work_count; e++) {
                const uint32_t i = region->work[e].node;
                const int n = world->sent_count[i] - (int)m->composition_region_buffers;
                raster[i] = g->variables++;
                cost[i] = m->raster_region + m->raster_triangle * region->work[e].triangles;
                rule(g, raster[i], geometry, geometry_time);
                for (int c = 0; n >= 0 && c < world->sent[i][n].count; c++)
                    rule(g, raster[i], world->sent[i][n].at[c], world->sent[i][n].length[c]);
                follow(g, &world->raster[i], raster[i], cost[i]);
            }
            const int first = g->variables;
            g->variables += (int)schedule->count;
            add_moves(g, world, m, w, schedule, f, k, raster, cost, geometry, geometry_time, first,
                      colours);
            const int shade = g->variables++, colour = g->variables++;
            for (size_t i = 0; i < schedule->count; i++) {
                const struct schedule_move *move = &schedule->moves[i];
                const ticks words = (ticks)(move->end - move->first) * region->words;
                const ticks length = m->composition_word * (words ? words : 1);
                if (move->to == SCHEDULE_SHADING && region->words)
                    rule(g, shade, first + (int)i, length + hop);
                else if (move->to == SCHEDULE_SHADING)
                    rule(g, end, first + (int)i, length + 2 * hop);
            }
            if (!region->words)
                continue;
            follow(g, &world->shade[j], shade, region->shading);
            rule(g, colour, shade, region->shading + hop);
            follow(g, &world->colour, colour, colours);
            rule(g, end, colour, colours);
            world->shaded[j][world->shaded_count[j]++] = colour;
        }
        geometry_before = geometry;
        geometry_before_time = geometry_time;
        end_before = frame_end[f] = end;
    }
    free(world);
}

static void times_agree_to_the_tick_with_the_rules_as_a_graph(void **state) {
    (void)state;
    struct rng rng = {4711};
    struct timing_case *w = malloc(sizeof *w);
    int compared = 0;
    for (int round = 0; round < 10000; round++) {
        const struct strategy *strategy = strategy_at(1 + round % 4);
        struct graph graph = {0};
        int end[CASE_FRAMES];
        random_case_of_strategies(&rng, w);
        const struct machine machine = w->machine;
        struct schedule *schedule = schedule_create(strategy->plan, w->rendering_nodes, 8192);
        assert_true(schedule->count <= MOVES_MAX);
        build(&graph, &machine, w, schedule, end);
        graph_solve(&graph);
        struct timing_model *model =
            timing_model_create(&machine, strategy, w->rendering_nodes, w->shading_nodes);
        for (int f = 0; f < CASE_FRAMES; f++) {
            struct timing_result result;
            const struct timing_frame frame = case_frame(w, f);
            assert_true(timing_model_add_frame(model, &frame, &result, NULL));
            if (result.end != graph.at[end[f]])
                fail_msg("%s, round %d, frame %d: %lld, by the graph %lld", strategy->name, round,
                         f, (long long)result.end, (long long)graph.at[end[f]]);
            compared++;
        }
        timing_model_destroy(model);
        schedule_destroy(schedule);
        graph_finish(&graph);
    }
    assert_true(compared == 10000 * CASE_FRAMES);
    free(w);
}

static ticks time_of(const struct machine *machine, const struct strategy *strategy,
                     const struct timing_case *w) {
    struct timing_model *model =
        timing_model_create(machine, strategy, w->rendering_nodes, w->shading_nodes);
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
    struct rng rng = {99};
    struct timing_case *w = malloc(sizeof *w);
    for (int round = 0; round < 2000; round++) {
        const struct strategy *strategy = strategy_at(1 + round % 4);
        random_case_of_strategies(&rng, w);
        const struct machine machine = w->machine;
        const ticks whole = time_of(&machine, strategy, w);
        struct machine better = machine;
        better.composition_hop /= 2;
        assert_true(time_of(&better, strategy, w) <= whole);
        better = machine;
        better.composition_word = 1;
        assert_true(time_of(&better, strategy, w) <= whole);
        better = machine;
        better.composition_region_buffers++;
        assert_true(time_of(&better, strategy, w) <= whole);
        struct timing_region *region =
            &w->regions[rng_below(&rng, CASE_FRAMES)][rng_below(&rng, w->regions_per_frame)];
        region->shading /= 2;
        assert_true(time_of(&machine, strategy, w) <= whole);
        region->words /= 2;
        region->shading = region->words ? region->shading : 0;
        assert_true(time_of(&machine, strategy, w) <= whole);
    }
    free(w);
}

/* No raster, no shading, no latency: regions at the pace of the busiest port. */
static void ports_set_the_pace(void **state) {
    (void)state;
    static const struct {
        const char *name;
        uint32_t s;
        ticks expected; /* regions' worth of words through the busiest port, per frame */
    } cases[] = {
        {"direct-send", 1, 16 * 8}, /* the one shading node takes each region 8 times */
        {"direct-send", 8, 16},     /* eight take turns */
        {"chain", 1, 16},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct machine machine = {.region_width = 128,
                                  .region_height = 64,
                                  .geometry_word_bytes = 4,
                                  .rate = {1000000000},
                                  .composition_word = 1,
                                  .geometry_word = 1,
                                  .colour_words = 1,
                                  .composition_region_buffers = 8,
                                  .geometry_frame_buffers = 2};
        struct timing_region regions[16];
        for (int k = 0; k < 16; k++)
            regions[k] = (struct timing_region){.words = 1};
        const struct timing_frame frame = {0, regions, 16, NULL};
        struct timing_model *model =
            timing_model_create(&machine, strategy_find(cases[c].name), 8, cases[c].s);
        struct timing_result result;
        assert_true(timing_model_add_frame(model, &frame, &result, NULL));
        assert_int_equal(result.composition_busy, cases[c].expected * 8192);
        timing_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_sample_of_each_node_arrives_once),
        cmocka_unit_test(steps_and_volumes_are_those_of_the_literature),
        cmocka_unit_test(ranks_and_nodes_belong_together_and_take_turns),
        cmocka_unit_test(times_agree_to_the_tick_with_the_rules_as_a_graph),
        cmocka_unit_test(less_of_anything_never_takes_longer),
        cmocka_unit_test(ports_set_the_pace),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
