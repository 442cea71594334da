/* SPDX-License-Identifier: Apache-2.0 */
#define SHADER_WIDTH 4
#include "shaders/compiler/fold.h"
#include "shaders/compiler/passes.h"

#include "shaders/simd/vector_math.h"

/* Constant folding: an instruction on constants becomes a move of its result, a control flow whose
 * condition is known becomes the side that is taken. Values are computed by the functions that
 * generated code calls, so nothing changes by a bit. */

/* X(NAME, value from x, y, z) for operations on floats; those with a fast version apart. */
#define FLOAT_FOLDS(X)                                                                             \
    X(ADD, x + y)                                                                                  \
    X(SUBTRACT, x - y)                                                                             \
    X(MULTIPLY, x *y)                                                                              \
    X(DIVIDE, x / y)                                                                               \
    X(NEGATE, -x)                                                                                  \
    X(ABS, sf_abs(x))                                                                              \
    X(MIN, sf_min(x, y))                                                                           \
    X(MAX, sf_max(x, y))                                                                           \
    X(FLOOR, sf_floor(x))                                                                          \
    X(CEIL, sf_ceil(x))                                                                            \
    X(ROUND, sf_round(x))                                                                          \
    X(SQRT, sf_sqrt(x))                                                                            \
    X(NOISE1, sf_noise1(x))                                                                        \
    X(NOISE2, sf_noise2(x, y))                                                                     \
    X(NOISE3, sf_noise3(x, y, z))
#define FLOAT_FUNCTION_FOLDS_1(X)                                                                  \
    X(SIN, sin)                                                                                    \
    X(COS, cos) X(TAN, tan) X(ASIN, asin) X(ACOS, acos) X(ATAN, atan) X(EXP, exp) X(LOG, log)
#define FLOAT_FUNCTION_FOLDS_2(X) X(ATAN2, atan2) X(POW, pow)
#define COMPARISON_FOLDS(X) X(LESS, <) X(LESS_EQUAL, <=) X(EQUAL, ==) X(NOT_EQUAL, !=)

static bool is_constant(const struct ir_operand *operand) {
    return operand->kind != OPERAND_VARIABLE && operand->kind != OPERAND_NONE;
}

static bool all_constant(const struct ir_node *node) {
    const int count = ir_operand_count(node->operation);
    for (int i = 0; i < count; i++)
        if (!is_constant(&node->operands[i]))
            return false;
    return count > 0;
}

static bool fold_float(const struct ir_node *node, float *result) {
    const struct ir_operand *o = node->operands;
    const float x = o[0].number, y = o[1].number, z = o[2].number;
    switch (node->operation) {
#define FLOAT_CASE(name, value)                                                                    \
    case IR_##name:                                                                                \
        *result = value;                                                                           \
        return true;
        FLOAT_FOLDS(FLOAT_CASE)
#undef FLOAT_CASE
#define FUNCTION_CASE_1(name, function)                                                            \
    case IR_##name:                                                                                \
        *result = node->is_fast ? sf_##function##_fast(x) : sf_##function(x);                      \
        return true;
        FLOAT_FUNCTION_FOLDS_1(FUNCTION_CASE_1)
#undef FUNCTION_CASE_1
#define FUNCTION_CASE_2(name, function)                                                            \
    case IR_##name:                                                                                \
        *result = node->is_fast ? sf_##function##_fast(x, y) : sf_##function(x, y);                \
        return true;
        FLOAT_FUNCTION_FOLDS_2(FUNCTION_CASE_2)
#undef FUNCTION_CASE_2
    case IR_SELECT:
        *result = o[0].truth ? o[1].number : o[2].number;
        return true;
    case IR_FIXED_TO_FLOAT:
        *result = fold_fixed_to_float(&o[0]);
        return true;
    default:
        return false;
    }
}

static bool fold_condition(const struct ir_node *node, bool *result) {
    const struct ir_operand *o = node->operands;
    switch (node->operation) {
#define COMPARISON_CASE(name, operator)                                                            \
    case IR_##name:                                                                                \
        *result = o[0].number operator o[1].number;                                                \
        return true;
        COMPARISON_FOLDS(COMPARISON_CASE)
#undef COMPARISON_CASE
    case IR_AND:
        *result = o[0].truth && o[1].truth;
        return true;
    case IR_OR:
        *result = o[0].truth || o[1].truth;
        return true;
    case IR_NOT:
        *result = !o[0].truth;
        return true;
    case IR_STRING_EQUAL:
        *result = o[0].identity == o[1].identity;
        return true;
    case IR_FIXED_LESS:
    case IR_FIXED_LESS_EQUAL:
    case IR_FIXED_EQUAL:
    case IR_FIXED_NOT_EQUAL:
        *result = fold_fixed_comparison(node->operation, o);
        return true;
    default:
        return false;
    }
}

static bool fold_value(const struct ir_node *node, struct ir_operand *result) {
    float number;
    bool truth;
    const struct ir_variable *to = node->results[0];
    if (to->type == IR_FIXED && ir_operation_is_fixed(node->operation)) {
        *result = ir_fixed(fold_fixed(node->operation, node->operands, to->format), to->format);
        return true;
    }
    if (to->type == IR_FLOAT && fold_float(node, &number)) {
        *result = ir_float(number);
        return number - number == 0; /* what is not finite cannot be written in C */
    }
    if (to->type == IR_BOOL && fold_condition(node, &truth)) {
        *result = ir_bool(truth);
        return true;
    }
    return false;
}

static void fold_instruction(struct ir_node *node) {
    struct ir_operand result;
    if (!node->results[0] || ir_is_move(node) || !all_constant(node) || !fold_value(node, &result))
        return;
    static const enum ir_operation moves[] = {
        [IR_FLOAT] = IR_MOVE, [IR_BOOL] = IR_MOVE_BOOL, [IR_FIXED] = IR_MOVE_FIXED};
    node->operation = moves[node->results[0]->type];
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        node->operands[i] = (struct ir_operand){0};
    node->operands[0] = result;
    node->is_fast = node->is_free = false;
    node->call_site = NULL;
}

static void adopt(struct ir_list *into, struct ir_list *from) {
    for (struct ir_node *node = from->first; node; node = node->next)
        node->list = into;
    for (struct ir_variable *v = from->variables, *next; v; v = next) {
        next = v->next_in_home;
        v->home = into;
        v->next_in_home = into->variables;
        into->variables = v;
    }
}

static void fold_list(struct ir_list *list);

/* What takes the place of control flow with a known condition: the nodes of a list, or none.
 * Returns false when it stays. */
static bool known_side(const struct ir_node *node, struct ir_list **side) {
    if (node->condition.kind != OPERAND_BOOL)
        return false;
    *side = NULL;
    if (node->kind == NODE_IF)
        *side = node->condition.truth ? node->body : node->otherwise;
    else if (node->kind != NODE_LOOP || node->condition.truth || node->test->first)
        return false;
    return true;
}

static void fold_list(struct ir_list *list) {
    struct ir_node **link = &list->first;
    struct ir_node *last = NULL;
    while (*link) {
        struct ir_node *node = *link;
        struct ir_list *side;
        ir_propagate_into(node);
        if (node->kind == NODE_INSTRUCTION)
            fold_instruction(node);
        else if (known_side(node, &side)) {
            if (side && side->first) {
                adopt(list, side);
                side->last->next = node->next;
                *link = side->first;
            } else {
                if (side)
                    adopt(list, side);
                *link = node->next;
            }
            continue;
        } else {
            if (node->test)
                fold_list(node->test);
            if (node->kind == NODE_LOOP)
                ir_propagate_into(node);
            fold_list(node->body);
            if (node->otherwise)
                fold_list(node->otherwise);
        }
        last = node;
        link = &node->next;
    }
    list->last = last;
}

void pass_fold_constants(struct ir_program *ir) {
    ir_prepare_propagation(ir);
    fold_list(ir->top);
}
