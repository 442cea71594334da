/* SPDX-License-Identifier: Apache-2.0 */
#ifndef ACCURACY_H
#define ACCURACY_H

#include "shaders/simd/vector_kernels.h"

#include <stdint.h>

/* Runs work(argument) on this thread and as many others as are wanted, up to 63, and waits. */
void run_on_threads(int threads, void *(*work)(void *), void *argument);

/* What a sweep of one function over all floats, or a measurement of pairs, found. */
struct sweep_result {
    double ulp_max; /* infinite where a NaN or infinity is wrong */
    uint32_t ulp_max_at, ulp_max_at_second;
    uint64_t wrongly_rounded; /* results other than the reference rounded to float */
    int is_monotone;          /* the function should be; breaks are counted */
    uint64_t monotone_breaks;
    double absolute_max, relative_max; /* on the function's domain, for the fast functions */
    uint64_t inputs;
    uint64_t hash; /* of all results in order of bit pattern */
    double seconds;
};

/* Applies a function of one argument to every `step`-th float pattern; without errors: only hash
 * and monotonicity. */
void sweep_function(const struct vector_function *function, int with_errors, uint32_t step,
                    int threads, struct sweep_result *result);

/* Measures a function of two arguments on `blocks` x 4096 pairs of each kind (or of ordinary
 * numbers only): all together, or printed one by one. */
void pairs_measure(const struct vector_function *function, int ordinary_only, uint32_t blocks,
                   struct sweep_result *result);
void pairs_table(const struct vector_function *function, uint32_t blocks);

/* Prints what every function of one argument makes of zeros, denormals, infinities and NaN. */
void special_table(const struct vector_kernels *kernels);

/* Hashes 2^24 results of every function (or the one named) with every instruction set; 0 when
 * two differ, or one from what is recorded. */
int same_bits_check(const char *only, int threads);

/* Nanoseconds a value of each function (NULL: skipped), the best of interleaved rounds on arrays
 * that stay in the first-level cache. */
enum { THROUGHPUT_ROUNDS = 40 };
void throughput_measure(const struct vector_function *const *functions, int count, double *ns);

/* Prints ns a value for every function (or the one named) and every instruction set this processor
 * has. */
void throughput_table(const char *only);

/* Prints speed and largest error beside those of other libraries. */
void compare_table(const struct vector_kernels *kernels, const char *only, uint32_t step,
                   int threads);

#endif
