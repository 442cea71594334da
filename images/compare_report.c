/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image_compare.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

static void report_json_pair(cJSON *to, const char *key, const uint64_t pair[2]) {
    char apart[32];
    cJSON_AddNumberToObject(to, key, (double)(pair[0] + pair[1]));
    snprintf(apart, sizeof apart, "%s_first", key);
    cJSON_AddNumberToObject(to, apart, (double)pair[0]);
    snprintf(apart, sizeof apart, "%s_second", key);
    cJSON_AddNumberToObject(to, apart, (double)pair[1]);
}

/* cJSON would write an infinity as null by itself; here it is said. */
static void report_json_finite(cJSON *to, const char *key, double value) {
    cJSON_AddItemToObject(to, key,
                          isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull());
}

static void report_json_measures(cJSON *to, const struct image_measures *measures) {
    cJSON_AddBoolToObject(to, "identical", measures->differing == 0);
    report_json_pair(to, "nan", measures->nan);
    report_json_pair(to, "inf", measures->infinite);
    cJSON_AddNumberToObject(to, "max_error", measures->max_error);
    cJSON_AddNumberToObject(to, "mean_error", measures->mean_error);
    cJSON_AddNumberToObject(to, "rmse", measures->rmse);
    report_json_finite(to, "psnr_db", measures->psnr_db);
    cJSON_AddNumberToObject(to, "over_1_255", measures->over_1_255);
    cJSON_AddNumberToObject(to, "over_2_255", measures->over_2_255);
    cJSON_AddNumberToObject(to, "samples", (double)measures->samples);
    cJSON_AddNumberToObject(to, "differing", (double)measures->differing);
}

static void report_json_perception(cJSON *to, bool is_there, double ssim,
                                   const struct flip_summary *flip) {
    if (!is_there) {
        cJSON_AddNullToObject(to, "ssim");
        cJSON_AddNullToObject(to, "flip");
        return;
    }
    cJSON_AddNumberToObject(to, "ssim", ssim);
    cJSON *object = cJSON_AddObjectToObject(to, "flip");
    cJSON_AddNumberToObject(object, "mean", flip->mean);
    cJSON_AddNumberToObject(object, "weighted_median", flip->weighted_median);
    cJSON_AddNumberToObject(object, "max", flip->max);
}

struct cJSON *image_difference_json(const struct image_difference *difference) {
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "width", difference->width);
    cJSON_AddNumberToObject(json, "height", difference->height);
    report_json_measures(json, &difference->overall);
    cJSON_AddNumberToObject(json, "integer_channels_differing",
                            difference->integer_channels_differing);
    report_json_perception(json, difference->has_color, difference->ssim, &difference->flip);
    cJSON *channels = cJSON_AddObjectToObject(json, "channels");
    for (int i = 0; i < difference->channel_count; i++) {
        cJSON *channel = cJSON_AddObjectToObject(channels, difference->channels[i].name);
        cJSON_AddBoolToObject(channel, "integer", difference->channels[i].integer);
        report_json_measures(channel, &difference->channels[i].measures);
        report_json_perception(channel, difference->channels[i].has_perception,
                               difference->channels[i].ssim, &difference->channels[i].flip);
    }
    return json;
}

/* A zero is "0" and nothing else is. */
static void report_number(char *text, size_t size, double value) {
    if (value == 0)
        snprintf(text, size, "0");
    else
        snprintf(text, size, "%.3e", value);
}

static void report_share(char *text, size_t size, double share) {
    if (share == 0)
        snprintf(text, size, "0");
    else
        snprintf(text, size, share < 1e-4 ? "%.1e %%" : "%.3f %%", 100 * share);
}

static void report_row(FILE *out, int name_width, const char *name,
                       const struct image_measures *measures, bool integer) {
    char max[32], mean[32], rmse[32], psnr[32], over1[32], over2[32], nan[48], infinite[48];
    report_number(max, sizeof max, measures->max_error);
    report_number(mean, sizeof mean, measures->mean_error);
    report_number(rmse, sizeof rmse, measures->rmse);
    snprintf(psnr, sizeof psnr, isfinite(measures->psnr_db) ? "%.2f" : "inf", measures->psnr_db);
    report_share(over1, sizeof over1, measures->over_1_255);
    report_share(over2, sizeof over2, measures->over_2_255);
    snprintf(nan, sizeof nan, "%" PRIu64 "/%" PRIu64, measures->nan[0], measures->nan[1]);
    snprintf(infinite, sizeof infinite, "%" PRIu64 "/%" PRIu64, measures->infinite[0],
             measures->infinite[1]);
    if (integer) /* identities, not amounts: ratios would say nothing */
        for (int i = 0; i < 6; i++)
            strcpy((char *[]){rmse, psnr, over1, over2, nan, infinite}[i], "-");
    fprintf(out, "%-*s %10s %10s %10s %8s %10s %10s %9s %9s %11" PRIu64 "\n", name_width, name, max,
            mean, rmse, psnr, over1, over2, nan, infinite, measures->differing);
}

void image_difference_print(const struct image_difference *difference, FILE *out) {
    int name_width = (int)strlen("channel");
    for (int i = 0; i < difference->channel_count; i++) {
        int length = (int)strlen(difference->channels[i].name);
        name_width = length > name_width ? length : name_width;
    }
    fprintf(out, "%-*s %10s %10s %10s %8s %10s %10s %9s %9s %11s\n", name_width, "channel",
            "max error", "mean", "rmse", "psnr dB", "> 1/255", "> 2/255", "nan", "inf",
            "differing");
    for (int i = 0; i < difference->channel_count; i++)
        report_row(out, name_width, difference->channels[i].name, &difference->channels[i].measures,
                   difference->channels[i].integer);
    if (difference->channel_count > 1)
        report_row(out, name_width, "all", &difference->overall, false);
    if (difference->has_color)
        fprintf(out, "FLIP mean %.6f, weighted median %.6f, max %.6f; SSIM %.6f\n",
                difference->flip.mean, difference->flip.weighted_median, difference->flip.max,
                difference->ssim);
}
