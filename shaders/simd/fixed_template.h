/* SPDX-License-Identifier: Apache-2.0 */
/* Fixed-point arithmetic on raw integers, once for vectors and once for scalars: vector_fixed.h
 * includes this file twice, with FX the signed and FXU the unsigned 64-bit type (or vector of them)
 * and FX_NAME(x) the name of a function. Exponents, sizes and signs are constants where these
 * functions are called, so that every choice between them is made while compiling. Results wrap:
 * what does not fit into the bits of the result is cut off at the top. */

/* The low `size` bits, as a signed or unsigned number. */
SIMD_INLINE FX FX_NAME(wrap)(FX x, int size, int is_unsigned) {
    if (size >= 64)
        return x;
    const FXU high = (FXU)x << (64 - size);
    return is_unsigned ? (FX)(high >> (64 - size)) : (FX)high >> (64 - size);
}

/* x * 2^left: to the left modulo 2^64, to the right rounded down. */
SIMD_INLINE FX FX_NAME(shift)(FX x, int left, int is_unsigned) {
    if (left >= 64 || (left <= -64 && is_unsigned))
        return x ^ x;
    if (left >= 0)
        return (FX)((FXU)x << left);
    if (left <= -64)
        return x >> 63;
    return is_unsigned ? (FX)((FXU)x >> -left) : x >> -left;
}

SIMD_INLINE FX FX_NAME(add)(FX a, FX b) {
    return (FX)((FXU)a + (FXU)b);
}

SIMD_INLINE FX FX_NAME(subtract)(FX a, FX b) {
    return (FX)((FXU)a - (FXU)b);
}

SIMD_INLINE FX FX_NAME(multiply)(FX a, FX b) {
    return (FX)((FXU)a * (FXU)b);
}

/* What a shift to the right by `places` loses: 0 where nothing, else something else. */
SIMD_INLINE FX FX_NAME(lost)(FX x, int places, int is_unsigned) {
    return places >= 64 ? x
                        : x ^ FX_NAME(shift)(FX_NAME(shift)(x, -places, is_unsigned), places, 0);
}

/* Comparisons of whole numbers of either sign: true is -1 in a lane, 1 in a scalar. */
SIMD_INLINE FX FX_NAME(less_whole)(FX a, int a_unsigned, FX b, int b_unsigned) {
    if (!a_unsigned && !b_unsigned)
        return (FX)(a < b);
    const FX below = (FX)((FXU)a < (FXU)b);
    if (a_unsigned && b_unsigned)
        return below;
    return a_unsigned ? (FX)(b >= 0) & below : (FX)(a < 0) | below;
}

SIMD_INLINE FX FX_NAME(same_whole)(FX a, int a_unsigned, FX b, int b_unsigned) {
    const FX same = (FX)(a == b);
    return a_unsigned == b_unsigned ? same : same & (FX)(a >= 0);
}

/* a * 2^-a_exponent < b * 2^-b_exponent: floors decide, and where they are equal, what they lost.
 */
SIMD_INLINE FX FX_NAME(less)(FX a, int a_exponent, int a_unsigned, FX b, int b_exponent,
                             int b_unsigned) {
    const int finer = a_exponent - b_exponent;
    if (finer >= 0)
        return FX_NAME(less_whole)(FX_NAME(shift)(a, -finer, a_unsigned), a_unsigned, b,
                                   b_unsigned);
    const FX floor = FX_NAME(shift)(b, finer, b_unsigned);
    return FX_NAME(less_whole)(a, a_unsigned, floor, b_unsigned) |
           (FX_NAME(same_whole)(a, a_unsigned, floor, b_unsigned) &
            (FX)(FX_NAME(lost)(b, -finer, b_unsigned) != 0));
}

SIMD_INLINE FX FX_NAME(equal)(FX a, int a_exponent, int a_unsigned, FX b, int b_exponent,
                              int b_unsigned) {
    const int finer = a_exponent - b_exponent;
    if (finer < 0)
        return FX_NAME(same_whole)(a, a_unsigned, FX_NAME(shift)(b, finer, b_unsigned),
                                   b_unsigned) &
               (FX)(FX_NAME(lost)(b, -finer, b_unsigned) == 0);
    return FX_NAME(same_whole)(FX_NAME(shift)(a, -finer, a_unsigned), a_unsigned, b, b_unsigned) &
           (FX)(FX_NAME(lost)(a, finer, a_unsigned) == 0);
}

/* The whole numbers above and nearest (halves up) of a number with `exponent` > 0. */
SIMD_INLINE FX FX_NAME(ceil)(FX x, int exponent, int is_unsigned) {
    const FX above = (FX)(FX_NAME(lost)(x, exponent, is_unsigned) != 0);
    return FX_NAME(add)(FX_NAME(shift)(x, -exponent, is_unsigned), above & 1);
}

SIMD_INLINE FX FX_NAME(round)(FX x, int exponent, int is_unsigned) {
    return FX_NAME(add)(FX_NAME(shift)(x, -exponent, is_unsigned),
                        FX_NAME(shift)(x, 1 - exponent, is_unsigned) & 1);
}
