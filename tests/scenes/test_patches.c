/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/scenes/scene_test.h"

#include <stdio.h>

/* A bumpy net of points, u fastest. */
static struct vec3 net_point(int i, int j) {
    return vec3_make(i * 0.5 - 1, j * 0.5 - 1, 0.4 * sin(i * 1.3 + j * 0.7));
}

static void write_net(char *text, int nu, int nv) {
    for (int j = 0; j < nv; j++)
        for (int i = 0; i < nu; i++) {
            struct vec3 p = net_point(i, j);
            text += sprintf(text, " %.17g %.17g %.17g", p.x, p.y, p.z);
        }
}

static struct scene_frame *read_mesh(struct reading *reading, const char *before, const char *type,
                                     int nu, const char *uwrap, int nv, const char *vwrap,
                                     const char *after) {
    static char text[65536], net[32768];
    write_net(net, nu, nv);
    snprintf(text, sizeof text, IN_VIEW("%s PatchMesh \"%s\" %d \"%s\" %d \"%s\" \"P\" [%s] %s"),
             before, type, nu, uwrap, nv, vwrap, net, after);
    return read_frame(reading, text, NULL);
}

/* Whether some vertex lies at this object point with these parameters. */
static bool has_vertex(const struct scene_mesh *mesh, struct vec3 p, double u, double v) {
    p.z += 8;
    for (size_t i = 0; i < mesh->vertex_count; i++)
        if (fabs(variable_float(mesh, "u", i) - u) < 1e-6 &&
            fabs(variable_float(mesh, "v", i) - v) < 1e-6 &&
            length3(vec3_subtract(vec3_from(mesh->positions, i), p)) < 1e-5)
            return true;
    return false;
}

static void bezier_meshes_interpolate_their_corners(void **state) {
    struct reading reading;
    struct scene_frame *frame =
        read_mesh(&reading, "", "bicubic", 7, "nonperiodic", 4, "nonperiodic", "");
    const struct scene_mesh *mesh = &frame->meshes[0];
    check_mesh(mesh);
    check_winding(mesh);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++)
            assert_true(has_vertex(mesh, net_point(3 * i, 3 * j), i / 2., j));
    frame_close(&reading, frame);
}

/* Cox and de Boor's recursion for uniform knots, independent of basis matrices. */
static double spline_blend(int i, int degree, double t) {
    if (degree == 0)
        return t >= i && t < i + 1;
    return (t - i) / degree * spline_blend(i, degree - 1, t) +
           (i + degree + 1 - t) / degree * spline_blend(i + 1, degree - 1, t);
}

static void b_splines_agree_with_the_recursion(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_mesh(&reading, "Basis \"b-spline\" 1 \"b-spline\" 1",
                                          "bicubic", 6, "nonperiodic", 5, "nonperiodic", "");
    const struct scene_mesh *mesh = &frame->meshes[0];
    check_mesh(mesh);
    check_winding(mesh);
    for (size_t k = 0; k < mesh->vertex_count; k++) {
        double x = 3 + 3 * fmin(variable_float(mesh, "u", k), 1 - 1e-12);
        double y = 3 + 2 * fmin(variable_float(mesh, "v", k), 1 - 1e-12);
        struct vec3 sum = {0, 0, 8};
        for (int j = 0; j < 5; j++)
            for (int i = 0; i < 6; i++)
                sum = vec3_add(sum, vec3_scale(net_point(i, j),
                                               spline_blend(i, 3, x) * spline_blend(j, 3, y)));
        assert_true(length3(vec3_subtract(vec3_from(mesh->positions, k), sum)) < 2e-5);
    }
    frame_close(&reading, frame);
}

static void catmull_rom_meshes_interpolate_inner_points(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_mesh(&reading, "Basis \"catmull-rom\" 1 \"catmull-rom\" 1",
                                          "bicubic", 5, "nonperiodic", 5, "nonperiodic", "");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            assert_true(has_vertex(&frame->meshes[0], net_point(i + 1, j + 1), i / 2., j / 2.));
    frame_close(&reading, frame);
}

static void periodic_meshes_close(void **state) {
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading,
                   IN_VIEW("PatchMesh \"bilinear\" 4 \"periodic\" 2 \"nonperiodic\" \"P\" [1 0 0 0 "
                           "1 0 -1 0 0 0 -1 0"
                           " 1 0 1 0 1 1 -1 0 1 0 -1 1] \"varying float a\" [0 1 2 3 4 5 6 7]"),
                   NULL);
    assert_true(fabs(mesh_area(&frame->meshes[0]) - 4 * M_SQRT2) < 1e-5);
    check_mesh(&frame->meshes[0]);
    frame_close(&reading, frame);
    frame = read_mesh(&reading, "Basis \"b-spline\" 1 \"b-spline\" 1", "bicubic", 5, "periodic", 6,
                      "periodic", "");
    const struct scene_mesh *mesh = &frame->meshes[0];
    size_t row = 0;
    while (variable_float(mesh, "u", row) < 1)
        row++;
    for (size_t i = 0; i + row < mesh->vertex_count; i += row + 1)
        assert_true(length3(vec3_subtract(vec3_from(mesh->positions, i),
                                          vec3_from(mesh->positions, i + row))) < 1e-6);
    frame_close(&reading, frame);
}

static void bilinear_patches_take_their_corners_in_order(void **state) {
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading,
                   IN_VIEW("Patch \"bilinear\" \"P\" [0 0 0 2 0 0 0 1 0 2 1 0]"
                           " \"varying float a\" [0 1 2 3]"),
                   NULL);
    const struct scene_mesh *mesh = &frame->meshes[0];
    assert_int_equal(mesh->triangle_count, 2);
    check_winding(mesh);
    assert_true(has_vertex(mesh, vec3_make(2, 0, 0), 1, 0) &&
                has_vertex(mesh, vec3_make(0, 1, 0), 0, 1));
    assert_true(variable_vec3(mesh, "N", 0).z == 1);
    assert_true(variable_vec3(mesh, "dPdu", 3).x == 2 && variable_vec3(mesh, "dPdv", 0).y == 1);
    assert_true(variable_float(mesh, "a", 3) == 3);
    frame_close(&reading, frame);
}

static void twisted_bilinear_patches_are_diced(void **state) {
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading, IN_VIEW("Patch \"bilinear\" \"P\" [0 0 0 2 0 0 0 2 0 2 2 2]"), NULL);
    assert_true(frame->meshes[0].triangle_count > 100);
    check_winding(&frame->meshes[0]);
    frame_close(&reading, frame);
}

static void collapsed_edges_have_normals(void **state) {
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading,
                   IN_VIEW("Patch \"bicubic\" \"P\" [0 0 0 0 0 0 0 0 0 0 0 0"
                           " 0 1 0 .3 1 0 .6 1 0 1 1 0  0 2 0 .6 2 0 1.3 2 0 2 2 0"
                           " 0 3 0 1 3 0 2 3 0 3 3 0]"),
                   NULL);
    const struct scene_mesh *mesh = &frame->meshes[0];
    check_mesh(mesh);
    for (size_t i = 0; i < mesh->vertex_count; i++)
        assert_true(fabs(variable_vec3(mesh, "N", i).z - 1) < 1e-5);
    frame_close(&reading, frame);
}

static void values_of_faces_jump_and_vertex_values_follow_p(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_mesh(&reading, "", "bicubic", 7, "nonperiodic", 4,
                                          "nonperiodic", "\"uniform float a\" [3 5]");
    const struct scene_mesh *mesh = &frame->meshes[0];
    check_mesh(mesh);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double u = 0, a = variable_float(mesh, "a", mesh->triangles[3 * i]);
        for (size_t k = 0; k < 3; k++) {
            u += variable_float(mesh, "u", mesh->triangles[3 * i + k]) / 3;
            assert_true(variable_float(mesh, "a", mesh->triangles[3 * i + k]) == a);
        }
        assert_true(a == (u < .5 ? 3 : 5));
    }
    frame_close(&reading, frame);
    char xs[1024] = "\"vertex float a\" [";
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 7; i++)
            sprintf(xs + strlen(xs), " %.17g", net_point(i, j).z);
    strcat(xs, "]");
    frame = read_mesh(&reading, "", "bicubic", 7, "nonperiodic", 4, "nonperiodic", xs);
    for (size_t i = 0; i < frame->meshes[0].vertex_count; i++)
        assert_true(fabs(variable_float(&frame->meshes[0], "a", i) + 8 -
                         frame->meshes[0].positions[3 * i + 2]) < 2e-6);
    frame_close(&reading, frame);
}

static void wrong_counts_are_errors(void **state) {
    expect_error_part(
        "WorldBegin PatchMesh \"bicubic\" 5 \"nonperiodic\"", NULL,
        "test.rib:1:32: error: PatchMesh: 5 points in u: 4 and a multiple of 3 more expected");
    expect_error_part("WorldBegin PatchMesh \"bicubic\" 4 \"periodic\"", NULL,
                      "a multiple of 3 expected");
    expect_error_part("WorldBegin Patch \"bilinear\" \"P\" [0 0 0]", NULL,
                      "\"P\" takes 4 points, not 1");
    expect_error_part("WorldBegin Patch \"bilinear\" \"Pw\" [0 0 0 1]", NULL,
                      "\"Pw\" is not supported; give \"P\"");
    expect_error_part("WorldBegin PatchMesh \"bilinear\" 16777216 \"periodic\" 16777216 "
                      "\"periodic\" \"P\" [0 0 0]",
                      NULL, "points, not 1");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bezier_meshes_interpolate_their_corners),
        cmocka_unit_test(b_splines_agree_with_the_recursion),
        cmocka_unit_test(catmull_rom_meshes_interpolate_inner_points),
        cmocka_unit_test(periodic_meshes_close),
        cmocka_unit_test(bilinear_patches_take_their_corners_in_order),
        cmocka_unit_test(twisted_bilinear_patches_are_diced),
        cmocka_unit_test(collapsed_edges_have_normals),
        cmocka_unit_test(values_of_faces_jump_and_vertex_values_follow_p),
        cmocka_unit_test(wrong_counts_are_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
