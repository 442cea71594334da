/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_MATH_H
#define VECTOR_MATH_H

/* Everything that compiled shaders call: vectors of SHADER_WIDTH samples (vector_types.h), exact
 * functions (vector_exact.h, vector_trigonometry.h), the paper's fast ones (vector_fast.h), noise
 * (vector_noise.h, vector_lattice.h, vector_fixed_noise.h), and here their scalar twins for uniform
 * code: sf_sin(x) has the bits of every lane of vf_sin(vf_set(x)). With SHADER_REFERENCE defined
 * the same names compute in double precision (vector_double.h). */

#ifdef SHADER_REFERENCE
#include "vector_double.h"
#else
#include "vector_exact.h"
#include "vector_fast.h"
#include "vector_fixed_noise.h"
#include "vector_lattice.h"
#include "vector_noise.h"
#include "vector_trigonometry.h"
#include "vector_types.h"

/* The functions of one float, of two, and of three: VECTOR_FUNCTIONS_1(F) is F(sqrt) F(abs) ... */
/* clang-format off */
#define VECTOR_FUNCTIONS_1(F) \
    F(sqrt) F(abs) F(floor) F(ceil) F(round) F(inversesqrt) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(exp) \
    F(exp2) F(log) F(log2) F(sin_fast) F(cos_fast) F(tan_fast) F(asin_fast) F(acos_fast) F(atan_fast) \
    F(exp_fast) F(exp2_fast) F(log_fast) F(log2_fast) F(noise1)
#define VECTOR_FUNCTIONS_2(F) \
    F(min) F(max) F(mod) F(atan2) F(pow) F(atan2_fast) F(pow_fast) F(noise2)
#define VECTOR_FUNCTIONS_3(F) F(noise3) F(snoise3)
/* clang-format on */

#define SCALAR_TWIN_1(name)                                                                        \
    SIMD_FUNCTION float sf_##name(float x) {                                                       \
        return vf_##name(vf_set(x))[0];                                                            \
    }
#define SCALAR_TWIN_2(name)                                                                        \
    SIMD_FUNCTION float sf_##name(float x, float y) {                                              \
        return vf_##name(vf_set(x), vf_set(y))[0];                                                 \
    }
#define SCALAR_TWIN_3(name)                                                                        \
    SIMD_FUNCTION float sf_##name(float x, float y, float z) {                                     \
        return vf_##name(vf_set(x), vf_set(y), vf_set(z))[0];                                      \
    }
VECTOR_FUNCTIONS_1(SCALAR_TWIN_1)
VECTOR_FUNCTIONS_2(SCALAR_TWIN_2)
VECTOR_FUNCTIONS_3(SCALAR_TWIN_3)
#undef SCALAR_TWIN_1
#undef SCALAR_TWIN_2
#undef SCALAR_TWIN_3

SIMD_FUNCTION void sf_noise1_3(float x, float out[3]) {
    vf value[3];
    vf_noise1_3(vf_set(x), value);
    for (int c = 0; c < 3; c++)
        out[c] = value[c][0];
}

SIMD_FUNCTION void sf_noise2_3(float x, float y, float out[3]) {
    vf value[3];
    vf_noise2_3(vf_set(x), vf_set(y), value);
    for (int c = 0; c < 3; c++)
        out[c] = value[c][0];
}

SIMD_FUNCTION void sf_noise3_3(float x, float y, float z, float out[3]) {
    vf value[3];
    vf_noise3_3(vf_set(x), vf_set(y), vf_set(z), value);
    for (int c = 0; c < 3; c++)
        out[c] = value[c][0];
}

#endif /* SHADER_REFERENCE */

#endif
