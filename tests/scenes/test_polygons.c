/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/scenes/scene_test.h"

#include "base/rng.h"
#include "scenes/triangulate.h"

#include <stdio.h>

static void concave_polygons_keep_their_area(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading, IN_VIEW("Polygon \"P\" [0 0 0 3 0 0 3 3 0 2 3 0 2 1 0 1 1 0 1 3 0 0 3 0]"), NULL);
    const struct scene_mesh *mesh = &frame->meshes[0];
    check_mesh(mesh);
    check_winding(mesh);
    assert_int_equal(mesh->triangle_count, 6);
    assert_int_equal(mesh->vertex_count, 8);
    assert_true(fabs(mesh_area(mesh) - 7) < 1e-5);
    assert_true(variable_vec3(mesh, "N", 0).z == 1);
    frame_close(&reading, frame);
}

static void holes_are_cut_out(void **state) {
    static const char *const texts[] = {
        "GeneralPolygon [4 4 3] \"P\" [0 0 0 4 0 0 4 4 0 0 4 0  1 1 0 2 1 0 2 2 0 1 2 0  3 3 0 3.5 "
        "3 0 3 3.5 0]",
        "GeneralPolygon [4 4 3] \"P\" [0 0 0 0 4 0 4 4 0 4 0 0  1 1 0 2 1 0 2 2 0 1 2 0  3 3 0 3 "
        "3.5 0 3.5 3 0]",
        "Rotate 37 1 2 3 PointsGeneralPolygons [3] [4 4 3] [0 1 2 3 4 5 6 7 8 9 10] \"P\" "
        "[0 0 0 4 0 0 4 4 0 0 4 0  1 1 0 2 1 0 2 2 0 1 2 0  3 3 0 3.5 3 0 3 3.5 0]"};
    for (size_t k = 0; k < 3; k++) {
        char text[512];
        struct reading reading;
        snprintf(text, sizeof text, IN_VIEW("%s"), texts[k]);
        struct scene_frame *frame = read_frame(&reading, text, NULL);
        check_mesh(&frame->meshes[0]);
        check_winding(&frame->meshes[0]);
        assert_true(fabs(mesh_area(&frame->meshes[0]) - (16 - 1 - 0.125)) < 1e-5);
        frame_close(&reading, frame);
    }
}

/* Twice the area of the triangles, each of which must go round like the outline. */
static double triangles_area(const double *points, const uint32_t *triangles, size_t count,
                             double sign) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double *a = points + 2 * triangles[3 * i], *b = points + 2 * triangles[3 * i + 1],
                     *c = points + 2 * triangles[3 * i + 2];
        double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert_true(area * sign > -1e-9);
        sum += area;
    }
    return sum;
}

static void random_stars_with_holes_are_covered_exactly(void **state) {
    enum { ROUNDS = 2000, CORNERS_MAX = 40, HOLES_MAX = 5 };
    struct rng rng = {20};
    for (int round = 0; round < ROUNDS; round++) {
        double points[2 * (CORNERS_MAX + 8 * HOLES_MAX)], expected = 0;
        uint32_t triangles[3 * (CORNERS_MAX + 10 * HOLES_MAX + 2)];
        int loops[1 + HOLES_MAX], count = 3 + (int)rng_below(&rng, CORNERS_MAX - 2), at = 0;
        int holes = (int)rng_below(&rng, HOLES_MAX + 1);
        bool is_clockwise = rng_next(&rng) & 1;
        for (int loop = 0; loop <= holes; loop++) {
            int corners = loop ? 3 + (int)rng_below(&rng, 5) : count, first = at;
            double turn = loop ? 2 * M_PI * loop / (holes + 1e-9) : 0, size = loop ? 0.15 : 1;
            bool reverse = loop ? rng_next(&rng) & 1 : is_clockwise;
            for (int i = 0; i < corners; i++, at++) {
                double angle = 2 * M_PI * (reverse ? corners - i : i) / corners;
                double r = size * (loop ? 0.3 + rng_unit(&rng) : 3 + 2 * rng_unit(&rng)) *
                           (count < 6 && !loop ? 3 : 1);
                points[2 * at] = r * cos(angle) + (loop ? 0.8 * cos(turn) : 0);
                points[2 * at + 1] = r * sin(angle) + (loop ? 0.8 * sin(turn) : 0);
            }
            loops[loop] = corners;
            double area = 0;
            for (int i = first; i < at; i++) {
                int j = i + 1 < at ? i + 1 : first;
                area += points[2 * i] * points[2 * j + 1] - points[2 * j] * points[2 * i + 1];
            }
            expected += loop ? -fabs(area) : fabs(area);
        }
        size_t triangle_count;
        double sign = is_clockwise ? -1 : 1;
        assert_true(
            triangulate_polygon(points, loops, holes + 1, triangles, &triangle_count, NULL));
        assert_int_equal(triangle_count, at + 2 * holes - 2);
        assert_true(
            fabs(sign * triangles_area(points, triangles, triangle_count, sign) - expected) < 1e-9);
    }
}

static void degenerate_outlines_give_triangles_of_their_corners(void **state) {
    struct rng rng = {7};
    for (int round = 0; round < 5000; round++) {
        double points[40];
        uint32_t triangles[3 * 26];
        int loops[3] = {3 + (int)rng_below(&rng, 10), 3, 3},
            loop_count = 1 + (int)rng_below(&rng, 3);
        for (int i = 0; i < 40; i++)
            points[i] = (double)rng_below(&rng, 4); /* crossing, collinear, coincident */
        size_t count;
        assert_true(triangulate_polygon(points, loops, loop_count, triangles, &count, NULL));
        assert_true(count <= (size_t)(loops[0] + 6 + 2 * loop_count));
        for (size_t i = 0; i < 3 * count; i++)
            assert_true(triangles[i] < (uint32_t)(loops[0] + 3 * (loop_count - 1)));
    }
}

static void vertices_are_shared_unless_faces_differ(void **state) {
    static const struct {
        const char *variables;
        uint32_t vertices;
    } cases[] = {{"", 8},
                 {"\"N\" [0 0 -1 0 0 -1 0 0 -1 0 0 -1 0 0 -1 0 0 -1]", 6},
                 {"\"N\" [0 0 -1 0 0 -1 0 0 -1 0 0 -1 0 0 -1 0 0 -1] \"uniform float a\" [1 2]", 8},
                 {"\"varying float a\" [0 1 2 3 4 5]", 8},
                 {"\"facevarying float a\" [0 1 2 3 4 5 6 7]", 8}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[512];
        struct reading reading;
        snprintf(text, sizeof text,
                 IN_VIEW("PointsPolygons [4 4] [0 3 4 1 1 4 5 2] \"P\" [0 0 0 1 0 0 2 0 1 0 1 0 1 "
                         "1 0 2 1 1] %s"),
                 cases[k].variables);
        struct scene_frame *frame = read_frame(&reading, text, NULL);
        const struct scene_mesh *mesh = &frame->meshes[0];
        check_mesh(mesh);
        check_winding(mesh);
        assert_int_equal(mesh->vertex_count, cases[k].vertices);
        assert_int_equal(mesh->triangle_count, 4);
        assert_true(fabs(mesh_area(mesh) - 1 - M_SQRT2) < 1e-6);
        for (size_t i = 0; i < mesh->vertex_count; i++) {
            assert_true(variable_float(mesh, "u", i) == mesh->positions[3 * i]);
            assert_true(variable_float(mesh, "t", i) == mesh->positions[3 * i + 1]);
        }
        frame_close(&reading, frame);
    }
}

static void polygon_normals_face_who_sees_them_clockwise(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        IN_VIEW("Polygon \"P\" [0 0 0 0 1 0 1 1 0 1 0 0] Scale -1 1 1 "
                "Polygon \"P\" [0 0 0 0 1 0 1 1 0 1 0 0] Polygon \"P\" [0 0 0 0 0 1 0 1 1 0 1 0]"),
        NULL);
    for (size_t i = 0; i < 2; i++) {
        assert_true(variable_vec3(&frame->meshes[i], "N", 0).z == -1);
        check_winding(&frame->meshes[i]);
    }
    struct vec3 du = variable_vec3(&frame->meshes[2], "dPdu", 0),
                dv = variable_vec3(&frame->meshes[2], "dPdv", 0);
    assert_true(length3(vec3_cross(du, dv)) > 0.9);
    frame_close(&reading, frame);
}

static void user_normals_go_by_the_inverse_transpose(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        IN_VIEW(
            "Scale 2 1 1 Polygon \"P\" [0 0 0 0 1 0 1 0 0] \"N\" [1 1 0 1 1 0 1 1 0]"
            " \"varying vector w\" [1 1 0 1 1 0 1 1 0] \"varying point q\" [1 1 0 1 1 0 1 1 0]"),
        NULL);
    struct vec3 n = variable_vec3(&frame->meshes[0], "N", 1);
    assert_true(fabs(n.x - 1 / sqrt(5)) < 1e-6 && fabs(n.y - 2 / sqrt(5)) < 1e-6);
    assert_true(variable_vec3(&frame->meshes[0], "w", 1).x == 2);
    assert_true(variable_vec3(&frame->meshes[0], "q", 1).z == 8);
    assert_true(variable_vec3(&frame->meshes[0], "Ng", 1).z == -1);
    frame_close(&reading, frame);
}

static void extreme_coordinates_are_left_out_with_a_warning(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        "WorldBegin Translate 0 0 5 Polygon \"P\" [0 0 0 0 1 0 1 0 0]\nScale 1e10 1e10 1\n"
        "PointsPolygons [3 3] [0 1 2 0 1 3] \"P\" [0 0 0 0 1 0 1 0 0 1e30 0 0] WorldEnd",
        NULL);
    assert_int_equal(frame->mesh_count, 2);
    assert_int_equal(frame->meshes[1].triangle_count, 1);
    check_mesh(&frame->meshes[1]);
    assert_non_null(strstr(reading.warnings, "1 triangles left out"));
    frame_close(&reading, frame);
    frame = read_frame(
        &reading,
        IN_VIEW("Polygon \"P\" [0 0 0 0 0 0 0 0 0] Polygon \"P\" [0 0 0 1 1 0 2 2 0]"
                "Polygon \"P\" [0 0 0 1e-30 0 0 0 1e30 0] PointsPolygons [] [] \"P\" []"),
        NULL);
    for (size_t i = 0; i < frame->mesh_count; i++)
        check_mesh(&frame->meshes[i]);
    frame_close(&reading, frame);
    expect_error_part("WorldBegin Polygon \"P\" [0 0 0 1e300 0 0 0 1 0]", NULL,
                      "beyond the range of floats");
}

static void wrong_indices_and_counts_are_errors(void **state) {
    expect_error_part("WorldBegin PointsPolygons [3] [0 1 3] \"P\" [0 0 0 1 0 0 1 1 0]", NULL,
                      "corner 2 is point 3, but \"P\" has only 3 points");
    expect_error_part("WorldBegin PointsPolygons [3] [0 1 -1]", NULL,
                      "test.rib:1:36: error: PointsPolygons: index");
    expect_error_part("WorldBegin PointsPolygons [3] [0 1.5 2]", NULL,
                      "test.rib:1:34: error: PointsPolygons: index");
    expect_error_part("WorldBegin PointsPolygons [2] [0 1]", NULL, "number of corners must be 3");
    expect_error_part("WorldBegin PointsPolygons [3 3] [0 1 2] \"P\" []", NULL,
                      "add up to 6 corners, but 3 are");
    expect_error_part("WorldBegin PointsGeneralPolygons [2] [3] [0 1 2]", NULL,
                      "add up to 2 loops, but 1 are");
    expect_error_part("WorldBegin Polygon \"P\" [0 0 0 1 0 0]", NULL, "needs at least 3 points");
    expect_error_part("WorldBegin Polygon \"P\" [0 0 0 1]", NULL, "takes three numbers a point");
    expect_error_part("WorldBegin Polygon \"Cs\" [0 0 0]", NULL, "Polygon needs \"P\"");
    expect_error_part("WorldBegin Polygon \"P\" [0 0 0 1 0 0 0 1 0] \"Kz\" 1", NULL,
                      "is not declared");
    expect_error_part("WorldBegin Polygon \"P\" [0 0 0 1 0 0 0 1 0] \"float dPdu\" 1", NULL,
                      "is computed");
}

static void a_million_triangles_take_linear_time(void **state) {
    enum { SIDE = 708 };
    size_t capacity = (size_t)SIDE * SIDE * 64, length = 0;
    char *text = malloc(capacity);
    length += (size_t)sprintf(
        text, "Projection \"perspective\" Translate 0 0 2 WorldBegin PointsPolygons [");
    for (int i = 0; i < (SIDE - 1) * (SIDE - 1); i++)
        length += (size_t)sprintf(text + length, "4 ");
    length += (size_t)sprintf(text + length, "] [");
    for (int j = 0; j + 1 < SIDE; j++)
        for (int i = 0; i + 1 < SIDE; i++)
            length += (size_t)sprintf(text + length, "%d %d %d %d ", j * SIDE + i, j * SIDE + i + 1,
                                      (j + 1) * SIDE + i + 1, (j + 1) * SIDE + i);
    length += (size_t)sprintf(text + length, "] \"P\" [");
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++)
            length +=
                (size_t)sprintf(text + length, "%.4f %.4f 0 ", (double)i / SIDE, (double)j / SIDE);
    length += (size_t)sprintf(text + length, "] WorldEnd");
    assert_true(length < capacity);
    struct reading reading;
    struct scene_frame *frame = read_frame(&reading, text, NULL);
    assert_int_equal(frame->meshes[0].triangle_count, 2 * (SIDE - 1) * (SIDE - 1));
    frame_close(&reading, frame);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(concave_polygons_keep_their_area),
        cmocka_unit_test(holes_are_cut_out),
        cmocka_unit_test(random_stars_with_holes_are_covered_exactly),
        cmocka_unit_test(degenerate_outlines_give_triangles_of_their_corners),
        cmocka_unit_test(vertices_are_shared_unless_faces_differ),
        cmocka_unit_test(polygon_normals_face_who_sees_them_clockwise),
        cmocka_unit_test(user_normals_go_by_the_inverse_transpose),
        cmocka_unit_test(extreme_coordinates_are_left_out_with_a_warning),
        cmocka_unit_test(wrong_indices_and_counts_are_errors),
        cmocka_unit_test(a_million_triangles_take_linear_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
