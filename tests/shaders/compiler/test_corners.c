/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The corners of the language, a file each (corners/). Every shader checks itself: it makes green,
 * (0, 1, 0), of every sample when what it asks for holds. A surface and an imager do so by Ci, a
 * volume with a red surface before it, a displacement by an output parameter `ok`, a light by the
 * light that it sheds. Comments at the start say what else is expected:
 *
 *   // warning: TEXT    exactly these, in this order
 *   // error: TEXT      the compilation fails, and says this first
 *   // overrun          a loop is stopped */

static char folder[4096];
static int file_count;
static char **file_names;

static const char *read_include(void *context, const char *name, size_t *length) {
    static char texts[4][4096];
    char path[8192];
    int *next = context;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file || *next == 4)
        return NULL;
    *length = fread(texts[*next], 1, sizeof texts[0] - 1, file);
    fclose(file);
    return texts[(*next)++];
}

static struct shader_program *compile(const char *path, const char *text, struct status *status) {
    int next = 0;
    struct shader_compile_options options = {.read_include = read_include,
                                             .read_include_context = &next};
    struct shader_program *program = NULL;
    shader_compile(path, text, strlen(text), &options, &program, status);
    return program;
}

/* The texts after "// WORD: " in the comments at the start, one a line. */
static void expectations(const char *text, const char *word, char *lines, size_t size) {
    char start[32];
    snprintf(start, sizeof start, "// %s", word);
    lines[0] = '\0';
    for (; !strncmp(text, "// ", 3); text = strchr(text, '\n') + 1) {
        const char *end = strchr(text, '\n');
        if (strncmp(text, start, strlen(start)))
            continue;
        snprintf(lines + strlen(lines), size - strlen(lines), "%.*s\n",
                 (int)(end - text - (long)strlen(start)), text + strlen(start));
    }
}

static void check_warnings(const char *path, const struct shader_program *program,
                           const char *wanted) {
    char found[8192] = "";
    for (int i = 0; i < program->warning_count; i++) {
        const char *text = strstr(program->warnings[i], "warning: ") + 9;
        snprintf(found + strlen(found), sizeof found - strlen(found), "%.*s\n",
                 (int)strcspn(text, "\n"), text);
    }
    if (strcmp(found, wanted))
        fail_msg("%s warns\n%snot\n%s", path, found, wanted);
}

static void open_around(struct harness *h, const char *text, const struct shader_program *program) {
    if (program->kind == SHADER_KIND_DISPLACEMENT)
        harness_open_program(h,
                             harness_compile_with("surface around() { float ok = 0; displacement("
                                                  "\"ok\", ok);\n"
                                                  "  Ci = color (0, ok, 0) + 0 * (N . P); }",
                                                  text, NULL),
                             8);
    else
        harness_open_program(
            h, harness_compile_with("surface around() { Ci = color (1, 0, 0); }", NULL, text), 8);
}

static void run(const char *path, const char *text, struct shader_program *program, bool overruns) {
    static const char lit[] = "surface lit() { Ci = ambient(); illuminance (P) Ci += Cl; }";
    struct harness h, light;
    struct harness *lights[1] = {&light};
    struct harness_result result;
    const bool is_light = program->kind == SHADER_KIND_LIGHT;
    const bool has_around =
        program->kind == SHADER_KIND_DISPLACEMENT || program->kind == SHADER_KIND_VOLUME;
    if (has_around)
        open_around(&h, text, program);
    else if (is_light)
        harness_open(&h, lit, 8, NULL);
    else
        harness_open_program(&h, program, 8);
    if (is_light)
        harness_open_program(&light, program, 8);
    harness_run(&h, lights, is_light, &result);
    for (int i = 0; i < HARNESS_SAMPLES; i++)
        if (result.color[0][i] != 0 || result.color[1][i] != 1 || result.color[2][i] != 0)
            fail_msg("%s: sample %d is (%g, %g, %g)", path, i, (double)result.color[0][i],
                     (double)result.color[1][i], (double)result.color[2][i]);
    assert_int_equal(result.overrun, overruns);
    harness_close(&h);
    if (is_light)
        harness_close(&light);
    if (has_around)
        shader_program_destroy(program);
}

static void check(const char *path) {
    static char text[1 << 16], warnings[8192], errors[1024], overrun[64];
    struct status status = {0};
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
    expectations(text, "warning: ", warnings, sizeof warnings);
    expectations(text, "error: ", errors, sizeof errors);
    expectations(text, "overrun", overrun, sizeof overrun);
    struct shader_program *program = compile(path, text, &status);
    if (errors[0]) {
        errors[strlen(errors) - 1] = '\0';
        assert_null(program);
        const char *found = strstr(status.message, "error: ");
        if (!found || strncmp(found + 7, errors, strlen(errors)))
            fail_msg("%s says\n%s\nnot\n%s", path, status.message, errors);
        return;
    }
    if (!program)
        fail_msg("%s", status.message);
    check_warnings(path, program, warnings);
    run(path, text, program, overrun[0] != '\0');
}

/* The files are dealt out to several processes of the test: this one takes every `of`-th. */
static int first, of;

static void every_shader_makes_green(void **state) {
    assert_true(file_count >= 60);
    for (int i = first; i < file_count; i += of)
        check(file_names[i]);
}

int main(int count, char **names) {
    if (count < 4)
        return 1;
    first = atoi(names[1]);
    of = atoi(names[2]);
    file_count = count - 3;
    file_names = names + 3;
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_shader_makes_green)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
