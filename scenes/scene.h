/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SCENE_H
#define SCENE_H

#include "base/arena.h"
#include "base/status.h"
#include "base/vector.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One frame of a scene as the host sends it to the cluster: a camera, lights, surfaces, and
 * triangle meshes in camera space. Whatever the file format, a reader ends here. */

enum scene_type {
    SCENE_FLOAT,
    SCENE_COLOR,
    SCENE_POINT,
    SCENE_VECTOR,
    SCENE_NORMAL,
    SCENE_STRING,
    SCENE_MATRIX
};
/* Floats of one value; 1 for a string. */
static inline int scene_type_components(enum scene_type type) {
    return type == SCENE_FLOAT || type == SCENE_STRING ? 1 : type == SCENE_MATRIX ? 16 : 3;
}

/* Where in the input something was said; `file` lives as long as the reader. */
struct scene_location {
    const char *file;
    int line, column;
};

/* A value given to a shader by name, on Surface or LightSource (bound parameters of the paper), or
 * a constant primitive variable. Points, vectors and normals are in the space they were given in
 * (shader space). */
struct scene_parameter {
    const char *name;
    enum scene_type type;
    int array_length;     /* 0: not an array */
    const float *values;  /* components * max(1, array_length) floats; NULL for strings */
    const char **strings; /* max(1, array_length) strings; NULL otherwise */
    struct scene_location location;
};

/* One Surface or LightSource call. Identical calls may be separate objects. */
struct scene_shader {
    const char *name; /* as written: found by the shader search path, with or without ".sl" */
    struct mat4 shader_to_camera;
    struct scene_parameter *parameters;
    int parameter_count;
    struct scene_location location;
};

/* A variable interpolated over a mesh: a primitive variable of the file, or one the tessellator
 * made. */
struct scene_variable {
    const char *name; /* "N", "Ng", "s", "t", "u", "v", "dPdu", "dPdv", "Cs", "Os", or the user's */
    enum scene_type type;
    int components;      /* floats per vertex, array length included */
    const float *values; /* vertex_count * components; points, vectors, normals in camera space */
};

struct scene_mesh {
    const struct scene_shader *surface;                   /* NULL: the default surface */
    const struct scene_shader *displacement, *atmosphere; /* NULL: none */
    const struct scene_shader *const *lights; /* those switched on for it, in order of definition */
    int light_count;
    float color[3], opacity[3];
    struct mat4 object_to_camera;
    bool is_two_sided;
    uint32_t vertex_count, triangle_count;
    const float *positions; /* vertex_count * 3, camera space */
    const uint32_t
        *triangles; /* triangle_count * 3; counter-clockwise seen from outside is not assumed */
    struct scene_variable
        *variables; /* always at least N, Ng, s, t, u, v, dPdu, dPdv unless not wanted */
    int variable_count;
    struct scene_parameter
        *constants; /* constant primitive variables that are strings or match no vertex use */
    int constant_count;
    struct scene_location location;
};

struct scene_camera {
    struct mat4 world_to_camera;
    bool is_perspective;
    double screen_window[4];  /* left, right, bottom, top on the plane z = 1 (perspective: already
                                 scaled by  tan(fov/2)) or in camera units (orthographic) */
    int width, height;        /* pixels */
    int samples_x, samples_y; /* samples per pixel each way */
    double near_plane, far_plane; /* camera z range that is visible; far may be infinite */
};

/* A coordinate system that the scene gave a name. */
struct scene_space {
    const char *name;
    struct mat4 to_camera;
};

struct scene_frame {
    struct arena arena;       /* owns everything below */
    int number;               /* of FrameBegin; 1 without */
    const char *display_name; /* file named by Display, NULL when none */
    struct scene_camera camera;
    struct scene_shader **lights; /* every light of the frame, in order of definition */
    int light_count;
    struct scene_space *spaces;
    int space_count;
    struct scene_mesh *meshes; /* in scene order: primitive numbers count through them */
    size_t mesh_count;
};

void scene_frame_destroy(struct scene_frame *frame);

/* What a reader should make of the file. */
struct scene_options {
    int width, height;        /* > 0: override Format */
    int samples_x, samples_y; /* > 0: override PixelSamples */
    double chord_pixels;  /* how far, in pixels, a diced curve may lie from the true one; 0: default
                             0.1 */
    size_t triangles_max; /* per frame; 0: default 50 million. More is a clear error. */
};

/* Reads RIB (the RenderMan Interface Bytestream, ASCII form). Frames are pulled one by one so that
 * memory holds one frame, not the animation. */
struct rib_reader;

bool rib_reader_open(const char *path, const struct scene_options *options,
                     struct rib_reader **reader, struct status *status);
/* The same from memory; `path` is used in messages and to find archives. For tests and fuzzing. */
bool rib_reader_open_memory(const char *path, const char *text, size_t length,
                            const struct scene_options *options, struct rib_reader **reader,
                            struct status *status);
/* The next frame (a world block); *frame becomes NULL at the end of the file. Errors name
 * "FILE:LINE:COLUMN: error: ..." with the source line and a caret. */
bool rib_reader_next(struct rib_reader *reader, struct scene_frame **frame, struct status *status);
/* Warnings since the last call, oldest first, each "FILE:LINE:COLUMN: warning: ...", one per
 * unknown request name and file; NULL when there is none left. Valid until the next call on this
 * reader. */
const char *rib_reader_warning(struct rib_reader *reader);
void rib_reader_destroy(struct rib_reader *reader);

#endif
