/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

/* An instruction on `count` operands: one result for a float, three for what has components. */
static struct ir_value operate(struct lowering *l, const struct ast_expression *e,
                               enum ir_operation one, enum ir_operation three,
                               const struct ir_operand *operands, int count) {
    bool is_float = e->type == TYPE_FLOAT;
    struct ir_value result = {.count = is_float ? 1 : 3};
    result.part[0] = lower_operate(l, &e->at, is_float ? one : three, operands[0],
                                   count > 1 ? operands[1] : (struct ir_operand){0},
                                   count > 2 ? operands[2] : (struct ir_operand){0});
    struct ir_node *node = l->list->last;
    for (int i = 3; i < count; i++)
        node->operands[i] = operands[i];
    for (int i = 1; i < result.count; i++) {
        node->results[i] = lower_temporary(l, IR_FLOAT);
        result.part[i] = ir_of(node->results[i]);
    }
    return result;
}

/* A number per sample and call: the position of the sample and how many calls came before it. */
static struct ir_value lower_random(struct lowering *l, const struct ast_expression *e) {
    struct ir_value result = {.count = ast_type_width(e->type)};
    struct ir_operand none = {0}, x[4];
    if (!l->random_calls)
        l->random_calls = ir_variable_new(l->ir, l->ir->top, IR_FLOAT, NULL);
    for (int i = 0; i < 3; i++) {
        x[i] = lower_operate(l, &e->at, IR_POSITION, none, none, none);
        l->list->last->index = i;
    }
    for (int i = 0; i < result.count; i++) {
        x[3] = lower_binary(l, &e->at, IR_ADD, ir_of(l->random_calls), ir_float(1));
        lower_move(l, &e->at, l->random_calls, x[3]);
        result.part[i] = lower_operate(l, &e->at, IR_RANDOM, x[0], x[1], x[2]);
        l->list->last->operands[3] = x[3];
    }
    return result;
}

struct ir_value lower_noise(struct lowering *l, struct ast_expression *e,
                            const struct ir_value *arguments, int count) {
    static const enum ir_operation one[] = {IR_NOISE1, IR_NOISE2, IR_NOISE3, IR_NOISE4};
    static const enum ir_operation three[] = {IR_NOISE1_3, IR_NOISE2_3, IR_NOISE3_3, IR_NOISE4_3};
    struct ir_operand x[IR_OPERANDS_MAX];
    int dimensions = 0, halves = e->builtin->id == BUILTIN_PNOISE ? 2 : 1;
    if (e->builtin->id == BUILTIN_RANDOM)
        return lower_random(l, e);
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        x[i] = ir_float(0);
    for (int i = 0; i < count / halves; i++)
        for (int c = 0; c < arguments[i].count; c++)
            x[dimensions++] = arguments[i].part[c];
    if (e->builtin->id == BUILTIN_NOISE)
        return operate(l, e, one[dimensions - 1], three[dimensions - 1], x, dimensions);
    if (e->builtin->id == BUILTIN_CELLNOISE)
        return operate(l, e, IR_CELLNOISE, IR_CELLNOISE_3, x, 4);
    int all = dimensions == 4 ? 4 : 3, at = all;
    for (int i = count / 2; i < count; i++)
        for (int c = 0; c < arguments[i].count; c++)
            x[at++] = arguments[i].part[c];
    return operate(l, e, all == 4 ? IR_PNOISE4 : IR_PNOISE3, all == 4 ? IR_PNOISE4_3 : IR_PNOISE3_3,
                   x, 2 * all);
}
