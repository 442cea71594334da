/* SPDX-License-Identifier: Apache-2.0 */
#include "samples.h"

#include "base/rng.h"

#include <math.h>
#include <string.h>

float sample_float(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

uint32_t sample_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

void sample_stratified(float *x, uint32_t block, uint32_t blocks) {
    uint32_t stratum = (uint32_t)(((uint64_t)1 << 32) / ((uint64_t)blocks * SAMPLE_BLOCK));
    struct rng rng = {block};
    for (uint32_t i = 0; i < SAMPLE_BLOCK; i++)
        x[i] = sample_float((i * blocks + block) * stratum + (uint32_t)rng_below(&rng, stratum));
}

void sample_patterns(float *x, uint64_t seed, uint32_t block) {
    struct rng rng = {seed << 32 | block};
    for (int i = 0; i < SAMPLE_BLOCK; i++)
        x[i] = sample_float((uint32_t)rng_next(&rng));
}

void sample_uniform(float *x, uint64_t seed, uint32_t block, double low, double high) {
    struct rng rng = {seed << 32 | block};
    for (int i = 0; i < SAMPLE_BLOCK; i++)
        x[i] = (float)(low + (high - low) * rng_unit(&rng));
}

static int add_neighbours(float *x, int count, double center) {
    uint32_t bits = sample_bits((float)fabs(center));
    for (int step = -2; step <= 2; step++) {
        if (step < 0 && bits < (uint32_t)-step)
            continue;
        float value = sample_float(bits + (uint32_t)step);
        x[count++] = value;
        x[count++] = -value;
    }
    return count;
}

int sample_special(float *x) {
    static const double centers[] = {0.0,
                                     0x1p-149,
                                     0x1p-126,
                                     0x1p-24,
                                     0x1p-12,
                                     0.25,
                                     0.5,
                                     0.70710678118654752,
                                     1.0,
                                     1.41421356237309505,
                                     1.0 + 0x1p-20,
                                     1.5,
                                     2.0,
                                     2.5,
                                     3.0,
                                     8.0,
                                     0x1p19,
                                     0x1p22,
                                     0x1p23,
                                     0x1p24,
                                     0x1p31,
                                     0x1p32,
                                     8192.0,
                                     255.0,
                                     256.0,
                                     1e30,
                                     0x1.fffffep127,
                                     88.7228391,
                                     87.3365448,
                                     103.972084,
                                     104.5,
                                     89.0,
                                     126.0,
                                     127.0,
                                     128.0,
                                     129.0,
                                     149.0,
                                     150.0,
                                     151.0,
                                     INFINITY,
                                     0x1p64,
                                     0x1p127};
    int count = 0;
    for (size_t i = 0; i < sizeof centers / sizeof *centers; i++)
        count = add_neighbours(x, count, centers[i]);
    for (int k = 1; k <= 100; k++)
        count = add_neighbours(x, count, k * 1.57079632679489661923);
    for (int k = 7; k < 127; k++)
        count = add_neighbours(x, count, ldexp(1.57079632679489661923, k));
    for (int k = -149; k < 128; k++) {
        x[count++] = (float)ldexp(1.0, k);
        x[count++] = (float)-ldexp(1.0, k);
    }
    const uint32_t nans[] = {0x7fc00000, 0xffc00000, 0x7f800001, 0xff812345, 0x7fffffff};
    for (size_t i = 0; i < sizeof nans / sizeof *nans; i++)
        x[count++] = sample_float(nans[i]);
    return count;
}
