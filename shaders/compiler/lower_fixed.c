/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

/* Fixed-point expressions: every operation gets a result of the format that its rule gives
 * (fixed_format.h), and conversions cut it to what the context wants. */

struct ir_operand lower_fixed(struct lowering *l, const struct source_location *at,
                              enum ir_operation operation, struct fixed_format format,
                              struct ir_operand a, struct ir_operand b, struct ir_operand d) {
    struct ir_operand result = lower_operate(l, at, operation, a, b, d);
    result.variable->format = format;
    return result;
}

static const struct ir_operand none;

struct ir_operand lower_fixed_number(float number) {
    int64_t raw;
    const struct fixed_format format = fixed_of_number(number, &raw);
    return ir_fixed(raw, format);
}

struct ir_operand lower_fixed_binary(struct lowering *l, const struct source_location *at,
                                     int token, struct ir_operand a, struct ir_operand b) {
    const struct fixed_format x = ir_operand_format(&a), y = ir_operand_format(&b);
    switch (token) {
    case '+':
        return lower_fixed(l, at, IR_FIXED_ADD, fixed_result(FIXED_ADD, x, y), a, b, none);
    case '-':
        return lower_fixed(l, at, IR_FIXED_SUBTRACT, fixed_result(FIXED_SUBTRACT, x, y), a, b,
                           none);
    case '*':
        return lower_fixed(l, at, IR_FIXED_MULTIPLY, fixed_result(FIXED_MULTIPLY, x, y), a, b,
                           none);
    case '/':
        return lower_fixed(l, at, IR_FIXED_DIVIDE, fixed_result(FIXED_DIVIDE, x, y), a, b, none);
    default:
        return lower_fixed(l, at, IR_FIXED_REMAINDER, fixed_result(FIXED_REMAINDER, x, y), a, b,
                           none);
    }
}

struct ir_operand lower_fixed_negate(struct lowering *l, const struct source_location *at,
                                     struct ir_operand a) {
    const struct fixed_format x = ir_operand_format(&a);
    return lower_fixed(l, at, IR_FIXED_NEGATE, fixed_result(FIXED_NEGATE, x, x), a, none, none);
}

struct ir_operand lower_fixed_convert(struct lowering *l, const struct source_location *at,
                                      struct ir_operand a, enum ast_type type) {
    const enum ir_type from = ir_operand_type(&a);
    if (!ast_type_is_fixed(type))
        return lower_unary(l, at, IR_FIXED_TO_FLOAT, a);
    const struct fixed_format format = ast_type_format(type);
    if (from == IR_BOOL)
        return lower_fixed(l, at, IR_FIXED_SELECT, format, a, lower_fixed_number(1),
                           lower_fixed_number(0));
    if (from == IR_FLOAT)
        return lower_fixed(l, at, IR_FIXED_FROM_FLOAT, format, a, none, none);
    if (fixed_same(ir_operand_format(&a), format))
        return a;
    return lower_fixed(l, at, IR_FIXED_CONVERT, format, a, none, none);
}

static struct ir_operand extreme(struct lowering *l, const struct source_location *at,
                                 enum ir_operation op, struct ir_operand a, struct ir_operand b) {
    return lower_fixed(l, at, op,
                       fixed_result(FIXED_COMMON, ir_operand_format(&a), ir_operand_format(&b)), a,
                       b, none);
}

static struct ir_operand one_operand(struct lowering *l, const struct source_location *at,
                                     enum ir_operation op, enum fixed_rule rule,
                                     struct ir_operand a) {
    const struct fixed_format x = ir_operand_format(&a);
    return lower_fixed(l, at, op, fixed_result(rule, x, x), a, none, none);
}

static struct ir_operand less(struct lowering *l, const struct source_location *at,
                              struct ir_operand a, struct ir_operand b) {
    return lower_binary(l, at, IR_FIXED_LESS, a, b);
}

static struct ir_operand sign(struct lowering *l, const struct source_location *at,
                              struct ir_operand a) {
    const struct fixed_format format = {2, 0, false};
    const struct ir_operand zero = lower_fixed_number(0);
    struct ir_operand above = lower_fixed(l, at, IR_FIXED_SELECT, format, less(l, at, zero, a),
                                          lower_fixed_number(1), zero);
    return lower_fixed(l, at, IR_FIXED_SELECT, format, less(l, at, a, zero), lower_fixed_number(-1),
                       above);
}

struct ir_operand lower_fixed_call(struct lowering *l, const struct ast_expression *e,
                                   const struct ir_operand *a, int count) {
    const struct source_location *at = &e->at;
    struct ir_operand result = a[0];
    switch (e->builtin->id) {
    case BUILTIN_MOD:
        return lower_fixed_binary(l, at, '%', a[0], a[1]);
    case BUILTIN_ABS:
        return one_operand(l, at, IR_FIXED_ABS, FIXED_ABSOLUTE, a[0]);
    case BUILTIN_SIGN:
        return sign(l, at, a[0]);
    case BUILTIN_FLOOR:
        return one_operand(l, at, IR_FIXED_CONVERT, FIXED_FLOOR, a[0]);
    case BUILTIN_CEIL:
        return one_operand(l, at, IR_FIXED_CEIL, FIXED_CEIL, a[0]);
    case BUILTIN_ROUND:
        return one_operand(l, at, IR_FIXED_ROUND, FIXED_CEIL, a[0]);
    case BUILTIN_SQRT:
        return one_operand(l, at, IR_FIXED_SQRT, FIXED_SQRT, a[0]);
    case BUILTIN_STEP: /* 0 below the limit, 1 from there on */
        return lower_fixed(l, at, IR_FIXED_SELECT, (struct fixed_format){1, 0, true},
                           less(l, at, a[1], a[0]), lower_fixed_number(0), lower_fixed_number(1));
    case BUILTIN_MIX: {
        struct ir_operand rest = lower_fixed_binary(l, at, '-', lower_fixed_number(1), a[2]);
        return lower_fixed_binary(l, at, '+', lower_fixed_binary(l, at, '*', a[0], rest),
                                  lower_fixed_binary(l, at, '*', a[1], a[2]));
    }
    case BUILTIN_NOISE:
        return lower_fixed(l, at, (enum ir_operation)(IR_FIXED_NOISE1 + count - 1),
                           (struct fixed_format){15, 14, true}, a[0], count > 1 ? a[1] : none,
                           count > 2 ? a[2] : none);
    case BUILTIN_CLAMP:
        return extreme(l, at, IR_FIXED_MIN, extreme(l, at, IR_FIXED_MAX, a[0], a[1]), a[2]);
    default:
        for (int i = 1; i < count; i++)
            result = extreme(l, at, e->builtin->id == BUILTIN_MIN ? IR_FIXED_MIN : IR_FIXED_MAX,
                             result, a[i]);
        return result;
    }
}

void lower_array_convert(struct lowering *l, const struct source_location *at, enum ast_type type,
                         const struct ir_value *to, int length, enum ast_type from_type,
                         const struct ir_value *from) {
    if (from->array_length && lower_array_elements(from_type, from) != length) {
        compile_error(l->c, lower_at(l, at), "an array of %d cannot be copied from one of %d",
                      length, lower_array_elements(from_type, from));
        return;
    }
    for (int element = 0; element < length; element++) {
        struct ir_value one = {.count = 1, .part = {from->part[element % 3]}};
        if (!ast_type_is_triple(from_type) || from->array_length)
            one = lower_array_load(l, at, from_type, from, ir_float((float)element));
        if (ast_type_is_fixed(type) || (ast_type_is_fixed(from_type) && !ast_type_is_fixed(type)))
            one.part[0] = lower_fixed_convert(l, at, one.part[0], type);
        lower_array_store(l, at, type, to, ir_float((float)element), &one);
    }
}
