/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IR_OPERATIONS_H
#define IR_OPERATIONS_H

/* Every instruction of the IR: what the array pays for it (base/simd_operations.h, or FREE) and its
 * C.
 *
 * X(NAME, result and operand types, operation, scalar C, vector C). Types: f float, b condition, s
 * string identity, x fixed-point, * whatever the array holds; the first letter is the result ('3'
 * is three floats, each wanted or not; '0' none). In the C, $0 $1 $2 are operands, $F is "_fast"
 * when asked for, $M "& mask" in varying control flow. Rows with no C are written by
 * emit_instruction.c itself, those of fixed-point by emit_fixed.c; what a fixed-point operation
 * costs follows from the sizes (price_fixed.c). Its result is the exact one, rounded down to the
 * exponent of the result and cut to its size. */
#define IR_OPERATIONS(X)                                                                           \
    X(MOVE, "ff", FLOAT_MOVE, "$0", "$0")                                                          \
    X(MOVE_BOOL, "bb", LOGIC, "$0", "$0")                                                          \
    X(MOVE_STRING, "ss", FREE, "$0", NULL)                                                         \
    X(ADD, "fff", FLOAT_ADD, "$0 + $1", "$0 + $1")                                                 \
    X(SUBTRACT, "fff", FLOAT_ADD, "$0 - $1", "$0 - $1")                                            \
    X(MULTIPLY, "fff", FLOAT_MULTIPLY, "$0 * $1", "$0 * $1")                                       \
    X(DIVIDE, "fff", FLOAT_DIVIDE, "$0 / $1", "$0 / $1")                                           \
    X(NEGATE, "ff", FLOAT_SIGN, "-$0", "-$0")                                                      \
    X(ABS, "ff", FLOAT_SIGN, "sf_abs($0)", "vf_abs($0)")                                           \
    X(MIN, "fff", FLOAT_SELECT, "sf_min($0, $1)", "vf_min($0, $1)")                                \
    X(MAX, "fff", FLOAT_SELECT, "sf_max($0, $1)", "vf_max($0, $1)")                                \
    X(SELECT, "fbff", FLOAT_SELECT, "$0 ? $1 : $2", "vf_select($0, $1, $2)")                       \
    X(FLOOR, "ff", FLOAT_FLOOR, "sf_floor($0)", "vf_floor($0)")                                    \
    X(CEIL, "ff", FLOAT_FLOOR, "sf_ceil($0)", "vf_ceil($0)")                                       \
    X(ROUND, "ff", FLOAT_FLOOR, "sf_round($0)", "vf_round($0)")                                    \
    X(SQRT, "ff", FLOAT_SQRT, "sf_sqrt($0)", "vf_sqrt($0)")                                        \
    X(SIN, "ff", SIN, "sf_sin$F($0)", "vf_sin$F($0)")                                              \
    X(COS, "ff", COS, "sf_cos$F($0)", "vf_cos$F($0)")                                              \
    X(TAN, "ff", TAN, "sf_tan$F($0)", "vf_tan$F($0)")                                              \
    X(ASIN, "ff", ASIN, "sf_asin$F($0)", "vf_asin$F($0)")                                          \
    X(ACOS, "ff", ACOS, "sf_acos$F($0)", "vf_acos$F($0)")                                          \
    X(ATAN, "ff", ATAN, "sf_atan$F($0)", "vf_atan$F($0)")                                          \
    X(ATAN2, "fff", ATAN2, "sf_atan2$F($0, $1)", "vf_atan2$F($0, $1)")                             \
    X(EXP, "ff", EXP, "sf_exp$F($0)", "vf_exp$F($0)")                                              \
    X(LOG, "ff", LOG, "sf_log$F($0)", "vf_log$F($0)")                                              \
    X(POW, "fff", POW, "sf_pow$F($0, $1)", "vf_pow$F($0, $1)")                                     \
    X(NOISE1, "ff", FLOAT_NOISE, "sf_noise1($0)", "vf_noise1($0)")                                 \
    X(NOISE2, "fff", FLOAT_NOISE, "sf_noise2($0, $1)", "vf_noise2($0, $1)")                        \
    X(NOISE3, "ffff", FLOAT_NOISE, "sf_noise3($0, $1, $2)", "vf_noise3($0, $1, $2)")               \
    X(NOISE1_3, "3f", FLOAT_NOISE, "sf_noise1_3($0, ", "vf_noise1_3($0, ")                         \
    X(NOISE2_3, "3ff", FLOAT_NOISE, "sf_noise2_3($0, $1, ", "vf_noise2_3($0, $1, ")                \
    X(NOISE3_3, "3fff", FLOAT_NOISE, "sf_noise3_3($0, $1, $2, ", "vf_noise3_3($0, $1, $2, ")       \
    X(NOISE4, "fffff", FLOAT_NOISE, "sf_noise4($0, $1, $2, $3)", "vf_noise4($0, $1, $2, $3)")      \
    X(NOISE4_3, "3ffff", FLOAT_NOISE, "sf_noise4_3($0, $1, $2, $3, ",                              \
      "vf_noise4_3($0, $1, $2, $3, ")                                                              \
    X(PNOISE3, "fffffff", FLOAT_NOISE, "sf_pnoise3($0, $1, $2, $3, $4, $5)",                       \
      "vf_pnoise3($0, $1, $2, $3, $4, $5)")                                                        \
    X(PNOISE3_3, "3ffffff", FLOAT_NOISE, "sf_pnoise3_3($0, $1, $2, $3, $4, $5, ",                  \
      "vf_pnoise3_3($0, $1, $2, $3, $4, $5, ")                                                     \
    X(PNOISE4, "fffffffff", FLOAT_NOISE, "sf_pnoise4($0, $1, $2, $3, $4, $5, $6, $7)",             \
      "vf_pnoise4($0, $1, $2, $3, $4, $5, $6, $7)")                                                \
    X(PNOISE4_3, "3ffffffff", FLOAT_NOISE, "sf_pnoise4_3($0, $1, $2, $3, $4, $5, $6, $7, ",        \
      "vf_pnoise4_3($0, $1, $2, $3, $4, $5, $6, $7, ")                                             \
    X(CELLNOISE, "fffff", FLOAT_NOISE, "sf_cellnoise($0, $1, $2, $3)",                             \
      "vf_cellnoise($0, $1, $2, $3)")                                                              \
    X(CELLNOISE_3, "3ffff", FLOAT_NOISE, "sf_cellnoise_3($0, $1, $2, $3, ",                        \
      "vf_cellnoise_3($0, $1, $2, $3, ")                                                           \
    X(RANDOM, "fffff", FLOAT_NOISE, "sf_random($0, $1, $2, $3)", "vf_random($0, $1, $2, $3)")      \
    /* Between a sample and its neighbour in the quad, as far as both take part in the control     \
     * flow around: lanes see each other, so these two may not move into or out of control flow.   \
     */                                                                                            \
    X(DIFFERENCE_X, "ff", FLOAT_DIFFERENCE, "shader_no_difference($0)",                            \
      "shader_difference_x($0, present$M)")                                                        \
    X(DIFFERENCE_Y, "ff", FLOAT_DIFFERENCE, "shader_no_difference($0)",                            \
      "shader_difference_y($0, present$M)")                                                        \
    X(LESS, "bff", FLOAT_COMPARE, "$0 < $1", "$0 < $1")                                            \
    X(LESS_EQUAL, "bff", FLOAT_COMPARE, "$0 <= $1", "$0 <= $1")                                    \
    X(EQUAL, "bff", FLOAT_COMPARE, "$0 == $1", "$0 == $1")                                         \
    X(NOT_EQUAL, "bff", FLOAT_COMPARE, "$0 != $1", "$0 != $1")                                     \
    X(AND, "bbb", LOGIC, "$0 & $1", "$0 & $1")                                                     \
    X(OR, "bbb", LOGIC, "$0 | $1", "$0 | $1")                                                      \
    X(NOT, "bb", LOGIC, "!$0", "~$0")                                                              \
    X(STRING_EQUAL, "bss", FREE, "$0 == $1", NULL)                                                 \
    X(MOVE_FIXED, "xx", FREE, NULL, NULL)                                                          \
    X(FIXED_ADD, "xxx", FREE, NULL, NULL)                                                          \
    X(FIXED_SUBTRACT, "xxx", FREE, NULL, NULL)                                                     \
    X(FIXED_MULTIPLY, "xxx", FREE, NULL, NULL)                                                     \
    X(FIXED_DIVIDE, "xxx", FREE, NULL, NULL)                                                       \
    X(FIXED_REMAINDER, "xxx", FREE, NULL, NULL)                                                    \
    X(FIXED_MIN, "xxx", FREE, NULL, NULL)                                                          \
    X(FIXED_MAX, "xxx", FREE, NULL, NULL)                                                          \
    X(FIXED_SELECT, "xbxx", FREE, NULL, NULL)                                                      \
    X(FIXED_NEGATE, "xx", FREE, NULL, NULL)                                                        \
    X(FIXED_ABS, "xx", FREE, NULL, NULL)                                                           \
    X(FIXED_CONVERT, "xx", FREE, NULL, NULL)                                                       \
    X(FIXED_CEIL, "xx", FREE, NULL, NULL)                                                          \
    X(FIXED_ROUND, "xx", FREE, NULL, NULL)                                                         \
    X(FIXED_SQRT, "xx", FREE, NULL, NULL)                                                          \
    X(FIXED_NOISE1, "xx", FREE, NULL, NULL)                                                        \
    X(FIXED_NOISE2, "xxx", FREE, NULL, NULL)                                                       \
    X(FIXED_NOISE3, "xxxx", FREE, NULL, NULL)                                                      \
    X(FIXED_FROM_FLOAT, "xf", FREE, NULL, NULL)                                                    \
    X(FIXED_TO_FLOAT, "fx", FREE, NULL, NULL)                                                      \
    X(FIXED_LESS, "bxx", FREE, NULL, NULL)                                                         \
    X(FIXED_LESS_EQUAL, "bxx", FREE, NULL, NULL)                                                   \
    X(FIXED_EQUAL, "bxx", FREE, NULL, NULL)                                                        \
    X(FIXED_NOT_EQUAL, "bxx", FREE, NULL, NULL)                                                    \
    X(ARRAY_LOAD, "*f", FLOAT_MOVE, NULL, NULL)   /* result = array[operand 0] */                  \
    X(ARRAY_STORE, "0f*", FLOAT_MOVE, NULL, NULL) /* array[operand 0] = operand 1 */               \
    /* A call of node->external with 0 to 8 operands, emit_external.c. */                          \
    X(EXTERNAL0, "f", EXTERNAL_CALL, NULL, NULL)                                                   \
    X(EXTERNAL1, "ff", EXTERNAL_CALL, NULL, NULL)                                                  \
    X(EXTERNAL2, "fff", EXTERNAL_CALL, NULL, NULL)                                                 \
    X(EXTERNAL3, "ffff", EXTERNAL_CALL, NULL, NULL)                                                \
    X(EXTERNAL4, "fffff", EXTERNAL_CALL, NULL, NULL)                                               \
    X(EXTERNAL5, "ffffff", EXTERNAL_CALL, NULL, NULL)                                              \
    X(EXTERNAL6, "fffffff", EXTERNAL_CALL, NULL, NULL)                                             \
    X(EXTERNAL7, "ffffffff", EXTERNAL_CALL, NULL, NULL)                                            \
    X(EXTERNAL8, "fffffffff", EXTERNAL_CALL, NULL, NULL)                                           \
    X(TEXT_JOIN, "sss", FREE, "texts->join(texts, $0, $1)", NULL)                                  \
    X(TEXT_NUMBER, "ssfs", FREE, "texts->append_number(texts, $0, $1, $2)", NULL)                  \
    X(TEXT_MATCH, "fss", FREE, "texts->match(texts, $0, $1)", NULL)                                \
    X(MATERIAL, "f", FREE, NULL, NULL) /* component `index` of `parameter` */                      \
    X(BOUND, "f", FREE, NULL, NULL)    /* the same, bound */                                       \
    X(BOUND_STRING, "s", FREE, NULL, NULL)                                                         \
    X(GIVEN, "b", FREE, NULL, NULL)    /* whether `parameter` was given */                         \
    X(POSITION, "f", FREE, NULL, NULL) /* component `index` */                                     \
    X(INCIDENT, "f", FREE, NULL, NULL)                                                             \
    X(AMBIENT, "f", FLOAT_MOVE, NULL, NULL)   /* from the communication area of the lights */      \
    X(LIGHT_DIRECTION, "f", FREE, NULL, NULL) /* of the light of the illuminance around it */      \
    X(LIGHT_COLOR, "f", FREE, NULL, NULL)                                                          \
    /* Runs the lights at a place of its own (operands), as set `index` of results, for the        \
     * illuminances of which the result is the condition. */                                       \
    X(LIGHTS_AT, "bfff", FREE, NULL, NULL)                                                         \
    X(LIGHT_KNOWS, "b", FREE, NULL, NULL)  /* whether the light has what query `query` asks for */ \
    X(LIGHT_VALUE, "f", FREE, NULL, NULL)  /* its component `index` */                             \
    X(FROM_CAMERA, "fs", FREE, NULL, NULL) /* matrix element `index`; operand 0: the space */      \
    X(TO_CAMERA, "fs", FREE, NULL, NULL)

#endif
