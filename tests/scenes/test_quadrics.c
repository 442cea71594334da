/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/scenes/scene_test.h"

#include <stdio.h>

/* The vertex in object coordinates of the untransformed tests, whose camera is 8 away. */
static struct vec3 object_point(const struct scene_mesh *mesh, size_t i) {
    struct vec3 p = vec3_from(mesh->positions, i);
    p.z -= 8;
    return p;
}

/* Where a quadric must be for its parameters, straight from the definitions of RI. */
static struct vec3 expected_point(const char *kind, const double *a, double u, double v) {
    double theta = 0, r = 0, z = 0;
    switch (kind[0]) {
    case 'S': {
        double from = asin(a[1] / a[0]), to = asin(a[2] / a[0]), phi = from + v * (to - from);
        theta = u * a[3], r = a[0] * cos(phi), z = a[0] * sin(phi);
        break;
    }
    case 'C':
        if (kind[1] == 'y')
            theta = u * a[3], r = a[0], z = a[1] + v * (a[2] - a[1]);
        else
            theta = u * a[2], r = a[1] * (1 - v), z = a[0] * v;
        break;
    case 'D':
        theta = u * a[2], r = a[1] * (1 - v), z = a[0];
        break;
    case 'P':
        theta = u * a[3], z = a[1] + v * (a[2] - a[1]), r = a[0] * sqrt(z / a[2]);
        break;
    case 'T': {
        double phi = (a[2] + v * (a[3] - a[2])) * M_PI / 180;
        theta = u * a[4], r = a[0] + a[1] * cos(phi), z = a[1] * sin(phi);
        break;
    }
    default: { /* hyperboloid */
        double x = a[0] + v * (a[3] - a[0]), y = a[1] + v * (a[4] - a[1]), c, s;
        theta = u * a[6] * M_PI / 180, c = cos(theta), s = sin(theta);
        return vec3_make(x * c - y * s, x * s + y * c, a[2] + v * (a[5] - a[2]));
    }
    }
    theta *= M_PI / 180;
    return vec3_make(r * cos(theta), r * sin(theta), z);
}

static const struct quadric_case {
    const char *kind;
    int count;
    double a[7];
} cases[] = {
    {"Sphere", 4, {1.5, -1.5, 1.5, 360}},
    {"Sphere", 4, {1.5, -0.5, 1.2, 200}},
    {"Sphere", 4, {1, -1, 1, -90}},
    {"Cylinder", 4, {1, -1, 2, 360}},
    {"Cylinder", 4, {.5, 0, 2, 77}},
    {"Cone", 3, {2, 1, 360}},
    {"Cone", 3, {2, 1, 100}},
    {"Disk", 3, {.5, 2, 360}},
    {"Disk", 3, {0, 1, 45}},
    {"Paraboloid", 4, {1, 0, 2, 360}},
    {"Paraboloid", 4, {1, .5, 2, 180}},
    {"Torus", 5, {1.5, .5, 0, 360, 360}},
    {"Torus", 5, {1.5, .5, -90, 90, 180}},
    {"Hyperboloid", 7, {1, 0, -1, .5, .8, 1, 360}},
    {"Hyperboloid", 7, {1, 0, 0, 1, 1, 0, 90}},
};

static struct scene_frame *read_quadric(struct reading *reading, const struct quadric_case *quadric,
                                        const char *before) {
    char numbers[256] = "", text[512];
    for (int i = 0; i < quadric->count; i++)
        snprintf(numbers + strlen(numbers), 32, " %.17g", quadric->a[i]);
    snprintf(text, sizeof text, IN_VIEW("%s %s%s"), before, quadric->kind, numbers);
    return read_frame(reading, text, NULL);
}

static void vertices_lie_where_the_definition_puts_them(void **state) {
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct reading reading;
        struct scene_frame *frame = read_quadric(&reading, &cases[k], "");
        assert_int_equal(frame->mesh_count, 1);
        const struct scene_mesh *mesh = &frame->meshes[0];
        check_mesh(mesh);
        /* The last case folds over its inner circle, whose tangents are its generators. */
        if (k + 1 < sizeof cases / sizeof *cases)
            check_winding(mesh);
        for (size_t i = 0; i < mesh->vertex_count; i++) {
            struct vec3 expected =
                expected_point(cases[k].kind, cases[k].a, variable_float(mesh, "u", i),
                               variable_float(mesh, "v", i));
            assert_true(length3(vec3_subtract(expected, object_point(mesh, i))) < 1e-5);
        }
        frame_close(&reading, frame);
    }
}

static void tangents_are_the_derivatives_and_normals_their_product(void **state) {
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        struct reading reading;
        struct scene_frame *frame = read_quadric(&reading, &cases[k], "");
        const struct scene_mesh *mesh = &frame->meshes[0];
        for (size_t i = 0; i < mesh->vertex_count; i++) {
            double u = variable_float(mesh, "u", i), v = variable_float(mesh, "v", i), h = 1e-6;
            if (v < 0.02 || v > 0.98)
                continue; /* where the parameters may be singular */
            const char *kind = cases[k].kind;
            const double *a = cases[k].a;
            struct vec3 du = vec3_scale(
                vec3_subtract(expected_point(kind, a, u + h, v), expected_point(kind, a, u - h, v)),
                .5 / h);
            struct vec3 dv = vec3_scale(
                vec3_subtract(expected_point(kind, a, u, v + h), expected_point(kind, a, u, v - h)),
                .5 / h);
            assert_true(length3(vec3_subtract(du, variable_vec3(mesh, "dPdu", i))) <
                        1e-3 * length3(du));
            assert_true(length3(vec3_subtract(dv, variable_vec3(mesh, "dPdv", i))) <
                        1e-3 * length3(dv));
            struct vec3 n = vec3_normalize(vec3_cross(du, dv));
            assert_true(length3(vec3_subtract(n, variable_vec3(mesh, "N", i))) < 1e-3);
        }
        frame_close(&reading, frame);
    }
}

static void sphere_normals_point_outward_in_every_handedness(void **state) {
    static const struct {
        const char *before;
        double side;
    } ways[] = {{"", 1},
                {"Scale -1 1 1", 1},
                {"Scale 1 -2 1", 1},
                {"Orientation \"inside\"", -1},
                {"ReverseOrientation", -1},
                {"Orientation \"lh\"", 1},
                {"Orientation \"rh\"", -1},
                {"Scale 1 1 -1 Orientation \"lh\"", -1},
                {"Scale 1 1 -1 Orientation \"rh\"", 1},
                {"Scale 1e-20 1e-20 1e-20 Scale 1e20 1e20 1e20", 1}};
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        struct reading reading;
        struct scene_frame *frame = read_quadric(&reading, &cases[0], ways[k].before);
        const struct scene_mesh *mesh = &frame->meshes[0];
        check_mesh(mesh);
        check_winding(mesh);
        for (size_t i = 0; i < mesh->vertex_count; i++)
            assert_true(
                ways[k].side * vec3_dot(object_point(mesh, i), variable_vec3(mesh, "N", i)) > 0.5);
        frame_close(&reading, frame);
    }
}

/* The distance on the screen from a point of a triangle to the true sphere, seen square on. */
static void chords_stay_within_the_tolerance(void **state) {
    static const double tolerances[] = {0.1, 0.5, 2};
    for (size_t k = 0; k < 3; k++) {
        struct scene_options options = {.chord_pixels = tolerances[k]};
        struct reading reading;
        struct scene_frame *frame = read_frame(&reading, IN_VIEW("Sphere 2 -2 2 360"), &options);
        const struct scene_mesh *mesh = &frame->meshes[0];
        const struct scene_camera *camera = &frame->camera;
        double per_unit =
            camera->height / (camera->screen_window[3] - camera->screen_window[2]) / 6;
        double worst = 0;
        for (size_t i = 0; i < mesh->triangle_count; i++)
            for (size_t e = 0; e < 3; e++) {
                struct vec3 a = object_point(mesh, mesh->triangles[3 * i + e]),
                            b = object_point(mesh, mesh->triangles[3 * i + (e + 1) % 3]);
                worst = fmax(worst, 2 - length3(vec3_scale(vec3_add(a, b), .5)));
            }
        assert_true(worst * per_unit <= tolerances[k]);
        assert_true(worst * per_unit > tolerances[k] / 4); /* and no finer than needed */
        frame_close(&reading, frame);
    }
}

static void areas_converge_to_the_true_ones(void **state) {
    static const struct {
        const char *text;
        double area;
    } shapes[] = {
        {"Sphere 2 -2 2 360", 16 * M_PI},         {"Sphere 2 0 2 180", 4 * M_PI},
        {"Cylinder 1 -1 1 360", 4 * M_PI},        {"Disk 0 2 360", 4 * M_PI},
        {"Cone 1 1 360", M_PI * M_SQRT2},         {"Torus 2 .5 0 360 360", 4 * M_PI * M_PI},
        {"Hyperboloid 1 0 0 2 0 0 360", 3 * M_PI}};
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
        char text[256];
        struct reading reading;
        snprintf(text, sizeof text, IN_VIEW("%s"), shapes[k].text);
        struct scene_frame *frame = read_frame(&reading, text, NULL);
        assert_true(fabs(mesh_area(&frame->meshes[0]) / shapes[k].area - 1) < 2e-3);
        frame_close(&reading, frame);
    }
}

static size_t count_meshes(const char *text) {
    struct reading reading;
    struct scene_frame *frame = read_frame(&reading, text, NULL);
    size_t count = frame->mesh_count;
    for (size_t i = 0; i < count; i++)
        check_mesh(&frame->meshes[i]);
    frame_close(&reading, frame);
    return count;
}

static void what_is_out_of_view_is_culled(void **state) {
    assert_int_equal(count_meshes(IN_VIEW("Translate 0 0 -20 Sphere 1 -1 1 360")), 0);
    assert_int_equal(count_meshes(IN_VIEW("Translate 30 0 0 Sphere 1 -1 1 360")), 0);
    assert_int_equal(count_meshes(IN_VIEW("Translate 0 -30 0 Sphere 1 -1 1 360")), 0);
    assert_int_equal(count_meshes("Clipping 1 5\n" IN_VIEW("Sphere 1 -1 1 360")), 0);
    assert_int_equal(count_meshes("Clipping 1 8\n" IN_VIEW("Sphere 1 -1 1 360")), 1);
    assert_int_equal(count_meshes(IN_VIEW("Translate 6.5 0 0 Sphere 1.5 -1.5 1.5 360")), 1);
    assert_int_equal(count_meshes(IN_VIEW("Translate 100 0 0 Patch \"bilinear\" \"P\" "
                                          "[0 0 0 1 0 0 0 1 0 1 1 0]")),
                     0);
}

static void degenerate_quadrics_draw_nothing_or_what_is_left(void **state) {
    assert_int_equal(count_meshes(IN_VIEW("Sphere 0 -1 1 360 Disk 0 0 360 Cylinder 0 -1 1 360")),
                     0);
    assert_int_equal(
        count_meshes(IN_VIEW("Sphere 1 -1 1 0 Cylinder 1 1 1 360 Paraboloid 1 0 0 360")), 0);
    assert_int_equal(count_meshes(IN_VIEW("Torus 0 0 0 360 360 Sphere 1 .5 .5 360")), 0);
    assert_int_equal(count_meshes(IN_VIEW("Hyperboloid 0 0 0 0 0 1 360 Cone 0 0 360")), 0);
    assert_int_equal(
        count_meshes(IN_VIEW("Sphere 1 -9 9 720 Sphere -1 -1 1 360 Torus 1 2 0 360 360")), 3);
    assert_int_equal(count_meshes(IN_VIEW("Scale 1 1 0 Sphere 1 -1 1 360")), 0);
    assert_int_equal(
        count_meshes(IN_VIEW("Scale 1e30 1e30 1e30 Scale 1e30 1e30 1e30 Disk 0 1 360")), 0);
    assert_int_equal(count_meshes(IN_VIEW("Scale 1e-20 1e-20 1e-20 Sphere 1 -1 1 360")), 1);
}

static void an_eye_inside_or_at_the_surface_is_no_trouble(void **state) {
    assert_int_equal(count_meshes(IN_VIEW("Sphere 1000 -1000 1000 360")), 1);
    assert_int_equal(count_meshes(IN_VIEW("Sphere 8 -8 8 360")), 1);
    assert_int_equal(
        count_meshes(IN_VIEW("Translate 0 0 -8 Disk 0 1 360 Rotate 90 1 0 0 Disk 0 1 360")), 1);
    assert_int_equal(count_meshes(IN_VIEW("Perspective 40 Translate 0 0 2 Sphere 1 -1 1 360")), 1);
    assert_int_equal(count_meshes(IN_VIEW("Perspective 40 Sphere 1 -1 1 360")), 1);
}

static void too_many_triangles_are_a_clear_error(void **state) {
    struct scene_options options = {.triangles_max = 1000};
    expect_error_part(IN_VIEW("Sphere 2 -2 2 360"), &options, "test.rib:4:1: error: Sphere: ");
    expect_error_part(IN_VIEW("Sphere 2 -2 2 360"), &options, "the limit of the frame leaves 1000");
    expect_error_part(IN_VIEW("Cylinder 1 -1 1"), NULL,
                      "Cylinder: radius zmin zmax thetamax expected");
}

static void variables_of_quadrics_are_bilinear(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        IN_VIEW("Rotate 90 0 0 1 Cylinder 1 -1 1 360 \"varying float a\" [0 1 2 4] \"st\" [0 0 2 0 "
                "0 3 2 3]"
                " \"uniform color c\" [1 2 3] \"constant float k\" 5 \"constant string n\" \"x\""
                " \"varying vector w\" [1 0 0 1 0 0 1 0 0 1 0 0] \"Cs\" [1 0 0 1 0 0 0 1 0 0 1 0]"),
        NULL);
    const struct scene_mesh *mesh = &frame->meshes[0];
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        double u = variable_float(mesh, "u", i), v = variable_float(mesh, "v", i);
        double a = (1 - v) * u + v * ((1 - u) * 2 + u * 4);
        assert_true(fabs(variable_float(mesh, "a", i) - a) < 1e-5);
        assert_true(fabs(variable_float(mesh, "s", i) - 2 * u) < 1e-5);
        assert_true(fabs(variable_float(mesh, "t", i) - 3 * v) < 1e-5);
        assert_true(variable_vec3(mesh, "c", i).z == 3);
        assert_true(fabs(variable_vec3(mesh, "w", i).y - 1) < 1e-6);
        assert_true(fabs(variable_vec3(mesh, "Cs", i).y - v) < 1e-6);
    }
    assert_int_equal(mesh->constant_count, 2);
    assert_true(mesh->constants[0].values[0] == 5);
    assert_string_equal(mesh->constants[1].strings[0], "x");
    frame_close(&reading, frame);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_lie_where_the_definition_puts_them),
        cmocka_unit_test(tangents_are_the_derivatives_and_normals_their_product),
        cmocka_unit_test(sphere_normals_point_outward_in_every_handedness),
        cmocka_unit_test(chords_stay_within_the_tolerance),
        cmocka_unit_test(areas_converge_to_the_true_ones),
        cmocka_unit_test(what_is_out_of_view_is_culled),
        cmocka_unit_test(degenerate_quadrics_draw_nothing_or_what_is_left),
        cmocka_unit_test(an_eye_inside_or_at_the_surface_is_no_trouble),
        cmocka_unit_test(too_many_triangles_are_a_clear_error),
        cmocka_unit_test(variables_of_quadrics_are_bilinear),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
