/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/emit.h"

/* Calls of functions from outside. The module holds a pointer for each, which the loader fills from
 * the object that the command line names (shader_module.h). In the reference, where `float` means
 * double, they still take and give floats. Varying calls are made sample by sample, and only for
 * the samples that take part in the control flow around. */

static void number_function(struct ir_node *node, void *context) {
    struct emitter *e = context;
    if (node->kind == NODE_INSTRUCTION && node->external && !node->external->external_number)
        node->external->external_number = ++e->external_count;
}

/* a0, a1 ..., each with text around it. */
static void emit_parameters(struct emitter *e, int count, const char *before, const char *after) {
    for (int i = 0; i < count; i++)
        emit_text(e, "%s%sa%d%s", i ? ", " : "", before, i, after);
}

struct declaration_state {
    struct emitter *e;
    int declared;
};

static void declare_function(struct ir_node *node, void *context) {
    struct declaration_state *state = context;
    struct emitter *e = state->e;
    if (node->kind != NODE_INSTRUCTION || !node->external ||
        node->external->external_number <= state->declared)
        return;
    const int number = state->declared = node->external->external_number,
              count = ir_operand_count(node->operation);
    emit_text(e, "static shader_external_float (*external_%d)(%s", number, count ? "" : "void");
    emit_parameters(e, count, "shader_external_float ", "");
    emit_text(e, ");\n");
    if (!count)
        return;
    emit_text(e, "SHADER_HELPER vf external_lanes_%d(vi mask, ", number);
    emit_parameters(e, count, "vf ", "");
    emit_text(e,
              ") {\n"
              "    vf result = {0};\n"
              "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
              "        if (mask[i])\n"
              "            result[i] = external_%d(",
              number);
    emit_parameters(e, count, "(shader_external_float)", "[i]");
    emit_text(e, ");\n    return result;\n}\n\n");
}

void emit_externals(struct emitter *e) {
    struct declaration_state state = {e, 0};
    ir_each_node(e->ir->top, number_function, e);
    if (!e->external_count)
        return;
    emit_text(e, "typedef __typeof__(0.0f) shader_external_float;\n");
    ir_each_node(e->ir->top, declare_function, &state);
}

void emit_external_call(struct emitter *e, const struct ir_node *node, bool is_vector) {
    const int count = ir_operand_count(node->operation);
    emit_text(e, "external_%s%d(", is_vector ? "lanes_" : "", node->external->external_number);
    if (is_vector)
        emit_text(e, e->mask >= 0 ? "m%d, " : "vi_set(-1), ", e->mask);
    for (int i = 0; i < count; i++) {
        emit_text(e, i ? ", " : "");
        emit_operand(e, &node->operands[i], is_vector);
    }
    emit_text(e, ")");
}

static void emit_row(struct ir_node *node, void *context) {
    struct declaration_state *state = context;
    if (node->kind != NODE_INSTRUCTION || !node->external ||
        node->external->external_number <= state->declared)
        return;
    state->declared = node->external->external_number;
    emit_text(state->e, "    {");
    emit_quoted(state->e, node->external->name);
    emit_text(state->e, ", (void **)&external_%d},\n", state->declared);
}

void emit_external_table(struct emitter *e) {
    struct declaration_state state = {e, 0};
    emit_text(e, "static const struct shader_external shader_externals[] = {\n");
    ir_each_node(e->ir->top, emit_row, &state);
    emit_text(e, "};\n\n");
}
