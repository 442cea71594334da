/* SPDX-License-Identifier: Apache-2.0 */
/* Noise is Perlin's of 2002: his published values, the same function in double precision, the
 * period. */

#include "samples.h"

#include <math.h>
#include <stdlib.h>

static const struct vector_kernels *kernels;

static void apply(const char *name, const float *x, const float *y, const float *z,
                  float *const *out, int count) {
    const float *in[3] = {x, y, z};
    vector_kernels_find(kernels, name)->apply(in, out, (size_t)count);
}

static void published_values_are_met(void **state) {
    const float x[2] = {3.14f, -4.2f}, y[2] = {42.0f, 10.0f}, z[2] = {7.0f, 6.0f};
    const double published[2] = {0.13691995878400012, 0.14208000000000043};
    float n[2];
    apply("snoise3", x, y, z, (float *[]){n}, 2);
    for (int i = 0; i < 2; i++)
        assert_true(fabs(n[i] - published[i]) < 1e-6);
    assert_true(fabs(vector_reference_noise(3.14, 42, 7) - published[0]) < 1e-15);
    assert_true(fabs(vector_reference_noise(-4.2, 10, 6) - published[1]) < 1e-15);
}

static double to_unit(double n) {
    double value = 0.5 + 0.5 * n;
    return value < 0.0 ? 0.0 : value > 1.0 ? 1.0 : value;
}

static void all_forms_are_within_a_millionth_of_double_precision(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], z[SAMPLE_BLOCK], out[3][SAMPLE_BLOCK];
    double worst = 0.0;
    for (uint32_t block = 0; block < 128; block++) {
        double range = block < 64 ? 10.0 : 1e4;
        sample_uniform(x, 1, block, -range, range);
        sample_uniform(y, 2, block, -range, range);
        sample_uniform(z, 3, block, -range, range);
        for (int form = 0; form < 10; form++) {
            static const char *const names[] = {"snoise3",  "noise3",   "noise2",   "noise1",
                                                "noise3_3", "noise3_3", "noise2_3", "noise2_3",
                                                "noise1_3", "noise1_3"};
            int component = form < 4 ? 0 : form & 1 ? 2 : 1;
            int dimensions = names[form][names[form][0] == 's' ? 6 : 5] - '0';
            apply(names[form], x, y, z, (float *[]){out[0], out[1], out[2]}, SAMPLE_BLOCK);
            for (int i = 0; i < SAMPLE_BLOCK; i++) {
                /* component c: 85 c further along each axis */
                double offset = 85.0 * component;
                double n = vector_reference_noise((double)x[i] + offset,
                                                  (dimensions > 1 ? (double)y[i] : 0.0) + offset,
                                                  (dimensions > 2 ? (double)z[i] : 0.0) + offset);
                double error = fabs(out[component][i] - (form == 0 ? n : to_unit(n)));
                worst = error > worst ? error : worst;
            }
        }
    }
    print_message("largest difference %.3g\n", worst);
    assert_true(worst < 1e-6);
}

static void first_component_of_vector_noise_is_scalar_noise(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], z[SAMPLE_BLOCK], out[3][SAMPLE_BLOCK],
        scalar[SAMPLE_BLOCK];
    static const char *const names[][2] = {
        {"noise1", "noise1_3"}, {"noise2", "noise2_3"}, {"noise3", "noise3_3"}};
    sample_uniform(x, 4, 0, -300.0, 300.0);
    sample_uniform(y, 5, 0, -300.0, 300.0);
    sample_uniform(z, 6, 0, -300.0, 300.0);
    for (int d = 0; d < 3; d++) {
        apply(names[d][0], x, y, z, (float *[]){scalar}, SAMPLE_BLOCK);
        apply(names[d][1], x, y, z, (float *[]){out[0], out[1], out[2]}, SAMPLE_BLOCK);
        assert_memory_equal(scalar, out[0], sizeof scalar);
    }
}

static void components_are_uncorrelated(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], z[SAMPLE_BLOCK], out[3][SAMPLE_BLOCK];
    double sum[3][3] = {{0}}, count = 64.0 * SAMPLE_BLOCK;
    for (uint32_t block = 0; block < 64; block++) {
        sample_uniform(x, 7, block, 0.0, 256.0);
        sample_uniform(y, 8, block, 0.0, 256.0);
        sample_uniform(z, 9, block, 0.0, 256.0);
        apply("noise3_3", x, y, z, (float *[]){out[0], out[1], out[2]}, SAMPLE_BLOCK);
        for (int i = 0; i < SAMPLE_BLOCK; i++)
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    sum[a][b] += (out[a][i] - 0.5) * (out[b][i] - 0.5) / count;
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < a; b++)
            assert_true(fabs(sum[a][b]) < 0.02 * sqrt(sum[a][a] * sum[b][b]));
}

/* Multiples of 2^-8 below 2^15 stay exact when 256 is added, so the noise must be the same to the
 * bit. */
static void the_period_is_256_exactly(void **state) {
    static float x[3][SAMPLE_BLOCK], moved[3][SAMPLE_BLOCK], a[SAMPLE_BLOCK], b[SAMPLE_BLOCK];
    for (uint32_t block = 0; block < 32; block++) {
        for (int axis = 0; axis < 3; axis++) {
            sample_uniform(x[axis], 10 + (uint64_t)axis, block, -16384.0, 16384.0);
            for (int i = 0; i < SAMPLE_BLOCK; i++) {
                x[axis][i] = rintf(x[axis][i] * 256.0f) / 256.0f;
                moved[axis][i] = x[axis][i] + (float)((i + axis) % 7 - 3) * 256.0f;
            }
        }
        apply("noise3", x[0], x[1], x[2], (float *[]){a}, SAMPLE_BLOCK);
        apply("noise3", moved[0], moved[1], moved[2], (float *[]){b}, SAMPLE_BLOCK);
        assert_memory_equal(a, b, sizeof a);
    }
}

static void any_input_gives_a_value_in_range_or_nan(void **state) {
    static float x[SAMPLE_BLOCK], y[SAMPLE_BLOCK], z[SAMPLE_BLOCK], n[SAMPLE_BLOCK],
        value[SAMPLE_BLOCK];
    for (uint32_t block = 0; block < 256; block++) {
        sample_patterns(x, 20, block);
        sample_patterns(y, 21, block);
        sample_patterns(z, 22, block);
        if (block == 0)
            sample_special(x);
        apply("snoise3", x, y, z, (float *[]){n}, SAMPLE_BLOCK);
        apply("noise3", x, y, z, (float *[]){value}, SAMPLE_BLOCK);
        for (int i = 0; i < SAMPLE_BLOCK; i++) {
            if (isfinite(x[i]) && isfinite(y[i]) && isfinite(z[i]))
                assert_true(fabsf(n[i]) <= 1.1f && value[i] >= 0.0f && value[i] <= 1.0f);
            else
                assert_true(isnan(n[i]) && isnan(value[i]));
        }
    }
    /* whole numbers are lattice points, however large */
    const float huge[3] = {0x1p31f, 1e30f, -0x1p24f};
    apply("snoise3", huge, huge, huge, (float *[]){n}, 3);
    for (int i = 0; i < 3; i++)
        assert_true(n[i] == 0.0f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(published_values_are_met),
        cmocka_unit_test(all_forms_are_within_a_millionth_of_double_precision),
        cmocka_unit_test(first_component_of_vector_noise_is_scalar_noise),
        cmocka_unit_test(components_are_uncorrelated),
        cmocka_unit_test(the_period_is_256_exactly),
        cmocka_unit_test(any_input_gives_a_value_in_range_or_nan),
    };
    kernels = vector_kernels_best();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
