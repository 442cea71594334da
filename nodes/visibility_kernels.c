/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/visibility_kernels.h"

#include <stddef.h>

extern const struct visibility_kernels visibility_kernels_sse2, visibility_kernels_avx2,
    visibility_kernels_avx512;

static const struct visibility_kernels *const sets[] = {
    &visibility_kernels_sse2,
#ifdef __x86_64__
    &visibility_kernels_avx2,
    &visibility_kernels_avx512,
#endif
};

const struct visibility_kernels *visibility_kernels_at(int i) {
    int found = -1;
    for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
        if (sets[s]->is_supported() && ++found == i)
            return sets[s];
    return NULL;
}

const struct visibility_kernels *visibility_kernels_best(void) {
    const struct visibility_kernels *best = visibility_kernels_at(0);
    for (int i = 1; visibility_kernels_at(i); i++)
        best = visibility_kernels_at(i);
    return best;
}
