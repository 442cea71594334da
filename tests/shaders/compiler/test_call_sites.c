/* SPDX-License-Identifier: Apache-2.0 */
#include "base/simd_operations.h"
#include "shaders/compiler/shader_compile.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Exact or fast, call by call: which calls there are, where they count, and that a choice changes
 * them and nothing else. */

/* Two calls at one place, a sine that is there already, a function inlined twice, and what costs
 * the array nothing. */
static const char surface_text[] =
    "#define WAVE(x) sin(x)\n"
    "float f(float x) {\n"
    "    return exp(x) + cos(x);\n"
    "}\n"
    "surface t(float a = 0.3;) {\n"
    "    float once = f(s) + f(t);\n"
    "    float uniform_one = log(a);\n"
    "    float dead = atan(s);\n"
    "    point q = rotate(P, 2 * s, point (0, 0, 0), point (0, 0, 1));\n"
    "    float macro = WAVE(s) + WAVE(t) + WAVE(s);\n"
    "    Ci = once + uniform_one + xcomp(q) + macro +\n"
    "         specular(normalize(N), -normalize(I), 0.1);\n"
    "}\n";

static struct shader_program *
compile(const char *text, const struct shader_compile_options *options, struct status *status) {
    struct shader_program *program = NULL;
    if (!shader_compile("test.sl", text, strlen(text), options, &program, status))
        return NULL;
    return program;
}

static void calls_count_where_the_source_makes_them(void **state) {
    static const struct {
        const char *function;
        int line, column, instructions, issued;
    } expected[] = {
        {"exp", 3, 12, 2, 2},  {"cos", 3, 21, 2, 2},  {"log", 7, 25, 1, 0},  {"atan", 8, 18, 0, 0},
        {"sin", 9, 15, 1, 1},  {"cos", 9, 15, 1, 1},  {"sin", 10, 19, 1, 1}, {"sin", 10, 29, 1, 1},
        {"sin", 10, 39, 0, 0}, {"pow", 12, 10, 1, 1},
    };
    struct status status = {0};
    struct shader_program *program = compile(surface_text, NULL, &status);
    assert_non_null(program);
    assert_int_equal(program->call_site_count, sizeof expected / sizeof *expected);
    for (int i = 0; i < program->call_site_count; i++) {
        const struct shader_call_site *site = &program->call_sites[i];
        assert_string_equal(shader_call_function(site), expected[i].function);
        assert_string_equal(site->file, "test.sl");
        assert_int_equal(site->line, expected[i].line);
        assert_int_equal(site->column, expected[i].column);
        assert_int_equal(site->instructions, expected[i].instructions);
        assert_int_equal(site->issued, expected[i].issued);
        assert_false(site->is_fast || site->is_included);
    }
    shader_program_destroy(program);
}

/* How often `word` stands in the C. */
static int count_words(const struct shader_program *program, const char *word) {
    int count = 0;
    for (const char *at = program->c_source; (at = strstr(at, word)); at++)
        count++;
    return count;
}

static uint32_t count_issued(const struct shader_program *program, int operation) {
    uint32_t count = 0;
    for (int i = 0; i < program->line_cost_count; i++)
        count += program->line_costs[i].operation == operation ? program->line_costs[i].count : 0;
    return count;
}

static void chosen_calls_are_fast_and_no_others(void **state) {
    struct status status = {0};
    struct shader_program *exact = compile(surface_text, NULL, &status);
    assert_non_null(exact);
    assert_int_equal(count_words(exact, "_fast("), 0);
    for (int i = 0; i < exact->call_site_count; i++) {
        const struct shader_call_site *site = &exact->call_sites[i];
        const struct shader_fast_call call = {NULL, site->line, site->column};
        const struct shader_compile_options options = {.fast_calls = {.list = &call, .count = 1}};
        struct shader_program *chosen = compile(surface_text, &options, &status);
        assert_non_null(chosen);
        int instructions = 0, issued = 0;
        for (int k = 0; k < chosen->call_site_count; k++) {
            const struct shader_call_site *other = &chosen->call_sites[k];
            const bool is_there = other->line == site->line && other->column == site->column;
            assert_int_equal(other->is_fast, is_there);
            instructions += is_there ? other->instructions : 0;
            issued += is_there ? other->issued : 0;
        }
        assert_int_equal(count_words(chosen, "_fast("), instructions);
        assert_int_equal(strcmp(chosen->c_source, exact->c_source) != 0, instructions > 0);
        int fast = 0;
#define COUNT_FAST(name) fast += (int)count_issued(chosen, SIMD_##name##_FAST);
        SIMD_FAST_FUNCTIONS(COUNT_FAST)
#undef COUNT_FAST
        assert_int_equal(fast, issued);
        shader_program_destroy(chosen);
    }
    shader_program_destroy(exact);
}

static void all_calls_chosen_is_the_fast_mode(void **state) {
    struct status status = {0};
    struct shader_program *exact = compile(surface_text, NULL, &status);
    struct shader_fast_call calls[16];
    assert_non_null(exact);
    assert_in_range(exact->call_site_count, 1, 16);
    for (int i = 0; i < exact->call_site_count; i++)
        calls[i] = (struct shader_fast_call){"test.sl", exact->call_sites[i].line,
                                             exact->call_sites[i].column};
    const struct shader_compile_options one_by_one = {.fast_calls = {.list = calls,
                                                                     .count =
                                                                         exact->call_site_count}},
                                        shader = {.fast_calls = {.all = true}},
                                        mode = {.fast_math = true};
    struct shader_program *a = compile(surface_text, &one_by_one, &status),
                          *b = compile(surface_text, &mode, &status),
                          *c = compile(surface_text, &shader, &status);
    assert_non_null(a);
    assert_non_null(b);
    assert_non_null(c);
    assert_string_equal(a->c_source, b->c_source);
    assert_string_equal(a->c_source, c->c_source);
    shader_program_destroy(exact);
    shader_program_destroy(a);
    shader_program_destroy(b);
    shader_program_destroy(c);
}

static void a_place_without_a_call_is_refused_with_the_places_there_are(void **state) {
    static const struct {
        const char *text, *file, *words;
        int line, column;
    } cases[] = {
        {"surface t() { Ci = pow(s, 3) + exp(t); }", NULL,
         "test.sl:1:9: error: no function with a fast version is called at 1:19; t has: pow at "
         "1:20, exp at 1:32",
         1, 19},
        {"surface t() { Ci = sqrt(s); }", NULL, "t has: no such call", 1, 20},
        {"surface t() { Ci = sin(s); }", "other.h", "called at other.h:1:20; t has: sin at 1:20", 1,
         20},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct shader_fast_call call = {cases[i].file, cases[i].line, cases[i].column};
        const struct shader_compile_options options = {.fast_calls = {.list = &call, .count = 1}};
        struct status status = {0};
        assert_null(compile(cases[i].text, &options, &status));
        if (!strstr(status.message, cases[i].words))
            fail_msg("%s\nsays\n%s\nnot\n%s", cases[i].text, status.message, cases[i].words);
    }
}

static const char *read_include(void *context, const char *name, size_t *length) {
    static const char text[] = "float g(float x) { return sin(x); }\n";
    *length = strlen(text);
    return strcmp(name, "g.h") ? NULL : text;
}

/* A surface, its displacement and an included file have calls at the same line and column. */
static void shaders_compiled_together_are_told_apart(void **state) {
    static const char displacement[] = "displacement d() { float a =\n"
                                       "                         sin(s);\n"
                                       "    P += 0.1 * a * normalize(N); }\n";
    static const char surface[] = "#include \"g.h\"\n"
                                  "surface t() { Ci = g(s) + sin(t) + xcomp(P); }\n";
    const struct shader_fast_call at_1_27 = {"g.h", 1, 27}, at_2_26 = {NULL, 2, 26};
    for (int which = 0; which < 4; which++) {
        const struct shader_companion before = {
            "d.sl", displacement, strlen(displacement), {&at_2_26, which == 1, false}};
        const struct shader_compile_options options = {
            .displacement = &before,
            .fast_calls = {which == 2 ? &at_1_27 : NULL, which == 2, which == 3},
            .read_include = read_include};
        struct status status = {0};
        struct shader_program *program = compile(surface, &options, &status);
        if (!program)
            fail_msg("%s", status.message);
        assert_int_equal(program->call_site_count, 3);
        for (int i = 0; i < 3; i++) {
            const struct shader_call_site *site = &program->call_sites[i];
            const int part = site->kind == SHADER_KIND_DISPLACEMENT ? 1 : site->is_included ? 2 : 3;
            assert_int_equal(site->is_fast, part == which || (which == 3 && part == 2));
            assert_string_equal(site->file, part == 1 ? "d.sl" : part == 2 ? "g.h" : "test.sl");
        }
        shader_program_destroy(program);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(calls_count_where_the_source_makes_them),
        cmocka_unit_test(chosen_calls_are_fast_and_no_others),
        cmocka_unit_test(all_calls_chosen_is_the_fast_mode),
        cmocka_unit_test(a_place_without_a_call_is_refused_with_the_places_there_are),
        cmocka_unit_test(shaders_compiled_together_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
