/* SPDX-License-Identifier: Apache-2.0 */
#include "reference_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum exit_kind { RUNS_ON, BREAKS, CONTINUES, RETURNS };
struct flow {
    enum exit_kind kind;
    int level;
};

static void clear(struct reference *r, const struct ast_symbol *symbol) {
    struct reference_slot *slot = reference_slot(r, symbol);
    int cells = (slot->length ? slot->length : 1) * reference_cell_count(symbol->type);
    memset(slot->cells, 0, (size_t)cells * sizeof *slot->cells);
    slot->identity = shader_string_identity("");
}

static void write_slot(struct reference_slot *slot, const struct reference_value *value) {
    slot->identity = value->identity;
    reference_write(slot->symbol->type, slot->cells, value);
}

static struct flow run_list(struct reference *r, const struct ast_statement *list);

/* All arguments are evaluated before the first is bound; arrays are passed as they are. Output
 * parameters are copied back in their order. `given` stands for the one argument of a function that
 * is called from within. */
struct reference_value reference_call(struct reference *r, const struct ast_function *function,
                                      const struct ast_expression *arguments,
                                      const struct reference_value *given) {
    struct reference_value values[64], outer = r->result;
    struct reference_slot *arrays[64];
    float *elements[64];
    bool in_default = r->in_default;
    int i = 0;
    if (given)
        values[0] = *given;
    for (const struct ast_expression *a = arguments; a; a = a->next, i++) {
        bool is_element = a->kind == EXPRESSION_INDEX;
        arrays[i] = a->array_length ? reference_variable(r, a->symbol) : NULL;
        elements[i] = is_element ? reference_cells(r, a) : NULL;
        if (!arrays[i])
            values[i] =
                is_element ? reference_read(a->type, elements[i]) : reference_evaluate(r, a);
    }
    i = 0;
    for (const struct ast_symbol *formal = function->formals; formal; formal = formal->next, i++) {
        struct reference_slot *slot = reference_slot(r, formal);
        if (formal->array_length) {
            slot->cells = arrays[i]->cells;
            slot->length = arrays[i]->length;
        } else {
            write_slot(slot, &values[i]);
        }
    }
    r->in_default = false;
    r->result = (struct reference_value){.count = reference_width(function->type),
                                         .identity = shader_string_identity(""),
                                         .format = ast_type_format(function->type)};
    run_list(r, function->body);
    struct reference_value result = r->result;
    r->result = outer;
    r->in_default = in_default;
    const struct ast_symbol *formal = function->formals;
    i = 0;
    for (const struct ast_expression *a = arguments; a; a = a->next, formal = formal->next, i++)
        if (formal->is_output && !formal->array_length) {
            struct reference_value value =
                reference_read(formal->type, reference_slot(r, formal)->cells);
            if (elements[i])
                reference_write(a->type, elements[i], &value);
            else
                write_slot(reference_variable(r, a->symbol), &value);
        }
    return result;
}

static void set_elements(struct reference *r, const struct ast_symbol *symbol,
                         struct reference_slot *slot) {
    int element = 0;
    for (const struct ast_expression *e = symbol->elements; e; e = e->next, element++) {
        struct reference_value value = reference_evaluate(r, e);
        reference_write(symbol->type, slot->cells + element * reference_cell_count(symbol->type),
                        &value);
    }
}

static void declare(struct reference *r, const struct ast_symbol *symbol) {
    struct reference_value initial = {.count = 1, .identity = shader_string_identity("")};
    if (symbol->initial && !symbol->array_length)
        initial = reference_evaluate(r, symbol->initial);
    clear(r, symbol);
    struct reference_slot *slot = reference_slot(r, symbol);
    if (!symbol->array_length)
        write_slot(slot, &initial);
    else if (symbol->initial)
        reference_copy_whole(r, symbol->initial, slot);
    set_elements(r, symbol, slot);
}

/* What a loop makes of how its body ended: false when the loop is over, *flow then being how. */
static bool goes_on(struct flow *flow) {
    bool is_here = flow->level <= 1;
    if (flow->kind == RUNS_ON)
        return true;
    if (flow->kind == RETURNS)
        return false;
    if (!is_here) {
        flow->level--;
        return false;
    }
    bool continues = flow->kind == CONTINUES;
    *flow = (struct flow){RUNS_ON, 0};
    return continues;
}

static struct flow run_statement(struct reference *r, const struct ast_statement *s);

static struct flow run_loop(struct reference *r, const struct ast_statement *s) {
    struct flow flow = {RUNS_ON, 0};
    if (s->initial)
        reference_evaluate(r, s->initial);
    while (!s->expression || reference_evaluate(r, s->expression).truth) {
        if (++r->steps > SHADER_LOOP_LIMIT) {
            r->has_overrun = true;
            break;
        }
        flow = run_statement(r, s->body);
        if (!goes_on(&flow))
            break;
        if (s->step)
            reference_evaluate(r, s->step);
    }
    return flow;
}

struct cone {
    float axis[3], cosine;
};

static struct cone evaluate_cone(struct reference *r, const struct ast_expression *axis) {
    struct cone cone;
    struct reference_value direction = reference_evaluate(r, axis);
    float length = sqrtf(reference_dot(direction.part, direction.part));
    for (int i = 0; i < 3; i++)
        cone.axis[i] = direction.part[i] / length;
    cone.cosine = reference_cosine(r, reference_evaluate(r, axis->next).part[0]);
    return cone;
}

static bool is_inside(const struct cone *cone, const float direction[3]) {
    return cone->cosine * sqrtf(reference_dot(direction, direction)) <=
           reference_dot(direction, cone->axis);
}

static struct flow run_illuminance(struct reference *r, const struct ast_statement *s) {
    struct flow flow = {RUNS_ON, 0};
    struct cone cone = {{0}, 0};
    bool has_cone = s->argument_count == 3;
    if (has_cone)
        cone = evaluate_cone(r, s->arguments->next);
    for (int i = 0; i < r->world->light_count; i++) {
        const struct reference_light *light = &r->world->lights[i];
        float towards[3];
        for (int c = 0; c < 3; c++)
            towards[c] = -light->direction[c];
        if (light->is_ambient || !light->is_lit || (has_cone && !is_inside(&cone, towards)))
            continue;
        r->light = light;
        flow = run_statement(r, s->body);
        r->light = NULL;
        if (!goes_on(&flow))
            break;
    }
    return flow;
}

static struct flow run_illuminate(struct reference *r, const struct ast_statement *s) {
    struct reference_value direction = reference_evaluate(r, s->arguments);
    if (s->kind == STATEMENT_ILLUMINATE)
        for (int i = 0; i < 3; i++)
            direction.part[i] = r->world->position[i] - direction.part[i];
    struct cone cone = {{0}, 0};
    bool has_cone = s->argument_count == 3;
    if (has_cone)
        cone = evaluate_cone(r, s->arguments->next);
    write_slot(reference_variable(r, r->direction), &direction);
    if (has_cone && !is_inside(&cone, direction.part))
        return (struct flow){RUNS_ON, 0};
    r->is_lit = true;
    return s->body ? run_statement(r, s->body) : (struct flow){RUNS_ON, 0};
}

static struct flow run_statement(struct reference *r, const struct ast_statement *s) {
    const struct flow on = {RUNS_ON, 0};
    switch (s->kind) {
    case STATEMENT_EMPTY:
    case STATEMENT_FUNCTION:
        return on;
    case STATEMENT_EXPRESSION:
        reference_evaluate(r, s->expression);
        return on;
    case STATEMENT_DECLARE:
        declare(r, s->symbol);
        return on;
    case STATEMENT_BLOCK:
        return run_list(r, s->body);
    case STATEMENT_IF:
        if (reference_evaluate(r, s->expression).truth)
            return run_statement(r, s->body);
        return s->otherwise ? run_statement(r, s->otherwise) : on;
    case STATEMENT_FOR:
        return run_loop(r, s);
    case STATEMENT_BREAK:
        return (struct flow){BREAKS, s->level};
    case STATEMENT_CONTINUE:
        return (struct flow){CONTINUES, s->level};
    case STATEMENT_RETURN:
        if (s->expression)
            r->result = reference_evaluate(r, s->expression);
        return (struct flow){RETURNS, 0};
    case STATEMENT_ILLUMINANCE:
        return run_illuminance(r, s);
    case STATEMENT_ILLUMINATE:
    case STATEMENT_SOLAR:
        return run_illuminate(r, s);
    }
    abort();
}

static struct flow run_list(struct reference *r, const struct ast_statement *list) {
    struct flow flow = {RUNS_ON, 0};
    for (const struct ast_statement *s = list; s && flow.kind == RUNS_ON; s = s->next)
        flow = run_statement(r, s);
    return flow;
}

/* ---- whole shaders ---- */

/* Sets a parameter: what is given, component by component, else its default value. */
static void set_parameter(struct reference *r, const struct ast_symbol *symbol) {
    struct reference_slot *slot = reference_slot(r, symbol);
    const int elements = slot->length ? slot->length : 1;
    float value;
    if (!r->world->input(r->world->context, symbol->name, 0, &value)) {
        r->in_default = true;
        declare(r, symbol);
        r->in_default = false;
        return;
    }
    for (int i = 0; i < elements * reference_width(symbol->type); i++) {
        struct reference_value given = {.count = 1,
                                        .part = {reference_input(r, symbol->name, i, 0)}};
        if (ast_type_is_fixed(symbol->type))
            given = reference_fixed_convert(&given, TYPE_FLOAT, symbol->type);
        reference_write(
            ast_type_is_fixed(symbol->type) ? symbol->type : TYPE_FLOAT,
            slot->cells + i * (reference_cell_count(symbol->type) / reference_width(symbol->type)),
            &given);
    }
    memcpy(&slot->identity, slot->cells, sizeof slot->identity);
}

static void run(struct reference *r, const struct reference_world *world) {
    r->world = world;
    r->generation++;
    r->random_calls = 0;
    r->steps = 0;
    r->has_overrun = r->is_lit = r->in_default = false;
    r->light = NULL;
    for (const struct ast_symbol *symbol = r->unit->shader->formals; symbol; symbol = symbol->next)
        set_parameter(r, symbol);
    run_list(r, r->unit->shader->body);
}

bool reference_shade(struct reference *r, const struct reference_world *world, float color[3]) {
    run(r, world);
    memcpy(color, reference_variable(r, r->color)->cells, 3 * sizeof *color);
    return !r->has_overrun;
}

static bool says_illuminate(const struct ast_statement *list) {
    for (const struct ast_statement *s = list; s; s = s->next)
        if (s->kind == STATEMENT_ILLUMINATE || s->kind == STATEMENT_SOLAR ||
            says_illuminate(s->body) || says_illuminate(s->otherwise))
            return true;
    return false;
}

bool reference_is_light(const struct reference *r) {
    return r->unit->kind == SHADER_KIND_LIGHT;
}

bool reference_is_ambient(const struct reference *r) {
    return !says_illuminate(r->unit->shader->body);
}

bool reference_run_light(struct reference *r, const struct reference_world *world,
                         struct reference_light *light) {
    run(r, world);
    memcpy(light->color, reference_variable(r, r->color)->cells, sizeof light->color);
    memcpy(light->direction, reference_variable(r, r->direction)->cells, sizeof light->direction);
    light->is_ambient = reference_is_ambient(r);
    light->is_lit = r->is_lit || light->is_ambient;
    return !r->has_overrun;
}

/* The variable a shader is for, which exists even when the shader never says its name. */
static const struct ast_symbol *result_symbol(struct reference *r, struct ast_symbol **symbols,
                                              const char *name) {
    const struct ast_global *global = global_find(name);
    if (symbols[global - globals])
        return symbols[global - globals];
    struct ast_symbol *symbol = compilation_get(r->c, sizeof *symbol);
    *symbol = (struct ast_symbol){.name = name, .type = global->type, .global = global};
    return symbol;
}

static void parse_and_check(struct reference *r, const char *text) {
    struct compilation *c = r->c;
    struct ast_unit *prelude =
        parse_unit(c, "(standard functions)", prelude_text, strlen(prelude_text), true);
    char *copy = compilation_copy(c, text, strlen(text));
    r->unit = parse_unit(c, "program.sl", copy, strlen(copy), false);
    if (!r->unit->shader)
        compilation_stop(c);
    struct ast_symbol **symbols = check_unit(c, r->unit, prelude);
    if (c->error_count)
        compilation_stop(c);
    r->prelude = prelude->functions;
    bool is_surface = r->unit->kind == SHADER_KIND_SURFACE;
    r->color = result_symbol(r, symbols, is_surface ? "Ci" : "Cl");
    r->direction = result_symbol(r, symbols, "L");
}

/* False when the front end stopped with an error. */
static bool try_to_check(struct reference *r, const char *text) {
    if (setjmp(r->c->stop))
        return false;
    parse_and_check(r, text);
    return true;
}

struct reference *reference_open(const char *text, bool fast_math, char *message,
                                 size_t message_size) {
    struct reference *r = memory_get(1, sizeof *r);
    r->c = memory_get(1, sizeof *r->c);
    r->c->program = memory_get(1, sizeof *r->c->program);
    r->c->options = &r->options;
    r->fast_math = fast_math;
    arena_init(&r->c->arena, 64 << 20);
    arena_init(&r->c->program->arena, 1 << 20);
    if (try_to_check(r, text))
        return r;
    snprintf(message, message_size, "%s", r->c->message);
    reference_close(r);
    return NULL;
}

void reference_close(struct reference *r) {
    if (!r)
        return;
    for (int i = 0; i < REFERENCE_SLOTS; i++)
        free(r->slots[i].own_cells);
    arena_finish(&r->c->arena);
    arena_finish(&r->c->program->arena);
    free(r->c->program);
    free(r->c);
    free(r);
}
