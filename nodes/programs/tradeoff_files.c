/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"
#include "nodes/programs/tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    cJSON_AddNumberToObject(object, "max_error", result->max_error);
    if (isfinite(result->psnr_db))
        cJSON_AddNumberToObject(object, "psnr_db", result->psnr_db);
    else
        cJSON_AddNullToObject(object, "psnr_db");
    cJSON_AddNumberToObject(object, "square_error", result->square_error);
    cJSON_AddNumberToObject(object, "flip_mean", result->flip_mean);
    cJSON_AddNumberToObject(object, "flip_max", result->flip_max);
    cJSON_AddBoolToObject(object, "on_frontier", result->is_on_frontier);
    cJSON_AddStringToObject(object, "picture", result->picture);
    return object;
}

bool tradeoff_write_json(const struct tradeoff_study *study, const char *path,
                         struct status *status) {
    cJSON *document = cJSON_CreateObject();
    cJSON_AddStringToObject(document, "scene", study->scene);
    cJSON_AddStringToObject(document, "identity", study->identity);
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
    result->max_error = number_of(object, "max_error", 0);
    result->psnr_db = number_of(object, "psnr_db", INFINITY);
    result->square_error = number_of(object, "square_error", 0);
    result->flip_mean = number_of(object, "flip_mean", 0);
    result->flip_max = number_of(object, "flip_max", 0);
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

/* ---- the page ---- */

static void put_escaped(FILE *out, const char *text) {
    for (; *text; text++)
        *text == '<' ? fputs("&lt;", out) : *text == '&' ? fputs("&amp;", out) : fputc(*text, out);
}

/* Time against PSNR, both as they are; the frontier is joined. */
static void put_plot(FILE *out, const struct tradeoff_study *study) {
    enum { WIDTH = 760, HEIGHT = 380, EDGE = 50 };
    double longest = 1, low = 200, high = 0;
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        const double psnr = fmin(r->psnr_db, 200);
        longest = fmax(longest, (double)r->time_ps);
        low = fmin(low, psnr);
        high = fmax(high, psnr);
    }
    fprintf(out, "<svg width=\"%d\" height=\"%d\" font-size=\"12\">\n", WIDTH, HEIGHT);
    fprintf(out, "<text x=\"%d\" y=\"%d\">simulated time, 0 to %.3f ms</text>\n", WIDTH / 3,
            HEIGHT - 10, longest * 1e-9);
    fprintf(out, "<text x=\"5\" y=\"15\">PSNR, %.1f to %.1f dB</text>\n", low, high);
    fprintf(out,
            "<rect x=\"%d\" y=\"20\" width=\"%d\" height=\"%d\" fill=\"none\" "
            "stroke=\"#999\"/>\n",
            EDGE, WIDTH - EDGE - 10, HEIGHT - 70);
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        const double x = EDGE + (double)r->time_ps / longest * (WIDTH - EDGE - 20);
        const double y =
            30 + (high - fmin(r->psnr_db, 200)) / fmax(high - low, 1e-9) * (HEIGHT - 90);
        char text[512];
        tradeoff_describe(study, &r->setting, text, sizeof text);
        fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\"><title>", x, y,
                r->is_on_frontier ? 6 : 4,
                (int)i == study->chosen ? "#d40"
                : r->is_on_frontier     ? "#06c"
                                        : "#bbb");
        put_escaped(out, text);
        fprintf(out, "</title></circle>\n");
    }
    fprintf(out, "</svg>\n");
}

bool tradeoff_write_page(const struct tradeoff_study *study, const char *path,
                         struct status *status) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    fprintf(out,
            "<!DOCTYPE html>\n<meta charset=\"utf-8\"><title>Speed for accuracy</title>\n<h1>");
    put_escaped(out, study->scene);
    fprintf(out, "</h1>\n<p>Blue: no other setting is both quicker and more accurate. Orange: "
                 "chosen. Errors are against the reference in double precision.</p>\n");
    put_plot(out, study);
    fprintf(out, "<table cellpadding=\"4\">\n<tr><th>picture<th>setting<th>time, ms<th>shading, "
                 "ms<th>bytes a sample<th>map, bytes<th>PSNR, dB<th>FLIP mean<th>largest "
                 "error<th>wall, s\n");
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        char setting[512];
        if (!r->is_on_frontier && (int)i != study->chosen)
            continue;
        tradeoff_describe(study, &r->setting, setting, sizeof setting);
        fprintf(out, "<tr%s><td><img src=\"%s\" width=\"160\" alt=\"\"><td>",
                (int)i == study->chosen ? " style=\"background:#fe8\"" : "", r->picture);
        put_escaped(out, setting);
        fprintf(out, "<td>%.3f<td>%.3f<td>%.2f<td>%lld<td>%.2f<td>%.5f<td>%.4f<td>%.2f\n",
                (double)r->time_ps * 1e-9, (double)r->shading_ps * 1e-9, r->bytes_per_sample,
                (long long)r->map_bytes, r->psnr_db, r->flip_mean, r->max_error, r->wall_s);
    }
    fprintf(out, "</table>\n");
    const bool ok = !fclose(out) && text_write_file(path, text, "the page", status);
    free(text);
    return ok;
}
