/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/emit.h"

#include <math.h>
#include <string.h>

static void emit_number(struct emitter *e, float number) {
    if (isnan(number) || isinf(number)) /* cannot be written in RSL, but keep the C valid */
        emit_text(e, "(0.0f / 0.0f)");
    else
        emit_text(e, signbit(number) ? "(%af)" : "%af", (double)number);
}

static void emit_scalar(struct emitter *e, const struct ir_operand *operand) {
    switch (operand->kind) {
    case OPERAND_VARIABLE:
        emit_text(e, "v%d", operand->variable->id);
        break;
    case OPERAND_FLOAT:
        emit_number(e, operand->number);
        break;
    case OPERAND_BOOL:
        emit_text(e, "%d", operand->truth ? 1 : 0);
        break;
    case OPERAND_STRING:
        emit_text(e, "%d", (int)operand->identity);
        break;
    case OPERAND_FIXED:
        emit_fixed_constant(e, operand->raw);
        break;
    case OPERAND_NONE:
        break;
    }
}

/* The function that makes a vector of a scalar. */
static const char *broadcast_text(enum ir_type type) {
    return type == IR_BOOL ? "shader_mask(" : type == IR_FIXED ? "vx_set(" : "vf_set(";
}

void emit_operand(struct emitter *e, const struct ir_operand *operand, bool as_vector) {
    if (!as_vector || ir_operand_is_varying(operand)) {
        emit_scalar(e, operand);
        return;
    }
    emit_text(e, "%s", broadcast_text(ir_operand_type(operand)));
    emit_scalar(e, operand);
    emit_text(e, ")");
}

/* Fills in $0 $1 $2 and $F. */
static void emit_pattern(struct emitter *e, const struct ir_node *node, const char *pattern,
                         bool as_vector) {
    for (; *pattern; pattern++) {
        if (*pattern != '$') {
            emit_text(e, "%c", *pattern);
            continue;
        }
        pattern++;
        if (*pattern == 'M' && e->mask >= 0)
            emit_text(e, " & m%d", e->mask);
        if (*pattern == 'M')
            continue;
        if (*pattern == 'F')
            emit_text(e, "%s", node->is_fast ? "_fast" : "");
        else
            emit_operand(e, &node->operands[*pattern - '0'], as_vector);
    }
}

/* Whether samples outside the mask in force must keep the variable's value. */
static bool needs_blend(const struct emitter *e, const struct ir_node *node,
                        const struct ir_variable *v) {
    if (e->mask < 0 || !v->is_varying)
        return false;
    for (const struct ir_list *list = node->list; list != v->home && list->owner;
         list = list->owner->list)
        if (list->owner->is_varying)
            return true;
    return false;
}

/* `v = `, or with a mask `v = select(mask, ` which close_result ends. */
static void open_result(struct emitter *e, const struct ir_node *node,
                        const struct ir_variable *v) {
    for (int i = 0; i < e->indent; i++)
        emit_text(e, "    ");
    emit_text(e, "v%d = ", v->id);
    if (needs_blend(e, node, v))
        emit_text(e, "%s(m%d, ",
                  v->type == IR_BOOL    ? "vi_select"
                  : v->type == IR_FIXED ? "vx_select"
                                        : "vf_select",
                  e->mask);
}

static void close_result(struct emitter *e, const struct ir_node *node,
                         const struct ir_variable *v) {
    if (needs_blend(e, node, v))
        emit_text(e, ", v%d)", v->id);
    emit_text(e, ";\n");
}

static const char *index_text(const struct ir_node *node) {
    return ir_operand_is_varying(&node->operands[0]) ? "lanes" : "one";
}

static void emit_array_load(struct emitter *e, struct ir_node *node) {
    struct ir_variable *result = node->results[0];
    bool is_gather = ir_operand_is_varying(&node->operands[0]);
    bool broadcasts = !is_gather && !node->array->is_varying && result->is_varying;
    open_result(e, node, result);
    if (is_gather) {
        emit_text(e, "shader_load%s_%s_%s(v%d, %d, v%d)",
                  node->array->type == IR_FIXED ? "_fixed" : "", index_text(node),
                  node->array->is_varying ? "varying" : "uniform", node->array->id,
                  node->array->array_length, node->operands[0].variable->id);
    } else {
        emit_text(e, "%sv%d[shader_index(", broadcasts ? broadcast_text(node->array->type) : "",
                  node->array->id);
        emit_operand(e, &node->operands[0], false);
        emit_text(e, ", %d)]%s", node->array->array_length, broadcasts ? ")" : "");
    }
    close_result(e, node, result);
}

static void emit_array_store(struct emitter *e, struct ir_node *node) {
    struct ir_variable *array = node->array;
    for (int i = 0; i < e->indent; i++)
        emit_text(e, "    ");
    if (ir_operand_is_varying(&node->operands[0])) {
        emit_text(e, "shader_store%s_lanes(v%d, %d, v%d, ", array->type == IR_FIXED ? "_fixed" : "",
                  array->id, array->array_length, node->operands[0].variable->id);
        if (needs_blend(e, node, array))
            emit_text(e, "m%d, ", e->mask);
        else
            emit_text(e, "vi_set(-1), ");
        emit_operand(e, &node->operands[1], true);
        emit_text(e, ");\n");
        return;
    }
    if (needs_blend(e, node, array))
        emit_text(e, "shader_store%s_one(&v%d[shader_index(",
                  array->type == IR_FIXED ? "_fixed" : "", array->id);
    else
        emit_text(e, "v%d[shader_index(", array->id);
    emit_operand(e, &node->operands[0], false);
    emit_text(e, ", %d)]", array->array_length);
    if (needs_blend(e, node, array))
        emit_text(e, ", m%d, ", e->mask);
    else
        emit_text(e, " = ");
    emit_operand(e, &node->operands[1], array->is_varying);
    emit_text(e, needs_blend(e, node, array) ? ");\n" : ";\n");
}

/* What comes from outside. */
static bool emit_input(struct emitter *e, struct ir_node *node) {
    struct ir_variable *v = node->results[0];
    int index = node->index;
    if (node->operation < IR_MATERIAL)
        return false;
    open_result(e, node, v);
    bool broadcasts = v->is_varying && !ir_instruction_reads_varying(node);
    if (broadcasts)
        emit_text(e, v->type == IR_BOOL ? "shader_mask(" : "vf_set(");
    switch (node->operation) {
    case IR_MATERIAL:
        emit_text(e, "vf_load(call->material[%d] + at)", node->parameter->map_offset + index);
        break;
    case IR_POSITION:
        emit_text(e, e->in_light ? "vf_load(position[%d])" : "vf_load(call->position[%d] + at)",
                  index);
        break;
    case IR_INCIDENT:
        emit_text(e, "vf_load(call->incident[%d] + at)", index);
        break;
    case IR_BOUND:
        emit_text(e, "bound[%d]", node->parameter->bound_offset + index);
        break;
    case IR_BOUND_STRING:
        emit_text(e, "shader_identity(bound + %d)", node->parameter->bound_offset + index);
        break;
    case IR_GIVEN:
        emit_text(e, "given[%d] != 0", node->parameter->bound_offset);
        break;
    case IR_AMBIENT:
        emit_text(e, "ambient[%d]", index);
        break;
    case IR_LIGHT_DIRECTION:
    case IR_LIGHT_COLOR:
        emit_text(e, "vf_load(light_result + %d * SHADER_WIDTH)",
                  index + (node->operation == IR_LIGHT_COLOR ? 3 : 0));
        break;
    case IR_LIGHT_KNOWS:
        emit_text(e, "this_light->query_offsets[%d] >= 0", index / 3);
        break;
    case IR_LIGHT_VALUE:
        emit_text(e,
                  "(this_light->query_offsets[%d] >= 0 ? vf_load(light_result + "
                  "(this_light->query_offsets[%d] + %d) * SHADER_WIDTH) : vf_set(0.0f))",
                  index / 3, index / 3, index % 3);
        break;
    default:
        emit_text(e, "shader_matrix(matrices, %d, ", node->operation == IR_TO_CAMERA);
        emit_operand(e, &node->operands[0], false);
        emit_text(e, ")[%d]", index);
    }
    if (broadcasts)
        emit_text(e, ")");
    close_result(e, node, v);
    return true;
}

/* Three results of one noise call. */
static void emit_noise(struct emitter *e, struct ir_node *node) {
    bool is_vector = ir_instruction_reads_varying(node);
    int number = e->next_number++;
    emit_line(e, "%s o%d[3];", is_vector ? "vf" : "float", number);
    for (int i = 0; i < e->indent; i++)
        emit_text(e, "    ");
    emit_pattern(e, node,
                 is_vector ? ir_operations[node->operation].vector
                           : ir_operations[node->operation].scalar,
                 is_vector);
    emit_text(e, "o%d);\n", number);
    for (int i = 0; i < 3; i++) {
        struct ir_variable *v = node->results[i];
        if (!v)
            continue;
        bool broadcasts = v->is_varying && !is_vector;
        open_result(e, node, v);
        emit_text(e, broadcasts ? "vf_set(o%d[%d])" : "o%d[%d]", number, i);
        close_result(e, node, v);
    }
}

void emit_instruction(struct emitter *e, struct ir_node *node) {
    const struct ir_operation_info *info = &ir_operations[node->operation];
    if (node->operation == IR_ARRAY_LOAD) {
        emit_array_load(e, node);
        return;
    }
    if (node->operation == IR_ARRAY_STORE) {
        emit_array_store(e, node);
        return;
    }
    if (node->operation == IR_LIGHTS_AT) {
        emit_lights_at(e, node);
        return;
    }
    if (emit_input(e, node))
        return;
    if (info->types[0] == '3') {
        emit_noise(e, node);
        return;
    }
    struct ir_variable *v = node->results[0];
    bool is_vector = ir_instruction_reads_varying(node);
    bool broadcasts = v->is_varying && !is_vector;
    open_result(e, node, v);
    if (broadcasts)
        emit_text(e, "%s", broadcast_text(v->type));
    if (ir_operation_is_fixed(node->operation))
        emit_fixed(e, node, is_vector);
    else if (node->external)
        emit_external_call(e, node, is_vector);
    else
        emit_pattern(e, node, is_vector ? info->vector : info->scalar, is_vector);
    if (broadcasts)
        emit_text(e, ")");
    close_result(e, node, v);
}
