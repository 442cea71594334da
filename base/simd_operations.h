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
    X(POW, "pow", "general power")

enum simd_operation {
#define SIMD_OPERATION_ENUM(name, key, what) SIMD_##name,
    SIMD_OPERATIONS(SIMD_OPERATION_ENUM)
#undef SIMD_OPERATION_ENUM
        SIMD_OPERATION_COUNT
};

#endif
