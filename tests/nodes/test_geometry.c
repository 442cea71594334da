/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/rng.h"
#include "nodes/triangle_setup.h"
#include "nodes/visibility.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct machine pixelflow(void) {
    struct machine machine;
    assert_true(machine_read_file(MACHINES "/pixelflow.json", &machine, NULL));
    return machine;
}

static struct frame_payload camera(uint32_t width, uint32_t height, bool is_perspective) {
    return (struct frame_payload){.width = width,
                                  .height = height,
                                  .samples_x = 1,
                                  .samples_y = 1,
                                  .is_perspective = is_perspective,
                                  .screen_window = {-1, 1, -1, 1},
                                  .near_plane = 0.1,
                                  .far_plane = 1e30,
                                  .image_path = ""};
}

static void random_triangle(struct rng *rng, float v[9]) {
    const double size = pow(10, rng_unit(rng) * 4 - 3);
    double centre[3] = {rng_unit(rng) * 6 - 3, rng_unit(rng) * 6 - 3, rng_unit(rng) * 8 - 1};
    for (int i = 0; i < 9; i++)
        v[i] = (float)(centre[i % 3] + size * (rng_unit(rng) - 0.5));
}

/* The place of a ray on a triangle by the textbook, in long double: plane, then edge products. */
static bool textbook_hit(const float v[9], float x, float y, bool is_perspective,
                         long double *depth, long double weight[3]) {
    long double e1[3], e2[3], d[3] = {is_perspective ? x : 0, is_perspective ? y : 0, 1},
                              o[3] = {0};
    if (!is_perspective)
        o[0] = x, o[1] = y;
    for (int i = 0; i < 3; i++) {
        e1[i] = (long double)v[3 + i] - v[i];
        e2[i] = (long double)v[6 + i] - v[i];
    }
    const long double p[3] = {d[1] * e2[2] - d[2] * e2[1], d[2] * e2[0] - d[0] * e2[2],
                              d[0] * e2[1] - d[1] * e2[0]};
    const long double det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    if (fabsl(det) < 1e-12L)
        return false;
    const long double t[3] = {o[0] - v[0], o[1] - v[1], o[2] - v[2]};
    const long double q[3] = {t[1] * e1[2] - t[2] * e1[1], t[2] * e1[0] - t[0] * e1[2],
                              t[0] * e1[1] - t[1] * e1[0]};
    weight[1] = (t[0] * p[0] + t[1] * p[1] + t[2] * p[2]) / det;
    weight[2] = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
    weight[0] = 1 - weight[1] - weight[2];
    *depth = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
    return true;
}

static void setup_gives_depth_and_weights_of_the_textbook(void **state) {
    (void)state;
    struct rng rng = {9};
    int compared = 0;
    for (int round = 0; round < 20000; round++) {
        const bool is_perspective = round % 2;
        float v[9];
        struct triangle_setup setup;
        long double depth, weight[3];
        random_triangle(&rng, v);
        const float x = (float)(rng_unit(&rng) * 2 - 1), y = (float)(rng_unit(&rng) * 2 - 1);
        if (!triangle_setup_make(v, v + 3, v + 6, is_perspective, &setup) ||
            !textbook_hit(v, x, y, is_perspective, &depth, weight))
            continue;
        if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0 || depth < 0.01L)
            continue;
        const float ours = triangle_setup_depth(&setup, x, y);
        assert_true(fabsl(ours - depth) <= 1e-6L * depth);
        double w[3], sum = 0;
        for (int i = 0; i < 3; i++) {
            w[i] = setup.weight[i][0] * x + setup.weight[i][1] * y + setup.weight[i][2];
            sum += w[i];
        }
        for (int i = 0; i < 3; i++)
            assert_true(fabsl(w[i] / sum - weight[i]) < 1e-6L);
        compared++;
    }
    assert_true(compared > 100);
}

static void degenerate_triangles_have_no_setup(void **state) {
    (void)state;
    struct triangle_setup setup;
    const float a[] = {0, 0, 1}, b[] = {1, 0, 1}, c[] = {2, 0, 1}, nan[] = {NAN, 0, 1},
                inf[] = {INFINITY, 0, 1};
    assert_false(triangle_setup_make(a, b, c, true, &setup));
    assert_false(triangle_setup_make(a, a, b, false, &setup));
    assert_false(triangle_setup_make(a, b, nan, true, &setup));
    assert_false(triangle_setup_make(inf, b, c, true, &setup));
}

/* By looking at every sample of the region. */
static bool region_is_covered(const struct frame_payload *frame, const struct region_grid *grid,
                              uint32_t region, const struct triangle_setup *setup) {
    uint32_t x0, y0;
    region_grid_origin(grid, region, &x0, &y0);
    for (uint32_t y = y0; y < y0 + grid->region_height && y < frame->height; y++)
        for (uint32_t x = x0; x < x0 + grid->region_width && x < frame->width; x++) {
            const float sx = region_grid_screen_x(grid, frame, x),
                        sy = region_grid_screen_y(grid, frame, y);
            const float depth = triangle_setup_depth(setup, sx, sy);
            if (triangle_setup_is_inside(setup, sx, sy) && depth >= frame->near_plane &&
                depth <= frame->far_plane)
                return true;
        }
    return false;
}

static void a_region_counts_as_covered_where_a_sample_of_it_is(void **state) {
    (void)state;
    const struct machine machine = pixelflow();
    struct rng rng = {22};
    int covered = 0, touched = 0;
    for (int round = 0; round < 1500; round++) {
        const struct frame_payload frame = camera(300 + round % 7, 150, round % 2);
        const struct region_grid grid = region_grid_make(&frame, &machine);
        struct region_bins bins;
        struct triangle_setup setup;
        float v[9];
        random_triangle(&rng, v);
        for (int i = 0; round % 3 == 0 && i < 9; i++) /* slivers between samples, too */
            v[i] = i % 3 == 2 ? v[2] : v[i % 3] + (v[i] - v[i % 3]) * 0.004f;
        if (!triangle_setup_make(v, v + 3, v + 6, frame.is_perspective, &setup))
            continue;
        region_bins_init(&bins, &grid, true);
        region_bins_add(&bins, &frame, &(struct binned_triangle){{v, v + 3, v + 6}, &setup, 5, 9});
        for (uint32_t k = 0; k < grid.count; k++) {
            const bool is_covered = region_is_covered(&frame, &grid, k, &setup);
            assert_int_equal(bins.bins[k] && bins.bins[k]->is_covered, is_covered);
            covered += is_covered;
        }
        for (size_t e = 0; e < bins.entry_count; e++) {
            const struct chunk_work *entry = &bins.entries[e];
            assert_int_equal(entry->chunk, 5);
            assert_int_equal(entry->triangles, bins.bins[entry->region]->triangles);
            assert_int_equal(entry->covers, bins.bins[entry->region]->is_covered);
            assert_int_equal(bins.bins[entry->region]->longest_map, entry->covers ? 9 : 0);
            touched += !entry->covers;
        }
        region_bins_finish(&bins);
    }
    if (covered < 400 || touched < 400)
        fail_msg("only %d regions covered, %d touched without", covered, touched);
}

static void every_sample_inside_a_triangle_lies_in_a_marked_tile(void **state) {
    (void)state;
    const struct machine machine = pixelflow();
    struct rng rng = {21};
    int inside = 0;
    for (int round = 0; round < 400; round++) {
        const struct frame_payload frame = camera(150 + round % 7, 90, round % 2);
        const struct region_grid grid = region_grid_make(&frame, &machine);
        struct region_bins bins;
        float v[9];
        random_triangle(&rng, v);
        struct triangle_setup setup;
        if (!triangle_setup_make(v, v + 3, v + 6, frame.is_perspective, &setup))
            continue;
        region_bins_init(&bins, &grid, true);
        const struct sample_box box = region_bins_add(
            &bins, &frame, &(struct binned_triangle){{v, v + 3, v + 6}, &setup, 5, 9});
        for (uint32_t y = 0; y < frame.height; y++)
            for (uint32_t x = 0; x < frame.width; x++) {
                long double depth, w[3];
                const float sx = region_grid_screen_x(&grid, &frame, x),
                            sy = region_grid_screen_y(&grid, &frame, y);
                if (!textbook_hit(v, sx, sy, frame.is_perspective, &depth, w) || w[0] < 0 ||
                    w[1] < 0 || w[2] < 0 || depth < frame.near_plane)
                    continue;
                const uint32_t k = y / grid.region_height * grid.columns + x / grid.region_width;
                assert_non_null(bins.bins[k]);
                assert_true(region_bin_has_tile(&bins, bins.bins[k],
                                                x % grid.region_width / TILE_SAMPLES,
                                                y % grid.region_height / TILE_SAMPLES));
                assert_true(x >= box.x0 && x <= box.x1 && y >= box.y0 && y <= box.y1);
                inside++;
            }
        region_bins_finish(&bins);
    }
    assert_true(inside > 10000);
}

/* One chunk of the triangles given; the arrays must outlive it. */
static struct chunk_payload chunk_of(const float *positions, uint32_t triangles,
                                     uint16_t *indices) {
    for (uint32_t i = 0; i < triangles * 3; i++)
        indices[i] = (uint16_t)i;
    return (struct chunk_payload){.shader_id = 1,
                                  .vertex_count = triangles * 3,
                                  .triangle_count = triangles,
                                  .positions = positions,
                                  .triangles = indices};
}

static uint32_t covered_samples(const struct frame_payload *frame,
                                const struct chunk_payload *chunk) {
    const struct machine machine = pixelflow();
    const struct region_grid grid = region_grid_make(frame, &machine);
    struct visibility_device *device;
    struct visibility *visibility;
    uint32_t covered = 0;
    assert_true(visibility_device_create(&device, NULL));
    assert_true(visibility_create(device, frame, &grid, chunk, 1, false, &visibility, NULL));
    for (uint32_t k = 0; k < grid.count; k++) {
        struct region_view view;
        if (!visibility_bins(visibility)->bins[k])
            continue;
        struct region_draft draft = visibility_render(visibility, k, 0);
        struct message *message = region_seal(&draft, 0, k, 0);
        assert_true(region_open(message->bytes, message->length,
                                grid.region_width * grid.region_height, &view, NULL));
        covered += view.head.sample_count;
        message_release(message);
    }
    visibility_destroy(visibility);
    visibility_device_destroy(device);
    return covered;
}

static void a_full_screen_mesh_covers_every_sample_in_any_vertex_order(void **state) {
    (void)state;
    /* edges and the common vertex lie exactly on sample centres: 15 x 9 samples, the middle one at
     * (0, 0) */
    static const float corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int is_perspective = 0; is_perspective < 2; is_perspective++)
        for (int order = 0; order < 6; order++) {
            static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                             {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
            const struct frame_payload frame = camera(15, 9, is_perspective);
            float positions[4 * 9];
            uint16_t indices[12];
            for (int t = 0; t < 4; t++) {
                const float fan[3][3] = {
                    {0, 0, 2},
                    {2 * corner[t][0], 2 * corner[t][1], 2},
                    {2 * corner[(t + 1) % 4][0], 2 * corner[(t + 1) % 4][1], 2}};
                for (int i = 0; i < 3; i++)
                    memcpy(positions + t * 9 + i * 3, fan[orders[order][i]], 3 * sizeof(float));
            }
            const struct chunk_payload chunk = chunk_of(positions, 4, indices);
            assert_int_equal(covered_samples(&frame, &chunk), 15 * 9);
        }
}

static void extreme_triangles_do_no_harm(void **state) {
    (void)state;
    const float extremes[] = {0,          -0.0f,   1e-30f, 1e30f,    -1e30f,    FLT_MAX,
                              -FLT_MAX,   FLT_MIN, 1e-45f, INFINITY, -INFINITY, NAN,
                              8388608.5f, 1,       -1,     0.1f};
    struct rng rng = {4};
    const struct frame_payload frame = camera(129, 65, true);
    for (int round = 0; round < 300; round++) {
        float positions[9];
        uint16_t indices[3];
        for (int i = 0; i < 9; i++)
            positions[i] = extremes[rng_below(&rng, sizeof extremes / sizeof *extremes)];
        const struct chunk_payload chunk = chunk_of(positions, 1, indices);
        assert_true(covered_samples(&frame, &chunk) <= 129 * 65);
    }
}

static void nothing_in_front_of_near_or_behind_far_is_seen(void **state) {
    (void)state;
    uint16_t indices[3];
    struct frame_payload frame = camera(64, 64, true);
    frame.near_plane = 1;
    frame.far_plane = 10;
    for (int i = 0; i < 4; i++) {
        const float z[] = {0.5f, 1.5f, 9.5f, 10.5f};
        const float positions[] = {-90, -90, z[i], 90, -90, z[i], 0, 90, z[i]};
        const struct chunk_payload chunk = chunk_of(positions, 1, indices);
        assert_true((covered_samples(&frame, &chunk) > 0) == (i == 1 || i == 2));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(setup_gives_depth_and_weights_of_the_textbook),
        cmocka_unit_test(degenerate_triangles_have_no_setup),
        cmocka_unit_test(every_sample_inside_a_triangle_lies_in_a_marked_tile),
        cmocka_unit_test(a_region_counts_as_covered_where_a_sample_of_it_is),
        cmocka_unit_test(a_full_screen_mesh_covers_every_sample_in_any_vertex_order),
        cmocka_unit_test(extreme_triangles_do_no_harm),
        cmocka_unit_test(nothing_in_front_of_near_or_behind_far_is_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
