/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STREAM_CACHE_H
#define STREAM_CACHE_H

#include "nodes/frame_plan.h"

/* Instruction streams from frame to frame (PF section 6.1.6): that of an instance or light is
 * generated anew only when a value that it is given has changed since the frame before. */

struct stream_counts {
    uint32_t generated, reused;
};

struct stream_cache {
    uint64_t *hashes; /* of what the streams of the last frame were given; lights, then instances */
    size_t count;
};

/* Counts for the next frame, and remembers it. */
struct stream_counts stream_cache_next(struct stream_cache *cache, const struct frame_plan *plan);
/* Counts for a frame that repeats the last. */
struct stream_counts stream_cache_repeat(const struct stream_cache *cache);
void stream_cache_finish(struct stream_cache *cache);

#endif
