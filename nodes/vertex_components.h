/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VERTEX_COMPONENTS_H
#define VERTEX_COMPONENTS_H

#include "scenes/scene.h"
#include "shaders/compiler/shader_compile.h"

/* Where one component of the transfer map comes from: a plane of the mesh, or a constant. */
struct vertex_component {
    const float *values; /* first vertex's component */
    size_t stride;       /* floats from vertex to vertex; 0 for a constant */
};

/* All components of a mesh in the order of the transfer map of its shader. */
struct vertex_components {
    struct vertex_component *list;
    uint32_t count;
    float **transformed; /* values in camera space that the mesh has in object space */
    size_t transformed_count, transformed_capacity;
};

/* The lists point into the mesh, which must outlive them. */
void vertex_components_list(const struct scene_mesh *mesh, const struct shader_program *program,
                            struct vertex_components *components);
void vertex_components_finish(struct vertex_components *components);

/* A primitive variable of the mesh, or NULL. */
const struct scene_variable *scene_mesh_variable(const struct scene_mesh *mesh, const char *name);

#endif
