/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/emit.h"
#include "shaders/compiler/fold.h"

#include <inttypes.h>

/* Calls of vector_fixed.h (vx_ in vectors, sx_ in scalars) with formats as constants. An operand is
 * brought to the exponent of the result, the operation works on whole numbers, and the result is
 * cut to its size. */

struct call {
    struct emitter *e;
    const struct ir_node *node;
    bool is_vector;
    const char *prefix; /* "vx" or "sx" */
};

void emit_fixed_constant(struct emitter *e, int64_t raw) {
    if (raw == INT64_MIN)
        emit_text(e, "INT64_MIN");
    else
        emit_text(e, "INT64_C(%" PRId64 ")", raw);
}

static struct fixed_format format_of(const struct call *c, int i) {
    return ir_operand_format(&c->node->operands[i]);
}

static void operand(const struct call *c, int i) {
    emit_operand(c->e, &c->node->operands[i], c->is_vector);
}

/* The operand with another exponent, rounded down. */
static void shifted(const struct call *c, int i, int exponent) {
    const struct fixed_format from = format_of(c, i);
    if (from.exponent == exponent) {
        operand(c, i);
        return;
    }
    emit_text(c->e, "%s_shift(", c->prefix);
    operand(c, i);
    emit_text(c->e, ", %d, %d)", exponent - from.exponent, from.is_unsigned);
}

static void two_shifted(const struct call *c, const char *function, int exponent) {
    emit_text(c->e, "%s_%s(", c->prefix, function);
    shifted(c, 0, exponent);
    emit_text(c->e, ", ");
    shifted(c, 1, exponent);
    emit_text(c->e, ")");
}

static void multiply(const struct call *c, struct fixed_format result) {
    const struct fixed_format a = format_of(c, 0), b = format_of(c, 1);
    const int places = a.exponent + b.exponent - result.exponent;
    emit_text(c->e, places > 0 ? "%s_multiply_wide(" : "%s_multiply(", c->prefix);
    operand(c, 0);
    if (places > 0)
        emit_text(c->e, ", %d", a.is_unsigned);
    emit_text(c->e, ", ");
    operand(c, 1);
    if (places > 0)
        emit_text(c->e, ", %d, %d", b.is_unsigned, places);
    emit_text(c->e, ")");
}

static int larger(int a, int b) {
    return a > b ? a : b;
}

static void divide(const struct call *c, struct fixed_format result) {
    const struct fixed_format a = format_of(c, 0), b = format_of(c, 1);
    const int places = result.exponent - a.exponent + b.exponent;
    emit_text(c->e, "%s_divide(", c->prefix);
    operand(c, 0);
    emit_text(c->e, ", %d, ", a.is_unsigned);
    operand(c, 1);
    emit_text(c->e, ", %d, %d", b.is_unsigned, places);
    if (c->is_vector)
        emit_text(c->e, ", %d", larger(a.size + larger(places, 0), b.size));
    emit_text(c->e, ")");
}

static void remainder_of(const struct call *c, struct fixed_format result) {
    const struct fixed_format a = format_of(c, 0), b = format_of(c, 1);
    const int a_places = result.exponent - a.exponent, b_places = result.exponent - b.exponent;
    emit_text(c->e, "%s_remainder(", c->prefix);
    operand(c, 0);
    emit_text(c->e, ", %d, %d, ", a.is_unsigned, a_places);
    operand(c, 1);
    emit_text(c->e, ", %d, %d", b.is_unsigned, b_places);
    if (c->is_vector)
        emit_text(c->e, ", %d", larger(a.size + larger(a_places, 0), b.size + larger(b_places, 0)));
    emit_text(c->e, ")");
}

static void root(const struct call *c, struct fixed_format result) {
    const struct fixed_format a = format_of(c, 0);
    const int places = 2 * result.exponent - a.exponent;
    emit_text(c->e, "%s_sqrt(", c->prefix);
    operand(c, 0);
    emit_text(c->e, ", %d, %d", a.is_unsigned, places);
    if (c->is_vector)
        emit_text(c->e, ", %d", a.size + places);
    emit_text(c->e, ")");
}

/* A condition: a mask of 32-bit lanes, or a truth. */
static void comparison(const struct call *c, const char *function, bool is_swapped,
                       bool is_negated) {
    const int first = is_swapped ? 1 : 0, second = 1 - first;
    const struct fixed_format a = format_of(c, first), b = format_of(c, second);
    emit_text(c->e, "%s%s%s_%s(", is_negated ? (c->is_vector ? "~" : "!") : "",
              c->is_vector ? "vx_condition(" : "(int)(", c->prefix, function);
    operand(c, first);
    emit_text(c->e, ", %d, %d, ", a.exponent, a.is_unsigned);
    operand(c, second);
    emit_text(c->e, ", %d, %d))", b.exponent, b.is_unsigned);
}

/* select(condition, a, b) of operands in the format of the result. */
static void choose(const struct call *c, struct fixed_format result, int first) {
    const bool is_extreme = c->node->operation != IR_FIXED_SELECT;
    emit_text(c->e, "%s_select(", c->prefix);
    if (is_extreme)
        comparison(c, "less", c->node->operation == IR_FIXED_MAX, false);
    else
        operand(c, 0);
    emit_text(c->e, ", ");
    shifted(c, first, result.exponent);
    emit_text(c->e, ", ");
    shifted(c, first + 1, result.exponent);
    emit_text(c->e, ")");
}

static void rounded(const struct call *c, const char *function) {
    const struct fixed_format a = format_of(c, 0);
    if (a.exponent <= 0) {
        operand(c, 0);
        return;
    }
    emit_text(c->e, "%s_%s(", c->prefix, function);
    operand(c, 0);
    emit_text(c->e, ", %d, %d)", a.exponent, a.is_unsigned);
}

static void to_float(const struct call *c, int i) {
    const struct fixed_format a = format_of(c, i);
    emit_text(c->e, "%s_to_float(", c->prefix);
    operand(c, i);
    emit_text(c->e, ", %d, %d, %d)", a.exponent, a.size, a.is_unsigned);
}

static void noise(const struct call *c) {
    const int count = (int)c->node->operation - IR_FIXED_NOISE1 + 1;
    const int exponent = fixed_noise_exponent(c->node->operands, count);
    emit_text(c->e, "%s_noise(", c->prefix);
    for (int i = 0; i < 3; i++) {
        if (i < count)
            shifted(c, i, exponent);
        else
            emit_text(c->e, c->is_vector ? "(vx){0}" : "0");
        emit_text(c->e, ", ");
    }
    emit_text(c->e, "%d)", exponent);
}

/* The whole number before it is cut to the result's size. */
static void uncut(const struct call *c, struct fixed_format result) {
    switch (c->node->operation) {
    case IR_FIXED_ADD:
        two_shifted(c, "add", result.exponent);
        break;
    case IR_FIXED_SUBTRACT:
        two_shifted(c, "subtract", result.exponent);
        break;
    case IR_FIXED_MULTIPLY:
        multiply(c, result);
        break;
    case IR_FIXED_DIVIDE:
        divide(c, result);
        break;
    case IR_FIXED_REMAINDER:
        remainder_of(c, result);
        break;
    case IR_FIXED_MIN:
    case IR_FIXED_MAX:
        choose(c, result, 0);
        break;
    case IR_FIXED_SELECT:
        choose(c, result, 1);
        break;
    case IR_FIXED_NEGATE:
        emit_text(c->e, c->is_vector ? "vx_subtract((vx){0}, " : "sx_subtract(0, ");
        shifted(c, 0, result.exponent);
        emit_text(c->e, ")");
        break;
    case IR_FIXED_ABS:
        if (format_of(c, 0).is_unsigned) {
            operand(c, 0);
            break;
        }
        emit_text(c->e, "%s_abs(", c->prefix);
        operand(c, 0);
        emit_text(c->e, ")");
        break;
    case IR_FIXED_CEIL:
        rounded(c, "ceil");
        break;
    case IR_FIXED_ROUND:
        rounded(c, "round");
        break;
    case IR_FIXED_SQRT:
        root(c, result);
        break;
    default: /* a move or conversion */
        shifted(c, 0, result.exponent);
    }
}

void emit_fixed(struct emitter *e, const struct ir_node *node, bool is_vector) {
    const struct call call = {e, node, is_vector, is_vector ? "vx" : "sx"}, *c = &call;
    const struct fixed_format result = node->results[0]->format;
    switch (node->operation) {
    case IR_MOVE_FIXED:
        operand(c, 0);
        break;
    case IR_FIXED_FROM_FLOAT:
        emit_text(e, "%s_from_float(", c->prefix);
        operand(c, 0);
        emit_text(e, ", %d, %d, %d)", result.exponent, result.size, result.is_unsigned);
        break;
    case IR_FIXED_TO_FLOAT:
        to_float(c, 0);
        break;
    case IR_FIXED_NOISE1:
    case IR_FIXED_NOISE2:
    case IR_FIXED_NOISE3:
        noise(c);
        break;
    case IR_FIXED_LESS:
        comparison(c, "less", false, false);
        break;
    case IR_FIXED_LESS_EQUAL:
        comparison(c, "less", true, true);
        break;
    case IR_FIXED_EQUAL:
        comparison(c, "equal", false, false);
        break;
    case IR_FIXED_NOT_EQUAL:
        comparison(c, "equal", false, true);
        break;
    default:
        emit_text(e, "%s_wrap(", c->prefix);
        uncut(c, result);
        emit_text(e, ", %d, %d)", result.size, result.is_unsigned);
    }
}
