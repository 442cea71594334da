/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include "scenes/tessellate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mat4 rib_current_to_camera(const struct rib_reader *reader) {
    return reader->in_world ? mat4_multiply(&reader->state.transform, &reader->world_to_camera)
                            : reader->state.transform;
}

static int whole_samples(double samples) {
    return (int)ceil(samples);
}

/* The screen window without ScreenWindow: the shorter side of the frame goes from -1 to 1. */
static void default_screen_window(const struct camera_options *options, double aspect,
                                  double window[4]) {
    double x = aspect > 1 ? aspect : 1, y = aspect > 1 ? 1 : 1 / aspect;
    if (options->has_screen_window) {
        memcpy(window, options->screen_window, sizeof options->screen_window);
        return;
    }
    window[0] = -x;
    window[1] = x;
    window[2] = -y;
    window[3] = y;
}

static void make_camera(const struct rib_reader *reader, struct scene_camera *camera) {
    const struct camera_options *options = &reader->camera;
    const struct scene_options *given = &reader->options;
    camera->world_to_camera = reader->world_to_camera;
    camera->is_perspective = options->is_perspective;
    camera->width = given->width > 0 ? given->width : options->width;
    camera->height = given->height > 0 ? given->height : options->height;
    camera->samples_x = given->samples_x > 0 ? given->samples_x : whole_samples(options->samples_x);
    camera->samples_y = given->samples_y > 0 ? given->samples_y : whole_samples(options->samples_y);
    camera->near_plane = options->near_plane;
    camera->far_plane = options->far_plane;
    double aspect = options->frame_aspect_ratio > 0
                        ? options->frame_aspect_ratio
                        : options->pixel_aspect * camera->width / camera->height;
    default_screen_window(options, aspect, camera->screen_window);
    double scale = options->is_perspective ? tan(options->fov_degrees * (M_PI / 360)) : 1;
    for (int i = 0; i < 4; i++)
        camera->screen_window[i] *= scale;
}

bool rib_frame_start(struct rib_reader *reader) {
    struct scene_frame *frame = memory_get(1, sizeof *frame);
    arena_init(&frame->arena, 0);
    reader->builder = (struct frame_builder){.frame = frame};
    reader->frame_serial++;
    frame->number = reader->frame_number;
    make_camera(reader, &frame->camera);
    const char *display = reader->camera.display_name;
    if (display)
        frame->display_name = arena_copy_string(&frame->arena, display, strlen(display));
    struct mat4 inverse;
    if (!mat4_invert(&reader->world_to_camera, &inverse))
        rib_warn(reader, &reader->request_at, "singular camera",
                 "the camera transform is singular: nothing can be seen");
    return true;
}

void rib_frame_abandon(struct rib_reader *reader) {
    free(reader->builder.meshes);
    scene_frame_destroy(reader->builder.frame);
    reader->builder = (struct frame_builder){0};
}

bool rib_frame_complete(struct rib_reader *reader) {
    struct frame_builder *builder = &reader->builder;
    struct scene_frame *frame = builder->frame;
    size_t light_count = reader->lights.count;
    frame->lights = arena_get(&frame->arena, light_count * sizeof *frame->lights);
    for (size_t i = 0; i < light_count; i++)
        frame->lights[i] = rib_frame_shader(reader, reader->lights.handles[i].value);
    frame->light_count = (int)light_count;
    rib_copy_spaces(reader, frame);
    frame->meshes = arena_get(&frame->arena, builder->mesh_count * sizeof *frame->meshes);
    if (builder->mesh_count)
        memcpy(frame->meshes, builder->meshes, builder->mesh_count * sizeof *frame->meshes);
    frame->mesh_count = builder->mesh_count;
    free(builder->meshes);
    builder->meshes = NULL;
    return true;
}

static const char *copy_text(struct arena *arena, const char *text) {
    return arena_copy_string(arena, text, strlen(text));
}

static void copy_parameter(struct arena *arena, const struct scene_parameter *from,
                           struct scene_parameter *to) {
    size_t count = (size_t)(from->array_length > 0 ? from->array_length : 1);
    *to = *from;
    to->name = copy_text(arena, from->name);
    if (from->strings) {
        to->strings = arena_get(arena, count * sizeof *to->strings);
        for (size_t i = 0; i < count; i++)
            to->strings[i] = copy_text(arena, from->strings[i]);
    } else {
        size_t bytes = count * (size_t)scene_type_components(from->type) * sizeof(float);
        to->values = memcpy(arena_get(arena, bytes), from->values, bytes);
    }
}

struct scene_shader *rib_frame_shader(struct rib_reader *reader, struct rib_shader *shader) {
    if (shader->frame_serial == reader->frame_serial)
        return shader->frame_copy;
    struct arena *arena = &reader->builder.frame->arena;
    struct scene_shader *copy = arena_get(arena, sizeof *copy);
    *copy = shader->shader;
    copy->name = copy_text(arena, shader->shader.name);
    copy->parameters = arena_get(arena, (size_t)copy->parameter_count * sizeof *copy->parameters);
    for (int i = 0; i < copy->parameter_count; i++)
        copy_parameter(arena, &shader->shader.parameters[i], &copy->parameters[i]);
    shader->frame_serial = reader->frame_serial;
    shader->frame_copy = copy;
    return copy;
}

static void copy_lights(struct rib_reader *reader, struct scene_mesh *mesh) {
    struct light_set *set = reader->state.lights;
    if (!set)
        return;
    if (!set->frame_copy || set->frame_serial != reader->frame_serial) {
        const struct scene_shader **copy =
            arena_get(&reader->builder.frame->arena, (size_t)set->count * sizeof *copy);
        for (int i = 0; i < set->count; i++)
            copy[i] = rib_frame_shader(reader, set->lights[i]);
        set->frame_copy = copy;
        set->frame_serial = reader->frame_serial;
    }
    mesh->lights = set->frame_copy;
    mesh->light_count = set->count;
}

/* A constant Cs or Os stands for Color or Opacity. */
static void set_color(const struct primitive *primitive, const char *name, const float attribute[3],
                      float out[3]) {
    const struct primitive_variable *item = primitive_find_variable(primitive, name);
    for (int i = 0; i < 3; i++)
        out[i] = item && item->storage == STORAGE_CONSTANT ? (float)item->values[i] : attribute[i];
}

static void set_attributes(struct rib_reader *reader, const struct primitive *primitive,
                           struct scene_mesh *mesh) {
    const struct graphics_state *state = &reader->state;
    mesh->surface = state->surface ? rib_frame_shader(reader, state->surface) : NULL;
    mesh->displacement = state->displacement ? rib_frame_shader(reader, state->displacement) : NULL;
    mesh->atmosphere = state->atmosphere ? rib_frame_shader(reader, state->atmosphere) : NULL;
    copy_lights(reader, mesh);
    set_color(primitive, "Cs", state->color, mesh->color);
    set_color(primitive, "Os", state->opacity, mesh->opacity);
    mesh->is_two_sided = state->sides == 2;
    mesh->location = primitive->location;
}

static bool is_reversed(enum surface_orientation orientation, const struct mat4 *object_to_camera) {
    bool is_left_handed = mat4_determinant3(object_to_camera) >= 0;
    switch (orientation) {
    case ORIENTATION_OUTSIDE:
        return false;
    case ORIENTATION_INSIDE:
        return true;
    case ORIENTATION_LH:
        return !is_left_handed;
    case ORIENTATION_RH:
        return is_left_handed;
    }
    return false;
}

bool rib_frame_add(struct rib_reader *reader, const struct primitive *primitive) {
    struct frame_builder *builder = &reader->builder;
    if (++builder->primitive_count > RIB_PRIMITIVES_PER_FRAME_MAX)
        return rib_error_code(reader, &reader->request_at, STATUS_LIMIT,
                              "more than %d primitives in a frame", RIB_PRIMITIVES_PER_FRAME_MAX);
    struct mat4 to_camera = rib_current_to_camera(reader);
    struct tessellation tessellation = {
        .camera = &builder->frame->camera,
        .object_to_camera = mat4_multiply(&primitive->transform, &to_camera),
        .chord_pixels = reader->options.chord_pixels,
        .texture_coordinates = reader->state.texture_coordinates,
        .triangles_max = reader->options.triangles_max - builder->triangle_count,
        .arena = &builder->frame->arena};
    if (!mat4_invert(&tessellation.object_to_camera, &tessellation.camera_to_object)) {
        rib_warn(reader, &reader->request_at, "singular transform",
                 "%s under a singular transform: nothing to draw", reader->request);
        return true;
    }
    tessellation.is_reversed =
        is_reversed(reader->state.orientation, &tessellation.object_to_camera);
    struct status status;
    struct scene_mesh mesh;
    if (!tessellate(&tessellation, primitive, &mesh, &status))
        return rib_error_code(reader, &reader->request_at, status.code, "%s: %.800s",
                              reader->request, status.message);
    if (tessellation.dropped_triangles)
        rib_warn(reader, &reader->request_at, "not finite",
                 "%s: %zu triangles left out: their coordinates are beyond the range of floats",
                 reader->request, tessellation.dropped_triangles);
    if (mesh.triangle_count == 0)
        return true;
    set_attributes(reader, primitive, &mesh);
    builder->triangle_count += mesh.triangle_count;
    builder->meshes = memory_grow(builder->meshes, &builder->mesh_capacity, builder->mesh_count + 1,
                                  sizeof *builder->meshes);
    builder->meshes[builder->mesh_count++] = mesh;
    return true;
}
