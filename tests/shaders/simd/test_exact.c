/* SPDX-License-Identifier: Apache-2.0 */
/* The exact functions are within 0.501 ulp of the true value for 2^24 inputs spread over all floats
 * (pow, atan2 and mod: pairs), on the widest instruction set here; the others have the same bits
 * (test_same_bits.c). */

#include "samples.h"

#include <math.h>
#include <stdlib.h>

#define BOUND 0.501
#define BLOCKS 4096 /* 2^24 inputs */

static const struct vector_kernels *kernels;

static void check(const char *name, const float *x, const float *y, const float *result,
                  int count) {
    const struct vector_reference *reference = vector_reference_find(name);
    for (int i = 0; i < count; i++) {
        double truth = y ? reference->f2(x[i], y[i]) : reference->f1(x[i]);
        double error = vector_ulp_error(result[i], truth);
        if (!(error <= BOUND))
            fail_msg("%s(%a, %a) = %a, not %a: %g ulp", name, x[i], y ? y[i] : 0.0, result[i],
                     truth, error);
    }
}

static void run(const char *name, const float *x, const float *y, int count) {
    static float result[SAMPLE_BLOCK];
    const float *in[2] = {x, y};
    float *out[1] = {result};
    vector_kernels_find(kernels, name)->apply(in, out, (size_t)count);
    check(name, x, y, result, count);
}

static void unary_functions_are_within_the_bound(void **state) {
    static float x[SAMPLE_BLOCK], special[SAMPLE_BLOCK];
    int special_count = sample_special(special);
    for (int f = 0; f < vector_reference_count; f++) {
        const struct vector_reference *reference = &vector_references[f];
        if (reference->inputs != 1)
            continue;
        run(reference->name, special, NULL, special_count);
        for (uint32_t block = 0; block < BLOCKS; block++) {
            sample_stratified(x, block, BLOCKS);
            run(reference->name, x, NULL, SAMPLE_BLOCK);
        }
    }
}

static void power_and_arctangent_of_pairs_are_within_the_bound(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK];
    for (uint32_t block = 0; block < 512; block++) {
        sample_patterns(x, 1, block);
        sample_patterns(y, 2, block);
        run("atan2", x, y, SAMPLE_BLOCK);
        run("pow", x, y, SAMPLE_BLOCK);
        sample_uniform(x, 3, block, 0.0, 10.0);
        sample_uniform(y, 4, block, -38.0, 38.0);
        run("atan2", x, y, SAMPLE_BLOCK);
        run("pow", x, y, SAMPLE_BLOCK);
        sample_uniform(x, 5, block, 0.999, 1.001);
        sample_uniform(y, 6, block, -150000.0, 150000.0);
        run("pow", x, y, SAMPLE_BLOCK);
        sample_uniform(x, 7, block, -20.0, 20.0);
        for (int i = 0; i < SAMPLE_BLOCK; i++)
            y[i] = (float)((i & 63) - 32); /* negative bases with integer powers */
        run("pow", x, y, SAMPLE_BLOCK);
    }
}

static void special_pairs_are_within_the_bound(void **state) {
    static float special[SAMPLE_BLOCK], y[SAMPLE_BLOCK];
    int count = sample_special(special);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++)
            y[k] = special[i];
        run("atan2", special, y, count);
        run("pow", special, y, count);
    }
}

static void remainders_are_exact_for_quotients_below_2_to_29(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK];
    for (uint32_t block = 0; block < 256; block++) {
        sample_uniform(x, 8, block, -1000.0, 1000.0);
        sample_uniform(y, 9, block, -10.0, 10.0);
        run("mod", x, y, SAMPLE_BLOCK);
        sample_patterns(x, 10, block);
        sample_patterns(y, 11, block);
        for (int i = 0; i < SAMPLE_BLOCK; i++)
            if (fabs((double)x[i] / y[i]) >= 0x1p29)
                y[i] = x[i] * 0.3f;
        run("mod", x, y, SAMPLE_BLOCK);
    }
}

static void remainders_stay_in_range_for_all_pairs(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], result[SAMPLE_BLOCK];
    const struct vector_function *mod = vector_kernels_find(kernels, "mod");
    for (uint32_t block = 0; block < 256; block++) {
        sample_patterns(x, 12, block);
        sample_patterns(y, 13, block);
        const float *in[2] = {x, y};
        float *out[1] = {result};
        mod->apply(in, out, SAMPLE_BLOCK);
        for (int i = 0; i < SAMPLE_BLOCK; i++) {
            if (!isfinite(x[i]) || !isfinite(y[i]))
                assert_true(isnan(result[i]));
            else
                assert_true(fabsf(result[i]) <= fabsf(y[i]) && (double)result[i] * y[i] >= 0.0);
        }
    }
}

/* Ten thousand runs of 512 neighbouring floats, all over the line. */
static void functions_that_should_be_monotone_are(void **state) {
    static float x[512], result[512];
    for (int f = 0; f < vector_reference_count; f++) {
        const struct vector_reference *reference = &vector_references[f];
        if (!reference->monotone)
            continue;
        const struct vector_function *function = vector_kernels_find(kernels, reference->name);
        for (uint32_t start = 0; start < 10000; start++) {
            for (uint32_t i = 0; i < 512; i++)
                x[i] = sample_float(start * 429496u + i);
            const float *in[1] = {x};
            float *out[1] = {result};
            function->apply(in, out, 512);
            for (int i = 1; i < 512; i++) {
                if (isnan(result[i]) || isnan(result[i - 1]))
                    continue;
                float change = (result[i] - result[i - 1]) * (float)reference->monotone;
                if (x[i] < x[i - 1])
                    change = -change;
                if (change < 0.0f)
                    fail_msg("%s falls from %a to %a", reference->name, x[i - 1], x[i]);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unary_functions_are_within_the_bound),
        cmocka_unit_test(power_and_arctangent_of_pairs_are_within_the_bound),
        cmocka_unit_test(special_pairs_are_within_the_bound),
        cmocka_unit_test(remainders_are_exact_for_quotients_below_2_to_29),
        cmocka_unit_test(remainders_stay_in_range_for_all_pairs),
        cmocka_unit_test(functions_that_should_be_monotone_are),
    };
    kernels = vector_kernels_best();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
