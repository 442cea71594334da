/* SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "shaders/compiler/fold.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <gmp.h>

/* Fixed-point arithmetic against rational numbers of any size: the result of every operation is the
 * exact one, rounded down to the exponent of its format and cut to its size (docs/language.md,
 * section 11). The model knows nothing of the code under test but the formats of operands and
 * result, and those it checks for themselves: a result that keeps everything loses nothing. */

struct model {
    mpq_t a, b, exact, scale;
    mpz_t whole, rest;
};

static struct model model;

static int set_up(void **state) {
    (void)state;
    mpq_inits(model.a, model.b, model.exact, model.scale, NULL);
    mpz_inits(model.whole, model.rest, NULL);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    mpq_clears(model.a, model.b, model.exact, model.scale, NULL);
    mpz_clears(model.whole, model.rest, NULL);
    return 0;
}

/* out = x * 2^n */
static void scale(mpq_t out, const mpq_t x, int n) {
    if (n >= 0)
        mpq_mul_2exp(out, x, (mp_bitcnt_t)n);
    else
        mpq_div_2exp(out, x, (mp_bitcnt_t)-n);
}

static void set_whole(mpz_t out, int64_t raw, bool is_unsigned) {
    const bool is_negative = !is_unsigned && raw < 0;
    const uint64_t magnitude = is_negative ? -(uint64_t)raw : (uint64_t)raw;
    mpz_import(out, 1, 1, sizeof magnitude, 0, 0, &magnitude);
    if (is_negative)
        mpz_neg(out, out);
}

static void set_value(mpq_t out, int64_t raw, struct fixed_format format) {
    set_whole(model.whole, raw, format.is_unsigned);
    mpq_set_z(out, model.whole);
    scale(out, out, -format.exponent);
}

/* floor(x * 2^exponent) modulo 2^size, as the format reads it. */
static int64_t cut(const mpq_t x, struct fixed_format format) {
    scale(model.scale, x, format.exponent);
    mpz_fdiv_q(model.whole, mpq_numref(model.scale), mpq_denref(model.scale));
    mpz_fdiv_r_2exp(model.rest, model.whole, (mp_bitcnt_t)format.size);
    uint64_t bits = 0;
    mpz_export(&bits, NULL, 1, sizeof bits, 0, 0, model.rest);
    if (!format.is_unsigned && format.size < 64 && bits >> (format.size - 1) & 1)
        bits |= ~(uint64_t)0 << format.size;
    return (int64_t)bits;
}

/* x rounded down to the exponent. */
static void round_down(mpq_t x, int exponent) {
    scale(x, x, exponent);
    mpz_fdiv_q(model.whole, mpq_numref(x), mpq_denref(x));
    mpq_set_z(x, model.whole);
    scale(x, x, -exponent);
}

/* The exact value of a OP b, operands brought to the exponent of the result where clauses 11.6 and
 * 11.9 say so. Leaves it in model.exact. */
static void compute(enum ir_operation operation, struct fixed_format result) {
    switch (operation) {
    case IR_FIXED_ADD:
    case IR_FIXED_SUBTRACT:
        round_down(model.a, result.exponent);
        round_down(model.b, result.exponent);
        (operation == IR_FIXED_ADD ? mpq_add : mpq_sub)(model.exact, model.a, model.b);
        break;
    case IR_FIXED_MULTIPLY:
        mpq_mul(model.exact, model.a, model.b);
        break;
    case IR_FIXED_DIVIDE:
        if (mpq_sgn(model.b))
            mpq_div(model.exact, model.a, model.b);
        else
            mpq_set_ui(model.exact, 0, 1);
        break;
    case IR_FIXED_REMAINDER:
        round_down(model.a, result.exponent);
        round_down(model.b, result.exponent);
        if (!mpq_sgn(model.b)) {
            mpq_set_ui(model.exact, 0, 1);
            break;
        }
        mpq_div(model.exact, model.a, model.b);
        round_down(model.exact, 0);
        mpq_mul(model.exact, model.exact, model.b);
        mpq_sub(model.exact, model.a, model.exact);
        break;
    case IR_FIXED_MIN:
    case IR_FIXED_MAX:
        mpq_set(model.exact, (mpq_cmp(model.a, model.b) < 0) == (operation == IR_FIXED_MIN)
                                 ? model.a
                                 : model.b);
        break;
    case IR_FIXED_NEGATE:
        round_down(model.a, result.exponent);
        mpq_neg(model.exact, model.a);
        break;
    case IR_FIXED_ABS:
        mpq_abs(model.exact, model.a);
        break;
    case IR_FIXED_CEIL:
        mpz_cdiv_q(model.whole, mpq_numref(model.a), mpq_denref(model.a));
        mpq_set_z(model.exact, model.whole);
        break;
    case IR_FIXED_ROUND: /* halves up */
        mpq_set_ui(model.exact, 1, 2);
        mpq_add(model.exact, model.a, model.exact);
        round_down(model.exact, 0);
        break;
    default:
        mpq_set(model.exact, model.a);
    }
}

/* The root is checked as floors are: r^2 <= x < (r + 1)^2 in units of the result. */
static int64_t root(struct fixed_format result) {
    if (mpq_sgn(model.a) <= 0)
        return 0;
    scale(model.scale, model.a, 2 * result.exponent);
    mpz_fdiv_q(model.whole, mpq_numref(model.scale), mpq_denref(model.scale));
    mpz_sqrt(model.whole, model.whole);
    uint64_t bits = 0;
    mpz_export(&bits, NULL, 1, sizeof bits, 0, 0, model.whole);
    return (int64_t)bits;
}

/* X(operation, rule of its result, operands) */
#define OPERATIONS(X)                                                                              \
    X(FIXED_ADD, FIXED_ADD, 2)                                                                     \
    X(FIXED_SUBTRACT, FIXED_SUBTRACT, 2)                                                           \
    X(FIXED_MULTIPLY, FIXED_MULTIPLY, 2)                                                           \
    X(FIXED_DIVIDE, FIXED_DIVIDE, 2)                                                               \
    X(FIXED_REMAINDER, FIXED_REMAINDER, 2)                                                         \
    X(FIXED_MIN, FIXED_COMMON, 2)                                                                  \
    X(FIXED_MAX, FIXED_COMMON, 2)                                                                  \
    X(FIXED_NEGATE, FIXED_NEGATE, 1)                                                               \
    X(FIXED_ABS, FIXED_ABSOLUTE, 1)                                                                \
    X(FIXED_CONVERT, FIXED_FLOOR, 1)                                                               \
    X(FIXED_CEIL, FIXED_CEIL, 1)                                                                   \
    X(FIXED_ROUND, FIXED_CEIL, 1)                                                                  \
    X(FIXED_SQRT, FIXED_SQRT, 1)
static const struct operation {
    enum ir_operation operation;
    enum fixed_rule rule;
    int operands;
    const char *name;
} operations[] = {
#define OPERATION_ENTRY(operation, rule, operands) {IR_##operation, rule, operands, #operation},
    OPERATIONS(OPERATION_ENTRY)
#undef OPERATION_ENTRY
};
enum { OPERATION_COUNT = sizeof operations / sizeof *operations };

static void check_one(const struct operation *op, const struct ir_operand *operands) {
    const struct fixed_format result =
        fixed_result(op->rule, operands[0].format, operands[1].format);
    set_value(model.a, operands[0].raw, operands[0].format);
    set_value(model.b, operands[1].raw, operands[1].format);
    compute(op->operation, result);
    const int64_t wanted =
        op->operation == IR_FIXED_SQRT ? root(result) : cut(model.exact, result);
    const int64_t got = fold_fixed(op->operation, operands, result);
    if (wanted != got) {
        char a[32], b[32], r[32];
        fail_msg("%s of %lld:%s and %lld:%s is %lld:%s, not %lld", op->name,
                 (long long)operands[0].raw, fixed_format_name(operands[0].format, a),
                 (long long)operands[1].raw, fixed_format_name(operands[1].format, b),
                 (long long)wanted, fixed_format_name(result, r), (long long)got);
    }
    /* formats keep all whole bits: unless the exponent had to give way, nothing is cut at the top;
     * the quotient alone is bounded by its rule and not by its operands' precision */
    if (op->operation != IR_FIXED_SQRT) {
        round_down(model.exact, result.exponent);
        set_value(model.a, got, result);
        if (mpq_cmp(model.a, model.exact)) {
            char r[32];
            fail_msg("%s: %s does not hold the result", op->name, fixed_format_name(result, r));
        }
    }
}

static void check_comparisons(const struct ir_operand *operands) {
    set_value(model.a, operands[0].raw, operands[0].format);
    set_value(model.b, operands[1].raw, operands[1].format);
    const int order = mpq_cmp(model.a, model.b);
    assert_int_equal(fold_fixed_comparison(IR_FIXED_LESS, operands), order < 0);
    assert_int_equal(fold_fixed_comparison(IR_FIXED_LESS_EQUAL, operands), order <= 0);
    assert_int_equal(fold_fixed_comparison(IR_FIXED_EQUAL, operands), order == 0);
    assert_int_equal(fold_fixed_comparison(IR_FIXED_NOT_EQUAL, operands), order != 0);
}

static void check_all(const struct ir_operand *operands, bool with_one) {
    for (int i = 0; i < OPERATION_COUNT; i++)
        if (operations[i].operands == 2 || with_one)
            check_one(&operations[i], operands);
    check_comparisons(operands);
}

static int64_t lowest(struct fixed_format format) {
    return format.is_unsigned ? 0 : INT64_MIN >> (64 - format.size);
}

static void every_pair_of_small_numbers_is_exact(void **state) {
    (void)state;
    static const int16_t exponents[] = {-2, 0, 1, 3, 5};
    for (int s = 0; s < 4 * 4 * 25; s++) {
        const struct fixed_format a = {(int16_t)(1 + s % 4), exponents[s / 16 % 5], s / 3 & 1},
                                  b = {(int16_t)(1 + s / 4 % 4), exponents[s / 80 % 5], s / 5 & 1};
        for (int64_t i = 0; i < 1 << a.size; i++)
            for (int64_t k = 0; k < 1 << b.size; k++) {
                const struct ir_operand operands[2] = {ir_fixed(lowest(a) + i, a),
                                                       ir_fixed(lowest(b) + k, b)};
                check_all(operands, k == 0);
            }
    }
}

static void every_pair_of_bytes_is_exact(void **state) {
    (void)state;
    static const struct fixed_format pairs[][2] = {{{8, 0, false}, {8, 0, false}},
                                                   {{8, 8, true}, {8, 4, false}},
                                                   {{8, 3, true}, {8, 6, true}}};
    for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++)
        for (int64_t i = 0; i < 256; i++)
            for (int64_t k = 0; k < 256; k++) {
                const struct ir_operand operands[2] = {
                    ir_fixed(lowest(pairs[p][0]) + i, pairs[p][0]),
                    ir_fixed(lowest(pairs[p][1]) + k, pairs[p][1])};
                check_all(operands, k == 0);
            }
}

static struct ir_operand draw(struct rng *rng) {
    struct fixed_format format = {(int16_t)(1 + rng_below(rng, 64)),
                                  (int16_t)(rng_below(rng, 201) - 70), rng_below(rng, 2) != 0};
    if (rng_below(rng, 2)) /* near each other, as shaders have them */
        format.exponent = (int16_t)(rng_below(rng, 40) - 4);
    uint64_t bits = rng_next(rng) >> (64 - format.size);
    const uint64_t kind = rng_below(rng, 8);
    if (kind == 0)
        bits = 0;
    else if (kind == 1)
        bits = (uint64_t)1 << (format.size - 1); /* the lowest, or half of the unsigned range */
    else if (kind == 2)
        bits = ~(uint64_t)0 >> (64 - format.size);
    if (!format.is_unsigned && format.size < 64 && bits >> (format.size - 1) & 1)
        bits |= ~(uint64_t)0 << format.size;
    return ir_fixed((int64_t)bits, format);
}

static void random_numbers_of_up_to_64_bits_are_exact(void **state) {
    (void)state;
    struct rng rng = {20261124};
    for (int i = 0; i < 200000; i++) {
        const struct ir_operand operands[2] = {draw(&rng), draw(&rng)};
        check_all(operands, true);
    }
}

static void conversions_round_down_and_wrap(void **state) {
    (void)state;
    struct rng rng = {7};
    for (int i = 0; i < 200000; i++) {
        const struct ir_operand from = draw(&rng);
        const struct fixed_format to = draw(&rng).format;
        set_value(model.a, from.raw, from.format);
        assert_int_equal(fold_fixed(IR_FIXED_CONVERT, &from, to), cut(model.a, to));
    }
}

static void floats_become_the_nearest_number_below_or_an_end(void **state) {
    (void)state;
    struct rng rng = {11};
    for (int i = 0; i < 300000; i++) {
        const struct fixed_format to = draw(&rng).format;
        uint32_t bits = (uint32_t)rng_next(&rng);
        if (i % 4) /* in or near the range */
            bits = (bits & 0x807fffffu) |
                   (uint32_t)((129 + to.size - to.exponent - (int)rng_below(&rng, 70)) & 255) << 23;
        float number;
        memcpy(&number, &bits, sizeof number);
        const struct ir_operand from = ir_float(number);
        const int64_t got = fold_fixed(IR_FIXED_FROM_FLOAT, &from, to);
        const int64_t most =
            to.is_unsigned ? (int64_t)(~(uint64_t)0 >> (64 - to.size)) : ~lowest(to);
        if (number != number) {
            assert_int_equal(got, 0);
        } else if (number - number != 0) {
            assert_int_equal(got, number > 0 ? most : lowest(to));
        } else {
            mpq_set_d(model.a, (double)number);
            set_value(model.b, most, to);
            round_down(model.a, to.exponent);
            if (mpq_cmp(model.a, model.b) > 0) {
                assert_int_equal(got, most);
                continue;
            }
            set_value(model.b, lowest(to), to);
            assert_int_equal(got, mpq_cmp(model.a, model.b) < 0 ? lowest(to) : cut(model.a, to));
        }
    }
}

static void floats_come_back_rounded_to_nearest_even(void **state) {
    (void)state;
    struct rng rng = {13};
    mpf_t x;
    mpf_init2(x, 256);
    for (int i = 0; i < 300000; i++) {
        const struct ir_operand from = draw(&rng);
        const float got = fold_fixed_to_float(&from);
        if (got - got != 0) { /* beyond the largest float and half a step */
            set_value(model.a, from.raw, from.format);
            mpq_set_d(model.b, 0x1.ffffffp127);
            mpq_abs(model.a, model.a);
            assert_true(mpq_cmp(model.a, model.b) >= 0);
            continue;
        }
        set_value(model.a, from.raw, from.format);
        /* no float is nearer: the neighbours are at least as far away */
        const float below = __builtin_nextafterf(got, -__builtin_inff()),
                    above = __builtin_nextafterf(got, __builtin_inff());
        mpq_set_d(model.b, (double)got);
        mpq_sub(model.exact, model.a, model.b);
        mpq_abs(model.exact, model.exact);
        const float others[2] = {below, above};
        for (int k = 0; k < 2; k++) {
            if (others[k] - others[k] != 0)
                continue;
            mpq_set_d(model.b, (double)others[k]);
            mpq_sub(model.b, model.a, model.b);
            mpq_abs(model.b, model.b);
            const int order = mpq_cmp(model.exact, model.b);
            uint32_t bits;
            memcpy(&bits, &got, sizeof bits);
            if (order > 0 || (order == 0 && bits & 1)) {
                char name[32];
                fail_msg("%lld:%s is not %a", (long long)from.raw,
                         fixed_format_name(from.format, name), (double)got);
            }
        }
    }
    mpf_clear(x);
}

static void numbers_written_out_are_held_exactly(void **state) {
    (void)state;
    struct rng rng = {17};
    for (int i = 0; i < 100000; i++) {
        const uint32_t bits = (uint32_t)rng_next(&rng);
        float number;
        memcpy(&number, &bits, sizeof number);
        if (number - number != 0 || __builtin_fabsf(number) > 0x1p60f)
            continue;
        int64_t raw;
        const struct fixed_format format = fixed_of_number(number, &raw);
        set_value(model.a, raw, format);
        mpq_set_d(model.b, (double)number);
        assert_int_equal(mpq_cmp(model.a, model.b), 0);
        assert_true(format.size <= 64 && (number < 0) == !format.is_unsigned);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pair_of_small_numbers_is_exact),
        cmocka_unit_test(every_pair_of_bytes_is_exact),
        cmocka_unit_test(random_numbers_of_up_to_64_bits_are_exact),
        cmocka_unit_test(conversions_round_down_and_wrap),
        cmocka_unit_test(floats_become_the_nearest_number_below_or_an_end),
        cmocka_unit_test(floats_come_back_rounded_to_nearest_even),
        cmocka_unit_test(numbers_written_out_are_held_exactly),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
