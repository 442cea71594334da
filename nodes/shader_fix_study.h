/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_FIX_STUDY_H
#define SHADER_FIX_STUDY_H

#include "nodes/local_services.h"
#include "nodes/shader_fix.h"

/* What the search for sizes (shader_fix.c) stands on: renderings of the scene with a shader in this
 * or that form, and what such a shader costs. */

enum { FIX_NAME_BYTES = 256, FIX_PATH_BYTES = 4096, FIX_MATERIAL_MAX = 128 };

struct fix_study {
    const struct shader_fix_options *options;
    struct trace trace;
    struct local_services *services;
    struct shader_library *library;   /* for what is written */
    struct shader_library *probed;    /* of trials: shaders are compiled once for all of them */
    char name[FIX_NAME_BYTES];        /* that the scene knows the shader by */
    char folder[FIX_PATH_BYTES];      /* for what is written; removed at the end */
    char *original, *written;         /* "NAME=FILE" of the shader and of what is written; owned */
    char *material[FIX_MATERIAL_MAX]; /* parameters that come with the primitives; owned */
    int material_count;
    const struct shader_program *program; /* with variables and source, all floats; owned */
    int width, height;                    /* of small pictures, for trials */
    struct cluster_pictures reference;    /* large, in double precision */
    struct cluster_pictures floats;       /* small, as the shader is */
    struct shader_module *module;         /* with probes, whose values are those of `floats` */
    int renderings;
};

bool fix_study_create(const struct shader_fix_options *options, struct fix_study **study,
                      struct status *status);
void fix_study_destroy(struct fix_study *study);

/* Compiles the shader for these fixings; the program, with its source, is the caller's. */
bool fix_study_write(struct fix_study *study, const struct shader_fixing *fixings,
                     struct shader_program **program, struct status *status);
/* What a shader costs that is given as source. */
bool fix_study_price(struct fix_study *study, const char *source, struct shader_fix_cost *cost,
                     struct status *status);
/* Renders with the module's probes as they are set; *error is the largest difference to `floats`.
 */
bool fix_study_round(struct fix_study *study, struct shader_fix_error *error,
                     struct status *status);
/* Renders large pictures with this source for the shader; the error is against
 * `reference`. NULL: the shader as it is. */
bool fix_study_check(struct fix_study *study, const char *source, struct shader_fix_error *error,
                     struct status *status);

#endif
