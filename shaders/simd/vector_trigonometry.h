/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_TRIGONOMETRY_H
#define VECTOR_TRIGONOMETRY_H

/* The exact trigonometric functions and their inverses; see vector_exact.h for what exact means. */

#include "vector_exact.h"

/* Arguments beyond this leave the two-constant reduction for the one in 128-bit integers. */
#define SIMD_HUGE_ANGLE 0x1p19f

/* ---- reduction of huge arguments, a lane at a time ---- */

/* 2/pi * x modulo 4, in units of 2^-126; x is finite and at least SIMD_HUGE_ANGLE. The error is
 * below 2^-101: x is an integer m of 24 bits times 2^exponent, and only 128 bits of 2^exponent *
 * 2/pi matter to the result. */
SIMD_FUNCTION unsigned __int128 simd_quarter_turns(float x) {
    static const uint64_t words[] = {TWO_OVER_PI_WORDS};
    uint32_t bits;
    __builtin_memcpy(&bits, &x, sizeof bits);
    int start = 64 + (int)(bits >> 23) - 150 -
                2; /* the first bit of 2/pi that is worth 2 or 1 after scaling */
    int word = start >> 6, shift = start & 63;
    uint64_t high = words[word] << shift, low = words[word + 1] << shift;
    if (shift > 0) {
        high |= words[word + 1] >> (64 - shift);
        low |= words[word + 2] >> (64 - shift);
    }
    return (((unsigned __int128)high << 64) | low) * ((bits & 0x7fffff) | 0x800000);
}

/* A signed number of quarter turns in units of 2^-126, as an angle. */
SIMD_FUNCTION double simd_angle(unsigned __int128 turns) {
    double high = (double)(int64_t)(turns >> 64), low = (double)(uint64_t)turns;
    return (high * 0x1p-62 + low * 0x1p-126) * CONSTANT_HALF_PI;
}

SIMD_INLINE vi vi_huge_angle(vf x) {
    vf size = vf_abs(x);
    return (vi)(size > SIMD_HUGE_ANGLE) & (vi)(size < __builtin_inff());
}

/* ---- sine and cosine ---- */

/* sin(r) for |r| <= pi/2; never above 1 once rounded to float. */
SIMD_INLINE hd hd_sin_reduced(hd r) {
    hd s = r * r, s2 = s * s;
    hd q01 = POLYNOMIAL_SIN_0 + POLYNOMIAL_SIN_1 * s;
    hd q23 = POLYNOMIAL_SIN_2 + POLYNOMIAL_SIN_3 * s;
    hd q45 = POLYNOMIAL_SIN_4 + POLYNOMIAL_SIN_5 * s;
    hd q = q01 + s2 * (q23 + s2 * q45);
    return r * (1.0 + s * q);
}

SIMD_INLINE hd hd_sin(hd x) {
    hd shifted = x * CONSTANT_INVERSE_PI + SIMD_ROUND_TO_INTEGER;
    hd n = shifted - SIMD_ROUND_TO_INTEGER;
    hd r = (x - n * CONSTANT_PI_HIGH) - n * CONSTANT_PI_LOW;
    return (hd)((hl)hd_sin_reduced(r) ^ ((hl)shifted << 63));
}

/* cos(x) = sin(x + pi/2), for x >= 0 */
SIMD_INLINE hd hd_cos(hd x) {
    hd shifted = (x * CONSTANT_INVERSE_PI + 0.5) + SIMD_ROUND_TO_INTEGER;
    hd n = (shifted - SIMD_ROUND_TO_INTEGER) - 0.5;
    hd r = (x - n * CONSTANT_PI_HIGH) - n * CONSTANT_PI_LOW;
    return (hd)((hl)hd_sin_reduced(r) ^ ((hl)shifted << 63));
}

/* Replaces the lanes of `result` whose argument is huge by sin(|x| + quarters * pi/2), sign of x
 * for sine. */
SIMD_RARE vf vf_sin_huge(vf x, vf result, int quarters) {
    vi huge = vi_huge_angle(x);
    vf size = vf_abs(x);
    double angle[SHADER_WIDTH];
    int32_t sign[SHADER_WIDTH];
    for (int i = 0; i < SHADER_WIDTH; i++) {
        angle[i] = 0.0;
        sign[i] = 0;
        if (huge[i] == 0)
            continue;
        unsigned __int128 turns =
            simd_quarter_turns(size[i]) + ((unsigned __int128)quarters << 126);
        unsigned __int128 half_turns = (turns + ((unsigned __int128)1 << 126)) >> 127;
        angle[i] = simd_angle(turns - (half_turns << 127));
        sign[i] = (int32_t)((uint32_t)half_turns << 31);
    }
    hd low, high;
    vi flip;
    __builtin_memcpy(&low, angle, sizeof low);
    __builtin_memcpy(&high, angle + SHADER_WIDTH / 2, sizeof high);
    __builtin_memcpy(&flip, sign, sizeof flip);
    if (quarters == 0)
        flip ^= (vi)x & (int32_t)0x80000000;
    vf value = vf_join(hd_sin_reduced(low), hd_sin_reduced(high));
    return vf_select(huge, (vf)((vi)value ^ flip), result);
}

/* All finite x; odd, sin(+-0) = +-0, magnitude at most 1; NaN for infinities. */
SIMD_FUNCTION vf vf_sin(vf x) {
    vf result = vf_canonical(vf_join(hd_sin(hd_low(x)), hd_sin(hd_high(x))));
    if (__builtin_expect(vi_any(vi_huge_angle(x)), 0))
        result = vf_sin_huge(x, result, 0);
    return result;
}

/* All finite x; even, cos(0) = 1, magnitude at most 1; NaN for infinities. */
SIMD_FUNCTION vf vf_cos(vf x) {
    vf size = vf_abs(x);
    vf result = vf_canonical(vf_join(hd_cos(hd_low(size)), hd_cos(hd_high(size))));
    if (__builtin_expect(vi_any(vi_huge_angle(x)), 0))
        result = vf_sin_huge(size, result, 1);
    return result;
}

/* ---- tangent ---- */

/* tan(r) for |r| <= pi/4, -1 / tan(r) where `odd` is -1 */
SIMD_INLINE hd hd_tan_reduced(hd r, hl odd) {
    hd s = r * r, s2 = s * s;
    hd sine = POLYNOMIAL_TAN_SIN_0 + POLYNOMIAL_TAN_SIN_1 * s +
              s2 * (POLYNOMIAL_TAN_SIN_2 + POLYNOMIAL_TAN_SIN_3 * s + s2 * POLYNOMIAL_TAN_SIN_4);
    hd cosine = POLYNOMIAL_TAN_COS_0 + POLYNOMIAL_TAN_COS_1 * s +
                s2 * (POLYNOMIAL_TAN_COS_2 + POLYNOMIAL_TAN_COS_3 * s + s2 * POLYNOMIAL_TAN_COS_4);
    sine = r * (1.0 + s * sine);
    cosine = 1.0 + s * cosine;
    return hd_select(odd, -cosine, sine) / hd_select(odd, sine, cosine);
}

SIMD_INLINE hd hd_tan(hd x) {
    hd shifted = x * CONSTANT_TWO_OVER_PI + SIMD_ROUND_TO_INTEGER;
    hd n = shifted - SIMD_ROUND_TO_INTEGER;
    hd r = (x - n * CONSTANT_HALF_PI_HIGH) - n * CONSTANT_HALF_PI_LOW;
    return hd_tan_reduced(r, -((hl)shifted & 1));
}

SIMD_RARE vf vf_tan_huge(vf x, vf result) {
    vi huge = vi_huge_angle(x);
    vf size = vf_abs(x);
    double angle[SHADER_WIDTH];
    int64_t odd[SHADER_WIDTH];
    for (int i = 0; i < SHADER_WIDTH; i++) {
        angle[i] = 0.0;
        odd[i] = 0;
        if (huge[i] == 0)
            continue;
        unsigned __int128 turns = simd_quarter_turns(size[i]);
        unsigned __int128 quarters = (turns + ((unsigned __int128)1 << 125)) >> 126;
        angle[i] = simd_angle(turns - (quarters << 126));
        odd[i] = -(int64_t)(quarters & 1);
    }
    hd low, high;
    hl low_odd, high_odd;
    __builtin_memcpy(&low, angle, sizeof low);
    __builtin_memcpy(&high, angle + SHADER_WIDTH / 2, sizeof high);
    __builtin_memcpy(&low_odd, odd, sizeof low_odd);
    __builtin_memcpy(&high_odd, odd + SHADER_WIDTH / 2, sizeof high_odd);
    vf value = vf_join(hd_tan_reduced(low, low_odd), hd_tan_reduced(high, high_odd));
    value = (vf)((vi)value ^ ((vi)x & (int32_t)0x80000000));
    return vf_select(huge, value, result);
}

/* All finite x; odd, tan(+-0) = +-0; NaN for infinities. */
SIMD_FUNCTION vf vf_tan(vf x) {
    vf result = vf_canonical(vf_join(hd_tan(hd_low(x)), hd_tan(hd_high(x))));
    if (__builtin_expect(vi_any(vi_huge_angle(x)), 0))
        result = vf_tan_huge(x, result);
    return result;
}

/* ---- inverse sine and cosine ---- */

/* asin(|x|) for |x| <= 1/2; elsewhere asin(sqrt((1 - |x|) / 2)), and `big` is -1 */
SIMD_INLINE hd hd_asin_reduced(hd x, hl *big) {
    hd size = hd_abs(x);
    *big = (hl)(size > 0.5);
    hd half = (1.0 - size) * 0.5;
    hd s = hd_select(*big, half, x * x);
    hd r = hd_select(*big, hd_sqrt(half), size);
    hd s2 = s * s, s4 = s2 * s2;
    hd q01 = POLYNOMIAL_ASIN_0 + POLYNOMIAL_ASIN_1 * s;
    hd q23 = POLYNOMIAL_ASIN_2 + POLYNOMIAL_ASIN_3 * s;
    hd q45 = POLYNOMIAL_ASIN_4 + POLYNOMIAL_ASIN_5 * s;
    hd q67 = POLYNOMIAL_ASIN_6 + POLYNOMIAL_ASIN_7 * s;
    hd q = (q01 + q23 * s2) + s4 * (q45 + q67 * s2);
    return r * (1.0 + s * q);
}

SIMD_INLINE hd hd_asin(hd x) {
    hl big;
    hd angle = hd_asin_reduced(x, &big);
    angle = hd_select(big, CONSTANT_HALF_PI - 2.0 * angle, angle);
    return hd_with_sign(angle, x);
}

SIMD_INLINE hd hd_acos(hd x) {
    hl big;
    hd angle = hd_asin_reduced(x, &big);
    hd far = hd_select((hl)(x < 0.0), CONSTANT_PI - 2.0 * angle, 2.0 * angle);
    return hd_select(big, far, CONSTANT_HALF_PI - hd_with_sign(angle, x));
}

/* [-1, 1], NaN outside; odd, asin(+-0) = +-0. */
SIMD_FUNCTION vf vf_asin(vf x) {
    return vf_canonical(vf_join(hd_asin(hd_low(x)), hd_asin(hd_high(x))));
}

/* [-1, 1], NaN outside; acos(1) = +0. */
SIMD_FUNCTION vf vf_acos(vf x) {
    return vf_canonical(vf_join(hd_acos(hd_low(x)), hd_acos(hd_high(x))));
}

/* ---- inverse tangent ---- */

/* atan(r) for |r| <= 1 */
SIMD_INLINE hd hd_atan_reduced(hd r) {
    hd s = r * r, s2 = s * s, s4 = s2 * s2, s8 = s4 * s4;
    hd q01 = POLYNOMIAL_ATAN_0 + POLYNOMIAL_ATAN_1 * s;
    hd q23 = POLYNOMIAL_ATAN_2 + POLYNOMIAL_ATAN_3 * s;
    hd q45 = POLYNOMIAL_ATAN_4 + POLYNOMIAL_ATAN_5 * s;
    hd q67 = POLYNOMIAL_ATAN_6 + POLYNOMIAL_ATAN_7 * s;
    hd q89 = POLYNOMIAL_ATAN_8 + POLYNOMIAL_ATAN_9 * s;
    hd qab = POLYNOMIAL_ATAN_10 + POLYNOMIAL_ATAN_11 * s;
    hd qcd = POLYNOMIAL_ATAN_12 + POLYNOMIAL_ATAN_13 * s;
    hd low = (q01 + q23 * s2) + s4 * (q45 + q67 * s2);
    hd high = (q89 + qab * s2) + s4 * qcd;
    return r * (1.0 + s * (low + s8 * high));
}

SIMD_INLINE hd hd_atan(hd x) {
    hl inverted = (hl)(hd_abs(x) > 1.0);
    hd angle = hd_atan_reduced(hd_select(inverted, -1.0 / x, x));
    /* -1 / x has the other sign: the quarter turn takes x's */
    return angle + (hd)((hl)hd_with_sign((hd){} + CONSTANT_HALF_PI, x) & inverted);
}

SIMD_INLINE hd hd_atan2(hd y, hd x) {
    hd across = hd_abs(x), up = hd_abs(y);
    hl steep = (hl)(up > across);
    hd ratio = hd_select(steep, across, up) / hd_select(steep, up, across);
    hd same = (hd)((hl)(up > 0.0) & (hl)((hd){} + 1.0)); /* 0/0 counts as 0, Inf/Inf as 1 */
    ratio = hd_select((hl)(up == across), same, ratio);
    hd angle = hd_atan_reduced(ratio);
    angle = hd_select(steep, CONSTANT_HALF_PI - angle, angle);
    hl left = -(hl)((hu)x >> 63);
    angle = hd_select(left, CONSTANT_PI - angle, angle);
    return hd_with_sign(angle, y);
}

/* All x; odd, atan(+-0) = +-0, atan(+-Inf) = +-pi/2. */
SIMD_FUNCTION vf vf_atan(vf x) {
    vf result = vf_join(hd_atan(hd_low(x)), hd_atan(hd_high(x)));
    /* the sum in hd_atan loses the sign of -0 */
    return vf_canonical(vf_select((vi)(x == 0.0f), x, result));
}

/* The angle of (x, y), with the special cases of C99 Annex F (atan2(+-0, -0) = +-pi, all
 * infinities). */
SIMD_FUNCTION vf vf_atan2(vf y, vf x) {
    vf result = vf_join(hd_atan2(hd_low(y), hd_low(x)), hd_atan2(hd_high(y), hd_high(x)));
    return vf_canonical(vf_select((vi)(x == x) & (vi)(y == y), result, vf_set(__builtin_nanf(""))));
}

#endif
