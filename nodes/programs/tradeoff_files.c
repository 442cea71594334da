/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"
#include "nodes/programs/tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_error(cJSON *object, const struct tradeoff_error *error) {
    cJSON_AddNumberToObject(object, "max_error", error->max_error);
    if (isfinite(error->psnr_db))
        cJSON_AddNumberToObject(object, "psnr_db", error->psnr_db);
    else
        cJSON_AddNullToObject(object, "psnr_db");
    cJSON_AddNumberToObject(object, "square_error", error->square_error);
    cJSON_AddNumberToObject(object, "flip_mean", error->flip_mean);
    cJSON_AddNumberToObject(object, "flip_max", error->flip_max);
}

static void add_frames(cJSON *object, const char *key, const struct tradeoff_frames *frames) {
    cJSON_AddItemToObject(object, key, cJSON_CreateIntArray(frames->numbers, frames->count));
}

static cJSON *result_json(const struct tradeoff_study *study,
                          const struct tradeoff_result *result) {
    cJSON *object = cJSON_CreateObject(), *setting = cJSON_AddObjectToObject(object, "setting");
    for (int k = 0; k < study->knob_count; k++)
        cJSON_AddStringToObject(setting, study->knobs[k].key,
                                study->knobs[k].values[result->setting.choice[k]]);
    json_add_whole(object, "time_ps", result->time_ps);
    json_add_whole(object, "shading_ps", result->shading_ps);
    cJSON_AddNumberToObject(object, "bytes_per_sample", result->bytes_per_sample);
    json_add_whole(object, "transfer_map_bytes", result->map_bytes);
    cJSON_AddNumberToObject(object, "wall_s", result->wall_s);
    add_error(object, &result->error);
    if (result->is_judged) {
        cJSON *judged = cJSON_AddObjectToObject(object, "judged");
        json_add_whole(judged, "time_ps", result->judged_time_ps);
        add_error(judged, &result->judged);
    } else {
        cJSON_AddNullToObject(object, "judged");
    }
    cJSON_AddBoolToObject(object, "refused", result->is_refused);
    cJSON_AddBoolToObject(object, "on_frontier", result->is_on_frontier);
    cJSON_AddStringToObject(object, "picture", result->picture);
    return object;
}

bool tradeoff_write_json(const struct tradeoff_study *study, const char *path,
                         struct status *status) {
    cJSON *document = cJSON_CreateObject();
    cJSON_AddStringToObject(document, "scene", study->scene);
    cJSON_AddStringToObject(document, "identity", study->identity);
    add_frames(document, "tune_frames", &study->tuned);
    add_frames(document, "judge_frames", &study->unseen);
    cJSON *knobs = cJSON_AddArrayToObject(document, "knobs");
    for (int k = 0; k < study->knob_count; k++) {
        cJSON *knob = cJSON_CreateObject();
        cJSON_AddStringToObject(knob, "name", study->knobs[k].key);
        cJSON_AddStringToObject(knob, "about", study->knobs[k].about);
        cJSON_AddItemToObject(knob, "values",
                              cJSON_CreateStringArray((const char **)study->knobs[k].values,
                                                      study->knobs[k].value_count));
        cJSON_AddItemToArray(knobs, knob);
    }
    cJSON *results = cJSON_AddArrayToObject(document, "results");
    for (size_t i = 0; i < study->result_count; i++)
        cJSON_AddItemToArray(results, result_json(study, &study->results[i]));
    if (study->chosen >= 0)
        cJSON_AddNumberToObject(document, "chosen", study->chosen);
    else
        cJSON_AddNullToObject(document, "chosen");
    const bool ok = json_write_document(path, document, status);
    cJSON_Delete(document);
    return ok;
}

static double number_of(const cJSON *object, const char *key, double missing) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    return cJSON_IsNumber(item) ? item->valuedouble : missing;
}

static void read_error(const cJSON *object, struct tradeoff_error *error) {
    error->max_error = number_of(object, "max_error", 0);
    error->psnr_db = number_of(object, "psnr_db", INFINITY);
    error->square_error = number_of(object, "square_error", 0);
    error->flip_mean = number_of(object, "flip_mean", 0);
    error->flip_max = number_of(object, "flip_max", 0);
}

/* False when the setting names a value that this study does not have. */
static bool read_result(const struct tradeoff_study *study, const cJSON *object,
                        struct tradeoff_result *result) {
    const cJSON *setting = cJSON_GetObjectItemCaseSensitive(object, "setting");
    *result = (struct tradeoff_result){0};
    for (int k = 0; k < study->knob_count; k++) {
        const cJSON *value = cJSON_GetObjectItemCaseSensitive(setting, study->knobs[k].key);
        int v = 0;
        while (cJSON_IsString(value) && v < study->knobs[k].value_count &&
               strcmp(study->knobs[k].values[v], value->valuestring))
            v++;
        if (!cJSON_IsString(value) || v == study->knobs[k].value_count)
            return false;
        result->setting.choice[k] = v;
    }
    const cJSON *picture = cJSON_GetObjectItemCaseSensitive(object, "picture");
    if (cJSON_IsString(picture))
        snprintf(result->picture, sizeof result->picture, "%.60s", picture->valuestring);
    result->time_ps = (int64_t)number_of(object, "time_ps", 0);
    result->shading_ps = (int64_t)number_of(object, "shading_ps", 0);
    result->bytes_per_sample = number_of(object, "bytes_per_sample", 0);
    result->map_bytes = (int64_t)number_of(object, "transfer_map_bytes", 0);
    result->wall_s = number_of(object, "wall_s", 0);
    read_error(object, &result->error);
    const cJSON *judged = cJSON_GetObjectItemCaseSensitive(object, "judged");
    result->is_judged = cJSON_IsObject(judged);
    if (result->is_judged) {
        result->judged_time_ps = (int64_t)number_of(judged, "time_ps", 0);
        read_error(judged, &result->judged);
    }
    return result->time_ps > 0;
}

bool tradeoff_read_json(struct tradeoff_study *study, const char *path, struct status *status) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return true; /* nothing to go on with */
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    char block[4096];
    for (size_t got; (got = fread(block, 1, sizeof block, file)) > 0;)
        fwrite(block, 1, got, memory);
    fclose(memory);
    fclose(file);
    cJSON *document = cJSON_Parse(text);
    free(text);
    const cJSON *identity = cJSON_GetObjectItemCaseSensitive(document, "identity"), *item;
    const bool is_ours =
        cJSON_IsString(identity) && !strcmp(identity->valuestring, study->identity);
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(document, "results")) {
        struct tradeoff_result result;
        if (!is_ours || !read_result(study, item, &result))
            continue;
        study->results = memory_grow(study->results, &study->result_capacity,
                                     study->result_count + 1, sizeof *study->results);
        study->results[study->result_count++] = result;
    }
    cJSON_Delete(document);
    return is_ours || status_fail(status, STATUS_INVALID,
                                  "%s holds another study; choose another folder with -o", path);
}
