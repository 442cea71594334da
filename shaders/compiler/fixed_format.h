/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FIXED_FORMAT_H
#define FIXED_FORMAT_H

#include <stdbool.h>
#include <stdint.h>

/* Formats of fixed-point numbers, pfman's fixed<size,exponent> (PF section 3.1): a raw integer of
 * `size` bits, in two's complement unless unsigned, stands for raw * 2^-exponent. The rules that
 * give results their format keep all precision of the operands (the bottom-up pass of PF
 * section 6.3.2); docs/language.md states them clause by clause. */

enum {
    FIXED_SIZE_MAX = 64, /* bits */
    FIXED_EXPONENT_MIN = -512,
    FIXED_EXPONENT_MAX = 512,
};

struct fixed_format {
    int16_t size;     /* bits, 1 to FIXED_SIZE_MAX */
    int16_t exponent; /* FIXED_EXPONENT_MIN to FIXED_EXPONENT_MAX */
    bool is_unsigned;
};

/* The operations whose result has a format of its own.
 * X(NAME, operands) */
#define FIXED_RULES(X)                                                                             \
    X(ADD, 2)                                                                                      \
    X(SUBTRACT, 2)                                                                                 \
    X(MULTIPLY, 2)                                                                                 \
    X(DIVIDE, 2)                                                                                   \
    X(REMAINDER, 2)                                                                                \
    X(COMMON, 2) /* minimum, maximum, choice of two */                                             \
    X(NEGATE, 1)                                                                                   \
    X(ABSOLUTE, 1)                                                                                 \
    X(FLOOR, 1)                                                                                    \
    X(CEIL, 1) /* and round */                                                                     \
    X(SQRT, 1)
enum fixed_rule {
#define FIXED_RULE_ENUM(name, operands) FIXED_##name,
    FIXED_RULES(FIXED_RULE_ENUM)
#undef FIXED_RULE_ENUM
        FIXED_RULE_COUNT
};

/* The format of the result. When keeping everything takes more than FIXED_SIZE_MAX bits, fraction
 * bits are given up: the exponent is lowered until the result fits. `b` is ignored by rules of one
 * operand. */
struct fixed_format fixed_result(enum fixed_rule rule, struct fixed_format a,
                                 struct fixed_format b);

/* The smallest format that holds `number` exactly, and the raw integer. `number` is finite. */
struct fixed_format fixed_of_number(float number, int64_t *raw);

/* Bytes of pixel memory: whole bytes are allocated (PF section 6.3.2). */
static inline int fixed_bytes(struct fixed_format format) {
    return (format.size + 7) / 8;
}
static inline bool fixed_same(struct fixed_format a, struct fixed_format b) {
    return a.size == b.size && a.exponent == b.exponent && a.is_unsigned == b.is_unsigned;
}
/* "fixed<16,8>" or "unsigned fixed<16,8>" into `text` of at least 32 bytes; returns it. */
char *fixed_format_name(struct fixed_format format, char text[32]);

#endif
