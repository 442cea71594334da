/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SAMPLE_QUADS_H
#define SAMPLE_QUADS_H

#include <stddef.h>
#include <stdint.h>

/* The samples of an instance whose shader asks about neighbours, arranged in quads: every 2 x 2
 * samples of the picture of which at least one is the instance's. Regions begin at even columns and
 * rows, so that no quad lies in two of them. Where the instance has no sample, the quad's first one
 * stands in, and `present` is 0. */
struct sample_quads {
    uint32_t *order;  /* sample of each lane */
    uint8_t *present; /* of each lane */
    size_t lane_count;
};

/* `order` lists the instance's `count` samples; location[sample] is the sample's place in the
 * region, row by row. */
void sample_quads_make(struct sample_quads *quads, const uint32_t *location, uint32_t region_width,
                       uint32_t region_height, const uint32_t *order, size_t count);
void sample_quads_finish(struct sample_quads *quads);

#endif
