/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_FIXED_NOISE_H
#define VECTOR_FIXED_NOISE_H

/* Perlin's noise in 16-bit fixed point (PF section 3.1, table 2), from raw coordinates whose value
 * is raw * 2^-exponent. Integers only, so that every width gives the same bits. Inner products are
 * rounded to the nearest, halves upwards (ours). */

#ifdef SHADER_REFERENCE
#include "vector_double.h"
#else
#include "vector_noise.h"
#endif

/* Bits after the point of fractions, weights and results. */
#define SIMD_FIXED_NOISE_EXPONENT 14

/* Splits a number of `exponent` bits after the point (0 to 30) into its lattice cell modulo 256 and
 * the fraction, rounded to 14 bits. */
SIMD_INLINE vi vi_fixed_cell(vi raw, int exponent, vi *cell) {
    *cell = (raw >> exponent) & 255;
    vi fraction = raw & (int32_t)(((uint32_t)1 << exponent) - 1);
    if (exponent <= SIMD_FIXED_NOISE_EXPONENT)
        return fraction << (SIMD_FIXED_NOISE_EXPONENT - exponent);
    const int drop = exponent - SIMD_FIXED_NOISE_EXPONENT;
    return (fraction + (1 << (drop - 1))) >> drop;
}

SIMD_INLINE vi vi_fixed_multiply(vi a, vi b) {
    return (a * b + (1 << (SIMD_FIXED_NOISE_EXPONENT - 1))) >> SIMD_FIXED_NOISE_EXPONENT;
}

/* vf_fade, exactly 0 at 0 and 1 at 1. */
SIMD_INLINE vi vi_fixed_fade(vi t) {
    const int one = 1 << SIMD_FIXED_NOISE_EXPONENT;
    vi c = t - one / 2, c2 = vi_fixed_multiply(c, c);
    return one / 2 + vi_fixed_multiply(c, 15 * one / 8 + vi_fixed_multiply(c2, 6 * c2 - 5 * one));
}

SIMD_INLINE vi vi_fixed_lerp(vi weight, vi a, vi b) {
    return a + vi_fixed_multiply(weight, b - a);
}

/* As vf_gradient; nothing is rounded. */
SIMD_INLINE vi vi_fixed_gradient(vi hash, int shift, vi x, vi y, vi z) {
    vi h = hash >> shift, bit3 = -((h >> 3) & 1), bit2 = -((h >> 2) & 1);
    vi bit1 = -((h >> 1) & 1), bit0 = -(h & 1);
    vi u = vi_select(bit3, y, x);
    vi v = vi_select(bit3 | bit2, vi_select(bit3 & bit2 & ~bit0, x, z), y);
    return ((u ^ bit0) - bit0) + ((v ^ bit1) - bit1);
}

SIMD_INLINE vi vi_fixed_edge(const vi h[4], int corner, int far, vi x, vi y, vi z, vi u) {
    vi start = vi_fixed_gradient(h[simd_corner_vector(corner, far)], simd_corner_shift(corner, far),
                                 x, y, z);
    vi end = vi_fixed_gradient(h[simd_corner_vector(corner + 1, far)],
                               simd_corner_shift(corner + 1, far),
                               x - (1 << SIMD_FIXED_NOISE_EXPONENT), y, z);
    return vi_fixed_lerp(u, start, end);
}

/* Perlin's noise of coordinates with `exponent` bits after the point (0 to 30): 14 bits after the
 * point, within 2^-12 of vf_snoise3 where the coordinates have at most 14 of them. Period 256. */
SIMD_FUNCTION vi vi_fixed_snoise3(vi x, vi y, vi z, int exponent) {
    const int one = 1 << SIMD_FIXED_NOISE_EXPONENT;
    vi i, j, k, h[4];
    x = vi_fixed_cell(x, exponent, &i);
    y = vi_fixed_cell(y, exponent, &j);
    z = vi_fixed_cell(z, exponent, &k);
    vi u = vi_fixed_fade(x), v = vi_fixed_fade(y), w = vi_fixed_fade(z);
    vi_corner_hashes(i, j, k, h);
    vi near = vi_fixed_lerp(v, vi_fixed_edge(h, 0, 0, x, y, z, u),
                            vi_fixed_edge(h, 2, 0, x, y - one, z, u));
    vi far = vi_fixed_lerp(v, vi_fixed_edge(h, 0, 1, x, y, z - one, u),
                           vi_fixed_edge(h, 2, 1, x, y - one, z - one, u));
    return vi_fixed_lerp(w, near, far);
}

/* RSL's noise, 0 to 1 with 14 bits after the point. */
SIMD_FUNCTION vi vi_fixed_noise3(vi x, vi y, vi z, int exponent) {
    const int one = 1 << SIMD_FIXED_NOISE_EXPONENT;
    vi value = (vi_fixed_snoise3(x, y, z, exponent) + one + 1) >> 1;
    value &= (vi)(value > 0);
    return vi_select((vi)(value > one), vi_set(one), value);
}

SIMD_FUNCTION vi vi_fixed_noise2(vi x, vi y, int exponent) {
    return vi_fixed_noise3(x, y, vi_set(0), exponent);
}

SIMD_FUNCTION vi vi_fixed_noise1(vi x, int exponent) {
    return vi_fixed_noise3(x, vi_set(0), vi_set(0), exponent);
}

#endif
