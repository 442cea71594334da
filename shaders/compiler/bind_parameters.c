/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/parameter_precision.h"
#include "shaders/compiler/passes.h"

/* Lays out the transfer map and the bound values: parameters in order of declaration, predefined
 * variables after, each whole or not at all. Then marks what else the program needs from outside.
 */

static void mark_parameter(struct ir_node *node, void *context) {
    struct ir_program *ir = context;
    if (node->kind == NODE_ILLUMINANCE) {
        ir->uses_illuminance = true;
        ir->uses_shared_lights |= node->condition.kind == OPERAND_NONE;
    }
    if (node->kind != NODE_INSTRUCTION)
        return;
    if (node->parameter)
        node->parameter->is_live = true;
    if (node->operation == IR_DIFFERENCE_X || node->operation == IR_DIFFERENCE_Y)
        ir->uses_neighbours = true;
    if (node->operation == IR_TEXT_JOIN || node->operation == IR_TEXT_NUMBER ||
        node->operation == IR_TEXT_MATCH)
        ir->uses_texts = true;
    if (node->operation == IR_AMBIENT)
        ir->uses_ambient = true;
    if (node->operation != IR_FROM_CAMERA && node->operation != IR_TO_CAMERA)
        return;
    int32_t identity = node->operands[0].identity;
    if (node->operands[0].kind != OPERAND_STRING) {
        ir->spaces |= SHADER_SPACES_BY_STRING;
        ir->uses_any_space = true;
    } else if (identity < SHADER_SPACE_COUNT) {
        ir->spaces |= 1u << identity;
    } else {
        for (int i = 0; i < ir->named_space_count; i++)
            if (shader_string_identity(ir->named_spaces[i].name) == identity)
                ir->named_spaces[i].is_used = true;
    }
}

void pass_bind_parameters(struct ir_program *ir) {
    struct shader_program *program = ir->c->program;
    const enum parameter_precision precision =
        ir->c->options ? ir->c->options->parameters : PARAMETERS_FLOAT;
    ir->uses_texts = ir->uses_shared_lights = ir->uses_illuminance = ir->uses_ambient =
        ir->uses_neighbours = false;
    ir->spaces = 0;
    ir_each_node(ir->top, mark_parameter, ir);
    for (int i = 0; i < program->parameter_count; i++) {
        struct shader_parameter *parameter = &program->parameters[i];
        if (!parameter->is_live) {
            parameter->is_material = false;
            continue;
        }
        int *total = parameter->is_material ? &program->material_count : &program->bound_count;
        int *offset = parameter->is_material ? &parameter->map_offset : &parameter->bound_offset;
        *offset = *total;
        *total += parameter->components;
        if (parameter->is_material) {
            if (parameter_precision_applies(parameter))
                parameter->bytes =
                    parameter->components * parameter_precision_bits(precision, parameter) / 8;
            parameter->map_byte = SHADER_ID_BYTES + program->material_bytes;
            program->material_bytes += parameter->bytes;
        }
    }
}
