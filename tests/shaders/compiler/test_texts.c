/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Strings at run time: each surface compares what it made with what it should be. */

static void assert_holds(const char *parameters, const char *condition, const char *bound) {
    char source[1024];
    struct harness h;
    struct harness_result result;
    snprintf(source, sizeof source, "surface a(%s) { if (%s) Ci = 1; else Ci = s - 100; }",
             parameters, condition);
    harness_open(&h, source, 8, NULL);
    if (bound)
        harness_bind_string(&h, "name", bound);
    harness_run(&h, NULL, 0, &result);
    harness_close(&h);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        if (result.color[0][i] != 1)
            fail_msg("%s does not hold", condition);
}

static void strings_are_put_together_at_run_time(void **state) {
    assert_holds("string name = \"wood\";",
                 "concat(name, \".\", \"tx\") == \"wood.tx\" && concat(\"a\", name) != \"awoo\"",
                 NULL);
    assert_holds("string name = \"wood\";", "concat(name, name) == \"stonestone\"", "stone");
    assert_holds("uniform float n = 7; color c = color (0.5, 1, 0.25); string name = \"x\";",
                 "format(\"%s%04d: %.2f%%\", name, n, n / 4) == \"tile0007: 1.75%\" && "
                 "format(\"(%c)\", c) == \"(0.500000 1.000000 0.250000)\" && "
                 "format(\"%3d|%-3d|\", n, -n) == \"  7|-7 |\" && "
                 "format(\"%p\", point \"shader\" (1, 2, n)) == \"1.000000 2.000000 7.000000\"",
                 "tile");
    assert_holds(
        "matrix m = 2; string name = \"a\";",
        "match(\"^2.000000 0.000000 0.000000 0.000000 0.000000 2\", format(\"%m\", m)) == 1", NULL);
}

static void string_arrays_are_arrays(void **state) {
    assert_holds(
        "string names[3] = {\"red\", \"green\", \"blue\"}; uniform float i = 2; string name = "
        "\"\";",
        "names[i] == \"blue\" && names[0] == \"red\" && names[9] == \"blue\" && "
        "concat(names[i - 1], name) == \"green!\"",
        "!");
}

static void patterns_match(void **state) {
    static const struct {
        const char *pattern, *text;
        bool matches;
    } cases[] = {
        {"oo", "wood", true},      {"^oo", "wood", false},    {"^w.*d$", "wood", true},
        {"[a-f]+$", "wood", true}, {"[^a-z]", "wood", false}, {"[^a-z]", "wo-od", true},
        {"x*", "", true},          {"x+", "", false},         {"colou?r", "my color", true},
        {"a|b|^c", "xcb", true},   {"a|^c", "xc", false},     {"\\.tx$", "a.tx", true},
        {"\\.tx$", "atx", false},  {"", "anything", true},    {"[]x]", "]", true},
        {"a.c", "abc", true},      {"a.c", "ac", false},      {"[", "[", true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (text_matches(cases[i].pattern, cases[i].text) != cases[i].matches)
            fail_msg("%s against %s", cases[i].pattern, cases[i].text);
}

static void hopeless_patterns_end(void **state) {
    char text[4001];
    memset(text, 'a', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_false(text_matches("a*a*a*a*a*a*a*a*a*a*b", text));
}

static void categories_are_lists(void **state) {
    assert_true(text_category_matches("", "anything"));
    assert_true(text_category_matches("key", "fill,key"));
    assert_false(text_category_matches("key", "keys,monkey"));
    assert_true(text_category_matches("-key", ""));
    assert_false(text_category_matches("-key,fill", "fill"));
    assert_false(text_category_matches("key", ""));
}

static void texts_that_do_not_fit_are_empty(void **state) {
    struct text_table table;
    static const struct shader_module none = {0};
    text_table_init(&table, &none, NULL, 0);
    int32_t text = text_table_add(&table, "0123456789");
    for (int i = 0; i < 8; i++)
        text = table.texts.join(&table.texts, text, text);
    assert_int_equal(strlen(text_table_find(&table, text)), 2560);
    text = table.texts.join(&table.texts, text, text);
    assert_string_equal(text_table_find(&table, text), "");
    for (int i = 0; i < 100000; i++) {
        char one[32];
        snprintf(one, sizeof one, "number %d", i);
        text_table_add(&table, one);
    }
    text_table_finish(&table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strings_are_put_together_at_run_time),
        cmocka_unit_test(string_arrays_are_arrays),
        cmocka_unit_test(patterns_match),
        cmocka_unit_test(hopeless_patterns_end),
        cmocka_unit_test(categories_are_lists),
        cmocka_unit_test(texts_that_do_not_fit_are_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
