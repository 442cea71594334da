/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include "base/simd_operations.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Functions from outside: extern "C". */

static void assert_refused(const char *source, bool allows, const char *words) {
    const struct shader_compile_options options = {.allows_external = allows};
    struct shader_program *program = NULL;
    struct status status = {0};
    if (shader_compile("test.sl", source, strlen(source), &options, &program, &status))
        fail_msg("compiles: %s", source);
    if (!strstr(status.message, words))
        fail_msg("%s\nsays\n%s\nnot\n%s", source, status.message, words);
}

static void what_cannot_be_is_refused(void **state) {
    assert_refused("extern \"C\" float f(float x); surface t() { Ci = f(s); }", false,
                   "test.sl:1:1: error: this shader calls functions of an object of yours, which "
                   "the command line must allow: --link FILE.so");
    assert_refused("extern \"D\" float f(float x); surface t() { Ci = f(s); }", true,
                   "functions from outside are extern \"C\"");
    assert_refused("extern \"C\" float f(float x) { return x; } surface t() { Ci = f(s); }", true,
                   "has no body");
    assert_refused("extern \"C\" color f(float x); surface t() { Ci = f(s); }", true,
                   "its result is a float");
    assert_refused("extern \"C\" float f(color x); surface t() { Ci = f(Cs); }", true,
                   "must be a plain float");
    assert_refused("extern \"C\" float f(output float x); surface t() { Ci = 0; }", true,
                   "must be a plain float");
    assert_refused("extern \"C\" float f(float x[2]); surface t() { Ci = 0; }", true,
                   "must be a plain float");
    assert_refused("extern \"C\" float f(float a, b, c, d, e, f, g, h, i); surface t() { Ci = 0; }",
                   true, "at most 8 floats");
    assert_refused("extern \"C\" float f(float x); surface t() { Ci = f(s, t); }", true,
                   "f() takes 1 argument, not 2");
    assert_refused("extern \"C\" float x; surface t() { Ci = 0; }", true,
                   "expected a function after extern");
    assert_refused("extern \"C\"", true, "test.sl:1");
}

static float called_with[4096];
static int calls;

static float twice(float x) {
    called_with[calls++ % 4096] = x;
    return 2 * x;
}

static void open_linked(struct harness *h, const char *source, int width) {
    static const char *const material[] = {"s", NULL};
    harness_open(h, source, width, material);
    calls = 0;
    for (int i = 0; i < h->module->external_count; i++) {
        assert_string_equal(h->module->externals[i].name, "twice");
        float (*function)(float) = twice;
        memcpy(h->module->externals[i].address, &function, sizeof function);
    }
}

static void only_samples_that_take_part_are_called_for(void **state) {
    for (int width = 4; width <= 16; width *= 2) {
        struct harness h;
        struct harness_result result;
        open_linked(&h,
                    "extern \"C\" float twice(float x); surface t() { float v = 1; "
                    "if (s > 2) v = twice(s) + twice(s); Ci = v; }",
                    width);
        harness_run(&h, NULL, 0, &result);
        for (int i = 0; i < HARNESS_SAMPLES; i++)
            assert_true(result.color[0][i] == (i > 2 ? 4.0f * (float)i : 1.0f));
        assert_true(calls >= HARNESS_SAMPLES - 3);
        for (int i = 0; i < calls; i++)
            assert_true(called_with[i] > 2);
        /* twice(s) twice is one call */
        assert_int_equal(harness_operations(h.module, SHADER_PRE_ILLUM, SIMD_EXTERNAL_CALL), 1);
        harness_close(&h);
    }
}

static void uniform_calls_are_made_once_and_cost_nothing(void **state) {
    struct harness h;
    struct harness_result result;
    open_linked(&h,
                "extern \"C\" float twice(float x); surface t(uniform float k = 3;) { "
                "Ci = s * twice(k); }",
                8);
    harness_run(&h, NULL, 0, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        assert_true(result.color[0][i] == 6.0f * (float)i);
    assert_int_equal(calls, 1);
    assert_int_equal(harness_operations(h.module, SHADER_PRE_ILLUM, SIMD_EXTERNAL_CALL), 0);
    harness_close(&h);
}

static void what_nobody_calls_is_not_linked(void **state) {
    struct harness h;
    open_linked(
        &h, "extern \"C\" float twice(float x); surface t() { float v = twice(s); Ci = 1; }", 4);
    assert_int_equal(h.module->external_count, 0);
    harness_close(&h);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(only_samples_that_take_part_are_called_for),
        cmocka_unit_test(uniform_calls_are_made_once_and_cost_nothing),
        cmocka_unit_test(what_nobody_calls_is_not_linked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
