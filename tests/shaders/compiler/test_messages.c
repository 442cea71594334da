/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Shaders that work together: displacement, surface and volume in one program, lights with
 * categories and output parameters, lights at other places than the sample. Sample i has P = (i, 2,
 * 3), I = (0, 0, 1), N = (0, 0, -1), s = i. */

enum { WIDTH = 8 };

static void assert_colors(const struct harness_result *result, int i, float r, float g, float b) {
    const float wanted[3] = {r, g, b};
    for (int c = 0; c < 3; c++)
        if (!(fabsf(result->color[c][i] - wanted[c]) <= 1e-5f * (1 + fabsf(wanted[c]))))
            fail_msg("component %d of sample %d is %g, not %g", c, i, (double)result->color[c][i],
                     (double)wanted[c]);
}

static void run_with(const char *surface, const char *displacement, const char *atmosphere,
                     struct harness_result *result) {
    struct harness h;
    harness_open_program(&h, harness_compile_with(surface, displacement, atmosphere), WIDTH);
    harness_run(&h, NULL, 0, result);
    harness_close(&h);
}

static void a_displacement_moves_what_the_surface_sees(void **state) {
    struct harness_result result;
    run_with("surface a() { Ci = color (xcomp(P), zcomp(P), zcomp(N)); }",
             "displacement b(float km = 0.5;) { P += km * normalize(N); N = -3 * N; }", NULL,
             &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, (float)i, 2.5f, 3);
}

static void an_atmosphere_changes_what_the_surface_gave(void **state) {
    struct harness_result result;
    run_with("surface a() { Ci = color (s, 0, 1); }", NULL,
             "volume fog(color tint = color (1, 1, 0); float depth = 6;) {\n"
             "  Ci = mix(Ci, tint, zcomp(P) / depth); }",
             &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, 0.5f * (float)i + 0.5f, 0.5f, 0.5f);
}

static void shaders_of_one_surface_read_each_others_parameters(void **state) {
    struct harness_result result;
    run_with(
        "surface a(output varying float wave = 0; color tint[2] = {1, color (0.5, 0, 2)};) {\n"
        "  float km = -1, none = 7, found = displacement(\"km\", km);\n"
        "  wave = 2 * s; Ci = color (found, km, none + displacement(\"none\", none)); }",
        "displacement b(float km = 0.5;) { float x; if (surface(\"wave\", x) == 1) P += 100; }",
        "volume c() { float x = 0; color t[2]; surface(\"wave\", x); surface(\"tint\", t);\n"
        "  Ci += x + t[1]; }",
        &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, 1.5f + 2 * (float)i, 0.5f + 2 * (float)i, 9 + 2 * (float)i);
}

static void parameters_of_companions_are_in_the_table_with_their_shader(void **state) {
    struct shader_program *program = harness_compile_with(
        "surface a(float k = 1;) { Ci = k * N . I; }",
        "displacement b(float k = 2; float unused = 1;) { N *= k * s; }", NULL);
    int live[SHADER_KIND_COUNT] = {0};
    for (int i = 0; i < program->parameter_count; i++)
        live[program->parameters[i].shader] += program->parameters[i].is_live;
    assert_int_equal(live[SHADER_KIND_DISPLACEMENT], 1);
    assert_int_equal(live[SHADER_KIND_SURFACE], 3); /* k, N and s */
    assert_int_equal(program->material_count, 4);
    assert_int_equal(program->bound_count, 2);
    shader_program_destroy(program);
}

static void each_kind_compiles_by_itself(void **state) {
    struct harness_result result;
    struct harness h;
    harness_open(&h, "displacement a() { P += vector (0, 1, 0); N = normal (0, s, 0); }", WIDTH,
                 NULL);
    harness_run(&h, NULL, 0, &result);
    harness_close(&h);
    for (int i = 0; i < HARNESS_SAMPLES; i++) {
        assert_colors(&result, i, (float)i, 3, 3);
        assert_float_equal(result.opacity[1][i], (float)i, 0);
    }
    harness_open(&h, "imager a(color c = 0.25;) { Ci += c; Oi = 1; alpha = 1; }", WIDTH, NULL);
    assert_int_equal(h.program->material_count, 3); /* Ci: what else it gets cannot reach it */
    harness_run(&h, NULL, 0, &result);
    harness_close(&h);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, 0.25f + (float)i, 100.25f + (float)i, 200.25f + (float)i);
}

static const char lamp[] =
    "light lamp(string __category = \"specular,key\"; float __nondiffuse = 1; color tint = 0.5;\n"
    "           output varying float shade = 0;) {\n"
    "  shade = xcomp(Ps) / 2; illuminate (point \"world\" (0, 2, 0)) Cl = tint; }";
static const char plain[] =
    "light plain(float level = 2;) { solar (vector (0, 0, 1), 0) Cl = level; }";

static void run_lit(const char *surface, const char *const *names, struct harness_result *result) {
    struct harness h, one, two;
    struct harness *lights[2] = {&one, &two};
    harness_open(&one, lamp, WIDTH, names);
    harness_open(&two, plain, WIDTH, names);
    harness_open(&h, surface, WIDTH, NULL);
    harness_run(&h, lights, 2, result);
    harness_close(&h);
    harness_close(&one);
    harness_close(&two);
}

static void a_category_chooses_lights(void **state) {
    struct harness_result result;
    run_lit("surface a() { color all = 0, key = 0, others = 0;\n"
            "  illuminance (P, N, PI) all += Cl;\n"
            "  illuminance (\"key\", P, N, PI) key += Cl;\n"
            "  illuminance (\"-key\", P) others += Cl;\n"
            "  illuminance (\"none,key,specular\", P) key += Cl;\n"
            "  Ci = color (comp(all, 0), comp(key, 0), comp(others, 0)); }",
            NULL, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, 2.5f, 1, 2);
}

static void lights_answer_what_they_are_asked(void **state) {
    static const char *const names[] = {"__nondiffuse", "shade", "tint", NULL};
    struct harness_result result;
    run_lit(
        "surface a() { float known = 0, shades = 0; color tints = 0;\n"
        "  illuminance (P) { float nondiffuse = 0, shade = 3; color tint = 10; string s = \"\";\n"
        "    known += lightsource(\"__nondiffuse\", nondiffuse);\n"
        "    if (lightsource(\"shade\", shade) != 0) known += 10;\n"
        "    lightsource(\"tint\", tint); lightsource(\"shade\", tint); lightsource(\"level\", "
        "shade);\n"
        "    shades += shade + nondiffuse; tints += tint; }\n"
        "  Ci = color (known, shades, comp(tints, 1)); }",
        names, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, 11, (float)i / 2 + 1 + 3, 10.5f);
}

/* L is from the place that is lit to the lamp at (0, 2, 0). */
static void lights_shine_on_the_place_that_illuminance_names(void **state) {
    struct harness_result result;
    run_lit("surface a() { point q = P + vector (10, 0, 0); color sum = 0;\n"
            "  illuminance (\"key\", q) sum += color (-xcomp(L), ycomp(L), zcomp(L));\n"
            "  illuminance (\"key\", P) sum += color (0, -xcomp(L), 0);\n"
            "  P -= vector (0, 0, 3);\n"
            "  illuminance (\"key\", P) sum += color (0, 0, zcomp(L));\n"
            "  Ci = sum; }",
            NULL, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, (float)i + 10, (float)i, -3);
}

static void a_displaced_surface_is_lit_where_it_is(void **state) {
    struct harness h, light;
    struct harness *lights[1] = {&light};
    struct harness_result result;
    harness_open(&light, lamp, WIDTH, NULL);
    harness_open_program(
        &h,
        harness_compile_with("surface a() { illuminance (P) Ci = color (-xcomp(L), "
                             "-zcomp(L), 0); }",
                             "displacement b() { P += vector (100, 0, s); }", NULL),
        WIDTH);
    harness_run(&h, lights, 1, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_colors(&result, i, 100 + (float)i, 3 + (float)i, 0);
    harness_close(&h);
    harness_close(&light);
}

static void solar_without_an_axis_is_ambient(void **state) {
    struct harness light;
    harness_open(&light, "light sky() { solar () Cl = 0.5; }", WIDTH, NULL);
    assert_true(light.module->is_ambient);
    harness_close(&light);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_displacement_moves_what_the_surface_sees),
        cmocka_unit_test(an_atmosphere_changes_what_the_surface_gave),
        cmocka_unit_test(shaders_of_one_surface_read_each_others_parameters),
        cmocka_unit_test(parameters_of_companions_are_in_the_table_with_their_shader),
        cmocka_unit_test(each_kind_compiles_by_itself),
        cmocka_unit_test(a_category_chooses_lights),
        cmocka_unit_test(lights_answer_what_they_are_asked),
        cmocka_unit_test(lights_shine_on_the_place_that_illuminance_names),
        cmocka_unit_test(a_displaced_surface_is_lit_where_it_is),
        cmocka_unit_test(solar_without_an_axis_is_ambient),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
