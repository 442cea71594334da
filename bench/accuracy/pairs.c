/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include "base/hash.h"
#include "base/rng.h"
#include "shaders/simd/vector_reference.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = 4096 };

/* Where functions of two arguments are measured: pairs cannot be swept. Each way fills one block.
 */
enum pair_region {
    PAIRS_PATTERNS, /* any two floats */
    PAIRS_ORDINARY, /* numbers as shaders have them */
    PAIRS_HARD,     /* where the function is hard: see fill_hard */
    PAIRS_LATTICE,  /* every exponent against every exponent, few bits of mantissa */
    PAIRS_SPECIAL,  /* zeros, denormals, ones, infinities and NaNs against each other */
    PAIRS_REGION_COUNT
};
static const char *const region_names[] = {"any two floats", "ordinary numbers", "hard regions",
                                           "lattice of exponents", "special values"};

static float float_of_bits(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static float uniform(struct rng *rng, double low, double high) {
    return (float)(low + (high - low) * rng_unit(rng));
}

/* pow: bases near 1 with large exponents, results near the ends of the range; atan2: angles near
 * multiples of pi/4 and quotients near the smallest; mod: quotients near whole numbers. */
static void fill_hard(const char *name, struct rng *rng, float *x, float *y) {
    for (int i = 0; i < BLOCK; i++) {
        if (strncmp(name, "pow", 3) == 0) {
            const int way = i % 3;
            x[i] = way == 0 ? uniform(rng, 0.999, 1.001) : uniform(rng, 1e-3, 1e3);
            const double end = way == 1 ? 128.0 : -149.5, limit = end / log2((double)x[i]);
            y[i] = way == 0 ? uniform(rng, -150000, 150000)
                            : (float)(limit * (1 + 1e-4 * (rng_unit(rng) - 0.5)));
        } else if (strncmp(name, "atan2", 5) == 0) {
            const int way = i % 4;
            y[i] = uniform(rng, -1, 1);
            x[i] = way == 0   ? y[i] * (1 + uniform(rng, -1e-6, 1e-6))
                   : way == 1 ? uniform(rng, -1e-30, 1e-30)
                   : way == 2 ? -1 / uniform(rng, 0, 1e-38)
                              : y[i] * uniform(rng, -1e-4, 1e-4);
        } else {
            y[i] = uniform(rng, -10, 10);
            x[i] = y[i] * (float)(int64_t)rng_below(rng, 1 << 20);
            x[i] = nextafterf(x[i], i & 1 ? INFINITY : -INFINITY);
        }
    }
}

/* Block k of 256: 16 x 16 pairs of (sign, exponent), each with 16 pairs of mantissas. */
static void fill_lattice(uint32_t block, float *x, float *y) {
    for (uint32_t i = 0; i < BLOCK; i++) {
        uint32_t high_x = (block >> 4) * 32 + (i >> 4 & 15) * 2 + (i & 1),
                 high_y = (block & 15) * 32 + (i >> 8 & 15) * 2 + (i >> 1 & 1);
        x[i] = float_of_bits(high_x << 23 | (i >> 2 & 1) * 0x2aaaab | (i & 1) * 0x400001);
        y[i] = float_of_bits(high_y << 23 | (i >> 3 & 1) * 0x555555 | (i >> 1 & 1) * 0x3fffff);
    }
}

static const float specials[] = {0.0f,
                                 0x1p-149f,
                                 0x1p-126f,
                                 0x1.fffffcp-127f,
                                 0.25f,
                                 0.5f,
                                 0x1.fffffep-1f,
                                 1.0f,
                                 0x1.000002p0f,
                                 1.5f,
                                 2.0f,
                                 3.0f,
                                 0x1p23f,
                                 0x1p24f,
                                 0x1p31f,
                                 0x1p64f,
                                 0x1.fffffep127f,
                                 INFINITY,
                                 NAN,
                                 100.0f,
                                 149.0f,
                                 150.0f,
                                 127.0f,
                                 128.0f,
                                 0x1.8p0f,
                                 0x1.62e43p6f};

static void fill_special(float *x, float *y) {
    const uint32_t count = sizeof specials / sizeof *specials;
    for (uint32_t i = 0; i < BLOCK; i++) {
        const uint32_t pair = i % (4 * count * count);
        x[i] = specials[pair / 4 % count] * (pair & 1 ? -1.0f : 1.0f);
        y[i] = specials[pair / 4 / count] * (pair & 2 ? -1.0f : 1.0f);
    }
}

static void fill_pairs(enum pair_region region, const char *name, uint32_t block, float *x,
                       float *y) {
    struct rng rng = {(uint64_t)region << 32 | block};
    for (int i = 0; i < BLOCK; i++) {
        const uint64_t bits = rng_next(&rng);
        x[i] = float_of_bits((uint32_t)bits);
        y[i] = float_of_bits((uint32_t)(bits >> 32));
    }
    if (region == PAIRS_ORDINARY)
        for (int i = 0; i < BLOCK; i++) {
            x[i] = uniform(&rng, strncmp(name, "pow", 3) == 0 ? 0 : -20, 20);
            y[i] = uniform(&rng, -20, 20);
        }
    if (region == PAIRS_HARD)
        fill_hard(name, &rng, x, y);
    else if (region == PAIRS_LATTICE)
        fill_lattice(block % 256, x, y);
    else if (region == PAIRS_SPECIAL)
        fill_special(x, y);
}

static void measure_region(const struct vector_function *function, enum pair_region region,
                           uint32_t blocks, struct sweep_result *result) {
    static float x[BLOCK], y[BLOCK], out[BLOCK];
    const struct vector_reference *reference = vector_reference_find(function->name);
    if (region == PAIRS_SPECIAL)
        blocks = 1;
    for (uint32_t block = 0; block < blocks; block++) {
        fill_pairs(region, function->name, block, x, y);
        function->apply((const float *[]){x, y}, (float *[]){out}, BLOCK);
        result->hash = hash_bytes(out, sizeof out, result->hash);
        result->inputs += BLOCK;
        for (int i = 0; i < BLOCK; i++) {
            /* mod keeps fewer digits beyond these quotients (docs/accuracy.md) */
            if (strcmp(function->name, "mod") == 0 && !(fabs((double)x[i] / y[i]) < 0x1p29))
                continue;
            const double truth = reference->f2(x[i], y[i]), error = vector_ulp_error(out[i], truth);
            const float rounded = (float)truth;
            result->wrongly_rounded += !(rounded == out[i] || (isnan(rounded) && isnan(out[i])));
            if (isfinite(truth) && isfinite(out[i])) {
                const double difference = fabs(out[i] - truth);
                result->absolute_max = fmax(result->absolute_max, difference);
                if (fabs(truth) > 0x1p-126 && fabs(truth) < 0x1p127)
                    result->relative_max = fmax(result->relative_max, difference / fabs(truth));
            }
            if (error > result->ulp_max) {
                result->ulp_max = error;
                memcpy(&result->ulp_max_at, &x[i], sizeof x[i]);
                memcpy(&result->ulp_max_at_second, &y[i], sizeof y[i]);
            }
        }
    }
}

void pairs_measure(const struct vector_function *function, int ordinary_only, uint32_t blocks,
                   struct sweep_result *result) {
    *result = (struct sweep_result){0};
    for (int region = 0; region < PAIRS_REGION_COUNT; region++)
        if (region == PAIRS_ORDINARY || !ordinary_only)
            measure_region(function, (enum pair_region)region, blocks, result);
}

void pairs_table(const struct vector_function *function, uint32_t blocks) {
    for (int region = 0; region < PAIRS_REGION_COUNT; region++) {
        struct sweep_result r = {0};
        float x, y;
        measure_region(function, (enum pair_region)region, blocks, &r);
        memcpy(&x, &r.ulp_max_at, sizeof x);
        memcpy(&y, &r.ulp_max_at_second, sizeof y);
        printf("%-12s %-21s %.6f ulp at (%a, %a), %" PRIu64 " of %" PRIu64
               " not correctly rounded, hash %016" PRIx64 "\n",
               function->name, region_names[region], r.ulp_max, (double)x, (double)y,
               r.wrongly_rounded, r.inputs, r.hash);
        fflush(stdout);
    }
}
