/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Derivatives are differences inside quads of samples (docs/language.md, 6.10). The harness lays
 * quads side by side: u = s = column, v = t = 0.5 + row, P = (column, 2 + row, 3). */

static const int widths[] = {4, 8, 16};

static void run(const char *source, uint32_t absent, struct harness_result *result) {
    for (int w = 0; w < 3; w++) {
        struct harness h;
        struct harness_result one;
        harness_open(&h, source, widths[w], NULL);
        h.absent = absent;
        harness_run(&h, NULL, 0, &one);
        assert_true(h.module->uses_neighbours);
        harness_close(&h);
        if (w)
            assert_memory_equal(one.color, result->color, sizeof one.color);
        *result = one;
    }
}

static void assert_everywhere(const char *source, float r, float g, float b) {
    struct harness_result result;
    float wanted[3] = {r, g, b};
    run(source, 0, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        for (int c = 0; c < 3; c++)
            if (!(fabsf(result.color[c][i] - wanted[c]) <= 1e-5f))
                fail_msg("%s\ncomponent %d of sample %d is %g, not %g", source, c, i,
                         (double)result.color[c][i], (double)wanted[c]);
}

static void linear_functions_have_their_coefficients(void **state) {
    assert_everywhere("surface a() { Ci = color (Du(3 * u + 5 * v), Dv(3 * u + 5 * v), Du(7)); }",
                      3, 5, 0);
    assert_everywhere("surface a() { vector x = Du(P), y = Dv(P); Ci = color (xcomp(x), ycomp(x), "
                      "ycomp(y)); }",
                      1, 0, 1);
    assert_everywhere("surface a() { Ci = Du(color (2 * u, 4 * v, 0.5 * (u - v))); }", 2, 0, 0.5f);
    assert_everywhere("surface a() { Ci = color (du, dv, Deriv(3 * u + 5 * v, 2 * u + v)); }", 1, 1,
                      6.5f);
    assert_everywhere("surface a() { Ci = color (filterwidth(2 * s - 3 * t), area(P), "
                      "filterwidthp(4 * P)); }",
                      5, 1, 4);
}

static void in_a_branch_only_samples_that_take_it_are_neighbours(void **state) {
    /* a row of each quad takes one side: there is a neighbour in the row, and none in the column */
    assert_everywhere("surface a() { float right, down; if (v < 1) { float y = 3 * u + v; right = "
                      "filterwidth(y) - 3; down = Dv(y); } else { float y = u * v; right = "
                      "filterwidth(y) - 1.5; down = Dv(y); } Ci = color (right, down, 0); }",
                      0, 0, 0);
    /* a column takes it; what the other column computes is not seen */
    assert_everywhere(
        "surface a() { float f = 0, odd = mod(u, 2); if (odd > 0.5) f = filterwidth(5 * "
        "v); else { f = filterwidth(7 * v) - 2; } Ci = f; }",
        5, 5, 5);
}

static void normals_are_square_to_what_is_spanned_and_on_the_side_of_n(void **state) {
    /* the plane z = 3 - column / 2; N is (0, 0, -1) */
    float l = sqrtf(1.25f);
    assert_everywhere("surface a() { Ci = color (normalize(calculatenormal(P - vector (0, 0, 0.5 * "
                      "u)))); }",
                      -0.5f / l, 0, -1 / l);
}

static void filterstep_is_the_average_of_a_step(void **state) {
    struct harness_result result;
    run("surface a() { Ci = color (filterstep(3.25, s), filterstep(2, s - 1, s + 1), "
        "filterstep(3.25, "
        "s, \"filter\", \"gaussian\", \"width\", 2)); }",
        0, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++) {
        double s = i / 4 * 2 + (i & 1);
        assert_float_equal(result.color[0][i], fmin(fmax(s - 3.25 + 0.5, 0), 1), 1e-5);
        assert_float_equal(result.color[1][i], fmin(fmax((s + 1 - 2) / 2, 0), 1), 1e-5);
        assert_float_equal(result.color[2][i], fmin(fmax((s - 3.25) / 2 + 0.5, 0), 1), 1e-5);
    }
}

/* In each quad another sample is missing; in the last two a row and all but one. */
static void a_missing_neighbour_is_replaced_by_the_other_row_or_nothing(void **state) {
    struct harness_result result;
    /* s t is not linear: across the upper row it changes by t = 0.5, across the lower by 1.5 */
    run("surface a() { Ci = color (Du(s * t), Dv(s * t), area(P)); }", 0x1 | 0x80 | 0xc00 | 0x7000,
        &result);
    static const float right[4] = {1.5f, 0.5f, 0.5f, 0};
    for (int i = 0; i < 8; i++)
        if (i != 0 && i != 7)
            assert_float_equal(result.color[0][i], right[i / 4], 1e-6);
    for (int i = 8; i < 10; i++) /* v stands still: there is no Du, but nothing breaks either */
        for (int c = 0; c < 3; c++)
            assert_float_equal(result.color[c][i], 0, 0);
    for (int c = 0; c < 3; c++)
        assert_float_equal(result.color[c][15], 0, 0);
}

static void who_does_not_ask_has_no_quads(void **state) {
    struct harness h;
    harness_open(&h, "surface a() { float unused = Du(s); Ci = u + v; }", 8, NULL);
    assert_false(h.module->uses_neighbours);
    harness_close(&h);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_functions_have_their_coefficients),
        cmocka_unit_test(in_a_branch_only_samples_that_take_it_are_neighbours),
        cmocka_unit_test(normals_are_square_to_what_is_spanned_and_on_the_side_of_n),
        cmocka_unit_test(filterstep_is_the_average_of_a_step),
        cmocka_unit_test(a_missing_neighbour_is_replaced_by_the_other_row_or_nothing),
        cmocka_unit_test(who_does_not_ask_has_no_quads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
