/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_FAST_H
#define VECTOR_FAST_H

/* The paper's fast functions (section 6.1.4): visually accurate, numerically poor. Each reduces the
 * argument as the exact function does and then uses a short polynomial that matches value and first
 * derivative at each end of the reduced range, so that the result is smooth across ranges. Single
 * precision throughout. NaN in gives NaN out; finite inputs never give NaN within a function's
 * domain. Bounds: docs/accuracy.md.
 *
 * Functions that should be monotone are, from each float to the next: the argument is rounded to
 * some 20 bits first, so that one step of it outweighs the rounding of the few operations after. */

#include "vector_exact.h"

/* 1.5 * 2^23: as SIMD_ROUND_TO_INTEGER, in single precision */
#define SIMD_ROUND_TO_INTEGER_FAST 0x1.8p23f

SIMD_INLINE vf vf_sin_reduced_fast(vf r) {
    r = vf_clamp_keep_nan(r, -FAST_HALF_PI, FAST_HALF_PI);
    vf s = r * r;
    vf value = r * (FAST_SIN_0 + s * (FAST_SIN_1 + s * FAST_SIN_2));
    return vf_clamp_keep_nan(value, -1.0f, 1.0f);
}

/* x - n pi to 2e-7 for |x| <= 8192 */
SIMD_INLINE vf vf_reduce_fast(vf x, vf n) {
    return (x - n * FAST_PI_COARSE) - n * FAST_PI_REST;
}

/* Absolute error below 4e-4 for |x| <= 8192; magnitude at most 1 for every x; odd, sin(+-0) = +-0.
 */
SIMD_FUNCTION vf vf_sin_fast(vf x) {
    vf size = vf_abs(x);
    vf shifted = size * FAST_INVERSE_PI + SIMD_ROUND_TO_INTEGER_FAST;
    vf n = shifted - SIMD_ROUND_TO_INTEGER_FAST;
    vf value = vf_sin_reduced_fast(vf_reduce_fast(size, n));
    vi sign = ((vi)shifted << 31) ^ ((vi)x & (int32_t)0x80000000);
    return vf_canonical((vf)((vi)value ^ sign));
}

/* Absolute error below 4e-4 for |x| <= 8192; magnitude at most 1 for every x; even, cos(0) = 1. */
SIMD_FUNCTION vf vf_cos_fast(vf x) {
    x = vf_abs(x);
    vf shifted = (x * FAST_INVERSE_PI + 0.5f) + SIMD_ROUND_TO_INTEGER_FAST;
    vf n = (shifted - SIMD_ROUND_TO_INTEGER_FAST) - 0.5f;
    vf value = vf_sin_reduced_fast(vf_reduce_fast(x, n));
    return vf_canonical((vf)((vi)value ^ ((vi)shifted << 31)));
}

/* Relative error below 3.5e-3 for |x| <= 8192; odd, tan(+-0) =
 * +-0. */
SIMD_FUNCTION vf vf_tan_fast(vf x) {
    const float quarter_pi = 0.5f * FAST_HALF_PI;
    vf size = vf_abs(x);
    vf shifted = size * FAST_TWO_OVER_PI + SIMD_ROUND_TO_INTEGER_FAST;
    vf n = (shifted - SIMD_ROUND_TO_INTEGER_FAST) * 0.5f;
    vf reduced = ((size - n * FAST_PI_HIGH) - n * FAST_PI_MIDDLE) - n * FAST_PI_LOW;
    vf r = vf_clamp_keep_nan(reduced, -quarter_pi, quarter_pi);
    vf s = r * r;
    vf value = r * (FAST_TAN_0 + s * (FAST_TAN_1 + s * FAST_TAN_2));
    vi odd = -((vi)shifted & 1);
    value = vf_select(odd, -1.0f / value, value);
    return vf_canonical((vf)((vi)value ^ ((vi)x & (int32_t)0x80000000)));
}

/* acos(|x|); 0 for |x| in (1, 1 + 2^-20] */
SIMD_INLINE vf vf_acos_reduced_fast(vf size) {
    vf s = vf_select((vi)(size > 1.0f) & (vi)(size <= 1.0f + 0x1p-20f), vf_set(1.0f), size);
    vf t = (vf)((vi)(1.0f - s) & ~31);
    s = 1.0f - t;
    vf q = FAST_ACOS_0 + s * (FAST_ACOS_1 + s * (FAST_ACOS_2 + s * FAST_ACOS_3));
    return vf_sqrt(t) * q;
}

/* Absolute error below 1.2e-3 on [-1, 1]; odd, asin(+-0) = +-0; NaN beyond 1 + 2^-20. Monotone. */
SIMD_FUNCTION vf vf_asin_fast(vf x) {
    vf angle = FAST_HALF_PI - vf_acos_reduced_fast(vf_abs(x));
    return vf_canonical(vf_with_sign(angle, x));
}

/* Absolute error below 1.2e-3 on [-1, 1]; acos(1) = 0; NaN beyond 1 + 2^-20. Monotone. */
SIMD_FUNCTION vf vf_acos_fast(vf x) {
    vf angle = vf_acos_reduced_fast(vf_abs(x));
    return vf_canonical(vf_select((vi)(x < 0.0f), FAST_PI - angle, angle));
}

SIMD_INLINE vf vf_atan_reduced_fast(vf r) {
    vf s = r * r;
    return r * (FAST_ATAN_0 + s * (FAST_ATAN_1 + s * FAST_ATAN_2));
}

/* Absolute error below 8.5e-3 for all x; odd, atan(+-0) = +-0. Monotone. */
SIMD_FUNCTION vf vf_atan_fast(vf x) {
    vf size = (vf)((vi)x & 0x7ffffff8);
    vi inverted = (vi)(size > 1.0f);
    vf angle = vf_atan_reduced_fast(vf_select(inverted, 1.0f / size, size));
    angle = vf_select(inverted, FAST_HALF_PI - angle, angle);
    return vf_select((vi)(x == x), vf_with_sign(angle, x), (vf)vi_set(0x7fc00000));
}

/* Absolute error below 8.5e-3; atan2(0, 0) = 0 for zeros of any sign; special cases otherwise as
 * atan2. */
SIMD_FUNCTION vf vf_atan2_fast(vf y, vf x) {
    vf across = vf_abs(x), up = vf_abs(y);
    vi steep = (vi)(up > across);
    vf ratio = vf_select(steep, across, up) / vf_select(steep, up, across);
    vf same = (vf)((vi)(up > 0.0f) & (vi)vf_set(1.0f));
    vf angle = vf_atan_reduced_fast(vf_select((vi)(up == across), same, ratio));
    angle = vf_select(steep, FAST_HALF_PI - angle, angle);
    angle = vf_select((vi)(x < 0.0f), FAST_PI - angle, angle);
    vi valid = (vi)(x == x) & (vi)(y == y);
    return vf_select(valid, vf_with_sign(angle, y), (vf)vi_set(0x7fc00000));
}

/* Relative error below 6.2e-4 where the result is normal. Exact at integers, monotone. Saturates:
 * 3.4e38 from 128 up (Inf included), 0 below -126; never NaN unless x is. */
SIMD_FUNCTION vf vf_exp2_fast(vf x) {
    vf v = vf_clamp_keep_nan(x, -126.0f, 0x1.fffffep6f);
    vf shifted = (v - 0.5f) + SIMD_ROUND_TO_INTEGER_FAST;
    vf f =
        v - (shifted - SIMD_ROUND_TO_INTEGER_FAST); /* 0 to 1; odd integers give 1, even ones 0 */
    f = (f + 0x1.8p4f) - 0x1.8p4f;
    vf p = FAST_EXP2_0 + f * (FAST_EXP2_1 + f * (FAST_EXP2_2 + f * FAST_EXP2_3));
    vf value = (vf)((vu)p + ((vu)shifted << 23));
    value = (vf)((vi)value & (vi)(x >= -126.0f));
    return vf_select((vi)(x == x), value, (vf)vi_set(0x7fc00000));
}

/* Relative error below 6.2e-4 plus that of rounding x * log2(e), 2^-24 |x|; saturates as exp2_fast.
 */
SIMD_FUNCTION vf vf_exp_fast(vf x) {
    return vf_exp2_fast(x * FAST_LOG2_E);
}

/* log2(x) for x >= 0 in normal range; between -127 and -126 for denormals and 0; finite for every
 * bit pattern */
SIMD_INLINE vf vf_log2_finite_fast(vf x) {
    vi bits = (vi)x & 0x7fffffff;
    vf e = (vf)((bits >> 23) | 0x4b000000) - (0x1p23f + 127.0f);
    vf f = (vf)((bits & 0x7ffff8) | 0x3f800000) - 1.0f;
    return e + f * (FAST_LOG2_1 + f * (FAST_LOG2_2 + f * FAST_LOG2_3));
}

/* Absolute error below 5.3e-3 for normal x; log2(2^k) = k; finite (about -126.5) for denormals;
 * monotone. +-0 gives -Inf, negative numbers NaN, Inf gives Inf. */
SIMD_FUNCTION vf vf_log2_fast(vf x) {
    return vf_log_special(x, vf_log2_finite_fast(x));
}

/* log2_fast times log(2): absolute error below 3.7e-3. */
SIMD_FUNCTION vf vf_log_fast(vf x) {
    return vf_log_special(x, vf_log2_finite_fast(x) * FAST_LN_2);
}

/* exp2_fast(y log2_fast(|x|)): finite and never NaN for finite x and y. pow(x, 0) = 1; pow(0, y >
 * 0) = 0; pow(0, y < 0) saturates. Negative x gives the signed value for integer y and 0 otherwise.
 */
SIMD_FUNCTION vf vf_pow_fast(vf x, vf y) {
    vf half = y * 0.5f;
    vi integer = (vi)(vf_floor(y) == y);
    vi odd = integer & ~(vi)(vf_floor(half) == half);
    vf exponent = y * vf_log2_finite_fast(x);
    exponent = vf_select((vi)(x == 0.0f) & (vi)(y != 0.0f), y * -__builtin_inff(), exponent);
    vf value = vf_exp2_fast(exponent);
    value = (vf)((vi)value & ~((vi)(x < 0.0f) & ~integer));
    value = (vf)((vi)value ^ ((vi)x & odd & (int32_t)0x80000000));
    return vf_select((vi)(x == x) & (vi)(y == y), value, (vf)vi_set(0x7fc00000));
}

#endif
