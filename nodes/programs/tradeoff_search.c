/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/tradeoff.h"

#include <math.h>
#include <string.h>

enum { COMBINATIONS_MAX = 1 << 18 };

void tradeoff_describe(const struct tradeoff_study *study, const struct tradeoff_setting *setting,
                       char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < study->knob_count && used < size; k++)
        if (setting->choice[k])
            used +=
                (size_t)snprintf(text + used, size - used, "%s%s=%s", used ? " " : "",
                                 study->knobs[k].key, study->knobs[k].values[setting->choice[k]]);
    if (!used)
        snprintf(text, size, "most accurate");
}

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

static void measure_effects(const struct tradeoff_study *study, const struct tradeoff_result *base,
                            struct effect effects[TRADEOFF_KNOBS_MAX][TRADEOFF_VALUES_MAX]) {
    for (int k = 0; k < study->knob_count; k++)
        for (int v = 0; v < study->knobs[k].value_count; v++) {
            const struct tradeoff_setting setting = single_change(k, v);
            const struct tradeoff_result *result = v ? find_result(study, &setting) : base;
            effects[k][v] =
                (struct effect){.time = (double)result->time_ps / fmax((double)base->time_ps, 1),
                                .error = result->square_error - base->square_error,
                                .is_worth_it = !v || result->time_ps < base->time_ps ||
                                               result->shading_ps < base->shading_ps ||
                                               result->bytes_per_sample < base->bytes_per_sample};
        }
}

/* Counts through all combinations; false after the last. */
static bool advance(const struct tradeoff_study *study, struct tradeoff_setting *setting) {
    for (int k = 0; k < study->knob_count; k++) {
        if (++setting->choice[k] < study->knobs[k].value_count)
            return true;
        setting->choice[k] = 0;
    }
    return false;
}

/* Is a run already there that is at least as quick and as accurate as the prediction? */
static bool is_dominated(const struct tradeoff_study *study, double time, double error) {
    for (size_t i = 0; i < study->result_count; i++)
        if ((double)study->results[i].time_ps <= time && study->results[i].square_error <= error)
            return true;
    return false;
}

/* The undominated combination of least predicted error for its gain: by error times time. */
static bool best_combination(const struct tradeoff_study *study, const struct tradeoff_result *base,
                             struct tradeoff_setting *best, size_t *left) {
    struct effect effects[TRADEOFF_KNOBS_MAX][TRADEOFF_VALUES_MAX];
    struct tradeoff_setting setting = {{0}};
    double least = INFINITY;
    measure_effects(study, base, effects);
    *left = 0;
    for (int n = 0; n < COMBINATIONS_MAX && advance(study, &setting); n++) {
        double time = (double)base->time_ps, error = base->square_error;
        bool is_worth_it = true;
        for (int k = 0; k < study->knob_count; k++) {
            const struct effect *effect = &effects[k][setting.choice[k]];
            is_worth_it = is_worth_it && effect->is_worth_it;
            time *= effect->time;
            error += effect->error;
        }
        error = fmax(error, 0);
        if (!is_worth_it || is_dominated(study, time, error) || find_result(study, &setting))
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
            if (find_result(study, &change))
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
            const bool is_better =
                b->time_ps < a->time_ps || b->square_error < a->square_error ||
                (b->time_ps == a->time_ps && b->square_error == a->square_error && j < i);
            if (i != j && b->time_ps <= a->time_ps && b->square_error <= a->square_error &&
                is_better)
                a->is_on_frontier = false;
        }
    }
}
