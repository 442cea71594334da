/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/builtins.h"
#include "shaders/compiler/fixing.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Instructions as expressions of the language. An operation is written in fixed-point when its
 * result is to be fixed-point and the language has it; the operands are then converted. Otherwise
 * it is written in floats. */

const char *source_format(struct source_writer *w, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *text = compilation_get(w->ir->c, (size_t)length + 1);
    vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    return text;
}

static struct piece primary(const char *text) {
    return (struct piece){.text = text, .precedence = PRECEDENCE_PRIMARY};
}

/* In parentheses unless it binds at least as tightly as `precedence`. */
static const char *bound(struct source_writer *w, struct piece piece, int precedence) {
    return piece.precedence >= precedence ? piece.text : source_format(w, "(%s)", piece.text);
}

const char *source_component(struct source_writer *w, const struct shader_parameter *parameter,
                             int index) {
    static const char axes[] = "xyz";
    const char *name = parameter->name;
    if (parameter->is_global && !global_find(name)) {
        compile_error(w->ir->c, w->ir->c->shader_at,
                      "this cannot be written as source with other types: option(\"%.64s\")", name);
        compilation_stop(w->ir->c);
    }
    if (parameter->array_length && parameter->type == SHADER_MATRIX)
        return source_format(w, "comp(%s[%d], %d, %d)", name, index / 16, index / 4 % 4, index % 4);
    if (parameter->array_length) {
        const int width = parameter->components / parameter->array_length;
        return width == 1 ? source_format(w, "%s[%d]", name, index)
               : parameter->type == SHADER_COLOR
                   ? source_format(w, "comp(%s[%d], %d)", name, index / width, index % width)
                   : source_format(w, "%ccomp(%s[%d])", axes[index % 3], name, index / width);
    }
    switch (parameter->type) {
    case SHADER_COLOR:
        return source_format(w, "comp(%s, %d)", name, index);
    case SHADER_POINT:
    case SHADER_VECTOR:
    case SHADER_NORMAL:
        return source_format(w, "%ccomp(%s)", axes[index % 3], name);
    case SHADER_MATRIX:
        return source_format(w, "comp(%s, %d, %d)", name, index / 4 % 4, index % 4);
    default:
        return name;
    }
}

/* A number as the language reads it back. */
static struct piece number(struct source_writer *w, double value) {
    if (!isfinite(value)) /* cannot be written; 0 / 0 is folded to what it is */
        return (struct piece){"0 / 0", PRECEDENCE_PRODUCT, false, {0}};
    struct piece piece = primary(source_format(w, "%.9g", value));
    if (value < 0 || signbit(value))
        piece.precedence = PRECEDENCE_SIGN;
    return piece;
}

/* The constant nearest to `value` with at most `exponent` bits after the point and 24 in all, as a
 * fixed-point number written out: all digits, so that it is exact. */
static struct piece fixed_number(struct source_writer *w, double value, int exponent) {
    if (!isfinite(value))
        value = 0;
    int top = 0;
    frexp(value, &top);
    if (exponent > 24 - top)
        exponent = 24 - top;
    const double nearest = ldexp(nearbyint(ldexp(value, exponent)), -exponent);
    struct piece piece = primary(source_format(w, "%.40g", nearest));
    int64_t raw;
    piece.is_fixed = true;
    piece.format = fixed_of_number((float)nearest, &raw);
    if (nearest < 0)
        piece.precedence = PRECEDENCE_SIGN;
    return piece;
}

static struct piece cast(struct source_writer *w, struct fixed_format format, struct piece piece) {
    char name[32];
    struct piece result =
        primary(source_format(w, "%s (%s)", fixed_format_name(format, name), piece.text));
    result.precedence = PRECEDENCE_SIGN;
    result.is_fixed = true;
    result.format = format;
    return result;
}

/* The type of a value that is an operand may be either; this is what it has. */
static struct piece natural(struct source_writer *w, const struct ir_operand *operand) {
    if (operand->kind == OPERAND_FLOAT)
        return number(w, (double)operand->number);
    const struct written *known = source_variable(w, operand->variable);
    if (known->alias)
        return primary(known->alias);
    if (!source_is_inlined(w, operand->variable)) {
        struct piece piece = primary(known->name ? known->name : "0");
        piece.is_fixed = known->is_fixed;
        piece.format = known->format;
        return piece;
    }
    struct piece piece = source_expression(w, known->definition);
    if (known->is_fixed && (!piece.is_fixed || !fixed_same(piece.format, known->format)))
        return cast(w, known->format, piece);
    return piece;
}

struct piece source_float(struct source_writer *w, const struct ir_operand *operand) {
    struct piece piece = natural(w, operand);
    if (!piece.is_fixed)
        return piece;
    piece = primary(source_format(w, "float (%s)", piece.text));
    piece.precedence = PRECEDENCE_SIGN;
    return piece;
}

/* Bits in front of the point of the largest magnitude of a range, negative for small ones. */
static int magnitude_bits(struct range range) {
    int top = 0;
    const double most = fmax(fabs(range.low), fabs(range.high));
    if (!isfinite(most))
        return 24;
    frexp(most, &top);
    return top;
}

/* What is not fixed-point yet is given enough bits after the point that rounding it is far below
 * rounding the result: GUARD_BITS more than the `exponent` that the result asks for. */
enum { GUARD_BITS = 8, FLOAT_BITS = 25 /* with a sign */ };

static struct fixed_format guarded_format(struct range range, int exponent) {
    const int size = exponent + GUARD_BITS - fixing_format(range, 0).exponent;
    return fixing_format(range, size < 2 ? 2 : size > FLOAT_BITS ? FLOAT_BITS : size);
}

/* An operand as fixed-point. */
static struct piece as_fixed(struct source_writer *w, const struct ir_operand *operand,
                             int exponent) {
    if (operand->kind == OPERAND_FLOAT)
        return fixed_number(w, (double)operand->number, exponent + GUARD_BITS);
    struct piece piece = natural(w, operand);
    if (piece.is_fixed)
        return piece;
    return cast(w, guarded_format(fixing_operand_range(w->ranges, operand), exponent), piece);
}

/* How exactly an operand is wanted of which the result is a multiple. */
static int factor_exponent(struct source_writer *w, struct fixed_format result,
                           const struct ir_operand *other) {
    return result.exponent + magnitude_bits(fixing_operand_range(w->ranges, other));
}

static struct piece infix(struct source_writer *w, int precedence, struct piece a,
                          const char *token, struct piece b) {
    return (struct piece){.text = source_format(w, "%s %s %s", bound(w, a, precedence), token,
                                                bound(w, b, precedence + 1)),
                          .precedence = precedence};
}

static struct piece call(struct source_writer *w, const char *function, int count,
                         const struct piece *arguments) {
    const char *text = source_format(w, "%s(", function);
    for (int i = 0; i < count; i++)
        text = source_format(w, "%s%s%s", text, i ? ", " : "", arguments[i].text);
    return primary(source_format(w, "%s)", text));
}

static struct piece question(struct source_writer *w, const struct ir_node *node, struct piece a,
                             struct piece b) {
    const struct piece condition = source_condition(w, &node->operands[0]);
    return (struct piece){.text =
                              source_format(w, "%s ? %s : %s", bound(w, condition, PRECEDENCE_OR),
                                            bound(w, a, PRECEDENCE_OR), bound(w, b, PRECEDENCE_OR)),
                          .precedence = PRECEDENCE_QUESTION};
}

/* Operations that fixed-point numbers have, with the rule for the format of the result.
 * X(operation, rule, operands, precedence, token; or a function where the precedence is that of a
 * primary expression) */
#define SOURCE_FIXED_OPERATIONS(X)                                                                 \
    X(ADD, FIXED_ADD, 2, PRECEDENCE_SUM, "+")                                                      \
    X(SUBTRACT, FIXED_SUBTRACT, 2, PRECEDENCE_SUM, "-")                                            \
    X(MULTIPLY, FIXED_MULTIPLY, 2, PRECEDENCE_PRODUCT, "*")                                        \
    X(DIVIDE, FIXED_DIVIDE, 2, PRECEDENCE_PRODUCT, "/")                                            \
    X(NEGATE, FIXED_NEGATE, 1, PRECEDENCE_SIGN, "-")                                               \
    X(ABS, FIXED_ABSOLUTE, 1, PRECEDENCE_PRIMARY, "abs")                                           \
    X(MIN, FIXED_COMMON, 2, PRECEDENCE_PRIMARY, "min")                                             \
    X(MAX, FIXED_COMMON, 2, PRECEDENCE_PRIMARY, "max")                                             \
    X(FLOOR, FIXED_FLOOR, 1, PRECEDENCE_PRIMARY, "floor")                                          \
    X(CEIL, FIXED_CEIL, 1, PRECEDENCE_PRIMARY, "ceil")                                             \
    X(ROUND, FIXED_CEIL, 1, PRECEDENCE_PRIMARY, "round")                                           \
    X(SQRT, FIXED_SQRT, 1, PRECEDENCE_PRIMARY, "sqrt")

/* What only floats have, and conditions. */
#define SOURCE_FLOAT_OPERATIONS(X)                                                                 \
    X(SIN, 1, PRECEDENCE_PRIMARY, "sin")                                                           \
    X(COS, 1, PRECEDENCE_PRIMARY, "cos")                                                           \
    X(TAN, 1, PRECEDENCE_PRIMARY, "tan")                                                           \
    X(ASIN, 1, PRECEDENCE_PRIMARY, "asin")                                                         \
    X(ACOS, 1, PRECEDENCE_PRIMARY, "acos")                                                         \
    X(ATAN, 1, PRECEDENCE_PRIMARY, "atan")                                                         \
    X(ATAN2, 2, PRECEDENCE_PRIMARY, "atan")                                                        \
    X(EXP, 1, PRECEDENCE_PRIMARY, "exp")                                                           \
    X(LOG, 1, PRECEDENCE_PRIMARY, "log")                                                           \
    X(POW, 2, PRECEDENCE_PRIMARY, "pow")

#define SOURCE_COMPARISONS(X)                                                                      \
    X(LESS, PRECEDENCE_LESS, "<")                                                                  \
    X(LESS_EQUAL, PRECEDENCE_LESS, "<=")                                                           \
    X(EQUAL, PRECEDENCE_EQUAL, "==")                                                               \
    X(NOT_EQUAL, PRECEDENCE_EQUAL, "!=")

static const struct source_operation {
    const char *token;
    int operands, precedence, rule; /* rule -1: not in fixed-point */
} operations[IR_OPERATION_COUNT] = {
#define SOURCE_FIXED_ENTRY(name, rule, operands, precedence, token)                                \
    [IR_##name] = {token, operands, precedence, rule},
#define SOURCE_FLOAT_ENTRY(name, operands, precedence, token)                                      \
    [IR_##name] = {token, operands, precedence, -1},
#define SOURCE_COMPARISON_ENTRY(name, precedence, token) [IR_##name] = {token, 2, precedence, -1},
    SOURCE_FIXED_OPERATIONS(SOURCE_FIXED_ENTRY) SOURCE_FLOAT_OPERATIONS(SOURCE_FLOAT_ENTRY)
        SOURCE_COMPARISONS(SOURCE_COMPARISON_ENTRY)
#undef SOURCE_FIXED_ENTRY
#undef SOURCE_FLOAT_ENTRY
#undef SOURCE_COMPARISON_ENTRY
};

static struct piece write_operation(struct source_writer *w, const struct source_operation *o,
                                    struct piece a, struct piece b) {
    const struct piece arguments[2] = {a, b};
    if (o->precedence == PRECEDENCE_PRIMARY)
        return call(w, o->token, o->operands, arguments);
    if (o->operands == 2)
        return infix(w, o->precedence, a, o->token, b);
    return (struct piece){.text =
                              source_format(w, "%s%s", o->token, bound(w, a, PRECEDENCE_PRIMARY)),
                          .precedence = PRECEDENCE_SIGN};
}

/* The operand with as many bits after the point as the result is to have. */
static struct piece lengthen(struct source_writer *w, struct piece piece, int exponent) {
    if (piece.format.exponent >= exponent)
        return piece;
    const int size = piece.format.size + exponent - piece.format.exponent;
    const struct fixed_format longer = {(int16_t)(size > 64 ? 64 : size),
                                        (int16_t)(size > 64 ? exponent - (size - 64) : exponent),
                                        piece.format.is_unsigned};
    return cast(w, longer, piece);
}

/* a times the reciprocal of b, which is uniform: computed once for all samples, by the processor.
 * Table 2 of the paper: a quotient costs more than three products. */
static bool multiply_by_reciprocal(struct source_writer *w, const struct ir_node *node,
                                   struct fixed_format result, struct piece *piece) {
    const struct ir_operand *dividend = &node->operands[0], *divisor = &node->operands[1];
    const struct range range = range_reciprocal(fixing_operand_range(w->ranges, divisor));
    if (ir_operand_is_varying(divisor) || !isfinite(range.low) || !isfinite(range.high))
        return false;
    const int exponent = factor_exponent(w, result, dividend);
    const struct piece b =
        divisor->kind == OPERAND_FLOAT
            ? fixed_number(w, range.low, exponent + GUARD_BITS)
            : cast(w, guarded_format(range, exponent),
                   infix(w, PRECEDENCE_PRODUCT, number(w, 1), "/", natural(w, divisor)));
    const struct piece a = as_fixed(w, dividend, result.exponent + magnitude_bits(range));
    *piece = infix(w, PRECEDENCE_PRODUCT, a, "*", b);
    piece->format = fixed_result(FIXED_MULTIPLY, a.format, b.format);
    piece->is_fixed = true;
    return true;
}

static struct piece fixed_operation(struct source_writer *w, const struct ir_node *node,
                                    struct fixed_format result) {
    const struct source_operation *o = &operations[node->operation];
    const struct ir_operand *first = &node->operands[0], *second = &node->operands[1];
    struct piece piece;
    if (node->operation == IR_DIVIDE && multiply_by_reciprocal(w, node, result, &piece))
        return piece;
    const bool is_factor = o->rule == FIXED_MULTIPLY;
    struct piece a =
        as_fixed(w, first, is_factor ? factor_exponent(w, result, second) : result.exponent);
    const struct piece b =
        o->operands == 1
            ? a
            : as_fixed(w, second, is_factor ? factor_exponent(w, result, first) : result.exponent);
    if (o->rule == FIXED_SQRT || (o->rule == FIXED_DIVIDE && b.format.exponent < result.exponent))
        a = lengthen(w, a, result.exponent);
    piece = write_operation(w, o, a, b);
    piece.format = fixed_result((enum fixed_rule)o->rule, a.format, b.format);
    piece.is_fixed = true;
    return piece;
}

static struct piece fixed_question(struct source_writer *w, const struct ir_node *node,
                                   struct fixed_format result) {
    const struct piece a = as_fixed(w, &node->operands[1], result.exponent),
                       b = as_fixed(w, &node->operands[2], result.exponent);
    struct piece piece = question(w, node, a, b);
    piece.format = fixed_result(FIXED_COMMON, a.format, b.format);
    piece.is_fixed = true;
    return piece;
}

static struct piece fixed_noise(struct source_writer *w, const struct ir_node *node, int count) {
    enum { NOISE_COORDINATE_BITS = 14 };
    struct piece arguments[3];
    for (int i = 0; i < count; i++)
        arguments[i] = as_fixed(w, &node->operands[i], NOISE_COORDINATE_BITS);
    struct piece piece = call(w, "noise", count, arguments);
    piece.format = (struct fixed_format){15, 14, true};
    piece.is_fixed = true;
    return piece;
}

/* point (a, b, c) of consecutive operands */
static struct piece tuple(struct source_writer *w, const struct ir_node *node, int first) {
    struct piece arguments[3];
    for (int i = 0; i < 3; i++)
        arguments[i] = source_float(w, &node->operands[first + i]);
    return call(w, "point ", 3, arguments);
}

static struct piece float_noise(struct source_writer *w, const struct ir_node *node,
                                const char *type, const char *function, bool has_period) {
    const int count = ir_operand_count(node->operation),
              coordinates = has_period ? count / 2 : count;
    struct piece arguments[4];
    int given = 0;
    for (int first = 0; first < count; first += coordinates) {
        if (coordinates >= 3)
            arguments[given++] = tuple(w, node, first);
        for (int i = coordinates >= 3 ? 3 : 0; i < coordinates; i++)
            arguments[given++] = source_float(w, &node->operands[first + i]);
    }
    struct piece piece = call(w, function, given, arguments);
    piece.text = source_format(w, "%s %s", type, piece.text);
    piece.precedence = PRECEDENCE_SIGN;
    return piece;
}

static struct piece noise(struct source_writer *w, const struct ir_node *node,
                          const struct written *result) {
    switch (node->operation) {
    case IR_NOISE1:
    case IR_NOISE2:
    case IR_NOISE3:
        if (result->is_fixed)
            return fixed_noise(w, node, ir_operand_count(node->operation));
        return float_noise(w, node, "float", "noise", false);
    case IR_NOISE4:
        return float_noise(w, node, "float", "noise", false);
    case IR_NOISE1_3:
    case IR_NOISE2_3:
    case IR_NOISE3_3:
    case IR_NOISE4_3:
        return float_noise(w, node, "color", "noise", false);
    case IR_PNOISE3:
    case IR_PNOISE4:
        return float_noise(w, node, "float", "pnoise", true);
    case IR_PNOISE3_3:
    case IR_PNOISE4_3:
        return float_noise(w, node, "color", "pnoise", true);
    case IR_CELLNOISE:
        return float_noise(w, node, "float", "cellnoise", false);
    default:
        return float_noise(w, node, "color", "cellnoise", false);
    }
}

static const char *space_name(struct source_writer *w, const struct ir_node *node) {
    static const char *const names[] = {[SHADER_SPACE_CURRENT] = "current",
                                        [SHADER_SPACE_CAMERA] = "camera",
                                        [SHADER_SPACE_SHADER] = "shader",
                                        [SHADER_SPACE_OBJECT] = "object",
                                        [SHADER_SPACE_WORLD] = "world"};
    const struct ir_operand *space = &node->operands[0];
    if (space->kind == OPERAND_STRING && space->identity >= 0 &&
        space->identity <= SHADER_SPACE_WORLD)
        return names[space->identity];
    for (int i = 0; space->kind == OPERAND_STRING && i < w->ir->named_space_count; i++)
        if (shader_string_identity(w->ir->named_spaces[i].name) == space->identity)
            return w->ir->named_spaces[i].name;
    source_refuse(w, node,
                  "a coordinate system that is chosen at run time, or divides by distance");
}

/* An element of the matrix of a space: a component of what becomes of an axis, or of the origin. */
static struct piece matrix_element(struct source_writer *w, const struct ir_node *node) {
    static const char *const axes[] = {"vector (1, 0, 0)", "vector (0, 1, 0)", "vector (0, 0, 1)",
                                       "point (0, 0, 0)"};
    const int row = node->index / 4, column = node->index % 4;
    const bool is_to_camera = node->operation == IR_TO_CAMERA;
    const char *name = space_name(w, node);
    if (column == 3)
        source_refuse(w, node, "an element of a matrix that transforms do not use");
    const char *spaces = is_to_camera ? source_format(w, "\"%s\", \"current\"", name)
                                      : source_format(w, "\"%s\"", name);
    return primary(source_format(w, "%ccomp(%stransform(%s, %s))", "xyz"[column],
                                 row < 3 ? "v" : "", spaces, axes[row]));
}

static struct piece input(struct source_writer *w, const struct ir_node *node) {
    switch (node->operation) {
    case IR_MATERIAL:
    case IR_BOUND:
        return primary(source_component(w, node->parameter, node->index));
    case IR_POSITION:
        return primary(source_format(w, "%ccomp(P)", "xyz"[node->index % 3]));
    case IR_INCIDENT:
        return primary(source_format(w, "%ccomp(I)", "xyz"[node->index % 3]));
    case IR_AMBIENT:
        return primary(source_format(w, "comp(ambient(), %d)", node->index));
    case IR_LIGHT_COLOR:
        return primary(source_format(w, "comp(Cl, %d)", node->index));
    case IR_LIGHT_DIRECTION: { /* towards the sample: the other way than L */
        struct piece piece = primary(source_format(w, "-%ccomp(L)", "xyz"[node->index % 3]));
        piece.precedence = PRECEDENCE_SIGN;
        return piece;
    }
    case IR_FROM_CAMERA:
    case IR_TO_CAMERA:
        return matrix_element(w, node);
    default:
        source_refuse(w, node, "something that no expression stands for");
    }
}

static struct piece array_load(struct source_writer *w, const struct ir_node *node) {
    const struct written *array = source_variable(w, node->array);
    if (!array->name)
        source_refuse(w, node, "an array parameter");
    return primary(
        source_format(w, "%s[%s]", array->name, source_float(w, &node->operands[0]).text));
}

static int light_component(struct source_writer *w, const struct ir_node *node) {
    return source_variable(w, node->operands[0].variable)->definition->index % 3;
}

bool source_is_towards_light(struct source_writer *w, const struct ir_node *node) {
    if (node->operation != IR_NEGATE || node->operands[0].kind != OPERAND_VARIABLE)
        return false;
    const struct ir_node *definition = source_variable(w, node->operands[0].variable)->definition;
    return definition && definition->operation == IR_LIGHT_DIRECTION;
}

struct piece source_expression(struct source_writer *w, const struct ir_node *node) {
    const struct source_operation *o = &operations[node->operation];
    const struct ir_variable *variable = node->results[0]   ? node->results[0]
                                         : node->results[1] ? node->results[1]
                                                            : node->results[2];
    const struct written *result = source_variable(w, variable);
    if (node->operation == IR_MOVE)
        return natural(w, &node->operands[0]);
    if (source_is_towards_light(w, node))
        return primary(source_format(w, "%ccomp(L)", "xyz"[light_component(w, node)]));
    if (node->operation == IR_ARRAY_LOAD)
        return array_load(w, node);
    if (node->operation >= IR_NOISE1 && node->operation <= IR_CELLNOISE_3)
        return noise(w, node, result);
    if (node->operation == IR_SELECT)
        return result->is_fixed ? fixed_question(w, node, result->format)
                                : question(w, node, source_float(w, &node->operands[1]),
                                           source_float(w, &node->operands[2]));
    if (!o->token)
        return input(w, node);
    if (result->is_fixed && o->rule >= 0)
        return fixed_operation(w, node, result->format);
    const struct piece a = source_float(w, &node->operands[0]);
    return write_operation(w, o, a, o->operands > 1 ? source_float(w, &node->operands[1]) : a);
}

/* Whether a comparison has to be made in floats: an operand varies and is one. */
static bool compares_floats(struct source_writer *w, const struct ir_node *node) {
    bool has_fixed = false;
    for (int i = 0; i < 2; i++) {
        const struct ir_operand *operand = &node->operands[i];
        if (operand->kind != OPERAND_VARIABLE)
            continue;
        const bool is_fixed = source_variable(w, operand->variable)->is_fixed;
        has_fixed |= is_fixed;
        if (ir_operand_is_varying(operand) && !is_fixed)
            return true;
    }
    return !has_fixed;
}

static struct piece comparison(struct source_writer *w, const struct ir_node *node) {
    const struct source_operation *o = &operations[node->operation];
    if (compares_floats(w, node))
        return infix(w, o->precedence, source_float(w, &node->operands[0]), o->token,
                     source_float(w, &node->operands[1]));
    struct piece sides[2];
    for (int i = 0; i < 2; i++) {
        const struct ir_operand *other = &node->operands[1 - i];
        const struct written *known =
            other->kind == OPERAND_VARIABLE ? source_variable(w, other->variable) : NULL;
        struct fixed_format format = {32, 24, false};
        if (known && known->is_fixed)
            format = known->format;
        sides[i] = as_fixed(w, &node->operands[i], format.exponent);
    }
    return infix(w, o->precedence, sides[0], o->token, sides[1]);
}

struct piece source_instruction_condition(struct source_writer *w, const struct ir_node *node) {
    struct piece piece;
    switch (node->operation) {
    case IR_MOVE_BOOL:
        return source_condition(w, &node->operands[0]);
    case IR_AND:
    case IR_OR: {
        const bool is_and = node->operation == IR_AND;
        return infix(w, is_and ? PRECEDENCE_AND : PRECEDENCE_OR,
                     source_condition(w, &node->operands[0]), is_and ? "&&" : "||",
                     source_condition(w, &node->operands[1]));
    }
    case IR_NOT:
        piece = source_condition(w, &node->operands[0]);
        return (struct piece){.text = source_format(w, "!%s", bound(w, piece, PRECEDENCE_PRIMARY)),
                              .precedence = PRECEDENCE_SIGN};
    default:
        if (!operations[node->operation].token)
            source_refuse(w, node, "a condition that no expression stands for");
        return comparison(w, node);
    }
}

struct piece source_condition(struct source_writer *w, const struct ir_operand *operand) {
    if (operand->kind == OPERAND_BOOL) {
        const struct piece one = number(w, 1), other = number(w, operand->truth ? 1 : 0);
        return infix(w, PRECEDENCE_EQUAL, other, "==", one);
    }
    const struct written *known = source_variable(w, operand->variable);
    if (known->is_given)
        source_refuse(w, known->definition, "a question whether something was given");
    if (!source_is_inlined(w, operand->variable)) /* a condition that was kept as a number */
        return (struct piece){.text = source_format(w, "%s != 0", known->name ? known->name : "0"),
                              .precedence = PRECEDENCE_EQUAL};
    return source_instruction_condition(w, known->definition);
}
