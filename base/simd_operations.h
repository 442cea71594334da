/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_SIMD_OPERATIONS_H
#define BASE_SIMD_OPERATIONS_H

/* The operations that the SIMD array of a node executes and a machine description prices, once for
 * the whole array. The compiler counts them, the machine prices them, reports group them.
 *
 * X(NAME, name in the machine description, what it is) */
#define SIMD_OPERATIONS(X)                                                                         \
    X(FLOAT_ADD, "float_add", "32-bit float add or subtract")                                      \
    X(FLOAT_MULTIPLY, "float_multiply", "32-bit float multiply")                                   \
    X(FLOAT_DIVIDE, "float_divide", "32-bit float divide")                                         \
    X(FLOAT_SQRT, "float_sqrt", "32-bit float square root")                                        \
    X(FLOAT_NOISE, "float_noise", "gradient noise, one 32-bit float result")                       \
    X(FLOAT_FLOOR, "float_floor", "round a float down to a whole number")                          \
    X(FLOAT_COMPARE, "float_compare", "compare two floats into an enable bit")                     \
    X(FLOAT_SELECT, "float_select", "minimum, maximum or choice of two floats")                    \
    X(FLOAT_SIGN, "float_sign", "absolute value or change of sign of a float")                     \
    X(FLOAT_MOVE, "float_move", "copy or load 4 bytes of pixel memory")                            \
    X(FLOAT_DIFFERENCE, "float_difference", "difference of a float and a neighbouring sample's")   \
    X(LOGIC, "logic", "one boolean operation or change of the enable flag")                        \
    X(SIN, "sin", "sine")                                                                          \
    X(COS, "cos", "cosine")                                                                        \
    X(TAN, "tan", "tangent")                                                                       \
    X(ASIN, "asin", "inverse sine")                                                                \
    X(ACOS, "acos", "inverse cosine")                                                              \
    X(ATAN, "atan", "inverse tangent")                                                             \
    X(ATAN2, "atan2", "inverse tangent of a quotient")                                             \
    X(EXP, "exp", "e to the power")                                                                \
    X(EXP2, "exp2", "2 to the power")                                                              \
    X(LOG, "log", "natural logarithm")                                                             \
    X(LOG2, "log2", "logarithm to base 2")                                                         \
    X(POW, "pow", "general power")                                                                 \
    X(SIN_FAST, "sin_fast", "sine, fast version")                                                  \
    X(COS_FAST, "cos_fast", "cosine, fast version")                                                \
    X(TAN_FAST, "tan_fast", "tangent, fast version")                                               \
    X(ASIN_FAST, "asin_fast", "inverse sine, fast version")                                        \
    X(ACOS_FAST, "acos_fast", "inverse cosine, fast version")                                      \
    X(ATAN_FAST, "atan_fast", "inverse tangent, fast version")                                     \
    X(ATAN2_FAST, "atan2_fast", "inverse tangent of a quotient, fast version")                     \
    X(EXP_FAST, "exp_fast", "e to the power, fast version")                                        \
    X(EXP2_FAST, "exp2_fast", "2 to the power, fast version")                                      \
    X(LOG_FAST, "log_fast", "natural logarithm, fast version")                                     \
    X(LOG2_FAST, "log2_fast", "logarithm to base 2, fast version")                                 \
    X(POW_FAST, "pow_fast", "general power, fast version")                                         \
    X(FIXED_ADD_BASE, "fixed_add_base", "fixed-point add: constant part")                          \
    X(FIXED_ADD_BYTE, "fixed_add_byte", "fixed-point add: per byte")                               \
    X(FIXED_MULTIPLY_BYTE2, "fixed_multiply_byte2", "fixed-point multiply: per byte squared")      \
    X(FIXED_DIVIDE_BYTE2, "fixed_divide_byte2", "fixed-point divide: per byte squared")            \
    X(FIXED16_SQRT, "fixed16_sqrt", "square root of 16-bit fixed-point")                           \
    X(FIXED32_SQRT, "fixed32_sqrt", "square root of 32-bit fixed-point")                           \
    X(FIXED16_NOISE, "fixed16_noise", "noise in 16-bit fixed-point")                               \
    X(SPILL_BYTE, "spill_byte", "a byte of pixel memory to or from texture memory")                \
    X(EXTERNAL_CALL, "external_call", "a function of the user, sample by sample on the processor")

enum simd_operation {
#define SIMD_OPERATION_ENUM(name, key, what) SIMD_##name,
    SIMD_OPERATIONS(SIMD_OPERATION_ENUM)
#undef SIMD_OPERATION_ENUM
        SIMD_OPERATION_COUNT
};

/* The mathematical functions that have a fast version (PF section 6.1.4 and table 3). */
#define SIMD_FAST_FUNCTIONS(X)                                                                     \
    X(SIN) X(COS) X(TAN) X(ASIN) X(ACOS) X(ATAN) X(ATAN2) X(EXP) X(EXP2) X(LOG) X(LOG2) X(POW)

/* The fast version of an operation, or the operation itself when it has none. */
static inline int simd_operation_fast(int operation) {
    switch (operation) {
#define SIMD_FAST_CASE(name)                                                                       \
    case SIMD_##name:                                                                              \
        return SIMD_##name##_FAST;
        SIMD_FAST_FUNCTIONS(SIMD_FAST_CASE)
#undef SIMD_FAST_CASE
    }
    return operation;
}

#endif
