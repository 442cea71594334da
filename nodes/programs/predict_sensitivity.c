/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"
#include "nodes/programs/predict_command.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One parameter, a step up and a step down. */
struct effect {
    int parameter;
    int64_t value, higher, lower; /* a step that is not possible equals the value */
    double change[2];             /* of the time, relative, at higher and lower */
    const char *why_not;          /* it was not tried; NULL: it was */
};

/* Parameters a record was made with: they decide which costs arise, so another value needs another
 * run. */
static const char *reason_not_to_try(const char *name) {
    static const char *const fixed[] = {"region_width", "region_height"};
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++)
        if (!strcmp(name, fixed[i]))
            return "a record is made for one size of regions";
    return NULL;
}

/* The time with one parameter changed, in seconds; negative when there is none. */
static double time_with(struct what_if_solver *solver, const struct what_if *question,
                        int parameter, int64_t value) {
    int64_t values[MACHINE_VALUE_COUNT];
    struct what_if changed = *question;
    struct what_if_result result;
    machine_to_values(&question->machine, values);
    values[parameter] = value;
    if (!machine_from_values(question->machine.name, values, &changed.machine, NULL) ||
        !what_if_solve(solver, &changed, NULL, &result, NULL))
        return -1;
    return ticks_to_s(changed.machine.rate, result.end);
}

static void try_parameter(struct what_if_solver *solver, const struct what_if *question,
                          double base_s, struct effect *effect) {
    enum { SMALL = 100 };
    const struct machine_parameter known = machine_parameter_at(effect->parameter);
    const int64_t value = effect->value = machine_value(&question->machine, effect->parameter);
    effect->why_not = reason_not_to_try(known.name);
    if (!effect->why_not && known.minimum == known.maximum)
        effect->why_not = "it has one value only";
    effect->higher = value < SMALL ? (value ? 2 * value : 1) : value + value / 100;
    effect->lower = value < SMALL ? value / 2 : value - value / 100;
    effect->higher = effect->higher > known.maximum ? value : effect->higher;
    effect->lower = effect->lower < known.minimum ? value : effect->lower;
    const int64_t steps[2] = {effect->higher, effect->lower};
    for (int i = 0; i < 2 && !effect->why_not; i++) {
        const double time_s =
            steps[i] == value ? base_s : time_with(solver, question, effect->parameter, steps[i]);
        if (time_s < 0)
            effect->why_not = "the changed value has no exact tick";
        else
            effect->change[i] = base_s > 0 ? time_s / base_s - 1 : 0;
    }
}

static double size_of(const struct effect *effect) {
    return effect->why_not ? -1 : fmax(fabs(effect->change[0]), fabs(effect->change[1]));
}

static int compare_effects(const void *a, const void *b) {
    const double x = size_of(a), y = size_of(b);
    return x != y ? (x < y) - (x > y)
                  : ((const struct effect *)a)->parameter - ((const struct effect *)b)->parameter;
}

static void print_effects(const struct effect *effects) {
    printf("\nSensitivity: change of the time when one parameter changes\n"
           "  %-32s %16s %16s %10s %16s %10s\n",
           "parameter", "value", "higher", "change", "lower", "change");
    int i = 0;
    for (; i < MACHINE_VALUE_COUNT && size_of(&effects[i]) > 0; i++)
        printf("  %-32s %16" PRId64 " %16" PRId64 " %+9.4f%% %16" PRId64 " %+9.4f%%\n",
               machine_parameter_at(effects[i].parameter).name, effects[i].value, effects[i].higher,
               100 * effects[i].change[0], effects[i].lower, 100 * effects[i].change[1]);
    printf("  no effect here:");
    for (; i < MACHINE_VALUE_COUNT && size_of(&effects[i]) == 0; i++)
        printf(" %s", machine_parameter_at(effects[i].parameter).name);
    putchar('\n');
    for (; i < MACHINE_VALUE_COUNT; i++)
        printf("  not tried: %s: %s\n", machine_parameter_at(effects[i].parameter).name,
               effects[i].why_not);
}

static void add_effects(cJSON *document, const struct effect *effects) {
    cJSON *list = cJSON_AddArrayToObject(document, "sensitivity");
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "parameter", machine_parameter_at(effects[i].parameter).name);
        json_add_whole(item, "value", effects[i].value);
        if (effects[i].why_not) {
            cJSON_AddStringToObject(item, "not_tried", effects[i].why_not);
        } else {
            json_add_whole(item, "higher", effects[i].higher);
            cJSON_AddNumberToObject(item, "higher_change", effects[i].change[0]);
            json_add_whole(item, "lower", effects[i].lower);
            cJSON_AddNumberToObject(item, "lower_change", effects[i].change[1]);
        }
        cJSON_AddItemToArray(list, item);
    }
}

bool sensitivity_report(struct what_if_solver *solver, const struct run_record *record,
                        const struct what_if *question, bool is_quiet, cJSON *document,
                        struct status *status) {
    struct what_if_result base;
    if (!what_if_solve(solver, question, NULL, &base, status))
        return false;
    const double base_s = ticks_to_s(question->machine.rate, base.end);
    struct effect effects[MACHINE_VALUE_COUNT] = {0};
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        effects[i].parameter = i;
        try_parameter(solver, question, base_s, &effects[i]);
    }
    qsort(effects, MACHINE_VALUE_COUNT, sizeof *effects, compare_effects);
    if (!is_quiet)
        print_effects(effects);
    if (document)
        add_effects(document, effects);
    return true;
}
