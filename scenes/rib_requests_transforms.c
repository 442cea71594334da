/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <math.h>
#include <string.h>

/* The new transform applies before what is there: CTM = new * CTM. */
static void concatenate(struct rib_reader *reader, const struct mat4 *matrix) {
    reader->state.transform = mat4_multiply(matrix, &reader->state.transform);
}

bool read_identity(struct rib_reader *reader) {
    reader->state.transform = mat4_identity;
    return true;
}

static bool read_matrix(struct rib_reader *reader, struct mat4 *matrix) {
    double values[16];
    if (!rib_read_numbers(reader, "16 numbers of a matrix", values, 16))
        return false;
    memcpy(matrix->m, values, sizeof values);
    return true;
}

bool read_transform(struct rib_reader *reader) {
    return read_matrix(reader, &reader->state.transform);
}

bool read_concat_transform(struct rib_reader *reader) {
    struct mat4 matrix;
    if (!read_matrix(reader, &matrix))
        return false;
    concatenate(reader, &matrix);
    return true;
}

bool read_translate(struct rib_reader *reader) {
    double by[3];
    if (!rib_read_numbers(reader, "dx dy dz", by, 3))
        return false;
    struct mat4 matrix = mat4_translate(by[0], by[1], by[2]);
    concatenate(reader, &matrix);
    return true;
}

bool read_rotate(struct rib_reader *reader) {
    double values[4];
    if (!rib_read_numbers(reader, "angle dx dy dz", values, 4))
        return false;
    if (values[1] == 0 && values[2] == 0 && values[3] == 0)
        return rib_error(reader, &reader->request_at, "Rotate: the axis must not be zero");
    struct mat4 matrix = mat4_rotate(values[0], values[1], values[2], values[3]);
    concatenate(reader, &matrix);
    return true;
}

bool read_scale(struct rib_reader *reader) {
    double by[3];
    if (!rib_read_numbers(reader, "sx sy sz", by, 3))
        return false;
    struct mat4 matrix = mat4_scale(by[0], by[1], by[2]);
    concatenate(reader, &matrix);
    return true;
}

/* Moves points along `along` by tan(angle) times how far they are along `away`; after RI: a point
 * on `away` turns by `angle` degrees towards `along`. Both vectors should be perpendicular; if not,
 * `along` is split. */
bool read_skew(struct rib_reader *reader) {
    double v[7];
    if (!rib_read_numbers(reader, "angle dx1 dy1 dz1 dx2 dy2 dz2", v, 7))
        return false;
    struct vec3 away = vec3_normalize(vec3_make(v[1], v[2], v[3]));
    struct vec3 towards = vec3_normalize(vec3_make(v[4], v[5], v[6]));
    struct vec3 across = vec3_subtract(towards, vec3_scale(away, vec3_dot(towards, away)));
    if (vec3_dot(across, across) < 1e-20 || !(fabs(v[0]) < 90))
        return rib_error(reader, &reader->request_at,
                         "Skew: the vectors must differ in direction and the angle be below 90");
    across = vec3_scale(vec3_normalize(across), tan(v[0] * (M_PI / 180)));
    const double a[3] = {away.x, away.y, away.z}, t[3] = {across.x, across.y, across.z};
    struct mat4 matrix = mat4_identity;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix.m[i][j] += a[i] * t[j];
    concatenate(reader, &matrix);
    return true;
}

bool read_perspective(struct rib_reader *reader) {
    double degrees;
    if (!rib_read_number(reader, "fov", &degrees))
        return false;
    if (!(degrees > 0 && degrees < 180))
        return rib_error(reader, &reader->request_at,
                         "Perspective: fov must be above 0 and below 180");
    double d = tan(degrees * (M_PI / 360));
    struct mat4 matrix = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, d, d}, {0, 0, -d, 0}}};
    concatenate(reader, &matrix);
    return true;
}
