/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_TYPES_H
#define VECTOR_TYPES_H

/* Vectors of samples in plain C with the vector extensions of GCC and Clang. SHADER_WIDTH lanes (4,
 * 8 or 16); what happens in a lane depends on that lane only, so no result depends on the width.
 * Compile with -ffp-contract=off -fno-math-errno -fno-trapping-math, and never with -ffast-math.
 *
 *   vf      SHADER_WIDTH floats
 *   vi      SHADER_WIDTH 32-bit integers; a mask has lanes of -1 and 0
 *   hd, hl  half a vector: SHADER_WIDTH / 2 doubles, 64-bit integers (the same bytes as a vf) */

#include <stddef.h>
#include <stdint.h>

#ifndef SHADER_WIDTH
#error "define SHADER_WIDTH as 4, 8 or 16"
#endif

/* Vectors wider than the machine's pass through memory; nothing here is called across object files.
 */
#pragma GCC diagnostic ignored "-Wpsabi"

#define SIMD_FUNCTION static inline __attribute__((unused))
#define SIMD_INLINE static inline __attribute__((unused, always_inline))
#define SIMD_RARE static __attribute__((unused, noinline, cold))

#ifdef SHADER_REFERENCE /* vector_double.h: the same names for lanes of 64 bits */
typedef double vf __attribute__((vector_size(8 * SHADER_WIDTH)));
typedef int64_t vi __attribute__((vector_size(8 * SHADER_WIDTH)));
typedef uint64_t vu __attribute__((vector_size(8 * SHADER_WIDTH)));
#else
typedef float vf __attribute__((vector_size(4 * SHADER_WIDTH)));
typedef int32_t vi __attribute__((vector_size(4 * SHADER_WIDTH)));
typedef uint32_t vu __attribute__((vector_size(4 * SHADER_WIDTH)));
#endif
typedef double hd __attribute__((vector_size(4 * SHADER_WIDTH)));
typedef int64_t hl __attribute__((vector_size(4 * SHADER_WIDTH)));
typedef uint64_t hu __attribute__((vector_size(4 * SHADER_WIDTH)));
typedef double simd_doubles __attribute__((vector_size(8 * SHADER_WIDTH)));

/* Lane numbers, and an operation written out per lane (both compilers turn the list into vector
 * code). */
#if SHADER_WIDTH == 4
#define SIMD_LOW_LANES 0, 1
#define SIMD_HIGH_LANES 2, 3
#define SIMD_ALL_LANES SIMD_LOW_LANES, SIMD_HIGH_LANES
#define SIMD_EACH_HALF(f, x) f(x, 0), f(x, 1)
#define SIMD_EACH(f, x) f(x, 0), f(x, 1), f(x, 2), f(x, 3)
#elif SHADER_WIDTH == 8
#define SIMD_LOW_LANES 0, 1, 2, 3
#define SIMD_HIGH_LANES 4, 5, 6, 7
#define SIMD_ALL_LANES SIMD_LOW_LANES, SIMD_HIGH_LANES
#define SIMD_EACH_HALF(f, x) f(x, 0), f(x, 1), f(x, 2), f(x, 3)
#define SIMD_EACH(f, x) SIMD_EACH_HALF(f, x), f(x, 4), f(x, 5), f(x, 6), f(x, 7)
#elif SHADER_WIDTH == 16
#define SIMD_LOW_LANES 0, 1, 2, 3, 4, 5, 6, 7
#define SIMD_HIGH_LANES 8, 9, 10, 11, 12, 13, 14, 15
#define SIMD_ALL_LANES SIMD_LOW_LANES, SIMD_HIGH_LANES
#define SIMD_EACH_HALF(f, x) f(x, 0), f(x, 1), f(x, 2), f(x, 3), f(x, 4), f(x, 5), f(x, 6), f(x, 7)
#define SIMD_EACH(f, x)                                                                            \
    SIMD_EACH_HALF(f, x), f(x, 8), f(x, 9), f(x, 10), f(x, 11), f(x, 12), f(x, 13), f(x, 14),      \
        f(x, 15)
#else
#error "SHADER_WIDTH must be 4, 8 or 16"
#endif
#define SIMD_LANE_SAME(x, i) (x)
#define SIMD_LANE_SQRTF(x, i) __builtin_sqrtf((x)[i])
#define SIMD_LANE_SQRT(x, i) __builtin_sqrt((x)[i])

/* a where the mask's lane is -1, b where it is 0. */
SIMD_INLINE vf vf_select(vi mask, vf a, vf b) {
    return (vf)(((vi)a & mask) | ((vi)b & ~mask));
}

SIMD_INLINE vi vi_select(vi mask, vi a, vi b) {
    return (a & mask) | (b & ~mask);
}

#ifndef SHADER_REFERENCE
SIMD_INLINE vf vf_set(float x) {
    return (vf){SIMD_EACH(SIMD_LANE_SAME, x)};
}

SIMD_INLINE vi vi_set(int32_t x) {
    return (vi){SIMD_EACH(SIMD_LANE_SAME, x)};
}

/* `p` is aligned to the size of a vf (planes of samples are aligned to 64 bytes). */
SIMD_INLINE vf vf_load(const float *p) {
    return *(const vf *)(const void *)p;
}

SIMD_INLINE void vf_store(float *p, vf x) {
    *(vf *)(void *)p = x;
}

SIMD_INLINE hd hd_select(hl mask, hd a, hd b) {
    return (hd)(((hl)a & mask) | ((hl)b & ~mask));
}

/* Whether a lane of the mask is set; whether all are. */
SIMD_INLINE int vi_any(vi mask) {
    hl wide = (hl)mask;
    int64_t any = 0;
    for (int i = 0; i < SHADER_WIDTH / 2; i++)
        any |= wide[i];
    return any != 0;
}

SIMD_INLINE int vi_all(vi mask) {
    return !vi_any(~mask);
}

/* Halves of a vector as doubles (exact, denormals included), and back with one rounding to nearest
 * even. Written as conversions of whole vectors, which both compilers turn into one instruction per
 * half. */
SIMD_INLINE hd hd_low(vf x) {
    simd_doubles wide = __builtin_convertvector(x, simd_doubles);
    return __builtin_shufflevector(wide, wide, SIMD_LOW_LANES);
}

SIMD_INLINE hd hd_high(vf x) {
    simd_doubles wide = __builtin_convertvector(x, simd_doubles);
    return __builtin_shufflevector(wide, wide, SIMD_HIGH_LANES);
}

SIMD_INLINE vf vf_join(hd low, hd high) {
    return __builtin_convertvector(__builtin_shufflevector(low, high, SIMD_ALL_LANES), vf);
}

/* Every NaN becomes the same quiet NaN: which operand's NaN survives an addition is the compiler's
 * choice. */
SIMD_INLINE vf vf_canonical(vf x) {
    return vf_select((vi)(x != x), (vf)vi_set(0x7fc00000), x);
}

/* IEEE square root; of a negative number NaN, of -0 it is -0. */
SIMD_INLINE vf vf_sqrt(vf x) {
    return vf_canonical((vf){SIMD_EACH(SIMD_LANE_SQRTF, x)});
}

SIMD_INLINE hd hd_sqrt(hd x) {
    return (hd){SIMD_EACH_HALF(SIMD_LANE_SQRT, x)};
}

SIMD_INLINE vf vf_abs(vf x) {
    return (vf)((vi)x & 0x7fffffff);
}

SIMD_INLINE hd hd_abs(hd x) {
    return (hd)((hl)x & 0x7fffffffffffffff);
}

/* x with its sign bit set where that of `sign` is. */
SIMD_INLINE vf vf_with_sign(vf x, vf sign) {
    return (vf)((vi)x | ((vi)sign & (int32_t)0x80000000));
}

SIMD_INLINE hd hd_with_sign(hd x, hd sign) {
    return (hd)((hl)x | ((hl)sign & INT64_MIN));
}

/* a < b ? a : b and a > b ? a : b: where either is NaN, and for zeros of different sign, the result
 * is b. That is what the processor's instruction does, which no compiler finds by itself. */
#if defined(__SSE2__) && SHADER_WIDTH == 4
#define SIMD_MIN(a, b) __builtin_ia32_minps(a, b)
#define SIMD_MAX(a, b) __builtin_ia32_maxps(a, b)
#elif defined(__AVX__) && SHADER_WIDTH == 8
#define SIMD_MIN(a, b) __builtin_ia32_minps256(a, b)
#define SIMD_MAX(a, b) __builtin_ia32_maxps256(a, b)
#elif defined(__AVX512F__) && SHADER_WIDTH == 16 && defined(__clang__)
#define SIMD_MIN(a, b) __builtin_ia32_minps512(a, b, 4)
#define SIMD_MAX(a, b) __builtin_ia32_maxps512(a, b, 4)
#elif defined(__AVX512F__) && SHADER_WIDTH == 16
#define SIMD_MIN(a, b) __builtin_ia32_minps512_mask(a, b, b, (short)-1, 4)
#define SIMD_MAX(a, b) __builtin_ia32_maxps512_mask(a, b, b, (short)-1, 4)
#else
#define SIMD_MIN(a, b) vf_select((vi)((a) < (b)), a, b)
#define SIMD_MAX(a, b) vf_select((vi)((a) > (b)), a, b)
#endif

SIMD_INLINE vf vf_min(vf a, vf b) {
    return SIMD_MIN(a, b);
}

SIMD_INLINE vf vf_max(vf a, vf b) {
    return SIMD_MAX(a, b);
}

/* The nearest integers below, above, and nearest with halves away from zero. Exact; the sign of
 * zero is kept (ceil(-0.5) is -0); infinities are kept. SIMD_ROUND: where an instruction does it.
 */
#if defined(__AVX__) && SHADER_WIDTH == 8
#define SIMD_ROUND(x, direction) __builtin_ia32_roundps256(x, direction)
#elif defined(__AVX512F__) && SHADER_WIDTH == 16
#define SIMD_ROUND(x, direction) __builtin_ia32_rndscaleps_mask(x, direction, x, (short)-1, 4)
#endif

SIMD_INLINE vf vf_floor(vf x) {
#ifdef SIMD_ROUND
    return SIMD_ROUND(x, 1);
#else
    vf size = vf_abs(x);
    vf nearest = vf_with_sign((size + 0x1p23f) - 0x1p23f, x);
    vf down = nearest - (vf)((vi)(nearest > x) & (vi)vf_set(1.0f));
    return vf_select((vi)(size < 0x1p23f), down, x + 0.0f);
#endif
}

SIMD_INLINE vf vf_ceil(vf x) {
#ifdef SIMD_ROUND
    return SIMD_ROUND(x, 2);
#else
    vf size = vf_abs(x);
    vf nearest = vf_with_sign((size + 0x1p23f) - 0x1p23f, x);
    vf up = nearest + (vf)((vi)(nearest < x) & (vi)vf_set(1.0f));
    return vf_select((vi)(size < 0x1p23f), vf_with_sign(up, x), x + 0.0f);
#endif
}

SIMD_INLINE vf vf_round(vf x) {
    vf size = vf_abs(x);
    vf down = vf_floor(size);
    vf nearest = down + (vf)((vi)(size - down >= 0.5f) & (vi)vf_set(1.0f));
    return vf_select((vi)(size == size), vf_with_sign(nearest, x), x + 0.0f);
}

#endif

#endif
