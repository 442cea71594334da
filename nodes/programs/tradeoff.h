/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TRADEOFF_H
#define TRADEOFF_H

#include "base/status.h"

#include <cjson/cJSON.h>
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
    X(PARAMETERS, "parameters", "--parameters", ({"float", "half", "fixed", "byte"}),              \
      "parameters on the composition network: bytes against their digits")                         \
    X(ASSIGNMENT, "assignment", "--assignment", ({"round-robin", "by-cost"}),                      \
      "regions to shading nodes, where there are several: by what each costs takes no accuracy")
#define TRADEOFF_UNWRAP(...) __VA_ARGS__

enum {
    TRADEOFF_VALUES_MAX = 4,
    TRADEOFF_KNOBS_MAX = 64,
    TRADEOFF_FRAMES_MAX = 64, /* of a list; frames after the 64th are not judged unless asked for */
    TRADEOFF_JUDGED_MAX = 8   /* frames that are judged unless asked for */
};

/* A knob of this run: one of the table, all functions of one shader, or those of one place in it.
 * Functions are those that the array is issued: where values are uniform, exact ones cost nothing.
 */
struct tradeoff_knob {
    char key[240];
    const char *option; /* NULL: of functions */
    char *calls;        /* of functions: what --fast-calls gets; owned */
    char *use;          /* of a shader in fixed-point: what --use gets; owned */
    int shader;         /* of a place: the knob of its shader; -1 */
    const char *values[TRADEOFF_VALUES_MAX];
    int value_count;
    const char *about;
};

struct tradeoff_setting {
    int choice[TRADEOFF_KNOBS_MAX]; /* value of each knob */
};

/* Frames of the scene by their place in it, from 1 on. */
struct tradeoff_frames {
    int numbers[TRADEOFF_FRAMES_MAX];
    int count;
};

/* Of the worst frame; the square error is the mean of all. */
struct tradeoff_error {
    double max_error, psnr_db, flip_mean, flip_max, square_error;
};

struct tradeoff_result {
    struct tradeoff_setting setting;
    int64_t time_ps, shading_ps; /* of the frames tuned on; shading: summed over the nodes */
    double bytes_per_sample;     /* on the composition network */
    int64_t map_bytes;           /* longest transfer map */
    double wall_s;
    struct tradeoff_error error; /* on the frames tuned on */
    bool is_judged;
    int64_t judged_time_ps;
    struct tradeoff_error judged; /* on the frames that nothing was tuned on */
    bool is_refused; /* within the limits on the frames tuned on, and not on the others */
    bool is_on_frontier;
    char picture[64]; /* PNG, in the folder */
};

struct tradeoff_study {
    const char *scene;
    struct tradeoff_knob knobs[TRADEOFF_KNOBS_MAX];
    int knob_count;
    struct tradeoff_frames tuned, unseen;
    struct tradeoff_result *results; /* owned */
    size_t result_count, result_capacity;
    char identity[2048]; /* everything results depend on but the setting */
    int chosen;          /* result that the limits pick, -1: none */
};

struct tradeoff_options {
    const char *scene, *folder;
    double min_psnr, max_flip, max_error, max_time_ms; /* NAN: no limit */
    long runs;                                         /* at most */
    const char *reference_samples;
    const char *fixed; /* error that shaders in fixed-point are to keep; NULL: none are made */
    const char *tune_frames, *judge_frames; /* lists, NULL: as it fits the scene */
    char **forwarded;                       /* to `sortlast render` */
    int forwarded_count;
};

/* tradeoff_frames.c: "1,3-5"; without options the first is tuned on, and others are judged. */
bool tradeoff_choose_frames(const struct tradeoff_options *options, struct tradeoff_study *study,
                            struct status *status);
/* "1,3-5" again */
void tradeoff_describe_frames(const struct tradeoff_frames *frames, char *text, size_t size);

/* tradeoff_knobs.c: those of the table; regions are assigned where there are several nodes. */
void tradeoff_add_table_knobs(struct tradeoff_study *study, bool has_several_shading_nodes);
/* Knobs for the functions of shaders and, for those with several, of places in them: `calls` are
 * those of the summary of a run. Says on standard error for which there is no room. */
void tradeoff_add_call_knobs(struct tradeoff_study *study, const cJSON *calls);
/* The knob of this key, -1: there is none. */
int tradeoff_find_knob(const struct tradeoff_study *study, const char *key);
/* Whether it asks for fast calls in a shader that it replaces by one in fixed-point. */
bool tradeoff_contradicts(const struct tradeoff_study *study,
                          const struct tradeoff_setting *setting);
void tradeoff_finish_knobs(struct tradeoff_study *study);
/* "samples=4 parameters=half ..."; what differs from the most accurate setting, or "most accurate".
 */
void tradeoff_describe(const struct tradeoff_study *study, const struct tradeoff_setting *setting,
                       char *text, size_t size);
/* The options of a setting. The list is the caller's to free, with room for two more; it points
 * into `study` and `text`, which is the caller's, too. */
char **tradeoff_arguments(const struct tradeoff_study *study,
                          const struct tradeoff_setting *setting, int *count, char **text);

/* tradeoff_fixed.c: knobs for the shaders of these instances of a summary, as far as they can be
 * made fixed-point; nothing without options->fixed. False when interrupted. */
bool tradeoff_add_fixed_knobs(const struct tradeoff_options *options, struct tradeoff_study *study,
                              const cJSON *instances, struct status *status);

/* tradeoff_run.c: the pictures that errors are measured against; `summary` of the first of `frames`
 * may be NULL. */
bool tradeoff_make_references(const struct tradeoff_options *options,
                              const struct tradeoff_frames *frames, cJSON **summary,
                              struct status *status);
/* Runs a setting on the frames to be tuned on, and adds the result. */
bool tradeoff_run(const struct tradeoff_options *options, struct tradeoff_study *study,
                  const struct tradeoff_setting *setting, struct status *status);
/* Runs it on the others. */
bool tradeoff_judge(const struct tradeoff_options *options, const struct tradeoff_study *study,
                    struct tradeoff_result *result, struct status *status);

/* tradeoff_search.c: the next setting worth a run, or false: base, then each single change (those
 * of places after that of their shader, and only where that is not harmless), then combinations
 * that no run so far dominates by prediction (times multiply, square errors add). `left` estimates
 * how many there are. */
bool tradeoff_next(const struct tradeoff_study *study, struct tradeoff_setting *setting,
                   size_t *left);
/* Marks the results that no other is at least as good as in simulated time and square error. */
void tradeoff_mark_frontier(struct tradeoff_study *study);

/* tradeoff_files.c */
bool tradeoff_write_json(const struct tradeoff_study *study, const char *path,
                         struct status *status);
/* Results of an earlier run into a study whose knobs are known; other studies' files are refused.
 */
bool tradeoff_read_json(struct tradeoff_study *study, const char *path, struct status *status);
/* tradeoff_page.c */
bool tradeoff_write_page(const struct tradeoff_study *study, const char *path,
                         struct status *status);

#endif
