/* SPDX-License-Identifier: Apache-2.0 */
/* The special values of C99 Annex F and of docs/accuracy.md, exactly, signs of zero included. */

#include "samples.h"

#include <math.h>
#include <string.h>

static const struct vector_kernels *kernels;

static float call2(const char *name, float x, float y) {
    const float *in[2] = {&x, &y};
    float result, *out[1] = {&result};
    vector_kernels_find(kernels, name)->apply(in, out, 1);
    return result;
}

static float call(const char *name, float x) {
    return call2(name, x, 0.0f);
}

static void expect(const char *name, float x, float y, float result, float expected) {
    if (isnan(expected) ? sample_bits(result) != 0x7fc00000
                        : sample_bits(result) != sample_bits(expected))
        fail_msg("%s(%a, %a) = %a, not %a", name, x, y, result, expected);
}

#define TINY 0x1p-149f
#define HUGE_FLOAT 0x1.fffffep127f
#define PI_FLOAT 0x1.921fb6p1f

static void one_argument(void **state) {
    static const struct {
        const char *name;
        float x, expected;
    } table[] = {
        {"sin", 0.0f, 0.0f},
        {"sin", -0.0f, -0.0f},
        {"sin", INFINITY, NAN},
        {"sin", -INFINITY, NAN},
        {"sin", TINY, TINY},
        {"sin", -TINY, -TINY},
        {"cos", 0.0f, 1.0f},
        {"cos", -0.0f, 1.0f},
        {"cos", INFINITY, NAN},
        {"cos", TINY, 1.0f},
        {"tan", 0.0f, 0.0f},
        {"tan", -0.0f, -0.0f},
        {"tan", INFINITY, NAN},
        {"tan", TINY, TINY},
        {"asin", 0.0f, 0.0f},
        {"asin", -0.0f, -0.0f},
        {"asin", 1.0f, PI_FLOAT / 2},
        {"asin", -1.0f, -PI_FLOAT / 2},
        {"asin", 0x1.000002p0f, NAN},
        {"asin", -INFINITY, NAN},
        {"asin", TINY, TINY},
        {"acos", 1.0f, 0.0f},
        {"acos", -1.0f, PI_FLOAT},
        {"acos", 0.0f, PI_FLOAT / 2},
        {"acos", 0x1.000002p0f, NAN},
        {"acos", INFINITY, NAN},
        {"atan", 0.0f, 0.0f},
        {"atan", -0.0f, -0.0f},
        {"atan", INFINITY, PI_FLOAT / 2},
        {"atan", -INFINITY, -PI_FLOAT / 2},
        {"atan", TINY, TINY},
        {"exp", 0.0f, 1.0f},
        {"exp", -0.0f, 1.0f},
        {"exp", INFINITY, INFINITY},
        {"exp", -INFINITY, 0.0f},
        {"exp", HUGE_FLOAT, INFINITY},
        {"exp", -HUGE_FLOAT, 0.0f},
        {"exp", TINY, 1.0f},
        {"exp", 0x1.62e42ep6f, 0x1.ffff08p127f},
        {"exp", 0x1.62e430p6f, INFINITY},
        {"exp2", 0.0f, 1.0f},
        {"exp2", 128.0f, INFINITY},
        {"exp2", -149.0f, TINY},
        {"exp2", -150.0f, 0.0f},
        {"exp2", -0x1.2bfffep7f, TINY},
        {"exp2", INFINITY, INFINITY},
        {"exp2", -INFINITY, 0.0f},
        {"log", 0.0f, -INFINITY},
        {"log", -0.0f, -INFINITY},
        {"log", -1.0f, NAN},
        {"log", -TINY, NAN},
        {"log", 1.0f, 0.0f},
        {"log", INFINITY, INFINITY},
        {"log", -INFINITY, NAN},
        {"log2", 0.0f, -INFINITY},
        {"log2", -0.0f, -INFINITY},
        {"log2", -TINY, NAN},
        {"log2", INFINITY, INFINITY},
        {"log2", -INFINITY, NAN},
        {"sqrt", -0.0f, -0.0f},
        {"sqrt", INFINITY, INFINITY},
        {"inversesqrt", 0.0f, INFINITY},
        {"inversesqrt", -0.0f, -INFINITY},
        {"inversesqrt", -1.0f, NAN},
        {"inversesqrt", INFINITY, 0.0f},
        {"inversesqrt", 4.0f, 0.5f},
        {"floor", -0.0f, -0.0f},
        {"floor", 0.5f, 0.0f},
        {"floor", -0.5f, -1.0f},
        {"floor", 0x1.fffffep22f, 0x1.fffffcp22f},
        {"floor", -INFINITY, -INFINITY},
        {"floor", -TINY, -1.0f},
        {"ceil", TINY, 1.0f},
        {"ceil", -0.5f, -0.0f},
        {"ceil", INFINITY, INFINITY},
        {"round", 0.5f, 1.0f},
        {"round", -0.5f, -1.0f},
        {"round", 2.5f, 3.0f},
        {"round", 0x1.fffffep-2f, 0.0f},
        {"round", -0.25f, -0.0f},
        {"round", INFINITY, INFINITY},
        {"round", 0x1.fffffep22f, 0x1p23f},
        {"round", HUGE_FLOAT, HUGE_FLOAT},
        {"sin_fast", 0.0f, 0.0f},
        {"sin_fast", -0.0f, -0.0f},
        {"cos_fast", 0.0f, 1.0f},
        {"tan_fast", -0.0f, -0.0f},
        {"asin_fast", 0.0f, 0.0f},
        {"asin_fast", 1.0f + 0x1p-20f, PI_FLOAT / 2},
        {"asin_fast", 1.0f + 0x1.2p-20f, NAN},
        {"acos_fast", 1.0f, 0.0f},
        {"acos_fast", 1.0f + 0x1p-20f, 0.0f},
        {"acos_fast", -1.0f - 0x1p-20f, PI_FLOAT},
        {"acos_fast", 1.0f + 0x1.2p-20f, NAN},
        {"atan_fast", -0.0f, -0.0f},
        {"atan_fast", INFINITY, PI_FLOAT / 2},
        {"exp2_fast", 0.0f, 1.0f},
        {"exp_fast", 0.0f, 1.0f},
        {"exp2_fast", -INFINITY, 0.0f},
        {"exp_fast", -HUGE_FLOAT, 0.0f},
        {"log2_fast", 0.0f, -INFINITY},
        {"log2_fast", -1.0f, NAN},
        {"log2_fast", INFINITY, INFINITY},
        {"log_fast", 1.0f, 0.0f},
        {"log_fast", -0.0f, -INFINITY},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        expect(table[i].name, table[i].x, 0.0f, call(table[i].name, table[i].x), table[i].expected);
}

static void powers_and_angles(void **state) {
    static const struct {
        const char *name;
        float x, y, expected;
    } table[] = {
        {"pow", NAN, 0.0f, 1.0f},
        {"pow", NAN, -0.0f, 1.0f},
        {"pow", INFINITY, 0.0f, 1.0f},
        {"pow", 0.0f, 0.0f, 1.0f},
        {"pow", 1.0f, NAN, 1.0f},
        {"pow", 1.0f, INFINITY, 1.0f},
        {"pow", NAN, 1.0f, NAN},
        {"pow", 2.0f, NAN, NAN},
        {"pow", -1.0f, NAN, NAN},
        {"pow", -1.0f, INFINITY, 1.0f},
        {"pow", -1.0f, -INFINITY, 1.0f},
        {"pow", -1.0f, 3.0f, -1.0f},
        {"pow", -1.0f, 4.0f, 1.0f},
        {"pow", -1.0f, 0.5f, NAN},
        {"pow", -1.0f, 0x1.fffffep23f, -1.0f},
        {"pow", -1.0f, 0x1p24f, 1.0f},
        {"pow", 0.0f, -3.0f, INFINITY},
        {"pow", -0.0f, -3.0f, -INFINITY},
        {"pow", -0.0f, -2.0f, INFINITY},
        {"pow", -0.0f, -0.5f, INFINITY},
        {"pow", 0.0f, 3.0f, 0.0f},
        {"pow", -0.0f, 3.0f, -0.0f},
        {"pow", -0.0f, 2.0f, 0.0f},
        {"pow", -0.0f, 0.5f, 0.0f},
        {"pow", 0.0f, -INFINITY, INFINITY},
        {"pow", -0.0f, INFINITY, 0.0f},
        {"pow", 0.5f, -INFINITY, INFINITY},
        {"pow", 2.0f, -INFINITY, 0.0f},
        {"pow", 0.5f, INFINITY, 0.0f},
        {"pow", -2.0f, INFINITY, INFINITY},
        {"pow", -INFINITY, -3.0f, -0.0f},
        {"pow", -INFINITY, -2.0f, 0.0f},
        {"pow", -INFINITY, -0.5f, 0.0f},
        {"pow", -INFINITY, 3.0f, -INFINITY},
        {"pow", -INFINITY, 2.0f, INFINITY},
        {"pow", -INFINITY, 0.5f, INFINITY},
        {"pow", INFINITY, -1.0f, 0.0f},
        {"pow", INFINITY, 1.0f, INFINITY},
        {"pow", -2.0f, 0.5f, NAN},
        {"pow", -8.0f, 3.0f, -512.0f},
        {"pow", 2.0f, 0.5f, 0x1.6a09e6p0f},
        {"pow", HUGE_FLOAT, HUGE_FLOAT, INFINITY},
        {"pow", TINY, 1.0f, TINY},
        {"pow", -TINY, 1.0f, -TINY},
        {"pow", 2.0f, 1e-30f, 1.0f},
        {"pow", 2.0f, -149.0f, TINY},
        {"pow", 2.0f, -150.0f, 0.0f},
        {"atan2", 0.0f, -0.0f, PI_FLOAT},
        {"atan2", -0.0f, -0.0f, -PI_FLOAT},
        {"atan2", 0.0f, 0.0f, 0.0f},
        {"atan2", -0.0f, 0.0f, -0.0f},
        {"atan2", 0.0f, -1.0f, PI_FLOAT},
        {"atan2", -0.0f, 1.0f, -0.0f},
        {"atan2", -1.0f, 0.0f, -PI_FLOAT / 2},
        {"atan2", 1.0f, -0.0f, PI_FLOAT / 2},
        {"atan2", 1.0f, -INFINITY, PI_FLOAT},
        {"atan2", -1.0f, INFINITY, -0.0f},
        {"atan2", INFINITY, 1.0f, PI_FLOAT / 2},
        {"atan2", INFINITY, -INFINITY, 0x1.2d97c8p1f},
        {"atan2", -INFINITY, INFINITY, -PI_FLOAT / 4},
        {"atan2", NAN, 1.0f, NAN},
        {"atan2", 1.0f, NAN, NAN},
        {"atan2", TINY, HUGE_FLOAT, 0.0f},
        {"atan2_fast", 0.0f, 0.0f, 0.0f},
        {"atan2_fast", 0.0f, -0.0f, 0.0f},
        {"atan2_fast", NAN, 1.0f, NAN},
        {"mod", 5.5f, 0.0f, 0.0f},
        {"mod", 5.5f, 2.0f, 1.5f},
        {"mod", -5.5f, 2.0f, 0.5f},
        {"mod", 5.5f, -2.0f, -0.5f},
        {"mod", -0x1p-40f, 1.0f, 1.0f},
        {"mod", INFINITY, 1.0f, NAN},
        {"mod", 1.0f, INFINITY, NAN},
        {"mod", NAN, 1.0f, NAN},
        {"mod", 0x1p100f, 3.0f, 0.0f},
        {"min", 1.0f, NAN, NAN},
        {"max", 1.0f, NAN, NAN},
        {"min", NAN, 1.0f, 1.0f},
        {"max", NAN, 1.0f, 1.0f},
        {"min", 0.0f, -0.0f, -0.0f},
        {"max", -0.0f, 0.0f, 0.0f},
        {"pow_fast", 0.0f, 0.0f, 1.0f},
        {"pow_fast", 3.0f, 0.0f, 1.0f},
        {"pow_fast", 0.0f, 2.0f, 0.0f},
        {"pow_fast", -2.0f, 0.5f, 0.0f},
        {"pow_fast", -2.0f, 3.0f, -8.0f},
        {"pow_fast", NAN, 1.0f, NAN},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        expect(table[i].name, table[i].x, table[i].y, call2(table[i].name, table[i].x, table[i].y),
               table[i].expected);
}

static void nan_in_gives_a_quiet_nan(void **state) {
    const uint32_t nans[] = {0x7fc00000, 0xffc00000, 0x7f800001, 0xff812345, 0x7fffffff};
    for (int f = 0; f < kernels->function_count; f++) {
        const struct vector_function *function = &kernels->functions[f];
        if (function->outputs != 1 || strcmp(function->name, "abs") == 0 ||
            strcmp(function->name, "min") == 0 || strcmp(function->name, "max") == 0)
            continue; /* these select, and do not compute */
        for (int argument = 0; argument < function->inputs; argument++) {
            for (size_t i = 0; i < sizeof nans / sizeof *nans; i++) {
                float x[3] = {0.75f, 0.75f, 0.75f}, result;
                x[argument] = sample_float(nans[i]);
                const float *in[3] = {&x[0], &x[1], &x[2]};
                float *out[1] = {&result};
                function->apply(in, out, 1);
                if ((sample_bits(result) & 0x7fc00000) != 0x7fc00000)
                    fail_msg("%s of NaN is %a", function->name, result);
            }
        }
    }
}

static void powers_of_two_are_exact(void **state) {
    for (int k = -149; k <= 127; k++) {
        float power = ldexpf(1.0f, k);
        expect("exp2", (float)k, 0.0f, call("exp2", (float)k), power);
        expect("log2", power, 0.0f, call("log2", power), (float)k);
        expect("pow", 2.0f, (float)k, call2("pow", 2.0f, (float)k), power);
        if (k >= -126) {
            expect("exp2_fast", (float)k, 0.0f, call("exp2_fast", (float)k), power);
            expect("log2_fast", power, 0.0f, call("log2_fast", power), (float)k);
        }
    }
}

/* The closest floats come to a multiple of pi/2, and the largest float: the reduction has to be
 * right to see them. */
static void huge_angles_are_reduced_exactly(void **state) {
    static const float angles[] = {
        16367173.0f * 0x1p72f, 0x1.f9cbe2p7f,   0x1.3d4p16f, 0x1p127f,   HUGE_FLOAT, 1e22f,
        0x1.6ac5b2p28f,        0x1.b5cf5ep120f, 0x1p20f,     524287.97f, 524288.06f};
    for (size_t i = 0; i < sizeof angles / sizeof *angles; i++) {
        float x = angles[i];
        assert_true(vector_ulp_error(call("sin", x), sin((double)x)) <= 0.501);
        assert_true(vector_ulp_error(call("cos", x), cos((double)x)) <= 0.501);
        assert_true(vector_ulp_error(call("tan", x), tan((double)x)) <= 0.501);
    }
}

static void odd_functions_are_odd_and_even_ones_even(void **state) {
    static const char *const odd[] = {"sin",      "tan",       "asin",      "atan", "sin_fast",
                                      "tan_fast", "asin_fast", "atan_fast", "round"};
    static const char *const even[] = {"cos", "cos_fast", "abs"};
    static float x[SAMPLE_BLOCK], opposite[SAMPLE_BLOCK], a[SAMPLE_BLOCK], b[SAMPLE_BLOCK];
    for (uint32_t block = 0; block < 256; block++) {
        sample_stratified(x, block, 256);
        for (int i = 0; i < SAMPLE_BLOCK; i++)
            opposite[i] = -x[i];
        for (size_t f = 0; f < sizeof odd / sizeof *odd + sizeof even / sizeof *even; f++) {
            int is_odd = f < sizeof odd / sizeof *odd;
            const char *name = is_odd ? odd[f] : even[f - sizeof odd / sizeof *odd];
            const struct vector_function *function = vector_kernels_find(kernels, name);
            function->apply((const float *[]){x}, (float *[]){a}, SAMPLE_BLOCK);
            function->apply((const float *[]){opposite}, (float *[]){b}, SAMPLE_BLOCK);
            for (int i = 0; i < SAMPLE_BLOCK; i++)
                if (!isnan(a[i]) &&
                    sample_bits(a[i]) != (sample_bits(b[i]) ^ (is_odd ? 0x80000000 : 0)))
                    fail_msg("%s(%a) = %a but %s(%a) = %a", name, x[i], a[i], name, -x[i], b[i]);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_argument),
        cmocka_unit_test(powers_and_angles),
        cmocka_unit_test(nan_in_gives_a_quiet_nan),
        cmocka_unit_test(powers_of_two_are_exact),
        cmocka_unit_test(huge_angles_are_reduced_exactly),
        cmocka_unit_test(odd_functions_are_odd_and_even_ones_even),
    };
    kernels = vector_kernels_best();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
