/* SPDX-License-Identifier: Apache-2.0 */
#ifndef COMPILED_OBJECT_H
#define COMPILED_OBJECT_H

#include "base/status.h"

#include <stddef.h>

/* Compiles the C of a shader with `compiler` (a command and its flags) and loads the shared object;
 * the caller closes it with dlclose. Objects are kept by what they are made of where SORTLAST_CACHE
 * is set: the suite runs in several builds, and the generated C is the same in all. NULL and a
 * message when the compiler refuses. */
void *compiled_object_load(const char *text, size_t length, const char *compiler,
                           struct status *status);

#endif
