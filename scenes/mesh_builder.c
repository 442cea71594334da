/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/mesh_builder.h"

#include <math.h>
#include <string.h>

static bool is_named(const struct primitive_variable *item, const char *name) {
    return strcmp(item->name, name) == 0;
}

/* Variables that become something else than a variable of the same name. */
static bool is_consumed(const struct primitive_variable *item) {
    static const char *const names[] = {"P", "N", "Np", "s", "t", "st"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (is_named(item, names[i]))
            return true;
    return item->storage == STORAGE_CONSTANT && (is_named(item, "Cs") || is_named(item, "Os"));
}

static bool is_constant(const struct primitive_variable *item) {
    return item->storage == STORAGE_CONSTANT || item->type == RIB_STRING;
}

bool texture_coordinates_are_uv(const double *texture_coordinates) {
    static const double standard[8] = {0, 0, 1, 0, 0, 1, 1, 1};
    return memcmp(texture_coordinates, standard, sizeof standard) == 0;
}

static bool check_limits(const struct mesh_builder *builder, struct status *status) {
    size_t limit = builder->tessellation->triangles_max;
    if (builder->triangle_capacity > limit)
        return status_fail(status, STATUS_LIMIT,
                           "%zu triangles needed where the limit of the frame leaves %zu",
                           builder->triangle_capacity, limit);
    if (builder->vertex_count > UINT32_MAX || builder->triangle_capacity > UINT32_MAX)
        return status_fail(status, STATUS_LIMIT,
                           "more than 2^32 vertices or triangles in a primitive");
    return true;
}

static float *carve(float **memory, size_t count) {
    float *part = *memory;
    *memory += count;
    return part;
}

static void find_standard_variables(struct mesh_builder *builder) {
    for (int i = 0; i < builder->primitive->variable_count; i++) {
        const struct primitive_variable *item = &builder->primitive->variables[i];
        bool is_st = is_named(item, "st");
        builder->has_user_n |= is_named(item, "N") || is_named(item, "Np");
        builder->has_user_s |= is_st || is_named(item, "s");
        builder->has_user_t |= is_st || is_named(item, "t");
    }
}

bool mesh_builder_start(struct mesh_builder *builder, const struct tessellation *tessellation,
                        const struct primitive *primitive, size_t vertex_count,
                        size_t triangle_capacity, bool shares_st, struct scene_mesh *mesh,
                        struct status *status) {
    *builder = (struct mesh_builder){.tessellation = tessellation,
                                     .primitive = primitive,
                                     .vertex_count = vertex_count,
                                     .triangle_capacity = triangle_capacity};
    if (!check_limits(builder, status))
        return false;
    find_standard_variables(builder);
    bool own_s = builder->has_user_s || !shares_st, own_t = builder->has_user_t || !shares_st;
    size_t floats = 3 + 3 + 3 + 3 + 1 + 1 + own_s + own_t + (builder->has_user_n ? 3 : 0);
    for (int i = 0; i < primitive->variable_count; i++)
        if (!is_consumed(&primitive->variables[i]) && !is_constant(&primitive->variables[i]))
            floats += (size_t)primitive_variable_components(&primitive->variables[i]);
    struct arena *arena = tessellation->arena;
    builder->user = arena_get(arena, (size_t)primitive->variable_count * sizeof *builder->user);
    float *memory = arena_get(arena, floats * vertex_count * sizeof *memory +
                                         3 * triangle_capacity * sizeof *builder->triangles);
    builder->positions = carve(&memory, 3 * vertex_count);
    builder->n = carve(&memory, 3 * vertex_count);
    builder->ng = builder->has_user_n ? carve(&memory, 3 * vertex_count) : builder->n;
    builder->dpdu = carve(&memory, 3 * vertex_count);
    builder->dpdv = carve(&memory, 3 * vertex_count);
    builder->u = carve(&memory, vertex_count);
    builder->v = carve(&memory, vertex_count);
    builder->s = own_s ? carve(&memory, vertex_count) : builder->u;
    builder->t = own_t ? carve(&memory, vertex_count) : builder->v;
    for (int i = 0; i < primitive->variable_count; i++)
        if (!is_consumed(&primitive->variables[i]) && !is_constant(&primitive->variables[i]))
            builder->user[i] = carve(&memory, vertex_count * (size_t)primitive_variable_components(
                                                                 &primitive->variables[i]));
    builder->triangles = (uint32_t *)memory;
    *mesh = (struct scene_mesh){.object_to_camera = tessellation->object_to_camera};
    return true;
}

/* NaN marks what cannot be shown; mesh_builder_finish clears it. */
static void put_point(float *out, struct vec3 p) {
    const float x = (float)p.x, y = (float)p.y, z = (float)p.z;
    bool is_good = isfinite(x) && isfinite(y) && isfinite(z);
    out[0] = is_good ? x : NAN;
    out[1] = is_good ? y : NAN;
    out[2] = is_good ? z : NAN;
}

static float finite_or_zero(double value) {
    float narrow = (float)value;
    return isfinite(narrow) ? narrow : 0;
}

static void put_vector(float *out, struct vec3 v) {
    out[0] = finite_or_zero(v.x);
    out[1] = finite_or_zero(v.y);
    out[2] = finite_or_zero(v.z);
}

/* Unit length at any scale; what has no direction faces the eye. */
static void put_normal(float *out, struct vec3 n) {
    double largest = fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    if (!(largest > 0) || !isfinite(largest)) {
        put_vector(out, vec3_make(0, 0, -1));
        return;
    }
    int exponent;
    frexp(largest, &exponent);
    put_vector(out, vec3_normalize(vec3_make(ldexp(n.x, -exponent), ldexp(n.y, -exponent),
                                             ldexp(n.z, -exponent))));
}

static double homogeneous_w(const struct mat4 *matrix, struct vec3 p) {
    const double(*m)[4] = matrix->m;
    return p.x * m[0][3] + p.y * m[1][3] + p.z * m[2][3] + m[3][3];
}

/* The image of a tangent vector at a point: the derivative of the map, which is projective in
 * general. */
static struct vec3 transform_tangent(const struct tessellation *t, struct vec3 p, struct vec3 d) {
    struct vec3 moved = mat4_vector(&t->object_to_camera, d);
    if (t->is_affine)
        return moved;
    const double(*m)[4] = t->object_to_camera.m;
    double w = homogeneous_w(&t->object_to_camera, p);
    double dw = d.x * m[0][3] + d.y * m[1][3] + d.z * m[2][3];
    struct vec3 image = mat4_point(&t->object_to_camera, p);
    return vec3_scale(vec3_subtract(moved, vec3_scale(image, dw)), 1 / w);
}

/* The image of the normal at a point: its tangent plane as a row of four goes by the inverse. */
static struct vec3 transform_normal(const struct tessellation *t, struct vec3 p, struct vec3 n) {
    struct vec3 moved = mat4_normal(&t->camera_to_object, n);
    if (t->is_affine)
        return moved;
    const double(*m)[4] = t->camera_to_object.m;
    double offset = -vec3_dot(n, p);
    moved = vec3_add(moved, vec3_scale(vec3_make(m[0][3], m[1][3], m[2][3]), offset));
    return homogeneous_w(&t->object_to_camera, p) < 0 ? vec3_scale(moved, -1) : moved;
}

/* One number of a variable, interpolated as its storage class says. */
static double variable_value(const struct primitive_variable *item,
                             const struct vertex_source *source, int component, int components) {
    const double *values = item->values + component;
    const size_t *index = source->varying;
    const double *weights = source->corner_weights;
    int count = source->corner_count;
    switch (item->storage) {
    case STORAGE_CONSTANT:
        return values[0];
    case STORAGE_UNIFORM:
        return values[source->uniform * (size_t)components];
    case STORAGE_VARYING:
        break;
    case STORAGE_FACEVARYING:
        index = source->facevarying;
        break;
    case STORAGE_VERTEX:
        index = source->points;
        weights = source->point_weights;
        count = source->point_count;
        break;
    }
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += weights[i] * values[index[i] * (size_t)components];
    return sum;
}

static void put_variable(struct mesh_builder *builder, const struct primitive_variable *item,
                         float *out, size_t vertex, struct vec3 position,
                         const struct vertex_source *source) {
    const struct tessellation *t = builder->tessellation;
    int components = primitive_variable_components(item);
    if (out)
        out += vertex * (size_t)components;
    if (item->type == RIB_POINT || item->type == RIB_VECTOR || item->type == RIB_NORMAL) {
        bool is_n = is_named(item, "N") || is_named(item, "Np");
        for (int i = 0; i < components; i += 3) {
            struct vec3 value = {variable_value(item, source, i, components),
                                 variable_value(item, source, i + 1, components),
                                 variable_value(item, source, i + 2, components)};
            if (is_n)
                put_normal(builder->n + 3 * vertex, transform_normal(t, position, value));
            else if (item->type == RIB_POINT)
                put_vector(out + i, mat4_point(&t->object_to_camera, value));
            else if (item->type == RIB_VECTOR)
                put_vector(out + i, transform_tangent(t, position, value));
            else
                put_vector(out + i, transform_normal(t, position, value));
        }
        return;
    }
    bool is_st = is_named(item, "st");
    if (is_st || is_named(item, "s"))
        builder->s[vertex] = finite_or_zero(variable_value(item, source, 0, components));
    if (is_st || is_named(item, "t"))
        builder->t[vertex] = finite_or_zero(variable_value(item, source, is_st, components));
    for (int i = 0; out && i < components; i++)
        out[i] = finite_or_zero(variable_value(item, source, i, components));
}

void mesh_builder_put(struct mesh_builder *builder, size_t vertex,
                      const struct surface_point *point, const struct vertex_source *source) {
    const struct tessellation *t = builder->tessellation;
    put_point(builder->positions + 3 * vertex, mat4_point(&t->object_to_camera, point->position));
    struct vec3 normal = transform_normal(t, point->position, point->normal);
    put_normal(builder->ng + 3 * vertex, t->is_reversed ? vec3_scale(normal, -1) : normal);
    put_vector(builder->dpdu + 3 * vertex, transform_tangent(t, point->position, point->dpdu));
    put_vector(builder->dpdv + 3 * vertex, transform_tangent(t, point->position, point->dpdv));
    builder->u[vertex] = finite_or_zero(point->u);
    builder->v[vertex] = finite_or_zero(point->v);
    if (builder->s != builder->u)
        builder->s[vertex] = finite_or_zero(point->s);
    if (builder->t != builder->v)
        builder->t[vertex] = finite_or_zero(point->t);
    for (int i = 0; i < builder->primitive->variable_count; i++) {
        const struct primitive_variable *item = &builder->primitive->variables[i];
        if (builder->user[i] || (item->values && is_consumed(item) && !is_named(item, "P")))
            put_variable(builder, item, builder->user[i], vertex, point->position, source);
    }
}

static bool is_same_point(const float *a, const float *b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

void mesh_builder_triangle(struct mesh_builder *builder, size_t a, size_t b, size_t c) {
    const float *p = builder->positions + 3 * a, *q = builder->positions + 3 * b,
                *r = builder->positions + 3 * c;
    if (isnan(p[0]) || isnan(q[0]) || isnan(r[0])) {
        builder->dropped++;
        return;
    }
    if (is_same_point(p, q) || is_same_point(q, r) || is_same_point(r, p))
        return;
    bool flips = builder->tessellation->flips_winding;
    uint32_t *out = builder->triangles + 3 * builder->triangle_count++;
    out[0] = (uint32_t)a;
    out[1] = (uint32_t)(flips ? c : b);
    out[2] = (uint32_t)(flips ? b : c);
}

/* Cells in blocks of BLOCK_U x BLOCK_V: consecutive triangles then lie close together on the
 * surface, and so does a chunk of them (256 triangles are one block) on the screen, where it
 * touches few regions and rows. */
void mesh_builder_grid(struct mesh_builder *builder, size_t first_vertex, size_t nu, size_t nv) {
    enum { BLOCK_U = 16, BLOCK_V = 8 };
    for (size_t block_j = 0; block_j < nv; block_j += BLOCK_V)
        for (size_t block_i = 0; block_i < nu; block_i += BLOCK_U)
            for (size_t j = block_j; j < nv && j < block_j + BLOCK_V; j++)
                for (size_t i = block_i; i < nu && i < block_i + BLOCK_U; i++) {
                    size_t a = first_vertex + j * (nu + 1) + i, b = a + 1, c = a + nu + 1,
                           d = c + 1;
                    mesh_builder_triangle(builder, a, b, d);
                    mesh_builder_triangle(builder, a, d, c);
                }
}

static void add_variable(struct scene_mesh *mesh, const char *name, enum scene_type type,
                         int components, const float *values) {
    mesh->variables[mesh->variable_count++] =
        (struct scene_variable){name, type, components, values};
}

static void add_constant(struct scene_mesh *mesh, struct arena *arena,
                         const struct primitive_variable *item) {
    struct scene_parameter *constant = &mesh->constants[mesh->constant_count++];
    *constant =
        (struct scene_parameter){.name = arena_copy_string(arena, item->name, strlen(item->name)),
                                 .type = rib_type_to_scene(item->type),
                                 .array_length = item->array_length,
                                 .location = item->location};
    if (item->type == RIB_STRING) {
        constant->strings = arena_get(arena, item->count * sizeof *constant->strings);
        for (size_t i = 0; i < item->count; i++)
            constant->strings[i] =
                arena_copy_string(arena, item->strings[i], strlen(item->strings[i]));
        return;
    }
    float *values = arena_get(arena, item->count * sizeof *values);
    for (size_t i = 0; i < item->count; i++)
        values[i] = (float)item->values[i];
    constant->values = values;
}

static void add_user_variables(const struct mesh_builder *builder, struct scene_mesh *mesh) {
    struct arena *arena = builder->tessellation->arena;
    for (int i = 0; i < builder->primitive->variable_count; i++) {
        const struct primitive_variable *item = &builder->primitive->variables[i];
        if (builder->user[i])
            add_variable(mesh, arena_copy_string(arena, item->name, strlen(item->name)),
                         rib_type_to_scene(item->type), primitive_variable_components(item),
                         builder->user[i]);
        else if (is_constant(item) && !is_consumed(item))
            add_constant(mesh, arena, item);
    }
}

void mesh_builder_finish(struct mesh_builder *builder, struct scene_mesh *mesh, size_t *dropped) {
    struct arena *arena = builder->tessellation->arena;
    size_t user_count = (size_t)builder->primitive->variable_count;
    for (size_t i = 0; builder->dropped && i < 3 * builder->vertex_count; i++)
        if (isnan(builder->positions[i]))
            builder->positions[i] = 0;
    mesh->vertex_count = (uint32_t)builder->vertex_count;
    mesh->triangle_count = (uint32_t)builder->triangle_count;
    mesh->positions = builder->positions;
    mesh->triangles = builder->triangles;
    mesh->variables = arena_get(arena, (8 + user_count) * sizeof *mesh->variables);
    mesh->constants = arena_get(arena, user_count * sizeof *mesh->constants);
    add_variable(mesh, "N", SCENE_NORMAL, 3, builder->n);
    add_variable(mesh, "Ng", SCENE_NORMAL, 3, builder->ng);
    add_variable(mesh, "s", SCENE_FLOAT, 1, builder->s);
    add_variable(mesh, "t", SCENE_FLOAT, 1, builder->t);
    add_variable(mesh, "u", SCENE_FLOAT, 1, builder->u);
    add_variable(mesh, "v", SCENE_FLOAT, 1, builder->v);
    add_variable(mesh, "dPdu", SCENE_VECTOR, 3, builder->dpdu);
    add_variable(mesh, "dPdv", SCENE_VECTOR, 3, builder->dpdv);
    add_user_variables(builder, mesh);
    *dropped += builder->dropped;
}
