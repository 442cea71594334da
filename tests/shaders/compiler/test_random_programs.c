/* SPDX-License-Identifier: Apache-2.0 */
/* usage: test_random_programs [PROGRAMS [FIRST-SEED]] */
#include "program_comparison.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

enum { BUNDLE = 400 };

static int program_count = BUNDLE;
static uint64_t first_program = 1;

static void compiled_and_evaluated_programs_agree_to_the_bit(void **state) {
    static const struct comparison_settings settings[] = {
        {8, "-O0"}, {16, "-O0"}, {4, "-O0"}, {8, "-O1"}, {16, "-O0"}, {4, "-O0"},
        {8, "-O0"}, {16, "-O2"}, {4, "-O0"}, {8, "-O0"}, {16, "-O0"}, {4, "-O1"}};
    time_t shown = time(NULL);
    for (int at = 0; at < program_count; at += BUNDLE) {
        struct comparison_result result;
        uint64_t first = first_program + (uint64_t)at;
        int count = program_count - at < BUNDLE ? program_count - at : BUNDLE;
        const struct comparison_settings *one =
            &settings[first / BUNDLE % (sizeof settings / sizeof *settings)];
        if (time(NULL) > shown + 60) {
            shown = time(NULL);
            print_message("%d programs\n", at);
        }
        if (comparison_run(first, count, one, &result))
            continue;
        if (result.message[0]) {
            for (int i = 0; !result.seed && i < count; i++) /* which one the C compiler refuses */
                if (!comparison_run(first + (uint64_t)i, 1, one, &result) && !result.seed)
                    result.seed = first + (uint64_t)i;
            struct random_program program;
            random_program_make(&program, result.seed, false);
            puts(program.text); /* longer than cmocka prints */
            fail_msg("program %llu: %s", (unsigned long long)result.seed, result.message);
        }
        char *reduced = comparison_reduce(result.seed, first, one);
        puts(reduced);
        free(reduced);
        fail_msg("program %llu (of the %d from %llu), %d lanes, %s: sample %d is %a %a %a compiled "
                 "and %a %a %a by reference",
                 (unsigned long long)result.seed, count, (unsigned long long)first, one->width,
                 one->optimisation, result.sample, (double)result.compiled[0],
                 (double)result.compiled[1], (double)result.compiled[2],
                 (double)result.reference[0], (double)result.reference[1],
                 (double)result.reference[2]);
    }
}

int main(int count, char **words) {
    if (count > 1)
        program_count = atoi(words[1]);
    if (count > 2)
        first_program = strtoull(words[2], NULL, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compiled_and_evaluated_programs_agree_to_the_bit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
