/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MESH_BUILDER_H
#define MESH_BUILDER_H

#include "scenes/tessellate.h"

/* Allocates the arrays of a mesh and fills them vertex by vertex. */

/* Where a vertex takes the values of primitive variables from: indices into the values of each
 * storage class with their weights. */
struct vertex_source {
    size_t uniform;
    int corner_count; /* 1 or 4 */
    size_t varying[4], facevarying[4];
    double corner_weights[4];
    int point_count; /* of STORAGE_VERTEX: 1, 4 or 16 */
    size_t points[16];
    double point_weights[16];
};

/* A point of a surface in object space. */
struct surface_point {
    struct vec3 position, dpdu, dpdv, normal; /* the normal as dPdu x dPdv, of any length */
    double u, v, s, t;
};

struct mesh_builder {
    const struct tessellation *tessellation;
    const struct primitive *primitive;
    size_t vertex_count, triangle_capacity, triangle_count;
    float *positions, *n, *ng, *u, *v, *s, *t, *dpdu, *dpdv;
    bool has_user_n, has_user_s, has_user_t; /* from primitive variables */
    float **user; /* for each primitive variable its array, or NULL when it is not interpolated */
    uint32_t *triangles;
    size_t dropped; /* triangles with a corner that is not finite */
};

/* With `shares_st`, s and t are u and v unless the file gives them. Fails with STATUS_LIMIT when
 * the counts pass the limits. */
bool mesh_builder_start(struct mesh_builder *builder, const struct tessellation *tessellation,
                        const struct primitive *primitive, size_t vertex_count,
                        size_t triangle_capacity, bool shares_st, struct scene_mesh *mesh,
                        struct status *status);
void mesh_builder_put(struct mesh_builder *builder, size_t vertex,
                      const struct surface_point *point, const struct vertex_source *source);
/* Corners in the order that goes with dPdu x dPdv in object space; triangles with two equal or any
 * non-finite corners are dropped. All vertices must have been put. */
void mesh_builder_triangle(struct mesh_builder *builder, size_t a, size_t b, size_t c);
/* The two triangles of every cell of a grid of (nu + 1) x (nv + 1) vertices stored u fastest;
 * neighbouring cells come close together in the order of triangles. */
void mesh_builder_grid(struct mesh_builder *builder, size_t first_vertex, size_t nu, size_t nv);
void mesh_builder_finish(struct mesh_builder *builder, struct scene_mesh *mesh, size_t *dropped);

/* Whether the standard texture coordinates (s,t) = (u,v) hold. */
bool texture_coordinates_are_uv(const double *texture_coordinates);

#endif
