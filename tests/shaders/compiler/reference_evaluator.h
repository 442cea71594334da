/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REFERENCE_EVALUATOR_H
#define REFERENCE_EVALUATOR_H

#include "shaders/simd/shader_module.h"

#include <stdbool.h>
#include <stddef.h>

/* What a shader means, said a second time: walks the checked syntax tree, one sample at a time, on
 * scalars, with real control flow. It shares the parser, the checker and the scalar mathematical
 * functions with the compiler, but none of lowering, passes and emission. Results must agree with
 * compiled shaders to the bit, any NaN with any NaN. */
struct reference;

/* One light as it reaches one sample. */
struct reference_light {
    bool is_ambient, is_lit;
    float direction[3], color[3];
};

/* Everything outside of the shader, for one sample. */
struct reference_world {
    /* Component `component` of a parameter or predefined variable (a string's is its identity
     * number as the bits of a float); false: not given. */
    bool (*input)(const void *context, const char *name, int component, float *value);
    const void *context;
    float position[3], incident[3];
    const struct shader_matrices *matrices;
    const struct reference_light *lights;
    int light_count;
};

/* Parses and checks; NULL and a message when the compiler's front end refuses the text. */
struct reference *reference_open(const char *text, bool fast_math, char *message,
                                 size_t message_size);
void reference_close(struct reference *r);

bool reference_is_light(const struct reference *r);
/* A light whose body says neither illuminate nor solar. */
bool reference_is_ambient(const struct reference *r);

/* Runs a surface; false when a loop reached SHADER_LOOP_LIMIT. */
bool reference_shade(struct reference *r, const struct reference_world *world, float color[3]);
/* Runs a light. */
bool reference_run_light(struct reference *r, const struct reference_world *world,
                         struct reference_light *light);

#endif
