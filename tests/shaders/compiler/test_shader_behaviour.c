/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include "base/simd_operations.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const int widths[] = {4, 8, 16};

/* Runs a surface at every width; the first width's colors are returned, the others must have the
 * same bits. */
static void run(const char *source, const char *const *material, struct harness *const *lights,
                int light_count, struct harness_result *result) {
    for (int w = 0; w < 3; w++) {
        struct harness h;
        struct harness_result one;
        harness_open(&h, source, widths[w], material);
        harness_run(&h, lights, light_count, &one);
        harness_close(&h);
        if (w)
            assert_memory_equal(one.color, result->color, sizeof one.color);
        *result = one;
    }
}

/* Expressions over s = i, each with what it is in plain C. */
#define EXPRESSIONS(X)                                                                             \
    X("s * 2 + 1", i * 2 + 1)                                                                      \
    X("1 - s / 4 - 2", 1 - i / 4 - 2)                                                              \
    X("-s + -(3)", -i - 3)                                                                         \
    X("s < 3 ? 10 : 20", i < 3 ? 10 : 20)                                                          \
    X("(s > 2 && s <= 5) || s == 9 ? 1 : 0", (i > 2 && i <= 5) || i == 9 ? 1 : 0)                  \
    X("!(s != 4) ? 1 : 2", i == 4 ? 1 : 2)                                                         \
    X("mod(s, 4)", fmodf(i, 4))                                                                    \
    X("mod(-s, 4)", (4 - fmodf(i, 4)) == 4 ? 0 : 4 - fmodf(i, 4))                                  \
    X("min(s, 5, 3)", fminf(i, 3))                                                                 \
    X("max(s, 5)", fmaxf(i, 5))                                                                    \
    X("clamp(s, 2, 4)", fminf(fmaxf(i, 2), 4))                                                     \
    X("abs(s - 5)", fabsf(i - 5))                                                                  \
    X("sign(s - 5)", i<5 ? -1 : i> 5 ? 1 : 0)                                                      \
    X("floor(s / 3) + ceil(s / 3)", floorf(i / 3) + ceilf(i / 3))                                  \
    X("step(4, s)", i < 4 ? 0 : 1)                                                                 \
    X("mix(10, 20, s / 16)", 10 * (1 - i / 16) + 20 * (i / 16))                                    \
    X("sqrt(s * s)", i)                                                                            \
    X("point (s, 1, 2) . vector (3, s, 1)", i * 3 + i + 2)                                         \
    X("zcomp(vector (s, 1, 0) ^ vector (2, 3, 0))", i * 3 - 2)                                     \
    X("length(vector (3 * s, 4 * s, 0))", 5 * i)                                                   \
    X("distance(point (s, 0, 0), point (s, 3, 4))", 5)                                             \
    X("comp(color (1, 2, 3), mod(s, 3))", fmodf(i, 3) + 1)                                         \
    X("smoothstep(0, 16, s)", (i / 16) * (i / 16) * (3 - 2 * (i / 16)))                            \
    X("comp(color \"hsv\" (0, 1, s), 0)", i)                                                       \
    X("comp(ctransform(\"hsv\", color (s, 0, 0)), 2)", i)                                          \
    X("xcomp(reflect(vector (s, 1, 0), normal (1, 0, 0)))", -i)                                    \
    X("degrees(radians(s)) > s - 0.01 ? 1 : 0", 1)

static void expressions_are_what_c_says(void **state) {
    static const char *const texts[] = {
#define TEXT(text, value) text,
        EXPRESSIONS(TEXT)
#undef TEXT
    };
    char source[16384] = "";
    enum { COUNT = sizeof texts / sizeof *texts };
    for (int first = 0; first < COUNT; first++) {
        snprintf(source, sizeof source, "surface a() { Ci = %s; }", texts[first]);
        struct harness_result result;
        struct harness h;
        harness_open(&h, source, 8, NULL);
        harness_run(&h, NULL, 0, &result);
        harness_close(&h);
        for (int n = 0; n < HARNESS_SAMPLES; n++) {
            float i = (float)n;
            const double values[] = {
#define VALUE(text, value) (double)(value),
                EXPRESSIONS(VALUE)
#undef VALUE
            };
            if (fabs((double)result.color[0][n] - values[first]) > 1e-5 * (1 + fabs(values[first])))
                fail_msg("%s at s = %d is %g, not %g", texts[first], n, (double)result.color[0][n],
                         values[first]);
        }
    }
}

static const char control_source[] =
    "surface a() {\n"
    "  float x = 0, y = 0, i, j;\n"
    "  if (s < 4) x = 1; else if (s < 8) { x = 2; y = s; } else x = 3;\n"
    "  for (i = 0; i < s; i += 1) {\n"
    "    if (i == 2) continue;\n"
    "    if (i == 7) break;\n"
    "    y += i;\n"
    "  }\n"
    "  while (x < 100) { x *= 2; if (x > 20) break; }\n"
    "  for (i = 0; i < 3; i += 1)\n"
    "    for (j = 0; j < 5; j += 1) { if (j > s) continue 2; if (i * j == 4) break 2; y += 100; }\n"
    "  Ci = color (x, y, i);\n"
    "}\n";

static void control_flow_is_what_c_says(void **state) {
    struct harness_result result;
    run(control_source, NULL, NULL, 0, &result);
    for (int n = 0; n < HARNESS_SAMPLES; n++) {
        float s = (float)n, x, y = 0, i, j;
        if (s < 4)
            x = 1;
        else if (s < 8)
            x = 2, y = s;
        else
            x = 3;
        for (i = 0; i < s; i += 1) {
            if (i == 2)
                continue;
            if (i == 7)
                break;
            y += i;
        }
        while (x < 100) {
            x *= 2;
            if (x > 20)
                break;
        }
        for (i = 0; i < 3; i += 1)
            for (j = 0; j < 5; j += 1) {
                if (j > s)
                    break;
                if (i * j == 4)
                    goto out;
                y += 100;
            }
    out:
        assert_true(result.color[0][n] == x);
        assert_true(result.color[1][n] == y);
        assert_true(result.color[2][n] == i);
    }
}

static void arrays_and_functions_work(void **state) {
    struct harness_result result;
    run("float early(float x) { if (x < 3) return 7; float y = x * 2; if (y > 20) { return 9; } "
        "return y; }\n"
        "void both(float x; output float a; output color b) { a = x + 1; b = color (a, x, 2); }\n"
        "float sum(float list[]; float count) { float i, n = 0;\n"
        "  for (i = 0; i < count; i += 1) n += list[i]; return n; }\n"
        "surface a(float p[3] = {10, 20, 30};) {\n"
        "  float q[4] = {1, 2, 3, 4}; color c[2]; float one; color two;\n"
        "  q[s - 2] = 100 + s;\n" /* clamped at both ends */
        "  c[1] = color (s, 5, 6);\n"
        "  both(s, one, two);\n"
        "  float twice(float z) { return z + one; }\n"
        "  Ci = color (early(s), sum(q, 4) + p[mod(s, 3)], twice(comp(two, 1)) + comp(c[7], 1));\n"
        "}",
        NULL, NULL, 0, &result);
    for (int n = 0; n < HARNESS_SAMPLES; n++) {
        float s = (float)n, q[4] = {1, 2, 3, 4};
        q[n < 2 ? 0 : n > 5 ? 3 : n - 2] = 100 + s;
        assert_true(result.color[0][n] == (s < 3 ? 7 : s * 2 > 20 ? 9 : s * 2));
        assert_true(result.color[1][n] == q[0] + q[1] + q[2] + q[3] + (float)(n % 3 * 10 + 10));
        assert_true(result.color[2][n] == s + s + 1 + 5);
    }
}

static void illuminance_visits_every_directional_light(void **state) {
    struct harness ambient, sun, lamp, *lights[3] = {&ambient, &sun, &lamp};
    for (int w = 0; w < 3; w++) {
        struct harness h;
        struct harness_result result;
        harness_open(&ambient, "light a() { Cl = 0.25; }", widths[w], NULL);
        harness_open(&sun, "light d() { solar (vector (0, 0, 1), 0) Cl = color (1, 2, 3); }",
                     widths[w], NULL);
        harness_open(&lamp,
                     "light p() { illuminate (point (8, 2, 0), vector (0, 0, 1), 0.9) Cl = 10; }",
                     widths[w], NULL);
        harness_open(&h,
                     "surface a() { color c = 0; float n = 0;\n"
                     "  illuminance (P) { c += Cl; n += zcomp(L); }\n"
                     "  Ci = ambient() + c + color (0, 0, n); }",
                     widths[w], NULL);
        assert_true(ambient.module->is_ambient);
        assert_false(sun.module->is_ambient);
        assert_true(h.module->uses_lights);
        harness_run(&h, lights, 3, &result);
        for (int i = 0; i < HARNESS_SAMPLES; i++) {
            float d = fabsf((float)i - 8);
            int is_lit = 3 >= cos(0.9) * sqrt(9.0 + (double)(d * d));
            assert_true(result.color[0][i] == 0.25f + 1 + (is_lit ? 10.0f : 0.0f));
            assert_true(result.color[2][i] ==
                        0.25f + 3 + (is_lit ? 10.0f : 0.0f) - 1 - (is_lit ? 3.0f : 0.0f));
        }
        assert_int_equal(h.executions[1], 2); /* two lights have a direction */
        harness_close(&h);
        for (int i = 0; i < 3; i++)
            harness_close(lights[i]);
    }
}

static void standard_reflection_is_what_the_formulas_say(void **state) {
    struct harness sun, *lights[1] = {&sun};
    struct harness h;
    struct harness_result result;
    harness_open(&sun, "light d() { solar (vector (0, 3, 4), 0) Cl = 1; }", 8, NULL);
    harness_open(&h,
                 "surface a() { Ci = color (comp(diffuse(N), 0), comp(specular(N, -I, 0.5), 0), "
                 "comp(phong(N, -I, 2), 0)); }",
                 8, NULL);
    harness_run(&h, lights, 1, &result);
    double hz = 1.8, hy = 0.6, cosine = hz / sqrt(hz * hz + hy * hy);
    assert_true(fabs((double)result.color[0][3] - 0.8) < 1e-6);
    assert_true(fabs((double)result.color[1][3] - cosine * cosine) < 1e-6);
    assert_true(fabs((double)result.color[2][3] - 0.64) < 1e-6);
    harness_close(&h);
    harness_close(&sun);
}

static void spaces_transform_points_vectors_and_normals(void **state) {
    struct harness h;
    struct harness_result result;
    harness_open(&h,
                 "surface a(point p = (1, 2, 3); vector v = vector (1, 0, 0); string where = "
                 "\"shader\";) {\n"
                 "  point q = transform(where, P);\n"
                 "  Ci = color (xcomp(p), xcomp(v), where == \"world\" ? 1 : xcomp(q)) +\n"
                 "       color (0, 0, 1000 * xcomp(ntransform(\"shader\", normal (1, 0, 0)))); }",
                 8, NULL);
    /* shader space is scaled by 2 and moved by 10 */
    for (int i = 0; i < 3; i++) {
        h.matrices.to_camera[SHADER_SPACE_SHADER][i * 5] = 2;
        h.matrices.to_camera[SHADER_SPACE_SHADER][12 + i] = 10;
        h.matrices.from_camera[SHADER_SPACE_SHADER][i * 5] = 0.5f;
        h.matrices.from_camera[SHADER_SPACE_SHADER][12 + i] = -5;
    }
    harness_run(&h, NULL, 0, &result);
    assert_true(result.color[0][0] == 12);
    assert_true(result.color[1][0] == 2);
    assert_true(result.color[2][4] == 2000 + 4 * 0.5f - 5);
    harness_bind_string(&h, "where", "camera");
    harness_run(&h, NULL, 0, &result);
    assert_true(result.color[2][4] == 2000 + 4);
    harness_bind_string(&h, "where", "world");
    harness_run(&h, NULL, 0, &result);
    assert_true(result.color[2][4] == 2001);
    harness_bind_string(&h, "where", "nowhere");
    harness_run(&h, NULL, 0, &result);
    assert_true(result.color[2][4] == 2004);
    harness_close(&h);
}

static void bound_values_replace_defaults(void **state) {
    struct harness h;
    struct harness_result result;
    const float five = 5, red[3] = {1, 0, 0};
    harness_open(&h,
                 "surface a(float k = 2 + 1; varying float m = 4; float list[2] = {1, 2};) { Ci = "
                 "Cs * (k + m + list[1]); }",
                 4, NULL);
    harness_run(&h, NULL, 0, &result);
    assert_true(result.color[1][0] == 9);
    harness_bind(&h, "k", &five);
    harness_bind(&h, "Cs", red);
    harness_run(&h, NULL, 0, &result);
    assert_true(result.color[0][0] == 11 && result.color[1][0] == 0);
    harness_close(&h);
}

static void loops_stop_at_their_limit(void **state) {
    struct harness h;
    struct harness_result result;
    harness_open(&h, "surface a() { float i = 0; if (s == 5) while (1 == 1) i += 1; Ci = i; }", 8,
                 NULL);
    harness_run(&h, NULL, 0, &result);
    assert_true(result.overrun);
    assert_true(result.color[0][4] == 0);
    harness_close(&h);
    harness_open(&h, "surface a(float k = 1;) { float i = 0; while (k > 0) { i += k; } Ci = i; }",
                 8, NULL);
    harness_run(&h, NULL, 0, &result);
    assert_true(result.overrun);
    harness_close(&h);
    harness_open(
        &h, "surface a() { float i = 0; while (s < 100) { while (s > -1) { i += 1; } } Ci = i; }",
        8, NULL);
    harness_run(&h, NULL, 0, &result);
    assert_true(result.overrun);
    harness_close(&h);
}

static void trips_are_those_of_the_neediest_sample(void **state) {
    for (int w = 0; w < 3; w++) {
        struct harness h;
        struct harness_result result;
        /* outer runs to 15 at s = 15; inner runs i times in pass i: 0 + 1 + ... + 14 */
        harness_open(&h,
                     "surface a() { float i, j, n = 0;\n"
                     "  for (i = 0; i < s; i += 1) for (j = 0; j < i; j += 1) n += 1;\n"
                     "  Ci = n; }",
                     widths[w], NULL);
        harness_run(&h, NULL, 0, &result);
        assert_int_equal(h.module->block_count, 3);
        assert_int_equal(h.module->blocks[2].parent, 1);
        assert_int_equal(h.executions[1], 15);
        assert_int_equal(h.executions[2], 105);
        assert_true(result.color[0][5] == 10);
        harness_close(&h);
    }
}

static void branches_of_uniform_ifs_report_once(void **state) {
    struct harness h;
    struct harness_result result;
    const float zero = 0;
    harness_open(&h, "surface a(float k = 1;) { if (k > 0) Ci = s; else Ci = s * s; }", 4, NULL);
    harness_run(&h, NULL, 0, &result);
    assert_int_equal(h.module->block_count, 3);
    assert_int_equal(h.executions[1], 1);
    assert_int_equal(h.executions[2], 0);
    memset(h.executions, 0, sizeof h.executions);
    harness_bind(&h, "k", &zero);
    harness_run(&h, NULL, 0, &result);
    assert_int_equal(h.executions[1], 0);
    assert_int_equal(h.executions[2], 1);
    harness_close(&h);
}

static void operations_are_counted_by_stream(void **state) {
    struct harness h;
    harness_open(&h,
                 "surface a(float k = 3;) { float pre = s * t + k * k;\n"
                 "  color sum = 0; illuminance (P) sum += Cl * pre;\n"
                 "  Ci = sum / pre; }",
                 8, NULL);
    const struct shader_module *m = h.module;
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_MULTIPLY), 1);
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_ADD), 1);
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_MOVE), 3); /* sum = 0 */
    assert_int_equal(harness_operations(m, SHADER_ILLUM, SIMD_FLOAT_MULTIPLY), 3);
    assert_int_equal(harness_operations(m, SHADER_ILLUM, SIMD_FLOAT_ADD), 3);
    assert_int_equal(harness_operations(m, SHADER_ILLUM, SIMD_FLOAT_SIGN), 0); /* L is not used */
    assert_int_equal(harness_operations(m, SHADER_POST_ILLUM, SIMD_FLOAT_DIVIDE), 3);
    assert_int_equal(harness_operations(m, SHADER_POST_ILLUM, SIMD_FLOAT_MOVE), 0);
    assert_int_equal(m->blocks[1].operations[SHADER_ILLUM][SIMD_FLOAT_MULTIPLY], 3);
    harness_close(&h);
    /* normalize: three multiplies, two adds, a square root, three divides */
    harness_open(&h, "surface a() { Ci = color (normalize(vector (s, t, u))); }", 8, NULL);
    m = h.module;
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_MULTIPLY), 3);
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_ADD), 2);
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_SQRT), 1);
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_DIVIDE), 3);
    assert_int_equal(harness_operations(m, SHADER_PRE_ILLUM, SIMD_FLOAT_MOVE), 0);
    harness_close(&h);
    /* a bound varying parameter is loaded into pixel memory */
    harness_open(&h, "surface a(varying color k = 1;) { Ci = k * s; }", 8, NULL);
    assert_int_equal(harness_operations(h.module, SHADER_PRE_ILLUM, SIMD_FLOAT_MOVE), 3);
    harness_close(&h);
}

static void every_width_gives_the_same_bits(void **state) {
    struct harness_result result;
    run("surface a() { point q = point (s * 0.37, t * 1.7 + u, v);\n"
        "  color c = color noise(q) + noise(s * 0.1) + sin(s) * exp(-s) + pow(s + 0.5, 1.7);\n"
        "  float i; for (i = 0; i < 6; i += 1) c += noise(q * i) / (i + 1);\n"
        "  Ci = c * color (atan(s, t), log(s + 1), cos(s * 3)); }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][1] != result.color[0][2]);
}

static void overwritten_components_do_not_leak_into_each_other(void **state) {
    struct harness_result result;
    run("surface a() { point p = point (s, 2, 3); p = point (ycomp(p), zcomp(p), xcomp(p));\n"
        "  vector v = vector (1, 2, s); v += v; setycomp(v, 40); Ci = color (p) + color (v); }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][6] == 2 + 2);
    assert_true(result.color[1][6] == 3 + 40);
    assert_true(result.color[2][6] == 6 + 12);
}

static void operands_are_evaluated_from_left_to_right(void **state) {
    struct harness_result result;
    run("float second(float a, b) { return b; }\n"
        "surface a() { float x = s, y = s, z = s; float old(float a) { z = 50; return a; }\n"
        "  float p = x + (x = 100), q = second(y = 7, y) + old(z);\n"
        "  color c = color (s, s, s); c = color (comp(c, 0), setx(c), comp(c, 0));\n"
        "  Ci = color (p, q, comp(c, 0) + comp(c, 2)); }\n"
        "float setx(output color c) { setxcomp(c, 9); return 0; }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][5] == 105);
    assert_true(result.color[1][5] == 12);
    assert_true(result.color[2][5] == 14);
}

static void setcomp_changes_the_component_that_comp_reads(void **state) {
    struct harness_result result;
    run("surface a() { color c = color (s - 1, 20, 30), d = color (1, 2, 3);\n"
        "  setcomp(c, xcomp(c), 7); setcomp(d, (s - 5) / (s - 5), 40);\n"
        "  Ci = color (comp(c, 0), comp(c, 1) + comp(c, 2), comp(d, 0)); }",
        NULL, NULL, 0, &result);
    const float expected[5][2] = {{7, 50}, {7, 50}, {1, 37}, {2, 27}, {3, 27}};
    for (int i = 0; i < 5; i++) {
        assert_true(result.color[0][i] == expected[i][0]);
        assert_true(result.color[1][i] == expected[i][1]);
        assert_true(result.color[2][i] == 1);
    }
    assert_true(result.color[2][5] == 40); /* not a number: the first */
}

static void variables_start_at_zero(void **state) {
    struct harness_result result;
    run("surface a() { float x; float y = x + 1; x = s; point p; Ci = color (x, y, xcomp(p));\n"
        "  float i; for (i = 0; i < 2; i += 1) { float z; Ci += z; z = 5; } }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][4] == 4 && result.color[1][4] == 1 && result.color[2][4] == 0);
}

static void what_comes_before_and_after_a_return_stays_uniform(void **state) {
    struct harness_result result;
    run("float half(uniform float x) { return x / 2; }\n"
        "surface a(uniform float k = 3;) { uniform float i, n = 0;\n"
        "  for (i = 0; i < k; i += 1) n += 1;\n"
        "  Ci = n; if (s > 7) return; Ci += half(comp(matrix k, 0, 0)); }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][2] == 4.5f && result.color[0][9] == 3);
    /* a jump after a return does not hide the return */
    run("surface a() { float i; for (i = 0; i < 1; i += 1) {\n"
        "  if (s > 7) return; if (s > 3) continue; Ci += 1; } Ci += 2; }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][2] == 3 && result.color[0][5] == 2 && result.color[0][9] == 0);
}

static void arguments_choose_an_overload_before_the_context_does(void **state) {
    struct harness_result result;
    run("surface a() { Ci = color (min(s, 2, 3) - vector (1, 2, 3)); }", NULL, NULL, 0, &result);
    assert_true(result.color[0][9] == 1 && result.color[2][9] == -1);
}

static void parameters_of_any_length_are_assigned_as_wholes(void **state) {
    struct harness_result result;
    struct status status = {0};
    run("void f(output float a[]; color b[]; output color c[]) { float d[2] = a; a[1] = d[0]; c = "
        "b; }\n"
        "surface a() { float x[2] = {s, 4}; color y[1] = {color (5, 6, 7)}, z[1]; f(x, y, z);\n"
        "  Ci = z[0] + color (x[1], 0, 0); }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][3] == 5 + 3 && result.color[1][3] == 6);
    assert_null(harness_compile("void f(output float a[]; float b[]) { a = b; }\n"
                                "surface a() { float x[2], y[3]; f(x, y); Ci = x[0]; }",
                                NULL, &status));
    assert_non_null(strstr(status.message, "an array of 2 cannot be copied from one of 3"));
}

static void the_value_of_an_assignment_is_what_was_assigned(void **state) {
    struct harness_result result;
    run("surface a() { color c = 7; Ci = (c = color (s, xcomp(c), ycomp(c)));\n"
        "  float x = 1; float y = (x = s) + (x = 2 * s) + x; Ci += y; }",
        NULL, NULL, 0, &result);
    assert_true(result.color[0][3] == 3 + 15 && result.color[1][3] == 7 + 15);
    assert_true(result.color[2][3] == 7 + 15);
}

static void the_first_of_three_results_may_be_dead(void **state) {
    struct harness_result result;
    run("surface a() { color c = 0; if (s > 3) c = color noise(0.5); Ci = ycomp(c); }", NULL, NULL,
        0, &result);
    assert_true(result.color[0][2] == 0 && result.color[0][5] > 0);
}

/* Nobody looks at the upper bits of the middle number, but its ends still hold. */
static void conversions_from_float_stop_at_the_ends_of_their_own_format(void **state) {
    struct harness_result result;
    run("surface a() { Ci = color (unsigned fixed<12,12> (fixed<20,12> (100 * s))); }", NULL, NULL,
        0, &result);
    assert_true(result.color[0][1] == 0 && result.color[0][2] == 4095 / 4096.0f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expressions_are_what_c_says),
        cmocka_unit_test(control_flow_is_what_c_says),
        cmocka_unit_test(arrays_and_functions_work),
        cmocka_unit_test(illuminance_visits_every_directional_light),
        cmocka_unit_test(standard_reflection_is_what_the_formulas_say),
        cmocka_unit_test(spaces_transform_points_vectors_and_normals),
        cmocka_unit_test(bound_values_replace_defaults),
        cmocka_unit_test(loops_stop_at_their_limit),
        cmocka_unit_test(trips_are_those_of_the_neediest_sample),
        cmocka_unit_test(branches_of_uniform_ifs_report_once),
        cmocka_unit_test(operations_are_counted_by_stream),
        cmocka_unit_test(every_width_gives_the_same_bits),
        cmocka_unit_test(overwritten_components_do_not_leak_into_each_other),
        cmocka_unit_test(operands_are_evaluated_from_left_to_right),
        cmocka_unit_test(setcomp_changes_the_component_that_comp_reads),
        cmocka_unit_test(variables_start_at_zero),
        cmocka_unit_test(what_comes_before_and_after_a_return_stays_uniform),
        cmocka_unit_test(arguments_choose_an_overload_before_the_context_does),
        cmocka_unit_test(parameters_of_any_length_are_assigned_as_wholes),
        cmocka_unit_test(the_value_of_an_assignment_is_what_was_assigned),
        cmocka_unit_test(the_first_of_three_results_may_be_dead),
        cmocka_unit_test(conversions_from_float_stop_at_the_ends_of_their_own_format),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
