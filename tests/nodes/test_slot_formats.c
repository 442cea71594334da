/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/rng.h"
#include "nodes/slot_formats.h"

#include <float.h>
#include <math.h>

static double value_of(struct slot_format format, int raw) {
    return ldexp(raw, -format.exponent);
}

static void raw_range(struct slot_format format, int *least, int *most) {
    *least = format.is_unsigned ? 0 : -(1 << (format.bits - 1));
    *most = format.is_unsigned ? (1 << format.bits) - 1 : (1 << (format.bits - 1)) - 1;
}

/* By looking at every number of the format; of two as near the one with an even raw integer. */
static double nearest(struct slot_format format, float value) {
    int least, most;
    raw_range(format, &least, &most);
    int best = least;
    for (int raw = least; raw <= most; raw++) {
        const double here = fabs(value_of(format, raw) - value),
                     there = fabs(value_of(format, best) - value);
        if (here < there || (here == there && raw % 2 == 0))
            best = raw;
    }
    return value_of(format, best);
}

static void values_become_the_nearest_of_their_format(void **state) {
    struct rng rng = {5};
    for (int i = 0; i < 3000; i++) {
        const struct slot_format format = {.rounding = SLOT_FIXED,
                                           .bits = i % 50 ? 8 : 16,
                                           .is_unsigned = (uint8_t)rng_below(&rng, 2),
                                           .exponent = (int8_t)((int)rng_below(&rng, 40) - 20)};
        const double range = ldexp(1, format.bits - format.exponent);
        float value = (float)((rng_unit(&rng) * 2.5 - 1.25) * range);
        if (i % 3 == 0) /* half way between two */
            value = (float)(floor(value * ldexp(1, format.exponent)) + 0.5) *
                    (float)ldexp(1, -format.exponent);
        float rounded = value;
        slot_format_round(format, &rounded, 1);
        assert_true(rounded == (float)nearest(format, value));
    }
}

static void formats_hold_the_values_they_are_for(void **state) {
    struct rng rng = {6};
    for (int i = 0; i < 20000; i++) {
        const int bits = i % 2 ? 8 : 16;
        float low = (float)ldexp(rng_unit(&rng) - 0.5, (int)rng_below(&rng, 60) - 30),
              high = low + (float)ldexp(rng_unit(&rng), (int)rng_below(&rng, 60) - 30);
        if (i % 5 == 0) { /* the usual ends */
            high = (float)ldexp(1, (int)rng_below(&rng, 20) - 10);
            low = i % 10 ? 0 : -high;
        }
        const struct slot_format format = slot_format_for(bits, low, high);
        int least, most;
        raw_range(format, &least, &most);
        assert_int_equal(format.is_unsigned, low >= 0);
        const double step = value_of(format, 1);
        assert_true(low >= value_of(format, least) - step && high <= value_of(format, most) + step);
        /* one bit more after the point would not */
        struct slot_format finer = format;
        finer.exponent++;
        const double end = low < 0 ? fmax(high, -low) : high, limit = value_of(finer, most);
        assert_true(end > limit + value_of(finer, 1));
    }
}

static void extremes_have_a_format(void **state) {
    static const float ends[] = {0, FLT_MIN, FLT_TRUE_MIN, 1, 65504, FLT_MAX};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        for (int sign = 0; sign < 2; sign++) {
            const struct slot_format format = slot_format_for(16, sign ? -ends[i] : 0, ends[i]);
            float values[] = {ends[i], -ends[i], INFINITY, -INFINITY, NAN, 0, -0.0f};
            slot_format_round(format, values, 7);
            for (int k = 0; k < 7; k++)
                assert_true(isfinite(values[k]));
            assert_true(values[4] == 0 && values[5] == 0 && values[6] == 0);
            /* what is below the 127th bit after the point is nothing */
            const double error = fabs((double)values[0] - (double)ends[i]);
            assert_true(error <= fmax(ends[i] * 0x1p-15, 0x1p-128));
            assert_true(values[2] >= values[0] && values[3] <= values[1]);
        }
}

static void other_slots_stay_or_become_halves(void **state) {
    float values[] = {0.1f, 70000, -1e-9f};
    slot_format_round((struct slot_format){.rounding = SLOT_FLOAT}, values, 3);
    assert_true(values[0] == 0.1f && values[1] == 70000 && values[2] == -1e-9f);
    slot_format_round((struct slot_format){.rounding = SLOT_HALF}, values, 3);
    assert_true(values[0] == 0x1.998p-4f && values[1] == 65504 && values[2] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_become_the_nearest_of_their_format),
        cmocka_unit_test(formats_hold_the_values_they_are_for),
        cmocka_unit_test(extremes_have_a_format),
        cmocka_unit_test(other_slots_stay_or_become_halves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
