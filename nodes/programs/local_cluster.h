/* SPDX-License-Identifier: Apache-2.0 */
#ifndef LOCAL_CLUSTER_H
#define LOCAL_CLUSTER_H

#include "nodes/programs/render_options.h"

/* Starts every node of a cluster as a process of its own on this machine, watches over them, and
 * leaves nothing behind: no process, no socket file, no partial picture. `arguments` are those of
 * `sortlast render`, handed on to the host. Returns the exit status of the run. */
int local_cluster_run(int argument_count, char **arguments, const struct render_options *options);

#endif
