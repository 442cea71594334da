/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_reader.h"

#include "scenes/rib_requests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct request_entry {
    const char *name;
    unsigned context;
    bool (*carry_out)(struct rib_reader *reader);
};

static const struct request_entry requests[] = {
#define REQUEST_ENTRY(name, context, handler) {#name, context, handler},
    RIB_REQUESTS(REQUEST_ENTRY)
#undef REQUEST_ENTRY
};

static void release_light(void *light) {
    rib_shader_release(light);
}

static void release_object(void *value) {
    struct rib_object *object = value;
    for (size_t i = 0; i < object->count; i++)
        primitive_finish(&object->primitives[i]);
    free(object->primitives);
    free(object);
}

static struct rib_reader *reader_create(const struct scene_options *options) {
    struct rib_reader *reader = memory_get(1, sizeof *reader);
    reader->options = options ? *options : (struct scene_options){0};
    if (!(reader->options.chord_pixels > 0))
        reader->options.chord_pixels = 0.1;
    if (!reader->options.triangles_max)
        reader->options.triangles_max = 50000000;
    reader->sources = memory_get(RIB_ARCHIVE_DEPTH_MAX + 1, sizeof *reader->sources);
    reader->frame_number = 1;
    reader->lights.release = release_light;
    reader->objects.release = release_object;
    reader->camera = (struct camera_options){.fov_degrees = 90,
                                             .width = 640,
                                             .height = 480,
                                             .pixel_aspect = 1,
                                             .samples_x = 1,
                                             .samples_y = 1,
                                             .near_plane = 1e-10,
                                             .far_plane = INFINITY};
    arena_init(&reader->strings, 0);
    graphics_state_init(&reader->state);
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++)
        name_table_set(&reader->requests, requests[i].name, (void *)&requests[i]);
    rib_declare_standard(reader);
    return reader;
}

bool rib_source_push(struct rib_reader *reader, const char *path, struct status *status) {
    const char *file = rib_intern(reader, path, strlen(path));
    if (!rib_lexer_open(&reader->sources[reader->source_count], file, status))
        return false;
    reader->source_count++;
    return true;
}

void rib_source_pop(struct rib_reader *reader) {
    rib_lexer_close(&reader->sources[--reader->source_count]);
}

bool rib_reader_open(const char *path, const struct scene_options *options,
                     struct rib_reader **reader, struct status *status) {
    *reader = reader_create(options);
    if (rib_source_push(*reader, path, status))
        return true;
    rib_reader_destroy(*reader);
    *reader = NULL;
    return false;
}

bool rib_reader_open_memory(const char *path, const char *text, size_t length,
                            const struct scene_options *options, struct rib_reader **reader,
                            struct status *status) {
    *reader = reader_create(options);
    const char *file = rib_intern(*reader, path, strlen(path));
    if (rib_lexer_open_memory(&(*reader)->sources[0], file, text, length, status)) {
        (*reader)->source_count = 1;
        return true;
    }
    rib_reader_destroy(*reader);
    *reader = NULL;
    return false;
}

void rib_reader_destroy(struct rib_reader *reader) {
    if (!reader)
        return;
    rib_frame_abandon(reader);
    rib_blocks_finish(reader);
    graphics_state_finish(&reader->state);
    handle_table_finish(&reader->lights);
    handle_table_finish(&reader->objects);
    while (reader->source_count)
        rib_source_pop(reader);
    free(reader->sources);
    for (size_t i = reader->warning_next; i < reader->warning_count; i++)
        free(reader->warnings[i]);
    free(reader->warnings);
    free(reader->warning_shown);
    free(reader->spaces);
    name_table_finish(&reader->requests);
    name_table_finish(&reader->declarations);
    name_table_finish(&reader->warned);
    name_table_finish(&reader->interned);
    arena_finish(&reader->strings);
    free(reader);
}

static bool check_context(struct rib_reader *reader, const struct request_entry *entry) {
    unsigned context = reader->in_object ? IN_OBJECT : reader->in_world ? IN_WORLD : IN_OPTIONS;
    if (entry->context & context)
        return true;
    return rib_error(reader, &reader->request_at, "%s is not allowed %s", entry->name,
                     context == IN_OBJECT  ? "between ObjectBegin and ObjectEnd"
                     : context == IN_WORLD ? "between WorldBegin and WorldEnd"
                                           : "outside of WorldBegin and WorldEnd");
}

/* Carries out the request that the next token names. */
static bool read_request(struct rib_reader *reader) {
    const struct rib_token *token = rib_peek(reader);
    const struct request_entry *entry = name_table_find(&reader->requests, token->text);
    reader->request_at = token->location;
    reader->request = entry ? entry->name : rib_intern(reader, token->text, token->length);
    rib_take(reader);
    if (!entry) {
        rib_warn(reader, &reader->request_at, reader->request, "unknown request '%.100s': skipped",
                 reader->request);
        return rib_skip_arguments(reader);
    }
    /* Of a motion block only the first sample is carried out. */
    if (reader->in_motion && entry->carry_out != read_motion_end && reader->motion_samples++ > 0)
        return rib_skip_arguments(reader);
    return check_context(reader, entry) && entry->carry_out(reader);
}

/* Until a frame is complete, the file ends or something fails. */
static bool read_requests(struct rib_reader *reader) {
    while (!reader->frame_is_ready) {
        const struct rib_token *token = rib_peek(reader);
        if (token->kind == RIB_TOKEN_END && reader->source_count > 1)
            rib_source_pop(reader);
        else if (token->kind == RIB_TOKEN_END)
            return rib_check_blocks_closed(reader);
        else if (token->kind == RIB_TOKEN_BAD)
            return rib_error(reader, &token->location, "%s", token->text);
        else if (token->kind != RIB_TOKEN_REQUEST)
            return rib_error(reader, &token->location, "a request expected here%s%s",
                             reader->request ? "; too many arguments of " : "",
                             reader->request ? reader->request : "");
        else if (!read_request(reader))
            return false;
    }
    return true;
}

bool rib_reader_next(struct rib_reader *reader, struct scene_frame **frame, struct status *status) {
    struct status ours = {0};
    *frame = NULL;
    reader->status = &ours;
    if (!reader->has_failed && !read_requests(reader)) {
        reader->failure = ours;
        reader->has_failed = true;
        rib_frame_abandon(reader);
    }
    reader->status = NULL;
    if (reader->has_failed)
        return status_fail(status, reader->failure.code, "%s", reader->failure.message);
    if (reader->frame_is_ready) {
        *frame = reader->builder.frame;
        reader->builder = (struct frame_builder){0};
        reader->frame_is_ready = false;
    }
    return true;
}
