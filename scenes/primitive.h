/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PRIMITIVE_H
#define PRIMITIVE_H

#include "base/vector.h"
#include "scenes/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A primitive as the file gives it, in object coordinates and double precision, before it is
 * tessellated. Objects keep theirs and tessellate them anew for every instance. */

enum storage_class {
    STORAGE_CONSTANT,    /* one value for the primitive */
    STORAGE_UNIFORM,     /* one for each face or patch */
    STORAGE_VARYING,     /* one for each corner, interpolated bilinearly */
    STORAGE_VERTEX,      /* one for each control point, interpolated like P */
    STORAGE_FACEVARYING, /* one for each corner of each face */
};

/* Types as RIB declares them; the reader turns integers into floats. */
enum rib_type {
    RIB_FLOAT,
    RIB_INTEGER,
    RIB_COLOR,
    RIB_POINT,
    RIB_VECTOR,
    RIB_NORMAL,
    RIB_HPOINT,
    RIB_MATRIX,
    RIB_STRING,
};

int rib_type_components(enum rib_type type);
const char *rib_type_name(enum rib_type type);
/* HPOINT and MATRIX have no counterpart and must not be asked for. */
enum scene_type rib_type_to_scene(enum rib_type type);

/* A named value of a parameter list. */
struct primitive_variable {
    const char *name; /* interned by the reader */
    enum storage_class storage;
    enum rib_type type;
    int array_length;     /* 0: not an array */
    size_t count;         /* numbers or strings */
    double *values;       /* owned; NULL for strings */
    const char **strings; /* the array is owned, the strings are interned */
    struct scene_location location;
};

static inline int primitive_variable_components(const struct primitive_variable *variable) {
    return rib_type_components(variable->type) *
           (variable->array_length > 0 ? variable->array_length : 1);
}

enum primitive_kind {
    PRIMITIVE_SPHERE,      /* radius zmin zmax thetamax */
    PRIMITIVE_CYLINDER,    /* radius zmin zmax thetamax */
    PRIMITIVE_CONE,        /* height radius thetamax */
    PRIMITIVE_DISK,        /* height radius thetamax */
    PRIMITIVE_PARABOLOID,  /* rmax zmin zmax thetamax */
    PRIMITIVE_HYPERBOLOID, /* point1 point2 thetamax */
    PRIMITIVE_TORUS,       /* majorradius minorradius phimin phimax thetamax */
    PRIMITIVE_PATCHES,
    PRIMITIVE_POLYGONS,
};

/* Control points in rows of point_count[0]; index 0 is u, 1 is v. */
struct patch_mesh {
    int order; /* 2 bilinear, 4 bicubic */
    int point_count[2], patch_count[2];
    int step[2];
    bool is_periodic[2];
    double basis[2][4][4];
};

/* Faces made of loops (the first is the outline, others are holes) of corners that index points. */
struct polygon_mesh {
    size_t face_count, loop_count, corner_count, point_count;
    int *face_loops;   /* loops of each face; owned, as below */
    int *loop_corners; /* corners of each loop */
    int *corners;
};

struct primitive {
    enum primitive_kind kind;
    double arguments[7];
    struct patch_mesh patches;
    struct polygon_mesh polygons;
    struct primitive_variable *variables; /* owned */
    int variable_count;
    struct mat4
        transform; /* object to the space that was current at ObjectBegin; identity outside */
    struct scene_location location;
};

void primitive_variables_free(struct primitive_variable *variables, int count);
/* Releases what the primitive owns, not the primitive itself. */
void primitive_finish(struct primitive *primitive);
const struct primitive_variable *primitive_find_variable(const struct primitive *primitive,
                                                         const char *name);
/* How many values (not numbers) a variable of this storage class must have. */
size_t primitive_value_count(const struct primitive *primitive, enum storage_class storage);

#endif
