/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_EXACT_H
#define VECTOR_EXACT_H

/* The exact functions: at most 0.501 ulp from the true value for every input (pow and atan2: for
 * all inputs sampled, docs/accuracy.md), denormal results included. Each lane is computed in double
 * precision by the paper's method, section 6.1.4: reduce by identities, then one polynomial, no
 * tables; the result is rounded once. NaN in gives one quiet NaN out. Add and multiply stay
 * separate (no fused operations), so that all instruction sets give the same bits. */

#include "vector_polynomials.h"
#include "vector_types.h"

/* 1.5 * 2^52: adding it rounds to an integer, which is then in the low bits of the sum. */
#define SIMD_ROUND_TO_INTEGER 0x1.8p52

/* ---- exponentials ---- */

SIMD_INLINE hd hd_exp2(hd x) {
    hd shifted = x + SIMD_ROUND_TO_INTEGER;
    hd f = x - (shifted - SIMD_ROUND_TO_INTEGER);
    hd f2 = f * f, f4 = f2 * f2;
    hd q01 = POLYNOMIAL_EXP2_0 + POLYNOMIAL_EXP2_1 * f;
    hd q23 = POLYNOMIAL_EXP2_2 + POLYNOMIAL_EXP2_3 * f;
    hd q45 = POLYNOMIAL_EXP2_4 + POLYNOMIAL_EXP2_5 * f;
    hd q67 = POLYNOMIAL_EXP2_6 + POLYNOMIAL_EXP2_7 * f;
    hd q = (q01 + q23 * f2) + f4 * (q45 + q67 * f2);
    hd p = 1.0 + f * q;
    return (hd)((hu)p + ((hu)shifted << 52)); /* p * 2^n; p is normal and n is in -151..129 */
}

SIMD_INLINE vf vf_clamp_keep_nan(vf x, float low, float high) {
    return vf_max(vf_set(low), vf_min(vf_set(high), x));
}

/* 2^x for all x. exp2 of an integer is exact; overflow gives Inf, underflow goes through denormals
 * to 0; exp2(Inf) = Inf, exp2(-Inf) = 0. Monotone. */
SIMD_FUNCTION vf vf_exp2(vf x) {
    x = vf_clamp_keep_nan(x, -151.0f, 129.0f);
    return vf_canonical(vf_join(hd_exp2(hd_low(x)), hd_exp2(hd_high(x))));
}

/* e^x for all x; special cases as exp2. Monotone. */
SIMD_FUNCTION vf vf_exp(vf x) {
    x = vf_clamp_keep_nan(x, -104.5f, 89.0f);
    return vf_canonical(
        vf_join(hd_exp2(hd_low(x) * CONSTANT_LOG2_E), hd_exp2(hd_high(x) * CONSTANT_LOG2_E)));
}

/* ---- logarithms ---- */

/* Splits positive x into m * 2^e with m in [sqrt(1/2), sqrt(2)); returns m - 1. */
SIMD_INLINE hd hd_split(hd x, hd *e) {
    const uint64_t one = 0x3ff0000000000000, sqrt_half = 0x3fe6a09e667f3bcd;
    hu bits = (hu)x + (one - sqrt_half);
    *e = (hd)((bits >> 52) | 0x4330000000000000) - (0x1p52 + 1023.0);
    return (hd)((bits & 0x000fffffffffffff) + sqrt_half) - 1.0;
}

SIMD_INLINE hd hd_log2(hd x) {
    hd e, f = hd_split(x, &e);
    hd f2 = f * f, f4 = f2 * f2, f8 = f4 * f4;
    hd q01 = POLYNOMIAL_LOG2_0 + POLYNOMIAL_LOG2_1 * f;
    hd q23 = POLYNOMIAL_LOG2_2 + POLYNOMIAL_LOG2_3 * f;
    hd q45 = POLYNOMIAL_LOG2_4 + POLYNOMIAL_LOG2_5 * f;
    hd q67 = POLYNOMIAL_LOG2_6 + POLYNOMIAL_LOG2_7 * f;
    hd q89 = POLYNOMIAL_LOG2_8 + POLYNOMIAL_LOG2_9 * f;
    hd qab = POLYNOMIAL_LOG2_10 + POLYNOMIAL_LOG2_11 * f;
    hd qcd = POLYNOMIAL_LOG2_12 + POLYNOMIAL_LOG2_13 * f;
    hd low = (q01 + q23 * f2) + f4 * (q45 + q67 * f2);
    hd high = (q89 + qab * f2) + f4 * (qcd + POLYNOMIAL_LOG2_14 * f2);
    return e + f * (low + f8 * high);
}

/* log2 with relative error near 2^-50, for pow; NaN for NaN, -Inf for 0, Inf for Inf; x >= 0. */
SIMD_INLINE hd hd_log2_for_pow(hd x) {
    hd e, f = hd_split(x, &e);
    hd f2 = f * f, f4 = f2 * f2, f8 = f4 * f4;
    hd q01 = POLYNOMIAL_POW_0 + POLYNOMIAL_POW_1 * f;
    hd q23 = POLYNOMIAL_POW_2 + POLYNOMIAL_POW_3 * f;
    hd q45 = POLYNOMIAL_POW_4 + POLYNOMIAL_POW_5 * f;
    hd q67 = POLYNOMIAL_POW_6 + POLYNOMIAL_POW_7 * f;
    hd q89 = POLYNOMIAL_POW_8 + POLYNOMIAL_POW_9 * f;
    hd qab = POLYNOMIAL_POW_10 + POLYNOMIAL_POW_11 * f;
    hd qcd = POLYNOMIAL_POW_12 + POLYNOMIAL_POW_13 * f;
    hd qef = POLYNOMIAL_POW_14 + POLYNOMIAL_POW_15 * f;
    hd qgh = POLYNOMIAL_POW_16 + POLYNOMIAL_POW_17 * f;
    hd low = (q01 + q23 * f2) + f4 * (q45 + q67 * f2);
    hd middle = (q89 + qab * f2) + f4 * (qcd + qef * f2);
    hd high = qgh + POLYNOMIAL_POW_18 * f2;
    hd result = e + f * (low + f8 * (middle + f8 * high));
    result = hd_select((hl)(x > 0.0), result, x - __builtin_inf());  /* 0 and NaN */
    return hd_select((hl)(x < __builtin_inf()), result, x + result); /* Inf and NaN */
}

SIMD_INLINE vf vf_log_special(vf x, vf result) {
    vf rest = vf_select((vi)(x == 0.0f), vf_set(-__builtin_inff()), vf_set(__builtin_nanf("")));
    rest = vf_select((vi)(x == __builtin_inff()), x, rest);
    return vf_select((vi)(x > 0.0f) & (vi)(x < __builtin_inff()), result, rest);
}

/* log2 of all x: exact for powers of two, monotone; +-0 gives -Inf, negative numbers NaN, Inf gives
 * Inf. */
SIMD_FUNCTION vf vf_log2(vf x) {
    return vf_log_special(x, vf_join(hd_log2(hd_low(x)), hd_log2(hd_high(x))));
}

/* Natural logarithm; special cases as log2. Monotone. */
SIMD_FUNCTION vf vf_log(vf x) {
    return vf_log_special(
        x, vf_join(hd_log2(hd_low(x)) * CONSTANT_LN_2, hd_log2(hd_high(x)) * CONSTANT_LN_2));
}

/* ---- power ---- */

SIMD_INLINE hd hd_pow(hd x, hd y) {
    hd v = y * hd_log2_for_pow(x);
    v = hd_select((hl)(v > 129.0), (hd){} + 129.0, v);
    v = hd_select((hl)(v < -151.0), (hd){} - 151.0, v);
    return hd_exp2(v);
}

/* x^y with the special cases of C99 Annex F: pow(x, +-0) = pow(1, y) = 1 even for NaN; negative x
 * needs an integer y (else NaN), odd ones give negative results; pow(+-0, y < 0) is infinite. */
SIMD_FUNCTION vf vf_pow(vf x, vf y) {
    vf size = vf_abs(x), half = y * 0.5f;
    vi integer = (vi)(vf_floor(y) == y);
    vi odd = integer & ~(vi)(vf_floor(half) == half);
    vf result = vf_join(hd_pow(hd_low(size), hd_low(y)), hd_pow(hd_high(size), hd_high(y)));
    result = vf_select((vi)(size == 1.0f) & (vi)(y == y), vf_set(1.0f), result);
    result = (vf)((vi)result ^ ((vi)x & odd & (int32_t)0x80000000));
    vi invalid = (vi)(x < 0.0f) & (vi)(size < __builtin_inff()) & ~integer;
    result = vf_canonical(vf_select(invalid, vf_set(__builtin_nanf("")), result));
    return vf_select((vi)(y == 0.0f) | (vi)(x == 1.0f), vf_set(1.0f), result);
}

/* ---- roots and remainders ---- */

SIMD_INLINE hd hd_inversesqrt(hd x) {
    return 1.0 / hd_sqrt(x);
}

/* 1 / sqrt(x): +-0 gives +-Inf, Inf gives 0, negative numbers NaN. */
SIMD_FUNCTION vf vf_inversesqrt(vf x) {
    return vf_canonical(vf_join(hd_inversesqrt(hd_low(x)), hd_inversesqrt(hd_high(x))));
}

SIMD_INLINE hd hd_floor(hd x) {
    hd size = hd_abs(x);
    hd nearest = hd_with_sign((size + 0x1p52) - 0x1p52, x);
    hd down = nearest - (hd)((hl)(nearest > x) & (hl)((hd){} + 1.0));
    return hd_select((hl)(size < 0x1p52), down, x);
}

SIMD_INLINE hd hd_mod(hd a, hd b) {
    hd rest = a - b * hd_floor(a / b);
    /* a / b may have been rounded up to an integer: the rest is then between -b and 0 */
    hd size = hd_abs(b), low = hd_select((hl)(rest * b < 0.0), rest + b, rest);
    hl inside = (hl)(low * b >= 0.0) & (hl)(hd_abs(low) <= size);
    hd result = (hd)(inside & (hl)low);
    return hd_select((hl)(a - a == 0.0) & (hl)(size < __builtin_inf()), result, rest);
}

/* a - b * floor(a / b): from 0 to b, of the sign of b. Exact before the one rounding to float
 * (which may round up to b itself) for |a / b| < 2^29; beyond that it stays in range, and is 0
 * where nothing is known of it. mod(a, 0) is 0. NaN for infinite a or b. */
SIMD_FUNCTION vf vf_mod(vf a, vf b) {
    return vf_canonical(vf_join(hd_mod(hd_low(a), hd_low(b)), hd_mod(hd_high(a), hd_high(b))));
}

#endif
