/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_KERNELS_H
#define VECTOR_KERNELS_H

#include <stddef.h>

/* The functions of vector_math.h over arrays, built once per instruction set: for the tests and the
 * accuracy program, which compare the sets with each other and with references. */

struct vector_function {
    const char *name; /* as in vector_math.h, without vf_ */
    int inputs;       /* 1 to 3 arrays in */
    int outputs;      /* 1, or 3 for vector noise */
    /* Applies the function to `count` elements; arrays may start anywhere and inputs may be
     * outputs. */
    void (*apply)(const float *const *in, float *const *out, size_t count);
};

struct vector_kernels {
    const char *name;
    int width;
    int (*supported)(void); /* whether this processor runs them */
    const struct vector_function *functions;
    int function_count;
};

/* Narrowest first; every set has the same functions in the same order. */
extern const struct vector_kernels *const vector_kernel_sets[];
extern const int vector_kernel_set_count;

/* The widest set this processor runs. */
const struct vector_kernels *vector_kernels_best(void);
/* The function of that name, or NULL. */
const struct vector_function *vector_kernels_find(const struct vector_kernels *kernels,
                                                  const char *name);

#endif
