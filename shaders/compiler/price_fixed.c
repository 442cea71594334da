/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/ir.h"

/* What fixed-point operations cost the array (PF table 2, by the bytes of their operands): an
 * addition goes byte by byte over its result, a product or quotient pairs every byte of one operand
 * with every byte of the other. Comparisons, copies, shifts and changes of sign are priced as
 * additions (ours). */

static int operand_bytes(const struct ir_node *node, int i) {
    const enum ir_type type = ir_operand_type(&node->operands[i]);
    return type == IR_FIXED ? fixed_bytes(ir_operand_format(&node->operands[i])) : 4;
}

static void add_additions(uint32_t *operations, int count, int bytes) {
    operations[SIMD_FIXED_ADD_BASE] += (uint32_t)count;
    operations[SIMD_FIXED_ADD_BYTE] += (uint32_t)(count * bytes);
}

static int larger(int a, int b) {
    return a > b ? a : b;
}

/* A table 2 entry for 16 bits and one for 32; longer roots take as many of the latter as pairs of
 * 4 bytes they hold. */
static void add_roots(uint32_t *operations, int bytes) {
    if (bytes <= 2)
        operations[SIMD_FIXED16_SQRT]++;
    else
        operations[SIMD_FIXED32_SQRT] += (uint32_t)((bytes + 3) / 4 * ((bytes + 3) / 4));
}

void price_fixed(const struct ir_node *node, uint32_t *operations) {
    const struct ir_variable *result = node->results[0];
    const int bytes = result->type == IR_FIXED ? fixed_bytes(result->format) : 0;
    switch (node->operation) {
    case IR_FIXED_MULTIPLY:
        operations[SIMD_FIXED_MULTIPLY_BYTE2] +=
            (uint32_t)(operand_bytes(node, 0) * operand_bytes(node, 1));
        break;
    case IR_FIXED_DIVIDE:
    case IR_FIXED_REMAINDER:
        operations[SIMD_FIXED_DIVIDE_BYTE2] +=
            (uint32_t)(operand_bytes(node, 0) * operand_bytes(node, 1));
        break;
    case IR_FIXED_MIN:
    case IR_FIXED_MAX: /* compare, conditional copy */
        add_additions(operations, 2, bytes);
        break;
    case IR_FIXED_SQRT:
        add_roots(operations, operand_bytes(node, 0));
        break;
    case IR_FIXED_NOISE1:
    case IR_FIXED_NOISE2:
    case IR_FIXED_NOISE3:
        operations[SIMD_FIXED16_NOISE]++;
        break;
    case IR_FIXED_FROM_FLOAT:
    case IR_FIXED_TO_FLOAT: /* align or normalise, as a float is rounded to a whole number */
        operations[SIMD_FLOAT_FLOOR]++;
        break;
    case IR_FIXED_LESS:
    case IR_FIXED_LESS_EQUAL:
    case IR_FIXED_EQUAL:
    case IR_FIXED_NOT_EQUAL:
        add_additions(operations, 1, larger(operand_bytes(node, 0), operand_bytes(node, 1)));
        break;
    default:
        add_additions(operations, 1, bytes);
    }
}
