/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REGION_BINS_H
#define REGION_BINS_H

#include "nodes/protocol.h"
#include "nodes/triangle_setup.h"

#include <stdint.h>

/* Which regions a node's triangles fall into, and within a region which tiles of 4 x 4 samples:
 * rays are cast only there, and a region without a bin costs nothing (contract C4). */

enum { TILE_SAMPLES = 4 }; /* each way: 16 rays, one Embree packet */

struct region_bin {
    uint32_t triangles;   /* whose screen rectangle touches the region: what raster is charged */
    bool is_covered;      /* some triangle covers a sample of the region, hidden or not */
    uint32_t longest_map; /* in bytes, among the triangles that do */
    uint32_t entry;       /* of the chunk at hand, plus 1; when work is recorded */
    uint64_t tiles[];     /* bit per tile, rows of bins->tile_words words */
};

struct region_bins {
    struct region_grid grid;
    uint32_t tile_columns, tile_rows, tile_words; /* of one region; words per row of tiles */
    struct region_bin **bins;                     /* one a region; NULL: nothing there */
    bool records_work;
    struct chunk_work *entries; /* when work is recorded: by chunk, then region */
    size_t entry_count, entry_capacity;
};

struct binned_triangle {
    const float *v[3]; /* camera space */
    const struct triangle_setup *setup;
    uint32_t chunk;     /* its number; chunks come one after the other */
    uint32_t map_bytes; /* of its instance */
};

/* Sample columns and rows of the picture, inclusive. */
struct sample_box {
    uint32_t x0, x1, y0, y1;
};

void region_bins_init(struct region_bins *bins, const struct region_grid *grid, bool records_work);
void region_bins_finish(struct region_bins *bins);
/* Adds a triangle. Parts in front of the near plane are cut off first; coordinates that are not
 * finite are ignored. Returns the samples that can see it: whatever else is in their tiles, no
 * others may, or what a sample sees would depend on which triangles a node has (contract C1). */
struct sample_box region_bins_add(struct region_bins *bins, const struct frame_payload *frame,
                                  const struct binned_triangle *triangle);

static inline bool region_bin_has_tile(const struct region_bins *bins, const struct region_bin *bin,
                                       uint32_t column, uint32_t row) {
    return bin->tiles[row * bins->tile_words + column / 64] >> (column % 64) & 1;
}

#endif
