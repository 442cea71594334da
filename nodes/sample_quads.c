/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/sample_quads.h"

#include "base/status.h"

#include <stdlib.h>

void sample_quads_make(struct sample_quads *quads, const uint32_t *location, uint32_t region_width,
                       uint32_t region_height, const uint32_t *order, size_t count) {
    const size_t across = (region_width + 1) / 2, down = (region_height + 1) / 2;
    uint32_t *number = memory_get(across * down, sizeof *number); /* of the quad, plus 1 */
    quads->order = memory_get(4 * count, sizeof *quads->order);
    quads->present = memory_get(4 * count, 1);
    quads->lane_count = 0;
    for (size_t k = 0; k < count; k++) {
        const uint32_t x = location[order[k]] % region_width, y = location[order[k]] / region_width;
        uint32_t *quad = &number[y / 2 * across + x / 2];
        if (!*quad) {
            *quad = (uint32_t)(quads->lane_count += 4) / 4;
            for (size_t lane = quads->lane_count - 4; lane < quads->lane_count; lane++)
                quads->order[lane] = order[k];
        }
        const size_t lane = 4 * (size_t)(*quad - 1) + (y & 1) * 2 + (x & 1);
        quads->order[lane] = order[k];
        quads->present[lane] = 1;
    }
    free(number);
}

void sample_quads_finish(struct sample_quads *quads) {
    free(quads->order);
    free(quads->present);
    *quads = (struct sample_quads){0};
}
