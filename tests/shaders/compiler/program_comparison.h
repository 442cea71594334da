/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROGRAM_COMPARISON_H
#define PROGRAM_COMPARISON_H

#include "program_bundle.h"
#include "random_program.h"

/* Random programs run both ways: compiled, and by the reference evaluator. */

enum { COMPARISON_LIGHTS = 8 };

struct comparison_settings {
    int width; /* 4, 8 or 16 */
    const char *optimisation;
};

struct comparison_result {
    uint64_t seed; /* of the first surface that differs */
    int sample;
    float compiled[3], reference[3];
    char message[2048]; /* why nothing could be compared; empty when something was */
};

/* Compares `count` programs of consecutive seeds on 16 samples each, under up to three of eight
 * lights drawn from the first seed. True when all agree. */
bool comparison_run(uint64_t first_seed, int count, const struct comparison_settings *settings,
                    struct comparison_result *result);

/* Removes statements from a program that differs for as long as it still differs, and returns what
 * is left, with the lights it ran under; the caller's to free. */
char *comparison_reduce(uint64_t seed, uint64_t first_seed,
                        const struct comparison_settings *settings);

#endif
