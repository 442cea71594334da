/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REGION_H
#define REGION_H

#include "netsim/wire.h"

#include <stdint.h>

/* The samples of one region on their way down the composition chain: runs of covered samples, and
 * one plane per quantity with an entry for each covered sample (structure of arrays), so that
 * composition is a streaming select and an empty region is a header.
 *
 * Payload: struct region_head, runs, then the planes depth (float), primitive (uint32), shader
 * (uint16, padded to 4 bytes), and `slots` planes of parameters (float); last, where they can grow,
 * the raster work entries. */

struct region_run {
    uint32_t first, count; /* sample index = row * region width + column */
};

/* Raster work of one rendering node in this region; rides along for the timing model. */
struct region_work {
    uint32_t node;
    uint32_t triangles;
};

struct region_head {
    uint32_t run_count, sample_count;
    uint32_t slots;       /* parameter planes: the longest map among the samples here, in floats */
    uint32_t longest_map; /* the longest map, in bytes after the shader ID, among the candidates any
                             node offered */
    uint32_t work_count;
    uint32_t nan_depths; /* samples refused because their depth was not a number */
    uint32_t rays;       /* cast for this region by all nodes so far */
    uint32_t composed;   /* samples that came out of compositions so far, one count a hop */
};

/* A region message taken apart; points into the message. */
struct region_view {
    struct region_head head;
    const struct region_work *work;
    const struct region_run *runs;
    const float *depth;
    const uint32_t *primitive;
    const uint16_t *shader;
    const float *slots; /* plane p at slots + p * sample_count */
};

/* Checks everything a consumer relies on: runs ascending and inside `region_samples`, counts,
 * finite work. Fails on any damage. */
bool region_open(const uint8_t *message_bytes, size_t length, uint32_t region_samples,
                 struct region_view *view, struct status *status);

/* The number of samples of a message that is only passed on, without a look at the rest; 0 for one
 * too short. */
uint32_t region_sample_count(const uint8_t *message_bytes, size_t length);

/* A region message being made: exact size known beforehand. The arrays are filled by the caller
 * through the non-const twins of region_view, then region_seal. */
struct region_draft {
    struct message *message;
    struct region_head head;
    struct region_work *work;
    struct region_run *runs;
    float *depth;
    uint32_t *primitive;
    uint16_t *shader;
    float *slots;
};

struct region_draft region_draft_create(struct region_head head);
/* A look at a draft whose arrays are filled, for composition before it is sealed. */
struct region_view region_draft_view(const struct region_draft *draft);
/* Hands over the finished message. */
struct message *region_seal(struct region_draft *draft, uint32_t frame, uint32_t region,
                            uint32_t sender);

/* A message with the samples [first, end) of a region alone. Raster work and refused samples ride
 * along with one part of the region only: `with_work`. */
struct message *region_extract(const struct region_view *view, uint32_t first, uint32_t end,
                               bool with_work, uint32_t frame, uint32_t region, uint32_t sender);

/* Image composition (PF section 5.1): for each sample the nearer of the two; at equal depth the
 * lower primitive number (contract C1). Work entries are joined by ascending node, the longest map
 * is the longer one. Order of the arguments does not matter, and composition is associative. */
struct message *region_compose(const struct region_view *a, const struct region_view *b,
                               uint32_t frame, uint32_t region, uint32_t sender);

/* The same, to the byte, by changing `message`, of which `view` is a look: only samples of `other`
 * that are nearer are written. False, and nothing is changed, when the message covers less than
 * `other` does, has fewer slots, no room for the work entries, or another holder. The view ends
 * with the call. */
bool region_compose_in_place(struct message *message, const struct region_view *view,
                             const struct region_view *other, uint32_t frame, uint32_t region,
                             uint32_t sender);

#endif
