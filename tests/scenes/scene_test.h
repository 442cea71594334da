/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SCENE_TEST_H
#define SCENE_TEST_H

#include "scenes/scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A reader over a text, with what it said. */
struct reading {
    struct rib_reader *reader;
    struct status status;
    char warnings[8192]; /* all so far, a newline after each */
};

static inline void reading_open(struct reading *reading, const char *text,
                                const struct scene_options *options) {
    memset(reading, 0, sizeof *reading);
    assert_true(rib_reader_open_memory("test.rib", text, strlen(text), options, &reading->reader,
                                       &reading->status));
}

static inline void reading_take_warnings(struct reading *reading) {
    const char *warning;
    while ((warning = rib_reader_warning(reading->reader))) {
        size_t used = strlen(reading->warnings);
        if (used + strlen(warning) + 2 < sizeof reading->warnings) {
            strcat(reading->warnings, warning);
            strcat(reading->warnings, "\n");
        }
    }
}

/* The next frame, which must be good; NULL at the end. */
static inline struct scene_frame *reading_next(struct reading *reading) {
    struct scene_frame *frame;
    if (!rib_reader_next(reading->reader, &frame, &reading->status))
        fail_msg("%s", reading->status.message);
    reading_take_warnings(reading);
    return frame;
}

static inline void reading_close(struct reading *reading) {
    rib_reader_destroy(reading->reader);
}

/* The only frame of a text. */
static inline struct scene_frame *read_frame(struct reading *reading, const char *text,
                                             const struct scene_options *options) {
    reading_open(reading, text, options);
    struct scene_frame *frame = reading_next(reading);
    assert_non_null(frame);
    return frame;
}

static inline void frame_close(struct reading *reading, struct scene_frame *frame) {
    scene_frame_destroy(frame);
    reading_close(reading);
}

/* Reads to the end and wants the failure whose message is exactly this. */
static inline void expect_error(const char *text, const struct scene_options *options,
                                const char *message) {
    struct reading reading;
    struct scene_frame *frame;
    reading_open(&reading, text, options);
    while (rib_reader_next(reading.reader, &frame, &reading.status) && frame)
        scene_frame_destroy(frame);
    assert_string_equal(reading.status.message, message);
    reading_close(&reading);
}

/* The same, but only a part of the message. */
static inline void expect_error_part(const char *text, const struct scene_options *options,
                                     const char *part) {
    struct reading reading;
    struct scene_frame *frame;
    reading_open(&reading, text, options);
    while (rib_reader_next(reading.reader, &frame, &reading.status) && frame)
        scene_frame_destroy(frame);
    if (!strstr(reading.status.message, part))
        fail_msg("\"%s\" is not in: %s", part, reading.status.message);
    reading_close(&reading);
}

static inline const struct scene_variable *find_variable(const struct scene_mesh *mesh,
                                                         const char *name) {
    for (int i = 0; i < mesh->variable_count; i++)
        if (strcmp(mesh->variables[i].name, name) == 0)
            return &mesh->variables[i];
    fail_msg("no variable %s", name);
    return NULL;
}

static inline struct vec3 vec3_from(const float *values, size_t index) {
    return vec3_make(values[3 * index], values[3 * index + 1], values[3 * index + 2]);
}

static inline struct vec3 variable_vec3(const struct scene_mesh *mesh, const char *name,
                                        size_t index) {
    return vec3_from(find_variable(mesh, name)->values, index);
}

static inline double variable_float(const struct scene_mesh *mesh, const char *name, size_t index) {
    return find_variable(mesh, name)->values[index];
}

static inline double length3(struct vec3 v) {
    return sqrt(vec3_dot(v, v));
}

/* Twice the area vector of a triangle, by its corners' order. */
static inline struct vec3 triangle_cross(const struct scene_mesh *mesh, size_t triangle) {
    const uint32_t *corner = mesh->triangles + 3 * triangle;
    struct vec3 a = vec3_from(mesh->positions, corner[0]);
    return vec3_cross(vec3_subtract(vec3_from(mesh->positions, corner[1]), a),
                      vec3_subtract(vec3_from(mesh->positions, corner[2]), a));
}

static inline double mesh_area(const struct scene_mesh *mesh) {
    double area = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++)
        area += length3(triangle_cross(mesh, i)) / 2;
    return area;
}

/* What every mesh must hold: indices in range, all numbers finite, N and Ng of unit length,
 * triangles that go round Ng. */
static inline void check_mesh(const struct scene_mesh *mesh) {
    assert_true(mesh->triangle_count > 0);
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        assert_true(mesh->triangles[i] < mesh->vertex_count);
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        assert_true(isfinite(mesh->positions[i]));
    for (int k = 0; k < mesh->variable_count; k++)
        for (size_t i = 0; i < mesh->vertex_count * (size_t)mesh->variables[k].components; i++)
            assert_true(isfinite(mesh->variables[k].values[i]));
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        assert_true(fabs(length3(variable_vec3(mesh, "N", i)) - 1) < 1e-5);
        assert_true(fabs(length3(variable_vec3(mesh, "Ng", i)) - 1) < 1e-5);
    }
}

/* Every triangle that is not a sliver goes round the average Ng of its corners. */
static inline void check_winding(const struct scene_mesh *mesh) {
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        struct vec3 cross = triangle_cross(mesh, i), sum = {0, 0, 0};
        for (int k = 0; k < 3; k++)
            sum = vec3_add(sum, variable_vec3(mesh, "Ng", mesh->triangles[3 * i + (size_t)k]));
        if (length3(cross) > 1e-9)
            assert_true(vec3_dot(cross, sum) > 0);
    }
}

#define IN_VIEW(text)                                                                              \
    "Projection \"perspective\" \"fov\" 60\nTranslate 0 0 8\nWorldBegin\n" text "\nWorldEnd\n"

#endif
