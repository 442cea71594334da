/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REGION_SELECT_H
#define REGION_SELECT_H

#include <stdint.h>

/* The rule of image composition, for both ways of composing (contract C1): mask[k] = all ones where
 * b's sample is nearer than a's, or as near with the lower primitive number, else 0. Returns the
 * union of all. Depths are never NaN here (nodes refuse them). */
static inline uint32_t region_select_nearer(const float *depth_a, const uint32_t *primitive_a,
                                            const float *depth_b, const uint32_t *primitive_b,
                                            uint32_t count, uint32_t *restrict mask) {
    uint32_t any = 0;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t nearer = -(uint32_t)(depth_b[k] < depth_a[k]);
        const uint32_t equal = -(uint32_t)(depth_b[k] == depth_a[k]);
        const uint32_t lower = -(uint32_t)(primitive_b[k] < primitive_a[k]);
        mask[k] = nearer | (equal & lower);
        any |= mask[k];
    }
    return any;
}

#endif
