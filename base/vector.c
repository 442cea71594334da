/* SPDX-License-Identifier: Apache-2.0 */
#include "base/vector.h"

#include <math.h>

const struct mat4 mat4_identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

struct vec3 vec3_normalize(struct vec3 a) {
    double length = sqrt(vec3_dot(a, a));
    return length > 0 ? vec3_scale(a, 1 / length) : a;
}

struct mat4 mat4_multiply(const struct mat4 *a, const struct mat4 *b) {
    struct mat4 product;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a->m[i][k] * b->m[k][j];
            product.m[i][j] = sum;
        }
    return product;
}

struct mat4 mat4_translate(double x, double y, double z) {
    struct mat4 matrix = mat4_identity;
    matrix.m[3][0] = x;
    matrix.m[3][1] = y;
    matrix.m[3][2] = z;
    return matrix;
}

struct mat4 mat4_scale(double x, double y, double z) {
    struct mat4 matrix = mat4_identity;
    matrix.m[0][0] = x;
    matrix.m[1][1] = y;
    matrix.m[2][2] = z;
    return matrix;
}

struct mat4 mat4_rotate(double degrees, double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0))
        return mat4_identity;
    x /= length;
    y /= length;
    z /= length;
    double angle = degrees * (M_PI / 180), c = cos(angle), s = sin(angle), t = 1 - c;
    return (struct mat4){{{t * x * x + c, t * x * y + s * z, t * x * z - s * y, 0},
                          {t * x * y - s * z, t * y * y + c, t * y * z + s * x, 0},
                          {t * x * z + s * y, t * y * z - s * x, t * z * z + c, 0},
                          {0, 0, 0, 1}}};
}

bool mat4_invert(const struct mat4 *matrix, struct mat4 *inverse) {
    double work[4][8];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            work[i][j] = matrix->m[i][j];
            work[i][j + 4] = i == j;
        }
    for (int column = 0; column < 4; column++) {
        int pivot = column;
        for (int row = column + 1; row < 4; row++)
            if (fabs(work[row][column]) > fabs(work[pivot][column]))
                pivot = row;
        double value = work[pivot][column];
        if (!isfinite(value) || value == 0)
            return false;
        for (int j = 0; j < 8; j++) {
            double swap = work[pivot][j];
            work[pivot][j] = work[column][j];
            work[column][j] = swap / value;
        }
        for (int row = 0; row < 4; row++) {
            if (row == column)
                continue;
            double factor = work[row][column];
            for (int j = 0; j < 8; j++)
                work[row][j] -= factor * work[column][j];
        }
    }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(work[i][j + 4]))
                return false;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            inverse->m[i][j] = work[i][j + 4];
    return true;
}

double mat4_determinant3(const struct mat4 *matrix) {
    const double(*m)[4] = matrix->m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

struct vec3 mat4_point(const struct mat4 *matrix, struct vec3 p) {
    const double(*m)[4] = matrix->m;
    struct vec3 q = {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
                     p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
                     p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
    double w = p.x * m[0][3] + p.y * m[1][3] + p.z * m[2][3] + m[3][3];
    return w == 1 ? q : vec3_scale(q, 1 / w);
}

struct vec3 mat4_vector(const struct mat4 *matrix, struct vec3 v) {
    const double(*m)[4] = matrix->m;
    return vec3_make(v.x * m[0][0] + v.y * m[1][0] + v.z * m[2][0],
                     v.x * m[0][1] + v.y * m[1][1] + v.z * m[2][1],
                     v.x * m[0][2] + v.y * m[1][2] + v.z * m[2][2]);
}

struct vec3 mat4_normal(const struct mat4 *inverse, struct vec3 n) {
    const double(*m)[4] = inverse->m;
    return vec3_make(n.x * m[0][0] + n.y * m[0][1] + n.z * m[0][2],
                     n.x * m[1][0] + n.y * m[1][1] + n.z * m[1][2],
                     n.x * m[2][0] + n.y * m[2][1] + n.z * m[2][2]);
}
