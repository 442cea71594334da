/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <string.h>

struct arguments {
    int count;
    struct ir_value *value; /* not on the stack, which calls inside each other share */
    struct ast_expression **expression;
};

static struct ir_value scalar(struct ir_operand operand) {
    return (struct ir_value){.count = 1, .part = {operand}};
}

static struct ir_operand op1(struct lowering *l, const struct ast_expression *e,
                             enum ir_operation op, struct ir_operand a) {
    return lower_unary(l, &e->at, op, a);
}

static struct ir_operand op2(struct lowering *l, const struct ast_expression *e,
                             enum ir_operation op, struct ir_operand a, struct ir_operand b) {
    return lower_binary(l, &e->at, op, a, b);
}

/* mod(a, b) = a - b floor(a / b) */
struct ir_operand lower_mod(struct lowering *l, const struct source_location *at,
                            struct ir_operand a, struct ir_operand b) {
    struct ir_operand whole = lower_unary(l, at, IR_FLOOR, lower_binary(l, at, IR_DIVIDE, a, b));
    return lower_binary(l, at, IR_SUBTRACT, a, lower_binary(l, at, IR_MULTIPLY, b, whole));
}

static struct ir_operand lower_sign(struct lowering *l, const struct ast_expression *e,
                                    struct ir_operand a) {
    struct ir_operand below = op2(l, e, IR_LESS, a, ir_float(0)),
                      above = op2(l, e, IR_LESS, ir_float(0), a);
    struct ir_operand rest = lower_operate(l, &e->at, IR_SELECT, above, ir_float(1), ir_float(0));
    return lower_operate(l, &e->at, IR_SELECT, below, ir_float(-1), rest);
}

/* mix(a, b, f) = a (1 - f) + b f, so that f = 1 gives b exactly */
static struct ir_value lower_mix(struct lowering *l, const struct ast_expression *e,
                                 const struct ir_value *value) {
    struct ir_value one = lower_constant(1, value[2].count);
    struct ir_value rest = lower_each(l, &e->at, IR_SUBTRACT, &one, &value[2]);
    struct ir_value a = lower_each(l, &e->at, IR_MULTIPLY, &value[0], &rest);
    struct ir_value b = lower_each(l, &e->at, IR_MULTIPLY, &value[1], &value[2]);
    return lower_each(l, &e->at, IR_ADD, &a, &b);
}

/* With a direction of reference the sign of -incident . reference decides, without one the vector's
 * own. */
static struct ir_value lower_faceforward(struct lowering *l, const struct ast_expression *e,
                                         const struct arguments *a) {
    struct ir_operand along = lower_dot(l, &e->at, &a->value[1], &a->value[a->count == 3 ? 2 : 0]);
    struct ir_operand turns = op2(l, e, IR_LESS, ir_float(0), along);
    struct ir_value result = {.count = 3};
    for (int i = 0; i < 3; i++)
        result.part[i] =
            lower_operate(l, &e->at, IR_SELECT, turns, op1(l, e, IR_NEGATE, a->value[0].part[i]),
                          a->value[0].part[i]);
    return result;
}

/* comp(c, i): the nearest component when i is out of range */
static struct ir_operand lower_comp(struct lowering *l, const struct ast_expression *e,
                                    const struct ir_value *value, struct ir_operand index) {
    if (index.kind == OPERAND_FLOAT)
        return value->part[index.number >= 2 ? 2 : index.number >= 1 ? 1 : 0];
    struct ir_operand is_second = op2(l, e, IR_LESS_EQUAL, ir_float(1), index);
    struct ir_operand is_third = op2(l, e, IR_LESS_EQUAL, ir_float(2), index);
    struct ir_operand first =
        lower_operate(l, &e->at, IR_SELECT, is_second, value->part[1], value->part[0]);
    return lower_operate(l, &e->at, IR_SELECT, is_third, value->part[2], first);
}

/* The value with component `index`, the one that comp() would take, replaced by `number`. */
static struct ir_value replace_component(struct lowering *l, const struct ast_expression *e,
                                         const struct ir_value *old, struct ir_operand index,
                                         struct ir_operand number) {
    struct ir_value changed = *old;
    if (index.kind == OPERAND_FLOAT) {
        changed.part[index.number >= 2 ? 2 : index.number >= 1 ? 1 : 0] = number;
        return changed;
    }
    struct ir_operand is_second = op2(l, e, IR_LESS_EQUAL, ir_float(1), index);
    struct ir_operand is_third = op2(l, e, IR_LESS_EQUAL, ir_float(2), index);
    struct ir_operand second = lower_operate(l, &e->at, IR_SELECT, is_second, number, old->part[1]);
    changed.part[0] = lower_operate(l, &e->at, IR_SELECT, is_second, old->part[0], number);
    changed.part[1] = lower_operate(l, &e->at, IR_SELECT, is_third, old->part[1], second);
    changed.part[2] = lower_operate(l, &e->at, IR_SELECT, is_third, number, old->part[2]);
    return changed;
}

/* setxcomp(v, x), setcomp(v, i, x) and setcomp(m, row, column, x) */
static struct ir_value lower_setcomp(struct lowering *l, const struct ast_expression *e,
                                     int fixed) {
    struct lower_target target = lower_target_open(l, e->arguments);
    struct ir_value a[4];
    int count = 1;
    for (struct ast_expression *x = e->arguments->next; x; x = x->next)
        a[count++] = lower_operand(l, x, x->next);
    a[0] = lower_target_read(l, &target);
    if (a[0].array_length) {
        lower_matrix_builtin(l, e, a);
        if (target.is_element)
            lower_target_write(l, &target, &a[0]);
        return lower_constant(0, 1);
    }
    struct ir_operand index = fixed >= 0 ? ir_float((float)fixed) : a[1].part[0];
    struct ir_value changed = replace_component(l, e, &a[0], index, a[count - 1].part[0]);
    lower_target_write(l, &target, &changed);
    return lower_constant(0, 1);
}

static struct ir_operand space_of(struct lowering *l, const struct arguments *a, int i) {
    if (a->expression[i]->kind == EXPRESSION_STRING)
        return lower_space(l, &a->expression[i]->at, a->expression[i]->name);
    return a->value[i].part[0];
}

static struct ir_value lower_spaces(struct lowering *l, const struct ast_expression *e,
                                    const struct arguments *a, enum ast_type type) {
    struct ir_operand from = a->count == 3 ? space_of(l, a, 0) : ir_string(SHADER_SPACE_CURRENT);
    struct ir_operand to = space_of(l, a, a->count - 2);
    return lower_transform(l, &e->at, type, &from, &to, &a->value[a->count - 1]);
}

static struct ir_value lower_ambient(struct lowering *l, const struct ast_expression *e) {
    struct ir_value result = {.count = 3};
    struct ir_operand none = {0};
    if (l->kind != SHADER_KIND_SURFACE && l->kind != SHADER_KIND_VOLUME)
        compile_error(l->c, lower_at(l, &e->at), "ambient() belongs into a surface shader");
    for (int i = 0; i < 3; i++) {
        result.part[i] = lower_operate(l, &e->at, IR_AMBIENT, none, none, none);
        l->list->last->index = i;
    }
    return result;
}

/* min, max of two and more; clamp(x, low, high) = min(max(x, low), high) */
static struct ir_value lower_extreme(struct lowering *l, const struct ast_expression *e,
                                     const struct arguments *a, enum ir_operation op) {
    struct ir_value result = a->value[0];
    for (int i = 1; i < a->count; i++)
        result = lower_each(l, &e->at, op, &result, &a->value[i]);
    return result;
}

static struct ir_value lower_one_float(struct lowering *l, const struct ast_expression *e,
                                       const struct arguments *a) {
    struct ir_operand x = a->value[0].part[0], y = a->count > 1 ? a->value[1].part[0] : x;
    switch (e->builtin->id) {
    case BUILTIN_RADIANS:
        return scalar(op2(l, e, IR_MULTIPLY, x, ir_float(0x1.1df46ap-6f)));
    case BUILTIN_DEGREES:
        return scalar(op2(l, e, IR_MULTIPLY, x, ir_float(0x1.ca5dc2p+5f)));
    case BUILTIN_SIN:
        return scalar(op1(l, e, IR_SIN, x));
    case BUILTIN_COS:
        return scalar(op1(l, e, IR_COS, x));
    case BUILTIN_TAN:
        return scalar(op1(l, e, IR_TAN, x));
    case BUILTIN_ASIN:
        return scalar(op1(l, e, IR_ASIN, x));
    case BUILTIN_ACOS:
        return scalar(op1(l, e, IR_ACOS, x));
    case BUILTIN_ATAN:
        return scalar(a->count == 2 ? op2(l, e, IR_ATAN2, x, y) : op1(l, e, IR_ATAN, x));
    case BUILTIN_POW:
        return scalar(op2(l, e, IR_POW, x, y));
    case BUILTIN_EXP:
        return scalar(op1(l, e, IR_EXP, x));
    case BUILTIN_SQRT:
        return scalar(op1(l, e, IR_SQRT, x));
    case BUILTIN_INVERSESQRT:
        return scalar(op2(l, e, IR_DIVIDE, ir_float(1), op1(l, e, IR_SQRT, x)));
    case BUILTIN_LOG:
        x = op1(l, e, IR_LOG, x);
        return scalar(a->count == 2 ? op2(l, e, IR_DIVIDE, x, op1(l, e, IR_LOG, y)) : x);
    case BUILTIN_MOD:
        return scalar(lower_mod(l, &e->at, x, y));
    case BUILTIN_ABS:
        return scalar(op1(l, e, IR_ABS, x));
    case BUILTIN_SIGN:
        return scalar(lower_sign(l, e, x));
    case BUILTIN_FLOOR:
        return scalar(op1(l, e, IR_FLOOR, x));
    case BUILTIN_CEIL:
        return scalar(op1(l, e, IR_CEIL, x));
    case BUILTIN_ROUND:
        return scalar(op1(l, e, IR_ROUND, x));
    case BUILTIN_STEP: /* step(limit, x): 0 below the limit, 1 from there on */
        return scalar(lower_operate(l, &e->at, IR_SELECT, op2(l, e, IR_LESS, y, x), ir_float(0),
                                    ir_float(1)));
    default:
        return lower_constant(0, ast_type_width(e->type));
    }
}

/* Functions that look at their arguments themselves; false: this is none of them. */
static bool lower_special(struct lowering *l, struct ast_expression *e, struct ir_value *value) {
    switch (e->builtin->id) {
    case BUILTIN_SPLINE:
        *value = lower_spline(l, e);
        return true;
    case BUILTIN_CONCAT:
    case BUILTIN_FORMAT:
    case BUILTIN_MATCH:
        *value = lower_text_builtin(l, e);
        return true;
    case BUILTIN_OPTION:
    case BUILTIN_ATTRIBUTE:
    case BUILTIN_RENDERERINFO:
        *value = lower_question(l, e);
        return true;
    case BUILTIN_DEPTH:
        *value = lower_depth(l, e);
        return true;
    case BUILTIN_LIGHTSOURCE:
    case BUILTIN_SURFACE:
    case BUILTIN_DISPLACEMENT:
    case BUILTIN_ATMOSPHERE:
    case BUILTIN_INCIDENT:
    case BUILTIN_OPPOSITE:
        *value = lower_message(l, e);
        return true;
    case BUILTIN_SETXCOMP:
    case BUILTIN_SETYCOMP:
    case BUILTIN_SETZCOMP:
        *value = lower_setcomp(l, e, (int)e->builtin->id - BUILTIN_SETXCOMP);
        return true;
    case BUILTIN_SETCOMP:
        *value = lower_setcomp(l, e, -1);
        return true;
    default:
        return false;
    }
}

/* What has no value of its own: neutral, or an error. */
static struct ir_value lower_nothing(const struct ast_expression *e, float neutral) {
    return e->type == TYPE_STRING ? scalar(ir_string(shader_string_identity("")))
                                  : lower_constant(neutral, ast_type_width(e->type));
}

struct ir_value lower_builtin(struct lowering *l, struct ast_expression *e) {
    struct arguments a = {0};
    struct ir_value difference;
    float neutral;
    if (builtin_neutral(e->builtin->id, &neutral))
        return lower_nothing(e, neutral);
    if (builtin_refusal(e->builtin->id)) {
        compile_error(l->c, lower_at(l, &e->at), "%s() is not supported: %s", e->name,
                      builtin_refusal(e->builtin->id));
        return lower_nothing(e, 0);
    }
    if (lower_special(l, e, &difference))
        return difference;
    a.value = compilation_get(l->c, (size_t)(e->argument_count + 1) * sizeof *a.value);
    a.expression = compilation_get(l->c, (size_t)(e->argument_count + 1) * sizeof *a.expression);
    for (struct ast_expression *x = e->arguments; x; x = x->next) {
        a.expression[a.count] = x;
        a.value[a.count++] = lower_operand(l, x, x->next);
    }
    if (ast_type_is_fixed(e->type)) {
        struct ir_operand *operands =
            compilation_get(l->c, (size_t)(a.count + 1) * sizeof *operands);
        for (int i = 0; i < a.count; i++)
            operands[i] = a.value[i].part[0];
        return scalar(lower_fixed_call(l, e, operands, a.count));
    }
    if (a.count && a.value[0].array_length)
        return lower_matrix_builtin(l, e, a.value);
    switch (e->builtin->id) {
    case BUILTIN_MIN:
        return lower_extreme(l, e, &a, IR_MIN);
    case BUILTIN_MAX:
        return lower_extreme(l, e, &a, IR_MAX);
    case BUILTIN_CLAMP:
        difference = lower_each(l, &e->at, IR_MAX, &a.value[0], &a.value[1]);
        return lower_each(l, &e->at, IR_MIN, &difference, &a.value[2]);
    case BUILTIN_MIX:
        return lower_mix(l, e, a.value);
    case BUILTIN_NOISE:
    case BUILTIN_CELLNOISE:
    case BUILTIN_PNOISE:
    case BUILTIN_RANDOM:
        return lower_noise(l, e, a.value, a.count);
    case BUILTIN_XCOMP:
        return scalar(a.value[0].part[0]);
    case BUILTIN_YCOMP:
        return scalar(a.value[0].part[1]);
    case BUILTIN_ZCOMP:
        return scalar(a.value[0].part[2]);
    case BUILTIN_COMP:
        return scalar(lower_comp(l, e, &a.value[0], a.value[1].part[0]));
    case BUILTIN_DU:
    case BUILTIN_DV:
    case BUILTIN_DERIV:
    case BUILTIN_AREA:
    case BUILTIN_CALCULATENORMAL:
    case BUILTIN_FILTERWIDTH:
    case BUILTIN_FILTERWIDTHP:
    case BUILTIN_FILTERSTEP:
        return lower_derivative(l, e, a.value, a.count);
    case BUILTIN_LENGTH:
        return scalar(lower_length(l, &e->at, &a.value[0]));
    case BUILTIN_NORMALIZE:
        return lower_normalize(l, &e->at, &a.value[0]);
    case BUILTIN_DISTANCE:
        difference = lower_each(l, &e->at, IR_SUBTRACT, &a.value[0], &a.value[1]);
        return scalar(lower_length(l, &e->at, &difference));
    case BUILTIN_FACEFORWARD:
        return lower_faceforward(l, e, &a);
    case BUILTIN_TRANSFORM:
        return lower_spaces(l, e, &a, TYPE_POINT);
    case BUILTIN_VTRANSFORM:
        return lower_spaces(l, e, &a, TYPE_VECTOR);
    case BUILTIN_NTRANSFORM:
        return lower_spaces(l, e, &a, TYPE_NORMAL);
    case BUILTIN_CTRANSFORM:
        return lower_ctransform(l, e, a.value, a.count);
    case BUILTIN_AMBIENT:
        return lower_ambient(l, e);
    default:
        return lower_one_float(l, e, &a);
    }
}
