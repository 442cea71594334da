/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "netsim/timeline.h"
#include "tests/netsim/event_simulation.h"

#include <stdlib.h>

static const struct timing_limits limits = {CASE_REGIONS_MAX, 5, 5};

static void solve(const struct timing_case *c, ticks end[CASE_FRAMES], struct timeline *timeline) {
    struct timing_model *model =
        timing_model_create(&c->machine, &strategy_chain, c->rendering_nodes, c->shading_nodes);
    timing_model_record(model, timeline);
    for (int f = 0; f < CASE_FRAMES; f++) {
        const struct timing_frame frame = case_frame(c, f);
        struct timing_result result;
        assert_true(timing_model_add_frame(model, &frame, &result, NULL));
        end[f] = result.end;
    }
    timing_model_destroy(model);
}

static void the_solver_agrees_to_the_tick_with_a_simulation_event_by_event(void **state) {
    (void)state;
    struct rng rng = {31};
    struct timing_case *c = malloc(sizeof *c);
    for (int round = 0; round < 10000; round++) {
        ticks solved[CASE_FRAMES], simulated[CASE_FRAMES];
        random_case(&rng, limits, c);
        solve(c, solved, NULL);
        simulate_events(c, simulated);
        for (int f = 0; f < CASE_FRAMES; f++)
            if (solved[f] != simulated[f])
                fail_msg("case %d, frame %d: solved %lld, simulated %lld", round, f,
                         (long long)solved[f], (long long)simulated[f]);
    }
    free(c);
}

/* Every activity begins when its cause lets it; what a resource did and waited for fills the frame;
 * the critical path is as long as the frame. */
static void reasons_and_critical_paths_add_up_to_the_frame_time(void **state) {
    (void)state;
    struct rng rng = {32};
    struct timing_case *c = malloc(sizeof *c);
    uint32_t seen[TIMELINE_WAIT_COUNT] = {0}, backward = 0;
    for (int round = 0; round < 10000; round++) {
        ticks end[CASE_FRAMES];
        random_case(&rng, limits, c);
        struct timeline *timeline =
            timeline_create(&c->machine, c->rendering_nodes, c->shading_nodes);
        solve(c, end, timeline);
        uint32_t frame_count;
        const struct timeline_frame *frames = timeline_frames(timeline, &frame_count);
        const uint32_t resources = timeline_resource_count(timeline);
        struct timeline_use *uses = timeline_uses(timeline);
        assert_int_equal(frame_count, CASE_FRAMES);
        for (uint32_t f = 0; f < CASE_FRAMES; f++) {
            const ticks time = end[f] - (f ? end[f - 1] : 0);
            ticks at = frames[f].begin;
            size_t count;
            struct timeline_step *steps = timeline_critical_path(timeline, f, &count);
            assert_int_equal(frames[f].end - frames[f].begin, time);
            for (size_t i = 0; i < count; i++) {
                assert_int_equal(steps[i].begin, at);
                assert_true(steps[i].end > steps[i].begin || steps[i].kind == TIMELINE_HOPS);
                backward += steps[i].end < steps[i].begin;
                at = steps[i].end;
            }
            assert_int_equal(at, end[f]);
            free(steps);
            for (uint32_t r = 0; r < resources; r++) {
                const struct timeline_use *use = &uses[f * resources + r];
                ticks sum = use->busy;
                for (int wait = 0; wait < TIMELINE_WAIT_COUNT; wait++) {
                    sum += use->idle[wait];
                    seen[wait] += use->idle[wait] > 0;
                }
                assert_int_equal(sum, time);
                assert_int_equal(use->idle[TIMELINE_WAIT_NOTHING], 0);
            }
        }
        free(uses);
        timeline_destroy(timeline);
    }
    for (int wait = TIMELINE_WAIT_NOTHING + 1; wait < TIMELINE_WAIT_COUNT; wait++)
        assert_true(seen[wait] > 100);
    /* steps that count back are the exception: hops to a node farther up the chain */
    assert_true(backward < 3000);
    free(c);
}

static ticks last_end(const struct timing_case *c) {
    ticks end[CASE_FRAMES];
    solve(c, end, NULL);
    return end[CASE_FRAMES - 1];
}

/* Each improves one thing about a case at random. */
static void more_bandwidth(struct rng *rng, struct timing_case *c) {
    c->machine.composition_word -= c->machine.composition_word > 1;
}
static void more_geometry_bandwidth(struct rng *rng, struct timing_case *c) {
    c->machine.geometry_word -= c->machine.geometry_word > 1;
}
static void fewer_words(struct rng *rng, struct timing_case *c) {
    struct timing_region *region =
        &c->regions[rng_below(rng, CASE_FRAMES)][rng_below(rng, c->regions_per_frame)];
    region->words -= region->words > 1;
}
static void less_geometry(struct rng *rng, struct timing_case *c) {
    c->geometry_bytes[rng_below(rng, CASE_FRAMES)] /= 2;
}
static void lower_latency(struct rng *rng, struct timing_case *c) {
    c->machine.composition_hop = c->machine.composition_hop * (ticks)rng_below(rng, 4) / 4;
}
static void more_region_buffers(struct rng *rng, struct timing_case *c) {
    c->machine.composition_region_buffers += 1 + (int64_t)rng_below(rng, 4);
}
static void more_frame_buffers(struct rng *rng, struct timing_case *c) {
    c->machine.geometry_frame_buffers++;
}
static void faster_raster(struct rng *rng, struct timing_case *c) {
    c->machine.raster_triangle /= 2;
    c->machine.raster_region /= 2;
}
static void faster_shading(struct rng *rng, struct timing_case *c) {
    for (int f = 0; f < CASE_FRAMES; f++)
        c->regions[f][rng_below(rng, c->regions_per_frame)].shading /= 2;
}
static void fewer_triangles(struct rng *rng, struct timing_case *c) {
    struct timing_region *region =
        &c->regions[rng_below(rng, CASE_FRAMES)][rng_below(rng, c->regions_per_frame)];
    struct timing_work *work = (struct timing_work *)region->work;
    for (uint32_t w = 0; w < region->work_count; w++)
        work[w].triangles /= 2;
}

static void less_of_anything_never_takes_longer(void **state) {
    (void)state;
    static const struct {
        const char *name;
        void (*improve)(struct rng *, struct timing_case *);
    } laws[] = {{"composition bandwidth", more_bandwidth},
                {"geometry bandwidth", more_geometry_bandwidth},
                {"words", fewer_words},
                {"geometry", less_geometry},
                {"latency", lower_latency},
                {"region buffers", more_region_buffers},
                {"frame buffers", more_frame_buffers},
                {"raster", faster_raster},
                {"shading", faster_shading},
                {"triangles", fewer_triangles}};
    struct rng rng = {33};
    struct timing_case *c = malloc(sizeof *c);
    uint32_t shorter[sizeof laws / sizeof *laws] = {0};
    for (int round = 0; round < 20000; round++) {
        random_case(&rng, limits, c);
        const size_t law = (size_t)round % (sizeof laws / sizeof *laws);
        const ticks before = last_end(c);
        laws[law].improve(&rng, c);
        const ticks after = last_end(c);
        if (after > before)
            fail_msg("case %d: better %s takes longer: %lld instead of %lld", round, laws[law].name,
                     (long long)after, (long long)before);
        shorter[law] += after < before;
    }
    for (size_t law = 0; law < sizeof laws / sizeof *laws; law++)
        if (!shorter[law])
            fail_msg("better %s never made a difference", laws[law].name);
    free(c);
}

/* Ticks `factor` times as fine. */
static void refine(struct timing_case *c, ticks factor) {
    c->machine.rate.per_s *= (uint64_t)factor;
    ticks *times[] = {&c->machine.composition_word, &c->machine.composition_hop,
                      &c->machine.geometry_word, &c->machine.raster_triangle,
                      &c->machine.raster_region};
    for (size_t i = 0; i < sizeof times / sizeof *times; i++)
        *times[i] *= factor;
    for (int f = 0; f < CASE_FRAMES; f++)
        for (uint32_t k = 0; k < c->regions_per_frame; k++)
            c->regions[f][k].shading *= factor;
}

static void finer_ticks_give_the_same_times(void **state) {
    (void)state;
    struct rng rng = {34};
    struct timing_case *c = malloc(sizeof *c);
    for (int round = 0; round < 2000; round++) {
        random_case(&rng, limits, c);
        const ticks at_t = last_end(c);
        const uint64_t rate = c->machine.rate.per_s;
        refine(c, 2);
        assert_int_equal(last_end(c), 2 * at_t);
        refine(c, 7);
        assert_int_equal(last_end(c), 14 * at_t);
        assert_int_equal(c->machine.rate.per_s, 14 * rate);
    }
    free(c);
}

/* docs/timing.md, "A worked example": times by hand, in clocks of 5 ns. */
static void the_worked_example_comes_out_as_by_hand(void **state) {
    (void)state;
    struct machine machine;
    assert_true(machine_read_file(MACHINES "/pixelflow.json", &machine, NULL));
    const struct timing_work triangle = {0, 1};
    const struct timing_region region = {1, 20000, &triangle, 1}, both[2] = {region, region};
    const struct timing_frame frame = {4000, both, 2, NULL};
    struct timing_model *model = timing_model_create(&machine, &strategy_chain, 1, 1);
    struct timeline *timeline = timeline_create(&machine, 1, 1);
    struct timing_result result;
    timing_model_record(model, timeline);
    assert_true(timing_model_add_frame(model, &frame, &result, NULL));
    size_t count;
    const struct timeline_activity *all = timeline_activities(timeline, &count);
    static const struct {
        enum timeline_kind kind;
        double begin_us, end_us;
    } by_hand[] = {{TIMELINE_GEOMETRY, 0, 5},
                   {TIMELINE_RASTER, 5, 5.715},
                   {TIMELINE_TRANSFER, 5.715, 46.675},
                   {TIMELINE_SHADING, 46.695, 146.695},
                   {TIMELINE_COLOURS, 146.715, 187.675},
                   {TIMELINE_RASTER, 5.715, 6.43},
                   {TIMELINE_TRANSFER, 46.675, 87.635},
                   {TIMELINE_SHADING, 146.695, 246.695},
                   {TIMELINE_COLOURS, 246.715, 287.675}};
    assert_int_equal(count, sizeof by_hand / sizeof *by_hand);
    for (size_t i = 0; i < count; i++) {
        assert_int_equal(all[i].kind, by_hand[i].kind);
        assert_int_equal(all[i].begin, (ticks)(by_hand[i].begin_us * 200 + 0.5));
        assert_int_equal(all[i].end, (ticks)(by_hand[i].end_us * 200 + 0.5));
    }
    assert_int_equal(result.end, 57535);
    assert_int_equal(result.composition_busy, 16384);
    assert_int_equal(result.bound_by, TIMING_SHADING);
    timeline_destroy(timeline);
    timing_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_worked_example_comes_out_as_by_hand),
        cmocka_unit_test(the_solver_agrees_to_the_tick_with_a_simulation_event_by_event),
        cmocka_unit_test(reasons_and_critical_paths_add_up_to_the_frame_time),
        cmocka_unit_test(less_of_anything_never_takes_longer),
        cmocka_unit_test(finer_ticks_give_the_same_times),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
