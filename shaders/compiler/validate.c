/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/ir.h"

#include <stdio.h>

/* The rules of ir.h, checked after every pass: cheap next to compiling the C, and a broken rule is
 * named here and not found as a wrong pixel. */

struct validation {
    struct ir_program *ir;
    const char *after;
    bool is_storage_known;
};

static _Noreturn void broken(struct validation *v, const struct ir_node *node, const char *rule) {
    v->ir->c->code = STATUS_INTERNAL;
    compile_limit(v->ir->c, node->at, "internal error after %s, in %s: %s", v->after,
                  node->kind == NODE_INSTRUCTION ? ir_operations[node->operation].name
                                                 : "control flow",
                  rule);
}

static bool is_visible(const struct ir_variable *variable, const struct ir_node *node) {
    for (const struct ir_list *list = node->list; list;
         list = list->owner ? list->owner->list : NULL)
        if (list == variable->home || (list->owner && list->owner->test == variable->home))
            return true;
    return false;
}

static void check_operand(struct validation *v, struct ir_node *node,
                          const struct ir_operand *operand, char wanted) {
    enum ir_type type = ir_letter_type(wanted, node->array);
    if (operand->kind == OPERAND_NONE)
        broken(v, node, "an operand is missing");
    if (ir_operand_type(operand) != type)
        broken(v, node, "an operand has the wrong type");
    if (type == IR_FIXED && !ir_operand_format(operand).size)
        broken(v, node, "a fixed-point operand has no format");
    if (operand->kind != OPERAND_VARIABLE)
        return;
    if (operand->variable->array_length)
        broken(v, node, "an array is used as a scalar");
    if (!is_visible(operand->variable, node))
        broken(v, node, "a variable is read outside of its list");
}

static void check_result(struct validation *v, struct ir_node *node, struct ir_variable *variable) {
    if (!is_visible(variable, node))
        broken(v, node, "a variable is written outside of its list");
    if (!v->is_storage_known || variable->is_varying)
        return;
    if (ir_instruction_reads_varying(node))
        broken(v, node, "a uniform variable gets a varying value");
    for (const struct ir_list *list = node->list; list->owner && list != variable->home;
         list = list->owner->list)
        if (list->owner->is_varying && list->owner->test != variable->home)
            broken(v, node, "a uniform variable is written in varying control flow");
}

static void check_instruction(struct validation *v, struct ir_node *node) {
    const struct ir_operation_info *info = &ir_operations[node->operation];
    bool is_array = node->operation == IR_ARRAY_LOAD || node->operation == IR_ARRAY_STORE;
    for (int i = 0; info->types[i + 1]; i++)
        check_operand(v, node, &node->operands[i], info->types[i + 1]);
    if (is_array && (!node->array || !node->array->array_length || !is_visible(node->array, node)))
        broken(v, node, "there is no array");
    if (ir_operation_is_external(node->operation) != (node->external != NULL))
        broken(v, node, "an external function is missing or too many");
    if (node->operation == IR_ARRAY_STORE)
        check_result(v, node, node->array);
    for (int i = 0; i < 3; i++) {
        if (!node->results[i])
            continue;
        enum ir_type type = ir_letter_type(info->types[0], node->array);
        if (type == IR_FIXED && !node->results[i]->format.size)
            broken(v, node, "a fixed-point result has no format");
        if (info->types[0] == '0' || (i && info->types[0] != '3') ||
            node->results[i]->type != type || node->results[i]->array_length)
            broken(v, node, "a result has the wrong type");
        check_result(v, node, node->results[i]);
    }
}

static void check_node(struct ir_node *node, void *context) {
    struct validation *v = context;
    if (node->kind == NODE_INSTRUCTION) {
        check_instruction(v, node);
        return;
    }
    if (!node->body || node->body->owner != node ||
        (node->otherwise && node->otherwise->owner != node))
        broken(v, node, "a list does not know its owner");
    if (node->kind == NODE_LOOP && (!node->test || node->test->owner != node))
        broken(v, node, "a loop has no test");
    if (node->kind == NODE_ILLUMINANCE && node->condition.kind == OPERAND_NONE)
        return;
    if (ir_operand_type(&node->condition) != IR_BOOL || node->condition.kind == OPERAND_NONE)
        broken(v, node, "a condition is not one");
    if (v->is_storage_known && ir_operand_is_varying(&node->condition) && !node->is_varying)
        broken(v, node, "control flow with a varying condition is taken for uniform");
}

void ir_validate(struct ir_program *ir, const char *after, bool is_storage_known) {
    struct validation v = {ir, after, is_storage_known};
    ir_each_node(ir->top, check_node, &v);
}
