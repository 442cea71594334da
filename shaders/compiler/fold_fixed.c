/* SPDX-License-Identifier: Apache-2.0 */
#define SHADER_WIDTH 4
#include "shaders/compiler/fold.h"

#include "shaders/simd/vector_math.h"

#include "shaders/simd/vector_fixed.h"

/* Fixed-point instructions on constants, by the functions that generated C calls (emit_fixed.c). */

static int64_t at_exponent(const struct ir_operand *operand, int exponent) {
    return sx_shift(operand->raw, exponent - operand->format.exponent, operand->format.is_unsigned);
}

static bool is_less(const struct ir_operand *a, const struct ir_operand *b) {
    return sx_less(a->raw, a->format.exponent, a->format.is_unsigned, b->raw, b->format.exponent,
                   b->format.is_unsigned) != 0;
}

static bool is_equal(const struct ir_operand *a, const struct ir_operand *b) {
    return sx_equal(a->raw, a->format.exponent, a->format.is_unsigned, b->raw, b->format.exponent,
                    b->format.is_unsigned) != 0;
}

static float as_float(const struct ir_operand *a) {
    return sx_to_float(a->raw, a->format.exponent, a->format.size, a->format.is_unsigned);
}

static int64_t multiply(const struct ir_operand *a, const struct ir_operand *b, int exponent) {
    const int places = a->format.exponent + b->format.exponent - exponent;
    return places > 0 ? sx_multiply_wide(a->raw, a->format.is_unsigned, b->raw,
                                         b->format.is_unsigned, places)
                      : sx_multiply(a->raw, b->raw);
}

/* The whole number before it is cut to the size of the result. */
static int64_t uncut(enum ir_operation operation, const struct ir_operand *a, int exponent) {
    const int e = a[0].format.exponent;
    const bool is_unsigned = a[0].format.is_unsigned;
    switch (operation) {
    case IR_FIXED_ADD:
        return sx_add(at_exponent(&a[0], exponent), at_exponent(&a[1], exponent));
    case IR_FIXED_SUBTRACT:
        return sx_subtract(at_exponent(&a[0], exponent), at_exponent(&a[1], exponent));
    case IR_FIXED_MULTIPLY:
        return multiply(&a[0], &a[1], exponent);
    case IR_FIXED_DIVIDE:
        return sx_divide(a[0].raw, is_unsigned, a[1].raw, a[1].format.is_unsigned,
                         exponent - e + a[1].format.exponent);
    case IR_FIXED_REMAINDER:
        return sx_remainder(a[0].raw, is_unsigned, exponent - e, a[1].raw, a[1].format.is_unsigned,
                            exponent - a[1].format.exponent);
    case IR_FIXED_MIN:
        return at_exponent(is_less(&a[0], &a[1]) ? &a[0] : &a[1], exponent);
    case IR_FIXED_MAX:
        return at_exponent(is_less(&a[1], &a[0]) ? &a[0] : &a[1], exponent);
    case IR_FIXED_SELECT:
        return at_exponent(a[0].truth ? &a[1] : &a[2], exponent);
    case IR_FIXED_NEGATE:
        return sx_subtract(0, at_exponent(&a[0], exponent));
    case IR_FIXED_ABS:
        return is_unsigned ? a[0].raw : sx_abs(a[0].raw);
    case IR_FIXED_CEIL:
        return e > 0 ? sx_ceil(a[0].raw, e, is_unsigned) : a[0].raw;
    case IR_FIXED_ROUND:
        return e > 0 ? sx_round(a[0].raw, e, is_unsigned) : a[0].raw;
    case IR_FIXED_SQRT:
        return sx_sqrt(a[0].raw, is_unsigned, 2 * exponent - e);
    default: /* a move or conversion */
        return at_exponent(&a[0], exponent);
    }
}

static int64_t noise(enum ir_operation operation, const struct ir_operand *a) {
    const int count = (int)operation - IR_FIXED_NOISE1 + 1,
              exponent = fixed_noise_exponent(a, count);
    int64_t at[3] = {0};
    for (int i = 0; i < count; i++)
        at[i] = at_exponent(&a[i], exponent);
    return sx_noise(at[0], at[1], at[2], exponent);
}

int64_t fold_fixed(enum ir_operation operation, const struct ir_operand *a,
                   struct fixed_format result) {
    switch (operation) {
    case IR_FIXED_FROM_FLOAT:
        return sx_from_float(a[0].number, result.exponent, result.size, result.is_unsigned);
    case IR_FIXED_NOISE1:
    case IR_FIXED_NOISE2:
    case IR_FIXED_NOISE3:
        return noise(operation, a);
    default:
        return sx_wrap(uncut(operation, a, result.exponent), result.size, result.is_unsigned);
    }
}

float fold_fixed_to_float(const struct ir_operand *a) {
    return as_float(a);
}

bool fold_fixed_comparison(enum ir_operation operation, const struct ir_operand *a) {
    switch (operation) {
    case IR_FIXED_LESS:
        return is_less(&a[0], &a[1]);
    case IR_FIXED_LESS_EQUAL:
        return !is_less(&a[1], &a[0]);
    case IR_FIXED_EQUAL:
        return is_equal(&a[0], &a[1]);
    default:
        return !is_equal(&a[0], &a[1]);
    }
}

int fixed_noise_exponent(const struct ir_operand *coordinates, int count) {
    enum { NOISE_EXPONENT_MAX = 22 }; /* with eight bits of cell in 32 bits */
    int exponent = 0;
    for (int i = 0; i < count; i++) {
        const int one = ir_operand_format(&coordinates[i]).exponent;
        exponent = one > exponent ? one : exponent;
    }
    return exponent < NOISE_EXPONENT_MAX ? exponent : NOISE_EXPONENT_MAX;
}
