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
    "Sweeps functions of one argument (all of them unless named) over all 2^32 floats and prints\n"
    "the largest error in units of the last place and where, results that are not the correctly\n"
    "rounded ones, breaks of monotonicity, a hash of all results and whether it is the recorded\n"
    "one, and for fast functions the errors on their domains. Functions of two arguments are\n"
    "measured on lattices, ordinary numbers, hard regions and special values.\n"
    "  --step N      every Nth float only (a power of two up to 65536)\n"
    "  --threads N   1 to 64 (default 2)\n"
    "  --set NAME    the instruction set (default: the widest this processor has)\n"
    "  --pairs N     blocks of 4096 pairs of each kind (default 256)\n"
    "  --order       without errors: hashes and breaks of monotonicity, much quicker\n"
    "  --hash        only hashes, of every instruction set\n"
    "  --same-bits   2^24 inputs of every function, of several arguments too, with every\n"
    "                instruction set (same_bits.sh: and with several compilers)\n"
    "  --special     only the table of special values\n"
    "  --compare     speed and error beside SLEEF, libmvec and the C library, in one run\n"
    "  --throughput  only nanoseconds a value\n"
    "Exit status: 1 when a hash of all inputs differs from the recorded one or between sets.\n";

enum mode {
    MODE_SWEEP,
    MODE_ORDER,
    MODE_HASH,
    MODE_SAME_BITS,
    MODE_SPECIAL,
    MODE_COMPARE,
    MODE_THROUGHPUT
};

struct options {
    uint32_t step, pair_blocks;
    int threads;
    enum mode mode;
    const struct vector_kernels *kernels;
};

/* Hashes of the results over all 2^32 inputs, of functions of one argument. */
static const struct {
    const char *name;
    uint64_t hash;
} recorded[] = {
#include "all_inputs.inc"
};

static int print_recorded(const char *name, uint64_t hash, uint32_t step) {
    for (size_t i = 0; step == 1 && i < sizeof recorded / sizeof *recorded; i++)
        if (strcmp(recorded[i].name, name) == 0) {
            printf(" %s", recorded[i].hash == hash ? "(as recorded)" : "(NOT AS RECORDED)");
            return recorded[i].hash == hash;
        }
    return 1;
}

static int print_sweep(const struct vector_function *function, const struct options *options) {
    struct sweep_result r;
    const int with_errors = options->mode == MODE_SWEEP;
    sweep_function(function, with_errors, options->step, options->threads, &r);
    float at;
    memcpy(&at, &r.ulp_max_at, sizeof at);
    printf("%-12s", function->name);
    if (with_errors && strstr(function->name, "_fast"))
        printf(" absolute %.4g relative %.4g on its domain,", r.absolute_max, r.relative_max);
    else if (with_errors)
        printf(" %.6f ulp at %a (0x%08" PRIx32 "), %" PRIu64 " of %" PRIu64
               " not correctly rounded,",
               r.ulp_max, (double)at, r.ulp_max_at, r.wrongly_rounded, r.inputs);
    if (r.is_monotone)
        printf(" %" PRIu64 " monotonicity breaks,", r.monotone_breaks);
    printf(" hash %016" PRIx64, r.hash);
    const int same = print_recorded(function->name, r.hash, options->step);
    printf(", %.0f s\n", r.seconds);
    fflush(stdout);
    return same;
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
    printf(" %s", same ? "same" : "DIFFERENT");
    same = print_recorded(name, first, options->step) && same;
    printf("\n");
    fflush(stdout);
    return same;
}

static int run(const struct vector_function *function, const struct options *options) {
    if (options->mode == MODE_HASH)
        return function->inputs != 1 || function->outputs != 1 ||
               print_hashes(function->name, options);
    if (function->inputs == 1 && function->outputs == 1)
        return print_sweep(function, options);
    if (function->inputs == 2 && vector_reference_find(function->name) &&
        options->mode == MODE_SWEEP)
        pairs_table(function, options->pair_blocks);
    return 1;
}

static int parse_count(const char *text, long low, long high, long *value) {
    char *end;
    *value = strtol(text, &end, 10);
    return end != text && !*end && *value >= low && *value <= high;
}

static const struct vector_kernels *find_set(const char *name) {
    for (int s = 0; s < vector_kernel_set_count; s++)
        if (strcmp(vector_kernel_sets[s]->name, name) == 0 && vector_kernel_sets[s]->supported())
            return vector_kernel_sets[s];
    return NULL;
}

static int parse_value(const char *option, const char *value, struct options *options) {
    long number = 0;
    int good = 1;
    if (strcmp(option, "--step") == 0) {
        good = parse_count(value, 1, 65536, &number) && (number & (number - 1)) == 0;
        options->step = (uint32_t)number;
    } else if (strcmp(option, "--threads") == 0) {
        good = parse_count(value, 1, 64, &number);
        options->threads = (int)number;
    } else if (strcmp(option, "--pairs") == 0) {
        good = parse_count(value, 1, 1 << 20, &number);
        options->pair_blocks = (uint32_t)number;
    } else if (strcmp(option, "--set") == 0) {
        options->kernels = find_set(value);
        good = options->kernels != NULL;
    } else {
        good = 0;
    }
    return good;
}

static int parse(int argc, char **argv, struct options *options, int *first_name) {
    static const struct {
        const char *name;
        enum mode mode;
    } modes[] = {{"--order", MODE_ORDER},         {"--hash", MODE_HASH},
                 {"--same-bits", MODE_SAME_BITS}, {"--special", MODE_SPECIAL},
                 {"--compare", MODE_COMPARE},     {"--throughput", MODE_THROUGHPUT}};
    int i = 1;
    for (; i < argc && strncmp(argv[i], "--", 2) == 0; i++) {
        int is_mode = 0;
        for (size_t m = 0; m < sizeof modes / sizeof *modes; m++)
            if (strcmp(argv[i], modes[m].name) == 0) {
                options->mode = modes[m].mode;
                is_mode = 1;
            }
        if (is_mode)
            continue;
        if (i + 1 == argc || !parse_value(argv[i], argv[i + 1], options))
            return 0;
        i++;
    }
    *first_name = i;
    return 1;
}

/* What the mode prints for a function, or for all (NULL). */
static int print(const char *name, const struct options *options) {
    if (options->mode == MODE_SAME_BITS)
        return same_bits_check(name, options->threads);
    if (options->mode == MODE_SPECIAL) {
        special_table(options->kernels);
        return 1;
    }
    if (options->mode == MODE_COMPARE) {
        compare_table(options->kernels, name, options->step == 1 ? 1024 : options->step,
                      options->threads);
        return 1;
    }
    if (options->mode == MODE_THROUGHPUT) {
        throughput_table(name);
        return 1;
    }
    int good = 1;
    for (int f = 0; f < options->kernels->function_count; f++)
        if (!name || strcmp(name, options->kernels->functions[f].name) == 0)
            good = run(&options->kernels->functions[f], options) && good;
    return good;
}

int main(int argc, char **argv) {
    struct options options = {
        .step = 1, .pair_blocks = 256, .threads = 2, .kernels = vector_kernels_best()};
    int first_name, good = 1;
    if (!parse(argc, argv, &options, &first_name)) {
        fputs(usage, stderr);
        return 2;
    }
    for (int i = first_name; i < argc; i++) {
        if (!vector_kernels_find(options.kernels, argv[i])) {
            fprintf(stderr, "accuracy: there is no function %s\n", argv[i]);
            return 2;
        }
        good = print(argv[i], &options) && good;
    }
    if (first_name == argc)
        good = print(NULL, &options);
    return good ? 0 : 1;
}
