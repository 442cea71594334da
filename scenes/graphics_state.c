/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/graphics_state.h"

#include <stdlib.h>
#include <string.h>

const double basis_bezier[4][4] = {{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}};

void rib_shader_release(struct rib_shader *shader) {
    if (!shader || --shader->references > 0)
        return;
    for (int i = 0; i < shader->shader.parameter_count; i++) {
        free((void *)shader->shader.parameters[i].values);
        free((void *)shader->shader.parameters[i].strings);
    }
    free(shader->shader.parameters);
    free(shader);
}

static void light_set_release(struct light_set *set) {
    if (!set || --set->references > 0)
        return;
    for (int i = 0; i < set->count; i++)
        rib_shader_release(set->lights[i]);
    free(set->lights);
    free(set);
}

/* A set that only this state holds, with the same lights. */
static struct light_set *light_set_unshare(struct graphics_state *state) {
    struct light_set *shared = state->lights;
    if (shared && shared->references == 1) {
        shared->frame_copy = NULL;
        return shared;
    }
    struct light_set *set = memory_get(1, sizeof *set);
    set->references = 1;
    if (shared) {
        set->lights =
            memory_grow(NULL, &set->capacity, (size_t)shared->count + 1, sizeof *set->lights);
        for (set->count = 0; set->count < shared->count; set->count++) {
            set->lights[set->count] = shared->lights[set->count];
            set->lights[set->count]->references++;
        }
    }
    light_set_release(shared);
    state->lights = set;
    return set;
}

void graphics_state_switch_light(struct graphics_state *state, struct rib_shader *light,
                                 bool is_on) {
    int count = state->lights ? state->lights->count : 0, at = count;
    while (at > 0 && state->lights->lights[at - 1]->sequence >= light->sequence)
        at--;
    bool was_on = at < count && state->lights->lights[at] == light;
    if (was_on == is_on)
        return;
    struct light_set *set = light_set_unshare(state);
    if (is_on) {
        set->lights =
            memory_grow(set->lights, &set->capacity, (size_t)count + 1, sizeof *set->lights);
        memmove(set->lights + at + 1, set->lights + at, (size_t)(count - at) * sizeof *set->lights);
        set->lights[at] = light;
        set->count++;
        light->references++;
    } else {
        memmove(set->lights + at, set->lights + at + 1,
                (size_t)(count - at - 1) * sizeof *set->lights);
        set->count--;
        rib_shader_release(light);
    }
}

void graphics_state_set_shader(struct rib_shader **place, struct rib_shader *shader) {
    rib_shader_release(*place);
    *place = shader;
}

void graphics_state_init(struct graphics_state *state) {
    *state = (struct graphics_state){.transform = mat4_identity,
                                     .color = {1, 1, 1},
                                     .opacity = {1, 1, 1},
                                     .sides = 2,
                                     .basis_step = {3, 3},
                                     .texture_coordinates = {0, 0, 1, 0, 0, 1, 1, 1}};
    memcpy(state->basis[0], basis_bezier, sizeof basis_bezier);
    memcpy(state->basis[1], basis_bezier, sizeof basis_bezier);
}

void graphics_state_copy(struct graphics_state *copy, const struct graphics_state *state) {
    *copy = *state;
    struct rib_shader *const shaders[] = {copy->surface, copy->displacement, copy->atmosphere};
    for (size_t i = 0; i < sizeof shaders / sizeof *shaders; i++)
        if (shaders[i])
            shaders[i]->references++;
    if (copy->lights)
        copy->lights->references++;
}

void graphics_state_finish(struct graphics_state *state) {
    rib_shader_release(state->surface);
    rib_shader_release(state->displacement);
    rib_shader_release(state->atmosphere);
    light_set_release(state->lights);
    *state = (struct graphics_state){0};
}
