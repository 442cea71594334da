/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_FIXED_H
#define VECTOR_FIXED_H

/* Fixed-point numbers (PF section 3.1): raw integers of up to 64 bits, one lane each; exponents,
 * sizes and signs are known to the compiler of shaders and come as constants. docs/language.md,
 * section 11, defines every operation; exact to the bit at every width.
 *
 *   vx, vxu  SHADER_WIDTH 64-bit integers, signed and unsigned
 *   sx_...   the same for one number, in uniform code */

#include "vector_fixed_noise.h"
#include "vector_types.h"

typedef int64_t vx __attribute__((vector_size(8 * SHADER_WIDTH)));
typedef uint64_t vxu __attribute__((vector_size(8 * SHADER_WIDTH)));

#define FX vx
#define FXU vxu
#define FX_NAME(name) vx_##name
#include "fixed_template.h"
#undef FX
#undef FXU
#undef FX_NAME
#define FX int64_t
#define FXU uint64_t
#define FX_NAME(name) sx_##name
#include "fixed_template.h"
#undef FX
#undef FXU
#undef FX_NAME

SIMD_INLINE vx vx_set(int64_t x) {
    return (vx){SIMD_EACH(SIMD_LANE_SAME, x)};
}

/* Masks of 32-bit lanes and of 64-bit lanes. */
SIMD_INLINE vx vx_mask(vi mask) {
    return __builtin_convertvector(mask, vx);
}

SIMD_INLINE vi vx_condition(vx mask) {
    return __builtin_convertvector(mask, vi);
}

SIMD_INLINE vx vx_select(vi mask, vx a, vx b) {
    const vx wide = vx_mask(mask);
    return (a & wide) | (b & ~wide);
}

SIMD_INLINE int64_t sx_select(int truth, int64_t a, int64_t b) {
    return truth ? a : b;
}

/* |x|, as an unsigned number. */
SIMD_INLINE vx vx_abs(vx x) {
    const vx negative = x >> 63;
    return vx_subtract(x ^ negative, negative);
}

SIMD_INLINE int64_t sx_abs(int64_t x) {
    return x < 0 ? sx_subtract(0, x) : x;
}

/* The product of more than 64 bits, `places` of them cut off below. */
SIMD_INLINE int64_t sx_multiply_wide(int64_t a, int a_unsigned, int64_t b, int b_unsigned,
                                     int places) {
    const unsigned __int128 product =
        (a_unsigned ? (unsigned __int128)(uint64_t)a : (unsigned __int128)(__int128)a) *
        (b_unsigned ? (unsigned __int128)(uint64_t)b : (unsigned __int128)(__int128)b);
    return a_unsigned && b_unsigned ? (int64_t)(product >> places)
                                    : (int64_t)((__int128)product >> places);
}

SIMD_INLINE __int128 sx_wide(int64_t x, int is_unsigned) {
    return is_unsigned ? (__int128)(uint64_t)x : (__int128)x;
}

/* floor(a * 2^places / b); 0 for b = 0. The compiler sees to it that a * 2^places fits 64 bits. */
SIMD_FUNCTION int64_t sx_divide(int64_t a, int a_unsigned, int64_t b, int b_unsigned, int places) {
    __int128 n = sx_wide(a, a_unsigned), d = sx_wide(b, b_unsigned);
    if (!d)
        return 0;
    if (d < 0) {
        n = -n;
        d = -d;
    }
    if (places >= 0)
        n = (__int128)((unsigned __int128)n << places);
    else
        n = places <= -127 ? (n < 0 ? -1 : 0) : n >> -places; /* floors one after the other */
    if (n == (int64_t)n && d == (int64_t)d) {
        const int64_t quotient = (int64_t)n / (int64_t)d;
        return quotient - (n < 0 && quotient * (int64_t)d != (int64_t)n);
    }
    const __int128 quotient = n / d;
    return (int64_t)(quotient - (n < 0 && quotient * d != n));
}

/* a * 2^a_places modulo b * 2^b_places, with the sign of b; 0 for b = 0. A negative number of
 * places rounds down first. */
SIMD_FUNCTION int64_t sx_remainder(int64_t a, int a_unsigned, int a_places, int64_t b,
                                   int b_unsigned, int b_places) {
    if (a_places < 0) {
        a = sx_shift(a, a_places, a_unsigned);
        a_places = 0;
    }
    const __int128 d = sx_wide(sx_shift(b, b_places, b_unsigned), b_unsigned);
    if (!d)
        return 0;
    __int128 rest = sx_wide(a, a_unsigned) % d;
    for (int i = 0; i < a_places; i++)
        rest = (rest + rest) % d;
    return (int64_t)(rest && (rest < 0) != (d < 0) ? rest + d : rest);
}

/* floor(sqrt(x * 2^places)); 0 for negative x. The root fits 64 bits: where `places` would move
 * bits out of 128, x is 0 or negative. */
SIMD_FUNCTION int64_t sx_sqrt(int64_t x, int is_unsigned, int places) {
    if (!x || (!is_unsigned && x < 0))
        return 0;
    const unsigned __int128 n = (unsigned __int128)(uint64_t)x << places;
    uint64_t root = 0;
    for (int bit = 63; bit >= 0; bit--) {
        const uint64_t more = root | (uint64_t)1 << bit;
        if ((unsigned __int128)more * more <= n)
            root = more;
    }
    return (int64_t)root;
}

#define SIMD_LANE_MULTIPLY_WIDE(x, i) sx_multiply_wide((x)[i], a_unsigned, b[i], b_unsigned, places)
#define SIMD_LANE_DIVIDE(x, i) sx_divide((x)[i], a_unsigned, b[i], b_unsigned, places)
#define SIMD_LANE_REMAINDER(x, i)                                                                  \
    sx_remainder((x)[i], a_unsigned, a_places, b[i], b_unsigned, b_places)
#define SIMD_LANE_ROOT(x, i) sx_sqrt((x)[i], is_unsigned, places)
#define SIMD_LANE_DOUBLE_SQRT(x, i) __builtin_sqrt((x)[i])

SIMD_FUNCTION vx vx_multiply_wide(vx a, int a_unsigned, vx b, int b_unsigned, int places) {
    return (vx){SIMD_EACH(SIMD_LANE_MULTIPLY_WIDE, a)};
}

/* floor(n / d) of numbers below 2^52 in magnitude: a quotient in double precision is less than
 * half of 1 / d away, too little to reach the next whole number. */
SIMD_INLINE vx vx_divide_doubles(vx n, vx d) {
    const vx is_zero = (vx)(d == 0);
    d |= is_zero & 1;
    const vx quotient = __builtin_convertvector(
        __builtin_convertvector(n, simd_doubles) / __builtin_convertvector(d, simd_doubles), vx);
    const vx rest = n - quotient * d;
    const vx is_above = (vx)(rest != 0) & (vx)((rest ^ d) < 0);
    return (quotient + is_above) & ~is_zero;
}

/* No instruction set divides vectors of integers: small ones go through doubles. `bits`: of the
 * shifted dividend and of the divisor, whichever is more. */
SIMD_FUNCTION vx vx_divide(vx a, int a_unsigned, vx b, int b_unsigned, int places, int bits) {
    if (bits <= 52 && places >= 0)
        return vx_divide_doubles(vx_shift(a, places, a_unsigned), b);
    return (vx){SIMD_EACH(SIMD_LANE_DIVIDE, a)};
}

SIMD_FUNCTION vx vx_remainder(vx a, int a_unsigned, int a_places, vx b, int b_unsigned,
                              int b_places, int bits) {
    if (bits <= 52) {
        a = vx_shift(a, a_places, a_unsigned);
        b = vx_shift(b, b_places, b_unsigned);
        return (a - vx_divide_doubles(a, b) * b) & (vx)(b != 0);
    }
    return (vx){SIMD_EACH(SIMD_LANE_REMAINDER, a)};
}

SIMD_FUNCTION vx vx_sqrt(vx x, int is_unsigned, int places, int bits) {
    if (bits <= 52) {
        const vx n = vx_shift(x, places, is_unsigned) & ~(x >> 63);
        const simd_doubles square = __builtin_convertvector(n, simd_doubles);
        return __builtin_convertvector(((simd_doubles){SIMD_EACH(SIMD_LANE_DOUBLE_SQRT, square)}),
                                       vx);
    }
    return (vx){SIMD_EACH(SIMD_LANE_ROOT, x)};
}

/* 2^n, exactly. */
SIMD_INLINE double simd_power_of_two(int n) {
    const union {
        uint64_t bits;
        double number;
    } power = {(uint64_t)(n + 1023) << 52};
    return power.number;
}

SIMD_INLINE int64_t sx_largest(int size, int is_unsigned) {
    const int bits = size - !is_unsigned;
    return bits ? (int64_t)(~(uint64_t)0 >> (64 - bits)) : 0;
}

/* floor(x * 2^exponent), or the nearest end of the format; not a number is 0. */
SIMD_INLINE vx vx_from_float(vf x, int exponent, int size, int is_unsigned) {
    const simd_doubles y = __builtin_convertvector(x, simd_doubles) * simd_power_of_two(exponent);
    const double low = is_unsigned ? 0.0 : -simd_power_of_two(size - 1),
                 high = simd_power_of_two(is_unsigned ? size : size - 1);
    const vx is_inside = (vx)(y >= low) & (vx)(y < high), is_above = (vx)(y >= high),
             is_below = (vx)(y < low);
    /* the upper half of 64 unsigned bits is beyond what a conversion gives */
    const vx is_far = (vx)(y >= 0x1p63) & is_inside;
    const simd_doubles near =
        (simd_doubles)(((vx)y & is_inside & ~is_far) | ((vx)(y - 0x1p63) & is_far));
    const vx cut = __builtin_convertvector(near, vx);
    const vx down = cut + (vx)(__builtin_convertvector(cut, simd_doubles) > near);
    return (down ^ (is_far & INT64_MIN)) | (is_above & sx_largest(size, is_unsigned)) |
           (is_below & (is_unsigned ? 0 : INT64_MIN >> (64 - size)));
}

SIMD_INLINE int64_t sx_from_float(float x, int exponent, int size, int is_unsigned) {
    const double y = (double)x * simd_power_of_two(exponent);
    const double low = is_unsigned ? 0.0 : -simd_power_of_two(size - 1),
                 high = simd_power_of_two(is_unsigned ? size : size - 1);
    if (y >= high)
        return sx_largest(size, is_unsigned);
    if (y < low)
        return is_unsigned ? 0 : INT64_MIN >> (64 - size);
    if (!(y >= low))
        return 0;
    if (y >= 0x1p63)
        return (int64_t)(uint64_t)y;
    const int64_t cut = (int64_t)y;
    return cut - ((double)cut > y);
}

/* The nearest float (ties to even). What takes more than 53 bits is rounded to odd first, which
 * leaves the last rounding to the conversion alone; what takes less is exact in double precision.
 */
SIMD_INLINE vf vx_to_float(vx x, int exponent, int size, int is_unsigned) {
    if (size <= 53)
        return __builtin_convertvector(
            __builtin_convertvector(x, simd_doubles) * simd_power_of_two(-exponent), vf);
    const vx high = vx_shift(x, -53, is_unsigned);
    const vx is_long = is_unsigned ? (vx)(high != 0) : (vx)(high != (x >> 63));
    const vx odd = vx_shift(x, -11, is_unsigned) | ((vx)((x & 0x7ff) != 0) & 1);
    const simd_doubles exact = __builtin_convertvector(x & ~is_long, simd_doubles),
                       rounded = __builtin_convertvector(odd & is_long, simd_doubles);
    return __builtin_convertvector((exact + rounded * 0x1p11) * simd_power_of_two(-exponent), vf);
}

SIMD_INLINE float sx_to_float(int64_t x, int exponent, int size, int is_unsigned) {
    const int64_t high = sx_shift(x, -53, is_unsigned);
    if (size <= 53 || high == (is_unsigned ? 0 : x >> 63))
        return (float)((double)x * simd_power_of_two(-exponent));
    const int64_t odd = sx_shift(x, -11, is_unsigned) | ((x & 0x7ff) != 0);
    return (float)((double)odd * simd_power_of_two(11 - exponent));
}

/* RSL's noise of three coordinates with the same exponent, 0 to 22; 14 bits after the point. Cells
 * repeat after 256, so that 32 bits of a coordinate are enough. */
SIMD_FUNCTION vx vx_noise(vx x, vx y, vx z, int exponent) {
    return __builtin_convertvector(
        vi_fixed_noise3(vx_condition(x), vx_condition(y), vx_condition(z), exponent), vx);
}

SIMD_FUNCTION int64_t sx_noise(int64_t x, int64_t y, int64_t z, int exponent) {
    return vx_noise(vx_set(x), vx_set(y), vx_set(z), exponent)[0];
}

#endif
