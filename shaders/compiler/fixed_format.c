/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/fixed_format.h"

#include <math.h>
#include <stdio.h>

/* Bits before the binary point, the sign included. */
static int whole_bits(struct fixed_format f) {
    return f.size - f.exponent;
}

static int larger(int a, int b) {
    return a > b ? a : b;
}

/* Puts a format together from its whole bits and exponent, within the limits. */
static struct fixed_format fitted(int whole, int exponent, bool is_unsigned) {
    if (exponent > FIXED_EXPONENT_MAX)
        exponent = FIXED_EXPONENT_MAX;
    int size = whole + exponent;
    if (size > FIXED_SIZE_MAX) {
        exponent -= size - FIXED_SIZE_MAX;
        size = FIXED_SIZE_MAX;
    }
    if (exponent < FIXED_EXPONENT_MIN)
        exponent = FIXED_EXPONENT_MIN;
    return (struct fixed_format){(int16_t)(size < 1 ? 1 : size), (int16_t)exponent, is_unsigned};
}

/* Whole bits that hold the values of both; one more for an unsigned one among signed. */
static int common_whole(struct fixed_format a, struct fixed_format b) {
    const bool is_mixed = a.is_unsigned != b.is_unsigned;
    return larger(whole_bits(a) + (is_mixed && a.is_unsigned),
                  whole_bits(b) + (is_mixed && b.is_unsigned));
}

static struct fixed_format whole_format(struct fixed_format a, int more) {
    if (a.exponent <= 0)
        return a;
    const int whole = whole_bits(a);
    return fitted((whole < 1 ? 1 : whole) + more, 0, a.is_unsigned);
}

static struct fixed_format sqrt_format(struct fixed_format a) {
    const int whole = whole_bits(a) - !a.is_unsigned,        /* a root has no sign */
        half = whole >= 0 ? (whole + 1) / 2 : -(-whole / 2); /* rounded up */
    const int exponent = a.exponent >= 0 ? a.exponent : -(-a.exponent / 2);
    return fitted(half, exponent, true);
}

struct fixed_format fixed_result(enum fixed_rule rule, struct fixed_format a,
                                 struct fixed_format b) {
    const bool both_unsigned = a.is_unsigned && b.is_unsigned;
    const int exponent = larger(a.exponent, b.exponent);
    switch (rule) {
    case FIXED_ADD:
        return fitted(common_whole(a, b) + 1, exponent, both_unsigned);
    case FIXED_SUBTRACT:
        return fitted(common_whole(a, b) + 1, exponent, false);
    case FIXED_MULTIPLY:
        return fitted(whole_bits(a) + whole_bits(b), a.exponent + b.exponent, both_unsigned);
    case FIXED_DIVIDE: /* at most |a| over the smallest b; MIN / -1 wants one more */
        return fitted(whole_bits(a) + b.exponent + 1, exponent, both_unsigned);
    case FIXED_REMAINDER:
        return fitted(whole_bits(b), exponent, b.is_unsigned);
    case FIXED_COMMON:
        return fitted(common_whole(a, b), exponent, both_unsigned);
    case FIXED_NEGATE:
        return fitted(whole_bits(a) + 1, a.exponent, false);
    case FIXED_ABSOLUTE:
        return (struct fixed_format){a.size, a.exponent, true};
    case FIXED_FLOOR:
        return whole_format(a, 0);
    case FIXED_CEIL:
        return whole_format(a, 1);
    case FIXED_SQRT:
        return sqrt_format(a);
    case FIXED_RULE_COUNT:
        break;
    }
    return a;
}

struct fixed_format fixed_of_number(float number, int64_t *raw) {
    struct fixed_format format = {1, 0, true};
    *raw = 0;
    if (number == 0)
        return format;
    int exponent, size = 0;
    int64_t bits = (int64_t)ldexpf(frexpf(fabsf(number), &exponent), 24);
    exponent = 24 - exponent; /* number = bits * 2^-exponent */
    while (!(bits & 1)) {
        bits >>= 1;
        exponent--;
    }
    while (bits >> size)
        size++;
    if (exponent < 0) { /* a whole number keeps its last digits: fixed<4,0>, not fixed<1,-3> */
        const int shift = size - exponent <= 32 ? -exponent : 0;
        bits <<= shift;
        size += shift;
        exponent += shift;
    }
    *raw = number < 0 ? -bits : bits;
    return (struct fixed_format){(int16_t)(size + (number < 0)), (int16_t)exponent, number >= 0};
}

char *fixed_format_name(struct fixed_format format, char text[32]) {
    snprintf(text, 32, "%sfixed<%d,%d>", format.is_unsigned ? "unsigned " : "", format.size,
             format.exponent);
    return text;
}
