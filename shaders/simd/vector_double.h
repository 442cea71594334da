/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_DOUBLE_H
#define VECTOR_DOUBLE_H

/* The functions of compiled shaders in double precision, lane by lane: what errors are stated
 * against (`--math reference`), not meant to be quick. The C library computes the functions, whose
 * errors are below a unit in the last place of a double; the fast functions are the exact ones
 * here. Noise is the same functions as in vector_noise.h and vector_lattice.h. */

#include "vector_permutation.h"
#include "vector_types.h"

SIMD_INLINE vf vf_set(double x) {
    return (vf){SIMD_EACH(SIMD_LANE_SAME, x)};
}

SIMD_INLINE vi vi_set(int64_t x) {
    return (vi){SIMD_EACH(SIMD_LANE_SAME, x)};
}

/* Planes are aligned to 64 bytes, less than a vector of 16 doubles. */
SIMD_INLINE vf vf_load(const double *p) {
    vf x;
    __builtin_memcpy(&x, p, sizeof x);
    return x;
}

SIMD_INLINE void vf_store(double *p, vf x) {
    __builtin_memcpy(p, &x, sizeof x);
}

SIMD_INLINE int vi_any(vi mask) {
    int64_t any = 0;
    for (int i = 0; i < SHADER_WIDTH; i++)
        any |= mask[i];
    return any != 0;
}

SIMD_INLINE int vi_all(vi mask) {
    return !vi_any(~mask);
}

SIMD_INLINE vf vf_canonical(vf x) {
    return x;
}

/* ---- functions of one and two numbers ---- */

/* clang-format off */
#define DOUBLE_FUNCTIONS_1(F) \
    F(sqrt, __builtin_sqrt(x)) F(abs, __builtin_fabs(x)) F(floor, __builtin_floor(x)) \
    F(ceil, __builtin_ceil(x)) F(round, __builtin_round(x)) F(inversesqrt, 1.0 / __builtin_sqrt(x)) \
    F(sin, __builtin_sin(x)) F(cos, __builtin_cos(x)) F(tan, __builtin_tan(x)) F(asin, __builtin_asin(x)) \
    F(acos, __builtin_acos(x)) F(atan, __builtin_atan(x)) F(exp, __builtin_exp(x)) F(exp2, __builtin_exp2(x)) \
    F(log, __builtin_log(x)) F(log2, __builtin_log2(x))
#define DOUBLE_FUNCTIONS_2(F) \
    F(min, x < y ? x : y) F(max, x > y ? x : y) F(atan2, __builtin_atan2(x, y)) F(pow, __builtin_pow(x, y)) \
    F(mod, y != 0 ? x - y * __builtin_floor(x / y) : x * 0)
/* clang-format on */

#define DOUBLE_TWIN_1(name, expression)                                                            \
    SIMD_FUNCTION double sf_##name(double x) {                                                     \
        return expression;                                                                         \
    }                                                                                              \
    SIMD_FUNCTION vf vf_##name(vf x) {                                                             \
        for (int i = 0; i < SHADER_WIDTH; i++)                                                     \
            x[i] = sf_##name(x[i]);                                                                \
        return x;                                                                                  \
    }
#define DOUBLE_TWIN_2(name, expression)                                                            \
    SIMD_FUNCTION double sf_##name(double x, double y) {                                           \
        return expression;                                                                         \
    }                                                                                              \
    SIMD_FUNCTION vf vf_##name(vf x, vf y) {                                                       \
        for (int i = 0; i < SHADER_WIDTH; i++)                                                     \
            x[i] = sf_##name(x[i], y[i]);                                                          \
        return x;                                                                                  \
    }
DOUBLE_FUNCTIONS_1(DOUBLE_TWIN_1)
DOUBLE_FUNCTIONS_2(DOUBLE_TWIN_2)
#undef DOUBLE_TWIN_1
#undef DOUBLE_TWIN_2

#define DOUBLE_FAST_1(name)                                                                        \
    SIMD_FUNCTION double sf_##name##_fast(double x) {                                              \
        return sf_##name(x);                                                                       \
    }                                                                                              \
    SIMD_FUNCTION vf vf_##name##_fast(vf x) {                                                      \
        return vf_##name(x);                                                                       \
    }
#define DOUBLE_FAST_2(name)                                                                        \
    SIMD_FUNCTION double sf_##name##_fast(double x, double y) {                                    \
        return sf_##name(x, y);                                                                    \
    }                                                                                              \
    SIMD_FUNCTION vf vf_##name##_fast(vf x, vf y) {                                                \
        return vf_##name(x, y);                                                                    \
    }
DOUBLE_FAST_1(sin)
DOUBLE_FAST_1(cos)
DOUBLE_FAST_1(tan)
DOUBLE_FAST_1(asin)
DOUBLE_FAST_1(acos)
DOUBLE_FAST_1(atan)
DOUBLE_FAST_1(exp)
DOUBLE_FAST_1(exp2)
DOUBLE_FAST_1(log)
DOUBLE_FAST_1(log2)
DOUBLE_FAST_2(atan2)
DOUBLE_FAST_2(pow)
#undef DOUBLE_FAST_1
#undef DOUBLE_FAST_2

/* ---- noise ---- */

SIMD_FUNCTION double double_fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

SIMD_FUNCTION double double_lerp(double t, double a, double b) {
    return a + t * (b - a);
}

/* The cell of x modulo `period` (0 where x is not finite), and in *x the fraction. */
SIMD_FUNCTION uint32_t double_cell(double *x, double period) {
    double down = __builtin_floor(*x);
    double wrapped = down - period * __builtin_floor(down / period);
    *x -= down;
    return wrapped >= 0.0 && wrapped < period ? (uint32_t)wrapped : 0;
}

SIMD_FUNCTION double double_gradient(uint32_t hash, double x, double y, double z) {
    uint32_t h = hash & 15;
    double u = h < 8 ? x : y, v = h < 4 ? y : h == 12 || h == 14 ? x : z;
    return ((h & 1) == 0 ? u : -u) + ((h & 2) == 0 ? v : -v);
}

/* n to RSL's range, as vf_noise_range. */
SIMD_FUNCTION double double_noise_range(double n) {
    double value = 0.5 + 0.5 * n;
    return value < 0.0 ? 0.0 : value > 1.0 ? 1.0 : value;
}

/* Perlin's noise with `offset` added to every lattice coordinate. */
SIMD_FUNCTION double double_perlin(double x, double y, double z, uint32_t offset) {
    const uint8_t *p = simd_permutation;
    uint32_t i = double_cell(&x, 256.0) + offset, j = double_cell(&y, 256.0) + offset;
    uint32_t k = double_cell(&z, 256.0) + offset;
    double value[8];
    for (uint32_t c = 0; c < 8; c++) {
        uint32_t dx = c & 1, dy = c >> 1 & 1, dz = c >> 2;
        uint32_t hash = p[(p[(p[(i + dx) & 255] + j + dy) & 255] + k + dz) & 255];
        value[c] = double_gradient(hash, x - dx, y - dy, z - dz);
    }
    double weight[3] = {double_fade(x), double_fade(y), double_fade(z)};
    for (int d = 0; d < 3; d++)
        for (int c = 0; c < 4 >> d; c++)
            value[c] = double_lerp(weight[d], value[2 * c], value[2 * c + 1]);
    return value[0];
}

SIMD_FUNCTION uint32_t double_mix(uint32_t hash, uint32_t key) {
    key *= 0xcc9e2d51u;
    key = (key << 15) | (key >> 17);
    hash ^= key * 0x1b873593u;
    hash = (hash << 13) | (hash >> 19);
    return hash * 5u + 0xe6546b64u;
}

SIMD_FUNCTION uint32_t double_finish(uint32_t hash) {
    hash = (hash ^ (hash >> 16)) * 0x85ebca6bu;
    hash = (hash ^ (hash >> 13)) * 0xc2b2ae35u;
    return hash ^ (hash >> 16);
}

SIMD_FUNCTION double double_gradient4(uint32_t hash, const double f[4]) {
    uint32_t h = hash & 31;
    double u = h < 24 ? f[0] : f[1], v = h < 16 ? f[1] : f[2], w = h < 8 ? f[2] : f[3];
    return (h & 1 ? -u : u) + (h & 2 ? -v : v) + (h & 4 ? -w : w);
}

/* Noise of three or four dimensions between hashed lattice points, with periods. */
SIMD_FUNCTION double double_lattice(const double *at, const double *period, int dimensions,
                                    uint32_t seed) {
    double f[4] = {0}, value[16];
    uint32_t near[4], far[4];
    for (int d = 0; d < dimensions; d++) {
        double whole = __builtin_floor(period[d]);
        whole = whole > 1.0 ? whole < 65536.0 ? whole : 65536.0 : 1.0;
        f[d] = at[d];
        near[d] = double_cell(&f[d], whole);
        far[d] = near[d] + 1.0 < whole ? near[d] + 1 : 0;
    }
    for (int c = 0; c < 1 << dimensions; c++) {
        uint32_t hash = seed;
        double g[4];
        for (int d = 0; d < dimensions; d++) {
            hash = double_mix(hash, c >> d & 1 ? far[d] : near[d]);
            g[d] = f[d] - (c >> d & 1);
        }
        hash = double_finish(hash);
        value[c] =
            dimensions == 4 ? double_gradient4(hash, g) : double_gradient(hash, g[0], g[1], g[2]);
    }
    for (int d = 0; d < dimensions; d++)
        for (int c = 0; c < 1 << (dimensions - 1 - d); c++)
            value[c] = double_lerp(double_fade(f[d]), value[2 * c], value[2 * c + 1]);
    return double_noise_range(dimensions == 4 ? 0.87 * value[0] : value[0]);
}

/* Component c of each noise, from its arguments in order. */
SIMD_FUNCTION double double_noise1(const double *a, int c) {
    return double_noise_range(double_perlin(a[0], 0.0, 0.0, 85u * (uint32_t)c));
}

SIMD_FUNCTION double double_noise2(const double *a, int c) {
    return double_noise_range(double_perlin(a[0], a[1], 0.0, 85u * (uint32_t)c));
}

SIMD_FUNCTION double double_noise3(const double *a, int c) {
    return double_noise_range(double_perlin(a[0], a[1], a[2], 85u * (uint32_t)c));
}

SIMD_FUNCTION double double_noise4(const double *a, int c) {
    const double period[4] = {65536.0, 65536.0, 65536.0, 65536.0};
    return double_lattice(a, period, 4, (uint32_t)c);
}

SIMD_FUNCTION double double_pnoise3(const double *a, int c) {
    return double_lattice(a, a + 3, 3, (uint32_t)c);
}

SIMD_FUNCTION double double_pnoise4(const double *a, int c) {
    return double_lattice(a, a + 4, 4, (uint32_t)c);
}

SIMD_FUNCTION double double_cellnoise(const double *a, int c) {
    uint32_t hash = (uint32_t)c;
    for (int d = 0; d < 4; d++) {
        double x = a[d];
        hash = double_mix(hash, double_cell(&x, 65536.0));
    }
    return (double)(double_finish(hash) >> 8) * 0x1p-24;
}

/* The bits of the coordinates as floats count, as in the other precision. */
SIMD_FUNCTION double double_random(const double *a, int c) {
    uint32_t hash = 0x72616e64;
    (void)c;
    for (int d = 0; d < 4; d++) {
        float x = (float)a[d];
        uint32_t bits;
        __builtin_memcpy(&bits, &x, sizeof bits);
        hash = double_mix(hash, bits);
    }
    return (double)(double_finish(hash) >> 8) * 0x1p-24;
}

/* Hashes of lattice corners for fixed-point noise, laid out as vector_noise.h has them in general.
 */
#define simd_corner_vector(corner, far) (corner)
#define simd_corner_shift(corner, far) (8 * (far))

SIMD_FUNCTION void vi_corner_hashes(vi i, vi j, vi k, vi h[4]) {
    const uint8_t *p = simd_permutation;
    for (int lane = 0; lane < SHADER_WIDTH; lane++)
        for (int c = 0; c < 4; c++) {
            int64_t base = p[(p[(i[lane] + (c & 1)) & 255] + j[lane] + (c >> 1)) & 255] + k[lane];
            h[c][lane] = p[base & 255] | (int64_t)p[(base + 1) & 255] << 8;
        }
}

/* The forms that compiled code calls. `scalars` and `vectors` are parameter lists, `names` the
 * arguments, `lanes` lane i of each. */
#define DOUBLE_NOISE(name, scalars, vectors, names, lanes)                                         \
    SIMD_FUNCTION double sf_##name(DOUBLE_UNWRAP scalars) {                                        \
        const double a[] = {DOUBLE_UNWRAP names};                                                  \
        return double_##name(a, 0);                                                                \
    }                                                                                              \
    SIMD_FUNCTION vf vf_##name(DOUBLE_UNWRAP vectors) {                                            \
        vf result;                                                                                 \
        for (int i = 0; i < SHADER_WIDTH; i++) {                                                   \
            const double a[] = {DOUBLE_UNWRAP lanes};                                              \
            result[i] = double_##name(a, 0);                                                       \
        }                                                                                          \
        return result;                                                                             \
    }                                                                                              \
    SIMD_FUNCTION void sf_##name##_3(DOUBLE_UNWRAP scalars, double out[3]) {                       \
        const double a[] = {DOUBLE_UNWRAP names};                                                  \
        for (int c = 0; c < 3; c++)                                                                \
            out[c] = double_##name(a, c);                                                          \
    }                                                                                              \
    SIMD_FUNCTION void vf_##name##_3(DOUBLE_UNWRAP vectors, vf out[3]) {                           \
        for (int i = 0; i < SHADER_WIDTH; i++) {                                                   \
            const double a[] = {DOUBLE_UNWRAP lanes};                                              \
            for (int c = 0; c < 3; c++)                                                            \
                out[c][i] = double_##name(a, c);                                                   \
        }                                                                                          \
    }
#define DOUBLE_UNWRAP(...) __VA_ARGS__
DOUBLE_NOISE(noise1, (double x), (vf x), (x), (x[i]))
DOUBLE_NOISE(noise2, (double x, double y), (vf x, vf y), (x, y), (x[i], y[i]))
DOUBLE_NOISE(noise3, (double x, double y, double z), (vf x, vf y, vf z), (x, y, z),
             (x[i], y[i], z[i]))
DOUBLE_NOISE(noise4, (double x, double y, double z, double t), (vf x, vf y, vf z, vf t),
             (x, y, z, t), (x[i], y[i], z[i], t[i]))
DOUBLE_NOISE(cellnoise, (double x, double y, double z, double t), (vf x, vf y, vf z, vf t),
             (x, y, z, t), (x[i], y[i], z[i], t[i]))
DOUBLE_NOISE(random, (double x, double y, double z, double t), (vf x, vf y, vf z, vf t),
             (x, y, z, t), (x[i], y[i], z[i], t[i]))
DOUBLE_NOISE(pnoise3, (double x, double y, double z, double a0, double b, double c0),
             (vf x, vf y, vf z, vf a0, vf b, vf c0), (x, y, z, a0, b, c0),
             (x[i], y[i], z[i], a0[i], b[i], c0[i]))
DOUBLE_NOISE(pnoise4,
             (double x, double y, double z, double t, double a0, double b, double c0, double d),
             (vf x, vf y, vf z, vf t, vf a0, vf b, vf c0, vf d), (x, y, z, t, a0, b, c0, d),
             (x[i], y[i], z[i], t[i], a0[i], b[i], c0[i], d[i]))
#undef DOUBLE_NOISE

#endif
