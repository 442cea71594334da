/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/analysis_options.h"

#include "nodes/programs/analysis_values.h"
#include "nodes/programs/render_options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ANALYSIS_NODES_MAX = 65536, ANALYSIS_COMBINATIONS_MAX = 10000000 };

static const struct {
    const char *option, *key, *what;
} axis_names[] = {
#define ANALYSIS_AXIS_NAME(name, option, key, what) {option, key, what},
    ANALYSIS_AXES(ANALYSIS_AXIS_NAME)
#undef ANALYSIS_AXIS_NAME
};

/* Short names of what is asked most; any parameter goes by its own name as well. */
static const struct {
    const char *option, *parameter;
} shorthands[] = {
    {"hop-latency-ps", "composition_hop_latency_ps"},
    {"region-buffers", "composition_region_buffers"},
    {"frame-buffers", "geometry_frame_buffers"},
};

static void print_help(const struct analysis_verb *verb) {
    printf("usage: sortlast %s\n\n%s\n", verb->usage, verb->about);
    puts("The input is a record (render --record) or a scene, which is then run in this process "
         "and recorded.\n");
    puts(verb->is_single ? "Question"
                         : "Question (each item may be a list: 1,2,4 or 1..16 or "
                           "0..100+25 or 1..64*2)");
    for (int i = 0; i < ANALYSIS_AXIS_COUNT; i++)
        printf("  %s--%-22s %s\n",
               i == ANALYSIS_RENDERING_NODES ? "-r, "
               : i == ANALYSIS_SHADING_NODES ? "-s, "
                                             : "    ",
               axis_names[i].option, axis_names[i].what);
    puts("      --set NAME=VALUE       any parameter of the machine (sortlast machine show lists "
         "them); also as\n"
         "                             an option of its own: --composition-bytes-per-s 9.1G\n"
         "      --hop-latency-ps, --region-buffers, --frame-buffers: the same, shorter\n"
         "\nOutput");
    if (verb->more_options)
        puts(verb->more_options);
    puts("      --json FILE            the results for programs; - for standard output");
    if (verb->has_csv)
        puts("      --csv FILE             a table for programs; - for standard output");
    puts("  -q, --quiet                no table\n"
         "  -h, --help                 this text\n"
         "\nOptions of `sortlast render` that describe the picture (--format, --samples, --chord, "
         "--frames,\n"
         "--shaders) go to the run that records a scene.\n"
         "\nExit status: 0 done; 1 the input or an option is wrong; 2 something around it failed.");
}

static int usage_error(const struct status *status) {
    fprintf(stderr, "sortlast: %s\n(see --help)\n", status->message);
    return 2;
}

static int parameter_index(const char *name, size_t length) {
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        const char *known = machine_parameter_at(i).name;
        size_t same = 0;
        while (same < length && known[same] &&
               (name[same] == known[same] || (name[same] == '-' && known[same] == '_')))
            same++;
        if (same == length && !known[same])
            return i;
    }
    return -1;
}

/* The axis of a kind (and parameter), made when it is not there yet; NULL when there are too many.
 * An option that comes again replaces what it said before. */
static struct analysis_axis *axis_of(struct analysis_options *options, int kind, int parameter) {
    for (size_t a = 0; a < options->axis_count; a++) {
        struct analysis_axis *axis = &options->axes[a];
        if (axis->kind != kind || (kind == ANALYSIS_PARAMETER && axis->parameter != parameter))
            continue;
        for (size_t i = 0; axis->labels && i < axis->count; i++)
            free(axis->labels[i]);
        free(axis->labels);
        free(axis->values);
        axis->labels = NULL;
        axis->values = NULL;
        axis->count = 0;
        return axis;
    }
    if (options->axis_count == sizeof options->axes / sizeof *options->axes)
        return NULL;
    struct analysis_axis *axis = &options->axes[options->axis_count++];
    *axis = (struct analysis_axis){.kind = kind,
                                   .parameter = parameter,
                                   .key = kind == ANALYSIS_PARAMETER
                                              ? machine_parameter_at(parameter).name
                                              : axis_names[kind].key};
    return axis;
}

static bool parse_parameter(struct analysis_options *options, int parameter, const char *text,
                            struct status *status) {
    const struct machine_parameter known = machine_parameter_at(parameter);
    struct analysis_axis *axis = axis_of(options, ANALYSIS_PARAMETER, parameter);
    if (!axis)
        return status_fail(status, STATUS_LIMIT, "more than %d parameters are set",
                           ANALYSIS_PARAMETERS_MAX);
    return values_parse(known.name, text, known.minimum, known.maximum, &axis->values, &axis->count,
                        status);
}

static bool parse_set(struct analysis_options *options, const char *text, struct status *status) {
    const char *equals = strchr(text, '=');
    const int parameter = equals ? parameter_index(text, (size_t)(equals - text)) : -1;
    if (parameter < 0)
        return status_fail(status, STATUS_INVALID,
                           "--set needs NAME=VALUE with a parameter of the machine, not \"%s\" "
                           "(sortlast machine show lists them)",
                           text);
    return parse_parameter(options, parameter, equals + 1, status);
}

/* The number of a choice by its name, -1 for none. */
static int64_t choice_of(int kind, const char *text) {
    static const char *const assignments[] = {
#define ASSIGNMENT_NAME(name, text_) text_,
        WHAT_IF_ASSIGNMENTS(ASSIGNMENT_NAME)
#undef ASSIGNMENT_NAME
            NULL};
    static const char *const maths[] = {
#define MATH_NAME(name, text_) text_,
        WHAT_IF_MATHS(MATH_NAME)
#undef MATH_NAME
            NULL};
    static const char *const maps[] = {"specific",
                                       "union",
                                       "specific+unbound",
                                       "union+unbound",
                                       "specific+position",
                                       "union+position",
                                       "specific+unbound+position",
                                       "union+unbound+position",
                                       NULL};
    if (kind == ANALYSIS_STRATEGY) {
        for (int i = 0; strategy_at(i); i++)
            if (!strcmp(strategy_at(i)->name, text))
                return i;
        return -1;
    }
    const char *const *names = kind == ANALYSIS_ASSIGNMENT ? assignments
                               : kind == ANALYSIS_MATH     ? maths
                                                           : maps;
    for (int i = 0; names[i]; i++)
        if (!strcmp(names[i], text))
            return i;
    return -1;
}

static bool parse_choices(struct analysis_options *options, int kind, const char *text,
                          struct status *status) {
    struct analysis_axis *axis = axis_of(options, kind, 0);
    size_t value_capacity = 0, label_capacity = 0;
    for (;; text++) {
        const size_t length = strcspn(text, ",");
        char *label = memory_get(length + 1, 1);
        memcpy(label, text, length);
        axis->values =
            memory_grow(axis->values, &value_capacity, axis->count + 1, sizeof *axis->values);
        axis->labels =
            memory_grow(axis->labels, &label_capacity, axis->count + 1, sizeof *axis->labels);
        axis->labels[axis->count] = label;
        axis->values[axis->count] =
            kind == ANALYSIS_MACHINE ? (int64_t)axis->count : choice_of(kind, label);
        if (axis->values[axis->count++] < 0)
            return status_fail(status, STATUS_INVALID, "--%s does not know \"%s\" (%s)",
                               axis_names[kind].option, label, axis_names[kind].what);
        text += length;
        if (!*text)
            return true;
    }
}

static bool parse_axis(struct analysis_options *options, int kind, const char *text,
                       struct status *status) {
    if (kind == ANALYSIS_MACHINE || kind >= ANALYSIS_STRATEGY)
        return parse_choices(options, kind, text, status);
    struct analysis_axis *axis = axis_of(options, kind, 0);
    const bool is_nodes = kind == ANALYSIS_RENDERING_NODES || kind == ANALYSIS_SHADING_NODES;
    return values_parse(axis_names[kind].key, text, kind != ANALYSIS_SEED,
                        is_nodes                 ? ANALYSIS_NODES_MAX
                        : kind == ANALYSIS_CHUNK ? CHUNK_TRIANGLES_MAX
                                                 : INT64_MAX,
                        &axis->values, &axis->count, status);
}

/* An option that only this or that verb has: where its value goes; NULL when this verb has none. */
static const char **special_option(const struct analysis_verb *verb, const char *name,
                                   struct analysis_options *options) {
    if (!strcmp(name, "json"))
        return &options->json;
    if (verb->has_csv && !strcmp(name, "csv"))
        return &options->csv;
    if (verb->has_output && !strcmp(name, "output"))
        return &options->output;
    return NULL;
}

static bool parse_long(const struct analysis_verb *verb, const char *name, const char *value,
                       struct analysis_options *options, bool *is_known, struct status *status) {
    const char **special = special_option(verb, name, options);
    *is_known = true;
    if (special) {
        *special = value;
        return true;
    }
    if (!strcmp(name, "set"))
        return parse_set(options, value, status);
    if (verb->has_fps && !strcmp(name, "fps")) {
        int64_t *values;
        size_t count;
        if (!values_parse("--fps", value, 1, 100000, &values, &count, status))
            return false;
        options->frames_per_s = values[0];
        free(values);
        return true;
    }
    for (int kind = 0; kind < ANALYSIS_AXIS_COUNT; kind++)
        if (!strcmp(name, axis_names[kind].option))
            return parse_axis(options, kind, value, status);
    for (size_t i = 0; i < sizeof shorthands / sizeof *shorthands; i++)
        if (!strcmp(name, shorthands[i].option))
            name = shorthands[i].parameter;
    const int parameter = parameter_index(name, strlen(name));
    *is_known = parameter >= 0;
    return !*is_known || parse_parameter(options, parameter, value, status);
}

static void forward(struct analysis_options *options, const char *text) {
    size_t capacity = (size_t)options->forwarded_count;
    options->forwarded =
        memory_grow(options->forwarded, &capacity, (size_t)options->forwarded_count + 1,
                    sizeof *options->forwarded);
    options->forwarded[options->forwarded_count++] = memory_copy_string(text);
}

/* The long name of a short option with a value; NULL for another. */
static const char *long_name(const char *argument) {
    return !strncmp(argument, "-r", 2)   ? "rendering-nodes"
           : !strncmp(argument, "-s", 2) ? "shading-nodes"
           : !strncmp(argument, "-o", 2) ? "output"
                                         : NULL;
}

/* One option at argv[*at] and its value; *at moves past them. */
static bool parse_option(const struct analysis_verb *verb, int argc, char **argv, int *at,
                         struct analysis_options *options, struct status *status) {
    const char *argument = argv[(*at)++];
    char name[64];
    const char *value = NULL;
    if (argument[1] == '-') {
        const char *equals = strchr(argument, '=');
        snprintf(name, sizeof name, "%.*s",
                 equals ? (int)(equals - argument) - 2 : (int)strlen(argument) - 2, argument + 2);
        value = equals ? equals + 1 : NULL;
    } else {
        const char *full = long_name(argument);
        snprintf(name, sizeof name, "%s", full ? full : argument);
        value = full && argument[2] ? argument + 2 : NULL;
    }
    if (verb->has_sensitivity && !strcmp(name, "sensitivity")) {
        options->wants_sensitivity = true;
        return true;
    }
    if (verb->has_explanation && !strcmp(name, "explain")) {
        options->wants_explanation = true;
        return true;
    }
    const int render_values = render_option_values(name);
    const char *next = value ? value : *at < argc ? argv[*at] : NULL;
    bool is_known = false;
    if (next && !parse_long(verb, name, next, options, &is_known, status))
        return false;
    if (!is_known && render_values < 0)
        return status_fail(status, STATUS_INVALID, "unknown option or missing value: %s", argument);
    if (!is_known) {
        forward(options, argument);
        if (render_values && !value && *at < argc)
            forward(options, argv[*at]);
    }
    *at += (is_known || render_values) && !value && *at < argc;
    return true;
}

static bool read_machines(struct analysis_options *options, struct status *status) {
    for (size_t a = 0; a < options->axis_count; a++) {
        const struct analysis_axis *axis = &options->axes[a];
        if (axis->kind != ANALYSIS_MACHINE)
            continue;
        options->machines = memory_get(axis->count, sizeof *options->machines);
        for (size_t i = 0; i < axis->count; i++) {
            char path[4096];
            if (!machine_find_file(axis->labels[i], path, sizeof path, status) ||
                !machine_read_file(path, &options->machines[i], status))
                return false;
        }
    }
    return true;
}

static int compare_axes(const void *a, const void *b) {
    const struct analysis_axis *x = a, *y = b;
    return x->kind != y->kind ? x->kind - y->kind : x->parameter - y->parameter;
}

static bool check_all(const struct analysis_verb *verb, struct analysis_options *options,
                      struct status *status) {
    if (!options->input)
        return status_fail(status, STATUS_INVALID, "no record or scene is given");
    qsort(options->axes, options->axis_count, sizeof *options->axes, compare_axes);
    for (size_t a = 0; a < options->axis_count; a++)
        if ((verb->is_single || options->wants_sensitivity || options->wants_explanation) &&
            options->axes[a].count > 1)
            return status_fail(status, STATUS_INVALID, "%s takes one value of %s%s", verb->name,
                               options->axes[a].key,
                               verb->is_single              ? "; predict takes lists"
                               : options->wants_explanation ? " with --explain"
                                                            : " with --sensitivity");
    if (analysis_combinations(options) > ANALYSIS_COMBINATIONS_MAX)
        return status_fail(status, STATUS_LIMIT, "more than %d combinations are asked for",
                           ANALYSIS_COMBINATIONS_MAX);
    return read_machines(options, status);
}

int analysis_options_parse(const struct analysis_verb *verb, int argc, char **argv,
                           struct analysis_options *options) {
    struct status status = {0};
    *options = (struct analysis_options){0};
    for (int at = 1; at < argc;) {
        const char *argument = argv[at];
        if (!strcmp(argument, "-h") || !strcmp(argument, "--help")) {
            print_help(verb);
            return 1;
        }
        if (!strcmp(argument, "-q") || !strcmp(argument, "--quiet")) {
            options->is_quiet = true;
            at++;
        } else if (argument[0] == '-' && argument[1]) {
            if (!parse_option(verb, argc, argv, &at, options, &status))
                return usage_error(&status);
        } else if (options->input) {
            status_fail(&status, STATUS_INVALID, "more than one record or scene is given");
            return usage_error(&status);
        } else {
            options->input = argument;
            at++;
        }
    }
    return check_all(verb, options, &status) ? 0 : usage_error(&status);
}

void analysis_options_finish(struct analysis_options *options) {
    for (size_t a = 0; a < options->axis_count; a++) {
        for (size_t i = 0; options->axes[a].labels && i < options->axes[a].count; i++)
            free(options->axes[a].labels[i]);
        free(options->axes[a].labels);
        free(options->axes[a].values);
    }
    for (int i = 0; i < options->forwarded_count; i++)
        free(options->forwarded[i]);
    free(options->forwarded);
    free(options->machines);
}
