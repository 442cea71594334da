/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_CACHE_H
#define SHADER_CACHE_H

#include "base/status.h"
#include "shaders/simd/shader_module.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

/* Compiled shaders as shared objects, addressed by content: the C source, the runtime it includes,
 * the compiler and its flags. Several processes may use one cache: files appear whole, by renaming.
 */
struct shader_cache;

/* Opens $SORTLAST_CACHE, else $XDG_CACHE_HOME/sortlast, else ~/.cache/sortlast; makes the folder
 * (0700) when it is missing and refuses one that others may write to, since code is loaded from it.
 * The C compiler is $SORTLAST_CC, else cc; vectors are as wide as this processor has them unless
 * $SORTLAST_VECTOR_WIDTH (4, 8 or 16 lanes) says otherwise. */
bool shader_cache_open(struct shader_cache **cache, struct status *status);
/* The shared object of the user's that has the extern "C" functions of shaders: its name, which
 * must stay. NULL, as at first: modules that call any are not loaded. */
void shader_cache_set_link(struct shader_cache *cache, const char *object);
/* When *stop becomes non-zero, compilations under way are ended and fail. NULL: never. */
void shader_cache_set_stop(struct shader_cache *cache, const volatile sig_atomic_t *stop);
/* Unloads nothing: modules stay valid until the program ends. */
void shader_cache_close(struct shader_cache *cache);

/* "16 lanes (AVX-512)": which vectors shaders run with. */
const char *shader_cache_vectors(const struct shader_cache *cache);

struct shader_cache_source {
    const char *name; /* for file names and messages */
    const char *text;
};

/* Compiles those sources that are not in the cache yet, as many at a time as there are processors.
 * Fails with the compiler's words. `compiled`, if given, receives how many were compiled. */
bool shader_cache_build(struct shader_cache *cache, const struct shader_cache_source *sources,
                        size_t count, size_t *compiled, struct status *status);

/* The module of a source, compiled if need be; loaded once. Fails, naming function and object, when
 * the module calls an extern "C" function that the linked object lacks. */
bool shader_cache_load(struct shader_cache *cache, struct shader_cache_source source,
                       const struct shader_module **module, struct status *status);

#endif
