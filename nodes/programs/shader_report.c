/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/shader_command.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { CHART_COLUMNS = 64, LINES_SHOWN = 8, LIFETIMES_SHOWN = 40 };

ticks shader_report_price(const struct machine *machine, const uint64_t *operations, bool fast) {
    ticks total = 0;
    for (int o = 0; o < SIMD_OPERATION_COUNT; o++) {
        const int priced = fast ? simd_operation_fast(o) : o;
        total = ticks_add(total,
                          operations[o] > INT64_MAX
                              ? TICKS_MAX
                              : ticks_multiply(machine->operation[priced], (int64_t)operations[o]));
    }
    return total;
}

ticks shader_report_time(const struct shader_report *report, bool fast) {
    ticks total = 0;
    for (int s = 0; s < SHADER_STREAM_COUNT; s++)
        total = ticks_add(total,
                          shader_report_price(report->machine, report->counts.operations[s], fast));
    return total;
}

const char *shader_stream_name(int stream) {
    static const char *const names[SHADER_STREAM_COUNT] = {"pre-illum", "illum", "post-illum",
                                                           "light", "shared"};
    return names[stream];
}

void shader_parameter_type(const struct shader_parameter *parameter, char text[64]) {
    char name[32];
    snprintf(text, 48, "%s",
             parameter->type == SHADER_FIXED ? fixed_format_name(parameter->format, name)
                                             : shader_type_name(parameter->type));
    if (parameter->array_length)
        snprintf(text + strlen(text), 16, "[%d]", parameter->array_length);
}

const char *shader_parameter_storage(const struct shader_parameter *parameter) {
    return parameter->is_material ? "varying" : parameter->is_varying ? "bound" : "uniform";
}

static double microseconds(const struct shader_report *report, ticks time) {
    return (double)ticks_to_ps(report->machine->rate, time) / 1e6;
}

static void print_parameters(FILE *stream, const struct shader_program *program) {
    fprintf(stream, "Parameters\n  %-18s %-24s %-8s %6s  %s\n", "name", "type", "storage", "bytes",
            "where");
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *p = &program->parameters[i];
        char type[64], where[64];
        shader_parameter_type(p, type);
        if (!p->is_live)
            snprintf(where, sizeof where, "dead: costs nothing");
        else if (p->is_material)
            snprintf(where, sizeof where, "transfer map, byte %d", p->map_byte);
        else
            snprintf(where, sizeof where, "geometry network, once a frame");
        fprintf(stream, "  %-18s %-24s %-8s %6d  %s\n", p->name, type, shader_parameter_storage(p),
                p->bytes, where);
    }
}

/* A letter for each byte: the parameter it belongs to. */
static void print_map(FILE *stream, const struct shader_report *report) {
    const struct shader_program *program = report->program;
    const int bytes = SHADER_ID_BYTES + program->material_bytes;
    const int64_t payload =
        report->machine->composition_word_bytes - report->machine->composition_depth_bytes;
    fprintf(stream, "\nTransfer map: %d bytes, %" PRId64 " of %" PRId64 " payload bytes a word\n",
            bytes, machine_map_words(report->machine, program->material_bytes), payload);
    char *map = memory_get((size_t)bytes + 1, 1);
    memset(map, '#', SHADER_ID_BYTES);
    char letter = 'a';
    fprintf(stream, "  %c %4d  %-18s %4d\n", '#', 0, "shader ID", SHADER_ID_BYTES);
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *p = &program->parameters[i];
        if (!p->is_material)
            continue;
        memset(map + p->map_byte, letter, (size_t)p->bytes);
        fprintf(stream, "  %c %4d  %-18s %4d\n", letter, p->map_byte, p->name, p->bytes);
        letter = letter == 'z' ? 'A' : letter == 'Z' ? 'a' : (char)(letter + 1);
    }
    for (int at = 0; at < bytes; at += (int)payload)
        fprintf(stream, "  |%-*.*s|\n", (int)payload, (int)payload, map + at);
    free(map);
}

struct paper_figures {
    const char *name;
    int64_t time_ps;
    int total, varying, allocated;
};

static const struct paper_figures *paper_figures(const char *name) {
    static const struct paper_figures figures[] = {
#define PAPER_ENTRY(name, time, total, varying, allocated) {name, time, total, varying, allocated},
        SHADER_PAPER_FIGURES(PAPER_ENTRY)
#undef PAPER_ENTRY
    };
    for (size_t i = 0; i < sizeof figures / sizeof *figures; i++)
        if (!strcmp(figures[i].name, name))
            return &figures[i];
    return NULL;
}

static void print_size(FILE *stream, const char *what, int bytes, int paper) {
    fprintf(stream, "  %-44s %6d", what, bytes);
    if (paper)
        fprintf(stream, "  (paper: %d)", paper);
    fputc('\n', stream);
}

static void print_memory(FILE *stream, const struct shader_program *program) {
    const struct shader_memory *m = &program->memory;
    const struct paper_figures *paper = paper_figures(program->name);
    fprintf(stream, "\nPixel memory, bytes\n");
    print_size(stream, "variables, uniform and varying", m->total, paper ? paper->total : 0);
    print_size(stream, "varying ones", m->varying, paper ? paper->varying : 0);
    print_size(stream, "allocated by lifetime", m->allocated, paper ? paper->allocated : 0);
    print_size(stream, "transfer map", m->parameters, 0);
    print_size(stream, "position", m->position, 0);
    print_size(stream, "communication with lights and shared code", m->communication, 0);
    fprintf(stream, "  %-44s %6d  of %d\n", m->free < 0 ? "too many" : "free",
            m->free < 0 ? -m->free : m->free, m->available);
    if (m->illum_end >= m->illum_begin)
        print_size(stream, "kept while lights run (high-water mark)", m->retained, 0);
    if (m->spilled)
        print_size(stream, "spilled to texture memory", m->spilled, 0);
}

static int column_of(const struct shader_memory *m, int instruction) {
    const int last = m->instructions > 0 ? m->instructions : 1;
    const int column = (int)((int64_t)instruction * CHART_COLUMNS / (last + 1));
    return column < CHART_COLUMNS ? column : CHART_COLUMNS - 1;
}

/* Time to the right, a row for each variable, = while it holds its place. */
static void print_lifetimes(FILE *stream, const struct shader_memory *m) {
    if (!m->lifetime_count)
        return;
    fprintf(stream, "\nLifetimes over %d instructions", m->instructions);
    if (m->illum_end >= m->illum_begin)
        fprintf(stream, " (| encloses illum)");
    fprintf(stream, "\n  %-18s %4s %5s %5s\n", "variable", "line", "bytes", "at");
    for (int i = 0; i < m->lifetime_count && i < LIFETIMES_SHOWN; i++) {
        const struct shader_lifetime *life = &m->lifetimes[i];
        char chart[CHART_COLUMNS + 1];
        memset(chart, ' ', CHART_COLUMNS);
        chart[CHART_COLUMNS] = 0;
        if (m->illum_end >= m->illum_begin)
            chart[column_of(m, m->illum_begin)] = chart[column_of(m, m->illum_end)] = '|';
        const int first = column_of(m, life->first), last = column_of(m, life->last);
        memset(chart + first, life->address < 0 ? '.' : '=', (size_t)(last - first + 1));
        char place[16] = "tex";
        if (life->address >= 0)
            snprintf(place, sizeof place, "%d", life->address);
        fprintf(stream, "  %-18.18s %4d %5d %5s %s\n", life->name[0] ? life->name : "(temporary)",
                life->line, life->bytes, place, chart);
    }
    if (m->lifetime_count > LIFETIMES_SHOWN)
        fprintf(stream, "  ... and %d more (--svg draws all)\n",
                m->lifetime_count - LIFETIMES_SHOWN);
}

static void print_times(FILE *stream, const struct shader_report *report) {
    const struct paper_figures *paper = paper_figures(report->program->name);
    bool is_chosen = false;
    for (int i = 0; i < report->program->call_site_count; i++)
        is_chosen |= report->program->call_sites[i].is_fast;
    fprintf(stream, "\nTime per region, us %27s %10s\n", is_chosen ? "as chosen" : "exact", "fast");
    for (int s = 0; s < SHADER_STREAM_COUNT; s++) {
        const uint64_t *operations = report->counts.operations[s];
        const ticks exact = shader_report_price(report->machine, operations, false);
        if (exact)
            fprintf(stream, "  %-34s %10.2f %10.2f\n", shader_stream_name(s),
                    microseconds(report, exact),
                    microseconds(report, shader_report_price(report->machine, operations, true)));
    }
    fprintf(stream, "  %-34s %10.2f %10.2f", "all of the shader",
            microseconds(report, shader_report_time(report, false)),
            microseconds(report, shader_report_time(report, true)));
    if (paper && paper->time_ps)
        fprintf(stream, "  (paper: %.2f)", (double)paper->time_ps / 1e6);
    fprintf(
        stream, "\n  %-34s %10.2f %10.2f\n", "its lights, once for all shaders",
        microseconds(report, shader_report_price(report->machine, report->counts.lights, false)),
        microseconds(report, shader_report_price(report->machine, report->counts.lights, true)));
}

struct ranked {
    int number; /* operation or line */
    ticks time;
    uint64_t count;
};

static int compare_ranked(const void *a, const void *b) {
    const struct ranked *x = a, *y = b;
    return x->time != y->time ? (x->time < y->time) - (x->time > y->time)
                              : (x->number > y->number) - (x->number < y->number);
}

static void print_operations(FILE *stream, const struct shader_report *report) {
    static const char *const names[] = {
#define OPERATION_NAME(name, key, what) what,
        SIMD_OPERATIONS(OPERATION_NAME)
#undef OPERATION_NAME
    };
    struct ranked ranked[SIMD_OPERATION_COUNT] = {{0}};
    const ticks all = shader_report_time(report, false);
    for (int o = 0; o < SIMD_OPERATION_COUNT; o++) {
        ranked[o].number = o;
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            ranked[o].count += report->counts.operations[s][o];
        ranked[o].time = ticks_multiply(report->machine->operation[o], (int64_t)ranked[o].count);
    }
    qsort(ranked, SIMD_OPERATION_COUNT, sizeof *ranked, compare_ranked);
    fprintf(stream, "\nOperations %34s %10s %7s\n", "issued", "us", "share");
    for (int i = 0; i < SIMD_OPERATION_COUNT && ranked[i].count; i++)
        fprintf(stream, "  %-34.34s %8" PRIu64 " %10.2f %5.1f %%\n", names[ranked[i].number],
                ranked[i].count, microseconds(report, ranked[i].time),
                all ? 100.0 * (double)ranked[i].time / (double)all : 0);
}

/* Line `number` of the text, without its end. */
static const char *line_text(const char *text, int number, int *length) {
    for (int line = 1; line < number && *text; text++)
        line += *text == '\n';
    *length = (int)strcspn(text, "\n");
    return text;
}

static void print_lines(FILE *stream, const struct shader_report *report, const char *source) {
    const struct shader_program *program = report->program;
    int last = 0;
    for (int i = 0; i < program->line_cost_count; i++)
        last = program->line_costs[i].line > last ? program->line_costs[i].line : last;
    struct ranked *lines = memory_get((size_t)last + 1, sizeof *lines);
    for (int i = 0; i < program->line_cost_count; i++) {
        const struct shader_line_cost *cost = &program->line_costs[i];
        const uint64_t executions = report->counts.block_executions[cost->block];
        lines[cost->line].number = cost->line;
        lines[cost->line].time = ticks_add(
            lines[cost->line].time, ticks_multiply(report->machine->operation[cost->operation],
                                                   (int64_t)(executions * cost->count)));
    }
    qsort(lines, (size_t)last + 1, sizeof *lines, compare_ranked);
    fprintf(stream, "\nLines that cost most %24s\n", "us");
    for (int i = 0; i <= last && i < LINES_SHOWN && lines[i].time; i++) {
        int length;
        const char *text = line_text(source, lines[i].number, &length);
        fprintf(stream, "  %4d %38.2f  %.*s\n", lines[i].number,
                microseconds(report, lines[i].time), length > 80 ? 80 : length, text);
    }
    free(lines);
}

void shader_report_print(FILE *stream, const struct shader_report *report, const char *source) {
    const struct shader_program *program = report->program;
    fprintf(stream, "%s, a %s shader (%s), on %s\n\n", program->name,
            shader_kind_name(program->kind), report->path, report->machine->name);
    print_parameters(stream, program);
    if (program->kind == SHADER_KIND_SURFACE)
        print_map(stream, report);
    print_memory(stream, program);
    print_lifetimes(stream, &program->memory);
    if (!report->is_measured)
        return;
    print_times(stream, report);
    shader_report_print_calls(stream, report);
    if (program->kind == SHADER_KIND_LIGHT)
        return;
    print_operations(stream, report);
    print_lines(stream, report, source);
    if (report->counts.has_overrun)
        fprintf(stream, "\nA loop was stopped after %d turns.\n", SHADER_LOOP_LIMIT);
}
