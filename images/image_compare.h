/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_IMAGE_COMPARE_H
#define IMAGES_IMAGE_COMPARE_H

#include "images/flip.h"
#include "images/image.h"

#include <stdio.h>

struct cJSON;

/* How far apart two sets of samples are. Sums are compensated: means and RMS are within 2^-50 of
 * the true ones, relative, for up to 2^50 samples. Values are taken as they are in memory: linear,
 * not encoded for display, colours premultiplied. Samples that are NaN or infinite in either image
 * are counted first and take no part in the other measures; a NaN that both images share is still
 * counted. */
struct image_measures {
    uint64_t samples;
    uint64_t nan[2], infinite[2];       /* in the first and in the second image */
    uint64_t differing;                 /* samples whose bits differ; 0 and -0 are different bits */
    double max_error, mean_error, rmse; /* of the absolute difference of finite samples */
    double psnr_db;                     /* with peak 1; INFINITY when rmse is 0 */
    double over_1_255, over_2_255;      /* shares of the finite samples, 0 to 1 */
};

struct image_channel_difference {
    char name[32];
    bool integer; /* UINT: `differing` and the errors of the numbers, never NaN, not part of
                     `overall` errors */
    struct image_measures measures;
    bool has_perception; /* asked for, and a colour: of the channel as a grey picture */
    double ssim;
    struct flip_summary flip;
};

struct image_difference {
    int width, height;
    struct image_measures
        overall; /* errors over all FLOAT and HALF channels; `differing` over all channels */
    struct image_channel_difference *channels; /* in the first image's order */
    int channel_count;
    int integer_channels_differing;
    bool has_color; /* channels R, G and B were compared: ssim and flip are set */
    double ssim;
    struct flip_summary flip;
    float *flip_map; /* width * height, row by row, when has_color */
};

struct image_compare_options {
    const char *only;         /* names of the channels to compare, with commas; NULL for all */
    double pixels_per_degree; /* of FLIP; 0 for FLIP_PIXELS_PER_DEGREE */
    bool without_perception;  /* skip SSIM and FLIP */
    bool channel_perception;  /* also SSIM and FLIP of R, G and B each */
};

/* The first image is the reference. Images of different size, or whose compared channels do not
 * match in name and kind (integer or not), are STATUS_INVALID. On success the caller finishes
 * *difference. NULL options: defaults. */
bool image_compare(const struct image *first, const struct image *second,
                   const struct image_compare_options *options, struct image_difference *difference,
                   struct status *status);
/* Harmless on a zeroed or failed difference. */
void image_difference_finish(struct image_difference *difference);

/* Every compared sample has the same bits in both images. */
bool image_difference_identical(const struct image_difference *difference);
/* NaN and infinities of both images. */
uint64_t image_measures_not_finite(const struct image_measures *measures);

/* The absolute difference of each compared channel, under its name; the caller destroys the image.
 */
bool image_difference_image(const struct image *first, const struct image *second,
                            const struct image_difference *difference, struct image **image,
                            struct status *status);
/* FLIP's error map in colours, or for `plain` as one channel named FLIP; needs has_color. */
bool image_difference_flip_image(const struct image_difference *difference, bool plain,
                                 struct image **image, struct status *status);

/* The measures for programs: max_error, mean_error, rmse, psnr_db (null when infinite), ssim, flip
 * {mean, weighted_median, max} (null where they were not computed), nan, inf (both images together,
 * with *_first and *_second apart), over_1_255, over_2_255, differing, identical; overall and for
 * each of `channels`. The caller deletes it. */
struct cJSON *image_difference_json(const struct image_difference *difference);
/* The measures for a person: an aligned table. */
void image_difference_print(const struct image_difference *difference, FILE *out);

/* `sortlast compare`: argv[0] is the verb. Exit status 0 for equal (or within the thresholds
 * given), 1 for different, over a threshold or not finite, 2 for an error. */
int image_compare_main(int argc, char **argv);

#endif
