/* SPDX-License-Identifier: Apache-2.0 */
#include "reference_internal.h"

#include "shaders/compiler/lexer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum exit_kind { RUNS_ON, BREAKS, CONTINUES, RETURNS };
struct flow {
    enum exit_kind kind;
    int level;
};

static int width_of(enum ast_type type) {
    return type == TYPE_MATRIX ? 16 : ast_type_width(type);
}

struct reference_slot *reference_slot(struct reference *r, const struct ast_symbol *symbol) {
    size_t at = ((uintptr_t)symbol >> 4) * 0x9e3779b1u % REFERENCE_SLOTS;
    for (int tried = 0; tried < REFERENCE_SLOTS; tried++, at = (at + 1) % REFERENCE_SLOTS) {
        struct reference_slot *slot = &r->slots[at];
        if (slot->symbol == symbol)
            return slot;
        if (slot->symbol)
            continue;
        slot->symbol = symbol;
        slot->length = symbol->array_length > 0 ? symbol->array_length : 0;
        int cells = (slot->length ? slot->length : 1) * width_of(symbol->type);
        slot->own_cells = slot->cells = calloc((size_t)cells, sizeof *slot->cells);
        if (!slot->cells)
            abort();
        return slot;
    }
    abort(); /* more variables than any test program has */
}

static void clear(struct reference *r, const struct ast_symbol *symbol) {
    struct reference_slot *slot = reference_slot(r, symbol);
    int cells = (slot->length ? slot->length : 1) * width_of(symbol->type);
    memset(slot->cells, 0, (size_t)cells * sizeof *slot->cells);
    slot->identity = shader_string_identity("");
}

static struct reference_value read_cells(enum ast_type type, const float *cells) {
    struct reference_value value = {.count = width_of(type)};
    memcpy(value.part, cells, (size_t)value.count * sizeof *cells);
    return value;
}

static void write_cells(enum ast_type type, float *cells, const struct reference_value *value) {
    for (int i = 0; i < width_of(type); i++)
        cells[i] = value->part[value->count == 1 ? 0 : i];
}

static void write_slot(struct reference_slot *slot, const struct reference_value *value) {
    slot->identity = value->identity;
    write_cells(slot->symbol->type, slot->cells, value);
}

/* ---- predefined variables ---- */

static float input(struct reference *r, const char *name, int component, float otherwise) {
    float value;
    return r->world->input(r->world->context, name, component, &value) ? value : otherwise;
}

static void set_global(struct reference *r, struct reference_slot *slot) {
    const struct ast_global *global = slot->symbol->global;
    bool is_surface = r->unit->kind == SHADER_KIND_SURFACE;
    enum global_source source = is_surface ? global->surface : global->light;
    for (int i = 0; i < ast_type_width(global->type); i++) {
        float *to = &slot->cells[i];
        const float *shader = r->world->matrices->to_camera[SHADER_SPACE_SHADER];
        switch (source) {
        case GLOBAL_MATERIAL:
        case GLOBAL_BOUND:
            *to = input(r, global->name, i, 1);
            break;
        case GLOBAL_POSITION:
            *to = r->world->position[i];
            break;
        case GLOBAL_INCIDENT:
            *to = r->world->incident[i];
            break;
        case GLOBAL_ONE:
            *to = 1;
            break;
        case GLOBAL_THREE:
            *to = 3;
            break;
        case GLOBAL_PI:
            *to = (float)M_PI;
            break;
        case GLOBAL_ORIGIN:
            *to = shader[12 + i];
            break;
        case GLOBAL_AXIS:
            *to = shader[8 + i];
            break;
        default:
            *to = 0;
        }
    }
}

static struct reference_slot *variable(struct reference *r, const struct ast_symbol *symbol) {
    struct reference_slot *slot = reference_slot(r, symbol);
    if (symbol->global && slot->generation != r->generation) {
        slot->generation = r->generation;
        set_global(r, slot);
    }
    return slot;
}

static struct reference_value read_name(struct reference *r, const struct ast_expression *e) {
    const struct ast_symbol *symbol = e->symbol;
    struct reference_value value = {.count = 3};
    bool is_of_light = symbol->global && r->unit->kind == SHADER_KIND_SURFACE &&
                       symbol->global->surface == GLOBAL_LIGHT;
    if (is_of_light) {
        for (int i = 0; i < 3; i++)
            value.part[i] =
                symbol->type == TYPE_COLOR ? r->light->color[i] : -r->light->direction[i];
        return value;
    }
    struct reference_slot *slot = variable(r, symbol);
    value = read_cells(symbol->type, slot->cells);
    value.identity = slot->identity;
    return value;
}

/* ---- expressions ---- */

static struct reference_value number(float x) {
    return (struct reference_value){.count = 1, .part = {x}};
}

static struct reference_value condition(bool truth) {
    return (struct reference_value){.count = 1, .truth = truth};
}

static struct reference_value widen(const struct reference_value *value, enum ast_type type) {
    struct reference_value wide = *value;
    wide.count = width_of(type);
    for (int i = 0; i < wide.count; i++)
        wide.part[i] = value->part[value->count == 1 ? 0 : i];
    return wide;
}

static struct reference_value into_current(struct reference *r, enum ast_type type,
                                           const struct reference_value *value) {
    return reference_transform(r, type, SHADER_SPACE_SHADER, SHADER_SPACE_CURRENT, value);
}

static struct reference_value evaluate_tuple(struct reference *r, const struct ast_expression *e) {
    struct reference_value value = {.count = width_of(e->type)};
    int i = 0;
    for (const struct ast_expression *a = e->arguments; a; a = a->next)
        value.part[i++] = reference_evaluate(r, a).part[0];
    if (r->in_default && ast_type_is_geometric(e->type))
        return into_current(r, e->type, &value);
    return value;
}

static struct reference_value evaluate_convert(struct reference *r,
                                               const struct ast_expression *e) {
    struct reference_value value = reference_evaluate(r, e->left);
    if (e->type == TYPE_BOOL)
        return e->left->type == TYPE_BOOL ? value : condition(value.part[0] != 0);
    if (e->left->type == TYPE_BOOL)
        value = number(value.truth ? 1 : 0);
    if (e->type == TYPE_MATRIX)
        return reference_matrix_diagonal(value.part[0]);
    value = widen(&value, e->type);
    if (r->in_default && e->left->type == TYPE_FLOAT && ast_type_is_geometric(e->type))
        return into_current(r, e->type, &value);
    return value;
}

static struct reference_value evaluate_cast(struct reference *r, const struct ast_expression *e) {
    bool in_default = r->in_default;
    bool takes_space = ast_type_is_geometric(e->type) &&
                       (e->left->kind == EXPRESSION_TUPLE || e->left->type == TYPE_FLOAT);
    int32_t space = e->name ? shader_string_identity(e->name) : SHADER_SPACE_CURRENT;
    r->in_default = in_default && !takes_space;
    struct reference_value value = reference_evaluate(r, e->left);
    r->in_default = in_default;
    if (e->left->type == TYPE_BOOL)
        value = number(value.truth ? 1 : 0);
    if (e->type == TYPE_MATRIX) {
        if (e->left->type != TYPE_MATRIX)
            value = reference_matrix_diagonal(value.part[0]);
        return reference_matrix_in_space(r, space, &value);
    }
    int32_t identity = value.identity;
    value = widen(&value, e->type);
    value.identity = identity;
    if (e->name && e->type == TYPE_COLOR)
        return reference_color_space(r, e->name, "rgb", &value);
    if (e->name && ast_type_is_geometric(e->type))
        return reference_transform(r, e->type, space, SHADER_SPACE_CURRENT, &value);
    if (in_default && takes_space)
        return into_current(r, e->type, &value);
    return value;
}

static bool is_equal(const struct ast_expression *e, const struct reference_value *a,
                     const struct reference_value *b) {
    if (e->left->type == TYPE_STRING)
        return a->identity == b->identity;
    int count = a->count > b->count ? a->count : b->count;
    for (int i = 0; i < count; i++)
        if (!(a->part[a->count == 1 ? 0 : i] == b->part[b->count == 1 ? 0 : i]))
            return false;
    return true;
}

static struct reference_value evaluate_binary(struct reference *r, const struct ast_expression *e) {
    struct reference_value a = reference_evaluate(r, e->left), b = reference_evaluate(r, e->right),
                           value = {.count = 3};
    const float *x = a.part, *y = b.part;
    switch (e->token) {
    case TOKEN_AND:
        return condition(a.truth && b.truth);
    case TOKEN_OR:
        return condition(a.truth || b.truth);
    case '<':
        return condition(x[0] < y[0]);
    case '>':
        return condition(x[0] > y[0]);
    case TOKEN_LESS_EQUAL:
        return condition(x[0] <= y[0]);
    case TOKEN_GREATER_EQUAL:
        return condition(x[0] >= y[0]);
    case TOKEN_EQUAL:
        return condition(is_equal(e, &a, &b));
    case TOKEN_NOT_EQUAL:
        return condition(!is_equal(e, &a, &b));
    case '.':
        return number(reference_dot(x, y));
    case '^':
        for (int i = 0; i < 3; i++)
            value.part[i] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
        return value;
    }
    if (e->type == TYPE_MATRIX)
        return reference_matrix_product(e->token == '/', &a, &b);
    return reference_each(e->token, &a, &b);
}

static struct reference_value evaluate_unary(struct reference *r, const struct ast_expression *e) {
    struct reference_value value = reference_evaluate(r, e->left);
    value.truth = !value.truth;
    for (int i = 0; i < value.count; i++)
        value.part[i] = -value.part[i];
    return value;
}

static struct reference_value evaluate_assignment(struct reference *r,
                                                  const struct ast_expression *e) {
    struct reference_value right = reference_evaluate(r, e->right);
    struct reference_slot *slot = variable(r, e->left->symbol);
    float *cells = slot->cells;
    if (e->left->kind == EXPRESSION_INDEX) {
        float index = reference_evaluate(r, e->left->right).part[0];
        cells += reference_index(index, slot->length) * width_of(e->type);
    }
    if (e->token) {
        struct reference_value left = read_cells(e->type, cells);
        right = e->type == TYPE_MATRIX ? reference_matrix_product(e->token == '/', &left, &right)
                                       : reference_each(e->token, &left, &right);
    }
    write_cells(e->type, cells, &right);
    slot->identity = right.identity;
    int32_t identity = right.identity;
    right = widen(&right, e->type);
    right.identity = identity;
    return right;
}

struct reference_value reference_evaluate(struct reference *r, const struct ast_expression *e) {
    struct reference_slot *slot;
    switch (e->kind) {
    case EXPRESSION_NUMBER:
        return number(e->number);
    case EXPRESSION_STRING:
        return (struct reference_value){.count = 1, .identity = shader_string_identity(e->name)};
    case EXPRESSION_NAME:
        return read_name(r, e);
    case EXPRESSION_INDEX:
        slot = variable(r, e->symbol);
        return read_cells(
            e->type,
            slot->cells + reference_index(reference_evaluate(r, e->right).part[0], slot->length) *
                              width_of(e->type));
    case EXPRESSION_TUPLE:
        return evaluate_tuple(r, e);
    case EXPRESSION_UNARY:
        return evaluate_unary(r, e);
    case EXPRESSION_BINARY:
        return evaluate_binary(r, e);
    case EXPRESSION_CONDITIONAL:
        return reference_evaluate(r, reference_evaluate(r, e->left).truth ? e->right : e->third);
    case EXPRESSION_ASSIGN:
        return evaluate_assignment(r, e);
    case EXPRESSION_CAST:
        return evaluate_cast(r, e);
    case EXPRESSION_CONVERT:
        return evaluate_convert(r, e);
    case EXPRESSION_CALL:
        return e->function ? reference_call(r, e->function, e->arguments, NULL)
                           : reference_builtin(r, e);
    }
    abort();
}

/* ---- statements ---- */

static struct flow run_list(struct reference *r, const struct ast_statement *list);

/* All arguments are evaluated before the first is bound; arrays are passed as they are. Output
 * parameters are copied back in their order. `given` stands for the one argument of a function that
 * is called from within. */
struct reference_value reference_call(struct reference *r, const struct ast_function *function,
                                      const struct ast_expression *arguments,
                                      const struct reference_value *given) {
    struct reference_value values[64], outer = r->result;
    struct reference_slot *arrays[64];
    bool in_default = r->in_default;
    int i = 0;
    if (given)
        values[0] = *given;
    for (const struct ast_expression *a = arguments; a; a = a->next, i++) {
        arrays[i] = a->array_length ? variable(r, a->symbol) : NULL;
        if (!arrays[i])
            values[i] = reference_evaluate(r, a);
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
    r->result = (struct reference_value){.count = width_of(function->type),
                                         .identity = shader_string_identity("")};
    run_list(r, function->body);
    struct reference_value result = r->result;
    r->result = outer;
    r->in_default = in_default;
    const struct ast_symbol *formal = function->formals;
    for (const struct ast_expression *a = arguments; a; a = a->next, formal = formal->next)
        if (formal->is_output && !formal->array_length) {
            struct reference_value value =
                read_cells(formal->type, reference_slot(r, formal)->cells);
            write_slot(variable(r, a->symbol), &value);
        }
    return result;
}

static void set_elements(struct reference *r, const struct ast_symbol *symbol,
                         struct reference_slot *slot) {
    int element = 0;
    for (const struct ast_expression *e = symbol->elements; e; e = e->next, element++) {
        struct reference_value value = reference_evaluate(r, e);
        write_cells(symbol->type, slot->cells + element * width_of(symbol->type), &value);
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
    write_slot(variable(r, r->direction), &direction);
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
    int cells = (slot->length ? slot->length : 1) * width_of(symbol->type);
    float value;
    if (!r->world->input(r->world->context, symbol->name, 0, &value)) {
        r->in_default = true;
        declare(r, symbol);
        r->in_default = false;
        return;
    }
    for (int i = 0; i < cells; i++)
        slot->cells[i] = input(r, symbol->name, i, 0);
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
    memcpy(color, variable(r, r->color)->cells, 3 * sizeof *color);
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
    memcpy(light->color, variable(r, r->color)->cells, sizeof light->color);
    memcpy(light->direction, variable(r, r->direction)->cells, sizeof light->direction);
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
