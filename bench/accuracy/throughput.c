/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include "base/rng.h"

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

void throughput_measure(const struct vector_function *const *functions, int count, double *ns) {
    static float a[COUNT], b[COUNT], c[COUNT], out[3][COUNT];
    const float *in[3] = {a, b, c};
    float *results[3] = {out[0], out[1], out[2]};
    for (int f = 0; f < count; f++)
        ns[f] = 0;
    for (int round = 0; round < THROUGHPUT_ROUNDS; round++)
        for (int f = 0; f < count; f++) {
            if (!functions[f])
                continue;
            struct rng rng = {1};
            fill(functions[f]->name, &rng, a, b, c);
            functions[f]->apply(in, results, COUNT); /* warm up */
            double start = now_ns();
            for (int i = 0; i < 8; i++)
                functions[f]->apply(in, results, COUNT);
            double time = (now_ns() - start) / (8.0 * COUNT);
            if (round == 0 || time < ns[f])
                ns[f] = time;
        }
}

void throughput_table(const char *only) {
    enum { SETS_MAX = 8 };
    printf("ns a value, one thread, best of %d rounds of 8 x %d values\n%-14s", THROUGHPUT_ROUNDS,
           COUNT, "function");
    for (int s = 0; s < vector_kernel_set_count; s++)
        printf(" %14s", vector_kernel_sets[s]->name);
    printf("\n");
    for (int f = 0; f < vector_kernel_sets[0]->function_count; f++) {
        const char *name = vector_kernel_sets[0]->functions[f].name;
        if (only && strcmp(only, name) != 0)
            continue;
        const struct vector_function *functions[SETS_MAX] = {NULL};
        double ns[SETS_MAX];
        for (int s = 0; s < vector_kernel_set_count && s < SETS_MAX; s++)
            if (vector_kernel_sets[s]->supported())
                functions[s] = &vector_kernel_sets[s]->functions[f];
        throughput_measure(functions, vector_kernel_set_count, ns);
        printf("%-14s", name);
        for (int s = 0; s < vector_kernel_set_count; s++)
            functions[s] ? printf(" %14.3f", ns[s]) : printf(" %14s", "-");
        printf("\n");
        fflush(stdout);
    }
}
