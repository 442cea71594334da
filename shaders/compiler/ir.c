/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/ir.h"

#include <string.h>

enum { SIMD_FREE = IR_FREE };

const struct ir_operation_info ir_operations[IR_OPERATION_COUNT] = {
#define IR_ENTRY(name, types, cost, scalar, vector) {#name, types, SIMD_##cost, scalar, vector},
    IR_OPERATIONS(IR_ENTRY)
#undef IR_ENTRY
};

struct ir_list *ir_list_new(struct ir_program *ir, struct ir_node *owner) {
    struct ir_list *list = compilation_get(ir->c, sizeof *list);
    list->owner = owner;
    return list;
}

struct ir_variable *ir_variable_new(struct ir_program *ir, struct ir_list *home, enum ir_type type,
                                    const char *name) {
    struct ir_variable *variable = compilation_get(ir->c, sizeof *variable);
    if (ir->variable_count == ir->variable_capacity) {
        size_t capacity = ir->variable_capacity ? ir->variable_capacity * 2 : 256;
        struct ir_variable **grown = compilation_get(ir->c, capacity * sizeof *grown);
        if (ir->variable_count)
            memcpy(grown, ir->variables, ir->variable_count * sizeof *grown);
        ir->variables = grown;
        ir->variable_capacity = capacity;
    }
    variable->id = (int)ir->variable_count;
    ir->variables[ir->variable_count++] = variable;
    variable->type = type;
    variable->home = home;
    variable->name = name;
    variable->slot = -1;
    variable->is_shared = ir->is_making_shared;
    variable->next_in_home = home->variables;
    home->variables = variable;
    return variable;
}

struct ir_node *ir_node_new(struct ir_program *ir, struct ir_list *list, enum ir_node_kind kind,
                            const struct source_location *at) {
    if (++ir->instruction_count > INSTRUCTION_COUNT_MAX)
        compile_limit(ir->c, at,
                      "the shader has more than %d instructions once functions are inlined",
                      INSTRUCTION_COUNT_MAX);
    struct ir_node *node = compilation_get(ir->c, sizeof *node);
    node->kind = kind;
    node->at = at;
    node->is_shared = ir->is_making_shared;
    node->list = list;
    node->block = node->block_otherwise = node->category = -1;
    if (list->last)
        list->last->next = node;
    else
        list->first = node;
    list->last = node;
    return node;
}

enum ir_type ir_operand_type(const struct ir_operand *operand) {
    switch (operand->kind) {
    case OPERAND_VARIABLE:
        return operand->variable->type;
    case OPERAND_BOOL:
        return IR_BOOL;
    case OPERAND_STRING:
        return IR_STRING;
    case OPERAND_FIXED:
        return IR_FIXED;
    default:
        return IR_FLOAT;
    }
}

struct fixed_format ir_operand_format(const struct ir_operand *operand) {
    return operand->kind == OPERAND_VARIABLE ? operand->variable->format : operand->format;
}

enum ir_type ir_letter_type(char letter, const struct ir_variable *array) {
    switch (letter) {
    case 'b':
        return IR_BOOL;
    case 's':
        return IR_STRING;
    case 'x':
        return IR_FIXED;
    case '*':
        return array ? array->type : IR_FLOAT;
    default:
        return IR_FLOAT;
    }
}

bool ir_list_is_inside(const struct ir_list *list, const struct ir_list *outer) {
    while (list != outer) {
        if (!list->owner)
            return false;
        list = list->owner->list;
    }
    return true;
}

bool ir_instruction_reads_varying(const struct ir_node *node) {
    switch (node->operation) {
    case IR_MATERIAL:
    case IR_POSITION:
    case IR_INCIDENT:
    case IR_AMBIENT:
    case IR_LIGHT_DIRECTION:
    case IR_LIGHT_COLOR:
    case IR_LIGHT_VALUE:
    case IR_LIGHTS_AT:
        return true;
    case IR_ARRAY_LOAD:
        if (node->array->is_varying)
            return true;
        break;
    default:
        break;
    }
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        if (ir_operand_is_varying(&node->operands[i]))
            return true;
    return false;
}

bool ir_instruction_is_varying(const struct ir_node *node) {
    for (int i = 0; i < 3; i++)
        if (node->results[i] && node->results[i]->is_varying)
            return true;
    return node->operation == IR_ARRAY_STORE && node->array->is_varying;
}

void ir_each_node(struct ir_list *list, ir_visit *visit, void *context) {
    if (!list)
        return;
    for (struct ir_node *node = list->first; node; node = node->next) {
        visit(node, context);
        if (node->kind == NODE_INSTRUCTION)
            continue;
        ir_each_node(node->test, visit, context);
        ir_each_node(node->body, visit, context);
        ir_each_node(node->otherwise, visit, context);
    }
}

void ir_each_read(struct ir_node *node, ir_visit_variable *visit, void *context) {
    if (node->kind != NODE_INSTRUCTION) {
        if (node->condition.kind == OPERAND_VARIABLE)
            visit(node->condition.variable, context);
        return;
    }
    for (int i = 0; i < IR_OPERANDS_MAX; i++)
        if (node->operands[i].kind == OPERAND_VARIABLE)
            visit(node->operands[i].variable, context);
    if (node->operation == IR_ARRAY_LOAD)
        visit(node->array, context);
}

void ir_each_write(struct ir_node *node, ir_visit_variable *visit, void *context) {
    if (node->kind != NODE_INSTRUCTION)
        return;
    for (int i = 0; i < 3; i++)
        if (node->results[i])
            visit(node->results[i], context);
    if (node->operation == IR_ARRAY_STORE)
        visit(node->array, context);
}

static bool has_direction(const struct ir_program *ir) {
    return (ir->kind == SHADER_KIND_LIGHT && !ir->is_ambient) ||
           ir->kind == SHADER_KIND_DISPLACEMENT;
}

int ir_results(const struct ir_program *ir, struct ir_variable *results[IR_RESULTS_MAX]) {
    int count = 0;
    for (int i = 0; i < 3; i++)
        results[count++] = ir->color[i];
    for (int i = 0; i < 3 && has_direction(ir); i++)
        results[count++] = ir->direction[i];
    if (ir->kind == SHADER_KIND_LIGHT)
        results[count++] = ir->lit;
    for (int e = 0; e < ir->export_count; e++)
        for (int i = 0; i < ir->exports[e].components; i++)
            results[count++] = ir->exports[e].value[i];
    return count;
}

void ir_set_results(struct ir_program *ir, struct ir_variable *const *results) {
    int count = 0;
    for (int i = 0; i < 3; i++)
        ir->color[i] = results[count++];
    for (int i = 0; i < 3 && has_direction(ir); i++)
        ir->direction[i] = results[count++];
    if (ir->kind == SHADER_KIND_LIGHT)
        ir->lit = results[count++];
}
