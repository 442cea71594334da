/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const block_names[] = {"Frame",     "World",  "Attribute",
                                          "Transform", "Object", "Motion"};

static bool block_push(struct rib_reader *reader, enum block_kind kind) {
    if (reader->block_count >= RIB_BLOCK_DEPTH_MAX)
        return rib_error_code(reader, &reader->request_at, STATUS_LIMIT,
                              "more than %d nested blocks", RIB_BLOCK_DEPTH_MAX);
    reader->blocks = memory_grow(reader->blocks, &reader->block_capacity, reader->block_count + 1,
                                 sizeof *reader->blocks);
    struct block *block = &reader->blocks[reader->block_count++];
    *block = (struct block){.kind = kind,
                            .location = reader->request_at,
                            .transform = reader->state.transform,
                            .camera = reader->camera};
    if (kind != BLOCK_TRANSFORM && kind != BLOCK_MOTION)
        graphics_state_copy(&block->state, &reader->state);
    return true;
}

/* Ends the innermost block, which must be of this kind, and restores what it saved. */
static bool block_pop(struct rib_reader *reader, enum block_kind kind) {
    struct block *block = reader->block_count ? &reader->blocks[reader->block_count - 1] : NULL;
    if (!block)
        return rib_error(reader, &reader->request_at, "%sEnd without %sBegin", block_names[kind],
                         block_names[kind]);
    if (block->kind != kind)
        return rib_error(reader, &reader->request_at,
                         "%sEnd, but the %sBegin of line %d is still open", block_names[kind],
                         block_names[block->kind], block->location.at.line);
    reader->block_count--;
    if (kind == BLOCK_TRANSFORM) {
        reader->state.transform = block->transform;
    } else if (kind != BLOCK_MOTION) {
        graphics_state_finish(&reader->state);
        reader->state = block->state; /* moves the references */
    }
    if (kind == BLOCK_FRAME)
        reader->camera = block->camera;
    return true;
}

bool rib_check_blocks_closed(struct rib_reader *reader) {
    if (!reader->block_count)
        return true;
    const struct block *block = &reader->blocks[reader->block_count - 1];
    return rib_error(reader, &block->location, "the file ends before %sEnd for this %sBegin",
                     block_names[block->kind], block_names[block->kind]);
}

void rib_blocks_finish(struct rib_reader *reader) {
    while (reader->block_count)
        graphics_state_finish(&reader->blocks[--reader->block_count].state);
    free(reader->blocks);
}

bool read_frame_begin(struct rib_reader *reader) {
    int number;
    if (!rib_read_integer(reader, "number", -2147483647, 2147483646, &number))
        return false;
    if (reader->in_frame)
        return rib_error(reader, &reader->request_at, "FrameBegin inside a frame block");
    reader->frame_number = number;
    reader->in_frame = true;
    return block_push(reader, BLOCK_FRAME);
}

bool read_frame_end(struct rib_reader *reader) {
    if (!block_pop(reader, BLOCK_FRAME))
        return false;
    handle_table_leave(&reader->lights, 0);
    handle_table_leave(&reader->objects, 0);
    reader->in_frame = false;
    reader->frame_number = 1;
    return true;
}

bool read_world_begin(struct rib_reader *reader) {
    if (!block_push(reader, BLOCK_WORLD))
        return false;
    reader->in_world = true;
    reader->world_to_camera = reader->state.transform;
    reader->state.transform = mat4_identity;
    return rib_frame_start(reader);
}

bool read_world_end(struct rib_reader *reader) {
    if (!block_pop(reader, BLOCK_WORLD) || !rib_frame_complete(reader))
        return false;
    int scope = reader->in_frame ? 1 : 0;
    handle_table_leave(&reader->lights, scope);
    handle_table_leave(&reader->objects, scope);
    rib_leave_spaces(reader);
    reader->in_world = false;
    reader->archives_read = 0;
    reader->frame_is_ready = true;
    return true;
}

bool read_attribute_begin(struct rib_reader *reader) {
    return block_push(reader, BLOCK_ATTRIBUTE);
}

bool read_attribute_end(struct rib_reader *reader) {
    return block_pop(reader, BLOCK_ATTRIBUTE);
}

bool read_transform_begin(struct rib_reader *reader) {
    return block_push(reader, BLOCK_TRANSFORM);
}

bool read_transform_end(struct rib_reader *reader) {
    return block_pop(reader, BLOCK_TRANSFORM);
}

bool read_object_begin(struct rib_reader *reader) {
    const char *key;
    if (!rib_read_handle(reader, "object handle", &key))
        return false;
    if (!block_push(reader, BLOCK_OBJECT))
        return false;
    reader->in_object = true;
    reader->state.transform = mat4_identity;
    reader->object = memory_get(1, sizeof *reader->object);
    handle_table_add(&reader->objects, key, reader->object,
                     reader->in_world   ? 2
                     : reader->in_frame ? 1
                                        : 0);
    return true;
}

bool read_object_end(struct rib_reader *reader) {
    if (!block_pop(reader, BLOCK_OBJECT))
        return false;
    reader->in_object = false;
    reader->object = NULL;
    return true;
}

bool read_object_instance(struct rib_reader *reader) {
    struct rib_location location = rib_peek(reader)->location;
    const char *key;
    if (!rib_read_handle(reader, "object handle", &key))
        return false;
    const struct rib_object *object = handle_table_find(&reader->objects, key);
    if (!object)
        return rib_error(reader, &location,
                         "ObjectInstance: there is no object with this handle here");
    for (size_t i = 0; i < object->count; i++)
        if (!rib_frame_add(reader, &object->primitives[i]))
            return false;
    return true;
}

bool read_motion_begin(struct rib_reader *reader) {
    double *times;
    size_t count;
    bool is_good = rib_read_array(reader, "times", &times, &count);
    free(times);
    while (is_good && rib_peek(reader)->kind == RIB_TOKEN_NUMBER)
        rib_take(reader); /* bare times */
    if (!is_good)
        return false;
    if (reader->in_motion)
        return rib_error(reader, &reader->request_at, "MotionBegin inside a motion block");
    rib_warn(reader, &reader->request_at, "MotionBegin",
             "motion blur is not supported: the first sample of each motion block is used");
    reader->in_motion = true;
    reader->motion_samples = 0;
    return block_push(reader, BLOCK_MOTION);
}

bool read_motion_end(struct rib_reader *reader) {
    reader->in_motion = false;
    return block_pop(reader, BLOCK_MOTION);
}

/* "DIRECTORY OF FILE/name" when `name` is relative and that exists, else `name` as it is. */
static const char *archive_path(struct rib_reader *reader, const char *name) {
    const char *file = reader->sources[reader->source_count - 1].file, *slash = strrchr(file, '/');
    if (name[0] == '/' || !slash)
        return name;
    size_t length = (size_t)(slash - file) + 1, name_length = strlen(name);
    char *path = memory_get(length + name_length + 1, 1);
    memcpy(path, file, length);
    memcpy(path + length, name, name_length);
    const char *kept = rib_intern(reader, path, length + name_length);
    free(path);
    return access(kept, F_OK) == 0 ? kept : name;
}

bool read_archive(struct rib_reader *reader) {
    struct rib_location location = rib_peek(reader)->location;
    const char *name;
    if (!rib_read_string(reader, "file name", &name) || !rib_skip_arguments(reader))
        return false;
    if (reader->source_count > RIB_ARCHIVE_DEPTH_MAX)
        return rib_error_code(reader, &location, STATUS_LIMIT, "more than %d nested archives",
                              RIB_ARCHIVE_DEPTH_MAX);
    if (++reader->archives_read > RIB_ARCHIVES_PER_FRAME_MAX)
        return rib_error_code(reader, &location, STATUS_LIMIT, "more than %d archives in a frame",
                              RIB_ARCHIVES_PER_FRAME_MAX);
    struct status status;
    if (!rib_source_push(reader, archive_path(reader, name), &status))
        return rib_error_code(reader, &location, status.code, "%.800s", status.message);
    const struct rib_lexer *opened = &reader->sources[reader->source_count - 1];
    for (int i = 0; i < reader->source_count - 1; i++) {
        const struct rib_lexer *outer = &reader->sources[i];
        if (opened->inode && outer->inode == opened->inode && outer->device == opened->device) {
            rib_source_pop(reader);
            return rib_error(reader, &location, "the archive \"%.300s\" reads itself", name);
        }
    }
    return true;
}
