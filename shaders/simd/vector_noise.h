/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_NOISE_H
#define VECTOR_NOISE_H

/* Perlin's improved noise (2002), n in about [-1.04, 1.04], and RSL's noise = (1 + n) / 2, clamped
 * to [0, 1]. One and two dimensions are the three-dimensional function on the axis y = z = 0 and
 * the plane z = 0, computed with the corners that count. Period 256 exactly in every coordinate:
 * the fraction is taken before wrapping. Within 1e-6 of the same function in double precision for
 * |coordinate| <= 1e4. NaN or Inf in any coordinate gives NaN. */

#include "vector_permutation.h"
#include "vector_types.h"

/* ---- hashes of lattice corners ----
 * Corner c = 0..3 of a cell is (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1); its hashes p[p[p[i]
 * + j] + k] and the one for k + 1 are bytes of the vectors h: see simd_corner_vector and
 * simd_corner_shift. Integers only: each way of looking them up gives the same. */

#if defined(__AVX512VBMI__) && SHADER_WIDTH == 16
/* Four corners to a lane; k in h[0], k + 1 in h[1]. The table is four registers. */
#define simd_corner_vector(corner, far) (far)
#define simd_corner_shift(corner, far) (8 * (corner))
typedef uint8_t simd_bytes __attribute__((vector_size(64)));

SIMD_INLINE vi vi_permute_bytes(vi x) {
    const simd_bytes *table = (const simd_bytes *)(const void *)simd_permutation;
    simd_bytes index = (simd_bytes)x;
#ifdef __clang__
    typedef char bytes __attribute__((vector_size(64)));
    bytes low = __builtin_ia32_vpermi2varqi512((bytes)table[0], (bytes)index, (bytes)table[1]);
    bytes high = __builtin_ia32_vpermi2varqi512((bytes)table[2], (bytes)index, (bytes)table[3]);
#else
    simd_bytes low = __builtin_shuffle(table[0], table[1], index);
    simd_bytes high = __builtin_shuffle(table[2], table[3], index);
#endif
    simd_bytes upper = (simd_bytes)(index > 127);
    return (vi)(((simd_bytes)low & ~upper) | ((simd_bytes)high & upper));
}

SIMD_INLINE vi vi_add_bytes(vi a, vi b) {
    return (vi)((simd_bytes)a + (simd_bytes)b);
}

/* The low byte of each lane in all four. */
SIMD_INLINE vi vi_spread_byte(vi x) {
    return (vi)(((vu)x & 0xff) * 0x01010101u);
}

SIMD_INLINE void vi_corner_hashes(vi i, vi j, vi k, vi h[4]) {
    vi first = vi_permute_bytes(vi_add_bytes(vi_spread_byte(i), vi_set(0x01000100)));
    first = vi_add_bytes(first, vi_set(0x01010000));
    vi second = vi_permute_bytes(vi_add_bytes(first, vi_spread_byte(j)));
    vi third = vi_add_bytes(second, vi_spread_byte(k));
    h[0] = vi_permute_bytes(third);
    h[1] = vi_permute_bytes(vi_add_bytes(third, vi_set(0x01010101)));
}
#else
/* One corner to a vector; k in the low byte, k + 1 in the next one. */
#define simd_corner_vector(corner, far) (corner)
#define simd_corner_shift(corner, far) (8 * (far))

#if defined(__AVX2__) && SHADER_WIDTH >= 8
#if SHADER_WIDTH == 16 && defined(__AVX512F__)
#define SIMD_GATHER(table, index)                                                                  \
    (vi) __builtin_ia32_gathersiv16si(vi_set(0), table, index, (short)-1, 1)
#elif SHADER_WIDTH == 8 && defined(__clang__)
#define SIMD_GATHER(table, index)                                                                  \
    (vi) __builtin_ia32_gatherd_d256(vi_set(0), table, index, vi_set(-1), 1)
#elif SHADER_WIDTH == 8
#define SIMD_GATHER(table, index)                                                                  \
    (vi) __builtin_ia32_gathersiv8si(vi_set(0), table, index, vi_set(-1), 1)
#endif
#endif

#ifdef SIMD_GATHER
/* p[i], p[i + 1] and two more in the four bytes of each lane */
SIMD_INLINE vu vu_permute_pair(vu i) {
    return (vu)SIMD_GATHER((const int *)(const void *)simd_permutation, (vi)(i & 0xff));
}

SIMD_INLINE void vi_corner_hashes(vi i, vi j, vi k, vi h[4]) {
    vu first = vu_permute_pair((vu)i);
    vu a = vu_permute_pair(first + (vu)j), b = vu_permute_pair((first >> 8) + (vu)j);
    h[0] = (vi)vu_permute_pair(a + (vu)k);
    h[1] = (vi)vu_permute_pair(b + (vu)k);
    h[2] = (vi)vu_permute_pair((a >> 8) + (vu)k);
    h[3] = (vi)vu_permute_pair((b >> 8) + (vu)k);
}
#else
SIMD_INLINE uint32_t simd_permute_pair(uint32_t i) {
    uint16_t pair;
    __builtin_memcpy(&pair, simd_permutation + (uint8_t)i, sizeof pair);
    return pair;
}

SIMD_INLINE void vi_corner_hashes(vi i, vi j, vi k, vi h[4]) {
    uint32_t cell[3][SHADER_WIDTH], hash[4][SHADER_WIDTH];
    __builtin_memcpy(cell[0], &i, sizeof i);
    __builtin_memcpy(cell[1], &j, sizeof j);
    __builtin_memcpy(cell[2], &k, sizeof k);
#pragma GCC unroll 16
    for (int lane = 0; lane < SHADER_WIDTH; lane++) {
        uint32_t first = simd_permute_pair(cell[0][lane]);
        uint32_t a = simd_permute_pair(first + cell[1][lane]);
        uint32_t b = simd_permute_pair((first >> 8) + cell[1][lane]);
        hash[0][lane] = simd_permute_pair(a + cell[2][lane]);
        hash[1][lane] = simd_permute_pair(b + cell[2][lane]);
        hash[2][lane] = simd_permute_pair((a >> 8) + cell[2][lane]);
        hash[3][lane] = simd_permute_pair((b >> 8) + cell[2][lane]);
    }
    __builtin_memcpy(h, hash, sizeof hash);
}
#endif
#endif

/* ---- cells, weights, gradients ---- */

/* Whole numbers towards zero; beyond 32 bits and for NaN INT32_MIN, as the processor does it. */
#if defined(SHADER_REFERENCE) || !defined(__SSE2__)
#elif SHADER_WIDTH == 4
#define SIMD_TRUNCATE(x) (vi) __builtin_ia32_cvttps2dq(x)
#elif SHADER_WIDTH == 8 && defined(__AVX__)
#define SIMD_TRUNCATE(x) (vi) __builtin_ia32_cvttps2dq256(x)
#elif SHADER_WIDTH == 16 && defined(__AVX512F__)
#define SIMD_TRUNCATE(x) (vi) __builtin_ia32_cvttps2dq512_mask(x, vi_set(0), (short)-1, 4)
#endif

/* Splits x into its lattice cell modulo 256 and the fraction (NaN for infinities). From 2^31 on all
 * numbers are multiples of 256. */
SIMD_INLINE vf vf_cell(vf x, vi *cell) {
#if defined(SIMD_TRUNCATE) && !defined(SIMD_ROUND)
    vi whole = SIMD_TRUNCATE(x), is_small = (vi)(vf_abs(x) < 0x1p31f);
    vf near = __builtin_convertvector(whole, vf);
    vi is_above = (vi)(near > x) & is_small;
    *cell = (whole + is_above) & 255;
    vf down = vf_select(is_small, near - (vf)(is_above & (vi)vf_set(1.0f)), x);
#elif defined(SIMD_TRUNCATE)
    vf down = vf_floor(x);
    *cell = SIMD_TRUNCATE(down) & 255;
#else
    vf down = vf_floor(x);
    vf wrapped = down - 256.0f * vf_floor(down * 0x1p-8f);
    wrapped = (vf)((vi)wrapped & (vi)(wrapped < 256.0f)); /* NaN: cell 0 */
    *cell = __builtin_convertvector(wrapped, vi);
#endif
    return x - down;
}

/* 6 t^5 - 15 t^4 + 10 t^3 around its middle, where it loses no digits: exactly 0 at 0 and 1 at 1.
 */
SIMD_INLINE vf vf_fade(vf t) {
    vf c = t - 0.5f, c2 = c * c;
    return 0.5f + c * (1.875f + c2 * (6.0f * c2 - 5.0f));
}

SIMD_INLINE vf vf_lerp(vf t, vf a, vf b) {
    return a + t * (b - a);
}

/* Perlin's gradient times (x, y, z): one of 12 directions to the middles of a cube's edges, chosen
 * by the four bits of the hash from bit `shift` up. Every way of computing it rounds once. */
#if defined(__AVX512F__) && SHADER_WIDTH == 16
SIMD_INLINE vf vf_lookup_16(vf table, vi index) {
#ifdef __clang__
    return (vf)__builtin_ia32_permvarsf512(table, index);
#else
    return __builtin_shuffle(table, index);
#endif
}

SIMD_INLINE vf vf_gradient(vi hash, int shift, vf x, vf y, vf z) {
    const vf along_x = {1, -1, 1, -1, 1, -1, 1, -1, 0, 0, 0, 0, 1, 0, -1, 0};
    const vf along_y = {1, 1, -1, -1, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1};
    const vf along_z = {0, 0, 0, 0, 1, 1, -1, -1, 1, 1, -1, -1, 0, 1, 0, -1};
    hash = hash >> shift;
    return vf_lookup_16(along_x, hash) * x + vf_lookup_16(along_y, hash) * y +
           vf_lookup_16(along_z, hash) * z;
}
#else
/* a where the sign bit of `bits` is set, else b */
SIMD_INLINE vf vf_choose(vi bits, vf a, vf b) {
#if defined(__AVX__) && SHADER_WIDTH == 8
    return (vf)__builtin_ia32_blendvps256(b, a, (vf)bits);
#else
    return (vf)((vi)b ^ (((vi)a ^ (vi)b) & (bits >> 31)));
#endif
}

SIMD_INLINE vf vf_gradient(vi hash, int shift, vf x, vf y, vf z) {
    vi bit3 = hash << (28 - shift), bit2 = hash << (29 - shift);
    vi bit1 = hash << (30 - shift), bit0 = hash << (31 - shift);
    vf u = vf_choose(bit3, y, x);
    vf v = vf_choose(bit3 | bit2, vf_choose(bit3 & bit2 & ~bit0, x, z), y);
    u = (vf)((vi)u ^ (bit0 & (int32_t)0x80000000));
    v = (vf)((vi)v ^ (bit1 & (int32_t)0x80000000));
    return u + v;
}
#endif

/* Between two corners along x. */
SIMD_INLINE vf vf_noise_edge(const vi h[4], int corner, int far, vf x, vf y, vf z, vf u) {
    vf start =
        vf_gradient(h[simd_corner_vector(corner, far)], simd_corner_shift(corner, far), x, y, z);
    vf end = vf_gradient(h[simd_corner_vector(corner + 1, far)], simd_corner_shift(corner + 1, far),
                         x - 1.0f, y, z);
    return vf_lerp(u, start, end);
}

SIMD_INLINE vf vf_noise_face(const vi h[4], int far, vf x, vf y, vf z, vf u, vf v) {
    return vf_lerp(v, vf_noise_edge(h, 0, far, x, y, z, u),
                   vf_noise_edge(h, 2, far, x, y - 1.0f, z, u));
}

/* The noise at fractions x, y, z in cell (i, j, k), with weights u, v, w. */
SIMD_INLINE vf vf_noise_in_cell(vi i, vi j, vi k, vf x, vf y, vf z, vf u, vf v, vf w) {
    vi h[4];
    vi_corner_hashes(i, j, k, h);
    return vf_lerp(w, vf_noise_face(h, 0, x, y, z, u, v),
                   vf_noise_face(h, 1, x, y, z - 1.0f, u, v));
}

SIMD_INLINE vf vf_noise_in_square(vi i, vi j, vi k, vf x, vf y, vf u, vf v) {
    vi h[4];
    vi_corner_hashes(i, j, k, h);
    return vf_noise_face(h, 0, x, y, vf_set(0.0f), u, v);
}

SIMD_INLINE vf vf_noise_in_segment(vi i, vi j, vi k, vf x, vf u) {
    vi h[4];
    vi_corner_hashes(i, j, k, h);
    return vf_noise_edge(h, 0, 0, x, vf_set(0.0f), vf_set(0.0f), u);
}

/* n to RSL's range */
SIMD_INLINE vf vf_noise_range(vf n) {
    vf value = vf_max(vf_set(0.0f), 0.5f + 0.5f * n);
    return vf_canonical(vf_min(vf_set(1.0f), value));
}

/* How far apart in the lattice the three components of vector noise are, along each axis. */
#define SIMD_NOISE_OFFSET 85

/* Signed noise; +0 rather than -0. */
SIMD_FUNCTION vf vf_snoise3(vf x, vf y, vf z) {
    vi i, j, k;
    vf fx = vf_cell(x, &i), fy = vf_cell(y, &j), fz = vf_cell(z, &k);
    vf n = vf_noise_in_cell(i, j, k, fx, fy, fz, vf_fade(fx), vf_fade(fy), vf_fade(fz));
    return vf_canonical(n + 0.0f);
}

SIMD_FUNCTION vf vf_noise3(vf x, vf y, vf z) {
    return vf_noise_range(vf_snoise3(x, y, z));
}

SIMD_FUNCTION vf vf_noise2(vf x, vf y) {
    vi i, j;
    vf fx = vf_cell(x, &i), fy = vf_cell(y, &j);
    return vf_noise_range(vf_noise_in_square(i, j, vi_set(0), fx, fy, vf_fade(fx), vf_fade(fy)));
}

SIMD_FUNCTION vf vf_noise1(vf x) {
    vi i;
    vf fx = vf_cell(x, &i);
    return vf_noise_range(vf_noise_in_segment(i, vi_set(0), vi_set(0), fx, vf_fade(fx)));
}

/* Three components: component c is the scalar noise with 85 c added to every lattice coordinate, so
 * that they share cell, fraction and weights. */
SIMD_FUNCTION void vf_noise3_3(vf x, vf y, vf z, vf out[3]) {
    vi i, j, k;
    vf fx = vf_cell(x, &i), fy = vf_cell(y, &j), fz = vf_cell(z, &k);
    vf u = vf_fade(fx), v = vf_fade(fy), w = vf_fade(fz);
    for (int c = 0; c < 3; c++) {
        int32_t offset = c * SIMD_NOISE_OFFSET;
        out[c] = vf_noise_range(
            vf_noise_in_cell(i + offset, j + offset, k + offset, fx, fy, fz, u, v, w));
    }
}

SIMD_FUNCTION void vf_noise2_3(vf x, vf y, vf out[3]) {
    vi i, j;
    vf fx = vf_cell(x, &i), fy = vf_cell(y, &j);
    vf u = vf_fade(fx), v = vf_fade(fy);
    for (int c = 0; c < 3; c++) {
        int32_t offset = c * SIMD_NOISE_OFFSET;
        vf n = vf_noise_in_square(i + offset, j + offset, vi_set(offset), fx, fy, u, v);
        out[c] = vf_noise_range(n);
    }
}

SIMD_FUNCTION void vf_noise1_3(vf x, vf out[3]) {
    vi i;
    vf fx = vf_cell(x, &i);
    vf u = vf_fade(fx);
    for (int c = 0; c < 3; c++) {
        vi offset = vi_set(c * SIMD_NOISE_OFFSET);
        out[c] = vf_noise_range(vf_noise_in_segment(i + offset, offset, offset, fx, u));
    }
}

#endif
