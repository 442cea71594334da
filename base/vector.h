/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_VECTOR_H
#define BASE_VECTOR_H

#include <stdbool.h>

/* Geometry on the host side, in double. Points are row vectors as in RIB: p' = p M, so that M = A B
 * applies A first; m[3] holds the translation. */
struct vec3 {
    double x, y, z;
};

struct mat4 {
    double m[4][4];
};

static inline struct vec3 vec3_make(double x, double y, double z) {
    return (struct vec3){x, y, z};
}
static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b) {
    return vec3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct vec3 vec3_subtract(struct vec3 a, struct vec3 b) {
    return vec3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct vec3 vec3_scale(struct vec3 a, double s) {
    return vec3_make(a.x * s, a.y * s, a.z * s);
}
static inline double vec3_dot(struct vec3 a, struct vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b) {
    return vec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
/* The zero vector stays zero. */
struct vec3 vec3_normalize(struct vec3 a);

extern const struct mat4 mat4_identity;
struct mat4 mat4_multiply(const struct mat4 *a, const struct mat4 *b);
struct mat4 mat4_translate(double x, double y, double z);
struct mat4 mat4_scale(double x, double y, double z);
/* Right-handed rotation by degrees about an axis; a zero axis gives the identity. */
struct mat4 mat4_rotate(double degrees, double x, double y, double z);
/* Returns false and leaves *inverse alone when the matrix is singular or not finite. */
bool mat4_invert(const struct mat4 *matrix, struct mat4 *inverse);
double mat4_determinant3(const struct mat4 *matrix);
struct vec3 mat4_point(const struct mat4 *matrix, struct vec3 p); /* divides by w when w is not 1 */
struct vec3 mat4_vector(const struct mat4 *matrix, struct vec3 v);
/* Normals go by the inverse transpose; `inverse` is the inverse of the matrix that moves the
 * points. */
struct vec3 mat4_normal(const struct mat4 *inverse, struct vec3 n);

#endif
