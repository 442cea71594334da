/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/budget.h"
#include "nodes/programs/predict_command.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NODES_MAX = 16384, RATE_FACTOR_MAX = 1024 };

/* Costs, to rank by: a change of scene or options is cheaper than any hardware. */
enum { COST_SOFTWARE = 0, COST_HARDWARE = 100 };

struct search {
    struct what_if_solver *solver;
    const struct run_record *record;
    const struct what_if *base;
    int64_t frames_per_s;
    struct budget_suggestion *list;
    size_t count, capacity;
};

bool budget_meets(const struct what_if *question, const struct what_if_result *result,
                  int64_t frames_per_s) {
    return (unsigned __int128)result->end * (uint64_t)frames_per_s <=
           (unsigned __int128)question->machine.rate.per_s * result->frame_count;
}

/* Solves; false also when there is no solution. */
static bool meets(struct search *search, const struct what_if *question,
                  struct what_if_result *result) {
    return what_if_solve(search->solver, question, NULL, result, NULL) &&
           budget_meets(question, result, search->frames_per_s);
}

/* Solves the changed question and keeps it when it is any better. */
static void suggest(struct search *search, const struct what_if *question, double cost,
                    const char *change) {
    struct what_if_result result, base;
    if (!what_if_solve(search->solver, search->base, NULL, &base, NULL))
        return;
    const int64_t before_ps = predict_frame_ps(search->base, &base);
    if (!what_if_solve(search->solver, question, NULL, &result, NULL))
        return;
    struct budget_suggestion suggestion = {
        .time_ps = predict_frame_ps(question, &result),
        .meets = budget_meets(question, &result, search->frames_per_s),
        .cost = cost};
    if (suggestion.time_ps >= before_ps)
        return;
    snprintf(suggestion.change, sizeof suggestion.change, "%s", change);
    search->list =
        memory_grow(search->list, &search->capacity, search->count + 1, sizeof *search->list);
    search->list[search->count++] = suggestion;
}

/* What hardware may be enlarged. X(NAME, resource it relieves) */
enum knob { KNOB_SHADING_NODES, KNOB_RENDERING_NODES, KNOB_COMPOSITION, KNOB_GEOMETRY, KNOB_COUNT };

/* Node counts, or rates in units of about a hundredth. */
static int64_t knob_unit(const struct what_if *question, enum knob knob) {
    if (knob < KNOB_COMPOSITION)
        return 1;
    int64_t unit = 1;
    const int64_t rate = knob == KNOB_COMPOSITION ? question->machine.composition_bytes_per_s
                                                  : question->machine.geometry_bytes_per_s;
    while (rate / unit >= 100)
        unit *= 10;
    return unit;
}

static int64_t knob_get(const struct what_if *question, enum knob knob) {
    switch (knob) {
    case KNOB_SHADING_NODES:
        return question->shading_nodes;
    case KNOB_RENDERING_NODES:
        return question->rendering_nodes;
    case KNOB_COMPOSITION:
        return question->machine.composition_bytes_per_s;
    default:
        return question->machine.geometry_bytes_per_s;
    }
}

static bool knob_set(struct what_if *question, enum knob knob, int64_t value) {
    int64_t values[MACHINE_VALUE_COUNT];
    struct machine machine;
    if (knob == KNOB_SHADING_NODES)
        question->shading_nodes = (uint32_t)value;
    else if (knob == KNOB_RENDERING_NODES)
        question->rendering_nodes = (uint32_t)value;
    if (knob < KNOB_COMPOSITION)
        return value <= NODES_MAX;
    machine_to_values(&question->machine, values);
    values[knob == KNOB_COMPOSITION ? MACHINE_INDEX_composition_bytes_per_s
                                    : MACHINE_INDEX_geometry_bytes_per_s] = value;
    if (!machine_from_values(question->machine.name, values, &machine, NULL))
        return false;
    question->machine = machine;
    return true;
}

static int64_t knob_limit(const struct search *search, enum knob knob) {
    int64_t limit = knob_get(search->base, knob) * RATE_FACTOR_MAX;
    if (knob == KNOB_RENDERING_NODES)
        limit = search->record->frames[0].chunk_count;
    if (knob == KNOB_SHADING_NODES)
        limit = search->record->frames[0].region_count;
    return knob < KNOB_COMPOSITION && limit > NODES_MAX ? NODES_MAX : limit;
}

/* The least value between `low`, which does not do, and `high`, which does, found by halving: times
 * fall almost always as the value rises, and every value taken was solved. */
static int64_t least_that_meets(struct search *search, const struct what_if *question,
                                enum knob knob, int64_t low, int64_t high) {
    struct what_if_result result;
    const int64_t unit = knob_unit(search->base, knob);
    while (high - low > unit) {
        struct what_if middle = *question;
        const int64_t value = low + (high - low) / (2 * unit) * unit;
        if (value <= low)
            break;
        if (knob_set(&middle, knob, value) && meets(search, &middle, &result))
            high = value;
        else
            low = value;
    }
    return high;
}

static void describe_knob(const struct what_if *base, enum knob knob, int64_t value, char *text,
                          size_t size) {
    const int64_t before = knob_get(base, knob);
    if (knob < KNOB_COMPOSITION)
        snprintf(text, size, "%" PRId64 " %s nodes instead of %" PRId64, value,
                 knob == KNOB_SHADING_NODES ? "shading" : "rendering", before);
    else
        snprintf(text, size, "%s at %g GB/s instead of %g",
                 knob == KNOB_COMPOSITION ? "composition" : "geometry", (double)value * 1e-9,
                 (double)before * 1e-9);
}

static double knob_cost(const struct what_if *base, enum knob knob, int64_t value) {
    const double before = (double)knob_get(base, knob);
    return knob < KNOB_COMPOSITION ? (double)value - before : 8 * ((double)value / before - 1);
}

/* More of one kind of hardware alone: the least that meets the target, or, when none does, as much
 * as still helps. */
static void suggest_knob(struct search *search, enum knob knob) {
    struct what_if_result result;
    const int64_t before = knob_get(search->base, knob), limit = knob_limit(search, knob);
    int64_t low = before, high = 0, best = 0;
    ticks best_end = 0;
    double best_s = 0;
    for (int64_t value = before * 2; !high && low < limit; value *= 2) {
        struct what_if question = *search->base;
        value = value > limit ? limit : value;
        if (!knob_set(&question, knob, value))
            break;
        if (meets(search, &question, &result)) {
            high = value;
        } else {
            if (!what_if_solve(search->solver, &question, NULL, &result, NULL))
                break;
            const double time_s = ticks_to_s(question.machine.rate, result.end);
            if (!best || time_s < best_s * 0.995) {
                best = value;
                best_s = time_s;
                best_end = result.end;
            }
            low = value;
        }
    }
    if (high)
        best = least_that_meets(search, search->base, knob, low, high);
    if (!best || (!high && !best_end))
        return;
    struct what_if question = *search->base;
    char change[256];
    describe_knob(search->base, knob, best, change, sizeof change);
    if (knob_set(&question, knob, best))
        suggest(search, &question, COST_HARDWARE + knob_cost(search->base, knob, best), change);
}

/* The knob that relieves what bounds a solution; latency counts as shading. */
static enum knob knob_for(enum timing_resource resource) {
    switch (resource) {
    case TIMING_COMPOSITION:
    case TIMING_FRAMEBUFFER:
        return KNOB_COMPOSITION;
    case TIMING_GEOMETRY:
        return KNOB_GEOMETRY;
    case TIMING_RASTER:
        return KNOB_RENDERING_NODES;
    default:
        return KNOB_SHADING_NODES;
    }
}

/* Enlarges what bounds, by a quarter, until the target is met; a knob at its limit gives way to the
 * next. False when nothing is left to enlarge. */
static bool enlarge_until_met(struct search *search, struct what_if *question) {
    enum { STEPS_MAX = 400 };
    struct what_if_result result;
    for (int step = 0; step < STEPS_MAX; step++) {
        if (meets(search, question, &result))
            return true;
        enum knob knob = knob_for(result.bound_by);
        struct what_if next = *question;
        int tries = 0;
        for (; tries < KNOB_COUNT; tries++, knob = (enum knob)((knob + 1) % KNOB_COUNT)) {
            const int64_t unit = knob_unit(search->base, knob), value = knob_get(question, knob);
            const int64_t more = value + (value / 4 / unit + 1) * unit;
            if (more <= knob_limit(search, knob) && knob_set(&next, knob, more))
                break;
        }
        if (tries == KNOB_COUNT)
            return false;
        *question = next;
    }
    return false;
}

static void append_part(char *change, size_t size, const char *part) {
    const size_t used = strlen(change);
    snprintf(change + used, size - used, "%s%s", used ? ", " : "", part);
}

/* Cuts one kind of hardware back as far as the target allows; what is left of it goes into the
 * change. Returns its cost. */
static double cut_back(struct search *search, struct what_if *question, enum knob knob,
                       char *change, size_t size) {
    struct what_if_result result;
    const int64_t before = knob_get(search->base, knob), now = knob_get(question, knob);
    if (now == before)
        return 0;
    struct what_if without = *question;
    int64_t value = before;
    if (!knob_set(&without, knob, before) || !meets(search, &without, &result))
        value = least_that_meets(search, question, knob, before, now);
    knob_set(question, knob, value);
    if (value == before)
        return 0;
    char part[96];
    describe_knob(search->base, knob, value, part, sizeof part);
    append_part(change, size, part);
    return knob_cost(search->base, knob, value);
}

static const char fast_functions[] = "fast versions of the mathematical functions",
                  by_cost[] = "regions to shading nodes by cost";

/* Several changes together: hardware enlarged where it binds, then cut back one after the other as
 * far as the target allows; besides, when asked for, what costs no hardware. */
static void suggest_together(struct search *search, bool with_fast, bool with_assignment) {
    struct what_if question = *search->base;
    char change[512] = "";
    double cost = COST_HARDWARE;
    if ((with_fast && question.math == WHAT_IF_MATH_FAST) ||
        (with_assignment && question.assignment == WHAT_IF_BY_COST))
        return; /* it is there already */
    if (with_fast) {
        question.math = WHAT_IF_MATH_FAST;
        append_part(change, sizeof change, fast_functions);
    }
    if (with_assignment) {
        question.assignment = WHAT_IF_BY_COST;
        append_part(change, sizeof change, by_cost);
    }
    if (!enlarge_until_met(search, &question))
        return;
    for (int knob = 0; knob < KNOB_COUNT; knob++)
        cost += cut_back(search, &question, (enum knob)knob, change, sizeof change);
    if (strchr(change, ',') && cost > COST_HARDWARE)
        suggest(search, &question, cost, change);
}

/* Instances of the first frame in which a parameter travels, though it could be bound. */
static size_t instances_with(const struct record_frame *frame, const char *name,
                             struct what_if_bind *binds) {
    size_t count = 0;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        for (uint32_t p = 0; p < frame->instances[i].parameter_count; p++) {
            const struct record_parameter *parameter = &frame->instances[i].parameters[p];
            if (parameter->use == RECORD_MATERIAL && !parameter->is_geometric &&
                !strcmp(parameter->name, name))
                binds[count++] = (struct what_if_bind){frame->instances[i].name, parameter->name};
        }
    return count;
}

/* Payload of the longest map in whole words, among the instances bound. */
static int64_t longest_payload(const struct record_frame *frame, const struct what_if *question,
                               const struct what_if_bind *binds, size_t count) {
    const struct machine *machine = &question->machine;
    int64_t words = 0;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        for (size_t b = 0; b < count; b++)
            if (!strcmp(binds[b].instance, frame->instances[i].name)) {
                const int64_t own =
                    machine_map_words(machine, what_if_map_bytes(frame, i, question));
                words = own > words ? own : words;
            }
    return words * (machine->composition_word_bytes - machine->composition_depth_bytes);
}

static void suggest_bind(struct search *search, const char *name, struct what_if_bind *binds) {
    const struct record_frame *frame = &search->record->frames[0];
    struct what_if question = *search->base;
    char change[256];
    question.binds = binds;
    question.bind_count = instances_with(frame, name, binds);
    const int64_t before = longest_payload(frame, search->base, binds, question.bind_count),
                  after = longest_payload(frame, &question, binds, question.bind_count);
    snprintf(change, sizeof change,
             "bind `%.60s` in %zu instance%s: %" PRId64 " -> %" PRId64 " bytes", name,
             question.bind_count, question.bind_count == 1 ? "" : "s", before, after);
    suggest(search, &question, COST_SOFTWARE + (double)question.bind_count, change);
}

/* Each parameter that could be bound, everywhere it travels. */
static void suggest_binds(struct search *search) {
    const struct record_frame *frame = &search->record->frames[0];
    size_t most = 0;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        most += frame->instances[i].parameter_count;
    struct what_if_bind *binds = memory_get(most, sizeof *binds),
                        *seen = memory_get(most, sizeof *seen);
    size_t seen_count = 0;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        for (uint32_t p = 0; p < frame->instances[i].parameter_count; p++) {
            const struct record_parameter *parameter = &frame->instances[i].parameters[p];
            bool is_new = parameter->use == RECORD_MATERIAL && !parameter->is_geometric;
            for (size_t s = 0; is_new && s < seen_count; s++)
                is_new = strcmp(seen[s].parameter, parameter->name) != 0;
            if (!is_new)
                continue;
            seen[seen_count++] = (struct what_if_bind){NULL, parameter->name};
            suggest_bind(search, parameter->name, binds);
        }
    free(binds);
    free(seen);
}

static void suggest_options(struct search *search) {
    struct what_if question = *search->base;
    char change[96];
    question.math = WHAT_IF_MATH_FAST;
    suggest(search, &question, COST_SOFTWARE, fast_functions);
    question = *search->base;
    question.assignment = WHAT_IF_BY_COST;
    suggest(search, &question, COST_SOFTWARE + 1, by_cost);
    question = *search->base;
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(&question.machine, values);
    const int64_t buffers = values[MACHINE_INDEX_composition_region_buffers] *= 2;
    snprintf(change, sizeof change, "%" PRId64 " region buffers a node instead of %" PRId64,
             buffers, buffers / 2);
    if (machine_from_values(search->base->machine.name, values, &question.machine, NULL))
        suggest(search, &question, COST_HARDWARE, change);
}

static int compare_suggestions(const void *a, const void *b) {
    const struct budget_suggestion *x = a, *y = b;
    if (x->meets != y->meets)
        return x->meets ? -1 : 1;
    if (x->meets && x->cost != y->cost)
        return x->cost < y->cost ? -1 : 1;
    return (x->time_ps > y->time_ps) - (x->time_ps < y->time_ps);
}

struct budget_suggestion *budget_suggest(struct what_if_solver *solver,
                                         const struct run_record *record,
                                         const struct what_if *question, int64_t frames_per_s,
                                         size_t *count) {
    struct search search = {
        .solver = solver, .record = record, .base = question, .frames_per_s = frames_per_s};
    suggest_options(&search);
    suggest_binds(&search);
    for (int knob = 0; knob < KNOB_COUNT; knob++)
        suggest_knob(&search, (enum knob)knob);
    for (int options = 0; options < 4; options++)
        suggest_together(&search, options & 1, options & 2);
    if (search.count)
        qsort(search.list, search.count, sizeof *search.list, compare_suggestions);
    *count = search.count;
    return search.list;
}
