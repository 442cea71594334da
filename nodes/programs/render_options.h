/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RENDER_OPTIONS_H
#define RENDER_OPTIONS_H

#include "nodes/host_node.h"

#include <sys/types.h>

/* The options of `sortlast render` and of `sortlast-host`, which takes them over from it. */

enum render_driver { DRIVER_PROCESSES, DRIVER_IN_PROCESS };
enum render_transport { TRANSPORT_IPC, TRANSPORT_TCP };

struct render_options {
    struct host_options host;
    enum render_driver driver;
    enum render_transport transport;
    uint64_t schedule_seed; /* of the in-process driver */
    const char *json;       /* file, "-" for standard output, NULL: none */
    bool is_shaped;         /* with pace: the network below throttles the composition link */
    double pace;            /* 0: as fast as this machine can */
    const char *record;     /* file for the record of the run, NULL: none */
    bool by_cost;           /* regions to shading nodes */
    const char *costs_from; /* the record that says what they cost */
    struct run_record *costs;
    const char *link; /* object with extern "C" functions of shaders, NULL: none */
    bool explain_time;
    int deadline_s;
    int verbosity;    /* -1 quiet, 0, 1 verbose */
    const char *bind; /* sortlast-host: where to listen */
    int board;        /* descriptor of a status board, -1: none */
    pid_t supervisor; /* started this process and reports lost nodes; 0: none */
    char machine_file[4096];
    char *folders[32];
    const char *shader_files[64]; /* --use */
};

/* Parses and checks everything, reads the machine description. `is_host_program` adds its own
 * options and makes
 * --bind required. Returns 0 to go on, else the exit status plus 1 to end with (--help printed, or
 * a message on standard error). */
int render_options_parse(int argc, char **argv, bool is_host_program,
                         struct render_options *options);
void render_options_finish(struct render_options *options);

/* The text of --help (render_help.c). */
void render_help_print(bool is_host_program);
/* How many values a long option of `sortlast render` takes, -1 when it has none of that name. */
int render_option_values(const char *name);

/* The file of a machine description: `name` itself when it looks like a path, else NAME.json among
 * those that come with the program. */
bool machine_find_file(const char *name, char *path, size_t size, struct status *status);

/* The folder of the running program. */
bool program_folder(char *path, size_t size);

#endif
