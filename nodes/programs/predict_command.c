/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/predict_command.h"

#include "images/replacement_file.h"
#include "nodes/programs/explain_report.h"
#include "nodes/programs/json_output.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The columns of results, for the table, CSV and JSON alike.
 * X(key, value of a frame in ticks) */
#define FRAME_TIMES(X)                                                                             \
    X("composition_busy", frame->times.composition_busy)                                           \
    X("geometry_busy", frame->times.geometry_busy)                                                 \
    X("raster_busy", frame->raster_longest)                                                        \
    X("shading_busy", frame->shading_longest)                                                      \
    X("framebuffer_busy", frame->times.framebuffer_busy)

struct prediction_output {
    const struct analysis_options *options;
    const struct run_record *record;
    cJSON *combinations;         /* NULL: no JSON */
    struct replacement_file csv; /* used when options->csv is a file */
    bool has_csv_file;
    size_t failures;
};

int64_t predict_frame_ps(const struct what_if *question, const struct what_if_result *result) {
    const int64_t total = ticks_to_ps(question->machine.rate, result->end);
    return result->frame_count ? (total + result->frame_count / 2) / result->frame_count : 0;
}

static bool is_shown(const struct analysis_axis *axis) {
    return axis->count > 1 && axis->kind != ANALYSIS_RENDERING_NODES &&
           axis->kind != ANALYSIS_SHADING_NODES;
}

static void print_head(const struct prediction_output *output) {
    const struct analysis_options *options = output->options;
    if (options->is_quiet)
        return;
    printf("%s, recorded on %s: %u frame%s of %u x %u pixels\n\n", output->record->scene,
           output->record->machine.name, output->record->frame_count,
           output->record->frame_count == 1 ? "" : "s", output->record->frames[0].width,
           output->record->frames[0].height);
    for (size_t a = 0; a < options->axis_count; a++)
        if (is_shown(&options->axes[a]))
            printf("%*s ",
                   (int)strlen(options->axes[a].key) > 16 ? (int)strlen(options->axes[a].key) : 16,
                   options->axes[a].key);
    printf("%9s %8s %14s %10s  %-12s %11s %8s %8s %8s %11s\n", "rendering", "shading", "frame ms",
           "frames/s", "bound by", "composition", "geometry", "raster", "shading", "framebuffer");
}

static double busy_share(const struct what_if_result *result, ticks busy) {
    return result->end ? 100 * (double)busy / (double)result->end : 0;
}

static void print_row(const struct prediction_output *output, size_t combination,
                      const struct what_if *question, const struct what_if_result *result) {
    const struct analysis_options *options = output->options;
    char text[32];
    ticks busy[5] = {0};
    for (uint32_t f = 0; f < result->frame_count; f++) {
        const struct what_if_frame *frame = &result->frames[f];
        int column = 0;
#define ADD_BUSY(key, value) busy[column++] += value;
        FRAME_TIMES(ADD_BUSY)
#undef ADD_BUSY
    }
    for (size_t a = 0; a < options->axis_count; a++)
        if (is_shown(&options->axes[a]))
            printf("%*s ",
                   (int)strlen(options->axes[a].key) > 16 ? (int)strlen(options->axes[a].key) : 16,
                   analysis_value_text(&options->axes[a], analysis_choice(options, combination, a),
                                       text));
    const double frame_ms =
        1e3 * ticks_to_s(question->machine.rate, result->end) / result->frame_count;
    printf("%9u %8u %14.6f %10.3f  %-12s", question->rendering_nodes, question->shading_nodes,
           frame_ms, frame_ms > 0 ? 1e3 / frame_ms : 0, timing_resource_name(result->bound_by));
    printf(" %9.1f %% %6.1f %% %6.1f %% %6.1f %% %9.1f %%\n", busy_share(result, busy[0]),
           busy_share(result, busy[1]), busy_share(result, busy[2]), busy_share(result, busy[3]),
           busy_share(result, busy[4]));
    fflush(stdout); /* results show as they come */
}

static void put_csv(struct prediction_output *output, const char *text) {
    if (output->has_csv_file)
        replacement_file_append(&output->csv, text, strlen(text));
    else
        fputs(text, stdout);
}

static void csv_head(struct prediction_output *output) {
    const struct analysis_options *options = output->options;
    for (size_t a = 0; a < options->axis_count; a++)
        if (options->axes[a].kind != ANALYSIS_RENDERING_NODES &&
            options->axes[a].kind != ANALYSIS_SHADING_NODES) {
            put_csv(output, options->axes[a].key);
            put_csv(output, ",");
        }
    put_csv(output, "rendering_nodes,shading_nodes,frame,time_ps,time_ticks,ticks_per_s,bound_by,"
                    "composition_bytes,composition_sent_bytes,geometry_bytes");
#define CSV_KEY(key, value) put_csv(output, "," key "_ps");
    FRAME_TIMES(CSV_KEY)
#undef CSV_KEY
    put_csv(output, "\n");
}

static void csv_rows(struct prediction_output *output, size_t combination,
                     const struct what_if *question, const struct what_if_result *result) {
    const struct analysis_options *options = output->options;
    const struct tick_rate rate = question->machine.rate;
    char text[512], value[32];
    for (uint32_t f = 0; f < result->frame_count; f++) {
        const struct what_if_frame *frame = &result->frames[f];
        for (size_t a = 0; a < options->axis_count; a++)
            if (options->axes[a].kind != ANALYSIS_RENDERING_NODES &&
                options->axes[a].kind != ANALYSIS_SHADING_NODES) {
                put_csv(output,
                        analysis_value_text(&options->axes[a],
                                            analysis_choice(options, combination, a), value));
                put_csv(output, ",");
            }
        snprintf(text, sizeof text,
                 "%u,%u,%d,%" PRId64 ",%" PRId64 ",%" PRIu64 ",%s,%" PRId64 ",%" PRId64 ",%" PRIu64,
                 question->rendering_nodes, question->shading_nodes,
                 output->record->frames[f].number, ticks_to_ps(rate, frame->times.time),
                 frame->times.time, rate.per_s, timing_resource_name(frame->times.bound_by),
                 frame->times.composition_bytes, frame->times.composition_sent_bytes,
                 frame->geometry_bytes);
        put_csv(output, text);
#define CSV_VALUE(key, time)                                                                       \
    snprintf(text, sizeof text, ",%" PRId64, ticks_to_ps(rate, time));                             \
    put_csv(output, text);
        FRAME_TIMES(CSV_VALUE)
#undef CSV_VALUE
        put_csv(output, "\n");
    }
}

static void add_json_frames(cJSON *object, const struct prediction_output *output,
                            const struct what_if *question, const struct what_if_result *result,
                            const struct timeline *timeline) {
    const struct tick_rate rate = question->machine.rate;
    cJSON *frames = cJSON_AddArrayToObject(object, "frames");
    for (uint32_t f = 0; f < result->frame_count; f++) {
        const struct what_if_frame *frame = &result->frames[f];
        cJSON *item = cJSON_CreateObject();
        json_add_whole(item, "frame", output->record->frames[f].number);
        json_add_whole(item, "time_ps", ticks_to_ps(rate, frame->times.time));
        json_add_whole(item, "time_ticks", frame->times.time);
        json_add_whole(item, "start_ticks", frame->times.start);
        json_add_whole(item, "end_ticks", frame->times.end);
        cJSON_AddStringToObject(item, "bound_by", timing_resource_name(frame->times.bound_by));
#define JSON_TIME(key, time) json_add_whole(item, key "_ps", ticks_to_ps(rate, time));
        FRAME_TIMES(JSON_TIME)
#undef JSON_TIME
        json_add_whole(item, "composition_bytes", frame->times.composition_bytes);
        json_add_whole(item, "composition_sent_bytes", frame->times.composition_sent_bytes);
        json_add_whole(item, "geometry_bytes", (int64_t)frame->geometry_bytes);
        if (timeline)
            explain_add_json(item,
                             &(struct explanation){timeline, rate, question->rendering_nodes,
                                                   question->shading_nodes},
                             f);
        cJSON_AddItemToArray(frames, item);
    }
}

static cJSON *json_combination(const struct prediction_output *output, size_t combination,
                               const struct what_if *question) {
    const struct analysis_options *options = output->options;
    cJSON *object = cJSON_CreateObject();
    json_add_whole(object, "rendering_nodes", question->rendering_nodes);
    json_add_whole(object, "shading_nodes", question->shading_nodes);
    for (size_t a = 0; a < options->axis_count; a++) {
        const struct analysis_axis *axis = &options->axes[a];
        const size_t choice = analysis_choice(options, combination, a);
        if (axis->kind == ANALYSIS_RENDERING_NODES || axis->kind == ANALYSIS_SHADING_NODES)
            continue;
        if (axis->labels)
            cJSON_AddStringToObject(object, axis->key, axis->labels[choice]);
        else
            json_add_whole(object, axis->key, axis->values[choice]);
    }
    return object;
}

/* Solves one combination and puts it out in every form asked for. A combination that cannot be
 * solved is a result as well: it says why. */
static void predict_one(struct prediction_output *output, struct what_if_solver *solver,
                        size_t combination) {
    struct status status = {0};
    struct what_if question;
    struct what_if_result result;
    struct timeline *timeline = NULL;
    const struct analysis_options *options = output->options;
    bool ok = analysis_question(options, output->record, combination, &question, &status);
    if (ok && options->wants_explanation)
        timeline =
            timeline_create(&question.machine, question.rendering_nodes, question.shading_nodes);
    ok = ok && what_if_solve(solver, &question, timeline, &result, &status);
    cJSON *object = output->combinations ? json_combination(output, combination, &question) : NULL;
    if (!ok) {
        output->failures++;
        fprintf(stderr, "sortlast: combination %zu: %s\n", combination, status.message);
        if (object)
            cJSON_AddStringToObject(object, "error", status.message);
    } else {
        if (!options->is_quiet)
            print_row(output, combination, &question, &result);
        if (options->csv)
            csv_rows(output, combination, &question, &result);
        if (object) {
            json_add_whole(object, "time_ps", predict_frame_ps(&question, &result));
            json_add_whole(object, "end_ps", ticks_to_ps(question.machine.rate, result.end));
            json_add_whole(object, "end_ticks", result.end);
            json_add_whole(object, "ticks_per_s", (int64_t)question.machine.rate.per_s);
            cJSON_AddStringToObject(object, "bound_by", timing_resource_name(result.bound_by));
            add_json_frames(object, output, &question, &result, timeline);
        }
        if (timeline && !options->is_quiet)
            explain_print(stdout,
                          &(struct explanation){timeline, question.machine.rate,
                                                question.rendering_nodes, question.shading_nodes});
    }
    if (object)
        cJSON_AddItemToArray(output->combinations, object);
    timeline_destroy(timeline);
}

static bool predict_all(const struct analysis_options *options, const struct run_record *record,
                        struct status *status) {
    struct prediction_output output = {.options = options, .record = record};
    cJSON *document = options->json ? cJSON_CreateObject() : NULL;
    if (document) {
        cJSON_AddStringToObject(document, "scene", record->scene);
        output.combinations = cJSON_AddArrayToObject(document, "combinations");
    }
    output.has_csv_file = options->csv && strcmp(options->csv, "-");
    if (output.has_csv_file && !replacement_file_open(&output.csv, options->csv, status)) {
        cJSON_Delete(document);
        return false;
    }
    struct what_if_solver *solver = what_if_solver_create(record);
    print_head(&output);
    if (options->csv)
        csv_head(&output);
    const size_t combinations = analysis_combinations(options);
    for (size_t i = 0; i < combinations; i++)
        predict_one(&output, solver, i);
    struct what_if question;
    bool ok = true;
    if (options->wants_sensitivity && !output.failures)
        ok = analysis_question(options, record, 0, &question, status) &&
             sensitivity_report(solver, record, &question, options->is_quiet, document, status);
    if (output.has_csv_file && ok)
        ok = replacement_file_commit(&output.csv, status);
    else if (output.has_csv_file)
        replacement_file_abandon(&output.csv);
    ok = ok && (!document || json_write_document(options->json, document, status));
    if (ok && (fflush(stdout) || ferror(stdout)))
        ok = status_fail(status, STATUS_IO, "cannot write to standard output");
    what_if_solver_destroy(solver);
    cJSON_Delete(document);
    if (ok && output.failures)
        ok = status_fail(status, STATUS_INVALID, "%zu of %zu combinations have no answer",
                         output.failures, combinations);
    return ok;
}

int predict_main(int argc, char **argv) {
    static const struct analysis_verb verb = {
        .name = "predict",
        .usage = "predict [options] RECORD|SCENE.rib",
        .about = "Says what a recorded run would take on other clusters, exactly, without "
                 "rendering again.",
        .more_options =
            "      --sensitivity          what changing each machine parameter changes\n"
            "      --explain              where the time went: critical path, and what "
            "every node waited for",
        .has_csv = true,
        .has_sensitivity = true,
        .has_explanation = true,
    };
    return analysis_main(&verb, argc, argv, predict_all);
}
