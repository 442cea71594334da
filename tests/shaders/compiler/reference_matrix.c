/* SPDX-License-Identifier: Apache-2.0 */
#define SHADER_WIDTH 4
#include "reference_internal.h"

#include "shaders/simd/vector_math.h"

#include <string.h>

/* Matrices by rows, for row vectors. The order of operations is part of what is compared. */

struct reference_value reference_matrix_diagonal(float number) {
    struct reference_value m = {.count = 16};
    for (int i = 0; i < 16; i += 5)
        m.part[i] = number;
    return m;
}

static void product(const float a[16], const float b[16], float result[16]) {
    for (int i = 0; i < 16; i++) {
        const float *row = a + i / 4 * 4, *column = b + i % 4;
        result[i] =
            row[0] * column[0] + row[1] * column[4] + row[2] * column[8] + row[3] * column[12];
    }
}

/* Laplace's expansion by the upper and the lower two rows: determinants of pairs of columns. */
static float minors(const float m[16], float upper[6], float lower[6]) {
    int n = 0;
    for (int a = 0; a < 3; a++)
        for (int b = a + 1; b < 4; b++, n++) {
            upper[n] = m[a] * m[4 + b] - m[4 + a] * m[b];
            lower[n] = m[8 + a] * m[12 + b] - m[12 + a] * m[8 + b];
        }
    return upper[0] * lower[5] - upper[1] * lower[4] + upper[2] * lower[3] + upper[3] * lower[2] -
           upper[4] * lower[1] + upper[5] * lower[0];
}

/* The pair of columns a < b among the six. */
static int pair_of(int a, int b) {
    return a == 0 ? b - 1 : a == 1 ? b + 1 : 5;
}

/* The adjugate over the determinant; element (i, j) from the cofactor of (j, i), its row expanded
 * over the three columns other than i. */
static void inverse(const float m[16], float result[16]) {
    float upper[6], lower[6], determinant = minors(m, upper, lower);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            static const int partner[4] = {1, 0, 3, 2}; /* the other row of the same half */
            const float *half = j < 2 ? lower : upper;
            int columns[3], n = 0;
            for (int c = 0; c < 4; c++)
                if (c != i)
                    columns[n++] = c;
            float t[3];
            for (int k = 0; k < 3; k++) {
                int a = columns[k == 0 ? 1 : 0], b = columns[k == 2 ? 1 : 2];
                t[k] = m[partner[j] * 4 + columns[k]] * half[pair_of(a, b)];
            }
            float sum = t[0] - t[1] + t[2];
            result[i * 4 + j] = ((i + j) % 2 ? -sum : sum) / determinant;
        }
}

struct reference_value reference_matrix_product(bool divides, const struct reference_value *a,
                                                const struct reference_value *b) {
    struct reference_value result = {.count = 16};
    float inverted[16];
    if (divides)
        inverse(b->part, inverted);
    product(a->part, divides ? inverted : b->part, result.part);
    return result;
}

struct reference_value reference_matrix_in_space(struct reference *r, int32_t space,
                                                 const struct reference_value *matrix) {
    if (space == SHADER_SPACE_CURRENT || space == SHADER_SPACE_CAMERA)
        return *matrix;
    struct reference_value result = {.count = 16};
    product(matrix->part, r->world->matrices->to_camera[space], result.part);
    return result;
}

/* p M, v M; a normal by the transpose of the inverse. */
static struct reference_value transform(enum builtin_id id, const float m[16], const float v[3]) {
    struct reference_value result = {.count = 3};
    float inverted[16];
    if (id == BUILTIN_NTRANSFORM)
        inverse(m, inverted);
    for (int j = 0; j < 3; j++) {
        const float *n = inverted + j * 4;
        result.part[j] = id == BUILTIN_NTRANSFORM ? v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
                                                  : v[0] * m[j] + v[1] * m[4 + j] + v[2] * m[8 + j];
        if (id == BUILTIN_TRANSFORM)
            result.part[j] += m[12 + j];
    }
    return result;
}

/* The rotation by an angle about an axis, its upper left part. */
static void rotation(struct reference *r, float angle, const float direction[3], float m[3][3]) {
    float length = sf_sqrt(reference_dot(direction, direction)), axis[3];
    float c = reference_cosine(r, angle), s = r->fast_math ? sf_sin_fast(angle) : sf_sin(angle);
    for (int i = 0; i < 3; i++)
        axis[i] = direction[i] / length;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            float both = (1 - c) * (axis[i] * axis[j]);
            m[i][j] = i == j             ? both + c
                      : (i + 1) % 3 == j ? both + s * axis[3 - i - j]
                                         : both - s * axis[3 - i - j];
        }
}

/* The new transformation comes before what m does. Elements that every such transformation has 0 or
 * 1 take no part. */
static struct reference_value append(struct reference *r, enum builtin_id id,
                                     const struct reference_value *arguments) {
    struct reference_value result = arguments[0];
    const float *m = arguments[0].part, *v = arguments[1].part;
    float turn[3][3];
    if (id == BUILTIN_ROTATE)
        rotation(r, arguments[1].part[0], arguments[2].part, turn);
    for (int j = 0; j < 4; j++) {
        if (id == BUILTIN_TRANSLATE)
            result.part[12 + j] = v[0] * m[j] + v[1] * m[4 + j] + v[2] * m[8 + j] + m[12 + j];
        for (int i = 0; i < 3 && id != BUILTIN_TRANSLATE; i++)
            result.part[i * 4 + j] =
                id == BUILTIN_SCALE
                    ? v[i] * m[i * 4 + j]
                    : turn[i][0] * m[j] + turn[i][1] * m[4 + j] + turn[i][2] * m[8 + j];
    }
    return result;
}

int reference_matrix_element(float row, float column) {
    float part[2] = {row, column};
    for (int i = 0; i < 2; i++)
        part[i] = sf_min(sf_max(sf_floor(part[i]), 0), 3);
    return reference_index(part[0] * 4 + part[1], 16);
}

struct reference_value reference_matrix_builtin(struct reference *r, enum builtin_id id,
                                                const struct reference_value *arguments) {
    struct reference_value result = {.count = 1};
    float upper[6], lower[6];
    const float *m = arguments[0].part;
    switch (id) {
    case BUILTIN_TRANSFORM:
    case BUILTIN_VTRANSFORM:
    case BUILTIN_NTRANSFORM:
        return transform(id, m, arguments[1].part);
    case BUILTIN_DETERMINANT:
        result.part[0] = minors(m, upper, lower);
        return result;
    case BUILTIN_COMP:
        result.part[0] = m[reference_matrix_element(arguments[1].part[0], arguments[2].part[0])];
        return result;
    default:
        return append(r, id, arguments);
    }
}
