/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <stdlib.h>
#include <string.h>

/* Coordinate systems with names: those that a world block names end with it. */

enum { NAMED_SPACES_MAX = 1000 };

static struct named_space *find(struct rib_reader *reader, const char *name) {
    for (size_t i = 0; i < reader->space_count; i++)
        if (!strcmp(reader->spaces[i].name, name))
            return &reader->spaces[i];
    return NULL;
}

bool read_coordinate_system(struct rib_reader *reader) {
    const char *name;
    if (!rib_read_string(reader, "name of the coordinate system", &name))
        return false;
    struct named_space *space = find(reader, name);
    if (!space && reader->space_count == NAMED_SPACES_MAX)
        return rib_error_code(reader, &reader->request_at, STATUS_LIMIT,
                              "more than %d coordinate systems", NAMED_SPACES_MAX);
    if (!space) {
        reader->spaces = memory_grow(reader->spaces, &reader->space_capacity,
                                     reader->space_count + 1, sizeof *reader->spaces);
        space = &reader->spaces[reader->space_count++];
    }
    *space = (struct named_space){name, reader->state.transform, reader->in_world};
    return true;
}

static struct mat4 to_camera(const struct rib_reader *reader, const struct named_space *space) {
    return space->in_world ? mat4_multiply(&space->transform, &reader->world_to_camera)
                           : space->transform;
}

bool read_coord_sys_transform(struct rib_reader *reader) {
    struct rib_location location = rib_peek(reader)->location;
    const char *name;
    struct mat4 camera_to_world, matrix;
    if (!rib_read_string(reader, "name of the coordinate system", &name))
        return false;
    const struct named_space *space = find(reader, name);
    const bool is_world = !space && !strcmp(name, "world"),
               is_camera = !space && !strcmp(name, "camera");
    if (!space && !is_world && !is_camera)
        return rib_error(reader, &location, "there is no coordinate system \"%.100s\" here", name);
    if (is_world || !reader->in_world) {
        reader->state.transform = space ? space->transform : mat4_identity;
        return true;
    }
    if (!mat4_invert(&reader->world_to_camera, &camera_to_world))
        return rib_error(reader, &reader->request_at, "the camera transform is singular");
    matrix = space ? to_camera(reader, space) : mat4_identity;
    reader->state.transform = mat4_multiply(&matrix, &camera_to_world);
    return true;
}

void rib_copy_spaces(const struct rib_reader *reader, struct scene_frame *frame) {
    frame->spaces = arena_get(&frame->arena, reader->space_count * sizeof *frame->spaces);
    for (size_t i = 0; i < reader->space_count; i++) {
        const char *name = reader->spaces[i].name;
        frame->spaces[i].name = arena_copy_string(&frame->arena, name, strlen(name));
        frame->spaces[i].to_camera = to_camera(reader, &reader->spaces[i]);
    }
    frame->space_count = (int)reader->space_count;
}

void rib_leave_spaces(struct rib_reader *reader) {
    size_t kept = 0;
    for (size_t i = 0; i < reader->space_count; i++)
        if (!reader->spaces[i].in_world)
            reader->spaces[kept++] = reader->spaces[i];
    reader->space_count = kept;
}
