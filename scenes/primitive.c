/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/primitive.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    int components;
    enum scene_type scene_type;
} rib_types[] = {
    [RIB_FLOAT] = {"float", 1, SCENE_FLOAT},    [RIB_INTEGER] = {"integer", 1, SCENE_FLOAT},
    [RIB_COLOR] = {"color", 3, SCENE_COLOR},    [RIB_POINT] = {"point", 3, SCENE_POINT},
    [RIB_VECTOR] = {"vector", 3, SCENE_VECTOR}, [RIB_NORMAL] = {"normal", 3, SCENE_NORMAL},
    [RIB_HPOINT] = {"hpoint", 4, SCENE_POINT},  [RIB_MATRIX] = {"matrix", 16, SCENE_MATRIX},
    [RIB_STRING] = {"string", 1, SCENE_STRING},
};

int rib_type_components(enum rib_type type) {
    return rib_types[type].components;
}

const char *rib_type_name(enum rib_type type) {
    return rib_types[type].name;
}

enum scene_type rib_type_to_scene(enum rib_type type) {
    return rib_types[type].scene_type;
}

void primitive_variables_free(struct primitive_variable *variables, int count) {
    for (int i = 0; i < count; i++) {
        free(variables[i].values);
        free(variables[i].strings);
    }
    free(variables);
}

void primitive_finish(struct primitive *primitive) {
    primitive_variables_free(primitive->variables, primitive->variable_count);
    free(primitive->polygons.face_loops);
    free(primitive->polygons.loop_corners);
    free(primitive->polygons.corners);
    *primitive = (struct primitive){0};
}

const struct primitive_variable *primitive_find_variable(const struct primitive *primitive,
                                                         const char *name) {
    for (int i = 0; i < primitive->variable_count; i++)
        if (strcmp(primitive->variables[i].name, name) == 0)
            return &primitive->variables[i];
    return NULL;
}

static size_t patch_value_count(const struct patch_mesh *mesh, enum storage_class storage) {
    size_t patches = (size_t)mesh->patch_count[0] * (size_t)mesh->patch_count[1], corners = 1;
    switch (storage) {
    case STORAGE_CONSTANT:
        return 1;
    case STORAGE_UNIFORM:
        return patches;
    case STORAGE_VARYING:
        for (int i = 0; i < 2; i++)
            corners *= (size_t)mesh->patch_count[i] + !mesh->is_periodic[i];
        return corners;
    case STORAGE_VERTEX:
        return (size_t)mesh->point_count[0] * (size_t)mesh->point_count[1];
    case STORAGE_FACEVARYING:
        return 4 * patches;
    }
    return 0;
}

size_t primitive_value_count(const struct primitive *primitive, enum storage_class storage) {
    if (primitive->kind == PRIMITIVE_PATCHES)
        return patch_value_count(&primitive->patches, storage);
    if (primitive->kind != PRIMITIVE_POLYGONS)
        return storage == STORAGE_CONSTANT || storage == STORAGE_UNIFORM ? 1 : 4;
    switch (storage) {
    case STORAGE_CONSTANT:
        return 1;
    case STORAGE_UNIFORM:
        return primitive->polygons.face_count;
    case STORAGE_VARYING:
    case STORAGE_VERTEX:
        return primitive->polygons.point_count;
    case STORAGE_FACEVARYING:
        return primitive->polygons.corner_count;
    }
    return 0;
}
