/* SPDX-License-Identifier: Apache-2.0 */
#ifndef DISTRIBUTION_H
#define DISTRIBUTION_H

#include <stddef.h>
#include <stdint.h>

/* Which rendering node gets each chunk of primitives: a permutation drawn from `seed`, dealt round
 * (FACTS: an effectively random subset of the primitives). The array is the caller's. */
uint32_t *distribution_assign(size_t chunk_count, uint32_t rendering_nodes, uint64_t seed);

#endif
