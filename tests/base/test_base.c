/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/arena.h"
#include "base/hash.h"
#include "base/rng.h"
#include "base/ticks.h"
#include "base/trace.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void tick_rate_makes_every_duration_whole(void **state) {
    (void)state;
    struct rng rng = {7};
    for (int round = 0; round < 2000; round++) {
        struct tick_rate rate = {1};
        uint64_t numerator[4], denominator[4];
        for (int i = 0; i < 4; i++) {
            numerator[i] = 1 + rng_below(&rng, 1000);
            denominator[i] = 1 + rng_below(&rng, 3000);
            assert_true(tick_rate_include(&rate, numerator[i], denominator[i], NULL));
        }
        for (int i = 0; i < 4; i++) {
            ticks duration;
            assert_true(ticks_from_seconds(rate, numerator[i], denominator[i], &duration, NULL));
            assert_true((unsigned __int128)(uint64_t)duration * denominator[i] ==
                        (unsigned __int128)numerator[i] * rate.per_s);
        }
        /* and it is the least such rate: no divisor of it will do */
        for (uint64_t prime = 2; prime < 3000; prime++) {
            if (rate.per_s % prime)
                continue;
            bool suffices = true;
            for (int i = 0; i < 4; i++)
                suffices &=
                    (unsigned __int128)numerator[i] * (rate.per_s / prime) % denominator[i] == 0;
            assert_false(suffices);
        }
    }
}

static void tick_rate_refuses_what_has_no_common_tick(void **state) {
    (void)state;
    struct tick_rate rate = {1};
    struct status status = {0};
    assert_true(tick_rate_include(&rate, 1, 999999937, &status));
    assert_false(tick_rate_include(&rate, 1, 999999999999999989u, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    assert_int_equal(rate.per_s, 999999937);
}

static void picoseconds_round_half_up_and_are_exact_at_5_ns(void **state) {
    (void)state;
    assert_int_equal(ticks_to_ps((struct tick_rate){200000000}, 8192), 40960000);
    assert_int_equal(ticks_to_ps((struct tick_rate){3}, 1), 333333333333);
    assert_int_equal(ticks_to_ps((struct tick_rate){3}, 2), 666666666667);
    assert_int_equal(ticks_to_ps((struct tick_rate){2000000000000u}, 1), 1); /* half a picosecond */
    assert_int_equal(ticks_to_ps((struct tick_rate){1}, TICKS_MAX), INT64_MAX);
}

static void time_arithmetic_saturates_instead_of_wrapping(void **state) {
    (void)state;
    assert_true(ticks_overflowed(ticks_add(TICKS_MAX - 1, 2)));
    assert_true(ticks_overflowed(ticks_multiply(TICKS_MAX / 2, 3)));
    assert_int_equal(ticks_add(TICKS_MAX - 2, 1), TICKS_MAX - 1);
}

static void hash_depends_on_every_bit_and_the_length(void **state) {
    (void)state;
    unsigned char bytes[200];
    struct rng rng = {3};
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)rng_next(&rng);
    for (size_t length = 1; length <= sizeof bytes; length++) {
        const uint64_t whole = hash_bytes(bytes, length, 1);
        assert_int_not_equal(whole, hash_bytes(bytes, length - 1, 1));
        for (size_t bit = 0; bit < length * 8; bit += 7) {
            bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
            assert_int_not_equal(whole, hash_bytes(bytes, length, 1));
            bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        }
    }
    /* zeros of different lengths, where padding could hide */
    memset(bytes, 0, sizeof bytes);
    for (size_t a = 0; a < 130; a++)
        for (size_t b = 0; b < a; b++)
            assert_int_not_equal(hash_bytes(bytes, a, 0), hash_bytes(bytes, b, 0));
}

static void random_numbers_stay_below_their_bound(void **state) {
    (void)state;
    struct rng rng = {1};
    int seen[7] = {0};
    for (int i = 0; i < 7000; i++)
        seen[rng_below(&rng, 7)]++;
    for (int i = 0; i < 7; i++)
        assert_in_range(seen[i], 850, 1150);
}

static void arena_keeps_to_its_limit(void **state) {
    (void)state;
    struct arena arena;
    arena_init(&arena, 1000);
    assert_non_null(arena_get(&arena, 900));
    assert_null(arena_get(&arena, 200));
    assert_null(arena_get(&arena, SIZE_MAX - 4));
    assert_string_equal(arena_format(&arena, "%d-%s", 5, "x"), "5-x");
    arena_finish(&arena);
}

static void inverse_matrix_undoes_the_matrix(void **state) {
    (void)state;
    struct rng rng = {11};
    for (int round = 0; round < 500; round++) {
        struct mat4 a =
            mat4_rotate(rng_unit(&rng) * 360, rng_unit(&rng), rng_unit(&rng), rng_unit(&rng) + 0.1);
        const struct mat4 move = mat4_translate(rng_unit(&rng), -rng_unit(&rng), 5),
                          scale = mat4_scale(0.5 + rng_unit(&rng), 2, -1);
        a = mat4_multiply(&a, &scale);
        a = mat4_multiply(&a, &move);
        struct mat4 inverse;
        assert_true(mat4_invert(&a, &inverse));
        const struct mat4 product = mat4_multiply(&a, &inverse);
        for (int i = 0; i < 16; i++)
            assert_true(fabs(product.m[i / 4][i % 4] - mat4_identity.m[i / 4][i % 4]) < 1e-12);
        /* a normal stays at a right angle to what it was at a right angle to */
        const struct vec3 tangent = {rng_unit(&rng), 1, -2}, other = {3, rng_unit(&rng), 1};
        const struct vec3 normal = vec3_cross(tangent, other);
        assert_true(fabs(vec3_dot(mat4_normal(&inverse, normal), mat4_vector(&a, tangent))) < 1e-9);
    }
    const struct mat4 flat = mat4_scale(1, 0, 1);
    struct mat4 untouched = mat4_identity;
    assert_false(mat4_invert(&flat, &untouched));
    assert_memory_equal(&untouched, &mat4_identity, sizeof untouched);
}

static void trace_keeps_the_last_lines(void **state) {
    (void)state;
    static struct trace trace;
    trace_init(&trace, "node", NULL);
    for (int i = 0; i < TRACE_LINES + 3; i++)
        trace_line(&trace, "line %d", i);
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    trace_dump(&trace, stream, 2);
    fclose(stream);
    assert_string_equal(text, "node: line 65\nnode: line 66\n");
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tick_rate_makes_every_duration_whole),
        cmocka_unit_test(tick_rate_refuses_what_has_no_common_tick),
        cmocka_unit_test(picoseconds_round_half_up_and_are_exact_at_5_ns),
        cmocka_unit_test(time_arithmetic_saturates_instead_of_wrapping),
        cmocka_unit_test(hash_depends_on_every_bit_and_the_length),
        cmocka_unit_test(random_numbers_stay_below_their_bound),
        cmocka_unit_test(arena_keeps_to_its_limit),
        cmocka_unit_test(inverse_matrix_undoes_the_matrix),
        cmocka_unit_test(trace_keeps_the_last_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
