/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* A variable that is only ever a copy of something that does not change is replaced by that
 * something: `normal n = N;` costs no pixel memory and no moves. */

static void count_write(struct ir_variable *variable, void *context) {
    variable->definition_count++;
    variable->definition = context;
}

static void note_read(struct ir_variable *variable, void *context) {
    variable->is_read_early |= variable->definition_count == 0;
}

static void number_node(struct ir_node *node, void *context) {
    int *order = context;
    node->order = ++*order;
    ir_each_read(node, note_read, NULL);
    ir_each_write(node, count_write, node);
}

bool ir_variable_is_settled(const struct ir_variable *variable) {
    return variable->definition_count == 1 && !variable->is_read_early && !variable->array_length &&
           variable->definition->list == variable->home;
}

static bool copied_from(const struct ir_variable *variable, struct ir_operand *source) {
    if (!ir_variable_is_settled(variable) || variable->is_declared_uniform ||
        variable->is_forced_varying)
        return false;
    const struct ir_node *node = variable->definition;
    if (!ir_is_move(node))
        return false;
    *source = node->operands[0];
    if (source->kind != OPERAND_VARIABLE)
        return true;
    const struct ir_variable *from = source->variable;
    return ir_variable_is_settled(from) && from->definition->order < node->order;
}

static void replace(struct ir_operand *operand) {
    struct ir_operand source;
    for (int steps = 0; steps < 1000; steps++) {
        if (operand->kind != OPERAND_VARIABLE || !copied_from(operand->variable, &source))
            return;
        if (source.kind == OPERAND_VARIABLE && !source.variable->called)
            source.variable->called =
                operand->variable->called ? operand->variable->called : operand->variable;
        *operand = source;
    }
}

void ir_propagate_into(struct ir_node *node) {
    if (node->kind != NODE_INSTRUCTION)
        replace(&node->condition);
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        replace(&node->operands[i]);
}

void ir_prepare_propagation(struct ir_program *ir) {
    int order = 0;
    for (size_t i = 0; i < ir->variable_count; i++) {
        ir->variables[i]->definition_count = 0;
        ir->variables[i]->definition = NULL;
        ir->variables[i]->is_read_early = false;
    }
    ir_each_node(ir->top, number_node, &order);
    /* results of the shader start at zero and are read from outside: never settled */
    struct ir_variable *results[IR_RESULTS_MAX];
    int count = ir_results(ir, results);
    for (int i = 0; i < count; i++)
        results[i]->definition_count += 2;
}

static void propagate(struct ir_node *node, void *context) {
    ir_propagate_into(node);
}

void pass_propagate_copies(struct ir_program *ir) {
    ir_prepare_propagation(ir);
    ir_each_node(ir->top, propagate, NULL);
}
