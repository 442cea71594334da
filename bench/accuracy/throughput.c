/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include "base/rng.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define COUNT 4096

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

/* Arguments as shaders have them. */
static void fill(const char *name, struct rng *rng, float *a, float *b, float *c) {
    double low = -8.0, high = 8.0;
    if (strncmp(name, "asin", 4) == 0 || strncmp(name, "acos", 4) == 0)
        low = -1.0, high = 1.0;
    else if (strncmp(name, "log", 3) == 0 || strncmp(name, "pow", 3) == 0 || strstr(name, "sqrt"))
        low = 0.0;
    else if (strstr(name, "noise"))
        low = -100.0, high = 100.0;
    for (int i = 0; i < COUNT; i++) {
        a[i] = (float)(low + (high - low) * rng_unit(rng));
        b[i] = (float)(low + (high - low) * rng_unit(rng));
        c[i] = (float)(low + (high - low) * rng_unit(rng));
    }
}

/* Best of `rounds`, nanoseconds a value, with arrays that stay in the first-level cache. */
static double measure(const struct vector_function *function, int rounds) {
    static float a[COUNT], b[COUNT], c[COUNT], out[3][COUNT];
    struct rng rng = {1};
    fill(function->name, &rng, a, b, c);
    const float *in[3] = {a, b, c};
    float *results[3] = {out[0], out[1], out[2]};
    double best = 1e30;
    for (int round = 0; round < rounds; round++) {
        double start = now_ns();
        for (int i = 0; i < 8; i++)
            function->apply(in, results, COUNT);
        double ns = (now_ns() - start) / (8.0 * COUNT);
        if (ns < best)
            best = ns;
    }
    return best;
}

/* The C library's function of one float, called in a loop, for comparison. */
static float (*library_function(const char *name))(float) {
    static const struct {
        const char *name;
        float (*function)(float);
    } library[] = {{"sin", sinf},   {"cos", cosf},   {"tan", tanf}, {"asin", asinf},
                   {"acos", acosf}, {"atan", atanf}, {"exp", expf}, {"exp2", exp2f},
                   {"log", logf},   {"log2", log2f}};
    for (size_t i = 0; i < sizeof library / sizeof *library; i++)
        if (strcmp(library[i].name, name) == 0)
            return library[i].function;
    return NULL;
}

static float (*volatile called)(float);

static void apply_library(const float *const *in, float *const *out, size_t count) {
    float (*function)(float) = called;
    for (size_t i = 0; i < count; i++)
        out[0][i] = function(in[0][i]);
}

void throughput_table(const char *only) {
    printf("ns a value, one thread, best of 40 rounds of 8 x %d values\n%-14s", COUNT, "function");
    for (int s = 0; s < vector_kernel_set_count; s++)
        printf(" %14s", vector_kernel_sets[s]->name);
    printf(" %14s\n", "C library");
    for (int f = 0; f < vector_kernel_sets[0]->function_count; f++) {
        const char *name = vector_kernel_sets[0]->functions[f].name;
        if (only && strcmp(only, name) != 0)
            continue;
        printf("%-14s", name);
        for (int s = 0; s < vector_kernel_set_count; s++) {
            if (vector_kernel_sets[s]->supported())
                printf(" %14.3f", measure(&vector_kernel_sets[s]->functions[f], 40));
            else
                printf(" %14s", "-");
        }
        called = library_function(name);
        if (called)
            printf(" %14.3f", measure(&(struct vector_function){name, 1, 1, apply_library}, 40));
        printf("\n");
    }
}
