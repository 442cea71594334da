/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int file_count;
static char **file_names;

static void every_library_shader_compiles_and_gives_finite_colors(void **state) {
    static char source[1 << 16];
    struct harness sun, *lights[1] = {&sun};
    harness_open(&sun, "light d() { solar (vector (0, 0.3, 1), 0) Cl = 1; }", 8, NULL);
    for (int i = 0; i < file_count; i++) {
        struct harness h;
        struct harness_result result;
        FILE *file = fopen(file_names[i], "rb");
        assert_non_null(file);
        source[fread(source, 1, sizeof source - 1, file)] = '\0';
        fclose(file);
        harness_open(&h, source, 8, NULL);
        if (h.program->warning_count)
            fail_msg("%s", h.program->warnings[0]);
        if (!h.module->is_light) {
            harness_run(&h, lights, 1, &result);
            for (int c = 0; c < 3; c++)
                for (int n = 0; n < HARNESS_SAMPLES; n++)
                    if (!isfinite(result.color[c][n]) || result.color[c][n] < 0)
                        fail_msg("%s: component %d of sample %d is %g", file_names[i], c, n,
                                 (double)result.color[c][n]);
        }
        harness_close(&h);
    }
    harness_close(&sun);
}

int main(int count, char **names) {
    file_count = count - 1;
    file_names = names + 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_library_shader_compiles_and_gives_finite_colors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
