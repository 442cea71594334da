/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/mesh_builder.h"

#include <math.h>
#include <stdlib.h>

/* Bilinear and bicubic patch meshes. Every column and every row of patches has one number of
 * divisions, so that neighbours share their vertices and no crack opens. */

/* The weights of the control points along one axis and their derivatives, for one parameter value.
 */
struct axis_weights {
    double value[4], first[4], second[4];
};

static struct axis_weights axis_weights_at(const struct patch_mesh *mesh, int axis, double x) {
    struct axis_weights weights = {{0}, {0}, {0}};
    if (mesh->order == 2)
        return (struct axis_weights){{1 - x, x}, {-1, 1}, {0}};
    const double(*basis)[4] = mesh->basis[axis];
    for (int i = 0; i < 4; i++) {
        weights.value[i] = ((basis[0][i] * x + basis[1][i]) * x + basis[2][i]) * x + basis[3][i];
        weights.first[i] = (3 * basis[0][i] * x + 2 * basis[1][i]) * x + basis[2][i];
        weights.second[i] = 6 * basis[0][i] * x + 2 * basis[1][i];
    }
    return weights;
}

/* The control points of one patch: indices and places, u fastest, order x order of them. */
struct patch {
    size_t index[16];
    struct vec3 points[16];
};

static void patch_load(const struct patch_mesh *mesh, const double *values, int column, int row,
                       struct patch *patch) {
    for (int j = 0; j < mesh->order; j++)
        for (int i = 0; i < mesh->order; i++) {
            size_t x =
                ((size_t)column * (size_t)mesh->step[0] + (size_t)i) % (size_t)mesh->point_count[0];
            size_t y =
                ((size_t)row * (size_t)mesh->step[1] + (size_t)j) % (size_t)mesh->point_count[1];
            size_t index = y * (size_t)mesh->point_count[0] + x;
            patch->index[j * mesh->order + i] = index;
            patch->points[j * mesh->order + i] =
                vec3_make(values[3 * index], values[3 * index + 1], values[3 * index + 2]);
        }
}

static struct vec3 patch_sum(const struct patch *patch, int order, const double *u,
                             const double *v) {
    struct vec3 sum = {0, 0, 0};
    for (int j = 0; j < order; j++) {
        struct vec3 along = {0, 0, 0};
        for (int i = 0; i < order; i++)
            along = vec3_add(along, vec3_scale(patch->points[j * order + i], u[i]));
        sum = vec3_add(sum, vec3_scale(along, v[j]));
    }
    return sum;
}

static double vec3_length(struct vec3 v) {
    return sqrt(vec3_dot(v, v));
}

/* How much the patch bends: the largest second derivatives found on a 4 x 4 grid; along u they are
 * linear in u, so that only the other way is sampled. A tenth is added for what lies between the
 * samples. */
static void patch_bend(const struct patch_mesh *mesh, const struct patch *patch, double *along_u,
                       double *along_v, double *twist) {
    *along_u = *along_v = *twist = 0;
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            struct axis_weights u = axis_weights_at(mesh, 0, i / 3.),
                                v = axis_weights_at(mesh, 1, j / 3.);
            *along_u =
                fmax(*along_u, vec3_length(patch_sum(patch, mesh->order, u.second, v.value)));
            *along_v =
                fmax(*along_v, vec3_length(patch_sum(patch, mesh->order, u.value, v.second)));
            *twist = fmax(*twist, vec3_length(patch_sum(patch, mesh->order, u.first, v.first)));
        }
    *along_u *= 1.1;
    *along_v *= 1.1;
    *twist *= 1.1;
}

struct patch_grid {
    int *divisions[2]; /* of each column, of each row */
    size_t total[2];
};

static void grid_finish(struct patch_grid *grid) {
    free(grid->divisions[0]);
    free(grid->divisions[1]);
}

static int at_least(int a, int b) {
    return a > b ? a : b;
}

/* A box around the patch itself: its control points bound it for the common bases; for others its
 * own points on the sampling grid are added. */
static struct bounds patch_bounds(const struct patch_mesh *mesh, const struct patch *patch) {
    struct bounds bounds = bounds_empty();
    for (int i = 0; i < mesh->order * mesh->order; i++)
        bounds_add(&bounds, patch->points[i]);
    for (int j = 0; mesh->order == 4 && j < 4; j++)
        for (int i = 0; i < 4; i++) {
            struct axis_weights u = axis_weights_at(mesh, 0, i / 3.),
                                v = axis_weights_at(mesh, 1, j / 3.);
            bounds_add(&bounds, patch_sum(patch, 4, u.value, v.value));
        }
    struct vec3 margin =
        vec3_scale(vec3_subtract(bounds.high, bounds.low), mesh->order == 4 ? 0.15 : 0);
    bounds.low = vec3_subtract(bounds.low, margin);
    bounds.high = vec3_add(bounds.high, margin);
    return bounds;
}

/* Chooses the divisions of all columns and rows from the patches that can be seen; false when none
 * can. */
static bool grid_divide(const struct tessellation *t, const struct patch_mesh *mesh,
                        const double *values, struct patch_grid *grid) {
    double half = t->chord_pixels / 2, along[2], twist;
    bool is_visible = false;
    for (int axis = 0; axis < 2; axis++) {
        grid->divisions[axis] = memory_get((size_t)mesh->patch_count[axis], sizeof(int));
        for (int i = 0; i < mesh->patch_count[axis]; i++)
            grid->divisions[axis][i] = 1;
    }
    for (int row = 0; row < mesh->patch_count[1]; row++)
        for (int column = 0; column < mesh->patch_count[0]; column++) {
            struct patch patch;
            patch_load(mesh, values, column, row, &patch);
            struct bounds bounds = patch_bounds(mesh, &patch);
            struct visibility visibility = tessellation_visibility(t, &bounds);
            if (visibility.is_outside)
                continue;
            is_visible = true;
            double pixels = fmin(visibility.pixels_per_unit, 1e30);
            patch_bend(mesh, &patch, &along[0], &along[1], &twist);
            int *nu = &grid->divisions[0][column], *nv = &grid->divisions[1][row];
            *nu = at_least(*nu, divide_curve(along[0] * pixels, half));
            *nv = at_least(*nv, divide_curve(along[1] * pixels, half));
            /* A twisted cell of two triangles misses the surface by twist / 4 over its area's
             * share. */
            double cells = fmin(twist * pixels / (4 * half), (double)DIVISIONS_MAX * DIVISIONS_MAX);
            if (cells > (double)*nu * *nv) {
                double more = sqrt(cells / ((double)*nu * *nv));
                *nu = (int)fmin(DIVISIONS_MAX, ceil(*nu * more));
                *nv = (int)fmin(DIVISIONS_MAX, ceil(*nv * more));
            }
        }
    for (int axis = 0; axis < 2; axis++)
        for (int i = 0; i < mesh->patch_count[axis]; i++)
            grid->total[axis] += (size_t)grid->divisions[axis][i];
    return is_visible;
}

/* dPdu x dPdv, or where an edge has shrunk to a point that of a place a little inside. */
static struct vec3 patch_normal(const struct patch_mesh *mesh, const struct patch *patch, double u,
                                double v, struct vec3 dpdu, struct vec3 dpdv) {
    struct vec3 normal = vec3_cross(dpdu, dpdv);
    double size = 0;
    for (int i = 1; i < mesh->order * mesh->order; i++)
        size = fmax(size, vec3_length(vec3_subtract(patch->points[i], patch->points[0])));
    if (vec3_length(normal) > 1e-9 * size * size)
        return normal;
    u += (0.5 - u) * 1e-3;
    v += (0.5 - v) * 1e-3;
    struct axis_weights wu = axis_weights_at(mesh, 0, u), wv = axis_weights_at(mesh, 1, v);
    return vec3_cross(patch_sum(patch, mesh->order, wu.first, wv.value),
                      patch_sum(patch, mesh->order, wu.value, wv.first));
}

/* Indices of the corners among the values of STORAGE_VARYING and STORAGE_FACEVARYING. */
static void patch_corners(const struct patch_mesh *mesh, int column, int row,
                          struct vertex_source *source) {
    size_t width = (size_t)mesh->patch_count[0] + !mesh->is_periodic[0];
    size_t height = (size_t)mesh->patch_count[1] + !mesh->is_periodic[1];
    source->uniform = (size_t)row * (size_t)mesh->patch_count[0] + (size_t)column;
    source->corner_count = 4;
    for (int i = 0; i < 4; i++) {
        size_t x = ((size_t)column + (i & 1)) % width, y = ((size_t)row + (i >> 1)) % height;
        source->varying[i] = y * width + x;
        source->facevarying[i] = 4 * source->uniform + (size_t)i;
    }
}

/* Where in the mesh a patch is evaluated. */
struct patch_place {
    const struct patch_mesh *mesh;
    const struct patch *patch;
    int column, row;
    struct vertex_source source;
};

static void put_patch_point(struct mesh_builder *builder, struct patch_place *place, double x,
                            double y, const struct axis_weights *wu, const struct axis_weights *wv,
                            size_t vertex) {
    const struct patch_mesh *mesh = place->mesh;
    const double *corners = builder->tessellation->texture_coordinates;
    int order = mesh->order;
    struct vec3 du = patch_sum(place->patch, order, wu->first, wv->value);
    struct vec3 dv = patch_sum(place->patch, order, wu->value, wv->first);
    struct surface_point point = {
        .position = patch_sum(place->patch, order, wu->value, wv->value),
        .dpdu = vec3_scale(du, mesh->patch_count[0]),
        .dpdv = vec3_scale(dv, mesh->patch_count[1]),
        .normal = patch_normal(mesh, place->patch, x, y, du, dv),
        .u = (place->column + x) / mesh->patch_count[0],
        .v = (place->row + y) / mesh->patch_count[1],
    };
    const double weights[4] = {(1 - point.u) * (1 - point.v), point.u * (1 - point.v),
                               (1 - point.u) * point.v, point.u * point.v};
    const double local[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
    for (int i = 0; i < 4; i++) {
        point.s += weights[i] * corners[2 * i];
        point.t += weights[i] * corners[2 * i + 1];
        place->source.corner_weights[i] = local[i];
    }
    place->source.point_count = order * order;
    for (int i = 0; i < order * order; i++) {
        place->source.points[i] = place->patch->index[i];
        place->source.point_weights[i] = wu->value[i % order] * wv->value[i / order];
    }
    mesh_builder_put(builder, vertex, &point, &place->source);
}

/* The vertices of one patch; those on its far edges belong to the next patch, if there is one. With
 * values that jump between patches, every patch has all of its own. */
static void put_patch(struct mesh_builder *builder, const struct patch_mesh *mesh,
                      const struct patch *patch, int column, int row, int nu, int nv, bool is_split,
                      size_t first, size_t stride) {
    struct patch_place place = {mesh, patch, column, row, {0}};
    bool has_last_u = is_split || column == mesh->patch_count[0] - 1;
    bool has_last_v = is_split || row == mesh->patch_count[1] - 1;
    struct axis_weights *across = memory_get((size_t)nu + 1, sizeof *across);
    patch_corners(mesh, column, row, &place.source);
    for (int i = 0; i <= nu; i++)
        across[i] = axis_weights_at(mesh, 0, (double)i / nu);
    for (int j = 0; j < nv + has_last_v; j++) {
        struct axis_weights up = axis_weights_at(mesh, 1, (double)j / nv);
        for (int i = 0; i < nu + has_last_u; i++)
            put_patch_point(builder, &place, (double)i / nu, (double)j / nv, &across[i], &up,
                            first + (size_t)j * stride + (size_t)i);
    }
    free(across);
}

/* Whether a variable may have two values where patches meet. */
static bool values_jump(const struct primitive *primitive) {
    if (primitive->patches.patch_count[0] == 1 && primitive->patches.patch_count[1] == 1)
        return false;
    for (int i = 0; i < primitive->variable_count; i++)
        if (primitive->variables[i].storage == STORAGE_UNIFORM ||
            primitive->variables[i].storage == STORAGE_FACEVARYING)
            return true;
    return false;
}

static void put_mesh(struct mesh_builder *builder, const struct primitive *primitive,
                     const double *values, const struct patch_grid *grid, bool is_split) {
    const struct patch_mesh *mesh = &primitive->patches;
    size_t stride = grid->total[0] + 1, next = 0, top = 0;
    for (int row = 0; row < mesh->patch_count[1]; row++) {
        size_t left = 0;
        int nv = grid->divisions[1][row];
        for (int column = 0; column < mesh->patch_count[0]; column++) {
            struct patch patch;
            int nu = grid->divisions[0][column];
            patch_load(mesh, values, column, row, &patch);
            size_t first = is_split ? next : top * stride + left;
            put_patch(builder, mesh, &patch, column, row, nu, nv, is_split, first,
                      is_split ? (size_t)nu + 1 : stride);
            if (is_split)
                mesh_builder_grid(builder, first, (size_t)nu, (size_t)nv);
            next += ((size_t)nu + 1) * ((size_t)nv + 1);
            left += (size_t)nu;
        }
        top += (size_t)nv;
    }
    if (!is_split)
        mesh_builder_grid(builder, 0, grid->total[0], grid->total[1]);
}

bool tessellate_patches(struct tessellation *t, const struct primitive *primitive,
                        struct scene_mesh *mesh, struct status *status) {
    const struct patch_mesh *patches = &primitive->patches;
    const double *values = primitive_find_variable(primitive, "P")->values;
    struct patch_grid grid = {{NULL, NULL}, {0, 0}};
    struct mesh_builder builder;
    bool is_good = true, is_split = values_jump(primitive);
    if (grid_divide(t, patches, values, &grid)) {
        size_t vertices = (grid.total[0] + 1) * (grid.total[1] + 1);
        if (is_split)
            vertices = (grid.total[0] + (size_t)patches->patch_count[0]) *
                       (grid.total[1] + (size_t)patches->patch_count[1]);
        is_good =
            mesh_builder_start(&builder, t, primitive, vertices, 2 * grid.total[0] * grid.total[1],
                               texture_coordinates_are_uv(t->texture_coordinates), mesh, status);
        if (is_good) {
            put_mesh(&builder, primitive, values, &grid, is_split);
            mesh_builder_finish(&builder, mesh, &t->dropped_triangles);
        }
    }
    grid_finish(&grid);
    return is_good;
}
