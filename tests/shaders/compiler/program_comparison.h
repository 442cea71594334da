/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROGRAM_COMPARISON_H
#define PROGRAM_COMPARISON_H

#include "program_bundle.h"
#include "random_program.h"

/* Random programs run both ways: compiled, and by the reference evaluator. */

enum { COMPARISON_LIGHTS = 8 };

struct comparison_result {
    int differences; /* programs that differ, or that one of the two refuses */
    /* of the first of them: */
    uint64_t seed;
    int sample;
    float compiled[3], reference[3];
    char message[2048]; /* why it could not be compared; empty when it was */
};

/* The settings of the bundle of COMPARISON_BUNDLE programs from a seed on: all widths and both
 * compilers without optimisation, which is a fifth of the work; the flags of shaders in use (-O2)
 * once in COMPARISON_FULL. */
enum { COMPARISON_BUNDLE = 400, COMPARISON_FULL = 20 };
const struct bundle_settings *comparison_settings_of(uint64_t first_seed);

/* Compares `count` programs of consecutive seeds on 16 samples each, under up to three of eight
 * lights drawn from the first seed. True when all agree. When the C compiler refuses, differences
 * is `count` and the seed the first. */
bool comparison_run(uint64_t first_seed, int count, const struct bundle_settings *settings,
                    struct comparison_result *result);

/* What there is to say about the first program that differs, of the bundle that begins at
 * `first_seed`: its text, with statements removed for as long as it still differs, the lights it
 * ran under, and both results. The caller's to free. */
char *comparison_report(uint64_t first_seed, const struct bundle_settings *settings,
                        const struct comparison_result *result);

#endif
