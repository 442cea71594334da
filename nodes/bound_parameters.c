/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/bound_parameters.h"

#include <stdio.h>
#include <string.h>

static enum shader_type shader_type_of(enum scene_type type) {
    switch (type) {
    case SCENE_FLOAT:
        return SHADER_FLOAT;
    case SCENE_COLOR:
        return SHADER_COLOR;
    case SCENE_POINT:
        return SHADER_POINT;
    case SCENE_VECTOR:
        return SHADER_VECTOR;
    case SCENE_NORMAL:
        return SHADER_NORMAL;
    case SCENE_STRING:
        return SHADER_STRING;
    case SCENE_MATRIX:
        return SHADER_MATRIX;
    }
    return SHADER_FLOAT;
}

static bool is_direction_or_point(enum shader_type type) {
    return type == SHADER_POINT || type == SHADER_VECTOR || type == SHADER_NORMAL;
}

/* Old scenes declare directions as points: any of the three fits any other. Scenes have no
 * fixed-point: floats are converted where they arrive. */
static bool types_fit(enum shader_type wanted, enum shader_type given) {
    return wanted == given || (wanted == SHADER_FIXED && given == SHADER_FLOAT) ||
           (is_direction_or_point(wanted) && is_direction_or_point(given));
}

static const struct shader_parameter *find_parameter(const struct shader_program *program,
                                                     enum shader_kind kind, const char *name) {
    for (int i = 0; i < program->parameter_count; i++)
        if (!program->parameters[i].is_global && program->parameters[i].shader == kind &&
            !strcmp(program->parameters[i].name, name))
            return &program->parameters[i];
    return NULL;
}

enum shader_type bound_parameter_transformed_as(const struct shader_parameter *parameter) {
    switch (parameter->transform) {
    case SHADER_TRANSFORM_POINT:
        return SHADER_POINT;
    case SHADER_TRANSFORM_VECTOR:
        return SHADER_VECTOR;
    case SHADER_TRANSFORM_NORMAL:
        return SHADER_NORMAL;
    default:
        return is_direction_or_point(parameter->type) ? parameter->type : SHADER_FLOAT;
    }
}

void bound_parameter_to_camera(float *value, enum shader_type type, const struct mat4 *matrix) {
    struct vec3 v = vec3_make(value[0], value[1], value[2]);
    struct mat4 inverse;
    if (type == SHADER_POINT)
        v = mat4_point(matrix, v);
    else if (type == SHADER_VECTOR)
        v = mat4_vector(matrix, v);
    else if (mat4_invert(matrix, &inverse))
        v = mat4_normal(&inverse, v);
    value[0] = (float)v.x;
    value[1] = (float)v.y;
    value[2] = (float)v.z;
}

static void list_parameters(const struct shader_program *program, enum shader_kind kind, char *text,
                            size_t size) {
    text[0] = 0;
    for (int i = 0; i < program->parameter_count; i++) {
        if (program->parameters[i].is_global || program->parameters[i].shader != kind)
            continue;
        const size_t used = strlen(text);
        snprintf(text + used, size - used, "%s%s", used ? ", " : "", program->parameters[i].name);
    }
}

static bool fits(const struct shader_program *program, enum shader_kind kind,
                 const char *shader_name, const struct shader_parameter *parameter,
                 const struct scene_parameter *given, struct status *status) {
    const struct scene_location at = given->location;
    if (!parameter) {
        char known[768];
        list_parameters(program, kind, known, sizeof known);
        return status_fail(status, STATUS_INVALID,
                           "%s:%d:%d: error: shader %s has no parameter \"%s\"; it has: %s",
                           at.file, at.line, at.column, shader_name, given->name,
                           known[0] ? known : "none");
    }
    if (!types_fit(parameter->type, shader_type_of(given->type)))
        return status_fail(
            status, STATUS_INVALID,
            "%s:%d:%d: error: parameter \"%s\" of shader %s is a %s, the scene gives a %s", at.file,
            at.line, at.column, given->name, shader_name, shader_type_name(parameter->type),
            shader_type_name(shader_type_of(given->type)));
    if (parameter->array_length != given->array_length &&
        (parameter->array_length ? parameter->array_length : 1) !=
            (given->array_length ? given->array_length : 1))
        return status_fail(
            status, STATUS_INVALID,
            "%s:%d:%d: error: parameter \"%s\" of shader %s has %d elements, the scene gives %d",
            at.file, at.line, at.column, given->name, shader_name,
            parameter->array_length ? parameter->array_length : 1,
            given->array_length ? given->array_length : 1);
    return true;
}

static void store(const struct shader_parameter *parameter, const struct scene_parameter *value,
                  const struct mat4 *matrix, float *bound, uint8_t *given) {
    if (parameter->bound_offset < 0)
        return; /* cannot reach the picture, or comes with the primitives */
    float *out = bound + parameter->bound_offset;
    if (parameter->type == SHADER_STRING) {
        const int count = parameter->array_length ? parameter->array_length : 1;
        for (int i = 0; i < count; i++) {
            const int32_t identity = shader_string_identity(value->strings[i]);
            memcpy(out + i, &identity, sizeof identity);
        }
    } else {
        memcpy(out, value->values, (size_t)parameter->components * sizeof(float));
        const enum shader_type type = bound_parameter_transformed_as(parameter);
        for (int i = 0; i + 3 <= parameter->components && type != SHADER_FLOAT; i += 3)
            bound_parameter_to_camera(out + i, type, matrix);
    }
    memset(given + parameter->bound_offset, 1, (size_t)parameter->components);
}

/* What one Surface, Displacement, Atmosphere or LightSource call gives. */
static bool fill_shader(const struct shader_program *program, enum shader_kind kind,
                        const struct scene_shader *shader, float *bound, uint8_t *given,
                        struct status *status) {
    const char *name = kind == program->kind ? program->name : shader->name;
    for (int i = 0; i < shader->parameter_count; i++) {
        const struct scene_parameter *value = &shader->parameters[i];
        const struct shader_parameter *parameter = find_parameter(program, kind, value->name);
        if (!fits(program, kind, name, parameter, value, status))
            return false;
        store(parameter, value, &shader->shader_to_camera, bound, given);
    }
    return true;
}

/* Constant primitive variables serve every shader of the surface that has such a parameter. */
static bool fill_constants(const struct shader_program *program, const struct bound_source *source,
                           float *bound, uint8_t *given, struct status *status) {
    for (int i = 0; i < source->constant_count; i++)
        for (int kind = 0; kind < SHADER_KIND_COUNT; kind++) {
            const struct scene_parameter *value = &source->constants[i];
            const struct shader_parameter *parameter =
                find_parameter(program, (enum shader_kind)kind, value->name);
            if (!parameter)
                continue;
            if (!fits(program, (enum shader_kind)kind, program->name, parameter, value, status))
                return false;
            store(parameter, value, source->object_to_camera, bound, given);
        }
    return true;
}

/* What shaders ask by option(). */
static void fill_option(const struct scene_camera *camera, const struct shader_parameter *parameter,
                        float *bound, uint8_t *given) {
    const double *w = camera->screen_window;
    const double aspect = (w[1] - w[0]) / (w[3] - w[2]);
    const struct {
        const char *name;
        float values[3];
    } options[] = {
        {"Format ()",
         {(float)camera->width, (float)camera->height,
          (float)(aspect * camera->height / camera->width)}},
        {"FrameAspectRatio ()", {(float)aspect}},
        {"Clipping ()", {(float)camera->near_plane, (float)camera->far_plane}},
    };
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (!strcmp(options[i].name, parameter->name)) {
            memcpy(bound + parameter->bound_offset, options[i].values,
                   (size_t)parameter->components * sizeof(float));
            memset(given + parameter->bound_offset, 1, (size_t)parameter->components);
        }
}

bool bound_parameters_fill(const struct shader_program *program, const struct bound_source *source,
                           float *bound, uint8_t *given, struct status *status) {
    const struct {
        enum shader_kind kind;
        const struct scene_shader *shader;
    } shaders[] = {{program->kind, source->shader},
                   {SHADER_KIND_DISPLACEMENT, source->displacement},
                   {SHADER_KIND_VOLUME, source->atmosphere}};
    for (size_t i = 0; i < sizeof shaders / sizeof *shaders; i++)
        if (shaders[i].shader &&
            !fill_shader(program, shaders[i].kind, shaders[i].shader, bound, given, status))
            return false;
    if (!fill_constants(program, source, bound, given, status))
        return false;
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *parameter = &program->parameters[i];
        if (parameter->is_global && parameter->bound_offset >= 0 && source->camera)
            fill_option(source->camera, parameter, bound, given);
        const float *value = !parameter->is_global            ? NULL
                             : !strcmp(parameter->name, "Cs") ? source->color
                             : !strcmp(parameter->name, "Os") ? source->opacity
                                                              : NULL;
        if (!value || parameter->bound_offset < 0)
            continue;
        memcpy(bound + parameter->bound_offset, value, 3 * sizeof(float));
        memset(given + parameter->bound_offset, 1, 3);
    }
    return true;
}

static void add_texts(const struct shader_program *program, enum shader_kind kind,
                      const struct scene_shader *shader, char **texts, size_t *bytes,
                      size_t *capacity) {
    for (int i = 0; shader && i < shader->parameter_count; i++) {
        const struct scene_parameter *value = &shader->parameters[i];
        const struct shader_parameter *parameter = find_parameter(program, kind, value->name);
        if (!value->strings || !parameter || parameter->bound_offset < 0)
            continue;
        for (int s = 0; s < (value->array_length ? value->array_length : 1); s++) {
            const size_t length = strlen(value->strings[s]) + 1;
            *texts = memory_grow(*texts, capacity, *bytes + length, 1);
            memcpy(*texts + *bytes, value->strings[s], length);
            *bytes += length;
        }
    }
}

void bound_parameters_texts(const struct shader_program *program, const struct bound_source *source,
                            char **texts, size_t *bytes) {
    size_t capacity = 0;
    *texts = NULL;
    *bytes = 0;
    add_texts(program, program->kind, source->shader, texts, bytes, &capacity);
    add_texts(program, SHADER_KIND_DISPLACEMENT, source->displacement, texts, bytes, &capacity);
    add_texts(program, SHADER_KIND_VOLUME, source->atmosphere, texts, bytes, &capacity);
}

const char *bound_parameters_category(const struct shader_program *program,
                                      const struct bound_source *source) {
    for (int i = 0; source->shader && i < source->shader->parameter_count; i++)
        if (source->shader->parameters[i].strings &&
            !strcmp(source->shader->parameters[i].name, "__category"))
            return source->shader->parameters[i].strings[0];
    return program->category;
}
