/* SPDX-License-Identifier: Apache-2.0 */
/* The fast functions keep their promised errors on their domains, are smooth where reduced ranges
 * meet, and are sane everywhere else. */

#include "samples.h"

#include <math.h>
#include <string.h>

enum kind { ABSOLUTE, RELATIVE };

static const struct promise {
    const char *name;
    double low, high; /* inputs tested */
    enum kind kind;
    double bound;
} promises[] = {
    {"sin_fast", -8192, 8192, ABSOLUTE, 4e-4},  {"cos_fast", -8192, 8192, ABSOLUTE, 4e-4},
    {"sin_fast", -4, 4, ABSOLUTE, 4e-4},        {"cos_fast", -4, 4, ABSOLUTE, 4e-4},
    {"tan_fast", -8, 8, RELATIVE, 3.5e-3},      {"tan_fast", -8192, 8192, RELATIVE, 3.5e-3},
    {"asin_fast", -1, 1, ABSOLUTE, 1.2e-3},     {"acos_fast", -1, 1, ABSOLUTE, 1.2e-3},
    {"atan_fast", -10, 10, ABSOLUTE, 8.5e-3},   {"atan_fast", -1e6, 1e6, ABSOLUTE, 8.5e-3},
    {"exp_fast", -87, 88, RELATIVE, 6.3e-4},    {"exp2_fast", -126, 127.99, RELATIVE, 6.2e-4},
    {"log_fast", 1e-3, 100, ABSOLUTE, 3.7e-3},  {"log_fast", 0.0, 3e38, ABSOLUTE, 3.7e-3},
    {"log2_fast", 1e-3, 100, ABSOLUTE, 5.3e-3}, {"log2_fast", 0.0, 3e38, ABSOLUTE, 5.3e-3},
};

static const struct vector_kernels *kernels;

static void errors_are_as_promised(void **state) {
    static float x[SAMPLE_BLOCK], result[SAMPLE_BLOCK];
    for (size_t p = 0; p < sizeof promises / sizeof *promises; p++) {
        const struct promise *promise = &promises[p];
        const struct vector_reference *reference = vector_reference_find(promise->name);
        double worst = 0.0;
        for (uint32_t block = 0; block < 256; block++) {
            sample_uniform(x, p, block, promise->low, promise->high);
            vector_kernels_find(kernels, promise->name)
                ->apply((const float *[]){x}, (float *[]){result}, SAMPLE_BLOCK);
            for (int i = 0; i < SAMPLE_BLOCK; i++) {
                if (x[i] == 0.0f)
                    continue;
                double truth = reference->f1(x[i]), error = fabs(result[i] - truth);
                if (promise->kind == RELATIVE)
                    error /= fabs(truth);
                worst = error > worst ? error : worst;
            }
        }
        print_message("%-10s on [%g, %g]: %s error %.3g of %.3g\n", promise->name, promise->low,
                      promise->high, promise->kind == RELATIVE ? "relative" : "absolute", worst,
                      promise->bound);
        assert_true(worst <= promise->bound);
    }
}

static void pairs_are_as_promised(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], result[SAMPLE_BLOCK];
    double worst_angle = 0.0, worst_power = 0.0;
    for (uint32_t block = 0; block < 256; block++) {
        sample_uniform(x, 30, block, -10, 10);
        sample_uniform(y, 31, block, -10, 10);
        vector_kernels_find(kernels, "atan2_fast")
            ->apply((const float *[]){y, x}, (float *[]){result}, SAMPLE_BLOCK);
        for (int i = 0; i < SAMPLE_BLOCK; i++)
            worst_angle = fmax(worst_angle, fabs(result[i] - atan2(y[i], x[i])));
        sample_uniform(x, 32, block, 0.01, 10);
        sample_uniform(y, 33, block, -8, 8);
        vector_kernels_find(kernels, "pow_fast")
            ->apply((const float *[]){x, y}, (float *[]){result}, SAMPLE_BLOCK);
        for (int i = 0; i < SAMPLE_BLOCK; i++) {
            /* the exponent's error is |y| times that of log2_fast */
            double relative = fabs(result[i] / pow(x[i], y[i]) - 1.0);
            worst_power = fmax(worst_power, (relative - 6.2e-4) / (fabs(y[i]) + 1e-3));
        }
    }
    print_message("atan2_fast: absolute error %.3g; pow_fast: relative error 6.2e-4 + %.3g |y|\n",
                  worst_angle, worst_power);
    assert_true(worst_angle <= 8.5e-3);
    assert_true(worst_power <= 3.8e-3);
}

/* The slope to the left of a junction equals that to the right. */
static void ranges_meet_smoothly(void **state) {
    static const struct {
        const char *name;
        double at, scale;
    } junctions[] = {
        {"sin_fast", 1.5707963, 1},  {"sin_fast", 4.712389, 1},   {"sin_fast", -1.5707963, 1},
        {"cos_fast", 3.1415927, 1},  {"cos_fast", 6.2831853, 1},  {"cos_fast", 0.0, 1},
        {"tan_fast", 0.78539816, 4}, {"tan_fast", 2.35619449, 4}, {"atan_fast", 1.0, 1},
        {"atan_fast", -1.0, 1},      {"atan_fast", 0.0, 1},       {"exp2_fast", 0.0, 1},
        {"exp2_fast", 1.0, 2},       {"exp2_fast", -1.0, 1},      {"exp_fast", 0.69314718, 2},
        {"log2_fast", 1.0, 2},       {"log2_fast", 2.0, 1},       {"log2_fast", 0.5, 4},
        {"log_fast", 4.0, 1},        {"asin_fast", 0.0, 1},       {"acos_fast", 0.0, 1}};
    const double h = 0x1p-9;
    for (size_t j = 0; j < sizeof junctions / sizeof *junctions; j++) {
        float x[3], f[3];
        for (int i = 0; i < 3; i++)
            x[i] = (float)(junctions[j].at + (i - 1) * h);
        vector_kernels_find(kernels, junctions[j].name)
            ->apply((const float *[]){x}, (float *[]){f}, 3);
        double jump = ((double)f[2] - 2.0 * f[1] + f[0]) / h;
        if (!(fabs(jump) <= 0.006 * junctions[j].scale))
            fail_msg("%s at %g: the slope jumps by %g", junctions[j].name, junctions[j].at, jump);
    }
}

/* Ten thousand runs of 512 neighbouring floats, all over the line and around every place where
 * ranges meet: no step goes the wrong way. */
static void functions_that_should_be_monotone_are(void **state) {
    static const char *const names[] = {"asin_fast", "acos_fast", "atan_fast", "exp_fast",
                                        "exp2_fast", "log_fast",  "log2_fast"};
    static const float junctions[] = {0.5f, 1.0f, 2.0f, 3.0f, 4.0f, 0.69314718f, -1.0f, 0x1p-20f};
    enum { RUN = 512, JUNCTIONS = sizeof junctions / sizeof *junctions };
    static float x[RUN], result[RUN];
    for (size_t f = 0; f < sizeof names / sizeof *names; f++) {
        const struct vector_function *function = vector_kernels_find(kernels, names[f]);
        const int direction = vector_reference_find(names[f])->monotone;
        for (uint32_t start = 0; start < 10000 + JUNCTIONS; start++) {
            const uint32_t first = start < JUNCTIONS ? sample_bits(junctions[start]) - RUN / 2
                                                     : (start - JUNCTIONS) * 429496u;
            for (uint32_t i = 0; i < RUN; i++)
                x[i] = sample_float(first + i);
            function->apply((const float *[]){x}, (float *[]){result}, RUN);
            for (int i = 1; i < RUN; i++) {
                const double change = ((double)result[i] - result[i - 1]) * direction;
                if (x[i] > x[i - 1] ? change < 0 : x[i] < x[i - 1] && change > 0)
                    fail_msg("%s goes the wrong way from %a to %a", names[f], x[i - 1], x[i]);
            }
        }
    }
}

static void every_input_gives_something_sane(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], r[SAMPLE_BLOCK];
    for (uint32_t block = 0; block < 512; block++) {
        sample_stratified(x, block, 512);
        if (block == 0)
            sample_special(x);
        sample_patterns(y, 40, block);
        for (int f = 0; f < kernels->function_count; f++) {
            const struct vector_function *function = &kernels->functions[f];
            if (strstr(function->name, "_fast") == NULL)
                continue;
            function->apply((const float *[]){x, y}, (float *[]){r}, SAMPLE_BLOCK);
            int is_power = strcmp(function->name, "pow_fast") == 0;
            int is_wave =
                strcmp(function->name, "sin_fast") == 0 || strcmp(function->name, "cos_fast") == 0;
            int is_log = strncmp(function->name, "log", 3) == 0;
            int is_arc =
                strncmp(function->name, "as", 2) == 0 || strncmp(function->name, "ac", 2) == 0;
            for (int i = 0; i < SAMPLE_BLOCK; i++) {
                int finite = isfinite(x[i]) && (function->inputs == 1 || isfinite(y[i]));
                if (!finite || (is_arc && fabsf(x[i]) > 1.0f) || (is_log && x[i] < 0.0f))
                    continue;
                int sane = !isnan(r[i]);
                if (is_power || strncmp(function->name, "exp", 3) == 0)
                    sane = isfinite(r[i]);
                else if (is_wave)
                    sane = fabsf(r[i]) <= 1.0f;
                else if (is_log)
                    sane = isfinite(r[i]) || x[i] == 0.0f;
                if (!sane)
                    fail_msg("%s(%a, %a) = %a", function->name, x[i], y[i], r[i]);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_as_promised),
        cmocka_unit_test(pairs_are_as_promised),
        cmocka_unit_test(ranges_meet_smoothly),
        cmocka_unit_test(functions_that_should_be_monotone_are),
        cmocka_unit_test(every_input_gives_something_sane),
    };
    kernels = vector_kernels_best();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
