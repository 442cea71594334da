/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/shader_command.h"

#include <string.h>

/* What each optimisation of the paper is worth for one shader: bytes of the transfer map, bytes of
 * pixel memory, time of a region. */

enum { POSITION_BYTES = 12, STANDARD_BYTES = 88 }; /* N Ng dPdu dPdv Cs Os: 12; s t u v: 4 */

static void print_row(FILE *stream, const char *what, int with, int without) {
    fprintf(stream, "  %-52s %6d against %6d\n", what, with, without);
}

static void explain_map(FILE *stream, const struct shader_program *program) {
    int own = SHADER_ID_BYTES + program->material_bytes, bound = 0, all = 0;
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *p = &program->parameters[i];
        const bool is_string = p->type == SHADER_STRING;
        bound += !is_string && p->is_live && !p->is_material ? p->bytes : 0;
        all += !is_string && !p->is_global ? p->bytes : 0;
    }
    fprintf(stream, "\nTransfer map, bytes a sample\n");
    print_row(stream, "a map for this shader, against all it could be given", own,
              SHADER_ID_BYTES + STANDARD_BYTES + all);
    print_row(stream, "bound parameters, against all with the samples", own, own + bound);
    print_row(stream, "position rebuilt from depth, against sent", own, own + POSITION_BYTES);
}

static int float_bytes(const struct shader_program *program) {
    int bytes = 0;
    for (int i = 0; i < program->memory.lifetime_count; i++)
        bytes += program->memory.lifetimes[i].bytes < 4 ? 4 : program->memory.lifetimes[i].bytes;
    return bytes;
}

static void explain_memory(FILE *stream, const struct shader_program *program) {
    const struct shader_memory *m = &program->memory;
    int own = 0;
    for (int i = 0; i < m->lifetime_count; i++)
        own += m->lifetimes[i].bytes;
    fprintf(stream, "\nPixel memory, bytes\n");
    print_row(stream, "uniform variables on the processor", m->varying, m->total);
    print_row(stream, "places shared by lifetime, against one each", m->allocated, own);
    print_row(stream, "sizes as they are, against 4 bytes at least", own, float_bytes(program));
}

static bool explain_pass(FILE *stream, const struct shader_study_options *options,
                         const struct shader_report *report, int pass, const char *what,
                         struct status *status) {
    struct shader_study_options without = *options;
    without.compile.passes_left_out |= 1u << pass;
    struct shader_study *study;
    if (!shader_study_create(&without, &study, status))
        return false;
    struct shader_report other = *report;
    other.program = shader_study_program(study);
    const bool ok = shader_study_run(study, (uint32_t)report->machine->region_width,
                                     (uint32_t)report->machine->region_height, NULL, status);
    if (ok) {
        shader_study_count(study, &other.counts);
        const double us = 1e-6;
        fprintf(stream, "  %-52s %8.2f against %8.2f us, %4d against %4d bytes\n", what,
                us * (double)ticks_to_ps(report->machine->rate, shader_report_time(report, false)),
                us * (double)ticks_to_ps(report->machine->rate, shader_report_time(&other, false)),
                report->program->memory.allocated, other.program->memory.allocated);
    }
    shader_study_destroy(study);
    return ok;
}

bool shader_explain_print(FILE *stream, const struct shader_study_options *options,
                          const struct shader_report *report, struct status *status) {
    if (report->program->kind == SHADER_KIND_SURFACE)
        explain_map(stream, report->program);
    explain_memory(stream, report->program);
    if (!report->is_measured)
        return true;
    fprintf(stream, "\nTime per region and pixel memory allocated, with and without a pass\n");
    const char *what;
    bool is_optional;
    for (int i = 0; shader_pass_name(i, &what, &is_optional); i++)
        if (is_optional && !explain_pass(stream, options, report, i, what, status))
            return false;
    return true;
}
