/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RENDER_REPORT_H
#define RENDER_REPORT_H

#include "nodes/programs/render_options.h"

#include <stdio.h>

/* What a run has to say: progress while it goes, then the summary for a person and the same as
 * JSON. */

struct render_progress {
    FILE *stream;
    bool is_terminal, is_quiet, is_verbose, has_line;
    double begin_s;
};

void render_progress_begin(struct render_progress *progress, const struct render_options *options);
/* The observer that feeds it; valid as long as `progress`. */
struct host_observer render_progress_observer(struct render_progress *progress);
/* Ends the updating line. */
void render_progress_end(struct render_progress *progress);
double render_wall_s(const struct render_progress *progress);

void render_summary_print(FILE *stream, const struct render_options *options,
                          const struct host_report *report, double wall_s);
/* Writes options->json; the file appears whole. */
bool render_json_write(const struct render_options *options, const struct host_report *report,
                       double wall_s, struct status *status);

#endif
