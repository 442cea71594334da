/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/mesh_builder.h"
#include "scenes/triangulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is known of a polygon mesh while it is cut. */
struct polygon_cutter {
    const struct polygon_mesh *mesh;
    const double *points;
    bool is_split;          /* a vertex for each corner; otherwise for each point */
    struct vec3 *normals;   /* of each vertex, not normalised */
    size_t *face_of_vertex; /* only when split */
    double *plane_points;   /* scratch: the corners of one face in its plane */
    uint32_t *cut;          /* scratch: its triangles */
};

static struct vec3 point_at(const struct polygon_cutter *cutter, size_t corner) {
    const double *p = cutter->points + 3 * (size_t)cutter->mesh->corners[corner];
    return vec3_make(p[0], p[1], p[2]);
}

static size_t vertex_of(const struct polygon_cutter *cutter, size_t corner) {
    return cutter->is_split ? corner : (size_t)cutter->mesh->corners[corner];
}

/* Newell's normal of a loop: twice the area in length, along (p1 - p0) x (p2 - p0). */
static struct vec3 loop_normal(const struct polygon_cutter *cutter, size_t first, size_t count) {
    struct vec3 origin = point_at(cutter, first), normal = {0, 0, 0};
    struct vec3 before = vec3_subtract(point_at(cutter, first + 1), origin);
    for (size_t i = 2; i < count; i++) {
        struct vec3 after = vec3_subtract(point_at(cutter, first + i), origin);
        normal = vec3_add(normal, vec3_cross(before, after));
        before = after;
    }
    return normal;
}

/* Drops the coordinate along which the face is seen largest. */
static void project_face(struct polygon_cutter *cutter, size_t first, size_t count,
                         struct vec3 normal) {
    struct vec3 origin = point_at(cutter, first);
    double x = fabs(normal.x), y = fabs(normal.y), z = fabs(normal.z);
    for (size_t i = 0; i < count; i++) {
        struct vec3 p = vec3_subtract(point_at(cutter, first + i), origin);
        double *out = cutter->plane_points + 2 * i;
        out[0] = x >= y && x >= z ? p.y : p.x;
        out[1] = z > x && z > y ? p.y : p.z;
    }
}

static bool cut_face(struct polygon_cutter *cutter, struct mesh_builder *builder, size_t first,
                     const int *loop_corners, int loop_count, struct status *status) {
    size_t count = 0, triangles;
    for (int i = 0; i < loop_count; i++)
        count += (size_t)loop_corners[i];
    if (count == 3) {
        mesh_builder_triangle(builder, vertex_of(cutter, first), vertex_of(cutter, first + 1),
                              vertex_of(cutter, first + 2));
        return true;
    }
    project_face(cutter, first, count, loop_normal(cutter, first, (size_t)loop_corners[0]));
    if (!triangulate_polygon(cutter->plane_points, loop_corners, loop_count, cutter->cut,
                             &triangles, status))
        return false;
    for (size_t i = 0; i < triangles; i++) {
        const uint32_t *corner = cutter->cut + 3 * i;
        mesh_builder_triangle(builder, vertex_of(cutter, first + corner[0]),
                              vertex_of(cutter, first + corner[1]),
                              vertex_of(cutter, first + corner[2]));
    }
    return true;
}

/* Normals of faces, given to their corners or added up at shared points. */
static void find_normals(struct polygon_cutter *cutter) {
    const struct polygon_mesh *mesh = cutter->mesh;
    size_t corner = 0, loop = 0;
    for (size_t face = 0; face < mesh->face_count; face++) {
        struct vec3 normal = loop_normal(cutter, corner, (size_t)mesh->loop_corners[loop]);
        for (int i = 0; i < mesh->face_loops[face]; i++, loop++)
            for (int k = 0; k < mesh->loop_corners[loop]; k++, corner++) {
                struct vec3 *sum = &cutter->normals[vertex_of(cutter, corner)];
                *sum = vec3_add(*sum, normal);
                if (cutter->is_split)
                    cutter->face_of_vertex[corner] = face;
            }
    }
}

/* u and v of a polygon are x and y of object space, so that dPdu and dPdv follow the plane above
 * the x and y axes; planes that hold the z axis get unit vectors along them instead. */
static void find_tangents(struct surface_point *point) {
    struct vec3 n = vec3_normalize(point->normal);
    if (fabs(n.z) > 1e-3) {
        point->dpdu = vec3_make(1, 0, -n.x / n.z);
        point->dpdv = vec3_make(0, 1, -n.y / n.z);
        return;
    }
    point->dpdu = vec3_normalize(vec3_cross(vec3_make(0, 0, 1), n));
    if (vec3_dot(point->dpdu, point->dpdu) == 0)
        point->dpdu = vec3_make(1, 0, 0);
    point->dpdv = vec3_cross(n, point->dpdu);
}

static void put_vertices(struct polygon_cutter *cutter, struct mesh_builder *builder) {
    const double *corners = builder->tessellation->texture_coordinates;
    struct vertex_source source = {.corner_count = 1, .point_count = 1};
    source.corner_weights[0] = source.point_weights[0] = 1;
    for (size_t i = 0; i < builder->vertex_count; i++) {
        size_t index = cutter->is_split ? (size_t)cutter->mesh->corners[i] : i;
        const double *p = cutter->points + 3 * index;
        struct surface_point point = {
            .position = {p[0], p[1], p[2]}, .normal = cutter->normals[i], .u = p[0], .v = p[1]};
        point.s = corners[0] + (corners[2] - corners[0]) * p[0] + (corners[4] - corners[0]) * p[1];
        point.t = corners[1] + (corners[3] - corners[1]) * p[0] + (corners[5] - corners[1]) * p[1];
        find_tangents(&point);
        source.varying[0] = source.points[0] = index;
        source.uniform = cutter->is_split ? cutter->face_of_vertex[i] : 0;
        source.facevarying[0] = i;
        mesh_builder_put(builder, i, &point, &source);
    }
}

/* Whether corners at one point may differ: in the plane normal where N is not given, in values of
 * faces. */
static bool needs_split(const struct primitive *primitive) {
    bool has_n = false, is_single = primitive->polygons.face_count == 1;
    for (int i = 0; i < primitive->variable_count; i++) {
        const struct primitive_variable *item = &primitive->variables[i];
        if (item->storage == STORAGE_FACEVARYING ||
            (item->storage == STORAGE_UNIFORM && !is_single))
            return true;
        has_n |= strcmp(item->name, "N") == 0 || strcmp(item->name, "Np") == 0;
    }
    return !has_n && !is_single;
}

/* Upper bounds: of all triangles, and of the corners and loops of one face. */
static size_t count_triangles(const struct polygon_mesh *mesh, size_t *corners_max,
                              size_t *loops_max) {
    size_t triangles = 0, loop = 0;
    *corners_max = *loops_max = 0;
    for (size_t face = 0; face < mesh->face_count; face++) {
        size_t loops = (size_t)mesh->face_loops[face], corners = 0;
        for (size_t i = 0; i < loops; i++)
            corners += (size_t)mesh->loop_corners[loop++];
        triangles += corners + 2 * (loops - 1) - 2;
        *corners_max = corners > *corners_max ? corners : *corners_max;
        *loops_max = loops > *loops_max ? loops : *loops_max;
    }
    return triangles;
}

static bool is_visible(const struct tessellation *t, const struct primitive *primitive,
                       const double *points) {
    struct bounds bounds = bounds_empty();
    for (size_t i = 0; i < primitive->polygons.point_count; i++)
        bounds_add(&bounds, vec3_make(points[3 * i], points[3 * i + 1], points[3 * i + 2]));
    return primitive->polygons.face_count > 0 && !tessellation_visibility(t, &bounds).is_outside;
}

static bool cut_faces(struct polygon_cutter *cutter, struct mesh_builder *builder,
                      struct status *status) {
    const struct polygon_mesh *mesh = cutter->mesh;
    size_t corner = 0, loop = 0;
    for (size_t face = 0; face < mesh->face_count; face++) {
        if (!cut_face(cutter, builder, corner, mesh->loop_corners + loop, mesh->face_loops[face],
                      status))
            return false;
        for (int i = 0; i < mesh->face_loops[face]; i++)
            corner += (size_t)mesh->loop_corners[loop++];
    }
    return true;
}

bool tessellate_polygons(struct tessellation *t, const struct primitive *primitive,
                         struct scene_mesh *mesh, struct status *status) {
    const struct polygon_mesh *polygons = &primitive->polygons;
    const double *points = primitive_find_variable(primitive, "P")->values;
    struct mesh_builder builder;
    size_t corners_max, loops_max;
    if (!is_visible(t, primitive, points))
        return true;
    size_t triangles = count_triangles(polygons, &corners_max, &loops_max);
    bool is_split = needs_split(primitive);
    size_t vertices = is_split ? polygons->corner_count : polygons->point_count;
    if (!mesh_builder_start(&builder, t, primitive, vertices, triangles,
                            texture_coordinates_are_uv(t->texture_coordinates), mesh, status))
        return false;
    struct polygon_cutter cutter = {.mesh = polygons, .points = points, .is_split = is_split};
    cutter.normals = memory_get(vertices, sizeof *cutter.normals);
    cutter.face_of_vertex = memory_get(is_split ? vertices : 0, sizeof *cutter.face_of_vertex);
    cutter.plane_points = memory_get(corners_max, 2 * sizeof *cutter.plane_points);
    cutter.cut = memory_get(corners_max + 2 * loops_max, 3 * sizeof *cutter.cut);
    find_normals(&cutter);
    put_vertices(&cutter, &builder);
    bool is_good = cut_faces(&cutter, &builder, status);
    if (is_good)
        mesh_builder_finish(&builder, mesh, &t->dropped_triangles);
    free(cutter.normals);
    free(cutter.face_of_vertex);
    free(cutter.plane_points);
    free(cutter.cut);
    return is_good;
}
