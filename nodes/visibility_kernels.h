/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VISIBILITY_KERNELS_H
#define VISIBILITY_KERNELS_H

#include "nodes/region_bins.h"
#include "nodes/triangle_setup.h"

#include <stdint.h>

/* The inner loops of visibility, compiled for several instruction sets (visibility_kernels_set.c);
 * all give the same bits, as nothing is contracted or reassociated. */

enum { PACKET_LANES = TILE_SAMPLES * TILE_SAMPLES };

/* The samples of a packet, and the best hit of each so far. */
struct packet_lanes {
    _Alignas(64) double x[PACKET_LANES], y[PACKET_LANES];
    double tolerance[PACKET_LANES];                   /* triangle_setup_tolerance there */
    uint32_t column[PACKET_LANES], row[PACKET_LANES]; /* in the picture */
    float depth[PACKET_LANES];                        /* INFINITY: none */
    uint32_t triangle[PACKET_LANES], primitive[PACKET_LANES];
};

/* A triangle that the lanes are asked about. */
struct packet_triangle {
    const struct triangle_setup *setup;
    struct sample_box box; /* of the picture: the samples that can see it */
    uint32_t triangle, primitive;
    double near_plane, far_plane;
};

struct visibility_kernels {
    const char *name;
    bool (*is_supported)(void);
    /* Lanes with valid[i] = -1 that see the triangle (it is inside, by the rules of
     * triangle_setup.h, and between the planes) keep it where it is nearer than the best so far, or
     * as near with a lower primitive number; valid becomes 0 for those that do not see it. Returns
     * how many of these had a depth that is not a number. `valid` is aligned to 64 bytes. */
    uint32_t (*consider)(struct packet_lanes *lanes, const struct packet_triangle *candidate,
                         int32_t *valid);
    /* Barycentric coordinates of `count` samples of one row. */
    void (*weigh)(const struct triangle_setup *setup, const float *x, float y, uint32_t count,
                  float *const barycentric[3]);
    /* out[k] = b[0][k] corner[0] + b[1][k] corner[1] + b[2][k] corner[2] */
    void (*interpolate)(const float *const barycentric[3], const float corner[3], uint32_t count,
                        float *out);
};

/* The i-th set that this processor has, the plainest first; NULL after the last. */
const struct visibility_kernels *visibility_kernels_at(int i);
/* The last of these. */
const struct visibility_kernels *visibility_kernels_best(void);

#endif
