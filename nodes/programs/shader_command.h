/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_COMMAND_H
#define SHADER_COMMAND_H

#include "netsim/machine.h"
#include "nodes/shader_fix.h"
#include "nodes/shader_study.h"

#include <cjson/cJSON.h>
#include <stdio.h>

/* The verb `sortlast shader`: what one shader costs the hardware, its picture without a cluster. */
int shader_main(int argc, char **argv);

/* A bound of errors, "2/255" or "0.01": above 0 and at most 1. */
bool shader_error_bound(const char *text, double *bound);

/* `sortlast shader --fix` */
struct shader_fix_request {
    struct shader_fix_options fix; /* path and max_error; the rest is filled in */
    struct host_options rendering; /* scene, frames, folders and machine */
    const char *output, *json;     /* files, "-" is standard output; json NULL: none */
};
bool shader_fix_command(struct shader_fix_request *request, struct status *status);

/* What the paper says of a shader of this name (PF tables 1 and 4); 0 where it says nothing.
 * X(name, table 1: ps per region, table 4: total, varying, allocated) */
#define SHADER_PAPER_FIGURES(X)                                                                    \
    X("simple_brick", 0, 171, 97, 16)                                                              \
    X("fancy_brick", 613150000, 239, 175, 101)                                                     \
    X("ripple_reflection", 1058070000, 341, 193, 137)                                              \
    X("planks", 532300000, 216, 152, 97)                                                           \
    X("bowling_pin", 401960000, 0, 0, 0)

/* A shader after its run over one region. */
struct shader_report {
    const char *path;
    const struct shader_program *program;
    const struct machine *machine;
    struct shader_study_counts counts;
    const char **warnings;
    int warning_count;
    bool is_measured; /* it was run: counts are there */
};

/* Price of operations, in ticks of the machine; `fast`: with the fast versions of functions. */
ticks shader_report_price(const struct machine *machine, const uint64_t *operations, bool fast);
/* All streams of the shader, its shared one included; lights aside. */
ticks shader_report_time(const struct shader_report *report, bool fast);
const char *shader_stream_name(int stream);
/* "unsigned fixed<16,8>[3]" */
void shader_parameter_type(const struct shader_parameter *parameter, char text[64]);
/* "uniform", "bound" (varying, bound to the instance) or "varying" */
const char *shader_parameter_storage(const struct shader_parameter *parameter);

void shader_report_print(FILE *stream, const struct shader_report *report, const char *source);
cJSON *shader_report_json(const struct shader_report *report);
/* Calls of functions with a fast version; shader_report_calls.c */
void shader_report_print_calls(FILE *stream, const struct shader_report *report);
cJSON *shader_report_calls_json(const struct shader_report *report);
/* The lifetime chart as SVG: the caller frees it. */
char *shader_report_svg(const struct shader_report *report);
/* What each optimisation saved; compiles the shader again without it. */
bool shader_explain_print(FILE *stream, const struct shader_study_options *options,
                          const struct shader_report *report, struct status *status);

#endif
