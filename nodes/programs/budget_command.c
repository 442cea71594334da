/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/analysis_options.h"
#include "nodes/programs/budget.h"
#include "nodes/programs/explain_report.h"
#include "nodes/programs/json_output.h"
#include "nodes/programs/predict_command.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PS_PER_S 1000000000000

struct budget budget_compute(const struct record_frame *frame, const struct what_if *question,
                             int64_t frames_per_s) {
    const struct machine *machine = &question->machine;
    struct budget budget = {
        .frames_per_s = frames_per_s,
        .samples = (uint64_t)frame->width * frame->samples_x * frame->height * frame->samples_y,
        .regions = frame->region_count,
        .payload_numerator =
            (uint64_t)machine->composition_bytes_per_s *
            (uint64_t)(machine->composition_word_bytes - machine->composition_depth_bytes),
        .payload_denominator = (uint64_t)machine->composition_word_bytes,
        .frame_time_ps = PS_PER_S / frames_per_s,
        .regions_per_node =
            (frame->region_count + question->shading_nodes - 1) / question->shading_nodes,
    };
    /* whole words of all regions, at the rate of the link, within 1 / rate */
    const unsigned __int128 screen_bytes = (unsigned __int128)frame->region_count *
                                           (uint64_t)machine_region_samples(machine) *
                                           (uint64_t)machine->composition_word_bytes;
    budget.words = (uint32_t)((uint64_t)machine->composition_bytes_per_s /
                              (screen_bytes * (uint64_t)frames_per_s));
    budget.usable_bytes = budget.words * (uint32_t)(machine->composition_word_bytes -
                                                    machine->composition_depth_bytes);
    const int64_t millisecond_ps = PS_PER_S / 1000;
    budget.shading_period_ps = budget.frame_time_ps >= millisecond_ps
                                   ? budget.frame_time_ps / millisecond_ps * millisecond_ps
                                   : budget.frame_time_ps;
    return budget;
}

double budget_bytes_per_sample(const struct budget *budget) {
    return (double)budget->payload_numerator / (double)budget->payload_denominator /
           ((double)budget->frames_per_s * (double)budget->samples);
}

/* What the paper's own savings are worth: the machine without each.
 * X(name, maps without it) */
#define OPTIMISATIONS(X)                                                                           \
    X("a transfer map for each shader, against one for all", WHAT_IF_MAPS_UNION)                   \
    X("bound parameters, against all with the samples", WHAT_IF_MAPS_UNBOUND)                      \
    X("position rebuilt from depth, against sent", WHAT_IF_MAPS_POSITION)

struct saving {
    const char *name;
    int64_t without_ps;
    uint64_t without_bytes; /* over the composition network, all frames */
};
enum {
#define SAVING_INDEX(name, maps) SAVING_OF_##maps,
    OPTIMISATIONS(SAVING_INDEX)
#undef SAVING_INDEX
        SAVING_COUNT
};

struct analysis {
    const struct run_record *record;
    struct what_if question;
    struct what_if_solver *solver;
    struct budget budget;
    int64_t time_ps;
    bool meets;
    enum timing_resource bound_by;
    uint64_t composition_bytes;
    struct saving savings[SAVING_COUNT];
    struct budget_suggestion *suggestions;
    size_t suggestion_count;
    struct timeline *timeline;
};

static uint64_t composition_bytes(const struct what_if_result *result) {
    uint64_t bytes = 0;
    for (uint32_t f = 0; f < result->frame_count; f++)
        bytes += (uint64_t)result->frames[f].times.composition_bytes;
    return bytes;
}

static bool solve_all(struct analysis *analysis, struct status *status) {
    static const struct {
        const char *name;
        uint32_t maps;
    } optimisations[SAVING_COUNT] = {
#define OPTIMISATION(name, maps) {name, maps},
        OPTIMISATIONS(OPTIMISATION)
#undef OPTIMISATION
    };
    struct what_if_result result;
    const struct what_if *question = &analysis->question;
    analysis->timeline =
        timeline_create(&question->machine, question->rendering_nodes, question->shading_nodes);
    if (!what_if_solve(analysis->solver, question, analysis->timeline, &result, status))
        return false;
    analysis->time_ps = predict_frame_ps(question, &result);
    analysis->meets = budget_meets(question, &result, analysis->budget.frames_per_s);
    analysis->bound_by = result.bound_by;
    analysis->composition_bytes = composition_bytes(&result);
    for (size_t i = 0; i < SAVING_COUNT; i++) {
        struct what_if without = *question;
        without.maps ^= optimisations[i].maps;
        if (!what_if_solve(analysis->solver, &without, NULL, &result, status))
            return false;
        analysis->savings[i] = (struct saving){
            optimisations[i].name, predict_frame_ps(&without, &result), composition_bytes(&result)};
    }
    if (!analysis->meets)
        analysis->suggestions =
            budget_suggest(analysis->solver, analysis->record, question,
                           analysis->budget.frames_per_s, &analysis->suggestion_count);
    return true;
}

static int64_t map_bytes(const struct analysis *analysis, uint32_t instance) {
    return analysis->question.machine.composition_shader_id_bytes +
           (int64_t)what_if_map_bytes(&analysis->record->frames[0], instance, &analysis->question);
}

static int64_t map_words(const struct analysis *analysis, uint32_t instance) {
    return machine_map_words(
        &analysis->question.machine,
        what_if_map_bytes(&analysis->record->frames[0], instance, &analysis->question));
}

/* Shading time of an instance where it works most. */
static int64_t longest_ps(const struct analysis *analysis, uint32_t instance) {
    return ticks_to_ps(
        analysis->question.machine.rate,
        what_if_longest_shading(&analysis->record->frames[0], instance, &analysis->question));
}

static void print_budget(const struct analysis *analysis) {
    const struct budget *budget = &analysis->budget;
    const struct record_frame *frame = &analysis->record->frames[0];
    printf("%s at %" PRId64 " frames/s on %s, %u rendering + %u shading nodes\n\n",
           analysis->record->scene, budget->frames_per_s, analysis->question.machine.name,
           analysis->question.rendering_nodes, analysis->question.shading_nodes);
    printf("  picture       %u x %u pixels, %u x %u samples each: %u regions\n", frame->width,
           frame->height, frame->samples_x, frame->samples_y, budget->regions);
    printf(
        "  composition   %.3f GB/s without depth: %.1f bytes a sample; usable in whole words: %u "
        "(%u words)\n",
        (double)budget->payload_numerator / (double)budget->payload_denominator * 1e-9,
        budget_bytes_per_sample(budget), budget->usable_bytes, budget->words);
    printf("  shading       %.3f ms a region (%.0f ms for %u regions a node)\n",
           (double)(budget->shading_period_ps / budget->regions_per_node) * 1e-9,
           (double)budget->shading_period_ps * 1e-9, budget->regions_per_node);
    printf("  frame         %.3f ms, bound by %s; the target is %.3f ms: %s\n",
           (double)analysis->time_ps * 1e-9, timing_resource_name(analysis->bound_by),
           (double)budget->frame_time_ps * 1e-9, analysis->meets ? "met" : "not met");
}

/* One bar a shader instance: a mark a word's worth of payload, the budget as a line through all. */
static void print_chart(const struct analysis *analysis) {
    enum { CHART_WIDTH = 56, SHOWN_MAX = 40 };
    const struct record_frame *frame = &analysis->record->frames[0];
    const bool has_colour = isatty(STDOUT_FILENO) && !getenv("NO_COLOR");
    int64_t longest = analysis->budget.usable_bytes;
    for (uint32_t i = 0; i < frame->instance_count; i++)
        longest = map_bytes(analysis, i) > longest ? map_bytes(analysis, i) : longest;
    const int64_t mark = longest ? analysis->budget.usable_bytes * CHART_WIDTH / longest : 0;
    printf("\nBytes a sample, by shader instance (| is the usable %u)\n",
           analysis->budget.usable_bytes);
    for (uint32_t i = 0; i < frame->instance_count && i < SHOWN_MAX; i++) {
        const int64_t bytes = map_bytes(analysis, i), words = map_words(analysis, i);
        const bool is_over = words > analysis->budget.words;
        char bar[CHART_WIDTH + 2];
        for (int64_t x = 0; x <= CHART_WIDTH; x++)
            bar[x] = x == mark ? '|' : x * longest < bytes * CHART_WIDTH ? '#' : ' ';
        bar[CHART_WIDTH + 1] = 0;
        printf("  %-24.24s %5" PRId64 " B %3" PRId64 " words  %s%s%s\n", frame->instances[i].name,
               bytes, words, has_colour ? (is_over ? "\033[31m" : "\033[32m") : "", bar,
               has_colour ? "\033[0m" : "");
        printf("  %-24s", "");
        for (uint32_t p = 0; p < frame->instances[i].parameter_count; p++)
            if (frame->instances[i].parameters[p].use == RECORD_MATERIAL)
                printf(" %s:%u", frame->instances[i].parameters[p].name,
                       frame->instances[i].parameters[p].bytes);
        printf("; longest region %.3f ms\n", (double)longest_ps(analysis, i) * 1e-9);
    }
    if (frame->instance_count > SHOWN_MAX)
        printf("  ... and %u more (all are in the JSON)\n", frame->instance_count - SHOWN_MAX);
}

static void print_savings(const struct analysis *analysis) {
    printf(
        "\nWhat the paper's savings are worth here            without it: frame ms   composition "
        "MB\n");
    printf("  %-56s %12.3f %16.3f\n", "as it is", (double)analysis->time_ps * 1e-9,
           (double)analysis->composition_bytes * 1e-6);
    for (size_t i = 0; i < SAVING_COUNT; i++)
        printf("  %-56s %12.3f %16.3f\n", analysis->savings[i].name,
               (double)analysis->savings[i].without_ps * 1e-9,
               (double)analysis->savings[i].without_bytes * 1e-6);
}

static void print_suggestions(const struct analysis *analysis) {
    enum { SHOWN_MAX = 12 };
    if (analysis->meets)
        return;
    printf("\nChanges, each solved; best first%s\n",
           analysis->suggestion_count ? "" : ": none was found that helps");
    for (size_t i = 0; i < analysis->suggestion_count && i < SHOWN_MAX; i++)
        printf("  %-8s %12.3f ms  %s\n", analysis->suggestions[i].meets ? "meets" : "helps",
               (double)analysis->suggestions[i].time_ps * 1e-9, analysis->suggestions[i].change);
}

static void add_instances(cJSON *document, const struct analysis *analysis) {
    const struct record_frame *frame = &analysis->record->frames[0];
    cJSON *instances = cJSON_AddArrayToObject(document, "instances");
    for (uint32_t i = 0; i < frame->instance_count; i++) {
        const struct record_instance *instance = &frame->instances[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", instance->name);
        cJSON_AddStringToObject(item, "shader", instance->shader);
        json_add_whole(item, "map_bytes", map_bytes(analysis, i));
        json_add_whole(item, "words", map_words(analysis, i));
        cJSON_AddBoolToObject(item, "meets", map_words(analysis, i) <= analysis->budget.words);
        json_add_whole(item, "longest_region_ps", longest_ps(analysis, i));
        json_add_whole(item, "bound_bytes", (int64_t)instance->bound_bytes);
        cJSON *parameters = cJSON_AddArrayToObject(item, "parameters");
        for (uint32_t p = 0; p < instance->parameter_count; p++) {
            static const char *const uses[RECORD_USE_COUNT] = {"material", "bound", "uniform"};
            cJSON *parameter = cJSON_CreateObject();
            cJSON_AddStringToObject(parameter, "name", instance->parameters[p].name);
            json_add_whole(parameter, "bytes", instance->parameters[p].bytes);
            cJSON_AddStringToObject(parameter, "use", uses[instance->parameters[p].use]);
            cJSON_AddItemToArray(parameters, parameter);
        }
        cJSON_AddItemToArray(instances, item);
    }
}

static void add_results(cJSON *document, const struct analysis *analysis) {
    cJSON *savings = cJSON_AddArrayToObject(document, "savings");
    for (size_t i = 0; i < SAVING_COUNT; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", analysis->savings[i].name);
        json_add_whole(item, "without_time_ps", analysis->savings[i].without_ps);
        json_add_whole(item, "without_composition_bytes",
                       (int64_t)analysis->savings[i].without_bytes);
        cJSON_AddItemToArray(savings, item);
    }
    cJSON *suggestions = cJSON_AddArrayToObject(document, "suggestions");
    for (size_t i = 0; i < analysis->suggestion_count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "change", analysis->suggestions[i].change);
        json_add_whole(item, "time_ps", analysis->suggestions[i].time_ps);
        cJSON_AddBoolToObject(item, "meets", analysis->suggestions[i].meets);
        cJSON_AddItemToArray(suggestions, item);
    }
}

static cJSON *make_document(const struct analysis *analysis) {
    const struct budget *budget = &analysis->budget;
    const struct what_if *question = &analysis->question;
    cJSON *document = cJSON_CreateObject();
    cJSON_AddStringToObject(document, "scene", analysis->record->scene);
    cJSON_AddStringToObject(document, "machine", question->machine.name);
    json_add_whole(document, "rendering_nodes", question->rendering_nodes);
    json_add_whole(document, "shading_nodes", question->shading_nodes);
    json_add_whole(document, "frames_per_s", budget->frames_per_s);
    if (budget->payload_numerator % budget->payload_denominator == 0)
        json_add_whole(document, "effective_bytes_per_s",
                       (int64_t)(budget->payload_numerator / budget->payload_denominator));
    else
        cJSON_AddNumberToObject(document, "effective_bytes_per_s",
                                (double)budget->payload_numerator /
                                    (double)budget->payload_denominator);
    cJSON_AddNumberToObject(document, "budget_bytes_per_sample", budget_bytes_per_sample(budget));
    json_add_whole(document, "usable_bytes_per_sample", budget->usable_bytes);
    json_add_whole(document, "usable_words_per_sample", budget->words);
    json_add_whole(document, "regions", budget->regions);
    json_add_whole(document, "shading_time_per_region_ps",
                   budget->shading_period_ps / budget->regions_per_node);
    json_add_whole(document, "target_time_ps", budget->frame_time_ps);
    json_add_whole(document, "time_ps", analysis->time_ps);
    cJSON_AddBoolToObject(document, "meets", analysis->meets);
    cJSON_AddStringToObject(document, "bound_by", timing_resource_name(analysis->bound_by));
    json_add_whole(document, "composition_bytes", (int64_t)analysis->composition_bytes);
    add_instances(document, analysis);
    add_results(document, analysis);
    explain_add_json(document,
                     &(struct explanation){analysis->timeline, question->machine.rate,
                                           question->rendering_nodes, question->shading_nodes},
                     analysis->record->frame_count - 1);
    return document;
}

static void print_all(const struct analysis *analysis) {
    print_budget(analysis);
    print_chart(analysis);
    explain_print(stdout, &(struct explanation){analysis->timeline, analysis->question.machine.rate,
                                                analysis->question.rendering_nodes,
                                                analysis->question.shading_nodes});
    print_savings(analysis);
    print_suggestions(analysis);
}

static bool analyse(const struct analysis_options *options, const struct run_record *record,
                    struct status *status) {
    struct analysis analysis = {.record = record, .solver = what_if_solver_create(record)};
    bool ok = analysis_question(options, record, 0, &analysis.question, status);
    if (ok) {
        analysis.budget =
            budget_compute(&record->frames[0], &analysis.question,
                           options->frames_per_s ? options->frames_per_s
                                                 : analysis.question.machine.target_frames_per_s);
        ok = solve_all(&analysis, status);
    }
    if (ok && !options->is_quiet && !(options->json && !strcmp(options->json, "-")))
        print_all(&analysis);
    if (ok && options->json) {
        cJSON *document = make_document(&analysis);
        ok = json_write_document(options->json, document, status);
        cJSON_Delete(document);
    }
    if (ok && (fflush(stdout) || ferror(stdout)))
        ok = status_fail(status, STATUS_IO, "cannot write to standard output");
    free(analysis.suggestions);
    timeline_destroy(analysis.timeline);
    what_if_solver_destroy(analysis.solver);
    return ok;
}

int budget_main(int argc, char **argv) {
    static const struct analysis_verb verb = {
        .name = "budget",
        .usage = "budget [options] RECORD|SCENE.rib",
        .about = "Says what a sample and a region may cost at a target rate, what the scene's "
                 "shaders cost,\nwhere the time goes, and which changes would meet the target.",
        .more_options =
            "      --fps N                target rate (default: the machine's, 30 frames/s)",
        .has_fps = true,
        .is_single = true,
    };
    return analysis_main(&verb, argc, argv, analyse);
}
