/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/check.h"
#include "shaders/compiler/lexer.h"

#include <string.h>

static struct ast_expression *fail(struct ast_expression *e) {
    e->type = TYPE_ERROR;
    e->kind = EXPRESSION_NUMBER;
    return e;
}

struct ast_expression *check_convert(struct checker *k, struct ast_expression *e,
                                     enum ast_type type) {
    if ((e->type == type && !e->array_length) || e->type == TYPE_ERROR || type == TYPE_ERROR)
        return e;
    if (ast_type_is_fixed(e->type) && ast_type_is_triple(type) && !e->array_length)
        e = check_convert(k, e, TYPE_FLOAT);
    const bool is_triple_of_array = e->array_length == 3 && ast_type_is_triple(type) &&
                                    (e->type == TYPE_FLOAT || ast_type_is_fixed(e->type));
    if (!is_triple_of_array && (e->array_length || ast_conversion_cost(e->type, type) < 0)) {
        const char *hint = "";
        if (ast_type_is_triple(e->type) && ast_type_is_triple(type))
            hint = type == TYPE_COLOR ? "; say color (...)" : "; say vector (...)";
        compile_error(k->c, &e->at, "cannot use %s%s where %s is wanted%s",
                      e->array_length ? "an array of " : "", ast_type_name(e->type),
                      ast_type_name(type), hint);
        return fail(e);
    }
    if (e->type == TYPE_TRIPLE && e->kind == EXPRESSION_TUPLE) {
        e->type = type;
        return e;
    }
    struct ast_expression *convert = compilation_get(k->c, sizeof *convert);
    convert->kind = EXPRESSION_CONVERT;
    convert->type = type;
    convert->at = e->at;
    convert->left = e;
    convert->has_effects = e->has_effects;
    return convert;
}

struct ast_expression *check_as(struct checker *k, struct ast_expression *e, enum ast_type type) {
    return check_convert(k, check_expression(k, e, type), type);
}

static struct ast_expression *check_name(struct checker *k, struct ast_expression *e) {
    e->symbol = scope_find_symbol(k, e->name);
    if (!e->symbol) {
        const char *best = NULL;
        int distance = 0;
        for (struct scope_entry *entry = k->newest; entry; entry = entry->previous)
            if (entry->symbol)
                suggestion_consider(e->name, entry->name, &best, &distance);
        for (int i = 0; i < global_count; i++)
            suggestion_consider(e->name, globals[i].name, &best, &distance);
        if (global_find(e->name))
            compile_error(k->c, &e->at, "%s has no value in %s shaders", e->name,
                          shader_kind_name(k->kind));
        else if (best)
            compile_error(k->c, &e->at, "'%.64s' is not declared; did you mean '%.64s'?", e->name,
                          best);
        else
            compile_error(k->c, &e->at, "'%.64s' is not declared", e->name);
        return fail(e);
    }
    e->type = e->symbol->type;
    e->array_length = e->symbol->array_length;
    return e;
}

static struct ast_expression *check_index(struct checker *k, struct ast_expression *e) {
    e->left = check_name(k, e->left);
    e->right = check_as(k, e->right, TYPE_FLOAT);
    if (e->left->type == TYPE_ERROR)
        return fail(e);
    if (!e->left->array_length && e->left->type == TYPE_STRING)
        return e->left; /* texture(name[0]): a channel of a file */
    if (!e->left->array_length) {
        compile_error(k->c, &e->at, "'%.64s' is not an array", e->name);
        return fail(e);
    }
    e->symbol = e->left->symbol;
    e->type = e->left->type;
    return e;
}

static struct ast_expression *check_tuple(struct checker *k, struct ast_expression *e) {
    for (struct ast_expression **a = &e->arguments; *a; a = &(*a)->next) {
        struct ast_expression *next = (*a)->next;
        *a = check_as(k, *a, TYPE_FLOAT);
        (*a)->next = next;
    }
    e->type = e->argument_count == 16 ? TYPE_MATRIX : TYPE_TRIPLE;
    return e;
}

static struct ast_expression *check_unary(struct checker *k, struct ast_expression *e,
                                          enum ast_type wanted) {
    if (e->token == '!') {
        e->left = check_as(k, e->left, TYPE_BOOL);
        e->type = TYPE_BOOL;
        return e;
    }
    e->left = check_expression(k, e->left, wanted);
    if (e->left->type == TYPE_BOOL)
        e->left = check_convert(k, e->left, TYPE_FLOAT);
    if (e->left->type == TYPE_ERROR)
        return fail(e);
    if ((e->left->type != TYPE_FLOAT && !ast_type_is_triple(e->left->type) &&
         !ast_type_is_fixed(e->left->type)) ||
        e->left->array_length) {
        compile_error(k->c, &e->at, "cannot change the sign of %s", ast_type_name(e->left->type));
        return fail(e);
    }
    e->type = e->left->type;
    if (e->token == '-' && ast_type_is_fixed(e->type))
        e->type = fixed_negated_type(e->type);
    return e->token == '+' ? e->left : e;
}

/* The type of a sum, difference, product or quotient; TYPE_ERROR when there is none. */
static enum ast_type arithmetic_type(int token, enum ast_type a, enum ast_type b) {
    if (a == TYPE_FLOAT && b == TYPE_FLOAT)
        return TYPE_FLOAT;
    if (ast_type_is_fixed(a) && ast_type_is_fixed(b))
        return fixed_arithmetic_type(token, a, b);
    if (token == '%')
        return TYPE_ERROR;
    if (a == TYPE_MATRIX || b == TYPE_MATRIX) {
        bool is_fine =
            (token == '*' || token == '/') && (a == b || a == TYPE_FLOAT || b == TYPE_FLOAT);
        return is_fine ? TYPE_MATRIX : TYPE_ERROR;
    }
    if (a == TYPE_TRIPLE && b == TYPE_FLOAT)
        return TYPE_TRIPLE;
    if (a == TYPE_FLOAT || a == TYPE_TRIPLE)
        return ast_type_is_triple(b) ? b : TYPE_ERROR;
    if (b == TYPE_FLOAT || b == TYPE_TRIPLE)
        return ast_type_is_triple(a) ? a : TYPE_ERROR;
    if (a == TYPE_COLOR && b == TYPE_COLOR)
        return TYPE_COLOR;
    if (!ast_type_is_geometric(a) || !ast_type_is_geometric(b))
        return TYPE_ERROR;
    if (a == TYPE_POINT && b == TYPE_POINT)
        return token == '-' ? TYPE_VECTOR : TYPE_POINT;
    if (a == TYPE_POINT || b == TYPE_POINT)
        return TYPE_POINT;
    return a == b ? a : TYPE_VECTOR;
}

static const char *operator_text(int token, char buffer[24]) {
    return token_kind_name(token, buffer);
}

static struct ast_expression *check_comparison(struct checker *k, struct ast_expression *e) {
    char buffer[24];
    enum ast_type a = e->left->type, b = e->right->type;
    bool is_equality = e->token == TOKEN_EQUAL || e->token == TOKEN_NOT_EQUAL;
    e->type = TYPE_BOOL;
    if (a == TYPE_STRING && b == TYPE_STRING && is_equality)
        return e;
    if (a == TYPE_BOOL)
        e->left = check_convert(k, e->left, a = TYPE_FLOAT);
    if (b == TYPE_BOOL)
        e->right = check_convert(k, e->right, b = TYPE_FLOAT);
    check_fixed_pair(k, &e->left, &e->right);
    a = e->left->type;
    b = e->right->type;
    if ((a == TYPE_FLOAT && b == TYPE_FLOAT) || (ast_type_is_fixed(a) && ast_type_is_fixed(b)))
        return e;
    if (is_equality && arithmetic_type('+', a, b) != TYPE_ERROR) {
        enum ast_type common = arithmetic_type('+', a, b);
        e->left = check_convert(k, e->left, common);
        e->right = check_convert(k, e->right, common);
        return e;
    }
    compile_error(k->c, &e->at, "cannot compare %s and %s with %s", ast_type_name(a),
                  ast_type_name(b), operator_text(e->token, buffer));
    return fail(e);
}

/* Products of vectors: `.` gives a float, `^` a vector. */
static struct ast_expression *check_product(struct checker *k, struct ast_expression *e) {
    e->left =
        check_convert(k, e->left, ast_type_is_triple(e->left->type) ? e->left->type : TYPE_VECTOR);
    e->right = check_convert(k, e->right,
                             ast_type_is_triple(e->right->type) ? e->right->type : TYPE_VECTOR);
    e->type = e->token == '.' ? TYPE_FLOAT : TYPE_VECTOR;
    return e;
}

static struct ast_expression *check_binary(struct checker *k, struct ast_expression *e,
                                           enum ast_type wanted) {
    char buffer[24];
    if (e->token == TOKEN_AND || e->token == TOKEN_OR) {
        e->left = check_as(k, e->left, TYPE_BOOL);
        e->right = check_as(k, e->right, TYPE_BOOL);
        e->type = TYPE_BOOL;
        return e;
    }
    bool is_arithmetic = strchr("+-*/%", e->token < 256 ? e->token : 1) != NULL;
    enum ast_type hint = is_arithmetic ? wanted : TYPE_ERROR;
    if (!is_arithmetic && (e->token == '.' || e->token == '^'))
        hint = TYPE_VECTOR;
    e->left = check_expression(k, e->left, hint);
    e->right = check_expression(k, e->right, hint);
    if (e->left->type == TYPE_ERROR || e->right->type == TYPE_ERROR)
        return fail(e);
    if (e->left->array_length || e->right->array_length) {
        compile_error(k->c, &e->at, "arrays are only used element by element");
        return fail(e);
    }
    if (e->token == '.' || e->token == '^')
        return check_product(k, e);
    if (!is_arithmetic)
        return check_comparison(k, e);
    if (e->left->type == TYPE_BOOL)
        e->left = check_convert(k, e->left, TYPE_FLOAT);
    if (e->right->type == TYPE_BOOL)
        e->right = check_convert(k, e->right, TYPE_FLOAT);
    check_fixed_pair(k, &e->left, &e->right);
    e->type = arithmetic_type(e->token, e->left->type, e->right->type);
    if (e->type == TYPE_ERROR) {
        compile_error(k->c, &e->at, "%s does not work between %s and %s",
                      operator_text(e->token, buffer), ast_type_name(e->left->type),
                      ast_type_name(e->right->type));
        return fail(e);
    }
    if (e->type == TYPE_MATRIX) {
        e->left = check_convert(k, e->left, TYPE_MATRIX);
        e->right = check_convert(k, e->right, TYPE_MATRIX);
    }
    return e;
}

static struct ast_expression *check_conditional(struct checker *k, struct ast_expression *e,
                                                enum ast_type wanted) {
    e->left = check_as(k, e->left, TYPE_BOOL);
    e->right = check_expression(k, e->right, wanted);
    e->third = check_expression(k, e->third, wanted);
    enum ast_type a = e->right->type, b = e->third->type;
    if (a == TYPE_ERROR || b == TYPE_ERROR)
        return fail(e);
    check_fixed_pair(k, &e->right, &e->third);
    a = e->right->type;
    b = e->third->type;
    if (ast_type_is_fixed(a) && ast_type_is_fixed(b))
        e->type = fixed_common_type(a, b);
    else
        e->type = ast_conversion_cost(a, b) >= 0 && !(a != TYPE_TRIPLE && b == TYPE_TRIPLE) ? b : a;
    if (e->type == TYPE_VOID) {
        compile_error(k->c, &e->at, "both sides of '?' must have a value");
        return fail(e);
    }
    e->right = check_convert(k, e->right, e->type);
    e->third = check_convert(k, e->third, e->type);
    return e;
}

void check_written(struct checker *k, struct ast_expression *target) {
    if (target->type == TYPE_ERROR)
        return;
    struct ast_symbol *symbol = target->symbol;
    if ((target->kind != EXPRESSION_NAME && target->kind != EXPRESSION_INDEX) || !symbol) {
        compile_error(k->c, &target->at, "only a variable can be assigned to");
        return;
    }
    if (symbol->is_parameter && !symbol->is_output && !symbol->is_assigned)
        compile_warning(k->c, &target->at,
                        "'%.64s' is a parameter of the shader and not declared output: only this "
                        "shader sees the change",
                        symbol->name);
    if (symbol->global && global_source_in(symbol->global, k->kind) == GLOBAL_LIGHT)
        compile_error(k->c, &target->at, "%s is set by the lights and cannot be changed here",
                      symbol->name);
    symbol->is_assigned = true;
    k->function->has_outputs |= symbol->owner != k->function || symbol->is_output;
}

static struct ast_expression *check_array_assign(struct checker *k, struct ast_expression *e) {
    e->right = check_expression(k, e->right, TYPE_ERROR);
    if (e->right->type != TYPE_ERROR && !check_array_fits(e->right, e->left->symbol)) {
        compile_error(k->c, &e->at,
                      "an array is assigned element by element, or from one of the same type and "
                      "length");
        return fail(e);
    }
    e->type = TYPE_VOID;
    return e;
}

static struct ast_expression *check_assign(struct checker *k, struct ast_expression *e) {
    e->left = check_expression(k, e->left, TYPE_ERROR);
    e->has_effects = true;
    check_written(k, e->left);
    if (e->left->type == TYPE_ERROR) {
        check_expression(k, e->right, TYPE_ERROR);
        return fail(e);
    }
    if (e->left->array_length && !e->token)
        return check_array_assign(k, e);
    if (e->left->array_length) {
        compile_error(k->c, &e->at, "arrays are only changed element by element");
        return fail(e);
    }
    e->type = e->left->type;
    if (!e->token) {
        e->right = check_as(k, e->right, e->type);
        return e;
    }
    e->right = check_expression(k, e->right, e->type);
    if (e->right->type == TYPE_BOOL)
        e->right = check_convert(k, e->right, TYPE_FLOAT);
    if (e->right->type == TYPE_ERROR)
        return fail(e);
    if (ast_type_is_fixed(e->type))
        check_fixed_number(e->right);
    if (ast_type_is_fixed(e->right->type) && !ast_type_is_fixed(e->type))
        e->right = check_convert(k, e->right, TYPE_FLOAT);
    enum ast_type left = e->type; /* a fixed-point target of float arithmetic is converted twice */
    if (ast_type_is_fixed(left) && !ast_type_is_fixed(e->right->type))
        left = TYPE_FLOAT;
    enum ast_type result = arithmetic_type(e->token, left, e->right->type);
    if (e->type == TYPE_STRING || result == TYPE_ERROR || e->right->array_length ||
        ast_conversion_cost(result, e->type) < 0) {
        compile_error(k->c, &e->at, "'%c=' does not work between %s and %s", e->token,
                      ast_type_name(e->type), ast_type_name(e->right->type));
        return fail(e);
    }
    if (e->type == TYPE_MATRIX)
        e->right = check_convert(k, e->right, TYPE_MATRIX);
    return e;
}

bool color_space_is_known(const char *name) {
    static const char *const names[] = {"rgb", "hsv", "hsl", "YIQ", "xyz"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(names[i], name))
            return true;
    return false;
}

static struct ast_expression *check_cast(struct checker *k, struct ast_expression *e) {
    e->left = check_expression(k, e->left, e->type);
    enum ast_type from = e->left->type;
    if (from == TYPE_ERROR || e->type == TYPE_ERROR || e->type == TYPE_VOID) {
        if (from != TYPE_ERROR)
            compile_error(k->c, &e->at, "there are no values of this type");
        return fail(e);
    }
    if (e->left->array_length == 3 && ast_type_is_triple(e->type) &&
        (from == TYPE_FLOAT || ast_type_is_fixed(from)))
        e->left = check_convert(k, e->left, e->type);
    bool is_fine = ast_conversion_cost(from, e->type) >= 0 ||
                   (ast_type_is_triple(from) && ast_type_is_triple(e->type));
    if (!is_fine || e->left->array_length) {
        compile_error(k->c, &e->at, "cannot make %s from %s%s", ast_type_name(e->type),
                      e->left->array_length ? "an array of " : "", ast_type_name(from));
        return fail(e);
    }
    if (e->name && !ast_type_is_triple(e->type) && e->type != TYPE_MATRIX) {
        compile_error(k->c, &e->at, "a %s is in no space", ast_type_name(e->type));
        return fail(e);
    }
    if (e->name && e->type == TYPE_COLOR && !color_space_is_known(e->name)) {
        compile_error(k->c, &e->at, "unknown color space \"%.64s\"; there are " COLOR_SPACES,
                      e->name);
        return fail(e);
    }
    return e;
}

static struct ast_expression *check_any(struct checker *k, struct ast_expression *e,
                                        enum ast_type wanted) {
    switch (e->kind) {
    case EXPRESSION_NUMBER:
        e->type = TYPE_FLOAT;
        return e;
    case EXPRESSION_STRING:
        e->type = TYPE_STRING;
        return e;
    case EXPRESSION_NAME:
        return check_name(k, e);
    case EXPRESSION_INDEX:
        return check_index(k, e);
    case EXPRESSION_TUPLE:
        return check_tuple(k, e);
    case EXPRESSION_UNARY:
        return check_unary(k, e, wanted);
    case EXPRESSION_BINARY:
        return check_binary(k, e, wanted);
    case EXPRESSION_CONDITIONAL:
        return check_conditional(k, e, wanted);
    case EXPRESSION_ASSIGN:
        return check_assign(k, e);
    case EXPRESSION_CAST:
        return check_cast(k, e);
    case EXPRESSION_CALL:
        return check_call(k, e, wanted);
    case EXPRESSION_CONVERT:
        return e;
    }
    return e;
}

struct ast_expression *check_expression(struct checker *k, struct ast_expression *e,
                                        enum ast_type wanted) {
    e = check_any(k, e, wanted);
    const struct ast_expression *const parts[] = {e->left, e->right, e->third};
    for (int i = 0; i < 3; i++)
        e->has_effects |= parts[i] && parts[i]->has_effects;
    for (const struct ast_expression *a = e->arguments; a; a = a->next)
        e->has_effects |= a->has_effects;
    return e;
}
