/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RUNTIME_TEXT_H
#define RUNTIME_TEXT_H

#include <stddef.h>

/* The headers that compiled shaders include (shader_module.h, vector_math.h and all they include),
 * embedded so that a node can write them beside a shader it compiles. They include each other by
 * plain file name. */
struct runtime_file {
    const char *name; /* without folders */
    const char *text; /* zero-terminated */
    size_t length;    /* without the zero */
};

extern const struct runtime_file runtime_files[];
extern const int runtime_file_count;

#endif
