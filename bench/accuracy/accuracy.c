/* SPDX-License-Identifier: Apache-2.0 */
/* Measures the functions of shaders/simd/vector_math.h over all floats, and their speed. See
 * docs/accuracy.md. */

#include "accuracy.h"

#include "shaders/simd/vector_reference.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "usage: accuracy [options] [FUNCTION...]\n"
    "Sweeps functions of one argument (all of them unless named) over all 2^32 floats and prints "
    "the largest error\n"
    "in units of the last place and where, results that are not the correctly rounded ones, breaks "
    "of\n"
    "monotonicity, a hash of all results, and for fast functions the errors on their domains.\n"
    "  --step N      every Nth float only (a power of two up to 65536)\n"
    "  --threads N   1 to 64 (default 2)\n"
    "  --set NAME    the instruction set (default: the widest this processor has)\n"
    "  --hash        only hashes, of every instruction set\n"
    "  --throughput  only nanoseconds a value\n";

struct options {
    uint32_t step;
    int threads, hash, throughput;
    const struct vector_kernels *kernels;
};

static void print_sweep(const struct vector_function *function, const struct options *options) {
    struct sweep_result r;
    sweep_function(function, 1, options->step, options->threads, &r);
    float at;
    memcpy(&at, &r.ulp_max_at, sizeof at);
    if (strstr(function->name, "_fast"))
        printf("%-12s absolute %.4g relative %.4g on its domain", function->name, r.absolute_max,
               r.relative_max);
    else
        printf("%-12s %.6f ulp at %a (0x%08" PRIx32 "), %" PRIu64 " of %" PRIu64
               " not correctly rounded, %" PRIu64 " monotonicity breaks",
               function->name, r.ulp_max, (double)at, r.ulp_max_at, r.wrongly_rounded, r.inputs,
               r.monotone_breaks);
    printf(", hash %016" PRIx64 ", %.0f s\n", r.hash, r.seconds);
    fflush(stdout);
}

static int print_hashes(const char *name, const struct options *options) {
    uint64_t first = 0;
    int same = 1;
    printf("%-12s", name);
    for (int s = 0; s < vector_kernel_set_count; s++) {
        struct sweep_result r;
        if (!vector_kernel_sets[s]->supported())
            continue;
        sweep_function(vector_kernels_find(vector_kernel_sets[s], name), 0, options->step,
                       options->threads, &r);
        first = s == 0 ? r.hash : first;
        same = same && r.hash == first;
        printf(" %s %016" PRIx64, vector_kernel_sets[s]->name, r.hash);
        fflush(stdout);
    }
    printf(" %s\n", same ? "same" : "DIFFERENT");
    fflush(stdout);
    return same;
}

static int run(const char *name, const struct options *options) {
    const struct vector_function *function = vector_kernels_find(options->kernels, name);
    if (!function) {
        fprintf(stderr, "accuracy: there is no function %s\n", name);
        return 0;
    }
    if (options->throughput) {
        throughput_table(name);
        return 1;
    }
    if (function->inputs != 1 || function->outputs != 1 ||
        (!options->hash && !vector_reference_find(name))) {
        fprintf(stderr, "accuracy: %s has no sweep: more than one argument, or no reference\n",
                name);
        return 0;
    }
    if (options->hash)
        return print_hashes(name, options);
    print_sweep(function, options);
    return 1;
}

static int parse(int argc, char **argv, struct options *options, int *first_name) {
    int i = 1;
    for (; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(argv[i], "--hash") == 0) {
            options->hash = 1;
        } else if (strcmp(argv[i], "--throughput") == 0) {
            options->throughput = 1;
        } else if (strcmp(argv[i], "--step") == 0) {
            long step = strtol(value, NULL, 10);
            if (step < 1 || step > 65536 || (step & (step - 1)) != 0)
                return 0;
            options->step = (uint32_t)step;
            i++;
        } else if (strcmp(argv[i], "--threads") == 0) {
            options->threads = (int)strtol(value, NULL, 10);
            if (options->threads < 1 || options->threads > 64)
                return 0;
            i++;
        } else if (strcmp(argv[i], "--set") == 0) {
            options->kernels = NULL;
            for (int s = 0; s < vector_kernel_set_count; s++)
                if (strcmp(vector_kernel_sets[s]->name, value) == 0 &&
                    vector_kernel_sets[s]->supported())
                    options->kernels = vector_kernel_sets[s];
            if (!options->kernels)
                return 0;
            i++;
        } else {
            return 0;
        }
    }
    *first_name = i;
    return 1;
}

int main(int argc, char **argv) {
    struct options options = {.step = 1, .threads = 2, .kernels = vector_kernels_best()};
    int first_name, good = 1;
    if (!parse(argc, argv, &options, &first_name)) {
        fputs(usage, stderr);
        return 2;
    }
    for (int i = first_name; i < argc; i++)
        good = run(argv[i], &options) && good;
    if (first_name < argc)
        return good ? 0 : 1;
    if (options.throughput) {
        throughput_table(NULL);
        return 0;
    }
    for (int f = 0; f < options.kernels->function_count; f++) {
        const struct vector_function *function = &options.kernels->functions[f];
        if (function->inputs == 1 && function->outputs == 1 &&
            (options.hash || vector_reference_find(function->name)))
            good = run(function->name, &options) && good;
    }
    return good ? 0 : 1;
}
