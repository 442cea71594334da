/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shader_fix.h"

#include "nodes/shader_fix_study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* All variables begin as floats. Then as many as possible take the largest size, and as many of
 * those the next, all that are chosen rounded together in each trial: first all at once, and where
 * that is too much, halves of them and halves of these. The bound is given out in portions, so that
 * no variable takes all of it because it came first. Then variables whose conversions cost more
 * than they save go back to floats, and the shader is written and rendered. */

static const struct {
    int size;       /* pixel memory and prices go by whole bytes; 0: a float */
    double portion; /* of the bound, that roundings up to this step may use up */
} steps[] = {{0, 0}, {32, 0.3}, {24, 0.4}, {16, 0.5}, {8, 0.9}};
enum { STEP_COUNT = sizeof steps / sizeof *steps, CHECKS_MAX = 4 };

struct candidate {
    int variable; /* number in the program */
    int exponent; /* bits after the point with size 0 */
    bool is_tried;
    int size_before;
};

struct search {
    const struct shader_fix_options *options;
    struct fix_study *study;
    struct candidate *candidates;
    size_t count;
    struct shader_fixing *fixings; /* of all variables */
    double bound;                  /* that roundings have to stay below */
    int exaggeration;              /* bits by which trials round more than the shader will */
};

static void report(const struct search *search, enum shader_fix_stage stage, size_t done,
                   size_t of) {
    if (search->options->progress)
        search->options->progress(search->options->progress_context, stage, done, of);
}

/* What the probes saw; the module is the same one for every rendering to come. */
static void read_probes(struct search *search) {
    for (int i = 0; i < search->study->program->variable_count; i++) {
        const struct shader_probe *probe = &search->study->module->probes[i];
        search->fixings[i] =
            (struct shader_fixing){probe->count > 0, probe->lowest, probe->highest, 0};
    }
}

static bool list_candidates(struct search *search, struct status *status) {
    const struct shader_module *module = search->study->module;
    struct shader_program *program;
    if (!fix_study_write(search->study, search->fixings, &program, status))
        return false;
    search->candidates = memory_get((size_t)program->variable_count, sizeof *search->candidates);
    for (int i = 0; i < program->variable_count; i++) {
        const struct shader_variable *variable = &program->variables[i];
        if (!variable->can_be_fixed || !search->fixings[i].is_seen)
            continue;
        if (!module->probes[i].unusable)
            search->candidates[search->count++] =
                (struct candidate){.variable = i, .exponent = variable->format.exponent};
    }
    shader_program_destroy(program);
    return true;
}

/* As the language rounds to `size` bits: down, to the last of them, and exaggerated by a few bits.
 * The noise of fixed-point numbers is good to 12 bits after the point (docs/accuracy.md). */
static void set_probe(const struct search *search, const struct candidate *candidate) {
    struct shader_probe *probe = &search->study->module->probes[candidate->variable];
    const int size = search->fixings[candidate->variable].size;
    int exponent = candidate->exponent + size - search->exaggeration;
    if (search->study->program->variables[candidate->variable].is_noise && exponent > 12)
        exponent = 12;
    probe->scale = size ? (float)ldexp(1, exponent > 120 ? 120 : exponent) : 0;
}

/* The error with all roundings as they are chosen. Trials have few pixels, and where a shader
 * decides, rounding moves the limit a little: seldom seen in them, often enough in a large picture.
 * Exaggerated, it is seen; errors that grow with the rounding are scaled back. */
static bool try_all(struct search *search, double *error, struct status *status) {
    struct shader_fix_error found;
    for (size_t i = 0; i < search->count; i++)
        set_probe(search, &search->candidates[i]);
    if (!fix_study_round(search->study, &found, status))
        return false;
    *error = ldexp(found.bulk, -search->exaggeration);
    return true;
}

/* Takes as many of candidates first to end - 1 from the step before to this one as it allows. */
static bool shorten(struct search *search, size_t first, size_t end, int step,
                    struct status *status) {
    const int from = steps[step - 1].size, to = steps[step].size;
    const double limit = steps[step].portion * search->bound;
    double error;
    size_t changed = 0;
    for (size_t i = first; i < end; i++) {
        struct shader_fixing *fixing = &search->fixings[search->candidates[i].variable];
        search->candidates[i].is_tried = fixing->size == from;
        changed += fixing->size == from;
        fixing->size = fixing->size == from ? to : fixing->size;
    }
    if (!changed)
        return true;
    if (!try_all(search, &error, status))
        return false;
    for (size_t i = first; i < end && error > limit; i++)
        if (search->candidates[i].is_tried)
            search->fixings[search->candidates[i].variable].size = from;
    if (error <= limit || end - first == 1)
        return true;
    const size_t middle = first + (end - first) / 2;
    return shorten(search, first, middle, step, status) &&
           shorten(search, middle, end, step, status);
}

static bool choose_sizes(struct search *search, struct status *status) {
    for (size_t i = 0; i < search->count; i++)
        search->fixings[search->candidates[i].variable].size = 0;
    for (int step = 1; step < STEP_COUNT; step++) {
        report(search, SHADER_FIX_ROUNDING, (size_t)step - 1, STEP_COUNT - 1);
        if (!shorten(search, 0, search->count, step, status))
            return false;
    }
    return true;
}

static bool price(struct search *search, ticks *time, struct status *status) {
    struct shader_program *program;
    struct shader_fix_cost cost;
    if (!fix_study_write(search->study, search->fixings, &program, status))
        return false;
    const bool ok = fix_study_price(search->study, program->source, &cost, status);
    shader_program_destroy(program);
    *time = cost.time;
    return ok;
}

/* Makes candidates first to end - 1 floats and leaves them so where that is cheaper than `best`. */
static bool try_floats(struct search *search, size_t first, size_t end, ticks *best,
                       struct status *status) {
    bool has_changed = false;
    ticks time;
    for (size_t i = first; i < end; i++) {
        struct shader_fixing *fixing = &search->fixings[search->candidates[i].variable];
        search->candidates[i].size_before = fixing->size;
        has_changed |= fixing->size != 0;
        fixing->size = 0;
    }
    if (!has_changed)
        return true;
    if (!price(search, &time, status))
        return false;
    for (size_t i = first; i < end && time >= *best; i++)
        search->fixings[search->candidates[i].variable].size = search->candidates[i].size_before;
    *best = time < *best ? time : *best;
    return true;
}

/* Conversions cost an addition of floats. What is gained by floats may show only where neighbours
 * become floats together, so after single variables twos are tried, fours, and so on to all. */
static bool drop_what_costs(struct search *search, struct status *status) {
    const size_t count = search->count;
    size_t group = 1, done = 0;
    ticks best;
    if (!price(search, &best, status))
        return false;
    for (bool is_last = false; count && !is_last; group *= 2) {
        is_last = group >= count;
        for (size_t first = 0; first < count; first += group) {
            const size_t end = count - first < group ? count : first + group;
            report(search, SHADER_FIX_CHOOSING, done++, 2 * count);
            if (!try_floats(search, first, end, &best, status))
                return false;
        }
    }
    return true;
}

static void describe(const struct search *search, struct shader_fix_result *result,
                     const struct shader_program *program) {
    result->variables = memory_get(search->count, sizeof *result->variables);
    result->variable_count = search->count;
    for (size_t i = 0; i < search->count; i++) {
        const struct candidate *candidate = &search->candidates[i];
        const struct shader_variable *known = &program->variables[candidate->variable];
        const struct shader_fixing *fixing = &search->fixings[candidate->variable];
        struct shader_fix_variable *variable = &result->variables[i];
        *variable = (struct shader_fix_variable){
            .line = known->line, .lowest = fixing->lowest, .highest = fixing->highest};
        snprintf(variable->name, sizeof variable->name, "%s", known->name);
        if (fixing->size)
            variable->format = known->format;
    }
}

/* Chooses, writes and renders; more carefully until the pictures are right. */
static bool find(struct search *search, struct shader_fix_result *result, struct status *status) {
    double least = INFINITY;
    search->bound = search->options->max_error - result->error_before.bulk;
    if (!(search->bound > 0))
        return status_fail(status, STATUS_INVALID,
                           "%s: floats are not within %g of double precision themselves: their "
                           "error is %g, and %llu pixels are further off than allowed",
                           search->options->path, search->options->max_error,
                           result->error_before.bulk,
                           (unsigned long long)result->error_before.pixels_beyond);
    search->exaggeration = 2;
    for (int i = 0; i < CHECKS_MAX; i++, search->bound /= 2, search->exaggeration++) {
        struct shader_program *program;
        if (!choose_sizes(search, status) || !drop_what_costs(search, status) ||
            !fix_study_write(search->study, search->fixings, &program, status))
            return false;
        report(search, SHADER_FIX_CHECKING, (size_t)i, CHECKS_MAX);
        bool ok = fix_study_check(search->study, program->source, &result->error_after, status) &&
                  fix_study_price(search->study, program->source, &result->after, status);
        if (ok && result->error_after.bulk <= search->options->max_error) {
            result->source = memory_copy_string(program->source);
            describe(search, result, program);
        }
        shader_program_destroy(program);
        if (!ok || result->source)
            return ok;
        least = fmin(least, result->error_after.bulk);
    }
    return status_fail(status, STATUS_INVALID,
                       "%s: no sizes were found that keep the pictures within %g; the least error "
                       "reached is %g, that of floats %g",
                       search->options->path, search->options->max_error, least,
                       result->error_before.bulk);
}

static bool run(struct search *search, struct shader_fix_result *result, struct status *status) {
    struct fix_study *study = search->study;
    read_probes(search);
    if (!fix_study_price(study, study->program->source, &result->before, status) ||
        !fix_study_check(study, NULL, &result->error_before, status) ||
        !list_candidates(search, status) || !find(search, result, status))
        return false;
    if (result->after.time >= result->before.time)
        return status_fail(
            status, STATUS_INVALID,
            "%s: fixed-point gains nothing here: conversions cost more than it saves",
            search->options->path);
    result->renderings = study->renderings;
    return true;
}

bool shader_fix(const struct shader_fix_options *options, struct shader_fix_result *result,
                struct status *status) {
    struct search search = {.options = options};
    *result = (struct shader_fix_result){0};
    report(&search, SHADER_FIX_LOOKING, 0, 1);
    if (!fix_study_create(options, &search.study, status))
        return false;
    search.fixings =
        memory_get((size_t)search.study->program->variable_count, sizeof *search.fixings);
    const bool ok = run(&search, result, status);
    free(search.candidates);
    free(search.fixings);
    fix_study_destroy(search.study);
    if (!ok)
        shader_fix_result_finish(result);
    return ok;
}

void shader_fix_result_finish(struct shader_fix_result *result) {
    free(result->source);
    free(result->variables);
    *result = (struct shader_fix_result){0};
}
