/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PREDICT_COMMAND_H
#define PREDICT_COMMAND_H

#include "nodes/programs/analysis_options.h"

#include <cjson/cJSON.h>

/* The verb `sortlast predict`: what a recorded run would take under every combination of the items
 * of a question. Returns the exit status. */
int predict_main(int argc, char **argv);

/* What one machine parameter changed, for --sensitivity: every parameter in turn is raised and
 * lowered by a hundredth (small ones doubled) and the question solved again. Prints the effects by
 * size, then what has none; adds "sensitivity" to `document` when that is not NULL. */
bool sensitivity_report(struct what_if_solver *solver, const struct run_record *record,
                        const struct what_if *question, bool is_quiet, cJSON *document,
                        struct status *status);

/* The average time of a frame, and rates, in picoseconds as everywhere. */
int64_t predict_frame_ps(const struct what_if *question, const struct what_if_result *result);

#endif
