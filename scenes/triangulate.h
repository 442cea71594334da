/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TRIANGULATE_H
#define TRIANGULATE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Above this many corners, only convex polygons are cut: cutting ears takes time quadratic in them.
 */
enum { TRIANGULATE_CORNERS_MAX = 16384 };

/* Cuts a polygon in the plane into triangles. `points` holds x, y of all corners, loop after loop;
 * the first loop is the outline, the others are holes, each in either direction. `triangles` has
 * room for 3 * (corners + 2 * loops) indices of corners and gets *triangle_count triples, which go
 * round like the outline. Outlines that cross themselves give some triangles of the corners. Fails
 * only on the limit. */
bool triangulate_polygon(const double *points, const int *loop_corners, int loop_count,
                         uint32_t *triangles, size_t *triangle_count, struct status *status);

#endif
