/* SPDX-License-Identifier: Apache-2.0 */
/* Fixed-point as docs/language.md, section 11, has it: on rational numbers of any size, with the
 * formats of results derived here a second time. Only the lattice of noise is the compiler's own.
 */
#define SHADER_WIDTH 4
#include "reference_internal.h"

#include "shaders/simd/vector_fixed_noise.h"

#include <gmp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const struct fixed_format truth = {1, 0, true}; /* of 0 and 1 */

/* ---- formats: clauses 11.4 and 11.5 ---- */

static int whole_bits(struct fixed_format f) {
    return f.size - f.exponent;
}

static int larger(int a, int b) {
    return a > b ? a : b;
}

static struct fixed_format format_of(int whole, int exponent, bool is_unsigned) {
    if (exponent > FIXED_EXPONENT_MAX)
        exponent = FIXED_EXPONENT_MAX;
    if (whole + exponent > 64)
        exponent = 64 - whole;
    return (struct fixed_format){(int16_t)larger(whole + exponent, 1), (int16_t)exponent,
                                 is_unsigned};
}

/* The larger whole bits, an unsigned operand beside a signed one counting one more. */
static int common_whole(struct fixed_format a, struct fixed_format b) {
    const int more_a = a.is_unsigned && !b.is_unsigned, more_b = b.is_unsigned && !a.is_unsigned;
    return larger(whole_bits(a) + more_a, whole_bits(b) + more_b);
}

static struct fixed_format binary_format(int token, struct fixed_format a, struct fixed_format b) {
    const bool both = a.is_unsigned && b.is_unsigned;
    const int exponent = larger(a.exponent, b.exponent);
    switch (token) {
    case '+':
        return format_of(common_whole(a, b) + 1, exponent, both);
    case '-':
        return format_of(common_whole(a, b) + 1, exponent, false);
    case '*':
        return format_of(whole_bits(a) + whole_bits(b), a.exponent + b.exponent, both);
    case '/':
        return format_of(whole_bits(a) + b.exponent + 1, exponent, both);
    case '%':
        return format_of(whole_bits(b), exponent, b.is_unsigned);
    default: /* minimum, maximum */
        return format_of(common_whole(a, b), exponent, both);
    }
}

/* floor (`more` 0), ceil and round (1) */
static struct fixed_format whole_format(struct fixed_format a, int more) {
    return a.exponent <= 0 ? a : format_of(larger(whole_bits(a), 1) + more, 0, a.is_unsigned);
}

/* n / 2, rounded up */
static int half_up(int n) {
    return (n + 4096 + 1) / 2 - 2048;
}

static struct fixed_format root_format(struct fixed_format a) {
    const int exponent = a.exponent < 0 ? half_up(a.exponent) : a.exponent;
    return format_of(half_up(whole_bits(a) - (a.is_unsigned ? 0 : 1)), exponent, true);
}

/* ---- numbers ---- */

/* out = x 2^places */
static void scale(mpq_t out, const mpq_t x, int places) {
    if (places >= 0)
        mpq_mul_2exp(out, x, (mp_bitcnt_t)places);
    else
        mpq_div_2exp(out, x, (mp_bitcnt_t)-places);
}

static void load(mpq_t out, const struct reference_value *value) {
    const bool is_negative = !value->format.is_unsigned && value->raw < 0;
    const uint64_t size = is_negative ? -(uint64_t)value->raw : (uint64_t)value->raw;
    mpq_set_ui(out, (unsigned long)(size >> 32), 1);
    mpq_mul_2exp(out, out, 32);
    mpz_add_ui(mpq_numref(out), mpq_numref(out), (unsigned long)(size & 0xffffffffu));
    if (is_negative)
        mpq_neg(out, out);
    scale(out, out, -value->format.exponent);
}

/* x rounded down to `exponent` bits after the point. */
static void round_down(mpq_t x, int exponent) {
    scale(x, x, exponent);
    mpz_fdiv_q(mpq_numref(x), mpq_numref(x), mpq_denref(x));
    mpz_set_ui(mpq_denref(x), 1);
    scale(x, x, -exponent);
}

/* Rounded down, the low bits kept: clauses 11.6 and 11.10. */
static struct reference_value cut(const mpq_t exact, struct fixed_format format) {
    struct reference_value value = {.count = 1, .format = format};
    uint64_t bits = 0;
    mpq_t x;
    mpq_init(x);
    scale(x, exact, format.exponent);
    mpz_fdiv_q(mpq_numref(x), mpq_numref(x), mpq_denref(x));
    mpz_fdiv_r_2exp(mpq_numref(x), mpq_numref(x), (mp_bitcnt_t)format.size);
    for (int bit = 0; bit < format.size; bit++)
        bits |= (uint64_t)mpz_tstbit(mpq_numref(x), (mp_bitcnt_t)bit) << bit;
    mpq_clear(x);
    if (!format.is_unsigned && bits >> (format.size - 1) & 1)
        for (int bit = format.size; bit < 64; bit++)
            bits |= (uint64_t)1 << bit;
    value.raw = (int64_t)bits;
    return value;
}

int reference_fixed_order(const struct reference_value *a, const struct reference_value *b) {
    mpq_t x, y;
    mpq_inits(x, y, NULL);
    load(x, a);
    load(y, b);
    const int order = mpq_cmp(x, y);
    mpq_clears(x, y, NULL);
    return order;
}

/* ---- conversions ---- */

/* 11.11: a long double holds any float times a power of two, and any 64 bits. */
static struct reference_value from_float(float number, struct fixed_format format) {
    struct reference_value value = {.count = 1, .format = format};
    const int bits = format.size - (format.is_unsigned ? 0 : 1);
    const long double x = floorl(ldexpl((long double)number, format.exponent)),
                      end = ldexpl(1, bits);
    if (isnan(number))
        return value;
    if (x >= end)
        value.raw = (int64_t)(bits ? ~(uint64_t)0 >> (64 - bits) : 0);
    else if (x < (format.is_unsigned ? 0 : -end))
        value.raw = format.is_unsigned ? 0 : (int64_t)-end;
    else
        value.raw = x < 0 ? (int64_t)x : (int64_t)(uint64_t)x;
    return value;
}

float reference_fixed_float(const struct reference_value *value) {
    const long double whole =
        value->format.is_unsigned ? (long double)(uint64_t)value->raw : (long double)value->raw;
    return (float)ldexpl(whole, -value->format.exponent);
}

struct reference_value reference_fixed_number(float number, enum ast_type type) {
    return from_float(number, ast_type_format(type));
}

static struct reference_value of_truth(bool is_true) {
    return (struct reference_value){.count = 1, .raw = is_true, .format = truth};
}

struct reference_value reference_fixed_convert(const struct reference_value *value,
                                               enum ast_type from, enum ast_type to) {
    const struct fixed_format format = ast_type_format(to);
    if (from == TYPE_FLOAT)
        return from_float(value->part[0], format);
    struct reference_value number = *value;
    if (from == TYPE_BOOL)
        number = of_truth(value->truth);
    mpq_t x;
    mpq_init(x);
    load(x, &number);
    number = cut(x, format);
    mpq_clear(x);
    return number;
}

/* ---- operators ---- */

static void operate(int token, mpq_t result, mpq_t a, mpq_t b) {
    switch (token) {
    case '+':
        mpq_add(result, a, b);
        break;
    case '-':
        mpq_sub(result, a, b);
        break;
    case '*':
        mpq_mul(result, a, b);
        break;
    default: /* a / b, or a - b floor(a / b) */
        if (!mpq_sgn(b)) {
            mpq_set_ui(result, 0, 1);
            break;
        }
        mpq_div(result, a, b);
        if (token == '/')
            break;
        round_down(result, 0);
        mpq_mul(result, result, b);
        mpq_sub(result, a, result);
    }
}

struct reference_value reference_fixed_binary(int token, const struct reference_value *a,
                                              const struct reference_value *b) {
    const struct fixed_format format = binary_format(token, a->format, b->format);
    mpq_t x, y, exact;
    mpq_inits(x, y, exact, NULL);
    load(x, a);
    load(y, b);
    if (token != '*' && token != '/') { /* 11.6 */
        round_down(x, format.exponent);
        round_down(y, format.exponent);
    }
    operate(token, exact, x, y);
    const struct reference_value value = cut(exact, format);
    mpq_clears(x, y, exact, NULL);
    return value;
}

struct reference_value reference_fixed_negate(const struct reference_value *a) {
    const struct fixed_format format =
        format_of(whole_bits(a->format) + 1, a->format.exponent, false);
    mpq_t x;
    mpq_init(x);
    load(x, a);
    round_down(x, format.exponent);
    mpq_neg(x, x);
    const struct reference_value value = cut(x, format);
    mpq_clear(x);
    return value;
}

/* ---- functions ---- */

static struct reference_value extreme(bool is_minimum, const struct reference_value *a,
                                      const struct reference_value *b) {
    const bool is_first = reference_fixed_order(a, b) < 0;
    const struct fixed_format format = binary_format(0, a->format, b->format);
    return reference_fixed_convert(is_first == is_minimum ? a : b, TYPE_ANY_FIXED,
                                   ast_type_fixed(format));
}

/* Where the result is one number made from one: |x|, floor, ceil and round (halves up), root. */
static struct reference_value one_number(enum builtin_id id, const struct reference_value *a) {
    struct fixed_format format = whole_format(a->format, id == BUILTIN_FLOOR ? 0 : 1);
    mpq_t x, half;
    mpq_inits(x, half, NULL);
    load(x, a);
    switch (id) {
    case BUILTIN_ABS:
        format = (struct fixed_format){a->format.size, a->format.exponent, true};
        mpq_abs(x, x);
        break;
    case BUILTIN_FLOOR:
        round_down(x, 0);
        break;
    case BUILTIN_CEIL:
        mpq_neg(x, x);
        round_down(x, 0);
        mpq_neg(x, x);
        break;
    case BUILTIN_ROUND:
        mpq_set_ui(half, 1, 2);
        mpq_add(x, x, half);
        round_down(x, 0);
        break;
    default: /* the largest r with r^2 <= x, in units of the result */
        format = root_format(a->format);
        if (mpq_sgn(x) < 0)
            mpq_set_ui(x, 0, 1);
        scale(x, x, 2 * format.exponent);
        mpz_fdiv_q(mpq_numref(x), mpq_numref(x), mpq_denref(x));
        mpz_set_ui(mpq_denref(x), 1);
        mpz_sqrt(mpq_numref(x), mpq_numref(x));
        scale(x, x, -format.exponent);
    }
    const struct reference_value value = cut(x, format);
    mpq_clears(x, half, NULL);
    return value;
}

static struct reference_value sign(const struct reference_value *a) {
    const struct reference_value zero = of_truth(false);
    const int order = reference_fixed_order(a, &zero);
    return (struct reference_value){
        .count = 1, .raw = (order > 0) - (order < 0), .format = {2, 0, false}};
}

/* a (1 - t) + b t */
static struct reference_value mix(const struct reference_value *a) {
    const struct reference_value one = of_truth(true),
                                 rest = reference_fixed_binary('-', &one, &a[2]),
                                 near = reference_fixed_binary('*', &a[0], &rest),
                                 far = reference_fixed_binary('*', &a[1], &a[2]);
    return reference_fixed_binary('+', &near, &far);
}

/* 11.13; whole units repeat after 256, so that the low 32 bits of a coordinate say all. */
static struct reference_value noise(const struct reference_value *a, int count) {
    const struct fixed_format format = {15, 14, true};
    vi at[3] = {{0}};
    int exponent = 0;
    for (int i = 0; i < count; i++)
        exponent = larger(exponent, a[i].format.exponent);
    if (exponent > 22)
        exponent = 22;
    for (int i = 0; i < count; i++) {
        const struct fixed_format coordinate = {32, (int16_t)exponent, false};
        at[i] = vi_set(
            (int32_t)reference_fixed_convert(&a[i], TYPE_ANY_FIXED, ast_type_fixed(coordinate))
                .raw);
    }
    return (struct reference_value){
        .count = 1, .raw = vi_fixed_noise3(at[0], at[1], at[2], exponent)[0], .format = format};
}

struct reference_value reference_fixed_builtin(enum builtin_id id, const struct reference_value *a,
                                               int count) {
    struct reference_value value = a[0];
    switch (id) {
    case BUILTIN_MOD:
        return reference_fixed_binary('%', &a[0], &a[1]);
    case BUILTIN_MIN:
    case BUILTIN_MAX:
        for (int i = 1; i < count; i++)
            value = extreme(id == BUILTIN_MIN, &value, &a[i]);
        return value;
    case BUILTIN_CLAMP:
        value = extreme(false, &a[0], &a[1]);
        return extreme(true, &value, &a[2]);
    case BUILTIN_STEP:
        return of_truth(reference_fixed_order(&a[1], &a[0]) >= 0);
    case BUILTIN_SIGN:
        return sign(&a[0]);
    case BUILTIN_MIX:
        return mix(a);
    case BUILTIN_NOISE:
        return noise(a, count);
    case BUILTIN_ABS:
    case BUILTIN_FLOOR:
    case BUILTIN_CEIL:
    case BUILTIN_ROUND:
    case BUILTIN_SQRT:
        return one_number(id, &a[0]);
    default:
        fprintf(stderr, "the reference evaluator has no fixed-point builtin %d\n", (int)id);
        abort();
    }
}
