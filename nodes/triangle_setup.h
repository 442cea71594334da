/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TRIANGLE_SETUP_H
#define TRIANGLE_SETUP_H

#include <math.h>
#include <stdbool.h>

/* Depth and barycentric coordinates of a triangle as functions of the screen position, in double.
 * Embree says which triangles a sample may see; these say how deep each lies there, from nothing
 * but the triangle and the sample, so that depths are the same bits on whichever node the triangle
 * is (contract C1).
 *
 * With P = sum b_i v_i and P = z (X, Y, 1), the weights w_i = b_i / z are linear in X and Y
 * (perspective); orthographic views use (x, y, 1) in place of v_i and need no division. No clipping
 * is needed for either. */
struct triangle_setup {
    double weight[3][3]; /* w_i = weight[i][0] X + weight[i][1] Y + weight[i][2] */
    double depth_numerator[3], depth_denominator[3];
};

/* v: three vertices in camera space. False when the triangle has no area as seen from the eye, or
 * is not finite: it covers no sample. */
bool triangle_setup_make(const float *v0, const float *v1, const float *v2, bool is_perspective,
                         struct triangle_setup *setup);

/* How far outside an edge a sample may lie and still count as inside, in screen units times the
 * size of the edge's weights. */
static inline double triangle_setup_tolerance(double x, double y) {
    return 0x1p-21 * (1 + fabs(x) + fabs(y));
}

/* Is the sample inside the triangle, or so close to its edge that Embree's floats cannot tell? A
 * sample on an edge must be inside one of the two triangles there; what Embree reports farther
 * outside (it does, of needles) depends on what else is in its scene. */
static inline bool triangle_setup_is_inside(const struct triangle_setup *setup, double x,
                                            double y) {
    const double tolerance = triangle_setup_tolerance(x, y);
    for (int i = 0; i < 3; i++) {
        const double *w = setup->weight[i];
        if (w[0] * x + w[1] * y + w[2] < -tolerance * (fabs(w[0]) + fabs(w[1])))
            return false;
    }
    return true;
}

static inline float triangle_setup_depth(const struct triangle_setup *setup, float x, float y) {
    const double *n = setup->depth_numerator, *d = setup->depth_denominator;
    return (float)((n[0] * x + n[1] * y + n[2]) / (d[0] * x + d[1] * y + d[2]));
}

#endif
