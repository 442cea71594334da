/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/check.h"

#include "base/hash.h"

#include <string.h>

static unsigned bucket_of(const char *name) {
    return (unsigned)(hash_string(name, 0) % SCOPE_BUCKETS);
}

void scope_enter(struct checker *k) {
    k->level++;
}

void scope_leave(struct checker *k) {
    while (k->newest && k->newest->level == k->level) {
        k->buckets[bucket_of(k->newest->name)] = k->newest->below;
        k->newest = k->newest->previous;
    }
    k->level--;
}

static struct scope_entry *add(struct checker *k, const char *name) {
    struct scope_entry *entry = compilation_get(k->c, sizeof *entry);
    struct scope_entry **bucket = &k->buckets[bucket_of(name)];
    entry->name = name;
    entry->level = k->level;
    entry->below = *bucket;
    entry->previous = k->newest;
    *bucket = k->newest = entry;
    return entry;
}

void scope_add_symbol(struct checker *k, struct ast_symbol *symbol) {
    for (struct scope_entry *e = k->buckets[bucket_of(symbol->name)]; e && e->level == k->level;
         e = e->below)
        if (e->symbol && !strcmp(e->name, symbol->name)) {
            compile_error(k->c, &symbol->at, "'%.64s' is declared twice; the first time in line %d",
                          symbol->name, e->symbol->at.line);
            return;
        }
    add(k, symbol->name)->symbol = symbol;
}

static bool same_formals(const struct ast_function *a, const struct ast_function *b) {
    const struct ast_symbol *x = a->formals, *y = b->formals;
    for (; x && y; x = x->next, y = y->next)
        if (x->type != y->type || !x->array_length != !y->array_length)
            return false;
    return !x && !y;
}

void scope_add_function(struct checker *k, struct ast_function *function) {
    for (struct scope_entry *e = k->buckets[bucket_of(function->name)]; e && e->level == k->level;
         e = e->below)
        if (e->function && !strcmp(e->name, function->name) && !e->function->is_prelude &&
            same_formals(e->function, function)) {
            compile_error(k->c, &function->at,
                          "function '%.64s' is defined twice; the first time in line %d",
                          function->name, e->function->at.line);
            return;
        }
    add(k, function->name)->function = function;
}

struct ast_symbol *scope_find_symbol(struct checker *k, const char *name) {
    for (struct scope_entry *e = k->buckets[bucket_of(name)]; e; e = e->below)
        if (e->symbol && !strcmp(e->name, name))
            return e->symbol;
    const struct ast_global *global = global_find(name);
    if (!global)
        return NULL;
    if (global_source_in(global, k->kind) == GLOBAL_ABSENT)
        return NULL;
    struct ast_symbol **slot = &k->global_symbols[global - globals];
    if (!*slot) {
        *slot = compilation_get(k->c, sizeof **slot);
        (*slot)->name = global->name;
        (*slot)->type = global->type;
        (*slot)->global = global;
    }
    return *slot;
}

struct scope_entry *scope_find_function(struct checker *k, const char *name,
                                        struct scope_entry *after) {
    for (struct scope_entry *e = after ? after->below : k->buckets[bucket_of(name)];
         e && (!after || e->level == after->level); e = e->below)
        if (e->function && !strcmp(e->name, name))
            return e;
    return NULL;
}

static void check_statement(struct checker *k, struct ast_statement *s);

static void check_list(struct checker *k, struct ast_statement *list, struct ast_statement *owner) {
    for (struct ast_statement *s = list; s; s = s->next) {
        check_statement(k, s);
        if (owner && s->exit_level > owner->exit_level)
            owner->exit_level = s->exit_level;
    }
}

static void check_scoped(struct checker *k, struct ast_statement *body,
                         struct ast_statement *owner) {
    if (!body)
        return;
    scope_enter(k);
    check_statement(k, body);
    scope_leave(k);
    if (body->exit_level > owner->exit_level)
        owner->exit_level = body->exit_level;
}

static void check_declaration(struct checker *k, struct ast_symbol *symbol) {
    symbol->owner = k->function;
    if (symbol->array_length < 0 && !symbol->is_formal) {
        compile_error(k->c, &symbol->at, "array '%.64s' needs a length", symbol->name);
        symbol->array_length = 1;
    }
    if (symbol->type == TYPE_STRING && symbol->storage == STORAGE_VARYING)
        compile_error(k->c, &symbol->at, "strings are uniform");
    int width = symbol->type == TYPE_MATRIX ? 16 : ast_type_width(symbol->type);
    if (symbol->array_length > 0 && symbol->array_length * width > ARRAY_FLOATS_MAX)
        compile_limit(k->c, &symbol->at, "an array holds at most %d floats", ARRAY_FLOATS_MAX);
    if (symbol->initial && !symbol->array_length) {
        symbol->initial = check_as(k, symbol->initial, symbol->type);
    } else if (symbol->initial) {
        symbol->initial = check_expression(k, symbol->initial, TYPE_ERROR);
        if (symbol->initial->type != TYPE_ERROR && !check_array_fits(symbol->initial, symbol))
            compile_error(k->c, &symbol->initial->at,
                          "an array of %d %s cannot begin as a copy of this", symbol->array_length,
                          ast_type_name(symbol->type));
    }
    if ((symbol->transform != TRANSFORM_NONE || symbol->is_unit) &&
        (!symbol->is_parameter || symbol->array_length != 3 ||
         (symbol->type != TYPE_FLOAT && !ast_type_is_fixed(symbol->type))))
        compile_error(k->c, &symbol->at,
                      "transformation attributes are for parameters of the shader that are arrays "
                      "of three numbers");
    for (struct ast_expression **e = &symbol->elements; *e; e = &(*e)->next) {
        struct ast_expression *next = (*e)->next;
        *e = check_as(k, *e, symbol->type);
        (*e)->next = next;
    }
}

static void check_each(struct checker *k, struct ast_expression **list) {
    for (struct ast_expression **e = list; *e; e = &(*e)->next) {
        struct ast_expression *next = (*e)->next;
        *e = check_expression(k, *e, TYPE_ERROR);
        (*e)->next = next;
    }
}

static void check_loop(struct checker *k, struct ast_statement *s) {
    check_each(k, &s->initial);
    if (s->expression)
        s->expression = check_as(k, s->expression, TYPE_BOOL);
    check_each(k, &s->step);
    k->loop_level++;
    check_scoped(k, s->body, s);
    k->loop_level--;
    if (s->exit_level && s->exit_level < EXIT_FUNCTION)
        s->exit_level--;
}

/* Displacement shaders run before all light, imagers after all surfaces. */
static bool can_ask_lights(enum shader_kind kind, bool is_illuminance) {
    return !is_illuminance || kind == SHADER_KIND_SURFACE || kind == SHADER_KIND_VOLUME;
}

/* illuminance(["category",] ... [, "name", value ...]): takes the category out of the arguments,
 * and drops what is named at their end. */
static void check_category(struct checker *k, struct ast_statement *s) {
    struct ast_expression **link = &s->arguments;
    if (s->arguments && s->arguments->type == TYPE_STRING) {
        s->category = s->arguments->kind == EXPRESSION_STRING ? s->arguments->name : NULL;
        if (!s->category)
            compile_warning(k->c, &s->arguments->at,
                            "a category that is not written out is ignored; every light matches");
        s->arguments = s->arguments->next;
        s->argument_count--;
    }
    while (*link && (*link)->type != TYPE_STRING)
        link = &(*link)->next;
    if (*link)
        compile_warning(k->c, &(*link)->at, "what illuminance is told here has no effect");
    for (struct ast_expression *a = *link; a; a = a->next)
        s->argument_count--;
    *link = NULL;
}

/* Arguments of illuminance ([category,] position [, axis, angle]), illuminate (from [, axis,
 * angle]) and solar
 * ([axis, angle]). */
static void check_lighting(struct checker *k, struct ast_statement *s) {
    bool is_surface = k->kind != SHADER_KIND_LIGHT;
    const char *name = s->kind == STATEMENT_ILLUMINANCE  ? "illuminance"
                       : s->kind == STATEMENT_ILLUMINATE ? "illuminate"
                                                         : "solar";
    if (is_surface != (s->kind == STATEMENT_ILLUMINANCE) || !can_ask_lights(k->kind, is_surface))
        compile_error(k->c, &s->at, "%s belongs into a %s shader", name,
                      is_surface && s->kind != STATEMENT_ILLUMINANCE ? "light" : "surface");
    check_each(k, &s->arguments);
    if (s->kind == STATEMENT_ILLUMINANCE)
        check_category(k, s);
    static const enum ast_type wanted[3] = {TYPE_POINT, TYPE_VECTOR, TYPE_FLOAT};
    int first = s->kind == STATEMENT_SOLAR ? 1 : 0, at = first;
    if (s->argument_count != 3 - first && s->argument_count != 1 - first)
        compile_error(k->c, &s->at, "%s takes (%s) or (%saxis, angle)", name,
                      first ? "" : "position", first ? "" : "position, ");
    else if (first && !s->argument_count)
        compile_warning(k->c, &s->at,
                        "solar without an axis shines from everywhere: its light is ambient");
    for (struct ast_expression **a = &s->arguments; *a && at < 3; a = &(*a)->next, at++) {
        struct ast_expression *next = (*a)->next;
        *a = check_convert(k, *a, wanted[at]);
        (*a)->next = next;
    }
    bool is_loop = s->kind == STATEMENT_ILLUMINANCE;
    k->loop_level += is_loop;
    k->illuminance_level += is_loop;
    if (k->illuminance_level > 1)
        compile_error(k->c, &s->at, "illuminance inside illuminance");
    check_scoped(k, s->body, s);
    k->illuminance_level -= is_loop;
    k->loop_level -= is_loop;
    if (is_loop && s->exit_level && s->exit_level < EXIT_FUNCTION)
        s->exit_level--;
}

static void check_return(struct checker *k, struct ast_statement *s) {
    enum ast_type type = k->function->type;
    s->exit_level = EXIT_FUNCTION;
    if (s->expression) {
        if (type == TYPE_VOID) {
            compile_error(k->c, &s->expression->at, "%s returns nothing",
                          k->function->is_shader ? "a shader" : "a void function");
            check_expression(k, s->expression, TYPE_ERROR);
        } else {
            s->expression = check_as(k, s->expression, type);
        }
    } else if (type != TYPE_VOID) {
        compile_error(k->c, &s->at, "this function returns a %s", ast_type_name(type));
    }
}

static void check_statement(struct checker *k, struct ast_statement *s) {
    switch (s->kind) {
    case STATEMENT_EMPTY:
        break;
    case STATEMENT_EXPRESSION:
        s->expression = check_expression(k, s->expression, TYPE_ERROR);
        break;
    case STATEMENT_DECLARE:
        check_declaration(k, s->symbol);
        scope_add_symbol(k, s->symbol);
        break;
    case STATEMENT_FUNCTION:
        scope_add_function(k, s->function);
        check_function(k, s->function);
        break;
    case STATEMENT_BLOCK:
        if (s->is_scope)
            scope_enter(k);
        check_list(k, s->body, s);
        if (s->is_scope)
            scope_leave(k);
        break;
    case STATEMENT_IF:
        s->expression = check_as(k, s->expression, TYPE_BOOL);
        check_scoped(k, s->body, s);
        check_scoped(k, s->otherwise, s);
        break;
    case STATEMENT_FOR:
        check_loop(k, s);
        break;
    case STATEMENT_BREAK:
    case STATEMENT_CONTINUE:
        if (s->level > k->loop_level)
            compile_error(k->c, &s->at,
                          k->loop_level ? "there are only %d loops around this"
                                        : "this is not inside a loop",
                          k->loop_level);
        s->exit_level = s->level;
        break;
    case STATEMENT_RETURN:
        check_return(k, s);
        break;
    case STATEMENT_ILLUMINANCE:
    case STATEMENT_ILLUMINATE:
    case STATEMENT_SOLAR:
        check_lighting(k, s);
        break;
    }
}

/* A return is early unless it is the last statement of the body. */
static bool has_early_return(const struct ast_statement *body) {
    for (const struct ast_statement *s = body; s; s = s->next)
        if (s->exit_level == EXIT_FUNCTION && !(s->kind == STATEMENT_RETURN && !s->next))
            return true;
    return false;
}

static bool has_return(const struct ast_statement *body) {
    for (const struct ast_statement *s = body; s; s = s->next)
        if (s->exit_level == EXIT_FUNCTION)
            return true;
    return false;
}

/* A function from outside takes and gives floats, one at a time. */
static void check_external(struct checker *k, struct ast_function *function) {
    if (function->type != TYPE_FLOAT)
        compile_error(k->c, &function->at, "%.64s() is extern \"C\": its result is a float",
                      function->name);
    if (function->formal_count > EXTERNAL_PARAMETERS_MAX)
        compile_error(k->c, &function->at, "%.64s() is extern \"C\": it takes at most %d floats",
                      function->name, EXTERNAL_PARAMETERS_MAX);
    for (const struct ast_symbol *s = function->formals; s; s = s->next)
        if (s->type != TYPE_FLOAT || s->array_length || s->is_output || s->initial)
            compile_error(k->c, &s->at,
                          "'%.64s' of %.64s(), which is extern \"C\", must be a plain float",
                          s->name, function->name);
    function->is_checked = true;
}

void check_function(struct checker *k, struct ast_function *function) {
    if (function->is_external) {
        check_external(k, function);
        return;
    }
    struct ast_function *outer = k->function;
    int outer_loops = k->loop_level, outer_illuminance = k->illuminance_level;
    k->function = function;
    k->loop_level = k->illuminance_level = 0;
    scope_enter(k);
    for (struct ast_symbol *formal = function->formals; formal; formal = formal->next) {
        k->in_default = true;
        if (!function->is_shader && formal->initial)
            compile_error(k->c, &formal->at, "parameters of functions have no default value");
        check_declaration(k, formal);
        k->in_default = false;
        if (function->is_shader && global_find(formal->name))
            compile_warning(k->c, &formal->at,
                            "parameter '%s' hides the predefined variable of this name",
                            formal->name);
        scope_add_symbol(k, formal);
        function->has_outputs |= formal->is_output;
    }
    check_list(k, function->body, NULL);
    scope_leave(k);
    if (function->type != TYPE_VOID && !has_return(function->body))
        compile_error(k->c, &function->at, "function '%.64s' never returns a value",
                      function->name);
    function->returns_early = has_early_return(function->body);
    function->is_checked = true;
    k->function = outer;
    k->loop_level = outer_loops;
    k->illuminance_level = outer_illuminance;
}

struct ast_symbol **check_unit(struct compilation *c, struct ast_unit *unit,
                               struct ast_unit *prelude) {
    struct checker *k = compilation_get(c, sizeof *k);
    k->c = c;
    k->prelude = prelude->functions;
    k->kind = SHADER_KIND_SURFACE; /* what a light must not call is found when it does */
    for (struct ast_function *f = prelude->functions; f; f = f->next)
        scope_add_function(k, f);
    for (struct ast_function *f = prelude->functions; f; f = f->next)
        check_function(k, f);
    k->kind = unit->kind;
    k->level = 1;
    for (struct ast_function *f = unit->functions; f; f = f->next)
        scope_add_function(k, f); /* all first, so that a cycle is called a cycle */
    for (struct ast_function *f = unit->functions; f; f = f->next)
        check_function(k, f);
    if (unit->shader)
        check_function(k, unit->shader);
    return k->global_symbols;
}
