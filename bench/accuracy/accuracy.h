/* SPDX-License-Identifier: Apache-2.0 */
#ifndef ACCURACY_H
#define ACCURACY_H

#include "shaders/simd/vector_kernels.h"

#include <stdint.h>

/* What a sweep of one function over all floats found. */
struct sweep_result {
    double ulp_max; /* infinite where a NaN or infinity is wrong */
    uint32_t ulp_max_at;
    uint64_t wrongly_rounded; /* results other than the reference rounded to float */
    uint64_t monotone_breaks;
    double absolute_max, relative_max; /* on the function's domain, for the fast functions */
    uint64_t inputs;
    uint64_t hash; /* of all results in order of bit pattern */
    double seconds;
};

/* Applies a function of one argument to every `step`-th float pattern; `references` false: only
 * hashes. */
void sweep_function(const struct vector_function *function, int references, uint32_t step,
                    int threads, struct sweep_result *result);

/* Prints ns a value for every function (or the one named) and every instruction set this processor
 * has. */
void throughput_table(const char *only);

#endif
