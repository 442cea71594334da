/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include "shaders/compiler/call_sites.h"

const struct source_location *lower_at(struct lowering *l, const struct source_location *at) {
    return l->site ? l->site : at;
}

void lower_deeper(struct lowering *l, const struct source_location *at, int depth) {
    l->depth += depth;
    if (l->depth > INLINE_DEPTH_MAX)
        compile_limit(l->c, lower_at(l, at),
                      "calls and operators are nested too deep once functions are inlined");
}

enum ir_type lower_type(enum ast_type type) {
    return type == TYPE_BOOL         ? IR_BOOL
           : type == TYPE_STRING     ? IR_STRING
           : ast_type_is_fixed(type) ? IR_FIXED
                                     : IR_FLOAT;
}

struct ir_variable *lower_temporary(struct lowering *l, enum ir_type type) {
    struct ir_variable *variable = ir_variable_new(l->ir, l->list, type, NULL);
    variable->is_temporary = true;
    variable->is_declared_uniform = type == IR_STRING;
    return variable;
}

struct ir_operand lower_operate(struct lowering *l, const struct source_location *at,
                                enum ir_operation operation, struct ir_operand a,
                                struct ir_operand b, struct ir_operand d) {
    struct ir_node *node = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, lower_at(l, at));
    node->operation = operation;
    node->call_site = call_site_of(l, node);
    node->is_fast = node->call_site && node->call_site->about.is_fast;
    node->operands[0] = a;
    node->operands[1] = b;
    node->operands[2] = d;
    node->results[0] = lower_temporary(l, ir_letter_type(ir_operations[operation].types[0], NULL));
    return ir_of(node->results[0]);
}

struct ir_operand lower_unary(struct lowering *l, const struct source_location *at,
                              enum ir_operation op, struct ir_operand a) {
    return lower_operate(l, at, op, a, (struct ir_operand){0}, (struct ir_operand){0});
}

static bool is_number(const struct ir_operand *operand, float number) {
    return operand->kind == OPERAND_FLOAT && operand->number == number;
}

/* Leaves out what cannot change the value: x * 1, x / 1, x - 0, and conditions known beforehand. */
struct ir_operand lower_binary(struct lowering *l, const struct source_location *at,
                               enum ir_operation op, struct ir_operand a, struct ir_operand b) {
    if ((op == IR_MULTIPLY || op == IR_DIVIDE) && is_number(&b, 1))
        return a;
    if (op == IR_MULTIPLY && is_number(&a, 1))
        return b;
    if (op == IR_AND && a.kind == OPERAND_BOOL)
        return a.truth ? b : a;
    if (op == IR_AND && b.kind == OPERAND_BOOL)
        return b.truth ? a : b;
    return lower_operate(l, at, op, a, b, (struct ir_operand){0});
}

struct ir_operand lower_dot(struct lowering *l, const struct source_location *at,
                            const struct ir_value *a, const struct ir_value *b) {
    struct ir_operand sum = lower_binary(l, at, IR_MULTIPLY, a->part[0], b->part[0]);
    for (int i = 1; i < 3; i++)
        sum = lower_binary(l, at, IR_ADD, sum,
                           lower_binary(l, at, IR_MULTIPLY, a->part[i], b->part[i]));
    return sum;
}

struct ir_value lower_cross(struct lowering *l, const struct source_location *at,
                            const struct ir_value *a, const struct ir_value *b) {
    struct ir_value value = {.count = 3};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        value.part[i] = lower_binary(l, at, IR_SUBTRACT,
                                     lower_binary(l, at, IR_MULTIPLY, a->part[j], b->part[k]),
                                     lower_binary(l, at, IR_MULTIPLY, a->part[k], b->part[j]));
    }
    return value;
}

struct ir_operand lower_length(struct lowering *l, const struct source_location *at,
                               const struct ir_value *a) {
    return lower_unary(l, at, IR_SQRT, lower_dot(l, at, a, a));
}

struct ir_value lower_each(struct lowering *l, const struct source_location *at,
                           enum ir_operation op, const struct ir_value *a,
                           const struct ir_value *b) {
    struct ir_value value = {.count = a->count > b->count ? a->count : b->count};
    for (int i = 0; i < value.count; i++)
        value.part[i] =
            lower_binary(l, at, op, a->part[a->count == 1 ? 0 : i], b->part[b->count == 1 ? 0 : i]);
    return value;
}

struct ir_value lower_normalize(struct lowering *l, const struct source_location *at,
                                const struct ir_value *a) {
    struct ir_value length = {.count = 1, .part = {lower_length(l, at, a)}};
    return lower_each(l, at, IR_DIVIDE, a, &length);
}

struct ir_value lower_constant(float number, int count) {
    struct ir_value value = {.count = count};
    for (int i = 0; i < count; i++)
        value.part[i] = ir_float(number);
    return value;
}

void lower_move(struct lowering *l, const struct source_location *at, struct ir_variable *to,
                struct ir_operand from) {
    if (from.kind == OPERAND_VARIABLE && from.variable == to)
        return;
    struct ir_node *node = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, lower_at(l, at));
    static const enum ir_operation moves[] = {
        [IR_FLOAT] = IR_MOVE,
        [IR_BOOL] = IR_MOVE_BOOL,
        [IR_STRING] = IR_MOVE_STRING,
        [IR_FIXED] = IR_MOVE_FIXED,
    };
    node->operation = moves[to->type];
    node->operands[0] = from;
    node->results[0] = to;
}

void lower_assign(struct lowering *l, const struct source_location *at, const struct ir_value *to,
                  const struct ir_value *from) {
    if (to->array_length) { /* a matrix, or of the same element type */
        lower_matrix_copy(l, at, to, from);
        return;
    }
    struct ir_value safe = *from;
    for (int i = 1; i < to->count; i++)
        for (int j = 0; j < i; j++)
            if (safe.part[i].kind == OPERAND_VARIABLE &&
                safe.part[i].variable == to->part[j].variable) {
                struct ir_variable *copy = lower_temporary(l, safe.part[i].variable->type);
                copy->format = safe.part[i].variable->format;
                lower_move(l, at, copy, safe.part[i]);
                safe.part[i] = ir_of(copy);
            }
    for (int i = 0; i < to->count; i++)
        lower_move(l, at, to->part[i].variable, safe.part[from->count == 1 ? 0 : i]);
}

struct ir_value lower_variables(struct lowering *l, const struct source_location *at,
                                enum ast_type type, int array_length, const char *name,
                                enum ast_storage storage) {
    if (type == TYPE_MATRIX)
        array_length = 16 * (array_length ? array_length : 1);
    struct ir_value value = {.count = type == TYPE_VOID ? 0 : ast_type_width(type),
                             .array_length = array_length};
    l->ir->array_floats += array_length > 0 ? array_length * value.count : 0;
    if (l->ir->array_floats > ARRAY_FLOATS_MAX)
        compile_limit(l->c, lower_at(l, at), "the arrays of this shader hold more than %d floats",
                      ARRAY_FLOATS_MAX);
    if (type == TYPE_STRING && array_length > 0) {
        value.strings = compilation_get(l->c, (size_t)array_length * sizeof *value.strings);
        for (int i = 0; i < array_length; i++) {
            value.strings[i] = ir_of(ir_variable_new(l->ir, l->scope, IR_STRING, name));
            value.strings[i].variable->is_declared_uniform = true;
        }
        return value;
    }
    for (int i = 0; i < value.count; i++) {
        struct ir_variable *variable = ir_variable_new(l->ir, l->scope, lower_type(type), name);
        variable->array_length = array_length;
        if (ast_type_is_fixed(type))
            variable->format = ast_type_format(type);
        variable->is_declared_uniform = storage == STORAGE_UNIFORM || type == TYPE_STRING;
        variable->is_forced_varying = storage == STORAGE_VARYING;
        value.part[i] = ir_of(variable);
    }
    return value;
}

struct ir_node *lower_control(struct lowering *l, enum ir_node_kind kind,
                              const struct source_location *at) {
    int depth = 0;
    for (const struct ir_list *list = l->list; list->owner; list = list->owner->list)
        depth++;
    if (depth >= CONTROL_DEPTH_MAX)
        compile_limit(l->c, lower_at(l, at),
                      "control flow is nested more than %d deep after inlining", CONTROL_DEPTH_MAX);
    struct ir_node *node = ir_node_new(l->ir, l->list, kind, lower_at(l, at));
    node->body = ir_list_new(l->ir, node);
    return node;
}
