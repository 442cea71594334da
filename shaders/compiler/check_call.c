/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/check.h"
#include "shaders/compiler/splines.h"

#include <stdio.h>
#include <string.h>

static struct ast_expression *fail(struct ast_expression *e) {
    e->kind = EXPRESSION_NUMBER;
    e->type = TYPE_ERROR;
    return e;
}

static void complain_unknown(struct checker *k, const struct ast_expression *e) {
    const char *best = NULL;
    int distance = 0;
    for (struct scope_entry *entry = k->newest; entry; entry = entry->previous)
        if (entry->function)
            suggestion_consider(e->name, entry->name, &best, &distance);
    for (int i = 0; i < BUILTIN_COUNT; i++)
        suggestion_consider(e->name, builtins[i].name, &best, &distance);
    if (best)
        compile_error(k->c, &e->at, "there is no function '%.64s'; did you mean '%.64s'?", e->name,
                      best);
    else
        compile_error(k->c, &e->at, "there is no function '%.64s'", e->name);
}

static struct ast_expression *check_user_call(struct checker *k, struct ast_expression *e,
                                              struct ast_function *function) {
    e->function = function;
    e->type = function->type;
    e->has_effects = function->has_outputs || !function->is_checked;
    k->function->has_outputs |= e->has_effects;
    if (e->argument_count != function->formal_count) {
        compile_error(k->c, &e->at, "%.64s() takes %d argument%s, not %d", e->name,
                      function->formal_count, function->formal_count == 1 ? "" : "s",
                      e->argument_count);
        for (struct ast_expression *a = e->arguments; a; a = a->next)
            check_expression(k, a, TYPE_ERROR);
        return fail(e);
    }
    struct ast_symbol *formal = function->formals;
    for (struct ast_expression **a = &e->arguments; *a; a = &(*a)->next, formal = formal->next) {
        struct ast_expression *next = (*a)->next;
        *a = check_expression(k, *a, formal->type);
        bool wants_array = formal->array_length != 0, is_array = (*a)->array_length != 0;
        if ((*a)->type == TYPE_ERROR) {
        } else if (wants_array != is_array || (is_array && (*a)->type != formal->type) ||
                   (formal->array_length > 0 && (*a)->array_length > 0 &&
                    (*a)->array_length < formal->array_length)) {
            compile_error(k->c, &(*a)->at, "argument '%.64s' of %.64s() is %s %s", formal->name,
                          e->name, wants_array ? "an array of" : "a single",
                          ast_type_name(formal->type));
        } else if (formal->is_output && !is_array &&
                   ((*a)->type != formal->type &&
                    !(ast_type_is_geometric((*a)->type) && ast_type_is_geometric(formal->type)))) {
            compile_error(k->c, &(*a)->at, "output argument '%.64s' of %.64s() is a %s",
                          formal->name, e->name, ast_type_name(formal->type));
        } else if (!is_array && !formal->is_output) {
            *a = check_convert(k, *a, formal->type);
        }
        if (formal->is_output)
            check_written(k, *a);
        (*a)->next = next;
    }
    return e;
}

static bool is_literal(const struct ast_expression *e) {
    return e && e->kind == EXPRESSION_STRING;
}

static void check_color_spaces(struct checker *k, struct ast_expression *e) {
    struct ast_expression *a = e->arguments;
    for (int i = 0; i < e->argument_count - 1 && a; i++, a = a->next)
        if (is_literal(a) && !color_space_is_known(a->name))
            compile_error(k->c, &a->at, "ctransform knows the color spaces " COLOR_SPACES);
}

/* concat and format of strings written out are strings written out. */
static void fold_strings(struct checker *k, struct ast_expression *e) {
    size_t length = 0, at = 0;
    bool is_format = e->builtin->id == BUILTIN_FORMAT;
    for (const struct ast_expression *a = e->arguments; a; a = a->next) {
        if (!is_literal(a) || (is_format && (a->next || strchr(a->name, '%'))))
            return;
        length += strlen(a->name);
    }
    char *text = compilation_get(k->c, length + 1);
    for (const struct ast_expression *a = e->arguments; a; a = a->next) {
        memcpy(text + at, a->name, strlen(a->name));
        at += strlen(a->name);
    }
    e->kind = EXPRESSION_STRING;
    e->name = text;
}

static void check_neutral(struct checker *k, struct ast_expression *e) {
    float value;
    const char *reason = builtin_neutral(e->builtin->id, &value);
    if (reason)
        compile_warning(k->c, &e->at, e->builtin->id == BUILTIN_PRINTF ? "%s %s" : "%s() %s",
                        e->name, reason);
}

static void check_strings(struct checker *k, struct ast_expression *e) {
    if (e->builtin->id == BUILTIN_FORMAT && !is_literal(e->arguments))
        compile_error(k->c, &e->arguments->at, "the text of format() must be written out");
    else
        fold_strings(k, e);
}

/* surface("name", x) and the like: the name is written out, x a variable. */
static void check_message(struct checker *k, struct ast_expression *e) {
    if (!is_literal(e->arguments))
        compile_error(k->c, &e->arguments->at, "the name that %s() asks for must be written out",
                      e->name);
    check_written(k, e->arguments->next);
}

/* The one type of a spline's values: the first that is said, or what the context wants of (x, y,
 * z). */
static enum ast_type spline_type(const struct ast_expression *values, enum ast_type wanted) {
    enum ast_type type = TYPE_FLOAT;
    for (const struct ast_expression *a = values; a; a = a->next)
        if (type == TYPE_FLOAT || (type == TYPE_TRIPLE && ast_type_is_triple(a->type)))
            type = a->type;
    if (type == TYPE_TRIPLE)
        return ast_type_is_triple(wanted) ? wanted : TYPE_COLOR;
    return type;
}

/* spline([basis,] x, value, value, ...) or spline([basis,] x, array), its arguments checked already
 */
static struct ast_expression *check_spline(struct checker *k, struct ast_expression *e,
                                           enum ast_type wanted) {
    struct ast_expression **a = &e->arguments;
    if (*a && (*a)->type == TYPE_STRING) {
        if (is_literal(*a) && !spline_basis_find((*a)->name)) {
            compile_error(k->c, &(*a)->at,
                          "the basis of a spline is \"catmull-rom\", \"bezier\", \"bspline\", "
                          "\"hermite\" or \"linear\"");
            return fail(e);
        }
        a = &(*a)->next;
    }
    if (!*a || !(*a)->next) {
        compile_error(k->c, &e->at, "spline() takes a position and values or an array");
        return fail(e);
    }
    bool is_array = (*a)->next->array_length != 0;
    e->type = spline_type((*a)->next, wanted);
    if (e->type != TYPE_FLOAT && !ast_type_is_triple(e->type)) {
        compile_error(k->c, &(*a)->next->at, "there are no splines of %s", ast_type_name(e->type));
        return fail(e);
    }
    for (int i = 0; *a; a = &(*a)->next, i++) {
        struct ast_expression *next = (*a)->next;
        if (i == 1 && is_array && !next)
            break;
        *a = check_convert(k, *a, i ? e->type : TYPE_FLOAT);
        (*a)->next = next;
    }
    return e;
}

static bool has_fixed(const enum ast_type *types, int count) {
    for (int i = 0; i < count; i++)
        if (ast_type_is_fixed(types[i]))
            return true;
    return false;
}

static struct ast_expression *check_builtin_call(struct checker *k, struct ast_expression *e,
                                                 const struct builtin *builtin,
                                                 enum ast_type wanted) {
    enum ast_type types[BUILTIN_ARGUMENTS_MAX] = {0}, parameters[BUILTIN_ARGUMENTS_MAX];
    uint32_t written = 0;
    int count = 0;
    float value;
    bool is_wrong = false, is_neutral = builtin_neutral(builtin->id, &value) != NULL;
    e->builtin = builtin;
    if (e->argument_count > BUILTIN_ARGUMENTS_MAX) {
        compile_error(k->c, &e->at, "more than %d arguments", BUILTIN_ARGUMENTS_MAX);
        return fail(e);
    }
    for (struct ast_expression **a = &e->arguments; *a; a = &(*a)->next) {
        struct ast_expression *next = (*a)->next;
        *a = check_expression(k, *a, TYPE_ERROR);
        (*a)->next = next;
        is_wrong |= (*a)->type == TYPE_ERROR;
        bool takes_array = is_neutral || builtin->id == BUILTIN_SPLINE ||
                           builtin_is_message(builtin->id) || builtin_refusal(builtin->id);
        if ((*a)->array_length && !takes_array) {
            compile_error(k->c, &(*a)->at, "%s() does not take an array", e->name);
            is_wrong = true;
        }
        types[count++] = (*a)->type;
    }
    if (is_wrong)
        return fail(e);
    if (builtin->id == BUILTIN_SPLINE)
        return check_spline(k, e, wanted);
    if (strstr(builtin->overloads, "x:") && has_fixed(types, count)) {
        count = 0;
        for (struct ast_expression *a = e->arguments; a; a = a->next) {
            check_fixed_number(a);
            types[count++] = a->type;
        }
    }
    if (!builtin_resolve(builtin, types, count, wanted, &e->type, parameters, &written)) {
        char list[160] = "";
        for (int i = 0; i < count && i < 6; i++) {
            size_t used = strlen(list);
            snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "",
                     ast_type_name(types[i]));
        }
        compile_error(k->c, &e->at, "%s() cannot be called with (%s)", e->name, list);
        return fail(e);
    }
    int i = 0;
    for (struct ast_expression **a = &e->arguments; *a; a = &(*a)->next, i++) {
        struct ast_expression *next = (*a)->next;
        if (is_neutral)
            ;
        else if (i < 32 && written >> i & 1) {
            check_written(k, *a);
            e->has_effects = true;
        } else if (parameters[i] != TYPE_TRIPLE && parameters[i] != TYPE_ANY_FIXED)
            *a = check_convert(k, *a, parameters[i]);
        (*a)->next = next;
    }
    if (e->type == TYPE_ANY_FIXED)
        e->type = fixed_call_type(builtin->id, types, count);
    if (builtin->id == BUILTIN_CTRANSFORM)
        check_color_spaces(k, e);
    switch (builtin->id) {
    case BUILTIN_FORMAT:
    case BUILTIN_CONCAT:
        check_strings(k, e);
        break;
    case BUILTIN_LIGHTSOURCE:
    case BUILTIN_SURFACE:
    case BUILTIN_DISPLACEMENT:
    case BUILTIN_ATMOSPHERE:
    case BUILTIN_INCIDENT:
    case BUILTIN_OPPOSITE:
    case BUILTIN_OPTION:
    case BUILTIN_ATTRIBUTE:
    case BUILTIN_RENDERERINFO:
        check_message(k, e);
        break;
    default:
        check_neutral(k, e);
    }
    return e;
}

/* What calling this one would cost in conversions, negative: it cannot be called so. */
static int call_cost(const struct ast_function *function, const struct ast_expression *e) {
    const struct ast_expression *a = e->arguments;
    int sum = 0;
    if (function->formal_count != e->argument_count)
        return -1;
    for (const struct ast_symbol *f = function->formals; f; f = f->next, a = a->next) {
        int cost = ast_conversion_cost(a->type, f->type);
        if (cost < 0 || !f->array_length != !a->array_length)
            return -1;
        sum += cost;
    }
    return sum;
}

/* Of functions of one name in one scope the one that fits the arguments best; the last defined when
 * none does. Arguments are checked here only when there is a choice. */
static struct ast_function *choose_overload(struct checker *k, struct ast_expression *e,
                                            struct scope_entry *entry) {
    struct ast_function *best = entry->function;
    int best_cost = -1;
    if (!scope_find_function(k, e->name, entry))
        return best;
    for (struct ast_expression **a = &e->arguments; *a; a = &(*a)->next) {
        struct ast_expression *next = (*a)->next;
        *a = check_expression(k, *a, TYPE_ERROR);
        (*a)->next = next;
    }
    for (; entry; entry = scope_find_function(k, e->name, entry)) {
        int cost = call_cost(entry->function, e);
        if (cost >= 0 && (best_cost < 0 || cost < best_cost)) {
            best = entry->function;
            best_cost = cost;
        }
    }
    return best;
}

struct ast_expression *check_call(struct checker *k, struct ast_expression *e,
                                  enum ast_type wanted) {
    struct scope_entry *entry = scope_find_function(k, e->name, NULL);
    struct ast_function *function = entry ? choose_overload(k, e, entry) : NULL;
    const struct builtin *builtin = builtin_find(e->name);
    if (function &&
        (!function->is_prelude || !builtin || function->formal_count == e->argument_count))
        return check_user_call(k, e, function);
    if (builtin)
        return check_builtin_call(k, e, builtin, wanted);
    complain_unknown(k, e);
    for (struct ast_expression *a = e->arguments; a; a = a->next)
        check_expression(k, a, TYPE_ERROR);
    return fail(e);
}
