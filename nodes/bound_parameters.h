/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BOUND_PARAMETERS_H
#define BOUND_PARAMETERS_H

#include "scenes/scene.h"
#include "shaders/compiler/shader_compile.h"

/* Where the bound values of an instance come from: the Surface or LightSource call, constant
 * primitive variables (which win), and the colour attributes. */
struct bound_source {
    const struct scene_shader *shader; /* NULL: the default surface */
    const struct scene_shader *displacement, *atmosphere;
    const struct scene_parameter *constants;
    int constant_count;
    const struct mat4 *object_to_camera;
    const struct scene_camera *camera; /* NULL for lights */
    const float *color, *opacity;      /* NULL for lights */
};

/* Fills `bound` and `given` (program->bound_count entries). Points, vectors and normals are brought
 * to camera space. A parameter the shader does not have, or of another type, is an error naming the
 * place in the scene. */
/* The texts of the strings that were given, each ended by a NUL: the caller frees *texts. */
void bound_parameters_texts(const struct shader_program *program, const struct bound_source *source,
                            char **texts, size_t *bytes);
/* The category of a light: what the scene says, else the shader's own. */
const char *bound_parameters_category(const struct shader_program *program,
                                      const struct bound_source *source);
bool bound_parameters_fill(const struct shader_program *program, const struct bound_source *source,
                           float *bound, uint8_t *given, struct status *status);

/* What the parameter's values are transformed as: its type, or what its transformation attribute
 * says (PF section 3.1); SHADER_FLOAT: they are not. */
enum shader_type bound_parameter_transformed_as(const struct shader_parameter *parameter);
/* Brings a point, vector or normal into camera space, in place. */
void bound_parameter_to_camera(float *value, enum shader_type type, const struct mat4 *matrix);

#endif
