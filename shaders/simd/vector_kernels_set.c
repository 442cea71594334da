/* SPDX-License-Identifier: Apache-2.0 */
/* One set of kernels (vector_kernels.h): compiled once per instruction set with SHADER_WIDTH,
 * KERNEL_SET (the variable's name), KERNEL_NAME and KERNEL_SUPPORTED given by the build. */

#include "vector_kernels.h"
#include "vector_math.h"

#include <string.h>

/* The part of an array that vector number `first / SHADER_WIDTH` covers; absent lanes repeat the
 * first one. */
static inline vf load_part(const float *from, size_t first, size_t count) {
    vf x;
    if (count - first >= SHADER_WIDTH) {
        memcpy(&x, from + first, sizeof x);
        return x;
    }
    x = vf_set(from[first]);
    memcpy(&x, from + first, (count - first) * sizeof *from);
    return x;
}

static inline void store_part(float *to, vf x, size_t first, size_t count) {
    size_t lanes = count - first < SHADER_WIDTH ? count - first : SHADER_WIDTH;
    if (lanes == SHADER_WIDTH)
        memcpy(to + first, &x, sizeof x);
    else
        memcpy(to + first, &x, lanes * sizeof *to);
}

#define PART(n) load_part(in[n], i, count)
#define FOR_PARTS for (size_t i = 0; i < count; i += SHADER_WIDTH)
#define APPLY_1(f)                                                                                 \
    static void apply_##f(const float *const *in, float *const *out, size_t count) {               \
        FOR_PARTS store_part(out[0], vf_##f(PART(0)), i, count);                                   \
    }
#define APPLY_2(f)                                                                                 \
    static void apply_##f(const float *const *in, float *const *out, size_t count) {               \
        FOR_PARTS store_part(out[0], vf_##f(PART(0), PART(1)), i, count);                          \
    }
#define APPLY_3(f)                                                                                 \
    static void apply_##f(const float *const *in, float *const *out, size_t count) {               \
        FOR_PARTS store_part(out[0], vf_##f(PART(0), PART(1), PART(2)), i, count);                 \
    }
VECTOR_FUNCTIONS_1(APPLY_1)
VECTOR_FUNCTIONS_2(APPLY_2)
VECTOR_FUNCTIONS_3(APPLY_3)

#define APPLY_VECTOR(f, ...)                                                                       \
    static void apply_##f(const float *const *in, float *const *out, size_t count) {               \
        FOR_PARTS {                                                                                \
            vf value[3];                                                                           \
            vf_##f(__VA_ARGS__, value);                                                            \
            for (int c = 0; c < 3; c++)                                                            \
                store_part(out[c], value[c], i, count);                                            \
        }                                                                                          \
    }
APPLY_VECTOR(noise1_3, PART(0))
APPLY_VECTOR(noise2_3, PART(0), PART(1))
APPLY_VECTOR(noise3_3, PART(0), PART(1), PART(2))

#define ENTRY_1(f) {#f, 1, 1, apply_##f},
#define ENTRY_2(f) {#f, 2, 1, apply_##f},
#define ENTRY_3(f) {#f, 3, 1, apply_##f},
static const struct vector_function functions[] = {
    VECTOR_FUNCTIONS_1(ENTRY_1) VECTOR_FUNCTIONS_2(ENTRY_2)
        VECTOR_FUNCTIONS_3(ENTRY_3){"noise1_3", 1, 3, apply_noise1_3},
    {"noise2_3", 2, 3, apply_noise2_3},
    {"noise3_3", 3, 3, apply_noise3_3},
};

static int supported(void) {
    return KERNEL_SUPPORTED;
}

extern const struct vector_kernels KERNEL_SET;
const struct vector_kernels KERNEL_SET = {KERNEL_NAME, SHADER_WIDTH, supported, functions,
                                          sizeof functions / sizeof *functions};
