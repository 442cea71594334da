/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name, *arguments;
    int argument_count;
} quadrics[] = {
    [PRIMITIVE_SPHERE] = {"Sphere", "radius zmin zmax thetamax", 4},
    [PRIMITIVE_CYLINDER] = {"Cylinder", "radius zmin zmax thetamax", 4},
    [PRIMITIVE_CONE] = {"Cone", "height radius thetamax", 3},
    [PRIMITIVE_DISK] = {"Disk", "height radius thetamax", 3},
    [PRIMITIVE_PARABOLOID] = {"Paraboloid", "rmax zmin zmax thetamax", 4},
    [PRIMITIVE_HYPERBOLOID] = {"Hyperboloid", "x1 y1 z1 x2 y2 z2 thetamax", 7},
    [PRIMITIVE_TORUS] = {"Torus", "majorradius minorradius phimin phimax thetamax", 5},
};

/* Variables of the tessellator that a file may not give. */
static bool is_reserved(const char *name) {
    static const char *const names[] = {"Ng", "u", "v", "dPdu", "dPdv"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

/* Whether a standard variable has the type that its meaning needs. */
static bool has_standard_type(const struct primitive_variable *item) {
    static const struct {
        const char *name;
        enum rib_type type;
        int array_length;
    } standard[] = {{"P", RIB_POINT, 0},  {"N", RIB_NORMAL, 0}, {"Np", RIB_NORMAL, 0},
                    {"Cs", RIB_COLOR, 0}, {"Os", RIB_COLOR, 0}, {"s", RIB_FLOAT, 0},
                    {"t", RIB_FLOAT, 0},  {"st", RIB_FLOAT, 2}};
    for (size_t i = 0; i < sizeof standard / sizeof *standard; i++)
        if (strcmp(standard[i].name, item->name) == 0)
            return standard[i].type == item->type && standard[i].array_length == item->array_length;
    return true;
}

static bool check_variable(struct rib_reader *reader, const struct primitive *primitive,
                           const struct primitive_variable *item,
                           const struct rib_location *location) {
    static const char *const classes[] = {"constant", "uniform", "varying", "vertex",
                                          "facevarying"};
    if (item->type == RIB_HPOINT || item->type == RIB_MATRIX || strcmp(item->name, "Pz") == 0)
        return rib_error(reader, location, "%s: \"%.100s\" of type %s is not supported",
                         reader->request, item->name, rib_type_name(item->type));
    if (is_reserved(item->name))
        return rib_error(reader, location, "%s: \"%s\" is computed and cannot be given",
                         reader->request, item->name);
    if (!has_standard_type(item))
        return rib_error(reader, location,
                         "%s: \"%s\" is declared with another type than it has in RIB",
                         reader->request, item->name);
    size_t values = primitive_value_count(primitive, item->storage);
    size_t needed = values * (size_t)primitive_variable_components(item);
    if (item->type == RIB_STRING && values != 1)
        return rib_error(reader, location, "%s: strings must be constant (\"%.100s\")",
                         reader->request, item->name);
    if (item->count != needed)
        return rib_error(reader, location, "%s: \"%.100s\" (%s %s) takes %zu values, not %zu",
                         reader->request, item->name, classes[item->storage],
                         rib_type_name(item->type), needed, item->count);
    return true;
}

bool rib_finish_primitive(struct rib_reader *reader, struct primitive *primitive,
                          struct parameter_list *list) {
    bool is_good = true;
    primitive->variables = list->items;
    primitive->variable_count = list->count;
    primitive->location = reader->request_at.at;
    primitive->transform = mat4_identity;
    for (int i = 0; is_good && i < list->count; i++)
        is_good = check_variable(reader, primitive, &list->items[i], &list->locations[i]);
    list->items = NULL;
    list->count = 0;
    parameter_list_finish(list);
    if (is_good && reader->in_object) {
        struct rib_object *object = reader->object;
        primitive->transform = reader->state.transform;
        object->primitives = memory_grow(object->primitives, &object->capacity, object->count + 1,
                                         sizeof *object->primitives);
        object->primitives[object->count++] = *primitive;
        return true;
    }
    is_good = is_good && rib_frame_add(reader, primitive);
    primitive_finish(primitive);
    return is_good;
}

bool rib_fail_primitive(struct primitive *primitive, struct parameter_list *list) {
    primitive_finish(primitive);
    parameter_list_finish(list);
    return false;
}

bool read_quadric(struct rib_reader *reader) {
    struct primitive primitive = {0};
    struct parameter_list list = {0};
    while (strcmp(quadrics[primitive.kind].name, reader->request) != 0)
        primitive.kind++;
    if (!rib_read_numbers(reader, quadrics[primitive.kind].arguments, primitive.arguments,
                          (size_t)quadrics[primitive.kind].argument_count))
        return false;
    if (!rib_read_parameters(reader, PARAMETERS_STRICT, &list))
        return rib_fail_primitive(&primitive, &list);
    const struct primitive_variable *points = parameter_list_find(&list, "P");
    if (points) {
        rib_error(reader, &list.locations[points - list.items], "%s takes no \"P\"",
                  reader->request);
        return rib_fail_primitive(&primitive, &list);
    }
    return rib_finish_primitive(reader, &primitive, &list);
}

bool rib_find_points(struct rib_reader *reader, const struct parameter_list *list, size_t *count) {
    const struct primitive_variable *points = parameter_list_find(list, "P");
    if (!points) {
        for (int i = 0; i < list->count; i++)
            if (strcmp(list->items[i].name, "Pw") == 0 || strcmp(list->items[i].name, "Pz") == 0)
                return rib_error(reader, &list->locations[i],
                                 "%s: \"%s\" is not supported; give \"P\"", reader->request,
                                 list->items[i].name);
        return rib_error(reader, &reader->request_at, "%s needs \"P\"", reader->request);
    }
    if (points->type != RIB_POINT || points->array_length || points->count % 3 ||
        (points->storage != STORAGE_VERTEX && points->storage != STORAGE_VARYING))
        return rib_error(reader, &list->locations[points - list->items],
                         "%s: \"P\" takes three numbers a point, not %zu in all", reader->request,
                         points->count);
    *count = points->count / 3;
    return true;
}

static bool read_patch_type(struct rib_reader *reader, struct patch_mesh *mesh) {
    struct rib_location location = rib_peek(reader)->location;
    const char *type;
    if (!rib_read_string(reader, "type", &type))
        return false;
    mesh->order = strcmp(type, "bilinear") == 0 ? 2 : strcmp(type, "bicubic") == 0 ? 4 : 0;
    if (!mesh->order)
        return rib_error(reader, &location, "%s: \"bilinear\" or \"bicubic\" expected",
                         reader->request);
    memcpy(mesh->basis, reader->state.basis, sizeof mesh->basis);
    for (int i = 0; i < 2; i++)
        mesh->step[i] = mesh->order == 2 ? 1 : reader->state.basis_step[i];
    return true;
}

static bool read_wrap(struct rib_reader *reader, bool *is_periodic) {
    struct rib_location location = rib_peek(reader)->location;
    const char *wrap;
    if (!rib_read_string(reader, "wrap", &wrap))
        return false;
    *is_periodic = strcmp(wrap, "periodic") == 0;
    if (!*is_periodic && strcmp(wrap, "nonperiodic") != 0)
        return rib_error(reader, &location, "%s: \"periodic\" or \"nonperiodic\" expected",
                         reader->request);
    return true;
}

/* How many patches the points of one direction make. */
static bool count_patches(struct rib_reader *reader, struct patch_mesh *mesh, int axis,
                          const struct rib_location *location) {
    int points = mesh->point_count[axis], step = mesh->step[axis], order = mesh->order;
    bool is_periodic = mesh->is_periodic[axis];
    const char *direction = axis ? "v" : "u";
    if (is_periodic && points % step)
        return rib_error(reader, location,
                         "%s: %d periodic points in %s: a multiple of %d expected", reader->request,
                         points, direction, step);
    if (!is_periodic && (points < order || (points - order) % step))
        return rib_error(reader, location,
                         "%s: %d points in %s: %d and a multiple of %d more expected",
                         reader->request, points, direction, order, step);
    mesh->patch_count[axis] = is_periodic ? points / step : (points - order) / step + 1;
    return true;
}

static bool finish_patches(struct rib_reader *reader, struct primitive *primitive,
                           struct parameter_list *list) {
    const struct patch_mesh *mesh = &primitive->patches;
    size_t points, needed = (size_t)mesh->point_count[0] * (size_t)mesh->point_count[1];
    if (!rib_read_parameters(reader, PARAMETERS_STRICT, list) ||
        !rib_find_points(reader, list, &points))
        return rib_fail_primitive(primitive, list);
    if (points != needed) {
        const struct primitive_variable *item = parameter_list_find(list, "P");
        rib_error(reader, &list->locations[item - list->items],
                  "%s: \"P\" takes %zu points, not %zu", reader->request, needed, points);
        return rib_fail_primitive(primitive, list);
    }
    return rib_finish_primitive(reader, primitive, list);
}

bool read_patch(struct rib_reader *reader) {
    struct primitive primitive = {.kind = PRIMITIVE_PATCHES};
    struct parameter_list list = {0};
    struct patch_mesh *mesh = &primitive.patches;
    if (!read_patch_type(reader, mesh))
        return false;
    for (int i = 0; i < 2; i++) {
        mesh->point_count[i] = mesh->order;
        mesh->patch_count[i] = 1;
    }
    return finish_patches(reader, &primitive, &list);
}

bool read_patch_mesh(struct rib_reader *reader) {
    struct primitive primitive = {.kind = PRIMITIVE_PATCHES};
    struct parameter_list list = {0};
    struct patch_mesh *mesh = &primitive.patches;
    if (!read_patch_type(reader, mesh))
        return false;
    for (int i = 0; i < 2; i++) {
        struct rib_location location = rib_peek(reader)->location;
        if (!rib_read_integer(reader, i ? "nv" : "nu", 1, 1 << 24, &mesh->point_count[i]) ||
            !read_wrap(reader, &mesh->is_periodic[i]) || !count_patches(reader, mesh, i, &location))
            return false;
    }
    return finish_patches(reader, &primitive, &list);
}
