/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image_compare.h"

#include "images/image_files.h"
#include "images/srgb.h"
#include "images/ssim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A sum with what rounding lost so far (Neumaier): the error stays below 2^-52 of the sum of
 * magnitudes however many terms there are. */
struct image_sum {
    double sum, lost;
};

static void image_sum_add(struct image_sum *to, double term) {
    const double sum = to->sum + term;
    to->lost += fabs(to->sum) >= fabs(term) ? (to->sum - sum) + term : (term - sum) + to->sum;
    to->sum = sum;
}

/* Sums from which measures are made, so that channels can be joined. */
struct image_sums {
    struct image_measures measures;
    uint64_t finite, over1, over2;
    struct image_sum absolute, squared;
};

static void image_sums_add_error(struct image_sums *sums, double error) {
    sums->finite++;
    image_sum_add(&sums->absolute, error);
    image_sum_add(&sums->squared, error * error);
    if (error > sums->measures.max_error)
        sums->measures.max_error = error;
    sums->over1 += error > 1 / 255.0;
    sums->over2 += error > 2 / 255.0;
}

static void image_sums_channel(struct image_sums *sums, const struct image_channel *first,
                               const struct image_channel *second, size_t count) {
    struct image_measures *measures = &sums->measures;
    measures->samples = count;
    for (size_t i = 0; i < count; i++) {
        measures->differing += first->integers[i] != second->integers[i];
        if (first->type == IMAGE_UINT) {
            image_sums_add_error(sums,
                                 fabs((double)first->integers[i] - (double)second->integers[i]));
            continue;
        }
        float a = first->values[i], b = second->values[i];
        if (isfinite(a) && isfinite(b)) {
            image_sums_add_error(sums, fabs((double)a - (double)b));
            continue;
        }
        measures->nan[0] += isnan(a) != 0;
        measures->nan[1] += isnan(b) != 0;
        measures->infinite[0] += isinf(a) != 0;
        measures->infinite[1] += isinf(b) != 0;
    }
}

static void image_sums_join(struct image_sums *sums, const struct image_sums *more) {
    struct image_measures *to = &sums->measures;
    const struct image_measures *from = &more->measures;
    to->samples += from->samples;
    to->differing += from->differing;
    for (int i = 0; i < 2; i++) {
        to->nan[i] += from->nan[i];
        to->infinite[i] += from->infinite[i];
    }
    to->max_error = from->max_error > to->max_error ? from->max_error : to->max_error;
    sums->finite += more->finite;
    sums->over1 += more->over1;
    sums->over2 += more->over2;
    image_sum_add(&sums->absolute, more->absolute.sum);
    image_sum_add(&sums->absolute, more->absolute.lost);
    image_sum_add(&sums->squared, more->squared.sum);
    image_sum_add(&sums->squared, more->squared.lost);
}

static void image_sums_finish(const struct image_sums *sums, struct image_measures *measures) {
    *measures = sums->measures;
    double count = sums->finite ? (double)sums->finite : 1;
    const double absolute = sums->absolute.sum + sums->absolute.lost,
                 squared = sums->squared.sum + sums->squared.lost;
    measures->mean_error = absolute / count;
    measures->rmse = sqrt(squared / count);
    measures->psnr_db = squared > 0 ? -20 * log10(measures->rmse) : INFINITY;
    measures->over_1_255 = (double)sums->over1 / count;
    measures->over_2_255 = (double)sums->over2 / count;
}

/* Whether `name` is in the comma-separated list; an absent list holds every name. */
static bool image_list_has(const char *list, const char *name) {
    size_t length = strlen(name);
    for (const char *at = list; at; at = strchr(at, ',')) {
        at += *at == ',';
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || !at[length]))
            return true;
    }
    return !list;
}

static bool image_check_list(const struct image *first, const struct image *second,
                             const char *list, struct status *status) {
    for (const char *at = list; at; at = strchr(at, ',')) {
        at += *at == ',';
        char name[32];
        size_t length = strcspn(at, ",");
        if (length && length < sizeof name) {
            memcpy(name, at, length);
            name[length] = 0;
            if (image_find_channel(first, name) && image_find_channel(second, name))
                continue;
        }
        return status_fail(status, STATUS_INVALID,
                           "channel '%.*s' to compare is not in both images", (int)length, at);
    }
    return true;
}

static bool image_check_pair(const struct image *first, const struct image *second,
                             const char *only, struct status *status) {
    if (first->width != second->width || first->height != second->height)
        return status_fail(status, STATUS_INVALID,
                           "the images differ in size: %d x %d and %d x %d pixels", first->width,
                           first->height, second->width, second->height);
    if (only && !image_check_list(first, second, only, status))
        return false;
    int chosen = 0;
    for (int i = 0; i < first->channel_count; i++) {
        const struct image_channel *a = &first->channels[i];
        if (!image_list_has(only, a->name))
            continue;
        const struct image_channel *b = image_find_channel(second, a->name);
        if (!b)
            return status_fail(status, STATUS_INVALID,
                               "the images differ in channels: '%s' is only in the first", a->name);
        if ((a->type == IMAGE_UINT) != (b->type == IMAGE_UINT))
            return status_fail(status, STATUS_INVALID,
                               "channel '%s' holds integers in the %s image only", a->name,
                               a->type == IMAGE_UINT ? "first" : "second");
        chosen++;
    }
    for (int i = 0; i < second->channel_count; i++)
        if (image_list_has(only, second->channels[i].name) &&
            !image_find_channel(first, second->channels[i].name))
            return status_fail(status, STATUS_INVALID,
                               "the images differ in channels: '%s' is only in the second",
                               second->channels[i].name);
    return chosen ? true : status_fail(status, STATUS_INVALID, "there are no channels to compare");
}

static bool image_colors(const struct image *image, const char *only, const float *planes[3]) {
    static const char names[3][2] = {"R", "G", "B"};
    for (int c = 0; c < 3; c++) {
        const struct image_channel *channel = image_find_channel(image, names[c]);
        if (!channel || channel->type == IMAGE_UINT || !image_list_has(only, names[c]))
            return false;
        planes[c] = channel->values;
    }
    return true;
}

static struct image_channel_difference *image_find_difference(struct image_difference *difference,
                                                              const char *name) {
    for (int i = 0; i < difference->channel_count; i++)
        if (strcmp(difference->channels[i].name, name) == 0)
            return &difference->channels[i];
    return NULL;
}

/* SSIM and FLIP of R, G and B each, as grey pictures. */
static bool image_compare_channels(const float *const a[3], const float *const b[3],
                                   double pixels_per_degree, struct image_difference *difference,
                                   struct status *status) {
    static const char names[3][2] = {"R", "G", "B"};
    const int width = difference->width, height = difference->height;
    const size_t count = (size_t)width * (size_t)height;
    float *map = memory_try(count, sizeof(float), status);
    bool ok = map != NULL;
    for (int c = 0; ok && c < 3; c++) {
        struct image_channel_difference *channel = image_find_difference(difference, names[c]);
        const float *const grey_a[3] = {a[c], a[c], a[c]}, *const grey_b[3] = {b[c], b[c], b[c]};
        channel->has_perception = true;
        channel->ssim = 1;
        if (memcmp(a[c], b[c], count * sizeof(float)))
            ok = ssim_compare(grey_a, grey_b, width, height, &channel->ssim, status) &&
                 flip_compare(grey_a, grey_b, width, height, pixels_per_degree, map, &channel->flip,
                              status);
    }
    free(map);
    return ok;
}

static bool image_compare_perception(const struct image *first, const struct image *second,
                                     const struct image_compare_options *options,
                                     struct image_difference *difference, struct status *status) {
    const float *a[3], *b[3];
    if (options->without_perception || !image_colors(first, options->only, a) ||
        !image_colors(second, options->only, b))
        return true;
    size_t count = (size_t)first->width * (size_t)first->height;
    difference->flip_map = memory_try(count, sizeof(float), status);
    if (!difference->flip_map)
        return false;
    difference->has_color = true;
    difference->ssim = 1;
    bool equal = true;
    for (int c = 0; c < 3; c++)
        equal = equal && memcmp(a[c], b[c], count * sizeof(float)) == 0;
    double pixels_per_degree =
        options->pixels_per_degree != 0 ? options->pixels_per_degree : FLIP_PIXELS_PER_DEGREE;
    if (options->channel_perception &&
        !image_compare_channels(a, b, pixels_per_degree, difference, status))
        return false;
    return equal || (ssim_compare(a, b, first->width, first->height, &difference->ssim, status) &&
                     flip_compare(a, b, first->width, first->height, pixels_per_degree,
                                  difference->flip_map, &difference->flip, status));
}

bool image_compare(const struct image *first, const struct image *second,
                   const struct image_compare_options *options, struct image_difference *difference,
                   struct status *status) {
    static const struct image_compare_options defaults = {0};
    options = options ? options : &defaults;
    *difference = (struct image_difference){.width = first->width, .height = first->height};
    if (!image_check_pair(first, second, options->only, status))
        return false;
    difference->channels = memory_get((size_t)first->channel_count, sizeof *difference->channels);
    struct image_sums overall = {0};
    for (int i = 0; i < first->channel_count; i++) {
        const struct image_channel *channel = &first->channels[i];
        if (!image_list_has(options->only, channel->name))
            continue;
        struct image_channel_difference *result =
            &difference->channels[difference->channel_count++];
        struct image_sums sums = {0};
        memcpy(result->name, channel->name, sizeof result->name);
        result->integer = channel->type == IMAGE_UINT;
        image_sums_channel(&sums, channel, image_find_channel(second, channel->name),
                           (size_t)first->width * (size_t)first->height);
        image_sums_finish(&sums, &result->measures);
        if (result->integer) {
            difference->integer_channels_differing += result->measures.differing > 0;
            overall.measures.differing += result->measures.differing;
            overall.measures.samples += result->measures.samples;
        } else {
            image_sums_join(&overall, &sums);
        }
    }
    image_sums_finish(&overall, &difference->overall);
    if (image_compare_perception(first, second, options, difference, status))
        return true;
    image_difference_finish(difference);
    return false;
}

void image_difference_finish(struct image_difference *difference) {
    free(difference->channels);
    free(difference->flip_map);
    *difference = (struct image_difference){0};
}

bool image_difference_identical(const struct image_difference *difference) {
    return difference->overall.differing == 0;
}

uint64_t image_measures_not_finite(const struct image_measures *measures) {
    return measures->nan[0] + measures->nan[1] + measures->infinite[0] + measures->infinite[1];
}

bool image_difference_image(const struct image *first, const struct image *second,
                            const struct image_difference *difference, struct image **image,
                            struct status *status) {
    if (!image_create(first->width, first->height, image, status))
        return false;
    size_t count = (size_t)first->width * (size_t)first->height;
    for (int i = 0; i < difference->channel_count; i++) {
        const char *name = difference->channels[i].name;
        const struct image_channel *a = image_find_channel(first, name);
        const struct image_channel *b = image_find_channel(second, name);
        struct image_channel *to = image_add_channel(*image, name, a->type);
        if (!to) {
            image_destroy(*image);
            *image = NULL;
            return status_fail(status, STATUS_LIMIT, "out of memory for the difference image");
        }
        for (size_t k = 0; k < count; k++)
            if (a->type == IMAGE_UINT)
                to->integers[k] = a->integers[k] > b->integers[k] ? a->integers[k] - b->integers[k]
                                                                  : b->integers[k] - a->integers[k];
            else
                to->values[k] = fabsf(a->values[k] - b->values[k]);
    }
    return true;
}

bool image_difference_flip_image(const struct image_difference *difference, bool plain,
                                 struct image **image, struct status *status) {
    static const char names[3][2] = {"R", "G", "B"};
    if (!difference->has_color)
        return status_fail(status, STATUS_INVALID, "FLIP needs channels R, G and B in both images");
    if (!image_create(difference->width, difference->height, image, status))
        return false;
    size_t count = (size_t)difference->width * (size_t)difference->height;
    float *planes[3] = {0};
    for (int c = 0; c < (plain ? 1 : 3); c++) {
        struct image_channel *channel =
            image_add_channel(*image, plain ? "FLIP" : names[c], IMAGE_FLOAT);
        if (!channel) {
            image_destroy(*image);
            *image = NULL;
            return status_fail(status, STATUS_LIMIT, "out of memory for the FLIP map");
        }
        planes[c] = channel->values;
    }
    if (plain) {
        memcpy(planes[0], difference->flip_map, count * sizeof(float));
        return true;
    }
    /* One colour for each of 256 steps, as the map goes to an 8-bit file. */
    float colors[256][3];
    for (int step = 0; step < 256; step++) {
        double rgb[3];
        flip_color((float)step / 255, rgb);
        for (int c = 0; c < 3; c++)
            colors[step][c] = (float)srgb_to_linear(rgb[c]);
    }
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            planes[c][i] = colors[(int)(difference->flip_map[i] * 255 + 0.5f)][c];
    return true;
}
