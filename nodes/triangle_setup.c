/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/triangle_setup.h"

#include "base/vector.h"

#include <math.h>

static struct vec3 vertex(const float *v, bool is_perspective) {
    return vec3_make(v[0], v[1], is_perspective ? v[2] : 1.0);
}

bool triangle_setup_make(const float *v0, const float *v1, const float *v2, bool is_perspective,
                         struct triangle_setup *setup) {
    const struct vec3 a = vertex(v0, is_perspective), b = vertex(v1, is_perspective),
                      c = vertex(v2, is_perspective);
    const struct vec3 rows[3] = {vec3_cross(b, c), vec3_cross(c, a), vec3_cross(a, b)};
    const double determinant = vec3_dot(a, rows[0]);
    if (!isfinite(determinant) || determinant == 0 || !isfinite(1 / determinant))
        return false;
    const float *vertices[3] = {v0, v1, v2};
    *setup = (struct triangle_setup){0};
    for (int i = 0; i < 3; i++) {
        const double w[3] = {rows[i].x / determinant, rows[i].y / determinant,
                             rows[i].z / determinant};
        for (int j = 0; j < 3; j++) {
            if (!isfinite(w[j]))
                return false;
            setup->weight[i][j] = w[j];
            setup->depth_denominator[j] += w[j];
            setup->depth_numerator[j] += w[j] * vertices[i][2];
        }
    }
    if (is_perspective) { /* sum w_i z_i is exactly 1 */
        setup->depth_numerator[0] = setup->depth_numerator[1] = 0;
        setup->depth_numerator[2] = 1;
    } else { /* sum w_i is exactly 1 */
        setup->depth_denominator[0] = setup->depth_denominator[1] = 0;
        setup->depth_denominator[2] = 1;
    }
    return true;
}
