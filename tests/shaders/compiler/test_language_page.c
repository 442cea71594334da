/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include "shaders/compiler/builtins.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* docs/language.md: its examples are shaders, and its table of functions is complete. */

static char page[1 << 17];

static bool is_shader(const char *text) {
    for (int kind = 0; kind < SHADER_KIND_COUNT; kind++) {
        char start[32];
        snprintf(start, sizeof start, "\n%s ", shader_kind_name((enum shader_kind)kind));
        if (!strncmp(text, start + 1, strlen(start + 1)) || strstr(text, start))
            return true;
    }
    return false;
}

static void every_example_compiles(void **state) {
    int count = 0;
    for (const char *at = page; (at = strstr(at, "```rsl\n")); count++) {
        static char text[8192], source[8192 + 64];
        at += strlen("```rsl\n");
        const char *end = strstr(at, "```");
        assert_non_null(end);
        snprintf(text, sizeof text, "%.*s", (int)(end - at), at);
        snprintf(source, sizeof source, is_shader(text) ? "%s" : "surface example() {\n%s}\n",
                 text);
        struct status status = {0};
        struct shader_program *program = harness_compile(source, NULL, &status);
        if (!program)
            fail_msg("%s\nin\n%s", status.message, source);
        if (program->warning_count)
            fail_msg("%s\nin\n%s", program->warnings[0], source);
        shader_program_destroy(program);
        at = end + 3;
    }
    assert_true(count >= 6);
}

static void assert_named(const char *name) {
    char call[80], bare[80];
    snprintf(call, sizeof call, "`%s(", name);
    snprintf(bare, sizeof bare, "`%s`", name);
    if (!strstr(page, call) && !strstr(page, bare))
        fail_msg("docs/language.md does not name %s", name);
}

static void every_function_and_predefined_variable_is_named(void **state) {
    for (int i = 0; i < BUILTIN_COUNT; i++)
        assert_named(builtins[i].name);
    for (int i = 0; i < global_count; i++)
        assert_named(globals[i].name);
}

int main(int count, char **names) {
    FILE *file = count > 1 ? fopen(names[1], "rb") : NULL;
    if (!file)
        return 1;
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_example_compiles),
        cmocka_unit_test(every_function_and_predefined_variable_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
