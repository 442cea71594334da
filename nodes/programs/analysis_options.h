/* SPDX-License-Identifier: Apache-2.0 */
#ifndef ANALYSIS_OPTIONS_H
#define ANALYSIS_OPTIONS_H

#include "netsim/what_if.h"

/* What `sortlast predict`, `budget` and `trace` have in common: a record, or a scene to record
 * first, and a question about it in which every item may be a list of values. */

/* Items of a question besides single machine parameters, slowest to vary first.
 * X(NAME, long option, key in results, what it is) */
#define ANALYSIS_AXES(X)                                                                           \
    X(MACHINE, "machine", "machine",                                                               \
      "machine descriptions, by name or file (default: the record's)")                             \
    X(RENDERING_NODES, "rendering-nodes", "rendering_nodes", "rendering nodes (default 1)")        \
    X(CHUNK, "chunk-triangles", "chunk_triangles",                                                 \
      "triangles dealt out together: multiples of the record's (default: the record's)")           \
    X(SEED, "seed", "seed", "seeds of the distribution of primitives (default: the record's)")     \
    X(SHADING_NODES, "shading-nodes", "shading_nodes", "shading nodes (default 1)")                \
    X(STRATEGY, "composition", "strategy", "composition strategies (default chain)")               \
    X(ASSIGNMENT, "assignment", "assignment", "regions to shading nodes: round-robin, by-cost")    \
    X(MAPS, "maps", "maps", "what travels: specific, union, and +unbound, +position with either")  \
    X(MATH, "math", "math", "functions: recorded, exact, fast")
enum analysis_axis_kind {
#define ANALYSIS_AXIS_ENUM(name, option, key, what) ANALYSIS_##name,
    ANALYSIS_AXES(ANALYSIS_AXIS_ENUM)
#undef ANALYSIS_AXIS_ENUM
        ANALYSIS_AXIS_COUNT,
    ANALYSIS_PARAMETER = ANALYSIS_AXIS_COUNT /* of the machine */
};

struct analysis_axis {
    int kind;
    int parameter;   /* its index in the machine */
    const char *key; /* in results */
    int64_t *values; /* numbers; for choices the index of the choice */
    char **labels;   /* of choices as they were given; NULL for numbers */
    size_t count;
};

enum { ANALYSIS_PARAMETERS_MAX = 32 };

struct analysis_options {
    const char *input; /* a record or a scene */
    const char *json, *csv, *output;
    bool is_quiet, wants_sensitivity, wants_explanation;
    int64_t frames_per_s; /* budget: the target, 0: the machine's */
    struct analysis_axis axes[ANALYSIS_AXIS_COUNT + ANALYSIS_PARAMETERS_MAX];
    size_t axis_count;
    struct machine *machines; /* of the machine axis */
    char **forwarded;         /* options for the run that records a scene */
    int forwarded_count;
};

/* The verb's own needs: its usage and help, and which of the special options it has. */
struct analysis_verb {
    const char *name, *usage, *about;
    const char *more_options; /* lines of help */
    bool has_csv, has_sensitivity, has_explanation, has_fps, has_output,
        is_single; /* one value for each item */
};

/* Returns 0 to go on, else the exit status plus 1 to end with, after --help or a message. */
int analysis_options_parse(const struct analysis_verb *verb, int argc, char **argv,
                           struct analysis_options *options);
void analysis_options_finish(struct analysis_options *options);

/* Reads the record, or runs the scene in this process and records it; the caller's. Failures have
 * been said; returns the exit status, 0 when *record is there. */
int analysis_record_obtain(const struct analysis_options *options, struct run_record **record);

/* The body of a verb: options, record, then `analyse`; says failures and returns the exit status.
 */
int analysis_main(const struct analysis_verb *verb, int argc, char **argv,
                  bool (*analyse)(const struct analysis_options *options,
                                  const struct run_record *record, struct status *status));

/* The number of combinations of all items, and the question of one of them. Fails when the machine
 * with these values is none. */
size_t analysis_combinations(const struct analysis_options *options);
bool analysis_question(const struct analysis_options *options, const struct run_record *record,
                       size_t combination, struct what_if *question, struct status *status);
/* Which value of axis a combination has. */
size_t analysis_choice(const struct analysis_options *options, size_t combination, size_t axis);
/* That value as text. */
const char *analysis_value_text(const struct analysis_axis *axis, size_t choice, char text[32]);

#endif
