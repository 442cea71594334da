/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RIB_READER_H
#define RIB_READER_H

#include "base/arena.h"
#include "base/status.h"
#include "scenes/graphics_state.h"
#include "scenes/name_table.h"
#include "scenes/primitive.h"
#include "scenes/rib_lexer.h"
#include "scenes/scene.h"

/* What the files of the RIB reader share; nothing outside the folder includes this. */

/* Limits on input; each has a message of its own. */
enum {
    RIB_ARCHIVE_DEPTH_MAX = 32,
    RIB_ARCHIVES_PER_FRAME_MAX = 100000,
    RIB_BLOCK_DEPTH_MAX = 4096,
    RIB_LIGHTS_MAX = 16384,
    RIB_PRIMITIVES_PER_FRAME_MAX = 10000000,
    RIB_WARNINGS_MAX = 1000,
};

struct declaration {
    enum storage_class storage;
    enum rib_type type;
    int array_length;
    const char *name; /* of an inline declaration; NULL otherwise */
};

/* A parameter list as read; the array and its values are owned. */
struct parameter_list {
    struct primitive_variable *items;
    struct rib_location
        *locations; /* of the names, owned; NULL after they moved into a primitive */
    int count;
    size_t capacity;
    size_t location_capacity;
};

enum parameter_mode {
    PARAMETERS_STRICT,  /* an undeclared name is an error: shaders and primitives */
    PARAMETERS_LENIENT, /* an undeclared name is a warning and skipped: options and attributes */
};

/* Things named by handles (lights, objects): an inner definition hides an outer one until its scope
 * ends. */
struct handle {
    const char *key; /* interned */
    void *value;
    size_t hidden; /* index + 1 of the handle that this one hides; 0: none */
    int scope;
};

struct handle_table {
    struct name_table names; /* value: index + 1 */
    struct handle *handles;
    size_t count, capacity;
    void (*release)(void *value);
};

void *handle_table_find(const struct handle_table *table, const char *key);
void handle_table_add(struct handle_table *table, const char *key, void *value, int scope);
/* Releases all handles defined in scopes deeper than this one. */
void handle_table_leave(struct handle_table *table, int scope);
void handle_table_finish(struct handle_table *table);

struct rib_object {
    struct primitive *primitives;
    size_t count, capacity;
};

/* Camera and image options, saved by FrameBegin. */
struct camera_options {
    bool is_perspective;
    double fov_degrees;
    int width, height;
    double pixel_aspect;
    double frame_aspect_ratio; /* 0: from the format */
    bool has_screen_window;
    double screen_window[4];
    double samples_x, samples_y;
    double near_plane, far_plane;
    const char *display_name;
};

enum block_kind {
    BLOCK_FRAME,
    BLOCK_WORLD,
    BLOCK_ATTRIBUTE,
    BLOCK_TRANSFORM,
    BLOCK_OBJECT,
    BLOCK_MOTION
};

struct block {
    enum block_kind kind;
    struct rib_location location;
    struct graphics_state state;  /* as it was before the block; not of TRANSFORM and MOTION */
    struct mat4 transform;        /* of TRANSFORM */
    struct camera_options camera; /* of FRAME */
};

/* The frame being built, from WorldBegin to WorldEnd. */
struct frame_builder {
    struct scene_frame *frame;
    struct scene_mesh *meshes; /* moved into the arena at the end */
    size_t mesh_count, mesh_capacity;
    size_t triangle_count, primitive_count;
};

struct rib_reader {
    struct scene_options options;
    struct rib_lexer *sources; /* the stack of files; the last one is being read */
    int source_count;
    struct arena strings; /* owns interned strings and declarations */
    struct name_table requests, interned, declarations, warned;
    char **warnings;
    size_t warning_count, warning_capacity, warning_next, warning_total;
    char *warning_shown;

    struct graphics_state state;
    struct camera_options camera;
    struct block *blocks;
    size_t block_count, block_capacity;
    struct handle_table lights, objects;
    struct named_space {
        const char *name;      /* interned */
        struct mat4 transform; /* as graphics_state.transform */
        bool in_world;
    } * spaces;
    size_t space_count, space_capacity;
    uint64_t light_sequence;
    int frame_number;
    bool in_frame, in_world, in_object, in_motion;
    int motion_samples;        /* requests met in the motion block */
    struct rib_object *object; /* being defined; the table of objects owns it */
    struct mat4 world_to_camera;
    struct frame_builder builder;
    uint64_t frame_serial;
    size_t archives_read; /* in this frame */
    bool frame_is_ready;

    struct rib_location request_at; /* the request being carried out */
    const char *request;
    struct status *status; /* of the call in progress */
    struct status failure; /* what ended reading */
    bool has_failed;
};

/* Messages (rib_messages.c). */

/* Fails the call in progress with "FILE:LINE:COLUMN: error: ..." and the source line; returns
 * false. */
bool rib_error(struct rib_reader *reader, const struct rib_location *location, const char *format,
               ...) __attribute__((format(printf, 3, 4)));
bool rib_error_code(struct rib_reader *reader, const struct rib_location *location,
                    enum status_code code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Queues a warning, once for each `key` and file. */
void rib_warn(struct rib_reader *reader, const struct rib_location *location, const char *key,
              const char *format, ...) __attribute__((format(printf, 4, 5)));
const char *rib_intern(struct rib_reader *reader, const char *text, size_t length);

/* Arguments (rib_arguments.c, rib_parameters.c). All fail through rib_error. */

const struct rib_token *rib_peek(struct rib_reader *reader);
void rib_take(struct rib_reader *reader);
bool rib_read_number(struct rib_reader *reader, const char *what, double *number);
bool rib_read_integer(struct rib_reader *reader, const char *what, int minimum, int maximum,
                      int *integer);
/* Exactly `count` numbers, in brackets or bare. */
bool rib_read_numbers(struct rib_reader *reader, const char *what, double *numbers, size_t count);
/* A bracketed array of any length, or one bare number. The caller frees *numbers, also after
 * failure. */
bool rib_read_array(struct rib_reader *reader, const char *what, double **numbers, size_t *count);
bool rib_read_integer_array(struct rib_reader *reader, const char *what, int minimum,
                            int **integers, size_t *count);
/* An interned string. */
bool rib_read_string(struct rib_reader *reader, const char *what, const char **string);
/* A handle of a light or object: number or string, as an interned key. */
bool rib_read_handle(struct rib_reader *reader, const char *what, const char **key);
/* Drops everything up to the next request. */
bool rib_skip_arguments(struct rib_reader *reader);
/* `list` is initialised here; release it with parameter_list_finish, also after failure. */
bool rib_read_parameters(struct rib_reader *reader, enum parameter_mode mode,
                         struct parameter_list *list);
const struct primitive_variable *parameter_list_find(const struct parameter_list *list,
                                                     const char *name);
void parameter_list_finish(struct parameter_list *list);

/* Declarations (rib_declarations.c). */

void rib_declare_standard(struct rib_reader *reader);
/* Parses "[class] type[n]", and with `is_inline` the name after it; returns NULL and sets *problem
 * when the text is none. The result lives as long as the reader. */
const struct declaration *rib_parse_declaration(struct rib_reader *reader, const char *text,
                                                bool is_inline, const char **problem);

/* Building frames (rib_frame.c). */

bool rib_frame_start(struct rib_reader *reader);
bool rib_frame_complete(struct rib_reader *reader);
void rib_frame_abandon(struct rib_reader *reader);
/* Tessellates the primitive into the frame under the current attributes. The caller keeps it. */
bool rib_frame_add(struct rib_reader *reader, const struct primitive *primitive);
/* Lights and surface copied into the frame, once each. */
struct scene_shader *rib_frame_shader(struct rib_reader *reader, struct rib_shader *shader);

/* Object to camera for the current transform. */
struct mat4 rib_current_to_camera(const struct rib_reader *reader);

/* Archives and blocks. */
bool rib_source_push(struct rib_reader *reader, const char *path, struct status *status);
void rib_source_pop(struct rib_reader *reader);

#endif
