/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/distribution.h"

#include "base/rng.h"
#include "base/status.h"

uint32_t *distribution_assign(size_t chunk_count, uint32_t rendering_nodes, uint64_t seed) {
    uint32_t *node = memory_get(chunk_count, sizeof *node);
    struct rng rng = {seed};
    for (size_t i = 0; i < chunk_count; i++)
        node[i] = (uint32_t)(i % rendering_nodes);
    for (size_t i = chunk_count; i > 1; i--) {
        const size_t j = rng_below(&rng, i);
        const uint32_t swap = node[i - 1];
        node[i - 1] = node[j];
        node[j] = swap;
    }
    return node;
}
