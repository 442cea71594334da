/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/fixing.h"

#include <math.h>

static struct range hull(struct range a, struct range b) {
    return (struct range){fmin(a.low, b.low), fmax(a.high, b.high)};
}

static struct range product(struct range a, struct range b) {
    const double corners[4] = {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high};
    struct range result = {INFINITY, -INFINITY};
    for (int i = 0; i < 4; i++) {
        if (isnan(corners[i])) /* zero times what is not known */
            return range_unknown;
        result = hull(result, (struct range){corners[i], corners[i]});
    }
    return result;
}

struct range range_reciprocal(struct range a) {
    if (a.low <= 0 && a.high >= 0)
        return range_unknown;
    return (struct range){1 / a.high, 1 / a.low};
}

struct range fixing_operand_range(const struct range *ranges, const struct ir_operand *operand) {
    if (operand->kind == OPERAND_FLOAT && isfinite(operand->number))
        return (struct range){(double)operand->number, (double)operand->number};
    return operand->kind == OPERAND_VARIABLE ? ranges[operand->variable->id] : range_unknown;
}

static bool is_square(const struct ir_node *node) {
    return node->operands[0].kind == OPERAND_VARIABLE &&
           node->operands[1].kind == OPERAND_VARIABLE &&
           node->operands[0].variable == node->operands[1].variable;
}

static struct range magnitude(struct range a) {
    return (struct range){a.low > 0 ? a.low : a.high < 0 ? -a.high : 0, fmax(-a.low, a.high)};
}

/* Operations that say something of their result whatever goes in. */
static struct range range_of_function(const struct ir_node *node) {
    switch (node->operation) {
    case IR_SIN:
    case IR_COS:
        return (struct range){-1, 1};
    case IR_ASIN:
    case IR_ATAN:
        return (struct range){-1.58, 1.58};
    case IR_ACOS:
        return (struct range){0, 3.15};
    case IR_ATAN2:
        return (struct range){-3.15, 3.15};
    case IR_EXP:
        return (struct range){0, INFINITY};
    case IR_NOISE1:
    case IR_NOISE2:
    case IR_NOISE3:
    case IR_NOISE1_3:
    case IR_NOISE2_3:
    case IR_NOISE3_3:
    case IR_NOISE4:
    case IR_NOISE4_3:
    case IR_PNOISE3:
    case IR_PNOISE3_3:
    case IR_PNOISE4:
    case IR_PNOISE4_3:
    case IR_CELLNOISE:
    case IR_CELLNOISE_3:
        return (struct range){0, 1};
    default:
        return range_unknown;
    }
}

struct range fixing_result_range(const struct range *ranges, const struct ir_node *node) {
    const struct range a = fixing_operand_range(ranges, &node->operands[0]),
                       b = fixing_operand_range(ranges, &node->operands[1]),
                       c = fixing_operand_range(ranges, &node->operands[2]);
    switch (node->operation) {
    case IR_MOVE:
        return a;
    case IR_ADD:
        return (struct range){a.low + b.low, a.high + b.high};
    case IR_SUBTRACT:
        return (struct range){a.low - b.high, a.high - b.low};
    case IR_MULTIPLY:
        return is_square(node) ? product(magnitude(a), magnitude(a)) : product(a, b);
    case IR_DIVIDE:
        return product(a, range_reciprocal(b));
    case IR_NEGATE:
        return (struct range){-a.high, -a.low};
    case IR_ABS:
        return magnitude(a);
    case IR_MIN:
        return (struct range){fmin(a.low, b.low), fmin(a.high, b.high)};
    case IR_MAX:
        return (struct range){fmax(a.low, b.low), fmax(a.high, b.high)};
    case IR_SELECT:
        return hull(b, c);
    case IR_FLOOR:
        return (struct range){floor(a.low), floor(a.high)};
    case IR_CEIL:
    case IR_ROUND:
        return (struct range){floor(a.low), ceil(a.high)};
    case IR_SQRT:
        return (struct range){0, sqrt(fmax(a.high, 0))};
    default:
        return range_of_function(node);
    }
}

struct analysis {
    struct ir_program *ir;
    struct range *ranges;
};

/* Twice what was seen, either way; of uniform values also half. Values that are rounded down may
 * fall a little below a lower bound: what was just above zero may come to lie below, what was zero
 * does not. */
static struct range narrow(const struct ir_program *ir, int id, struct range range) {
    const struct shader_compile_options *options = ir->c->options;
    if (range.low > 0)
        range.low = fmax(0, range.low * 0.99);
    if (id >= options->fixing_count || !options->fixings[id].is_seen)
        return range;
    const struct shader_fixing *seen = &options->fixings[id];
    const double low = (double)seen->lowest, high = (double)seen->highest;
    double most = 2 * fmax(fabs(low), fabs(high));
    if (!ir->variables[id]->is_varying && low * high > 0) /* keeps its sign, may be divided by */
        return low > 0 ? (struct range){low / 2, most} : (struct range){-most, high / 2};
    if (most == 0)
        most = 1; /* nothing is known of its size */
    return (struct range){fmax(range.low, -most), fmin(range.high, fmax(most, range.low))};
}

static void analyse(struct ir_node *node, void *context) {
    struct analysis *analysis = context;
    if (node->kind != NODE_INSTRUCTION)
        return;
    for (int r = 0; r < 3; r++) {
        const struct ir_variable *v = node->results[r];
        if (!v || v->type != IR_FLOAT)
            continue;
        const bool is_only = v->definition_count == 1 && !v->is_read_early;
        analysis->ranges[v->id] =
            narrow(analysis->ir, v->id,
                   is_only ? fixing_result_range(analysis->ranges, node) : range_unknown);
    }
}

struct range *fixing_ranges(struct ir_program *ir) {
    struct analysis analysis = {
        ir, compilation_get(ir->c, (ir->variable_count + 1) * sizeof(struct range))};
    for (size_t i = 0; i < ir->variable_count; i++)
        analysis.ranges[i] = narrow(ir, (int)i, range_unknown);
    ir_each_node(ir->top, analyse, &analysis);
    return analysis.ranges;
}

struct fixed_format fixing_format(struct range range, int size) {
    const bool is_unsigned = range.low >= 0;
    /* room for what rounding does to the operands, but a bound that is a power of two stays it */
    const double room = 1 + 0x1p-6;
    int whole = is_unsigned ? -40 : -39;
    for (; whole < 63; whole++) {
        const double top = ldexp(1, is_unsigned ? whole : whole - 1);
        const bool fits_above = range.high * room < top;
        const bool fits_below = is_unsigned || range.low * room >= -top || range.low == -top;
        if (fits_above && fits_below)
            break;
    }
    return (struct fixed_format){(int16_t)size, (int16_t)(size - whole), is_unsigned};
}
