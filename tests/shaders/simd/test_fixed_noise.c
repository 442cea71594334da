/* SPDX-License-Identifier: Apache-2.0 */
/* Noise in 16-bit fixed point is within 2^-12 of Perlin's in double precision. Built for every
 * width; the widths give the same bits. */

#include "samples.h"

#include "base/hash.h"
#include "base/rng.h"
#include "shaders/simd/vector_math.h"

#include <math.h>
#include <string.h>

static void noise_is_within_2_to_the_minus_12(void **state) {
    struct rng rng = {2};
    double worst = 0;
    for (int exponent = 0; exponent <= 14; exponent++)
        for (int i = 0; i < 20000; i++) {
            int32_t at[3];
            for (int d = 0; d < 3; d++)
                at[d] = (int32_t)rng_below(&rng, (uint64_t)512 << exponent) - (256 << exponent);
            const double scale = ldexp(1.0, -exponent);
            const double truth =
                vector_reference_noise(at[0] * scale, at[1] * scale, at[2] * scale);
            const vi x = vi_set(at[0]), y = vi_set(at[1]), z = vi_set(at[2]);
            const double n = vi_fixed_snoise3(x, y, z, exponent)[0] * 0x1p-14;
            const double value = vi_fixed_noise3(x, y, z, exponent)[0] * 0x1p-14;
            worst = fmax(worst, fabs(n - truth));
            worst = fmax(worst, fabs(value - fmin(fmax(0.5 + 0.5 * truth, 0), 1)));
        }
    print_message("largest difference %.3g of %.3g\n", worst, 0x1p-12);
    assert_true(worst <= 0x1p-12);
}

static void noise_has_the_period_and_takes_any_number(void **state) {
    struct rng rng = {3};
    for (int i = 0; i < 20000; i++) {
        const int exponent = (int)rng_below(&rng, 31);
        int32_t near[3][SHADER_WIDTH], far[3][SHADER_WIDTH];
        vi at[3], moved[3];
        for (int d = 0; d < 3; d++) {
            for (int lane = 0; lane < SHADER_WIDTH; lane++) {
                near[d][lane] = (int32_t)rng_next(&rng);
                far[d][lane] = exponent > 23
                                   ? near[d][lane]
                                   : (int32_t)((uint32_t)near[d][lane] + (256u << exponent));
            }
            memcpy(&at[d], near[d], sizeof at[d]);
            memcpy(&moved[d], far[d], sizeof moved[d]);
        }
        const vi a = vi_fixed_noise3(at[0], at[1], at[2], exponent);
        const vi b = vi_fixed_noise3(moved[0], moved[1], moved[2], exponent);
        for (int lane = 0; lane < SHADER_WIDTH; lane++)
            assert_true(a[lane] == b[lane] && a[lane] >= 0 && a[lane] <= 1 << 14);
    }
}

/* One hash for every width and instruction set. */
static void every_width_gives_the_recorded_bits(void **state) {
    struct rng rng = {4};
    uint64_t hash = 0;
    for (int i = 0; i < 4096; i++) {
        int32_t in[3][16], out[2][16];
        for (int d = 0; d < 3; d++)
            for (int lane = 0; lane < 16; lane++)
                in[d][lane] = (int32_t)rng_next(&rng);
        for (int lane = 0; lane < 16; lane += SHADER_WIDTH) {
            vi x, y, z;
            memcpy(&x, in[0] + lane, sizeof x);
            memcpy(&y, in[1] + lane, sizeof y);
            memcpy(&z, in[2] + lane, sizeof z);
            const vi n = vi_fixed_snoise3(x, y, z, i % 31), plane = vi_fixed_noise2(x, y, i % 31);
            memcpy(out[0] + lane, &n, sizeof n);
            memcpy(out[1] + lane, &plane, sizeof plane);
        }
        hash = hash_bytes(out, sizeof out, hash);
    }
    if (hash != 0xf1f157f61f5ff08au)
        fail_msg("hash 0x%016lx", (unsigned long)hash);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_within_2_to_the_minus_12),
        cmocka_unit_test(noise_has_the_period_and_takes_any_number),
        cmocka_unit_test(every_width_gives_the_recorded_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
