/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RENDER_REPORT_H
#define RENDER_REPORT_H

#include "nodes/programs/explain_report.h"
#include "nodes/programs/render_options.h"

#include <stdio.h>

/* What a run has to say: progress while it goes, then the summary for a person and the same as
 * JSON. */

struct render_progress {
    FILE *stream;
    bool is_terminal, is_quiet, is_verbose, has_line;
    double begin_s;
    int64_t *frame_done_ns; /* on CLOCK_MONOTONIC, one a frame */
    size_t frame_count, frame_capacity;
};

/* Wall times of a paced run. */
struct pace_report {
    double scale; /* 0: not paced */
    int64_t begin_ns;
    const int64_t *frame_done_ns; /* one for each frame of the report */
};
/* Wall time of frame `index`, in nanoseconds: since the frame before was done, for the first since
 * the first byte was sent. */
int64_t pace_frame_ns(const struct pace_report *pace, size_t index);

void render_progress_begin(struct render_progress *progress, const struct render_options *options);
/* The observer that feeds it; valid as long as `progress`. */
struct host_observer render_progress_observer(struct render_progress *progress);
/* Ends the updating line. */
void render_progress_end(struct render_progress *progress);
void render_progress_finish(struct render_progress *progress);
double render_wall_s(const struct render_progress *progress);

void render_summary_print(FILE *stream, const struct render_options *options,
                          const struct host_report *report, double wall_s,
                          const struct pace_report *pace);
/* What was done for the frame, for whom, and what was skipped and why (a record that was kept). */
void render_work_print(FILE *stream, const struct frame_record *record);
/* How many different shaders ran: those, and only those, are loaded. */
uint32_t render_modules_loaded(const struct work_record *work);
struct cJSON *render_work_json(const struct work_record *work);
/* Writes options->json; the file appears whole. `explanation` of the times, or NULL. */
bool render_json_write(const struct render_options *options, const struct host_report *report,
                       double wall_s, const struct pace_report *pace,
                       const struct explanation *explanation, struct status *status);
/* Writes the record of a run; the file appears whole. */
bool render_record_write(const char *path, const struct run_record *record, struct status *status);

#endif
