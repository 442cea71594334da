/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* The top-down pass over the sizes of fixed-point results (PF section 6.3.2): bits of a temporary
 * that nobody needs go. Results wrap, so the low n bits of a sum, difference or product follow from
 * the low bits of the operands: cutting the high ones changes no value that is kept. Whatever looks
 * at the whole number (comparisons, quotients, roots, conversions to float) needs all bits, and a
 * conversion from float keeps its size, at the ends of which it stops instead of wrapping. */

enum { WHOLE = FIXED_SIZE_MAX };

/* Bits of an operand shifted `left` to become the low `size` bits of something. */
static int bits_below(int size, int left) {
    const int bits = size - left;
    return bits < 1 ? 1 : bits;
}

/* How many low bits of operand `i` the node looks at. */
static int demand(const struct ir_node *node, int i) {
    const struct ir_operand *operand = &node->operands[i];
    const struct ir_variable *result = node->results[0];
    if (node->kind != NODE_INSTRUCTION || !result || result->type != IR_FIXED)
        return WHOLE;
    const struct fixed_format from = ir_operand_format(operand), to = result->format;
    const int left = to.exponent - from.exponent;
    switch (node->operation) {
    case IR_MOVE_FIXED:
        return to.size;
    case IR_FIXED_ADD:
    case IR_FIXED_SUBTRACT:
    case IR_FIXED_NEGATE:
    case IR_FIXED_CONVERT:
    case IR_FIXED_SELECT:
        return bits_below(to.size, left);
    case IR_FIXED_MULTIPLY: {
        const struct fixed_format other = ir_operand_format(&node->operands[1 - i]);
        return from.exponent + other.exponent == to.exponent ? to.size : WHOLE;
    }
    default:
        return WHOLE;
    }
}

static void look_at(struct ir_node *node) {
    const int count = node->kind == NODE_INSTRUCTION ? ir_operand_count(node->operation) : 0;
    for (int i = 0; i < count; i++) {
        const struct ir_operand *operand = &node->operands[i];
        if (operand->kind != OPERAND_VARIABLE || operand->variable->type != IR_FIXED)
            continue;
        const int bits = demand(node, i);
        if (bits > operand->variable->demanded_bits)
            operand->variable->demanded_bits = bits;
    }
}

static void shrink(const struct ir_node *node, struct ir_variable *variable) {
    if (node->operation != IR_FIXED_FROM_FLOAT && variable && variable->type == IR_FIXED &&
        variable->is_temporary && variable->demanded_bits &&
        variable->demanded_bits < variable->format.size)
        variable->format.size = (int16_t)variable->demanded_bits;
}

struct collected_nodes {
    struct ir_node **nodes;
    size_t count;
};

static void collect(struct ir_node *node, void *context) {
    struct collected_nodes *all = context;
    all->nodes[all->count++] = node;
}

/* Uses come after definitions, so one pass from the end settles all temporaries. */
void pass_fixed_sizes(struct ir_program *ir) {
    struct collected_nodes all = {0};
    all.nodes = compilation_get(ir->c, (size_t)(ir->instruction_count + 1) * sizeof *all.nodes);
    ir_each_node(ir->top, collect, &all);
    for (size_t i = all.count; i-- > 0;) {
        for (int r = 0; r < 3; r++)
            shrink(all.nodes[i], all.nodes[i]->results[r]);
        look_at(all.nodes[i]);
    }
}
