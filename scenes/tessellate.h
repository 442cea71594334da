/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TESSELLATE_H
#define TESSELLATE_H

#include "base/arena.h"
#include "base/status.h"
#include "scenes/primitive.h"
#include "scenes/scene.h"

/* From a primitive to a triangle mesh in camera space, fine enough for the pixels it will cover. */

struct tessellation {
    /* Given. */
    const struct scene_camera *camera;
    struct mat4 object_to_camera, camera_to_object;
    bool is_reversed; /* normals point against dPdu x dPdv of object space ("outside" is the latter)
                       */
    double chord_pixels;
    const double *texture_coordinates; /* 8: s and t at (u,v) = 00 10 01 11 */
    size_t triangles_max;              /* that this primitive may have */
    struct arena *arena;               /* owns the arrays of the mesh */
    /* Derived by tessellate. */
    bool is_affine, flips_winding;
    double scale_max; /* the most that the transform lengthens a vector */
    /* Result. */
    size_t dropped_triangles; /* because a coordinate is not finite */
};

/* Fills positions, triangles, variables and constants of *mesh. A primitive that is outside of the
 * view or has no area gives a mesh without triangles. Fails with STATUS_LIMIT past triangles_max,
 * and on polygons too large to cut; the message has no location. */
bool tessellate(struct tessellation *tessellation, const struct primitive *primitive,
                struct scene_mesh *mesh, struct status *status);

/* For the tessellators of the kinds of primitives. */

bool tessellate_quadric(struct tessellation *tessellation, const struct primitive *primitive,
                        struct scene_mesh *mesh, struct status *status);
bool tessellate_patches(struct tessellation *tessellation, const struct primitive *primitive,
                        struct scene_mesh *mesh, struct status *status);
bool tessellate_polygons(struct tessellation *tessellation, const struct primitive *primitive,
                         struct scene_mesh *mesh, struct status *status);

struct bounds {
    struct vec3 low, high;
};

struct bounds bounds_empty(void);
void bounds_add(struct bounds *bounds, struct vec3 point);

/* How an object-space box lies in the view. */
struct visibility {
    bool is_outside;        /* wholly: nothing of it can be seen */
    double pixels_per_unit; /* of object space, at most, for what of the box can be seen; capped
                               when the box reaches the eye */
};
struct visibility tessellation_visibility(const struct tessellation *tessellation,
                                          const struct bounds *bounds);

/* The same for a surface that is nowhere nearer to the eye than this, in object space. Affine maps
 * only. */
double tessellation_pixels_at_distance(const struct tessellation *tessellation, double distance);

enum { DIVISIONS_MAX = 1024, CIRCLE_DIVISIONS_MIN = 12 };

/* Chords for an arc so that none lies further than `tolerance` pixels from it. */
int divide_arc(double radius_pixels, double sweep_radians, double tolerance);
/* Chords for a curve whose second derivative over its whole parameter range is at most this. */
int divide_curve(double second_derivative_pixels, double tolerance);

#endif
