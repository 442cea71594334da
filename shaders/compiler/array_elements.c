/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* An array of which every access says outright which element it means becomes a variable for each
 * element: matrices, and pfman's points and colours as arrays (PF section 3.1), then cost no more
 * than triples do. */

static bool is_access(const struct ir_node *node) {
    return node->kind == NODE_INSTRUCTION &&
           (node->operation == IR_ARRAY_LOAD || node->operation == IR_ARRAY_STORE);
}

static void find_indexed(struct ir_node *node, void *context) {
    if (is_access(node) && node->operands[0].kind != OPERAND_FLOAT)
        node->array->is_indexed = true;
}

static struct ir_variable *element_of(struct ir_program *ir, struct ir_variable *array,
                                      float index) {
    const int last = array->array_length - 1;
    const int i = !(index > 0) ? 0 : index >= (float)last ? last : (int)index;
    if (!array->elements)
        array->elements =
            compilation_get(ir->c, (size_t)array->array_length * sizeof *array->elements);
    if (!array->elements[i]) {
        struct ir_variable *element = ir_variable_new(ir, array->home, array->type, array->name);
        element->format = array->format;
        element->is_declared_uniform = array->is_declared_uniform;
        element->is_forced_varying = array->is_forced_varying;
        element->declared = array->declared ? array->declared : array;
        array->elements[i] = element;
    }
    return array->elements[i];
}

static void replace(struct ir_node *node, void *context) {
    struct ir_program *ir = context;
    if (!is_access(node) || node->array->is_indexed)
        return;
    struct ir_variable *element = element_of(ir, node->array, node->operands[0].number);
    const struct ir_operand value = node->operands[1];
    static const enum ir_operation moves[] = {
        [IR_FLOAT] = IR_MOVE, [IR_BOOL] = IR_MOVE_BOOL, [IR_FIXED] = IR_MOVE_FIXED};
    node->operands[0] = node->operation == IR_ARRAY_LOAD ? ir_of(element) : value;
    node->operands[1] = (struct ir_operand){0};
    if (node->operation == IR_ARRAY_STORE)
        node->results[0] = element;
    node->operation = moves[element->type];
    node->array = NULL;
}

void pass_array_elements(struct ir_program *ir) {
    ir_each_node(ir->top, find_indexed, ir);
    ir_each_node(ir->top, replace, ir);
}
