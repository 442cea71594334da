/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/stream_cache.h"

#include <stdlib.h>

struct stream_counts stream_cache_next(struct stream_cache *cache, const struct frame_plan *plan) {
    const size_t count = plan->light_count + plan->instance_count;
    uint64_t *hashes = memory_get(count, sizeof *hashes);
    struct stream_counts counts = {0};
    for (size_t i = 0; i < count; i++) {
        const struct planned_instance *planned =
            i < plan->light_count ? &plan->lights[i] : &plan->instances[i - plan->light_count];
        /* shader, values, matrices, lights */
        hashes[i] = wire_payload_hash(planned->message->bytes);
        if (i < cache->count && cache->hashes[i] == hashes[i])
            counts.reused++;
        else
            counts.generated++;
    }
    free(cache->hashes);
    *cache = (struct stream_cache){hashes, count};
    return counts;
}

struct stream_counts stream_cache_repeat(const struct stream_cache *cache) {
    return (struct stream_counts){.reused = (uint32_t)cache->count};
}

void stream_cache_finish(struct stream_cache *cache) {
    free(cache->hashes);
    *cache = (struct stream_cache){0};
}
