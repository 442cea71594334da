/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_FIX_H
#define SHADER_FIX_H

#include "nodes/cluster_in_process.h"

/* From floats to fixed-point by itself: the variables of a surface shader get the sizes that cost
 * the array least while the pictures of a scene stay within a bound. What values they have is seen
 * in that scene (and bounded by interval arithmetic), what rounding each of them does to the
 * picture is tried, and the result is a shader in the language, rendered before it is believed. */

enum shader_fix_stage {
    SHADER_FIX_LOOKING,  /* the reference, and what values variables have */
    SHADER_FIX_ROUNDING, /* as many variables as can be, a byte shorter each time */
    SHADER_FIX_CHOOSING, /* floats where these are cheaper */
    SHADER_FIX_CHECKING, /* the shader written, compiled and rendered */
};

struct shader_fix_options {
    const char *path;                     /* of the shader; the scene knows it by its file name */
    const struct host_options *rendering; /* scene, frames, folders, machine */
    double max_error; /* of the colours of pixels, against double precision: 0.00784 is 2/255 */
    /* Share of the pixels that may be further off: where a shader decides (floor, if), a sample
     * right at the limit may fall to the other side, in floats too. 0: none. */
    double outliers;
    const volatile sig_atomic_t *stop; /* gives up, with STATUS_OK in the status; NULL: never */
    void (*progress)(void *context, enum shader_fix_stage stage, size_t done, size_t of);
    void *progress_context;
};

/* How far pictures are from those in double precision. */
struct shader_fix_error {
    double bulk;            /* largest difference but for the outliers */
    double largest;         /* of all; infinite where a colour is not finite */
    uint64_t pixels_beyond; /* that differ by more than max_error */
    uint64_t pixels;
};

/* What a shader costs by itself: in the streams of its own, every block once. */
struct shader_fix_cost {
    ticks time;
    int allocated_bytes, spilled_bytes; /* of pixel memory */
};

struct shader_fix_variable {
    char name[48]; /* the user's, or "" */
    int line;
    float lowest, highest;
    struct fixed_format format; /* size 0: stays a float */
};

struct shader_fix_result {
    char *source; /* owned */
    struct shader_fix_cost before, after;
    struct shader_fix_error error_before, error_after;
    struct shader_fix_variable *variables; /* those that could be fixed-point; owned */
    size_t variable_count;
    int renderings; /* made on the way */
};

/* Fails with STATUS_INVALID, naming the least error it reached, when the bound cannot be met, and
 * when the shader would not become cheaper; with the compiler's words when it is not a surface
 * shader, is not in the scene, or has what cannot be written. */
bool shader_fix(const struct shader_fix_options *options, struct shader_fix_result *result,
                struct status *status);
void shader_fix_result_finish(struct shader_fix_result *result);

#endif
