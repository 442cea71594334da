/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/trace_command.h"

#include "nodes/programs/analysis_options.h"
#include "nodes/programs/explain_report.h"
#include "nodes/programs/json_output.h"
#include "nodes/programs/predict_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_svg(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && !strcmp(dot, ".svg");
}

static bool draw(const struct analysis_options *options, const struct trace_view *view,
                 struct status *status) {
    char *text = is_svg(options->output) ? trace_svg(view) : trace_events(view);
    if (!text)
        return status_fail(status, STATUS_LIMIT, "no memory for the timeline");
    const bool ok = text_write_file(options->output, text, "the timeline", status);
    free(text);
    if (ok && !options->is_quiet && strcmp(options->output, "-")) {
        size_t count;
        timeline_activities(view->timeline, &count);
        printf("%s: %zu activities of %u frame%s, %.3f ms a frame\n", options->output, count,
               view->record->frame_count, view->record->frame_count == 1 ? "" : "s",
               (double)view->time_ps * 1e-9);
    }
    return ok;
}

static bool trace_run(const struct analysis_options *options, const struct run_record *record,
                      struct status *status) {
    struct what_if question;
    struct what_if_result result;
    if (!options->output)
        return status_fail(status, STATUS_INVALID,
                           "-o is missing: a file ending in .json (Trace Event) or .svg (chart)");
    if (!analysis_question(options, record, 0, &question, status))
        return false;
    struct what_if_solver *solver = what_if_solver_create(record);
    struct timeline *timeline =
        timeline_create(&question.machine, question.rendering_nodes, question.shading_nodes);
    bool ok = what_if_solve(solver, &question, timeline, &result, status);
    if (ok) {
        const struct trace_view view = {record, &question, timeline,
                                        predict_frame_ps(&question, &result)};
        ok = draw(options, &view, status);
    }
    timeline_destroy(timeline);
    what_if_solver_destroy(solver);
    return ok;
}

const char *trace_resource_name(const struct trace_view *view, uint32_t resource, char text[40]) {
    const struct explanation explanation = {view->timeline, view->question->machine.rate,
                                            view->question->rendering_nodes,
                                            view->question->shading_nodes};
    return explain_resource_name(&explanation, resource, text);
}

int trace_main(int argc, char **argv) {
    static const struct analysis_verb verb = {
        .name = "trace",
        .usage = "trace -o FILE.json|FILE.svg [options] RECORD|SCENE.rib",
        .about = "Draws the timeline of nodes, networks and buffers: as a Trace Event file that "
                 "Perfetto\n(ui.perfetto.dev) and chrome://tracing open, or as a Gantt chart.",
        .more_options = "  -o, --output FILE          .json: Trace Event; .svg: chart; - for Trace "
                        "Event on standard output",
        .has_output = true,
        .is_single = true,
    };
    return analysis_main(&verb, argc, argv, trace_run);
}
