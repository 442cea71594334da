/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/rng.h"
#include "nodes/visibility_kernels.h"

#include <string.h>

/* A triangle of any size around the picture, some of them needles, a few nearly without depth. */
static bool random_setup(struct rng *rng, struct triangle_setup *setup) {
    float v[9];
    for (int i = 0; i < 9; i++)
        v[i] = (float)(rng_unit(rng) * 4 - 2);
    for (int i = 2; i < 9; i += 3)
        v[i] = (float)(1 + rng_unit(rng) * (rng_below(rng, 8) ? 3 : 1e-6));
    if (!rng_below(rng, 4))
        memcpy(v + 3, v, 2 * sizeof *v); /* an edge along the line of sight */
    if (!rng_below(rng, 4))
        v[6] = v[3] + 1e-6f, v[7] = v[4];
    return triangle_setup_make(v, v + 3, v + 6, true, setup);
}

static void random_lanes(struct rng *rng, struct packet_lanes *lanes) {
    for (int i = 0; i < PACKET_LANES; i++) {
        const float x = (float)(rng_unit(rng) * 2 - 1), y = (float)(rng_unit(rng) * 2 - 1);
        lanes->x[i] = x;
        lanes->y[i] = y;
        lanes->tolerance[i] = triangle_setup_tolerance(x, y);
        lanes->column[i] = (uint32_t)rng_below(rng, 100);
        lanes->row[i] = (uint32_t)rng_below(rng, 100);
        lanes->depth[i] = rng_below(rng, 2) ? INFINITY : (float)(1 + 3 * rng_unit(rng));
        lanes->triangle[i] = (uint32_t)rng_below(rng, 50);
        lanes->primitive[i] = (uint32_t)rng_below(rng, 1u << 31) * 2u;
    }
}

/* One lane at a time, as the rules are written. */
static uint32_t consider_by_the_book(struct packet_lanes *lanes, const struct packet_triangle *c,
                                     int32_t *valid) {
    uint32_t refused = 0;
    for (int i = 0; i < PACKET_LANES; i++) {
        if (!valid[i])
            continue;
        const float depth = triangle_setup_depth(c->setup, (float)lanes->x[i], (float)lanes->y[i]);
        refused += depth != depth;
        valid[i] = 0;
        if (!(depth >= c->near_plane) || !(depth <= c->far_plane) || lanes->column[i] < c->box.x0 ||
            lanes->column[i] > c->box.x1 || lanes->row[i] < c->box.y0 ||
            lanes->row[i] > c->box.y1 ||
            !triangle_setup_is_inside(c->setup, lanes->x[i], lanes->y[i]))
            continue;
        valid[i] = -1;
        if (depth < lanes->depth[i] ||
            (depth == lanes->depth[i] && c->primitive < lanes->primitive[i])) {
            lanes->depth[i] = depth;
            lanes->triangle[i] = c->triangle;
            lanes->primitive[i] = c->primitive;
        }
    }
    return refused;
}

static void every_set_does_what_the_rules_say(void **state) {
    struct rng rng = {77};
    int seen = 0, nearer = 0, not_numbers = 0, ties = 0;
    for (int round = 0; round < 20000; round++) {
        struct triangle_setup setup;
        struct packet_lanes lanes = {0}, expected, actual;
        _Alignas(64) int32_t valid[PACKET_LANES], expected_valid[PACKET_LANES],
            actual_valid[PACKET_LANES];
        if (!random_setup(&rng, &setup))
            continue;
        if (!rng_below(&rng, 50)) /* 0 / 0 */
            memset(setup.depth_numerator, 0, sizeof setup.depth_numerator),
                memset(setup.depth_denominator, 0, sizeof setup.depth_denominator);
        random_lanes(&rng, &lanes);
        struct packet_triangle c = {&setup,
                                    {10, 80, 5, 90},
                                    51,
                                    (uint32_t)rng_below(&rng, 1u << 31) * 2u,
                                    rng_below(&rng, 3) ? 0 : 2,
                                    rng_below(&rng, 3) ? 1e9 : 3};
        for (int i = 0; i < PACKET_LANES; i++) {
            valid[i] = rng_below(&rng, 4) ? -1 : 0;
            if (!rng_below(&rng, 4)) { /* as deep as the best so far */
                lanes.depth[i] = triangle_setup_depth(&setup, (float)lanes.x[i], (float)lanes.y[i]);
                ties++;
            }
        }
        expected = lanes;
        memcpy(expected_valid, valid, sizeof valid);
        const uint32_t refused = consider_by_the_book(&expected, &c, expected_valid);
        not_numbers += refused != 0;
        for (int i = 0; i < PACKET_LANES; i++) {
            seen += expected_valid[i] != 0;
            nearer += expected.triangle[i] == 51;
        }
        for (int s = 0; visibility_kernels_at(s); s++) {
            actual = lanes;
            memcpy(actual_valid, valid, sizeof valid);
            assert_int_equal(visibility_kernels_at(s)->consider(&actual, &c, actual_valid),
                             refused);
            assert_memory_equal(actual_valid, expected_valid, sizeof valid);
            assert_memory_equal(&actual, &expected, sizeof actual);
        }
    }
    assert_true(seen > 4000 && nearer > 2000 && nearer < seen && not_numbers > 100 && ties > 1000);
}

static void every_set_interpolates_the_same_bits(void **state) {
    enum { MOST = 131 };
    struct rng rng = {78};
    float x[MOST], first[3][MOST], other[3][MOST], out[2][MOST];
    for (int round = 0; round < 3000; round++) {
        const uint32_t count = 1 + (uint32_t)rng_below(&rng, MOST);
        const float y = (float)(rng_unit(&rng) * 2 - 1);
        const float corner[3] = {(float)rng_unit(&rng), (float)(1e6 * rng_unit(&rng)),
                                 (float)(-3 * rng_unit(&rng))};
        struct triangle_setup setup;
        if (!random_setup(&rng, &setup))
            continue;
        for (uint32_t k = 0; k < count; k++)
            x[k] = (float)(rng_unit(&rng) * 2 - 1);
        for (int s = 0; visibility_kernels_at(s); s++) {
            const struct visibility_kernels *kernels = visibility_kernels_at(s);
            float *const planes[3] = {s ? other[0] : first[0], s ? other[1] : first[1],
                                      s ? other[2] : first[2]};
            kernels->weigh(&setup, x, y, count, planes);
            kernels->interpolate((const float *const *)planes, corner, count, out[s != 0]);
            for (int c = 0; s && c < 3; c++)
                assert_memory_equal(other[c], first[c], count * sizeof(float));
            assert_memory_equal(out[s != 0], out[0], count * sizeof(float));
            for (uint32_t k = 0; k < count; k++) /* they are shares */
                if (isfinite(planes[0][k]) && fabsf(planes[0][k]) < 100 &&
                    fabsf(planes[1][k]) < 100)
                    assert_true(fabs((double)planes[0][k] + planes[1][k] + planes[2][k] - 1) <
                                1e-3);
        }
    }
}

static void there_is_a_set_for_any_processor(void **state) {
    assert_non_null(visibility_kernels_at(0));
    assert_string_equal(visibility_kernels_at(0)->name, "sse2");
    assert_non_null(visibility_kernels_best());
    int count = 0;
    while (visibility_kernels_at(count))
        count++;
    assert_ptr_equal(visibility_kernels_best(), visibility_kernels_at(count - 1));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_set_does_what_the_rules_say),
        cmocka_unit_test(every_set_interpolates_the_same_bits),
        cmocka_unit_test(there_is_a_set_for_any_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
