/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image_compare.h"
#include "nodes/programs/budget.h"
#include "nodes/programs/host_run.h"
#include "nodes/programs/local_cluster.h"
#include "nodes/programs/machine_command.h"
#include "nodes/programs/predict_command.h"
#include "nodes/programs/scale.h"
#include "nodes/programs/shader_command.h"
#include "nodes/programs/trace_command.h"
#include "nodes/programs/tradeoff.h"

#include <stdio.h>
#include <string.h>

static int render_main(int argc, char **argv) {
    struct render_options options;
    const int end = render_options_parse(argc, argv, false, &options);
    int result = end - 1;
    if (!end)
        result = options.driver == DRIVER_IN_PROCESS ? host_run(&options)
                                                     : local_cluster_run(argc, argv, &options);
    render_options_finish(&options);
    return result;
}

/* Verbs of the command: X(name, function, what it does) */
#define VERBS(X)                                                                                   \
    X("render", render_main, "render a scene on a local cluster")                                  \
    X("shader", shader_main, "say what a shader costs, or shade a grid with it")                   \
    X("compare", image_compare_main, "say how far two pictures are apart")                         \
    X("budget", budget_main, "say what samples and regions may cost, and what would help")         \
    X("predict", predict_main, "say what a recorded run would take on other clusters")             \
    X("tradeoff", tradeoff_main, "say what speed costs in accuracy, and draw the frontier")        \
    X("scale", scale_main, "say how frames get faster with more nodes, predicted and run")         \
    X("trace", trace_main, "draw the timeline of nodes and networks")                              \
    X("machine", machine_main, "show, list or check machine descriptions")

static void print_help(FILE *stream) {
    fprintf(
        stream,
        "usage: sortlast VERB [options]\n\n"
        "Simulates a sort-last, deferred-shading rendering cluster of the PixelFlow class.\n\n");
#define VERB_HELP(name, function, what) fprintf(stream, "  %-10s %s\n", name, what);
    VERBS(VERB_HELP)
#undef VERB_HELP
    fprintf(stream, "\n`sortlast VERB --help` tells all about a verb.\n");
}

int main(int argc, char **argv) {
    if (argc < 2) {
        print_help(stderr);
        return 1;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help")) {
        print_help(stdout);
        return 0;
    }
    if (!strcmp(argv[1], "--version")) {
        puts("sortlast " SORTLAST_VERSION);
        return 0;
    }
#define VERB_CALL(name, function, what)                                                            \
    if (!strcmp(argv[1], name))                                                                    \
        return function(argc - 1, argv + 1);
    VERBS(VERB_CALL)
#undef VERB_CALL
    fprintf(stderr, "sortlast: unknown verb \"%s\"\n", argv[1]);
    print_help(stderr);
    return 1;
}
