/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/half.h"

#include <math.h>
#include <string.h>

static float float_of(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Straight from the definition of the format, in double. */
static double half_value(uint16_t half) {
    int exponent = half >> 10 & 31, mantissa = half & 0x3ff;
    double value = exponent ? ldexp(1024 + mantissa, exponent - 25) : ldexp(mantissa, -24);
    return half & 0x8000 ? -value : value;
}

/* The nearest finite half of a finite float by search; ties go to the even one. */
static uint16_t nearest_half(float value) {
    double magnitude = fabs((double)value);
    uint16_t low = 0, high = 0x7bff, sign = signbit(value) ? 0x8000 : 0;
    if (magnitude >= 65504)
        return sign | high;
    while (high - low > 1) {
        uint16_t middle = (uint16_t)((low + high) / 2);
        *(half_value(middle) <= magnitude ? &low : &high) = middle;
    }
    double below = magnitude - half_value(low), above = half_value(high) - magnitude;
    return sign | (below < above || (below == above && !(low & 1)) ? low : high);
}

static void all_halfs_have_their_value_and_come_back(void **state) {
    for (uint32_t half = 0; half < 65536; half++) {
        uint64_t clamped = 0;
        float value = half_to_float((uint16_t)half);
        if ((half & 0x7c00) == 0x7c00)
            assert_true(half & 0x3ff ? isnan(value) : isinf(value));
        else
            assert_true(value == half_value((uint16_t)half));
        assert_int_equal(signbit(value) != 0, half >> 15);
        assert_int_equal(half_from_float(value, &clamped), half);
        assert_int_equal(clamped, 0);
    }
}

static void floats_around_every_midpoint_round_to_the_nearest_even(void **state) {
    uint64_t clamped = 0;
    for (uint32_t half = 0; half < 0x7bff; half++) {
        float middle = (float)((half_value((uint16_t)half) + half_value((uint16_t)(half + 1))) /
                               2); /* exact */
        const float tries[3] = {nextafterf(middle, 0), middle, nextafterf(middle, INFINITY)};
        for (int i = 0; i < 3; i++) {
            assert_int_equal(half_from_float(tries[i], &clamped), nearest_half(tries[i]));
            assert_int_equal(half_from_float(-tries[i], &clamped), nearest_half(-tries[i]));
        }
    }
    assert_int_equal(clamped, 0);
}

static void floats_beyond_the_largest_half_are_clamped_and_counted(void **state) {
    uint64_t clamped = 0;
    assert_int_equal(half_from_float(65504, &clamped), 0x7bff);
    assert_int_equal(clamped, 0);
    assert_int_equal(half_from_float(nextafterf(65504, 1e9f), &clamped), 0x7bff);
    assert_int_equal(half_from_float(-1e30f, &clamped), 0xfbff);
    assert_int_equal(half_from_float(3.4028235e38f, &clamped), 0x7bff);
    assert_int_equal(clamped, 3);
    assert_int_equal(half_from_float(INFINITY, &clamped), 0x7c00);
    assert_int_equal(half_from_float(-INFINITY, &clamped), 0xfc00);
    assert_int_equal(clamped, 3);
}

static void a_nan_stays_a_nan_whatever_its_payload(void **state) {
    uint64_t clamped = 0;
    for (int bit = 0; bit < 23; bit++) {
        uint16_t half = half_from_float(float_of(0x7f800000u | 1u << bit), &clamped);
        assert_int_equal(half & 0x7c00, 0x7c00);
        assert_int_not_equal(half & 0x3ff, 0);
    }
    assert_int_equal(clamped, 0);
}

static void a_stratified_sample_of_floats_agrees_with_a_search(void **state) {
    uint64_t clamped = 0;
    for (uint64_t bits = 0; bits < 0x100000000u; bits += 4099) {
        float value = float_of((uint32_t)bits);
        if (isfinite(value) && half_from_float(value, &clamped) != nearest_half(value))
            fail_msg("%a: %x, not %x", value, half_from_float(value, &clamped),
                     nearest_half(value));
    }
}

#ifdef __x86_64__
#include <immintrin.h>

__attribute__((target("f16c"))) static uint64_t count_differences_from_hardware(void) {
    uint64_t wrong = 0, clamped = 0;
    for (uint64_t bits = 0; bits < 0x100000000u; bits += 97) {
        float value = float_of((uint32_t)bits);
        uint16_t hardware = (uint16_t)_mm_cvtsi128_si32(
            _mm_cvtps_ph(_mm_set_ss(value), _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
        if (isfinite(value) && fabsf(value) <= 65504)
            wrong += half_from_float(value, &clamped) != hardware;
    }
    for (uint32_t half = 0; half < 65536; half++) {
        float hardware = _mm_cvtss_f32(_mm_cvtph_ps(_mm_cvtsi32_si128((int)half)));
        float ours = half_to_float((uint16_t)half);
        wrong += isnan(hardware) ? !isnan(ours) : memcmp(&hardware, &ours, sizeof ours) != 0;
    }
    return wrong + clamped;
}

static void forty_million_floats_agree_with_the_hardware(void **state) {
    if (!__builtin_cpu_supports("avx2"))
        skip();
    assert_int_equal(count_differences_from_hardware(), 0);
}
#else
static void forty_million_floats_agree_with_the_hardware(void **state) {
    skip();
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_halfs_have_their_value_and_come_back),
        cmocka_unit_test(floats_around_every_midpoint_round_to_the_nearest_even),
        cmocka_unit_test(floats_beyond_the_largest_half_are_clamped_and_counted),
        cmocka_unit_test(a_nan_stays_a_nan_whatever_its_payload),
        cmocka_unit_test(a_stratified_sample_of_floats_agrees_with_a_search),
        cmocka_unit_test(forty_million_floats_agree_with_the_hardware),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
