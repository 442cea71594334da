/* SPDX-License-Identifier: Apache-2.0 */
/* How fast the timing model is: region-node steps (one region on one rendering node with work) a
 * second on one core, for several sizes of cluster; and predict's 1,000 combinations of a frame of
 * 160 regions. Usage: solver_speed [RECORD] */
#include "base/rng.h"
#include "netsim/what_if.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { REGIONS = 160, RUNS = 7, COMBINATIONS = 1000 };

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Every node has work in every region: what a large scene on few nodes looks like. */
static double steps_per_s(const struct machine *machine, uint32_t nodes) {
    struct rng rng = {1};
    struct timing_region *regions = memory_get(REGIONS, sizeof *regions);
    struct timing_work *work = memory_get((size_t)REGIONS * nodes, sizeof *work);
    const uint32_t frames = 20000000 / (REGIONS * nodes) + 1;
    double rates[RUNS];
    for (uint32_t k = 0; k < REGIONS; k++) {
        regions[k] =
            (struct timing_region){1 + (uint32_t)rng_below(&rng, 3), (ticks)rng_below(&rng, 100000),
                                   work + (size_t)k * nodes, nodes};
        for (uint32_t i = 0; i < nodes; i++)
            work[(size_t)k * nodes + i] = (struct timing_work){i, (uint32_t)rng_below(&rng, 500)};
    }
    for (int run = 0; run < RUNS; run++) {
        struct timing_model *model = timing_model_create(machine, &strategy_chain, nodes, 16);
        const struct timing_frame frame = {100000, regions, REGIONS, NULL};
        struct timing_result result;
        const double begin = now_s();
        for (uint32_t f = 0; f < frames; f++)
            if (!timing_model_add_frame(model, &frame, &result, NULL))
                abort();
        rates[run] = (double)frames * REGIONS * nodes / (now_s() - begin);
        timing_model_destroy(model);
    }
    free(regions);
    free(work);
    qsort(rates, RUNS, sizeof *rates, compare_doubles);
    return rates[RUNS / 2];
}

static int predict_combinations(const char *path) {
    struct run_record *record;
    struct status status = {0};
    double times[RUNS];
    if (!record_read_file(path, &record, &status)) {
        fprintf(stderr, "%s\n", status.message);
        return 1;
    }
    struct what_if_solver *solver = what_if_solver_create(record);
    for (int run = 0; run < RUNS; run++) {
        const double begin = now_s();
        for (int i = 0; i < COMBINATIONS; i++) {
            struct what_if question = what_if_default(record);
            struct what_if_result result;
            question.rendering_nodes = 1 + (uint32_t)(i / 40);
            question.shading_nodes = 1 + (uint32_t)(i % 40);
            if (!what_if_solve(solver, &question, NULL, &result, &status)) {
                fprintf(stderr, "%s\n", status.message);
                return 1;
            }
        }
        times[run] = now_s() - begin;
    }
    qsort(times, RUNS, sizeof *times, compare_doubles);
    printf("%d combinations of %u frame(s) of %u regions: %.3f s (median of %d)\n", COMBINATIONS,
           record->frame_count, record->frames[0].region_count, times[RUNS / 2], RUNS);
    what_if_solver_destroy(solver);
    record_destroy(record);
    return 0;
}

int main(int argc, char **argv) {
    struct machine machine;
    struct status status = {0};
    if (!machine_read_file(MACHINES "/pixelflow.json", &machine, &status)) {
        fprintf(stderr, "%s\n", status.message);
        return 1;
    }
    static const uint32_t nodes[] = {1, 4, 16, 64, 1024, 16384};
    for (size_t i = 0; i < sizeof nodes / sizeof *nodes; i++)
        printf("%5u rendering nodes: %6.1f M region-node steps/s (median of %d)\n", nodes[i],
               1e-6 * steps_per_s(&machine, nodes[i]), RUNS);
    return argc > 1 ? predict_combinations(argv[1]) : 0;
}
