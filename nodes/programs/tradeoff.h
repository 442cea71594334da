/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TRADEOFF_H
#define TRADEOFF_H

#include "base/status.h"

#include <stdint.h>
#include <stdio.h>

/* `sortlast tradeoff`: what speed costs in accuracy, knob by knob and together. */
int tradeoff_main(int argc, char **argv);

/* What may be chosen. Value 0 of each knob is the most accurate.
 *
 * X(NAME, key, option of `sortlast render`, values, where it applies and what it trades) */
#define TRADEOFF_KNOBS(X)                                                                          \
    X(SAMPLES, "samples", "--samples", ({"16", "4", "1"}),                                         \
      "samples a pixel: shading and composition against edges")                                    \
    X(CHORD, "chord", "--chord", ({"0.1", "0.5", "2"}),                                            \
      "dicing tolerance in pixels: triangles against silhouettes")                                 \
    X(PARAMETERS, "parameters", "--parameters", ({"float", "half"}),                               \
      "parameters on the composition network: bytes against their digits")

enum { TRADEOFF_VALUES_MAX = 3, TRADEOFF_KNOBS_MAX = 32 };

/* A knob of this run: one of the table, or the functions of one shader. */
struct tradeoff_knob {
    char key[80];
    const char *option; /* NULL: `values[1]` is added to --fast-shaders */
    const char *values[TRADEOFF_VALUES_MAX];
    int value_count;
    const char *about;
};

struct tradeoff_setting {
    int choice[TRADEOFF_KNOBS_MAX]; /* value of each knob */
};

struct tradeoff_result {
    struct tradeoff_setting setting;
    int64_t time_ps, shading_ps; /* of the frames; shading: summed over the nodes */
    double bytes_per_sample;     /* on the composition network */
    int64_t map_bytes;           /* longest transfer map */
    double wall_s;
    double max_error, psnr_db, flip_mean, flip_max, square_error;
    bool is_on_frontier;
    char picture[64]; /* PNG, in the folder */
};

struct tradeoff_study {
    const char *scene;
    struct tradeoff_knob knobs[TRADEOFF_KNOBS_MAX];
    int knob_count;
    struct tradeoff_result *results; /* owned */
    size_t result_count, result_capacity;
    char identity[2048]; /* everything results depend on but the setting */
    int chosen;          /* result that the limits pick, -1: none */
};

/* "samples=4 parameters=half ..."; what differs from the most accurate setting, or "most accurate".
 */
void tradeoff_describe(const struct tradeoff_study *study, const struct tradeoff_setting *setting,
                       char *text, size_t size);

/* The next setting worth a run, or false: base, then each single change, then combinations that no
 * run so far dominates by prediction (times multiply, square errors add). `left` estimates how many
 * there are. */
bool tradeoff_next(const struct tradeoff_study *study, struct tradeoff_setting *setting,
                   size_t *left);
/* Marks the results that no other is at least as good as in simulated time and square error. */
void tradeoff_mark_frontier(struct tradeoff_study *study);

bool tradeoff_write_json(const struct tradeoff_study *study, const char *path,
                         struct status *status);
/* Results of an earlier run into a study whose knobs are known; other studies' files are refused.
 */
bool tradeoff_read_json(struct tradeoff_study *study, const char *path, struct status *status);
bool tradeoff_write_page(const struct tradeoff_study *study, const char *path,
                         struct status *status);

#endif
