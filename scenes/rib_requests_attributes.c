/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Objects take their attributes from where they are instanced. */
static void warn_in_object(struct rib_reader *reader) {
    if (reader->in_object)
        rib_warn(reader, &reader->request_at, "attribute in object",
                 "%s in an object has no effect: instances take the attributes at ObjectInstance",
                 reader->request);
}

static bool read_three(struct rib_reader *reader, const char *what, float out[3]) {
    double values[3];
    warn_in_object(reader);
    if (!rib_read_numbers(reader, what, values, 3))
        return false;
    for (int i = 0; i < 3; i++) {
        if (!(fabs(values[i]) <= FLT_MAX))
            return rib_error(reader, &reader->request_at, "%s: %g is beyond the range of floats",
                             reader->request, values[i]);
        out[i] = (float)values[i];
    }
    return true;
}

bool read_color(struct rib_reader *reader) {
    return read_three(reader, "three numbers of a colour", reader->state.color);
}

bool read_opacity(struct rib_reader *reader) {
    return read_three(reader, "three numbers of an opacity", reader->state.opacity);
}

bool read_sides(struct rib_reader *reader) {
    warn_in_object(reader);
    return rib_read_integer(reader, "sides", 1, 2, &reader->state.sides);
}

bool read_orientation(struct rib_reader *reader) {
    static const char *const names[] = {"outside", "inside", "lh", "rh"};
    struct rib_location location = rib_peek(reader)->location;
    const char *name;
    warn_in_object(reader);
    if (!rib_read_string(reader, "orientation", &name))
        return false;
    for (int i = 0; i < 4; i++)
        if (strcmp(names[i], name) == 0) {
            reader->state.orientation = (enum surface_orientation)i;
            return true;
        }
    return rib_error(reader, &location, "Orientation is \"outside\", \"inside\", \"lh\" or \"rh\"");
}

bool read_reverse_orientation(struct rib_reader *reader) {
    warn_in_object(reader);
    reader->state.orientation ^= 1;
    return true;
}

bool read_texture_coordinates(struct rib_reader *reader) {
    warn_in_object(reader);
    return rib_read_numbers(reader, "s1 t1 s2 t2 s3 t3 s4 t4", reader->state.texture_coordinates,
                            8);
}

static const struct {
    const char *name;
    int step;
    double matrix[4][4];
} bases[] = {
    {"bezier", 3, {{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}}},
    {"b-spline",
     1,
     {{-1. / 6, 3. / 6, -3. / 6, 1. / 6},
      {3. / 6, -1, 3. / 6, 0},
      {-3. / 6, 0, 3. / 6, 0},
      {1. / 6, 4. / 6, 1. / 6, 0}}},
    {"catmull-rom", 1, {{-.5, 1.5, -1.5, .5}, {1, -2.5, 2, -.5}, {-.5, 0, .5, 0}, {0, 1, 0, 0}}},
    {"hermite", 2, {{2, 1, -2, 1}, {-3, -2, 3, -1}, {0, 1, 0, 0}, {1, 0, 0, 0}}},
    {"power", 4, {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}},
};

static bool read_basis_matrix(struct rib_reader *reader, double matrix[4][4], int *step) {
    double values[16];
    if (rib_peek(reader)->kind == RIB_TOKEN_STRING) {
        struct rib_location location = rib_peek(reader)->location;
        const char *name;
        size_t i = 0, count = sizeof bases / sizeof *bases;
        if (!rib_read_string(reader, "basis", &name))
            return false;
        while (i < count && strcmp(bases[i].name, name) != 0)
            i++;
        if (i == count)
            return rib_error(
                reader, &location,
                "Basis \"%.100s\": bezier, b-spline, catmull-rom, hermite or power expected", name);
        memcpy(matrix, bases[i].matrix, sizeof bases[i].matrix);
        *step = bases[i].step;
    } else {
        if (!rib_read_numbers(reader, "16 numbers of a basis", values, 16))
            return false;
        memcpy(matrix, values, sizeof values);
        *step = 1;
    }
    /* The step may be left out after a name. */
    if (rib_peek(reader)->kind != RIB_TOKEN_NUMBER)
        return true;
    return rib_read_integer(reader, "step", 1, 4, step);
}

bool read_basis(struct rib_reader *reader) {
    double matrices[2][4][4];
    int steps[2];
    for (int i = 0; i < 2; i++)
        if (!read_basis_matrix(reader, matrices[i], &steps[i]))
            return false;
    memcpy(reader->state.basis, matrices, sizeof matrices);
    memcpy(reader->state.basis_step, steps, sizeof steps);
    return true;
}

static bool shader_parameter(struct rib_reader *reader, const struct primitive_variable *item,
                             const struct rib_location *location,
                             struct scene_parameter *parameter) {
    size_t needed = (size_t)primitive_variable_components(item);
    if (item->type == RIB_HPOINT)
        return rib_error(reader, location, "%s: parameters of type %s are not supported",
                         reader->request, rib_type_name(item->type));
    if (item->count != needed)
        return rib_error(reader, location, "%s: \"%.100s\" takes %zu %s, not %zu", reader->request,
                         item->name, needed, item->type == RIB_STRING ? "string(s)" : "number(s)",
                         item->count);
    *parameter = (struct scene_parameter){.name = item->name,
                                          .type = rib_type_to_scene(item->type),
                                          .array_length = item->array_length,
                                          .location = item->location};
    if (item->type == RIB_STRING) {
        parameter->strings = memory_get(needed, sizeof *parameter->strings);
        memcpy(parameter->strings, item->strings, needed * sizeof *parameter->strings);
        return true;
    }
    float *values = memory_get(needed, sizeof *values);
    for (size_t i = 0; i < needed; i++)
        values[i] = (float)item->values[i];
    parameter->values = values;
    return true;
}

/* A shader with one reference, or NULL after an error. */
static struct rib_shader *read_shader(struct rib_reader *reader, const char *name) {
    struct parameter_list list;
    struct rib_shader *shader = memory_get(1, sizeof *shader);
    shader->references = 1;
    shader->shader = (struct scene_shader){.name = name,
                                           .shader_to_camera = rib_current_to_camera(reader),
                                           .location = reader->request_at.at};
    bool is_good = rib_read_parameters(reader, PARAMETERS_STRICT, &list);
    shader->shader.parameters = memory_get((size_t)list.count, sizeof *shader->shader.parameters);
    for (int i = 0; is_good && i < list.count; i++) {
        is_good = shader_parameter(reader, &list.items[i], &list.locations[i],
                                   &shader->shader.parameters[i]);
        shader->shader.parameter_count += is_good;
    }
    parameter_list_finish(&list);
    if (!is_good) {
        rib_shader_release(shader);
        return NULL;
    }
    return shader;
}

static bool read_shader_for(struct rib_reader *reader, struct rib_shader **place) {
    const char *name;
    warn_in_object(reader);
    if (!rib_read_string(reader, "name of the shader", &name))
        return false;
    struct rib_shader *shader = read_shader(reader, name);
    if (!shader)
        return false;
    graphics_state_set_shader(place, shader);
    return true;
}

bool read_surface(struct rib_reader *reader) {
    return read_shader_for(reader, &reader->state.surface);
}

bool read_displacement(struct rib_reader *reader) {
    return read_shader_for(reader, &reader->state.displacement);
}

bool read_atmosphere(struct rib_reader *reader) {
    return read_shader_for(reader, &reader->state.atmosphere);
}

/* Lights live until the world or frame that defines them ends. */
static int current_scope(const struct rib_reader *reader) {
    return reader->in_world ? 2 : reader->in_frame ? 1 : 0;
}

bool read_light_source(struct rib_reader *reader) {
    const char *name, *key;
    if (!rib_read_string(reader, "name of the shader", &name) ||
        !rib_read_handle(reader, "light handle", &key))
        return false;
    if (reader->lights.count >= RIB_LIGHTS_MAX)
        return rib_error_code(reader, &reader->request_at, STATUS_LIMIT, "more than %d lights",
                              RIB_LIGHTS_MAX);
    struct rib_shader *light = read_shader(reader, name);
    if (!light)
        return false;
    light->sequence = ++reader->light_sequence;
    handle_table_add(&reader->lights, key, light, current_scope(reader));
    graphics_state_switch_light(&reader->state, light, true);
    return true;
}

bool read_illuminate(struct rib_reader *reader) {
    struct rib_location location = rib_peek(reader)->location;
    const char *key;
    int is_on;
    if (!rib_read_handle(reader, "light handle", &key) ||
        !rib_read_integer(reader, "on or off", 0, 1, &is_on))
        return false;
    struct rib_shader *light = handle_table_find(&reader->lights, key);
    if (!light)
        return rib_error(reader, &location, "Illuminate: there is no light with this handle here");
    graphics_state_switch_light(&reader->state, light, is_on);
    return true;
}
