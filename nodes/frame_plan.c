/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/frame_plan.h"

#include "base/hash.h"
#include "nodes/bound_parameters.h"
#include "shaders/simd/shader_module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char default_surface[] = "defaultsurface";

/* Meshes that would be one instance but for their colour: when Cs (or Os) differs among them it
 * becomes a material parameter, else it is bound. */
struct colour_group {
    uint64_t key;
    float color[3], opacity[3];
    bool color_varies, opacity_varies;
};

static bool is_standard_variable(const char *name) {
    static const char *const names[] = {"N", "Ng", "s", "t", "u", "v", "dPdu", "dPdv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(name, names[i]))
            return true;
    return false;
}

static const struct scene_variable *find_variable(const struct scene_mesh *mesh, const char *name) {
    for (int i = 0; i < mesh->variable_count; i++)
        if (!strcmp(mesh->variables[i].name, name))
            return &mesh->variables[i];
    return NULL;
}

static uint64_t hash_parameter(const struct scene_parameter *parameter, uint64_t key) {
    key = hash_string(parameter->name,
                      key + (uint64_t)parameter->type * 3 + (uint64_t)parameter->array_length);
    const int count = parameter->array_length ? parameter->array_length : 1;
    if (parameter->strings)
        for (int i = 0; i < count; i++)
            key = hash_string(parameter->strings[i], key);
    else
        key = hash_bytes(parameter->values,
                         (size_t)(count * scene_type_components(parameter->type)) * sizeof(float),
                         key);
    return key;
}

static uint64_t hash_shader(const struct scene_shader *shader, uint64_t key) {
    key = hash_string(shader ? shader->name : "", key);
    for (int i = 0; shader && i < shader->parameter_count; i++)
        key = hash_parameter(&shader->parameters[i], key);
    return key;
}

static uint64_t colour_group_key(const struct scene_mesh *mesh) {
    uint64_t key = hash_string(mesh->surface ? mesh->surface->name : default_surface, 1);
    for (int i = 0; mesh->surface && i < mesh->surface->parameter_count; i++)
        key = hash_parameter(&mesh->surface->parameters[i], key);
    if (mesh->displacement || mesh->atmosphere)
        key = hash_shader(mesh->atmosphere, hash_shader(mesh->displacement, key));
    for (int i = 0; i < mesh->constant_count; i++)
        key = hash_parameter(&mesh->constants[i], key);
    for (int i = 0; i < mesh->variable_count; i++)
        if (!is_standard_variable(mesh->variables[i].name))
            key = hash_string(mesh->variables[i].name, key);
    return key;
}

static struct colour_group *find_group(struct colour_group *groups, size_t count, uint64_t key) {
    for (size_t i = 0; i < count; i++)
        if (groups[i].key == key)
            return &groups[i];
    return NULL;
}

static struct colour_group *group_colours(const struct scene_frame *frame, size_t *count) {
    struct colour_group *groups = memory_get(frame->mesh_count, sizeof *groups);
    *count = 0;
    for (size_t m = 0; m < frame->mesh_count; m++) {
        const struct scene_mesh *mesh = &frame->meshes[m];
        const uint64_t key = colour_group_key(mesh);
        struct colour_group *group = find_group(groups, *count, key);
        if (!group) {
            group = &groups[(*count)++];
            group->key = key;
            memcpy(group->color, mesh->color, sizeof group->color);
            memcpy(group->opacity, mesh->opacity, sizeof group->opacity);
        }
        group->color_varies |= memcmp(group->color, mesh->color, sizeof group->color) != 0;
        group->opacity_varies |= memcmp(group->opacity, mesh->opacity, sizeof group->opacity) != 0;
    }
    return groups;
}

/* Names of everything that comes with the primitives of a mesh besides what every mesh has. */
static int material_names(const struct scene_mesh *mesh, const struct colour_group *group,
                          const char **names) {
    int count = 0;
    for (int i = 0; i < mesh->variable_count; i++)
        if (!is_standard_variable(mesh->variables[i].name))
            names[count++] = mesh->variables[i].name;
    if (group->color_varies && !find_variable(mesh, "Cs"))
        names[count++] = "Cs";
    if (group->opacity_varies && !find_variable(mesh, "Os"))
        names[count++] = "Os";
    return count;
}

/* Checks that each material parameter of the variant has a variable of the right shape on the mesh.
 */
static bool check_material(const struct scene_mesh *mesh, const struct shader_variant *variant,
                           struct status *status) {
    for (int i = 0; i < variant->program->parameter_count; i++) {
        const struct shader_parameter *parameter = &variant->program->parameters[i];
        if (!parameter->is_material)
            continue;
        const struct scene_variable *variable = find_variable(mesh, parameter->name);
        if (variable && variable->components != parameter->components)
            return status_fail(
                status, STATUS_INVALID,
                "%s:%d:%d: error: primitive variable \"%s\" has %d floats, parameter %s of "
                "shader %s has %d",
                mesh->location.file, mesh->location.line, mesh->location.column, variable->name,
                variable->components, parameter->name, variant->program->name,
                parameter->components);
    }
    return true;
}

/* Both ways, 32 floats; false when the matrix has no inverse. */
static bool put_matrices(const struct mat4 *to_camera, float *matrices) {
    struct mat4 inverse;
    if (!mat4_invert(to_camera, &inverse))
        return false;
    for (int i = 0; i < 16; i++) {
        matrices[i] = (float)to_camera->m[i / 4][i % 4];
        matrices[16 + i] = (float)inverse.m[i / 4][i % 4];
    }
    return true;
}

static uint32_t append_matrices(uint32_t spaces,
                                const struct mat4 *to_camera_of[SHADER_SPACE_COUNT],
                                float *matrices) {
    uint32_t sent = 0;
    for (int space = 0; space < SHADER_SPACE_COUNT; space++) {
        if (!(spaces >> space & 1) || !to_camera_of[space] ||
            !put_matrices(to_camera_of[space], matrices))
            continue;
        matrices += 32;
        sent |= 1u << space;
    }
    return sent;
}

/* From screen, NDC and raster space to the camera's; RI: screen z is 0 at the near plane and 1 at
 * the far one, NDC and raster count from the upper left corner. */
static void view_spaces(const struct scene_camera *camera, struct mat4 to_camera[3]) {
    const double *w = camera->screen_window, n = camera->near_plane, f = camera->far_plane;
    const double wide = w[1] - w[0], high = w[3] - w[2];
    struct mat4 to_screen = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    if (camera->is_perspective) {
        to_screen.m[2][3] = 1;
        to_screen.m[3][3] = 0;
        to_screen.m[2][2] = isinf(f) ? 1 : f / (f - n);
        to_screen.m[3][2] = -n * to_screen.m[2][2];
    } else if (!isinf(f)) {
        to_screen.m[2][2] = 1 / (f - n);
        to_screen.m[3][2] = -n / (f - n);
    }
    for (int space = 0; space < 3; space++) {
        const double x = space == 2 ? camera->width : 1, y = space == 2 ? camera->height : 1;
        const struct mat4 scale = {{{x / wide, 0, 0, 0},
                                    {0, -y / high, 0, 0},
                                    {0, 0, 1, 0},
                                    {-w[0] * x / wide, w[3] * y / high, 0, 1}}};
        const struct mat4 matrix = space ? mat4_multiply(&to_screen, &scale) : to_screen;
        if (!mat4_invert(&matrix, &to_camera[space]))
            to_camera[space] = mat4_identity;
    }
}

static bool is_named(const struct shader_program *program, const char *name) {
    bool found = program->uses_any_space;
    for (int i = 0; i < program->named_space_count; i++)
        found |= !strcmp(program->named_spaces[i], name);
    return found;
}

/* The coordinate systems of the scene that the shader may ask for. */
static uint32_t append_named(const struct scene_frame *frame, const struct shader_program *program,
                             int32_t *names, float *matrices) {
    uint32_t count = 0;
    for (int i = 0; i < frame->space_count; i++) {
        if (!is_named(program, frame->spaces[i].name) ||
            !put_matrices(&frame->spaces[i].to_camera, matrices + 32 * (size_t)count))
            continue;
        names[count++] = shader_string_identity(frame->spaces[i].name);
    }
    return count;
}

/* Puts a shader with its bound values into a message; `lights` are indices for an instance. */
static bool encode_shader(const struct scene_frame *frame, const struct shader_variant *variant,
                          const struct bound_source *source, const uint32_t *lights,
                          uint32_t light_count, uint32_t id, enum wire_kind kind,
                          struct planned_instance *planned, struct status *status) {
    const int bound_count = variant->program->bound_count;
    float *bound = memory_get((size_t)bound_count, sizeof *bound);
    uint8_t *given = memory_get((size_t)bound_count, 1);
    bool ok = bound_parameters_fill(variant->program, source, bound, given, status);
    if (ok) {
        struct mat4 world_to_camera = frame->camera.world_to_camera, view[3];
        view_spaces(&frame->camera, view);
        const struct mat4 *to_camera_of[SHADER_SPACE_COUNT] = {
            [SHADER_SPACE_SHADER] =
                source->shader ? &source->shader->shader_to_camera : source->object_to_camera,
            [SHADER_SPACE_OBJECT] = source->object_to_camera,
            [SHADER_SPACE_WORLD] = &world_to_camera,
            [SHADER_SPACE_DISPLACEMENT] =
                source->displacement ? &source->displacement->shader_to_camera : NULL,
            [SHADER_SPACE_ATMOSPHERE] =
                source->atmosphere ? &source->atmosphere->shader_to_camera : NULL,
            [SHADER_SPACE_SCREEN] = &view[0],
            [SHADER_SPACE_NDC] = &view[1],
            [SHADER_SPACE_RASTER] = &view[2],
        };
        float matrices[SHADER_SPACE_COUNT * 32];
        int32_t *names = memory_get((size_t)frame->space_count, sizeof *names);
        float *named = memory_get((size_t)frame->space_count * 32, sizeof *named);
        const uint32_t named_count = append_named(frame, variant->program, names, named);
        char *texts = NULL;
        size_t text_bytes = 0;
        if (variant->program->uses_texts)
            bound_parameters_texts(variant->program, source, &texts, &text_bytes);
        struct instance_payload payload = {
            .id = id,
            .shader = variant->number,
            .bound_count = (uint32_t)bound_count,
            .bound = bound,
            .given = given,
            .spaces = append_matrices(variant->program->spaces, to_camera_of, matrices),
            .matrices = matrices,
            .named_count = named_count,
            .names = names,
            .named_matrices = named,
            .light_count = light_count,
            .lights = lights,
            .text_bytes = (uint32_t)text_bytes,
            .texts = texts,
            .category =
                kind == WIRE_LIGHT ? bound_parameters_category(variant->program, source) : "",
        };
        planned->variant = variant;
        planned->message = instance_payload_encode(&payload, kind, 0);
        planned->bound_bytes = instance_payload_bound_bytes(&payload);
        free(texts);
        free(names);
        free(named);
    }
    free(bound);
    free(given);
    return ok;
}

static void name_instance(struct frame_plan *plan, struct planned_instance *planned) {
    int same = 1;
    for (size_t i = 0; i < plan->instance_count; i++)
        same += !strcmp(plan->instances[i].variant->program->name, planned->variant->program->name);
    if (same == 1)
        snprintf(planned->name, sizeof planned->name, "%s", planned->variant->program->name);
    else
        snprintf(planned->name, sizeof planned->name, "%.48s.%d", planned->variant->program->name,
                 same);
}

/* Everything in an INSTANCE message but its ID. */
static bool same_instance(const struct message *a, const struct message *b) {
    enum { BEHIND_ID = WIRE_HEADER_BYTES + 4 };
    return a->length == b->length &&
           !memcmp(a->bytes + BEHIND_ID, b->bytes + BEHIND_ID, a->length - BEHIND_ID);
}

static bool add_instance(struct frame_plan *plan, struct planned_instance *planned, uint16_t *id,
                         const struct scene_mesh *mesh, struct status *status) {
    for (size_t i = 0; i < plan->instance_count; i++)
        if (same_instance(plan->instances[i].message, planned->message)) {
            message_release(planned->message);
            *id = (uint16_t)(i + 1);
            return true;
        }
    if (plan->instance_count == UINT16_MAX) {
        message_release(planned->message);
        return status_fail(
            status, STATUS_LIMIT,
            "%s:%d:%d: error: more than 65535 shader instances in one frame; share Surface "
            "calls, or give what differs as a primitive variable",
            mesh->location.file, mesh->location.line, mesh->location.column);
    }
    name_instance(plan, planned);
    plan->instances = memory_grow(plan->instances, &plan->instance_capacity,
                                  plan->instance_count + 1, sizeof *plan->instances);
    plan->instances[plan->instance_count++] = *planned;
    *id = (uint16_t)plan->instance_count;
    return true;
}

static uint32_t *light_indices(const struct scene_frame *frame, const struct scene_mesh *mesh,
                               uint32_t *count) {
    uint32_t *indices = memory_get((size_t)mesh->light_count, sizeof *indices);
    *count = 0;
    for (int i = 0; i < mesh->light_count; i++)
        for (int l = 0; l < frame->light_count; l++)
            if (mesh->lights[i] == frame->lights[l])
                indices[(*count)++] = (uint32_t)l;
    return indices;
}

static bool plan_mesh(const struct scene_frame *frame, const struct scene_mesh *mesh,
                      const struct colour_group *group, struct shader_library *library,
                      struct frame_plan *plan, uint16_t *id, struct status *status) {
    const char **names = memory_get((size_t)mesh->variable_count + 2, sizeof *names);
    const int name_count = material_names(mesh, group, names);
    const struct shader_variant *variant;
    const struct shader_wanted wanted = {
        .name = mesh->surface ? mesh->surface->name : default_surface,
        .displacement = mesh->displacement ? mesh->displacement->name : NULL,
        .atmosphere = mesh->atmosphere ? mesh->atmosphere->name : NULL,
        .kind = SHADER_KIND_SURFACE,
        .material = names,
        .material_count = name_count,
    };
    bool ok = shader_library_variant(library, &wanted,
                                     mesh->surface ? &mesh->surface->location : &mesh->location,
                                     &variant, status) &&
              check_material(mesh, variant, status);
    free(names);
    if (!ok)
        return false;
    const struct bound_source source = {.shader = mesh->surface,
                                        .displacement = mesh->displacement,
                                        .atmosphere = mesh->atmosphere,
                                        .camera = &frame->camera,
                                        .constants = mesh->constants,
                                        .constant_count = mesh->constant_count,
                                        .object_to_camera = &mesh->object_to_camera,
                                        .color = mesh->color,
                                        .opacity = mesh->opacity};
    uint32_t light_count;
    uint32_t *lights = light_indices(frame, mesh, &light_count);
    struct planned_instance planned = {0};
    ok = encode_shader(frame, variant, &source, lights, light_count,
                       (uint32_t)plan->instance_count + 1, WIRE_INSTANCE, &planned, status) &&
         add_instance(plan, &planned, id, mesh, status);
    free(lights);
    return ok;
}

/* Everything that a surface of the frame asks lights for; the names are the programs'. */
static int asked_names(const struct frame_plan *plan, const char ***names) {
    size_t count = 0, capacity = 0;
    *names = NULL;
    for (size_t i = 0; i < plan->instance_count; i++) {
        const struct shader_program *program = plan->instances[i].variant->program;
        for (int q = 0; q < program->query_count; q++) {
            bool is_known = false;
            for (size_t n = 0; n < count; n++)
                is_known |= !strcmp((*names)[n], program->queries[q]);
            if (is_known)
                continue;
            *names = memory_grow(*names, &capacity, count + 1, sizeof **names);
            (*names)[count++] = program->queries[q];
        }
    }
    return (int)count;
}

/* After the surfaces, which say what they ask of lights. */
static bool plan_lights(const struct scene_frame *frame, struct shader_library *library,
                        const char *const *names, int name_count, struct frame_plan *plan,
                        struct status *status) {
    plan->lights = memory_get((size_t)frame->light_count, sizeof *plan->lights);
    for (int l = 0; l < frame->light_count; l++) {
        const struct scene_shader *light = frame->lights[l];
        const struct bound_source source = {.shader = light,
                                            .object_to_camera = &light->shader_to_camera};
        const struct shader_variant *variant;
        const struct shader_wanted wanted = {.name = light->name,
                                             .kind = SHADER_KIND_LIGHT,
                                             .material = names,
                                             .material_count = name_count};
        if (!shader_library_variant(library, &wanted, &light->location, &variant, status) ||
            !encode_shader(frame, variant, &source, NULL, 0, (uint32_t)l, WIRE_LIGHT,
                           &plan->lights[l], status))
            return false;
        snprintf(plan->lights[l].name, sizeof plan->lights[l].name, "%s", variant->program->name);
        plan->light_count++;
    }
    return true;
}

bool frame_plan_make(const struct scene_frame *frame, struct shader_library *library,
                     struct frame_plan *plan, struct status *status) {
    *plan = (struct frame_plan){.mesh_count = frame->mesh_count};
    plan->mesh_instance = memory_get(frame->mesh_count, sizeof *plan->mesh_instance);
    size_t group_count;
    struct colour_group *groups = group_colours(frame, &group_count);
    bool ok = true;
    for (size_t m = 0; ok && m < frame->mesh_count; m++) {
        const struct scene_mesh *mesh = &frame->meshes[m];
        ok = plan_mesh(frame, mesh, find_group(groups, group_count, colour_group_key(mesh)),
                       library, plan, &plan->mesh_instance[m], status);
    }
    free(groups);
    const char **names;
    const int name_count = asked_names(plan, &names);
    ok = ok && plan_lights(frame, library, names, name_count, plan, status);
    free(names);
    if (!ok)
        frame_plan_finish(plan);
    return ok;
}

void frame_plan_finish(struct frame_plan *plan) {
    for (size_t i = 0; i < plan->instance_count; i++)
        message_release(plan->instances[i].message);
    for (size_t l = 0; l < plan->light_count; l++)
        message_release(plan->lights[l].message);
    free(plan->instances);
    free(plan->lights);
    free(plan->mesh_instance);
    *plan = (struct frame_plan){0};
}
