/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/host_run.h"

#include "netsim/what_if.h"
#include "nodes/cluster_in_process.h"
#include "nodes/driver_sockets.h"
#include "nodes/local_services.h"
#include "nodes/programs/explain_report.h"
#include "nodes/programs/program_process.h"
#include "nodes/programs/render_report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static bool run_in_process(struct node *host, const struct render_options *options,
                           struct local_services *services, struct trace *trace,
                           struct status *status) {
    const struct driver_options driver = {.seed = options->schedule_seed, .stop = &program_stop};
    return cluster_in_process_run(host, options->host.rendering_nodes, options->host.shading_nodes,
                                  local_services_interface(services), trace, &driver, status);
}

/* When the supervisor itself was killed, nobody else removes the folder of the sockets: as the
 * nodes leave they take their sockets along, and then it can go. */
static void remove_orphaned_folder(const struct render_options *options) {
    enum { TRIES = 100, PAUSE_NS = 20000000 };
    char folder[4096];
    const char *slash = strrchr(options->bind, '/');
    if (!options->supervisor || getppid() == options->supervisor ||
        strncmp(options->bind, "ipc://", 6) || !slash)
        return;
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - options->bind) - 6, options->bind + 6);
    for (int i = 0; i < TRIES && rmdir(folder) && errno == ENOTEMPTY; i++)
        nanosleep(&(struct timespec){0, PAUSE_NS}, NULL);
}

static bool run_by_sockets(struct node *host, const struct render_options *options,
                           int64_t *pace_begin_ns, struct status *status) {
    const struct socket_options sockets = {
        .host = options->bind,
        .rendering_nodes = options->host.rendering_nodes,
        .shading_nodes = options->host.shading_nodes,
        .deadline_s = options->deadline_s,
        .board = options->board >= 0 ? status_board_open(options->board, 0) : NULL,
        .stop = &program_stop,
        .describe = &program_describe,
        .pace = options->pace,
        .is_shaped = options->is_shaped,
        .pace_begin_ns = pace_begin_ns,
        .supervisor = options->supervisor,
    };
    const bool ok = driver_sockets_run(host, &sockets, status);
    remove_orphaned_folder(options);
    return ok;
}

/* What a run shows while it goes, and what is measured of it. */
struct run_view {
    const struct render_options *options;
    struct render_progress progress;
    struct pace_report pace;
};

/* The run solved once more from its record, with reasons; the timeline is the caller's. */
static struct timeline *solve_again(const struct render_options *options,
                                    const struct run_record *record, struct status *status) {
    struct what_if question = what_if_default(record);
    struct what_if_result result;
    question.strategy = options->host.strategy;
    question.assignment = options->by_cost ? WHAT_IF_BY_COST : WHAT_IF_ROUND_ROBIN;
    question.costs = options->costs;
    question.rendering_nodes = options->host.rendering_nodes;
    question.shading_nodes = options->host.shading_nodes;
    struct timeline *timeline =
        timeline_create(&question.machine, question.rendering_nodes, question.shading_nodes);
    struct what_if_solver *solver = what_if_solver_create(record);
    const bool ok = what_if_solve(solver, &question, timeline, &result, status);
    what_if_solver_destroy(solver);
    if (ok)
        return timeline;
    timeline_destroy(timeline);
    return NULL;
}

static bool report_results(void *context, const struct host_report *report, struct status *status) {
    const struct run_view *view = context;
    const struct render_options *options = view->options;
    const struct pace_report *pace = &view->pace;
    const double wall_s = render_wall_s(&view->progress);
    struct explanation explanation = {NULL, options->host.machine.rate,
                                      options->host.rendering_nodes, options->host.shading_nodes};
    struct timeline *timeline = NULL;
    if (options->explain_time && !(timeline = solve_again(options, report->record, status)))
        return false;
    explanation.timeline = timeline;
    if (options->verbosity >= 0 &&
        !(options->json && options->json[0] == '-' && !options->json[1])) {
        render_summary_print(stdout, options, report, wall_s, pace);
        if (timeline)
            explain_print(stdout, &explanation);
    }
    bool ok = (!fflush(stdout) && !ferror(stdout)) ||
              status_fail(status, STATUS_IO, "cannot write the summary to standard output");
    ok = ok && (!options->record || render_record_write(options->record, report->record, status)) &&
         (!options->json ||
          render_json_write(options, report, wall_s, pace, timeline ? &explanation : NULL, status));
    timeline_destroy(timeline);
    return ok;
}

static int run(struct run_view *view,
               bool (*then)(void *, const struct host_report *, struct status *), void *context) {
    const struct render_options *options = view->options;
    struct status status = {0};
    struct trace trace;
    struct node *host = NULL;
    view->pace = (struct pace_report){.scale = options->pace, .begin_ns = INT64_MIN};
    program_streams_ensure();
    program_signals_install();
    program_files_raise();
    program_memory_keep();
    trace_init(&trace, options->driver == DRIVER_IN_PROCESS ? "cluster" : "host",
               options->verbosity > 0 ? stderr : NULL);
    struct local_services *services = local_services_create(&trace, &program_stop);
    local_services_set_link(services, options->link);
    render_progress_begin(&view->progress, options);
    const struct host_observer observer = render_progress_observer(&view->progress);
    bool ok = host_node_create(&options->host, &observer, local_services_build_shaders, services,
                               &trace, &host, &status);
    if (ok)
        ok = options->driver == DRIVER_IN_PROCESS
                 ? run_in_process(host, options, services, &trace, &status)
                 : run_by_sockets(host, options, &view->pace.begin_ns, &status);
    render_progress_end(&view->progress);
    view->pace.frame_done_ns = view->progress.frame_done_ns;
    ok = ok && then(context, host_node_report(host), &status);
    render_progress_finish(&view->progress);
    if (!ok && !(status.code == STATUS_LOST && options->supervisor) && status.code != STATUS_OK)
        fprintf(stderr, "sortlast: %s\n", status.message);
    node_destroy(host);
    local_services_destroy(services);
    return ok                         ? 0
           : status.code == STATUS_OK ? 128 + (int)program_stop
                                      : status_exit_code(status.code);
}

int host_run(const struct render_options *options) {
    struct run_view view = {.options = options};
    return run(&view, report_results, &view);
}

int host_run_then(const struct render_options *options,
                  bool (*then)(void *context, const struct host_report *report,
                               struct status *status),
                  void *context) {
    struct run_view view = {.options = options};
    return run(&view, then, context);
}
