/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROGRAM_BUNDLE_H
#define PROGRAM_BUNDLE_H

#include "shaders/compiler/shader_compile.h"
#include "shaders/simd/shader_module.h"

/* Many compiled shaders in one shared object, since starting the C compiler and reading the vector
 * functions costs more than a small shader does. */
struct program_bundle {
    void *library;
    const struct shader_module **modules; /* in the order of the programs */
};

/* How the C is compiled: 4, 8 or 16 lanes (instructions as the processor has them), "-O1" or the
 * like, and the compiler; another one than cc is taken where it is installed. */
struct bundle_settings {
    int width;
    const char *optimisation, *compiler;
};

/* False and a message when the C compiler refuses. */
bool program_bundle_open(struct program_bundle *bundle, struct shader_program *const *programs,
                         int count, const struct bundle_settings *settings, struct status *status);
void program_bundle_close(struct program_bundle *bundle);

#endif
