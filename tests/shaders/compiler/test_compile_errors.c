/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Each mistake, and the whole of what is said about it. */
static const struct {
    const char *source, *message;
} mistakes[] = {
    {"surface a() {\n\tCi = color(1,0,0) + Foo;\n}",
     "test.sl:2:22: error: 'Foo' is not declared\n\tCi = color(1,0,0) + Foo;\n\t                   "
     " ^"},
    {"surface a(float colour = 1;) { Ci = shade1 * coluor; }",
     "test.sl:1:37: error: 'shade1' is not declared\n"
     "surface a(float colour = 1;) { Ci = shade1 * coluor; }\n"
     "                                    ^\n"
     "test.sl:1:46: error: 'coluor' is not declared; did you mean 'colour'?\n"
     "surface a(float colour = 1;) { Ci = shade1 * coluor; }\n"
     "                                             ^"},
    {"surface a() { Ci = normalise(N); }",
     "test.sl:1:20: error: there is no function 'normalise'; did you mean 'normalize'?\n"
     "surface a() { Ci = normalise(N); }\n"
     "                   ^"},
    {"float dark() { return occlusion(P, N, 16); }\nsurface a() { Ci = 1; }", NULL},
    {"float dark() { return occlusion(P, N, 16); }\nsurface a() { Ci = dark(); }",
     "test.sl:1:23: error: occlusion() is not supported: it needs ray tracing, and samples are "
     "shaded after all other geometry is gone\n"
     "float dark() { return occlusion(P, N, 16); }\n"
     "                      ^"},
    {"surface a() { gather (\"illuminance\", P, N, PI, 4) Ci += 1; else Ci = 0; }",
     "test.sl:1:15: error: gather() is not supported: it needs ray tracing, and samples are shaded "
     "after all other geometry is gone\n"
     "surface a() { gather (\"illuminance\", P, N, PI, 4) Ci += 1; else Ci = 0; }\n"
     "              ^"},
    {"surface a() { float x[2], y[3]; x = y; Ci = x[0]; }",
     "test.sl:1:35: error: an array is assigned element by element, or from one of the same type "
     "and "
     "length\n"
     "surface a() { float x[2], y[3]; x = y; Ci = x[0]; }\n"
     "                                  ^"},
    {"displacement a() { Ci = 1; }",
     "test.sl:1:20: error: Ci has no value in displacement shaders\n"
     "displacement a() { Ci = 1; }\n"
     "                   ^"},
    {"displacement a() { illuminance (P) P += 1; }",
     "test.sl:1:20: error: illuminance belongs into a surface shader\n"
     "displacement a() { illuminance (P) P += 1; }\n"
     "                   ^"},
    {"transformation a() { }",
     "test.sl:1:1: error: transformation shaders are not supported: geometry is transformed by the "
     "scene, before any shader runs\ntransformation a() { }\n^"},
    {"surface a() { matrix m = 1; Ci = xcomp(P * m); }",
     "test.sl:1:42: error: '*' does not work between point and matrix\n"
     "surface a() { matrix m = 1; Ci = xcomp(P * m); }\n"
     "                                         ^"},
    {"surface a() { Ci = spline(\"bezier\", s, 1, 2, 3, 4, 5); }",
     "test.sl:1:20: error: a bezier spline has 4 values and 3 more for each further segment, not "
     "5\n"
     "surface a() { Ci = spline(\"bezier\", s, 1, 2, 3, 4, 5); }\n"
     "                   ^"},
    {"surface a() { Ci = spline(s, \"x\", 2, 3, 4, 5); }",
     "test.sl:1:30: error: there are no splines of string\n"
     "surface a() { Ci = spline(s, \"x\", 2, 3, 4, 5); }\n"
     "                             ^"},
    {"surface a() { Ci = color \"lab\" (1, 2, 3); }",
     "test.sl:1:20: error: unknown color space \"lab\"; there are rgb, hsv, hsl, YIQ and xyz\n"
     "surface a() { Ci = color \"lab\" (1, 2, 3); }\n"
     "                   ^"},
    {"surface a() {\n  uniform float k = s;\n  Ci = k;\n}",
     "test.sl:2:21: error: a value that varies is assigned to uniform 'k'\n  uniform float k = "
     "s;\n                    ^"},
    {"surface a(uniform float k = 0;) { Ci = k; }", NULL},
    {"float f(float x) { return g(x); }\nfloat g(float x) { return f(x); }\nsurface a() { Ci = "
     "f(s); }",
     "test.sl:2:27: error: recursion: f calls g calls f; functions are inlined and cannot call "
     "themselves\n"
     "float g(float x) { return f(x); }\n                          ^"},
    {"#include \"x.h\"\nsurface a() { Ci = 1; }",
     "test.sl:1:10: error: #include is not possible here: there are no files to read from\n"
     "#include \"x.h\"\n         ^"},
    {"# 40 \"other.sl\"\nsurface a() { Ci = x; }",
     "other.sl:40:20: error: 'x' is not declared\nsurface a() { Ci = x; }\n                   ^"},
    {"surface a() { Ci = 1 }\n",
     "test.sl:1:22: error: expected ';' before '}'\nsurface a() { Ci = 1 }\n"
     "                     ^"},
    {"surface a() { Ci = transform(\"wrld\", P); }",
     "test.sl:1:20: error: cannot use point where color is wanted; say color (...)\n"
     "surface a() { Ci = transform(\"wrld\", P); }\n                   ^"},
    {"surface a() { Ci = xcomp(transform(\"wrld\", P)); }", NULL},
    {"surface a() { break; }",
     "test.sl:1:15: error: this is not inside a loop\nsurface a() { break; }\n"
     "              ^"},
    {"surface a(float k = 1;) { k = 2; Ci = k; }", NULL},
    {"displacement a(float k = 1;) { P += k; }", NULL},
    {"", "test.sl:1:1: error: there is no shader in this file\n\n^"},
    {"surface a() { Ci = Cl; }",
     "test.sl:1:20: error: Cl has a value only inside illuminance\nsurface a() { Ci = Cl; }\n"
     "                   ^"},
};

static void every_mistake_is_shown_where_it_is(void **state) {
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        struct status status = {0};
        struct shader_program *program = harness_compile(mistakes[i].source, NULL, &status);
        if (!mistakes[i].message) {
            assert_non_null(program);
        } else {
            assert_null(program);
            assert_string_equal(status.message, mistakes[i].message);
        }
        shader_program_destroy(program);
    }
}

static void at_most_eight_errors_are_reported(void **state) {
    char source[4096] = "surface a() {\n";
    struct status status = {0};
    int errors = 0;
    for (int i = 0; i < 30; i++)
        strcat(source, "x = 1;\n");
    strcat(source, "}");
    assert_null(harness_compile(source, NULL, &status));
    for (const char *at = status.message; (at = strstr(at, "error:")); at++)
        errors++;
    assert_int_equal(errors, 8);
}

static void a_uniform_parameter_cannot_come_with_the_primitives(void **state) {
    struct status status = {0};
    const char *const material[] = {"k", NULL};
    assert_null(harness_compile("surface a(uniform float k = 1;) { Ci = k; }", material, &status));
    assert_string_equal(
        status.message,
        "test.sl:1:25: error: 'k' comes with the primitives, but is declared uniform\n"
        "surface a(uniform float k = 1;) { Ci = k; }\n                        ^");
}

static void limits_are_errors(void **state) {
    struct status status = {0};
    size_t length = (1 << 20) + 1;
    char *big = calloc(length + 1, 1);
    memset(big, ' ', length);
    assert_null(harness_compile(big, NULL, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    memset(big, '(', 5000);
    big[5000] = '\0';
    memcpy(big, "surface a() { Ci = ", 19);
    assert_null(harness_compile(big, NULL, &status));
    assert_non_null(strstr(status.message, "nested more than 200 deep"));
    free(big);
    /* 2^20 calls that add no instruction are work, too */
    char source[4096] = "float f0(float x) { return x; }\n";
    for (int i = 1; i <= 20; i++) {
        size_t used = strlen(source);
        snprintf(source + used, sizeof source - used,
                 "float f%d(float x) { return f%d(f%d(x)); }\n", i, i - 1, i - 1);
    }
    strcat(source, "surface a() { Ci = f20(s); }");
    assert_null(harness_compile(source, NULL, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
}

static void long_chains_of_calls_end_in_a_message(void **state) {
    enum { FUNCTIONS = 5000, SIZE = 1 << 19 };
    char *source = calloc(SIZE, 1);
    struct status status = {0};
    size_t used = (size_t)sprintf(source, "float f0(float x) { return x; }\n");
    for (int i = 1; i < FUNCTIONS; i++)
        used += (size_t)snprintf(source + used, SIZE - used,
                                 "float f%d(float x) { return 1 + f%d(x); }\n", i, i - 1);
    snprintf(source + used, SIZE - used, "surface a() { Ci = f%d(s); }", FUNCTIONS - 1);
    assert_null(harness_compile(source, NULL, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    assert_non_null(strstr(status.message, "nested too deep once functions are inlined"));
    strcpy(source, "float f0(float x) { return x; }\n");
    for (int i = 1; i < 200; i++) { /* blocks inside blocks in each of them */
        char open[101], close[101];
        memset(open, '{', 100);
        memset(close, '}', 100);
        open[100] = close[100] = '\0';
        sprintf(source + strlen(source),
                "float f%d(float x) { float y; %s y = f%d(x); %s return y; }\n", i, open, i - 1,
                close);
    }
    strcat(source, "surface a() { Ci = f199(s); }");
    assert_null(harness_compile(source, NULL, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    /* 1000 operators in a row and 100 calls inside each other stay possible */
    strcpy(source, "float f0(float x) { return x; }\n");
    for (int i = 1; i <= 100; i++)
        sprintf(source + strlen(source), "float f%d(float x) { return 1 + f%d(x); }\n", i, i - 1);
    strcat(source, "surface a() { Ci = f100(s)");
    for (int i = 0; i < 990; i++)
        strcat(source, " + t");
    strcat(source, "; }");
    struct shader_program *program = harness_compile(source, NULL, &status);
    if (!program)
        fail_msg("%s", status.message);
    shader_program_destroy(program);
    free(source);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mistake_is_shown_where_it_is),
        cmocka_unit_test(at_most_eight_errors_are_reported),
        cmocka_unit_test(a_uniform_parameter_cannot_come_with_the_primitives),
        cmocka_unit_test(limits_are_errors),
        cmocka_unit_test(long_chains_of_calls_end_in_a_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
