/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_LATTICE_H
#define VECTOR_LATTICE_H

/* Cell noise, gradient noise in four dimensions, gradient noise with a period, and random numbers.
 * Lattice points are hashed with integer arithmetic (the mixing steps of MurmurHash3), so that
 * every width gives the same bits. Values are in [0, 1]; cell noise and random numbers are
 * multiples of 2^-24 below 1. */

#include "vector_noise.h"

SIMD_INLINE vu vu_mix(vu hash, vu key) {
    key *= 0xcc9e2d51u;
    key = (key << 15) | (key >> 17);
    hash ^= key * 0x1b873593u;
    hash = (hash << 13) | (hash >> 19);
    return hash * 5u + 0xe6546b64u;
}

SIMD_INLINE vu vu_finish(vu hash) {
    hash = (hash ^ (hash >> 16)) * 0x85ebca6bu;
    hash = (hash ^ (hash >> 13)) * 0xc2b2ae35u;
    return hash ^ (hash >> 16);
}

SIMD_INLINE vf vf_hash_value(vu hash) {
    return __builtin_convertvector((vi)(hash >> 8), vf) * 0x1p-24f;
}

/* The cell of x modulo 65536 (NaN and infinities: 0) and the fraction. */
SIMD_INLINE vf vf_wide_cell(vf x, vi *cell) {
    vf down = vf_floor(x);
    vf wrapped = down - 65536.0f * vf_floor(down * 0x1p-16f);
    wrapped = (vf)((vi)wrapped & (vi)(wrapped < 65536.0f));
    *cell = __builtin_convertvector(wrapped, vi);
    return x - down;
}

/* The cell of x modulo a period of whole cells, at least 1 and at most 65536, and the next cell. */
SIMD_INLINE vf vf_periodic_cell(vf x, vf period, vi *near, vi *far) {
    vf down = vf_floor(x);
    period = vf_min(vf_max(vf_floor(period), vf_set(1.0f)), vf_set(65536.0f));
    vf wrapped = down - period * vf_floor(down / period);
    wrapped += (vf)((vi)period & (vi)(wrapped < 0.0f)); /* the quotient may have been rounded */
    wrapped -= (vf)((vi)period & (vi)(wrapped >= period));
    wrapped = (vf)((vi)wrapped & (vi)(wrapped >= 0.0f) & (vi)(wrapped < period));
    vf next = wrapped + 1.0f;
    next = (vf)((vi)next & (vi)(next < period));
    *near = __builtin_convertvector(wrapped, vi);
    *far = __builtin_convertvector(next, vi);
    return x - down;
}

/* One of the 32 directions to the middles of the edges of a hypercube, times (x, y, z, t). */
SIMD_INLINE vf vf_gradient4(vi hash, vf x, vf y, vf z, vf t) {
    vi h = hash & 31;
    vf u = vf_select((vi)(h < 24), x, y), v = vf_select((vi)(h < 16), y, z);
    vf w = vf_select((vi)(h < 8), z, t);
    u = (vf)((vi)u ^ (vi)((vu)h << 31));
    v = (vf)((vi)v ^ (vi)((vu)(h & 2) << 30));
    w = (vf)((vi)w ^ (vi)((vu)(h & 4) << 29));
    return u + v + w;
}

/* Noise between the lattice points near[d] and far[d]; `dimensions` is 3 or 4. */
SIMD_INLINE vf vf_lattice_noise(const vi near[4], const vi far[4], const vf f[4], int dimensions,
                                uint32_t seed) {
    vu hash[16];
    vf value[16];
    hash[0] = (vu)vi_set((int32_t)seed);
    for (int d = 0; d < dimensions; d++)
        for (int c = 0; c < 1 << d; c++) {
            hash[c + (1 << d)] = vu_mix(hash[c], (vu)far[d]);
            hash[c] = vu_mix(hash[c], (vu)near[d]);
        }
    for (int c = 0; c < 1 << dimensions; c++) {
        vi h = (vi)vu_finish(hash[c]);
        vf x = f[0] - (float)(c & 1), y = f[1] - (float)(c >> 1 & 1),
           z = f[2] - (float)(c >> 2 & 1);
        value[c] = dimensions == 4 ? vf_gradient4(h, x, y, z, f[3] - (float)(c >> 3))
                                   : vf_gradient(h, 0, x, y, z);
    }
    for (int d = 0; d < dimensions; d++) {
        vf weight = vf_fade(f[d]);
        for (int c = 0; c < 1 << (dimensions - 1 - d); c++)
            value[c] = vf_lerp(weight, value[2 * c], value[2 * c + 1]);
    }
    return vf_noise_range(dimensions == 4 ? 0.87f * value[0] : value[0]);
}

/* One value for each cell of the lattice. Component c of the form with three starts from seed c. */
SIMD_FUNCTION void vf_cellnoise_some(vf x, vf y, vf z, vf t, vf *out, int count) {
    const vf at[4] = {x, y, z, t};
    vi cell[4];
    for (int d = 0; d < 4; d++)
        vf_wide_cell(at[d], &cell[d]);
    for (int c = 0; c < count; c++) {
        vu hash = (vu)vi_set(c);
        for (int d = 0; d < 4; d++)
            hash = vu_mix(hash, (vu)cell[d]);
        out[c] = vf_hash_value(vu_finish(hash));
    }
}

/* Period 65536 in every coordinate. */
SIMD_FUNCTION void vf_noise4_some(vf x, vf y, vf z, vf t, vf *out, int count) {
    const vf at[4] = {x, y, z, t};
    vi near[4], far[4];
    vf f[4];
    for (int d = 0; d < 4; d++) {
        f[d] = vf_wide_cell(at[d], &near[d]);
        far[d] = (near[d] + 1) & 65535;
    }
    for (int c = 0; c < count; c++)
        out[c] = vf_lattice_noise(near, far, f, 4, (uint32_t)c);
}

SIMD_FUNCTION void vf_pnoise3_some(vf x, vf y, vf z, vf px, vf py, vf pz, vf *out, int count) {
    const vf at[3] = {x, y, z}, period[3] = {px, py, pz};
    vi near[4], far[4];
    vf f[4];
    for (int d = 0; d < 3; d++)
        f[d] = vf_periodic_cell(at[d], period[d], &near[d], &far[d]);
    for (int c = 0; c < count; c++)
        out[c] = vf_lattice_noise(near, far, f, 3, (uint32_t)c);
}

SIMD_FUNCTION void vf_pnoise4_some(vf x, vf y, vf z, vf t, vf px, vf py, vf pz, vf pt, vf *out,
                                   int count) {
    const vf at[4] = {x, y, z, t}, period[4] = {px, py, pz, pt};
    vi near[4], far[4];
    vf f[4];
    for (int d = 0; d < 4; d++)
        f[d] = vf_periodic_cell(at[d], period[d], &near[d], &far[d]);
    for (int c = 0; c < count; c++)
        out[c] = vf_lattice_noise(near, far, f, 4, (uint32_t)c);
}

/* Call number n at a place; the bits of the coordinates count. */
SIMD_FUNCTION vf vf_random(vf x, vf y, vf z, vf n) {
    vu hash = vu_mix(vu_mix((vu)vi_set(0x72616e64), (vu)(vi)x), (vu)(vi)y);
    hash = vu_mix(vu_mix(hash, (vu)(vi)z), (vu)(vi)n);
    return vf_hash_value(vu_finish(hash));
}

/* The forms that compiled code calls, for vectors and for uniform values. */
#define LATTICE_FUNCTION(name, parameters, scalars, arguments, vectors)                            \
    SIMD_FUNCTION vf vf_##name parameters {                                                        \
        vf out[1];                                                                                 \
        vf_##name##_some(SIMD_UNWRAP arguments, out, 1);                                           \
        return out[0];                                                                             \
    }                                                                                              \
    SIMD_FUNCTION float sf_##name scalars {                                                        \
        return vf_##name vectors[0];                                                               \
    }
#define SIMD_UNWRAP(...) __VA_ARGS__
LATTICE_FUNCTION(cellnoise, (vf x, vf y, vf z, vf t), (float x, float y, float z, float t),
                 (x, y, z, t), (vf_set(x), vf_set(y), vf_set(z), vf_set(t)))
LATTICE_FUNCTION(noise4, (vf x, vf y, vf z, vf t), (float x, float y, float z, float t),
                 (x, y, z, t), (vf_set(x), vf_set(y), vf_set(z), vf_set(t)))
LATTICE_FUNCTION(pnoise3, (vf x, vf y, vf z, vf a, vf b, vf c),
                 (float x, float y, float z, float a, float b, float c), (x, y, z, a, b, c),
                 (vf_set(x), vf_set(y), vf_set(z), vf_set(a), vf_set(b), vf_set(c)))
LATTICE_FUNCTION(pnoise4, (vf x, vf y, vf z, vf t, vf a, vf b, vf c, vf d),
                 (float x, float y, float z, float t, float a, float b, float c, float d),
                 (x, y, z, t, a, b, c, d),
                 (vf_set(x), vf_set(y), vf_set(z), vf_set(t), vf_set(a), vf_set(b), vf_set(c),
                  vf_set(d)))
#undef LATTICE_FUNCTION

SIMD_FUNCTION float sf_random(float x, float y, float z, float n) {
    return vf_random(vf_set(x), vf_set(y), vf_set(z), vf_set(n))[0];
}

SIMD_INLINE void simd_first_lanes(const vf value[3], float out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = value[c][0];
}

#define vf_cellnoise_3(x, y, z, t, out) vf_cellnoise_some(x, y, z, t, out, 3)
#define vf_noise4_3(x, y, z, t, out) vf_noise4_some(x, y, z, t, out, 3)
#define vf_pnoise3_3(x, y, z, a, b, c, out) vf_pnoise3_some(x, y, z, a, b, c, out, 3)
#define vf_pnoise4_3(x, y, z, t, a, b, c, d, out) vf_pnoise4_some(x, y, z, t, a, b, c, d, out, 3)

SIMD_FUNCTION void sf_cellnoise_3(float x, float y, float z, float t, float out[3]) {
    vf value[3];
    vf_cellnoise_3(vf_set(x), vf_set(y), vf_set(z), vf_set(t), value);
    simd_first_lanes(value, out);
}

SIMD_FUNCTION void sf_noise4_3(float x, float y, float z, float t, float out[3]) {
    vf value[3];
    vf_noise4_3(vf_set(x), vf_set(y), vf_set(z), vf_set(t), value);
    simd_first_lanes(value, out);
}

SIMD_FUNCTION void sf_pnoise3_3(float x, float y, float z, float a, float b, float c,
                                float out[3]) {
    vf value[3];
    vf_pnoise3_3(vf_set(x), vf_set(y), vf_set(z), vf_set(a), vf_set(b), vf_set(c), value);
    simd_first_lanes(value, out);
}

SIMD_FUNCTION void sf_pnoise4_3(float x, float y, float z, float t, float a, float b, float c,
                                float d, float out[3]) {
    vf value[3];
    vf_pnoise4_3(vf_set(x), vf_set(y), vf_set(z), vf_set(t), vf_set(a), vf_set(b), vf_set(c),
                 vf_set(d), value);
    simd_first_lanes(value, out);
}

#endif
