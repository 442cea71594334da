/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/shader_compile.h"

#include "shaders/compiler/call_sites.h"
#include "shaders/compiler/passes.h"

#include <stdlib.h>
#include <string.h>

/* 256 MiB in all: syntax tree and IR, then what the caller keeps. */
enum { WORK_BYTES_MAX = 176 << 20, PROGRAM_BYTES_MAX = 80 << 20 };

int shader_type_components(enum shader_type type) {
    return type == SHADER_FLOAT || type == SHADER_STRING || type == SHADER_FIXED ? 1
           : type == SHADER_MATRIX                                               ? 16
                                                                                 : 3;
}

const char *shader_type_name(enum shader_type type) {
    static const char *const names[] = {"float",  "color",  "point", "vector",
                                        "normal", "string", "matrix"};
    return type == SHADER_FIXED ? "fixed" : names[type];
}

const char *shader_kind_name(enum shader_kind kind) {
    static const char *const names[SHADER_KIND_COUNT] = {"surface", "light", "displacement",
                                                         "volume", "imager"};
    return names[kind];
}

static void stop_on_errors(struct compilation *c) {
    if (c->error_count)
        compilation_stop(c);
}

/* Predefined variables that the shader never mentions leave the table. */
static void finish_program(struct compilation *c, const struct ir_program *ir) {
    struct shader_program *program = c->program;
    int kept = 0;
    for (int i = 0; i < program->parameter_count; i++)
        if (!program->parameters[i].is_global || program->parameters[i].line)
            program->parameters[kept++] = program->parameters[i];
    program->parameter_count = kept;
    program->kind = ir->kind;
    program->is_ambient = ir->is_ambient;
    program->spaces = ir->spaces;
    program->uses_any_space = ir->uses_any_space;
    program->named_spaces = arena_get(&program->arena, (size_t)(ir->named_space_count + 1) *
                                                           sizeof *program->named_spaces);
    for (int i = 0; i < ir->named_space_count && program->named_spaces; i++)
        if (ir->named_spaces[i].is_used)
            program->named_spaces[program->named_space_count++] = arena_copy_string(
                &program->arena, ir->named_spaces[i].name, strlen(ir->named_spaces[i].name));
    program->uses_texts = ir->uses_texts;
    program->query_count = ir->query_count;
    program->queries =
        arena_get(&program->arena, (size_t)ir->query_count * sizeof *program->queries);
    for (int i = 0; i < ir->query_count && program->queries; i++)
        program->queries[i] =
            arena_copy_string(&program->arena, ir->queries[i].name, strlen(ir->queries[i].name));
    program->c_source = arena_copy_string(&program->arena, c->output, c->output_length);
    program->c_length = c->output_length;
    program->warnings =
        arena_get(&program->arena, (size_t)c->warning_count * sizeof *program->warnings);
    program->warning_count = c->warning_count;
    if (!program->c_source || !program->warnings || !program->queries || !program->named_spaces)
        compile_limit(c, NULL, "the shader needs more memory than the compiler may use");
    program->line_costs =
        arena_get(&program->arena, (ir->line_cost_count + 1) * sizeof *program->line_costs);
    if (!program->line_costs)
        compile_limit(c, NULL, "the shader needs more memory than the compiler may use");
    if (ir->line_cost_count)
        memcpy((void *)program->line_costs, ir->line_costs,
               ir->line_cost_count * sizeof *ir->line_costs);
    program->line_cost_count = (int)ir->line_cost_count;
    call_sites_report(ir);
    if (c->warning_count)
        memcpy(program->warnings, c->warnings,
               (size_t)c->warning_count * sizeof *program->warnings);
}

static const char *find_category(struct compilation *c, const struct ast_function *shader) {
    for (const struct ast_symbol *s = shader->formals; s; s = s->next)
        if (!strcmp(s->name, "__category") && s->initial && s->initial->kind == EXPRESSION_STRING)
            return arena_copy_string(&c->program->arena, s->initial->name,
                                     strlen(s->initial->name));
    return "";
}

static struct checked_unit read_shader(struct compilation *c, const char *file, const char *text,
                                       size_t length) {
    struct checked_unit checked;
    checked.prelude =
        parse_unit(c, "(standard functions)", prelude_text, strlen(prelude_text), true);
    checked.unit = parse_unit(c, file, text, length, false);
    if (!checked.unit->shader)
        compilation_stop(c);
    checked.symbols = check_unit(c, checked.unit, checked.prelude);
    stop_on_errors(c);
    return checked;
}

/* A shader that runs before or after the main one. */
static void read_companion(struct compilation *c, const struct shader_companion *source,
                           enum shader_kind kind, struct checked_unit *units, int *count) {
    if (!source)
        return;
    if (source->length > SOURCE_BYTES_MAX)
        compile_limit(c, NULL, "%.200s: a shader is at most %d bytes long", source->file,
                      SOURCE_BYTES_MAX);
    char *text = compilation_copy(c, source->text, source->length);
    char *file = compilation_copy(c, source->file, strlen(source->file));
    units[*count] = read_shader(c, file, text, source->length);
    const struct ast_unit *unit = units[*count].unit;
    if (unit->kind != kind)
        compile_error(c, &unit->shader->at, "%.64s is a %s shader, and is used as %s shader",
                      unit->shader->name, shader_kind_name(unit->kind), shader_kind_name(kind));
    stop_on_errors(c);
    ++*count;
}

static const struct pass {
    const char *name;
    void (*run)(struct ir_program *ir);
    bool is_optional, is_storage_known;
    const char *what;
} passes[IR_PASS_COUNT] = {
#define IR_PASS_ENTRY(name, function, optional, storage, what)                                     \
    {name, function, optional, storage, what},
    IR_PASSES(IR_PASS_ENTRY)
#undef IR_PASS_ENTRY
};

const char *shader_pass_name(int i, const char **what, bool *is_optional) {
    if (i < 0 || i >= IR_PASS_COUNT)
        return NULL;
    *what = passes[i].what;
    *is_optional = passes[i].is_optional;
    return passes[i].name;
}

static void run_pass(struct ir_program *ir, const struct pass *pass, int number) {
    const struct shader_compile_options *options = ir->c->options;
    /* constants are folded in floats, which would be errors in the reference */
    const bool is_left_out = options && pass->is_optional &&
                             (options->passes_left_out >> number & 1 ||
                              (options->reference_math && pass->run == pass_fold_constants));
    if (!is_left_out) {
        pass->run(ir);
        stop_on_errors(ir->c);
        ir_validate(ir, pass->name, pass->is_storage_known);
    }
    if (options && options->dump && !strcmp(options->dump, pass->name))
        ir->c->program->dump = ir_dump(ir);
}

/* The pipeline. */
static void run_passes(struct compilation *c, const char *file, const char *text, size_t length) {
    const struct shader_compile_options *options = c->options;
    struct checked_unit units[3];
    int count = 0, main;
    if (options)
        read_companion(c, options->displacement, SHADER_KIND_DISPLACEMENT, units, &count);
    units[main = count++] = read_shader(c, file, text, length);
    const struct ast_unit *unit = units[main].unit;
    if (options && (options->displacement || options->atmosphere) &&
        unit->kind != SHADER_KIND_SURFACE)
        compile_error(c, &unit->shader->at,
                      "only a surface shader goes with displacement or volume shaders");
    stop_on_errors(c);
    if (options)
        read_companion(c, options->atmosphere, SHADER_KIND_VOLUME, units, &count);
    c->program->name =
        arena_copy_string(&c->program->arena, unit->shader->name, strlen(unit->shader->name));
    c->program->category = find_category(c, unit->shader);
    c->shader_at = &unit->shader->at;
    struct ir_program *ir = lower_units(c, units, count, main);
    stop_on_errors(c);
    ir_validate(ir, "lowering", false);
    for (int i = 0; i < IR_PASS_COUNT; i++)
        run_pass(ir, &passes[i], i);
    finish_program(c, ir);
}

static bool fail(struct compilation *c, struct status *status) {
    status_fail(status, c->code == STATUS_OK ? STATUS_INVALID : c->code, "%s",
                c->message_length ? c->message : "the shader cannot be compiled");
    shader_program_destroy(c->program);
    return false;
}

/* What was written has to compile: its parameters are copied, and may need what was around them. */
static bool check_source(const struct shader_compile_options *options,
                         struct shader_program **program, struct status *status) {
    struct shader_compile_options plain = *options;
    struct shader_program *again;
    struct status failure = {0};
    plain.writes_source = plain.has_probes = false;
    plain.fixings = NULL;
    plain.dump = NULL;
    plain.fast_calls = (struct shader_fast_calls){0}; /* of other lines */
    const char *source = (*program)->source;
    if (shader_compile("(written)", source, strlen(source), &plain, &again, &failure)) {
        shader_program_destroy(again);
        return true;
    }
    status_fail(status, failure.code == STATUS_INTERNAL ? STATUS_INTERNAL : STATUS_INVALID,
                "shader %.64s cannot be written as source with other types; parameters that need "
                "macros or functions of the file cannot be copied:\n%.600s",
                (*program)->name, failure.message);
    shader_program_destroy(*program);
    *program = NULL;
    return false;
}

bool shader_compile(const char *file, const char *text, size_t length,
                    const struct shader_compile_options *options, struct shader_program **program,
                    struct status *status) {
    *program = NULL;
    if (length > SOURCE_BYTES_MAX)
        return status_fail(status, STATUS_LIMIT, "%.200s: error: a shader is at most %d bytes long",
                           file, SOURCE_BYTES_MAX);
    struct compilation *c = memory_get(1, sizeof *c);
    arena_init(&c->arena, WORK_BYTES_MAX);
    c->options = options;
    c->program = memory_get(1, sizeof *c->program);
    arena_init(&c->program->arena, PROGRAM_BYTES_MAX);
    bool is_done = false;
    if (!setjmp(c->stop)) {
        char *copy = compilation_copy(c, text, length);
        char *name = compilation_copy(c, file, strlen(file));
        run_passes(c, name, copy, length);
        *program = c->program;
        is_done = true;
    }
    if (!is_done)
        fail(c, status);
    arena_finish(&c->arena);
    free(c->output);
    const bool is_written = is_done && c->program->source;
    free(c);
    return is_done && (!is_written || check_source(options, program, status));
}

void shader_program_destroy(struct shader_program *program) {
    if (!program)
        return;
    arena_finish(&program->arena);
    free(program);
}
