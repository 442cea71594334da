/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/simd/vector_math.h"

#include "shaders/simd/vector_fixed.h"

#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

/* The vector forms of fixed-point functions give in every lane what the scalar forms give, which
 * tests/shaders/compiler/test_fixed.c holds to exact arithmetic. */

enum { ROUNDS = 200000 };

static int64_t draw(struct rng *rng, int size, int is_unsigned) {
    const uint64_t kind = rng_below(rng, 6);
    const uint64_t bits = kind == 0   ? 0
                          : kind == 1 ? (uint64_t)1 << (size - 1)
                                      : rng_next(rng);
    return sx_wrap((int64_t)bits, size, is_unsigned);
}

struct drawn {
    vx x, y;
    int size_x, size_y, unsigned_x, unsigned_y, exponent_x, exponent_y;
};

static struct drawn draw_all(struct rng *rng, int size_max) {
    struct drawn d;
    d.size_x = 1 + (int)rng_below(rng, (uint64_t)size_max);
    d.size_y = 1 + (int)rng_below(rng, (uint64_t)size_max);
    d.unsigned_x = rng_below(rng, 2) != 0;
    d.unsigned_y = rng_below(rng, 2) != 0;
    d.exponent_x = (int)rng_below(rng, 100) - 30;
    d.exponent_y = (int)rng_below(rng, 100) - 30;
    for (int i = 0; i < SHADER_WIDTH; i++) {
        d.x[i] = draw(rng, d.size_x, d.unsigned_x);
        d.y[i] = draw(rng, d.size_y, d.unsigned_y);
    }
    return d;
}

static void quotients_and_remainders_have_the_bits_of_scalars(void **state) {
    (void)state;
    struct rng rng = {3};
    for (int r = 0; r < ROUNDS; r++) {
        const struct drawn d = draw_all(&rng, r & 1 ? 40 : 64);
        const int places = (int)rng_below(&rng, (uint64_t)(65 - d.size_x)) - (r % 5 == 0 ? 20 : 0);
        const int more = places > 0 ? places : 0;
        const int bits = d.size_x + more > d.size_y ? d.size_x + more : d.size_y;
        const vx quotient = vx_divide(d.x, d.unsigned_x, d.y, d.unsigned_y, places, bits);
        const vx rest = vx_remainder(d.x, d.unsigned_x, places, d.y, d.unsigned_y, 0, bits);
        for (int i = 0; i < SHADER_WIDTH; i++) {
            assert_int_equal(quotient[i],
                             sx_divide(d.x[i], d.unsigned_x, d.y[i], d.unsigned_y, places));
            assert_int_equal(rest[i], sx_remainder(d.x[i], d.unsigned_x, places, d.y[i],
                                                   d.unsigned_y, 0));
        }
    }
}

static void roots_have_the_bits_of_scalars(void **state) {
    (void)state;
    struct rng rng = {5};
    for (int r = 0; r < ROUNDS / 4; r++) {
        const struct drawn d = draw_all(&rng, 64);
        const int places = (int)rng_below(&rng, 64);
        const vx root = vx_sqrt(d.x, d.unsigned_x, places, d.size_x + places);
        for (int i = 0; i < SHADER_WIDTH; i++)
            assert_int_equal(root[i], sx_sqrt(d.x[i], d.unsigned_x, places));
    }
}

static void comparisons_have_the_truth_of_scalars(void **state) {
    (void)state;
    struct rng rng = {7};
    for (int r = 0; r < ROUNDS; r++) {
        const struct drawn d = draw_all(&rng, 64);
        const vx less = vx_less(d.x, d.exponent_x, d.unsigned_x, d.y, d.exponent_y, d.unsigned_y),
                 equal = vx_equal(d.x, d.exponent_x, d.unsigned_x, d.y, d.exponent_y, d.unsigned_y);
        for (int i = 0; i < SHADER_WIDTH; i++) {
            assert_int_equal(less[i] != 0, sx_less(d.x[i], d.exponent_x, d.unsigned_x, d.y[i],
                                                   d.exponent_y, d.unsigned_y));
            assert_int_equal(equal[i] != 0, sx_equal(d.x[i], d.exponent_x, d.unsigned_x, d.y[i],
                                                     d.exponent_y, d.unsigned_y));
        }
    }
}

static void floats_have_the_bits_of_scalars(void **state) {
    (void)state;
    struct rng rng = {9};
    for (int r = 0; r < ROUNDS; r++) {
        const struct drawn d = draw_all(&rng, 64);
        vf numbers;
        for (int i = 0; i < SHADER_WIDTH; i++) {
            uint32_t bits = (uint32_t)rng_next(&rng);
            if (i & 1)
                bits = (bits & 0x807fffffu) |
                       (uint32_t)((127 + d.size_x - d.exponent_x - (int)rng_below(&rng, 66)) & 255)
                           << 23;
            float number;
            memcpy(&number, &bits, sizeof number);
            numbers[i] = number;
        }
        const vx raw = vx_from_float(numbers, d.exponent_x, d.size_x, d.unsigned_x);
        const vf back = vx_to_float(d.x, d.exponent_x, d.size_x, d.unsigned_x);
        for (int i = 0; i < SHADER_WIDTH; i++) {
            const float one = sx_to_float(d.x[i], d.exponent_x, d.size_x, d.unsigned_x);
            const float lane = back[i];
            assert_int_equal(raw[i],
                             sx_from_float(numbers[i], d.exponent_x, d.size_x, d.unsigned_x));
            assert_memory_equal(&lane, &one, sizeof one);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quotients_and_remainders_have_the_bits_of_scalars),
        cmocka_unit_test(roots_have_the_bits_of_scalars),
        cmocka_unit_test(comparisons_have_the_truth_of_scalars),
        cmocka_unit_test(floats_have_the_bits_of_scalars),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
