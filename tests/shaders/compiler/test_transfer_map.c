/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static struct shader_program *compile(const char *source, const char *const *material) {
    struct status status = {0};
    struct shader_program *program = harness_compile(source, material, &status);
    if (!program)
        fail_msg("%s", status.message);
    return program;
}

static void a_parameter_is_in_the_map_whole_when_one_component_is_live(void **state) {
    const char *const material[] = {"tint", "unused", "st", NULL};
    struct shader_program *p =
        compile("surface a(color tint = 1; varying float unused = 0; float k = 2;) {\n"
                "  Ci = color(comp(tint, 1), k, t); }",
                material);
    assert_int_equal(p->material_count, 4);
    assert_int_equal(harness_parameter(p, "tint")->map_offset, 0);
    assert_int_equal(harness_parameter(p, "t")->map_offset, 3);
    assert_false(harness_parameter(p, "unused")->is_live);
    assert_int_equal(harness_parameter(p, "unused")->map_offset, -1);
    assert_int_equal(harness_parameter(p, "k")->bound_offset, 0);
    assert_int_equal(p->bound_count, 1);
    shader_program_destroy(p);
}

static void what_cannot_reach_ci_is_dead(void **state) {
    struct shader_program *p = compile("surface a(float used = 1; float dead = 1;) {\n"
                                       "  float x = dead * s; float y;\n"
                                       "  for (y = 0; y < dead; y += 1) x += t;\n"
                                       "  Oi = x; Ci = used; }",
                                       NULL);
    assert_int_equal(p->material_count, 0);
    assert_true(harness_parameter(p, "used")->is_live);
    assert_false(harness_parameter(p, "dead")->is_live);
    assert_int_equal(harness_parameter(p, "dead")->bound_offset, -1);
    assert_false(harness_parameter(p, "s")->is_live);
    shader_program_destroy(p);
}

static void position_and_eye_are_never_sent(void **state) {
    struct shader_program *p =
        compile("surface a() { Ci = color(length(P), length(I), distance(P, E)); }", NULL);
    assert_int_equal(p->material_count, 0);
    assert_int_equal(p->parameter_count, 0);
    shader_program_destroy(p);
}

static void predefined_variables_follow_in_their_own_order(void **state) {
    const char *const material[] = {"Cs", "late", NULL};
    struct shader_program *p = compile("surface a(float early = 0; float late = 0;) { Ci = Cs * t "
                                       "* s + late * zcomp(N) + early; }",
                                       material);
    assert_int_equal(harness_parameter(p, "late")->map_offset, 0);
    assert_int_equal(harness_parameter(p, "N")->map_offset, 1);
    assert_int_equal(harness_parameter(p, "s")->map_offset, 4);
    assert_int_equal(harness_parameter(p, "t")->map_offset, 5);
    assert_int_equal(harness_parameter(p, "Cs")->map_offset, 6);
    assert_int_equal(p->material_count, 9);
    assert_int_equal(harness_parameter(p, "early")->bound_offset, 0);
    shader_program_destroy(p);
}

static void condition_of_live_control_flow_is_live(void **state) {
    struct shader_program *p = compile("surface a(float limit = 3;) { Ci = 0; if (u > limit) Ci = "
                                       "1; if (v > 1) { float z = t; } }",
                                       NULL);
    assert_true(harness_parameter(p, "u")->is_live);
    assert_true(harness_parameter(p, "limit")->is_live);
    assert_false(harness_parameter(p, "v")->is_live);
    assert_int_equal(p->material_count, 1);
    shader_program_destroy(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_parameter_is_in_the_map_whole_when_one_component_is_live),
        cmocka_unit_test(what_cannot_reach_ci_is_dead),
        cmocka_unit_test(position_and_eye_are_never_sent),
        cmocka_unit_test(predefined_variables_follow_in_their_own_order),
        cmocka_unit_test(condition_of_live_control_flow_is_live),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
