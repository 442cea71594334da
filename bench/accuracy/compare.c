/* SPDX-License-Identifier: Apache-2.0 */
#include "accuracy.h"

#include "peers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { EXACT, FAST, OWN_COUNT, COLUMNS = OWN_COUNT + PEER_COUNT };

struct row {
    const struct vector_function *functions[COLUMNS];
    double ns[COLUMNS];
    char error[COLUMNS][16];
};

/* The functions that other libraries have, too. */
static const char *const compared[] = {"sin", "cos",  "tan", "asin", "acos",  "atan",
                                       "exp", "exp2", "log", "log2", "atan2", "pow"};

/* In ulp; of a fast function what is promised of it: the relative error where results span many
 * powers of two, else the absolute one, over its domain. */
static void describe_error(const struct vector_function *function, uint32_t step, int threads,
                           char *text, size_t size) {
    const int is_fast = strstr(function->name, "_fast") != NULL;
    const int is_relative = strncmp(function->name, "exp", 3) == 0 ||
                            strncmp(function->name, "tan", 3) == 0 ||
                            strncmp(function->name, "pow", 3) == 0;
    struct sweep_result r = {0};
    if (function->inputs == 1)
        sweep_function(function, 1, step, threads, &r);
    else
        pairs_measure(function, is_fast, 64, &r);
    if (is_fast)
        snprintf(text, size, "%.1e %s", is_relative ? r.relative_max : r.absolute_max,
                 is_relative ? "rel" : "abs");
    else
        snprintf(text, size,
                 isinf(r.ulp_max)  ? "wrong special"
                 : r.ulp_max < 1e4 ? "%.3f"
                                   : "%.1e",
                 r.ulp_max);
}

static void find_functions(const struct vector_kernels *kernels, const char *name,
                           struct row *row) {
    const struct peer_set *peers = peers_of_width(kernels->width);
    char fast[32];
    snprintf(fast, sizeof fast, "%s_fast", name);
    row->functions[EXACT] = vector_kernels_find(kernels, name);
    row->functions[FAST] = vector_kernels_find(kernels, fast);
    for (int p = 0; p < PEER_COUNT; p++)
        row->functions[OWN_COUNT + p] = peers_find(peers, (enum peer_library)p, name);
}

/* Of functions that both columns have. */
static double geometric_mean_ratio(const struct row *rows, int count, int column, int to) {
    double sum = 0;
    int counted = 0;
    for (int i = 0; i < count; i++) {
        if (rows[i].functions[column] && rows[i].functions[to]) {
            sum += log(rows[i].ns[column] / rows[i].ns[to]);
            counted++;
        }
    }
    return counted ? exp(sum / counted) : NAN;
}

static void print_heading(const char *what) {
    printf("%-8s %14s %14s", what, "exact", "fast");
    for (int p = 0; p < PEER_COUNT; p++)
        printf(" %14s", peer_headings[p]);
    printf("\n");
}

void compare_table(const struct vector_kernels *kernels, const char *only, uint32_t step,
                   int threads) {
    static struct row rows[sizeof compared / sizeof *compared];
    int count = 0;
    printf("%s; ns a value, one thread, best of %d interleaved rounds\n", kernels->name,
           THROUGHPUT_ROUNDS);
    print_heading("speed");
    for (size_t i = 0; i < sizeof compared / sizeof *compared; i++) {
        if (only && strcmp(only, compared[i]) != 0)
            continue;
        struct row *row = &rows[count++];
        find_functions(kernels, compared[i], row);
        throughput_measure(row->functions, COLUMNS, row->ns);
        printf("%-8s", compared[i]);
        for (int c = 0; c < COLUMNS; c++)
            row->functions[c] ? printf(" %14.3f", row->ns[c]) : printf(" %14s", "-");
        printf("\n");
        fflush(stdout);
    }
    printf("geometric means: exact %.2f of SLEEF u10, %.2f of libmvec, %.2f of glibc scalar; fast "
           "%.2f of SLEEF u35, %.2f of exact\n",
           geometric_mean_ratio(rows, count, EXACT, OWN_COUNT + PEER_SLEEF_U10),
           geometric_mean_ratio(rows, count, EXACT, OWN_COUNT + PEER_LIBMVEC),
           geometric_mean_ratio(rows, count, EXACT, OWN_COUNT + PEER_SCALAR),
           geometric_mean_ratio(rows, count, FAST, OWN_COUNT + PEER_SLEEF_U35),
           geometric_mean_ratio(rows, count, FAST, EXACT));
    printf("\nlargest error, ulp, every %uth float (pairs: a lattice)\n", step);
    print_heading("error");
    for (int i = 0; i < count; i++) {
        printf("%-8s", rows[i].functions[EXACT]->name);
        for (int c = 0; c < COLUMNS; c++) {
            if (rows[i].functions[c])
                describe_error(rows[i].functions[c], step, threads, rows[i].error[c],
                               sizeof rows[i].error[c]);
            printf(" %14s", rows[i].functions[c] ? rows[i].error[c] : "-");
        }
        printf("\n");
        fflush(stdout);
    }
}
