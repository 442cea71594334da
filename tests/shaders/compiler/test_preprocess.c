/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Files that #include may find. */
static const struct {
    const char *name, *text;
} files[] = {
    {"constants.h", "#ifndef CONSTANTS_H\n#define CONSTANTS_H\n#define THREE 3\n#endif\n"},
    {"patterns/tile.h", "#include \"parts/edge.h\"\n#include \"constants.h\"\n"
                        "float tile(float x) { return EDGE(x) + THREE; }\n"},
    {"patterns/parts/edge.h", "#define EDGE(x) step(0.5, mod(x, 1))\n"},
    {"itself.h", "#include \"itself.h\"\n"},
    {"wrong.h", "float one() { return 1; }\nfloat two() { return nothing; }\n"},
    {"open.h", "#if 1\nfloat one() { return 1; }\n"},
};

static const char *read_include(void *context, const char *name, size_t *length) {
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        if (!strcmp(files[i].name, name)) {
            *length = strlen(files[i].text);
            return files[i].text;
        }
    return NULL;
}

static struct shader_program *compile(const char *source, struct status *status) {
    struct shader_compile_options options = {.read_include = read_include};
    struct shader_program *program = NULL;
    shader_compile("test.sl", source, strlen(source), &options, &program, status);
    return program;
}

/* Both give the same C. */
static void assert_same(const char *with, const char *without) {
    struct status status = {0};
    struct shader_program *a = compile(with, &status), *b;
    if (!a)
        fail_msg("%s", status.message);
    b = compile(without, &status);
    if (!b)
        fail_msg("%s", status.message);
    assert_string_equal(a->c_source, b->c_source);
    shader_program_destroy(a);
    shader_program_destroy(b);
}

static void a_macro_is_what_it_stands_for(void **state) {
    assert_same("#define WIDTH 0.25\n#define BLUR /* none */\nsurface a() { BLUR Ci = WIDTH * s; }",
                "surface a() { Ci = 0.25 * s; }");
    assert_same("#define MIX(a, b, x) ((a) * (1 - (x)) + \\\n    (b) * (x))\n"
                "surface a() { Ci = MIX(s, max(t, 2), MIX(u, v, 0.5)); }",
                "surface a() { Ci = ((s) * (1 - (((u) * (1 - (0.5)) + (v) * (0.5)))) + (max(t, 2)) "
                "* (((u) * (1 - (0.5)) + (v) * (0.5)))); }");
    assert_same("#define vec point\n#define s2(x) x x\n#define NONE() 4\n"
                "surface a() { vec s2 = P; Ci = NONE() * length(s2); }",
                "surface a() { point s2 = P; Ci = 4 * length(s2); }");
    assert_same("#define s (s + 1)\n#define f(x) g(x)\n#define g(x) f(x)\n"
                "float f(float x) { return x; }\nsurface a() { Ci = f(s); }",
                "float f(float x) { return x; }\nsurface a() { Ci = f((s + 1)); }");
    assert_same(
        "#define PASTE(a, b) a ## b\n#define TURN 7\n#define SHOW(x) #x\n"
        "#define LATER(a, b) PASTE(a, b)\n#define ONE a\n"
        "surface a(string a1 = SHOW(TURN + \"x\"); string a = \"\";) { float TURNS = 2, PASTE(T, "
        "URNED) = 3;\n"
        "  Ci = PASTE(TURN, S) * PASTE(1, 2) * (a1 == SHOW(b  c) ? 1 : LATER(ONE, ) == \"\" ? 2 "
        ": 3); }",
        "surface a(string a1 = \"TURN + \\\"x\\\"\"; string a = \"\";) { float TURNS = 2, TURNED = "
        "3;\n"
        "  Ci = TURNS * 12 * (a1 == \"b c\" ? 1 : a == \"\" ? 2 : 3); }");
    assert_same(
        "#define HERE __LINE__\n\nsurface a() {\n  Ci = (\"test.sl\" == __FILE__ ? 1 : 0) + "
        "HERE; }",
        "surface a() {\n  Ci = (\"test.sl\" == \"test.sl\" ? 1 : 0) + 4; }");
    assert_same("#define K 1\n#undef K\n#define K 2\n#define K 2\n#pragma nolint 'x\n"
                "surface a() { Ci = K\n; }",
                "surface a() { Ci = 2; }");
    /* the classic way to write snoise: across lines, with nested calls */
    assert_same("#define snoise(x) (2 * (float noise(x)) - 1)\n"
                "surface a() { Ci = snoise(\n  snoise(P)\n); }",
                "surface a() { Ci = (2 * (float noise((2 * (float noise(P)) - 1))) - 1); }");
}

static void conditions_choose_what_is_read(void **state) {
    static const struct {
        const char *condition;
        bool holds;
    } cases[] = {
        {"#if 1", true},
        {"#if 0", false},
        {"#ifdef A", true},
        {"#ifndef A", false},
        {"#if defined(A) && !defined B", true},
        {"#if defined(B) || A > 4", true},
        {"#if A * 2 - 1 == 9 && (A / 2 != 3)", true},
        {"#if TWICE(A) >= 11", false},
        {"#if UNKNOWN", false},
        {"#if -A < 0", true},
        {"#if 3 / 2 == 1 && 7 % 4 == 3 && 0x10 == 16 && 010 == 8 && 5L == 5", true},
        {"#if (A & 4) && (A | 2) == 7 && (A ^ 1) == 4 && ~0 == -1", true},
        {"#if 1 << 3 == 8 && 9 >> 2 == 2", true},
        {"#if A == 5 ? 0 : 1 / 0", false},
        {"#if defined B && 1 / B", false},
        {"#if A - 2.5 == 2.5", true},
        {"#ifdef A\n#undef B\n#ident \"$Id\"\n#endif\n#if !defined(B)", true},
        {"#if 0\n#if 1\n#else\nnonsense ' $\n#endif\n /* #endif */ #\n#elif A == 5", true},
        {"#if 1\nfloat unused() { return 1; }\n#elif nonsense(\n#endif\n#if 0", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char source[512];
        snprintf(source, sizeof source,
                 "#define A 5\n#define TWICE(x) 2 * x\n%s\n#define K 1\n  # else // not so\n"
                 "#define K 2\n#endif\nsurface a() { Ci = K; }",
                 cases[i].condition);
        assert_same(source, cases[i].holds ? "surface a() { Ci = 1; }" : "surface a() { Ci = 2; }");
    }
}

static void included_files_are_read_in_place(void **state) {
    assert_same("#define TILE \"patterns/tile.h\"\n#include <constants.h>\n#include TILE\n"
                "surface a() { Ci = tile(s) * THREE; }",
                "float tile(float x) { return step(0.5, mod(x, 1)) + 3; }\n"
                "surface a() { Ci = tile(s) * 3; }");
    assert_same("#include \"constants.h\"\n#include \"constants.h\"\n"
                "#include \"patterns/tile.h\"\nsurface a() { Ci = tile(s) * THREE; }",
                "float tile(float x) { return step(0.5, mod(x, 1)) + 3; }\n"
                "surface a() { Ci = tile(s) * 3; }");
}

/* Each mistake and the start of what is said about it. */
static const struct {
    const char *source, *message;
} mistakes[] = {
    {"#define F(x) x +\nsurface a() { Ci = 1 +\n  F(2); }",
     "test.sl:3:7: error: expected an expression, not ';'\n  F(2); }\n      ^"},
    {"#define TINT coluor\nsurface a() { Ci = 2 * TINT; }",
     "test.sl:2:24: error: 'coluor' is not declared\nsurface a() { Ci = 2 * TINT; }\n"
     "                       ^"},
    {"#define F(x, y) x\nsurface a() { Ci = F(1); }",
     "test.sl:2:20: error: macro 'F' takes 2 arguments, not 1"},
    {"#define F(x) x\nsurface a() { Ci = F(1; }",
     "test.sl:2:20: error: the arguments of macro 'F' never end"},
    {"#define F(x) x ##\nsurface a() { Ci = 1; }",
     "test.sl:1:9: error: ## stands between two words"},
    {"#define F(x, y) x ## y\nsurface a() { Ci = F(+, 1); }",
     "test.sl:2:20: error: ## does not make one word of \"+1\""},
    {"#if (1 ? 2\n#endif\nsurface a() { Ci = 1; }",
     "test.sl:1:2: error: expected ':' in the condition"},
    {"#define F(x\nsurface a() { Ci = 1; }",
     "test.sl:1:10: error: expected the names of a macro's parameters, then ')'"},
    {"#define 3\nsurface a() { Ci = 1; }", "test.sl:1:9: error: expected the name of a macro"},
    {"#if 1 +\n#endif\nsurface a() { Ci = 1; }",
     "test.sl:1:2: error: expected a condition of numbers and names"},
    {"#if 1 / 0\n#endif\nsurface a() { Ci = 1; }",
     "test.sl:1:2: error: division by zero in a condition"},
    {"surface a() { Ci = 1; }\n#ifdef X", "test.sl:2:2: error: this #if is never closed"},
    {"#endif\nsurface a() { Ci = 1; }", "test.sl:1:2: error: #endif without #if"},
    {"#if 1\n#else\n#else\n#endif\nsurface a() { Ci = 1; }",
     "test.sl:3:2: error: #else after #else"},
    {"#ifndef X\n#error wants X\n#endif\nsurface a() { Ci = 1; }",
     "test.sl:2:1: error: #error wants X"},
    {"#import x\nsurface a() { Ci = 1; }", "test.sl:1:1: error: there is no directive #import"},
    {"#include <x.h>\nsurface a() { Ci = 1; }",
     "test.sl:1:10: error: cannot find \"x.h\" to include\n#include <x.h>\n         ^"},
    {"#include x\nsurface a() { Ci = 1; }",
     "test.sl:1:1: error: expected #include \"file\" or <file>"},
    {"#include <constants.h> x\nsurface a() { Ci = 1; }",
     "test.sl:1:10: error: expected #include \"file\" or <file>"},
    {"#include \"x.h\"\nsurface a() { Ci = 1; }",
     "test.sl:1:10: error: cannot find \"x.h\" to include\n#include \"x.h\"\n         ^"},
    {"#include \"itself.h\"\nsurface a() { Ci = 1; }",
     "itself.h:1:10: error: files include each other more than 32 deep"},
    {"#include \"wrong.h\"\nsurface a() { Ci = two(); }",
     "wrong.h:2:22: error: 'nothing' is not declared\nfloat two() { return nothing; }\n"},
    {"#include \"open.h\"\nsurface a() { Ci = one(); }",
     "open.h:1:2: error: this #if is never closed"},
    {"# 40 \"other.sl\"\n#define X 1\nsurface a() { Ci = x; }",
     "other.sl:41:20: error: 'x' is not declared"},
};

static void mistakes_are_shown_where_they_are(void **state) {
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        struct status status = {0};
        assert_null(compile(mistakes[i].source, &status));
        if (strncmp(status.message, mistakes[i].message, strlen(mistakes[i].message)))
            fail_msg("%s\nsays\n%s\nnot\n%s", mistakes[i].source, status.message,
                     mistakes[i].message);
    }
}

static void expansion_ends(void **state) {
    char source[8192] = "#define M0 1 + 1 +\n";
    struct status status = {0};
    for (int i = 1; i < 40; i++) {
        size_t used = strlen(source);
        snprintf(source + used, sizeof source - used, "#define M%d M%d M%d\n", i, i - 1, i - 1);
    }
    strcat(source, "surface a() { Ci = M39 1; }");
    assert_null(compile(source, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    strcpy(source, "#define F(x) x\nsurface a() { Ci = ");
    for (int i = 0; i < 500; i++)
        strcat(source, "F(");
    assert_null(compile(source, &status));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_macro_is_what_it_stands_for),
        cmocka_unit_test(conditions_choose_what_is_read),
        cmocka_unit_test(included_files_are_read_in_place),
        cmocka_unit_test(mistakes_are_shown_where_they_are),
        cmocka_unit_test(expansion_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
