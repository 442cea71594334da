/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/vertex_components.h"

#include "nodes/bound_parameters.h"

#include <stdlib.h>
#include <string.h>

const struct scene_variable *scene_mesh_variable(const struct scene_mesh *mesh, const char *name) {
    for (int i = 0; i < mesh->variable_count; i++)
        if (!strcmp(mesh->variables[i].name, name))
            return &mesh->variables[i];
    return NULL;
}

/* The values of a variable that feeds a parameter with a transformation attribute from plain floats
 * (PF section 3.1), brought into camera space; kept until the mesh is done. */
static const float *transformed_values(struct vertex_components *components,
                                       const struct scene_mesh *mesh,
                                       const struct shader_parameter *parameter,
                                       const struct scene_variable *variable) {
    const size_t count = mesh->vertex_count;
    components->transformed =
        memory_grow(components->transformed, &components->transformed_capacity,
                    components->transformed_count + 1, sizeof *components->transformed);
    float *values = memory_get(count * 3, sizeof *values);
    memcpy(values, variable->values, count * 3 * sizeof *values);
    for (size_t v = 0; v < count; v++)
        bound_parameter_to_camera(values + 3 * v, bound_parameter_transformed_as(parameter),
                                  &mesh->object_to_camera);
    components->transformed[components->transformed_count++] = values;
    return values;
}

void vertex_components_list(const struct scene_mesh *mesh, const struct shader_program *program,
                            struct vertex_components *components) {
    *components = (struct vertex_components){0};
    static const float zero;
    components->count = (uint32_t)program->material_count;
    components->list = memory_get(components->count, sizeof *components->list);
    for (uint32_t c = 0; c < components->count; c++)
        components->list[c] = (struct vertex_component){&zero, 0};
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *parameter = &program->parameters[i];
        if (!parameter->is_material)
            continue;
        const struct scene_variable *variable = scene_mesh_variable(mesh, parameter->name);
        const float *values = variable ? variable->values : NULL;
        if (variable && variable->type == SCENE_FLOAT &&
            bound_parameter_transformed_as(parameter) != SHADER_FLOAT)
            values = transformed_values(components, mesh, parameter, variable);
        const float *constant = !strcmp(parameter->name, "Cs")   ? mesh->color
                                : !strcmp(parameter->name, "Os") ? mesh->opacity
                                                                 : NULL;
        for (int c = 0; c < parameter->components; c++) {
            struct vertex_component *source = &components->list[parameter->map_offset + c];
            if (variable)
                *source = (struct vertex_component){values + c, (size_t)variable->components};
            else if (constant)
                *source = (struct vertex_component){constant + c, 0};
        }
    }
}

void vertex_components_finish(struct vertex_components *components) {
    while (components->transformed_count)
        free(components->transformed[--components->transformed_count]);
    free(components->transformed);
    free(components->list);
    *components = (struct vertex_components){0};
}
