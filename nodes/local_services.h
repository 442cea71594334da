/* SPDX-License-Identifier: Apache-2.0 */
#ifndef LOCAL_SERVICES_H
#define LOCAL_SERVICES_H

#include "nodes/node.h"

#include <signal.h>

/* The services of a real node: shaders from the shader cache of this machine, pictures written by a
 * thread of their own so that the next frame need not wait for the disk. */
struct local_services;

/* `stop`, when not NULL, ends compilations under way once it is set by a signal. */
struct local_services *local_services_create(struct trace *trace,
                                             const volatile sig_atomic_t *stop);
/* See shader_cache_set_link; before the first shader. */
void local_services_set_link(struct local_services *services, const char *object);
/* Pictures not finished are finished first. */
void local_services_destroy(struct local_services *services);
/* For node constructors; valid as long as `services`. */
const struct node_services *local_services_interface(struct local_services *services);
/* Compiles shaders ahead of their use; see shader_cache_build. */
bool local_services_build_shaders(void *services, const char *const *names,
                                  const char *const *sources, size_t count, size_t *compiled,
                                  struct status *status);

#endif
