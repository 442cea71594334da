/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include "shaders/compiler/builtins.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* docs/conformance.md: it names every function and predefined variable, the tests it names are
 * there, and functions that it says are refused or neutral are. */

static char page[1 << 17];

static void everything_has_a_row(void **state) {
    for (int i = 0; i < BUILTIN_COUNT + global_count; i++) {
        char name[80];
        snprintf(name, sizeof name, "`%s`",
                 i < BUILTIN_COUNT ? builtins[i].name : globals[i - BUILTIN_COUNT].name);
        if (!strstr(page, name))
            fail_msg("docs/conformance.md does not name %s", name);
    }
}

static void the_shaders_it_names_are_there(void **state) {
    int count = 0;
    for (const char *at = page; (at = strstr(at, " corners/")); count++) {
        char path[512];
        at += strlen(" corners/");
        size_t length = strspn(at, "abcdefghijklmnopqrstuvwxyz0123456789_");
        snprintf(path, sizeof path, CORNERS "/%.*s.sl", (int)length, at);
        FILE *file = fopen(path, "rb");
        if (!file)
            fail_msg("%s is not there", path);
        fclose(file);
    }
    assert_true(count > 60);
}

/* The row of a function says so when the compiler refuses it or gives a neutral value. */
static void status_is_what_the_compiler_does(void **state) {
    for (int i = 0; i < BUILTIN_COUNT; i++) {
        char name[80];
        float value;
        snprintf(name, sizeof name, "`%s`", builtins[i].name);
        const char *row = strstr(strstr(page, "## Functions"), name);
        if (!row)
            fail_msg("%s has no row among the functions", name);
        const char *end = strchr(row, '\n'), *refused = strstr(row, "| refused"),
                   *neutral = strstr(row, "neutral: ");
        assert_int_equal(refused && refused < end, builtin_refusal(builtins[i].id) != NULL);
        if (builtin_neutral(builtins[i].id, &value))
            assert_true(neutral && neutral < end);
    }
}

int main(int count, char **names) {
    FILE *file = count > 1 ? fopen(names[1], "rb") : NULL;
    if (!file)
        return 1;
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_has_a_row),
        cmocka_unit_test(the_shaders_it_names_are_there),
        cmocka_unit_test(status_is_what_the_compiler_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
