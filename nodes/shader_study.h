/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_STUDY_H
#define SHADER_STUDY_H

#include "images/image.h"
#include "nodes/shader_library.h"
#include "nodes/shading_frame.h"

/* One shader looked at by itself, without a cluster: compiled, bound, and run on a grid of samples
 * that faces the eye. What it costs is counted as a shading node counts it. */

struct shader_study_options {
    const char *path;           /* of the source */
    const char *const *folders; /* for lights and included files */
    int folder_count;
    const char *const *definitions; /* NAME=VALUE[,VALUE...] of bound parameters */
    int definition_count;
    const char *const *material; /* parameters that come with the samples, with constant values */
    int material_count;
    const char *const *lights; /* names of light shaders; NULL and 0: ambient and distant */
    int light_count;
    const char *link;             /* object with extern "C" functions; NULL: none are allowed */
    struct fast_calls fast_calls; /* of this shader; the names in it are not looked at */
    struct shader_compile_options compile; /* fast_math, passes_left_out, dump, memory of a pixel */
};

struct shader_study;

/* Compiles the shader and what a surface needs around it. `program` is there even when nothing can
 * be run: an imager. */
bool shader_study_create(const struct shader_study_options *options, struct shader_study **study,
                         struct status *status);
void shader_study_destroy(struct shader_study *study);
const struct shader_program *shader_study_program(const struct shader_study *study);
/* Warnings of the compiler, one a call; NULL after the last. */
const char *shader_study_warning(struct shader_study *study);

/* Shades width x height samples, both even, s and t from 0 to 1; colours go to `image` (RGBA and Z
 * as frames have them) when it is not NULL. */
bool shader_study_run(struct shader_study *study, uint32_t width, uint32_t height,
                      struct image *image, struct status *status);
/* What the run issued: of the shader, its shared stream apart; of all lights. */
struct shader_study_counts {
    uint64_t operations[SHADER_STREAM_COUNT][SIMD_OPERATION_COUNT];
    uint64_t lights[SIMD_OPERATION_COUNT];
    const uint64_t *block_executions;
    bool has_overrun;
};
void shader_study_count(const struct shader_study *study, struct shader_study_counts *counts);

#endif
