/* SPDX-License-Identifier: Apache-2.0 */
#include "vector_kernels.h"

#include <string.h>

extern const struct vector_kernels vector_kernels_sse2_4, vector_kernels_sse2_16;
#ifdef __x86_64__
extern const struct vector_kernels vector_kernels_avx2_8, vector_kernels_avx512_16,
    vector_kernels_avx512_vbmi_16;
#endif

const struct vector_kernels *const vector_kernel_sets[] = {
    &vector_kernels_sse2_4, &vector_kernels_sse2_16,
#ifdef __x86_64__
    &vector_kernels_avx2_8, &vector_kernels_avx512_16, &vector_kernels_avx512_vbmi_16,
#endif
};
const int vector_kernel_set_count = sizeof vector_kernel_sets / sizeof *vector_kernel_sets;

const struct vector_kernels *vector_kernels_best(void) {
    for (int i = vector_kernel_set_count - 1; i > 0; i--)
        if (vector_kernel_sets[i]->supported())
            return vector_kernel_sets[i];
    return vector_kernel_sets[0];
}

const struct vector_function *vector_kernels_find(const struct vector_kernels *kernels,
                                                  const char *name) {
    for (int i = 0; i < kernels->function_count; i++)
        if (strcmp(kernels->functions[i].name, name) == 0)
            return &kernels->functions[i];
    return NULL;
}
