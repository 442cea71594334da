/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RANDOM_PROGRAM_H
#define RANDOM_PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

/* A well-typed shader drawn from a seed: all types, fixed-point of any format (in half of the
 * programs), arrays by element and as wholes, functions with output parameters, of one name and
 * inside each other, every kind of control flow (loops are bounded), assignments within
 * expressions, spaces, noise, splines, matrices, lights.
 *
 * Left out, because results are then not told to the bit by the language: literal zeros as
 * components of what is transformed (terms that are zero beforehand are left out of sums), strings
 * at run time that name camera space, loops without an end, and side effects inside subscripts.
 * Left out, because the evaluator has none: derivatives, displacement and volume shaders and
 * messages, texts but for comparison, transformation attributes, shared_phong, extern "C". */
enum { RANDOM_PROGRAM_MATERIALS = 12 };

struct random_program {
    uint64_t seed;
    bool is_light, fast_math;
    uint32_t passes_left_out; /* of the compiler's, as its options take them */
    char *text;               /* one statement a line; owned, random_program_finish */
    char names[RANDOM_PROGRAM_MATERIALS][8];
    const char *material[RANDOM_PROGRAM_MATERIALS + 1]; /* parameters that come with the primitives,
                                                           NULL-terminated */
    int material_count;
};

void random_program_make(struct random_program *program, uint64_t seed, bool is_light);
void random_program_finish(struct random_program *program);

/* Whether a parameter is given, and its values: numbers from name, component and sample. Strings
 * (names starting with "w") are a space. */
bool random_program_input(uint64_t seed, const char *name, bool is_material, int component,
                          int sample, float *value);

#endif
