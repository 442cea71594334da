/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include "base/hash.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Every function on 2^24 inputs with every instruction set: one hash of all results, which all sets
 * have to give, and all compilers (many_inputs.inc). */

enum { BLOCK = 4096, BLOCKS = 4096, ARGUMENTS_MAX = 3, RESULTS_MAX = 3 };

static const struct {
    const char *name;
    uint64_t hash;
} recorded[] = {
#include "many_inputs.inc"
};

struct run {
    const struct vector_function *function;
    atomic_uint next_block;
    uint64_t hashes[BLOCKS];
};

/* 64 bits that depend on both numbers (the finaliser of splitmix64). */
static uint64_t mix(uint64_t index, uint64_t argument) {
    uint64_t x = index * 0x9e3779b97f4a7c15u + argument * 0xbf58476d1ce4e5b9u + 1;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

static float of_bits(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Stratified: one of each `BLOCK` x `BLOCKS`-th part of all bit patterns, in their order. */
static float stratified(uint32_t index, uint64_t argument) {
    enum { PART = 256 };
    return of_bits(index * PART + (uint32_t)(mix(index, argument) % PART));
}

/* From low to high; without a rounding that a compiler could choose: 24 bits times a power of 2. */
static float ordinary(uint32_t index, uint64_t argument, float low, float step) {
    return low + (float)(mix(index, argument) >> 40) * step;
}

/* Functions of one argument: stratified bit patterns; of several: half of the first argument
 * stratified with any bit patterns for the others, half ordinary numbers. Noise: three quarters
 * coordinates to +-1024. */
static void fill(const struct vector_function *function, uint32_t block,
                 float in[ARGUMENTS_MAX][BLOCK]) {
    const int is_noise = strstr(function->name, "noise") != NULL;
    const int is_ordinary = is_noise ? block % 4 != 0 : function->inputs > 1 && block % 2 != 0;
    for (uint32_t i = 0; i < BLOCK; i++) {
        const uint32_t index = block * BLOCK + i;
        for (int a = 0; a < function->inputs; a++) {
            if (is_ordinary && is_noise)
                in[a][i] = ordinary(index, (uint64_t)a, -1024, 0x1p-13f);
            else if (is_ordinary)
                in[a][i] = ordinary(index, (uint64_t)a, a ? -16 : 0, a ? 0x1p-19f : 0x1p-20f);
            else
                in[a][i] = a ? of_bits((uint32_t)mix(index, (uint64_t)a)) : stratified(index, 0);
        }
    }
}

static void *work(void *argument) {
    static _Thread_local float in[ARGUMENTS_MAX][BLOCK], out[RESULTS_MAX][BLOCK];
    struct run *run = argument;
    uint32_t block;
    while ((block = atomic_fetch_add(&run->next_block, 1)) < BLOCKS) {
        fill(run->function, block, in);
        run->function->apply((const float *[]){in[0], in[1], in[2]},
                             (float *[]){out[0], out[1], out[2]}, BLOCK);
        run->hashes[block] = hash_bytes(out, (size_t)run->function->outputs * sizeof out[0], block);
    }
    return NULL;
}

static uint64_t hash_function(const struct vector_function *function, int threads) {
    struct run run = {.function = function};
    run_on_threads(threads, work, &run);
    return hash_bytes(run.hashes, sizeof run.hashes, 0);
}

static int is_recorded(const char *name, uint64_t hash) {
    for (size_t i = 0; i < sizeof recorded / sizeof *recorded; i++)
        if (strcmp(recorded[i].name, name) == 0)
            return recorded[i].hash == hash;
    return 0;
}

static const char *compiler(void) {
#ifdef __clang__
    return "Clang " __clang_version__;
#else
    return "GCC " __VERSION__;
#endif
}

static int check_function(const char *name, int threads) {
    uint64_t first = 0;
    int good = 1;
    for (int s = 0; s < vector_kernel_set_count; s++) {
        if (!vector_kernel_sets[s]->supported())
            continue;
        const uint64_t hash =
            hash_function(vector_kernels_find(vector_kernel_sets[s], name), threads);
        first = s == 0 ? hash : first;
        if (hash != first)
            printf("%s: %s gives %016" PRIx64 "\n", name, vector_kernel_sets[s]->name, hash);
        good = good && hash == first;
    }
    const int as_recorded = is_recorded(name, first);
    printf("{\"%s\", 0x%016" PRIx64 "},%s%s\n", name, first, good ? "" : " DIFFERENT",
           as_recorded ? "" : " NOT AS RECORDED");
    fflush(stdout);
    return good && as_recorded;
}

int same_bits_check(const char *only, int threads) {
    struct timespec start, end;
    int good = 1, functions = 0, sets = 0;
    clock_gettime(CLOCK_MONOTONIC, &start);
    printf("%s; 2^24 inputs a function;", compiler());
    for (int s = 0; s < vector_kernel_set_count; s++)
        if (vector_kernel_sets[s]->supported()) {
            printf(" %s", vector_kernel_sets[s]->name);
            sets++;
        }
    printf("\n");
    for (int f = 0; f < vector_kernel_sets[0]->function_count; f++) {
        const char *name = vector_kernel_sets[0]->functions[f].name;
        if (only && strcmp(only, name) != 0)
            continue;
        good = check_function(name, threads) && good;
        functions++;
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("%d functions, %d instruction sets: %s, %.0f s\n", functions, sets,
           good ? "the same bits, as recorded" : "NOT THE SAME",
           (double)(end.tv_sec - start.tv_sec) + (double)(end.tv_nsec - start.tv_nsec) * 1e-9);
    return good;
}
