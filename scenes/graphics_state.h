/* SPDX-License-Identifier: Apache-2.0 */
#ifndef GRAPHICS_STATE_H
#define GRAPHICS_STATE_H

#include "scenes/primitive.h"
#include "scenes/scene.h"

/* What AttributeBegin saves and AttributeEnd restores. Shaders and light sets are shared by
 * counting. */

/* A Surface or LightSource call. `shader` and everything in it is owned, names are interned. */
struct rib_shader {
    int references;
    uint64_t sequence; /* order of definition */
    struct scene_shader shader;
    struct scene_shader *frame_copy; /* in the arena of the frame with this serial number */
    uint64_t frame_serial;
};

void rib_shader_release(struct rib_shader *shader); /* accepts NULL */

/* The lights that are on, in order of definition; immutable once shared. */
struct light_set {
    int references;
    int count;
    size_t capacity;
    struct rib_shader **lights;
    const struct scene_shader *const *frame_copy;
    uint64_t frame_serial;
};

enum surface_orientation {
    ORIENTATION_OUTSIDE,
    ORIENTATION_INSIDE,
    ORIENTATION_LH,
    ORIENTATION_RH
};

struct graphics_state {
    struct mat4 transform; /* object to world inside a world, to camera before */
    float color[3], opacity[3];
    int sides;
    enum surface_orientation orientation;
    struct rib_shader *surface, *displacement, *atmosphere; /* NULL: none */
    struct light_set *lights;                               /* NULL: none */
    double basis[2][4][4];                                  /* u, v */
    int basis_step[2];
    double texture_coordinates[8];
};

void graphics_state_init(struct graphics_state *state);
void graphics_state_copy(struct graphics_state *copy, const struct graphics_state *state);
void graphics_state_finish(struct graphics_state *state);

/* Puts a shader in one of the places above; takes over the caller's reference. */
void graphics_state_set_shader(struct rib_shader **place, struct rib_shader *shader);
/* Does nothing when the light already is what it should be. */
void graphics_state_switch_light(struct graphics_state *state, struct rib_shader *light,
                                 bool is_on);

extern const double basis_bezier[4][4];

#endif
