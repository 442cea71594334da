/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HOST_RUN_H
#define HOST_RUN_H

#include "nodes/programs/render_options.h"

/* Runs the host, by sockets or with the whole cluster in this process, shows progress, prints the
 * summary and writes the JSON. Returns the exit status. */
int host_run(const struct render_options *options);

/* The same without summary and JSON: what the run found out goes to `then`, whose failure is shown
 * and decides the exit status. */
int host_run_then(const struct render_options *options,
                  bool (*then)(void *context, const struct host_report *report,
                               struct status *status),
                  void *context);

#endif
