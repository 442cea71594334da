/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include "base/hash.h"
#include "shaders/simd/vector_reference.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define BLOCK 65536
#define BLOCK_COUNT 65536

struct sweep {
    const struct vector_function *function;
    const struct vector_reference *reference; /* NULL: neither errors nor order are known */
    int without_errors;
    double low, high; /* domain of a fast function's promise */
    uint32_t step;
    atomic_uint next_block;
    uint64_t *block_hashes;
    pthread_mutex_t lock;
    struct sweep_result result; /* under the lock */
};

static float float_of_bits(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Where the fast functions' errors are promised; elsewhere they are only sane. */
static void find_domain(const char *name, double *low, double *high) {
    static const struct {
        const char *name;
        double low, high;
    } domains[] = {{"sin_fast", -8192, 8192},
                   {"cos_fast", -8192, 8192},
                   {"tan_fast", -8192, 8192},
                   {"asin_fast", -1, 1},
                   {"acos_fast", -1, 1},
                   {"exp_fast", -87.3, 88.7},
                   {"exp2_fast", -126, 127.999},
                   {"log_fast", 0x1p-126, 0x1.fffffep127},
                   {"log2_fast", 0x1p-126, 0x1.fffffep127}};
    *low = -0x1.fffffep127;
    *high = 0x1.fffffep127;
    for (size_t i = 0; i < sizeof domains / sizeof *domains; i++) {
        if (strcmp(domains[i].name, name) == 0) {
            *low = domains[i].low;
            *high = domains[i].high;
        }
    }
}

/* x[0] and y[0] are those before the block. */
static uint64_t count_breaks(const float *x, const float *y, uint32_t count, int direction) {
    uint64_t breaks = 0;
    for (uint32_t i = 1; i <= count; i++) {
        double rise = ((double)y[i] - y[i - 1]) * direction; /* NaN where one is or both are Inf */
        breaks += x[i] > x[i - 1] ? rise < 0.0 : x[i] < x[i - 1] && rise > 0.0;
    }
    return breaks;
}

static void judge(const struct sweep *sweep, const float *x, const float *y, uint32_t first,
                  struct sweep_result *found) {
    const struct vector_reference *reference = sweep->reference;
    for (uint32_t i = 1; i <= BLOCK / sweep->step; i++) {
        double truth = reference->f1(x[i]), error = vector_ulp_error(y[i], truth);
        if (error > found->ulp_max) {
            found->ulp_max = error;
            found->ulp_max_at = first + (i - 1) * sweep->step;
        }
        float rounded = (float)truth;
        found->wrongly_rounded += !(rounded == y[i] || (isnan(rounded) && isnan(y[i])));
        if ((double)x[i] >= sweep->low && (double)x[i] <= sweep->high && isfinite(truth)) {
            double difference = fabs(y[i] - truth);
            found->absolute_max = fmax(found->absolute_max, difference);
            if (truth != 0.0)
                found->relative_max = fmax(found->relative_max, difference / fabs(truth));
        }
    }
}

static void *work(void *argument) {
    struct sweep *sweep = argument;
    static _Thread_local float x[BLOCK + 1], y[BLOCK + 1];
    struct sweep_result found = {0};
    uint32_t count = BLOCK / sweep->step, block;
    while ((block = atomic_fetch_add(&sweep->next_block, 1)) < BLOCK_COUNT) {
        /* x[0] is the input before the block's first, for monotonicity; none before the two zeros
         */
        uint32_t first = block * BLOCK;
        x[0] = float_of_bits(first & 0x7fffffff ? first - sweep->step : first);
        for (uint32_t i = 0; i < count; i++)
            x[i + 1] = float_of_bits(first + i * sweep->step);
        sweep->function->apply((const float *[]){x}, (float *[]){y}, count + 1);
        sweep->block_hashes[block] = hash_bytes(y + 1, count * sizeof *y, block);
        if (sweep->reference && sweep->reference->monotone)
            found.monotone_breaks += count_breaks(x, y, count, sweep->reference->monotone);
        if (sweep->reference && !sweep->without_errors)
            judge(sweep, x, y, first, &found);
        found.inputs += count;
    }
    pthread_mutex_lock(&sweep->lock);
    struct sweep_result *total = &sweep->result;
    if (found.ulp_max > total->ulp_max) {
        total->ulp_max = found.ulp_max;
        total->ulp_max_at = found.ulp_max_at;
    }
    total->wrongly_rounded += found.wrongly_rounded;
    total->monotone_breaks += found.monotone_breaks;
    total->absolute_max = fmax(total->absolute_max, found.absolute_max);
    total->relative_max = fmax(total->relative_max, found.relative_max);
    total->inputs += found.inputs;
    pthread_mutex_unlock(&sweep->lock);
    return NULL;
}

void sweep_function(const struct vector_function *function, int with_errors, uint32_t step,
                    int threads, struct sweep_result *result) {
    struct sweep sweep = {.function = function,
                          .without_errors = !with_errors,
                          .step = step,
                          .lock = PTHREAD_MUTEX_INITIALIZER};
    struct timespec start, end;
    sweep.reference = vector_reference_find(function->name);
    find_domain(function->name, &sweep.low, &sweep.high);
    sweep.block_hashes = calloc(BLOCK_COUNT, sizeof *sweep.block_hashes);
    if (!sweep.block_hashes)
        abort();
    clock_gettime(CLOCK_MONOTONIC, &start);
    run_on_threads(threads, work, &sweep);
    clock_gettime(CLOCK_MONOTONIC, &end);
    sweep.result.is_monotone = sweep.reference && sweep.reference->monotone;
    *result = sweep.result;
    result->hash = hash_bytes(sweep.block_hashes, BLOCK_COUNT * sizeof *sweep.block_hashes, 0);
    result->seconds =
        (double)(end.tv_sec - start.tv_sec) + (double)(end.tv_nsec - start.tv_nsec) * 1e-9;
    free(sweep.block_hashes);
}
