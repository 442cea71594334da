/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/check.h"

/* Types of fixed-point expressions (docs/language.md, section 11): a number written out beside a
 * fixed-point value becomes one, exactly; beside a float a fixed-point value becomes a float; two
 * fixed-point values give a fixed-point result whose format keeps everything. */

static bool is_number(const struct ast_expression *e) {
    if (e->kind == EXPRESSION_UNARY && (e->token == '-' || e->token == '+'))
        return is_number(e->left);
    return e->kind == EXPRESSION_NUMBER && e->type == TYPE_FLOAT;
}

static float number_of(const struct ast_expression *e) {
    if (e->kind == EXPRESSION_UNARY)
        return e->token == '-' ? -number_of(e->left) : number_of(e->left);
    return e->number;
}

void check_fixed_number(struct ast_expression *e) {
    int64_t raw;
    if (e->type != TYPE_FLOAT || !is_number(e))
        return;
    e->number = number_of(e);
    e->kind = EXPRESSION_NUMBER;
    e->left = NULL;
    e->type = ast_type_fixed(fixed_of_number(e->number, &raw));
}

void check_fixed_pair(struct checker *k, struct ast_expression **a, struct ast_expression **b) {
    if (!ast_type_is_fixed((*a)->type) && !ast_type_is_fixed((*b)->type))
        return;
    if ((*a)->type == TYPE_BOOL)
        *a = check_convert(k, *a, TYPE_FLOAT);
    if ((*b)->type == TYPE_BOOL)
        *b = check_convert(k, *b, TYPE_FLOAT);
    check_fixed_number(*a);
    check_fixed_number(*b);
    if (ast_type_is_fixed((*a)->type) == ast_type_is_fixed((*b)->type))
        return;
    if (ast_type_is_fixed((*a)->type))
        *a = check_convert(k, *a, TYPE_FLOAT);
    else
        *b = check_convert(k, *b, TYPE_FLOAT);
}

enum ast_type fixed_arithmetic_type(int token, enum ast_type a, enum ast_type b) {
    const enum fixed_rule rule = token == '+'   ? FIXED_ADD
                                 : token == '-' ? FIXED_SUBTRACT
                                 : token == '*' ? FIXED_MULTIPLY
                                 : token == '/' ? FIXED_DIVIDE
                                                : FIXED_REMAINDER;
    return ast_type_fixed(fixed_result(rule, ast_type_format(a), ast_type_format(b)));
}

enum ast_type fixed_common_type(enum ast_type a, enum ast_type b) {
    return ast_type_fixed(fixed_result(FIXED_COMMON, ast_type_format(a), ast_type_format(b)));
}

static enum ast_type one(enum fixed_rule rule, enum ast_type a) {
    const struct fixed_format format = ast_type_format(a);
    return ast_type_fixed(fixed_result(rule, format, format));
}

enum ast_type fixed_negated_type(enum ast_type a) {
    return one(FIXED_NEGATE, a);
}

/* a (1 - t) + b t */
static enum ast_type mix_type(const enum ast_type t[3]) {
    const enum ast_type unity = ast_type_fixed((struct fixed_format){1, 0, true});
    const enum ast_type rest = fixed_arithmetic_type('-', unity, t[2]);
    return fixed_arithmetic_type('+', fixed_arithmetic_type('*', t[0], rest),
                                 fixed_arithmetic_type('*', t[1], t[2]));
}

enum ast_type fixed_call_type(enum builtin_id id, const enum ast_type *types, int count) {
    enum ast_type common = types[0];
    switch (id) {
    case BUILTIN_MOD:
        return fixed_arithmetic_type('%', types[0], types[1]);
    case BUILTIN_ABS:
        return one(FIXED_ABSOLUTE, types[0]);
    case BUILTIN_SIGN:
        return ast_type_fixed((struct fixed_format){2, 0, false});
    case BUILTIN_FLOOR:
        return one(FIXED_FLOOR, types[0]);
    case BUILTIN_CEIL:
    case BUILTIN_ROUND:
        return one(FIXED_CEIL, types[0]);
    case BUILTIN_STEP:
        return ast_type_fixed((struct fixed_format){1, 0, true});
    case BUILTIN_SQRT:
        return one(FIXED_SQRT, types[0]);
    case BUILTIN_MIX:
        return mix_type(types);
    case BUILTIN_NOISE:
        return ast_type_fixed((struct fixed_format){15, 14, true});
    default: /* min, max, clamp */
        for (int i = 1; i < count; i++)
            common = fixed_common_type(common, types[i]);
        return common;
    }
}

/* Arrays as wholes: initial values and assignments copy element by element; a triple is an array of
 * three. How long a parameter of any length is shows where the function is called: lower_array.c.
 */
bool check_array_fits(const struct ast_expression *from, const struct ast_symbol *to) {
    const bool is_numeric = to->type == TYPE_FLOAT || ast_type_is_fixed(to->type);
    if (from->array_length)
        return (from->array_length == to->array_length || from->array_length < 0 ||
                to->array_length < 0) &&
               ast_conversion_cost(from->type, to->type) >= 0;
    return is_numeric && to->array_length == 3 && ast_type_is_triple(from->type);
}
