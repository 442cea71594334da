/* SPDX-License-Identifier: Apache-2.0 */
/* One bundle of random programs; compare_programs.c compares as many as asked for. */
#include "program_comparison.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static void compiled_and_evaluated_programs_agree_to_the_bit(void **state) {
    (void)state;
    struct comparison_result result;
    const struct bundle_settings *settings = comparison_settings_of(1);
    if (comparison_run(1, COMPARISON_BUNDLE, settings, &result))
        return;
    char *report = comparison_report(1, settings, &result);
    puts(report); /* longer than cmocka prints */
    free(report);
    fail_msg("%d of %d programs differ", result.differences, COMPARISON_BUNDLE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compiled_and_evaluated_programs_agree_to_the_bit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
