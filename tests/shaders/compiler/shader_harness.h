/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_HARNESS_H
#define SHADER_HARNESS_H

#include "shaders/compiler/shader_compile.h"
#include "shaders/loader/shader_texts.h"
#include "shaders/simd/shader_module.h"

/* Compiles RSL all the way to code that runs in this process, and runs it on a few samples. Asserts
 * through cmocka that everything before the behaviour under test works. */

enum { HARNESS_SAMPLES = 16, HARNESS_BLOCKS = 64, HARNESS_LIGHT_VECTORS = 32 };

struct harness {
    struct shader_program *program;
    void *library;
    const struct shader_module *module;
    float *uniform;
    float bound[64];
    uint8_t given[64];
    struct shader_matrices matrices;
    struct shader_counters counters;
    uint64_t executions[HARNESS_BLOCKS];
    struct text_table texts; /* while running */
    char bound_texts[512];
    size_t bound_text_bytes;
    uint32_t absent; /* bit i: lane i is no sample, for shaders that ask about neighbours */
};

/* What run() shades: sample i has s = i, t = 0.5, P = (i, 2, 3), I = (0, 0, 1), N = (0, 0, -1);
 * other material parameters are i + 100 * component. For a shader that asks about neighbours the
 * samples are quads side by side: s = u = column, t = v = 0.5 + row, P = (column, 2 + row, 3). */
struct harness_result {
    float color[3][HARNESS_SAMPLES], opacity[3][HARNESS_SAMPLES];
    int overrun;
};

/* `material` is a NULL-terminated list of names or NULL (for a light: what it exports); width is 4,
 * 8 or 16. */
void harness_open(struct harness *h, const char *source, int width, const char *const *material);
/* Takes over the program. */
void harness_open_program(struct harness *h, struct shader_program *program, int width);
/* A surface with the shaders around it, NULL for none; fails the test when that does not compile.
 */
struct shader_program *harness_compile_with(const char *source, const char *displacement,
                                            const char *atmosphere);
void harness_close(struct harness *h);
/* Binds a parameter by name. */
void harness_bind(struct harness *h, const char *name, const float *values);
void harness_bind_string(struct harness *h, const char *name, const char *text);
/* Prepares and shades all samples under these lights. */
void harness_run(struct harness *h, struct harness *const *lights, int light_count,
                 struct harness_result *result);
/* The parameter of this name; fails the test when there is none. */
const struct shader_parameter *harness_parameter(const struct shader_program *program,
                                                 const char *name);
/* Operations of a stream over all blocks. */
uint32_t harness_operations(const struct shader_module *module, int stream, int operation);
/* Compiles only; NULL and the message when that fails. */
struct shader_program *harness_compile(const char *source, const char *const *material,
                                       struct status *status);

#endif
