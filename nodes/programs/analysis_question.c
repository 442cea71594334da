/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/analysis_options.h"

#include <inttypes.h>
#include <stdio.h>

size_t analysis_combinations(const struct analysis_options *options) {
    size_t combinations = 1;
    for (size_t a = 0; a < options->axis_count; a++)
        if (__builtin_mul_overflow(combinations, options->axes[a].count, &combinations))
            return SIZE_MAX;
    return combinations;
}

size_t analysis_choice(const struct analysis_options *options, size_t combination, size_t axis) {
    for (size_t a = options->axis_count; a-- > axis + 1;)
        combination /= options->axes[a].count;
    return combination % options->axes[axis].count;
}

const char *analysis_value_text(const struct analysis_axis *axis, size_t choice, char text[32]) {
    if (axis->labels)
        return axis->labels[choice];
    snprintf(text, 32, "%" PRId64, axis->values[choice]);
    return text;
}

static void apply(const struct analysis_options *options, int kind, int64_t value,
                  struct what_if *question) {
    switch (kind) {
    case ANALYSIS_MACHINE:
        question->machine = options->machines[value];
        break;
    case ANALYSIS_RENDERING_NODES:
        question->rendering_nodes = (uint32_t)value;
        break;
    case ANALYSIS_CHUNK:
        question->chunk_triangles = (uint32_t)value;
        break;
    case ANALYSIS_SEED:
        question->seed = (uint64_t)value;
        break;
    case ANALYSIS_SHADING_NODES:
        question->shading_nodes = (uint32_t)value;
        break;
    case ANALYSIS_STRATEGY:
        question->strategy = strategy_at((int)value);
        break;
    case ANALYSIS_ASSIGNMENT:
        question->assignment = (enum what_if_assignment)value;
        break;
    case ANALYSIS_MAPS:
        question->maps = (uint32_t)value;
        break;
    default:
        question->math = (enum what_if_math)value;
    }
}

bool analysis_question(const struct analysis_options *options, const struct run_record *record,
                       size_t combination, struct what_if *question, struct status *status) {
    int64_t parameters[MACHINE_VALUE_COUNT];
    bool has_parameters = false;
    *question = what_if_default(record);
    for (size_t a = 0; a < options->axis_count; a++) { /* the machine is the first */
        const struct analysis_axis *axis = &options->axes[a];
        const int64_t value = axis->values[analysis_choice(options, combination, a)];
        if (axis->kind != ANALYSIS_PARAMETER) {
            apply(options, axis->kind, value, question);
            continue;
        }
        if (!has_parameters)
            machine_to_values(&question->machine, parameters);
        has_parameters = true;
        parameters[axis->parameter] = value;
    }
    struct machine machine;
    if (!has_parameters)
        return true;
    if (!machine_from_values(question->machine.name, parameters, &machine, status))
        return false;
    question->machine = machine;
    return true;
}
