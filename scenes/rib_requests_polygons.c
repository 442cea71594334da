/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Which arrays stand before the parameter list. */
enum polygon_arrays {
    HAVE_FACE_LOOPS = 1,   /* nloops: loops of each face */
    HAVE_LOOP_CORNERS = 2, /* nverts: corners of each loop */
    HAVE_CORNERS = 4,      /* verts: points of the corners */
};

static int *array_fill(size_t count, int value) {
    int *array = memory_get(count, sizeof *array);
    for (size_t i = 0; i < count; i++)
        array[i] = value;
    return array;
}

/* The sum of an array, which must equal `expected` when that is not SIZE_MAX. */
static bool check_sum(struct rib_reader *reader, const int *array, size_t count, size_t expected,
                      const char *what, size_t *sum) {
    *sum = 0;
    for (size_t i = 0; i < count; i++)
        *sum += (size_t)array[i];
    if (*sum > INT_MAX)
        return rib_error(reader, &reader->request_at, "%s: too many %s", reader->request, what);
    if (expected != SIZE_MAX && *sum != expected)
        return rib_error(reader, &reader->request_at,
                         "%s: the counts add up to %zu %s, but %zu are given", reader->request,
                         *sum, what, expected);
    return true;
}

static bool read_counts(struct rib_reader *reader, unsigned arrays, struct polygon_mesh *mesh) {
    size_t sum;
    if (arrays & HAVE_FACE_LOOPS) {
        if (!rib_read_integer_array(reader, "number of loops", 1, &mesh->face_loops,
                                    &mesh->face_count))
            return false;
    }
    if (arrays & HAVE_LOOP_CORNERS) {
        if (!rib_read_integer_array(reader, "number of corners", 3, &mesh->loop_corners,
                                    &mesh->loop_count))
            return false;
        if (!check_sum(reader, mesh->loop_corners, mesh->loop_count, SIZE_MAX, "corners",
                       &mesh->corner_count))
            return false;
    }
    if (arrays & HAVE_CORNERS) {
        size_t count = mesh->corner_count;
        if (!rib_read_integer_array(reader, "index of a point", 0, &mesh->corners,
                                    &mesh->corner_count) ||
            !check_sum(reader, mesh->loop_corners, mesh->loop_count, mesh->corner_count, "corners",
                       &count))
            return false;
    }
    if (arrays & HAVE_FACE_LOOPS)
        return check_sum(reader, mesh->face_loops, mesh->face_count, mesh->loop_count, "loops",
                         &sum);
    if (arrays & HAVE_CORNERS) {
        mesh->face_count = mesh->loop_count;
        mesh->face_loops = array_fill(mesh->face_count, 1);
    } else if (arrays & HAVE_LOOP_CORNERS) {
        mesh->face_count = 1;
        mesh->face_loops = array_fill(1, (int)mesh->loop_count);
    }
    return true;
}

/* Fills in what the arrays did not give, now that the number of points is known. */
static bool match_points(struct rib_reader *reader, unsigned arrays, struct polygon_mesh *mesh) {
    if (arrays == 0) {
        if (mesh->point_count < 3 || mesh->point_count > INT_MAX)
            return rib_error(reader, &reader->request_at,
                             "Polygon needs at least 3 points, \"P\" has %zu", mesh->point_count);
        mesh->face_count = mesh->loop_count = 1;
        mesh->corner_count = mesh->point_count;
        mesh->face_loops = array_fill(1, 1);
        mesh->loop_corners = array_fill(1, (int)mesh->point_count);
    }
    if (arrays & HAVE_CORNERS) {
        for (size_t i = 0; i < mesh->corner_count; i++)
            if ((size_t)mesh->corners[i] >= mesh->point_count)
                return rib_error(reader, &reader->request_at,
                                 "%s: corner %zu is point %d, but \"P\" has only %zu points",
                                 reader->request, i, mesh->corners[i], mesh->point_count);
        return true;
    }
    if (mesh->corner_count != mesh->point_count)
        return rib_error(reader, &reader->request_at, "%s: %zu corners, but \"P\" has %zu points",
                         reader->request, mesh->corner_count, mesh->point_count);
    mesh->corners = array_fill(mesh->corner_count, 0);
    for (size_t i = 0; i < mesh->corner_count; i++)
        mesh->corners[i] = (int)i;
    return true;
}

static bool read_polygons(struct rib_reader *reader, unsigned arrays) {
    struct primitive primitive = {.kind = PRIMITIVE_POLYGONS};
    struct polygon_mesh *mesh = &primitive.polygons;
    struct parameter_list list = {0};
    if (!read_counts(reader, arrays, mesh) ||
        !rib_read_parameters(reader, PARAMETERS_STRICT, &list) ||
        !rib_find_points(reader, &list, &mesh->point_count) || !match_points(reader, arrays, mesh))
        return rib_fail_primitive(&primitive, &list);
    return rib_finish_primitive(reader, &primitive, &list);
}

bool read_polygon(struct rib_reader *reader) {
    return read_polygons(reader, 0);
}

bool read_general_polygon(struct rib_reader *reader) {
    return read_polygons(reader, HAVE_LOOP_CORNERS);
}

bool read_points_polygons(struct rib_reader *reader) {
    return read_polygons(reader, HAVE_LOOP_CORNERS | HAVE_CORNERS);
}

bool read_points_general_polygons(struct rib_reader *reader) {
    return read_polygons(reader, HAVE_FACE_LOOPS | HAVE_LOOP_CORNERS | HAVE_CORNERS);
}
