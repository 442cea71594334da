/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/tradeoff.h"

#include <math.h>
#include <string.h>

enum { COMBINATIONS_MAX = 1 << 18 };

static bool same_setting(const struct tradeoff_setting *a, const struct tradeoff_setting *b) {
    return !memcmp(a->choice, b->choice, sizeof a->choice);
}

static const struct tradeoff_result *find_result(const struct tradeoff_study *study,
                                                 const struct tradeoff_setting *setting) {
    for (size_t i = 0; i < study->result_count; i++)
        if (same_setting(&study->results[i].setting, setting))
            return &study->results[i];
    return NULL;
}

static struct tradeoff_setting single_change(int knob, int value) {
    struct tradeoff_setting setting = {{0}};
    setting.choice[knob] = value;
    return setting;
}

/* What changing one knob alone did, against the most accurate setting. */
struct effect {
    double time, error; /* factor; difference of square errors */
    bool is_worth_it;   /* it gains time, or bytes */
};

static bool is_worth_it(const struct tradeoff_result *base, const struct tradeoff_result *result) {
    return result->time_ps < base->time_ps || result->shading_ps < base->shading_ps ||
           result->bytes_per_sample < base->bytes_per_sample;
}

/* Whether a knob is looked at. One for a place in a shader is when all of the shader's functions
 * together gain something, and do harm: their error is more than a hundredth of what there is
 * without them. */
static bool is_open(const struct tradeoff_study *study, const struct tradeoff_result *base,
                    int knob) {
    const double harm = 0.01;
    if (study->knobs[knob].shader < 0)
        return true;
    const struct tradeoff_setting all = single_change(study->knobs[knob].shader, 1);
    const struct tradeoff_result *result = find_result(study, &all);
    return base && result && is_worth_it(base, result) &&
           result->error.square_error - base->error.square_error > harm * base->error.square_error;
}

/* Combinations of the values that are worth it. */
struct combinations {
    int knobs[TRADEOFF_KNOBS_MAX], count;
    int values[TRADEOFF_KNOBS_MAX][TRADEOFF_VALUES_MAX], value_counts[TRADEOFF_KNOBS_MAX];
    struct effect effects[TRADEOFF_KNOBS_MAX][TRADEOFF_VALUES_MAX]; /* of the i-th value there */
    double size;
};

static double most_gained(const struct combinations *c, int i) {
    double least = 1;
    for (int v = 0; v < c->value_counts[i]; v++)
        least = fmin(least, c->effects[i][v].time);
    return 1 - least;
}

/* Leaves out the knob that gains least. */
static void drop_least(struct combinations *c) {
    int least = 0;
    for (int i = 1; i < c->count; i++)
        if (most_gained(c, i) <= most_gained(c, least))
            least = i;
    c->size /= c->value_counts[least];
    c->count--;
    for (int i = least; i < c->count; i++) {
        c->knobs[i] = c->knobs[i + 1];
        c->value_counts[i] = c->value_counts[i + 1];
        memcpy(c->values[i], c->values[i + 1], sizeof c->values[i]);
        memcpy(c->effects[i], c->effects[i + 1], sizeof c->effects[i]);
    }
}

static void collect_effects(const struct tradeoff_study *study, const struct tradeoff_result *base,
                            struct combinations *c) {
    *c = (struct combinations){.size = 1};
    for (int k = 0; k < study->knob_count; k++) {
        int count = 0;
        for (int v = 0; v < study->knobs[k].value_count; v++) {
            const struct tradeoff_setting setting = single_change(k, v);
            const struct tradeoff_result *result = find_result(study, &setting);
            if (v && (!is_open(study, base, k) || !result || !is_worth_it(base, result)))
                continue;
            c->values[c->count][count] = v;
            c->effects[c->count][count++] =
                (struct effect){.time = (double)result->time_ps / fmax((double)base->time_ps, 1),
                                .error = result->error.square_error - base->error.square_error};
        }
        if (count < 2)
            continue;
        c->value_counts[c->count] = count;
        c->size *= count;
        c->knobs[c->count++] = k;
    }
    while (c->size > COMBINATIONS_MAX)
        drop_least(c);
}

/* Counts through all combinations; false after the last. */
static bool advance(const struct combinations *c, int *at) {
    for (int i = 0; i < c->count; i++) {
        if (++at[i] < c->value_counts[i])
            return true;
        at[i] = 0;
    }
    return false;
}

/* Whether it contradicts itself or says one thing twice: a place of a shader all of whose functions
 * are fast, or all places of a shader. */
static bool is_redundant(const struct tradeoff_study *study,
                         const struct tradeoff_setting *setting) {
    int places[TRADEOFF_KNOBS_MAX] = {0}, fast[TRADEOFF_KNOBS_MAX] = {0};
    if (tradeoff_contradicts(study, setting))
        return true;
    for (int k = 0; k < study->knob_count; k++) {
        const int shader = study->knobs[k].shader;
        if (shader < 0)
            continue;
        places[shader]++;
        fast[shader] += setting->choice[k] != 0;
    }
    for (int k = 0; k < study->knob_count; k++)
        if (fast[k] && (setting->choice[k] || fast[k] == places[k]))
            return true;
    return false;
}

/* Is a run already there that is at least as quick and as accurate as the prediction? */
static bool is_dominated(const struct tradeoff_study *study, double time, double error) {
    for (size_t i = 0; i < study->result_count; i++)
        if ((double)study->results[i].time_ps <= time &&
            study->results[i].error.square_error <= error)
            return true;
    return false;
}

/* The undominated combination of least predicted error for its gain: by error times time. */
static bool best_combination(const struct tradeoff_study *study, const struct tradeoff_result *base,
                             struct tradeoff_setting *best, size_t *left) {
    struct combinations c;
    int at[TRADEOFF_KNOBS_MAX] = {0};
    double least = INFINITY;
    collect_effects(study, base, &c);
    *left = 0;
    while (advance(&c, at)) {
        struct tradeoff_setting setting = {{0}};
        double time = (double)base->time_ps, error = base->error.square_error;
        for (int i = 0; i < c.count; i++) {
            setting.choice[c.knobs[i]] = c.values[i][at[i]];
            time *= c.effects[i][at[i]].time;
            error += c.effects[i][at[i]].error;
        }
        error = fmax(error, 0);
        if (is_dominated(study, time, error) || is_redundant(study, &setting) ||
            find_result(study, &setting))
            continue;
        ++*left;
        const double rank = log(time) + 0.5 * log(error + 1e-12);
        if (rank < least) {
            least = rank;
            *best = setting;
        }
    }
    return least < INFINITY;
}

bool tradeoff_next(const struct tradeoff_study *study, struct tradeoff_setting *setting,
                   size_t *left) {
    const struct tradeoff_setting none = {{0}};
    const struct tradeoff_result *base = find_result(study, &none);
    size_t singles = 0;
    *setting = none;
    for (int k = study->knob_count - 1; k >= 0; k--)
        for (int v = study->knobs[k].value_count - 1; v > 0; v--) {
            const struct tradeoff_setting change = single_change(k, v);
            if (find_result(study, &change) || !is_open(study, base, k))
                continue;
            singles++;
            if (base)
                *setting = change;
        }
    if (!base || singles) {
        *left = singles + !base;
        return true;
    }
    return best_combination(study, base, setting, left);
}

void tradeoff_mark_frontier(struct tradeoff_study *study) {
    for (size_t i = 0; i < study->result_count; i++) {
        struct tradeoff_result *a = &study->results[i];
        a->is_on_frontier = true;
        for (size_t j = 0; j < study->result_count; j++) {
            const struct tradeoff_result *b = &study->results[j];
            const bool is_better = b->time_ps < a->time_ps ||
                                   b->error.square_error < a->error.square_error ||
                                   (b->time_ps == a->time_ps &&
                                    b->error.square_error == a->error.square_error && j < i);
            if (i != j && b->time_ps <= a->time_ps &&
                b->error.square_error <= a->error.square_error && is_better)
                a->is_on_frontier = false;
        }
    }
}
