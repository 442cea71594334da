/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/flip.h"
#include "images/image_compare.h"
#include "images/srgb.h"
#include "images/ssim.h"
#include "reference_metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct image_difference compare(const struct image *a, const struct image *b) {
    struct image_difference difference;
    assert_success(image_compare(a, b, NULL, &difference, &status));
    return difference;
}

static void planes_of(struct image *image, const float *planes[3]) {
    for (int c = 0; c < 3; c++)
        planes[c] = fixture_plane(image, (const char *[]){"R", "G", "B"}[c]);
}

static double flip_mean(struct image *a, struct image *b) {
    struct image_difference difference = compare(a, b);
    double mean = difference.flip.mean;
    image_difference_finish(&difference);
    return mean;
}

static void identical_images_have_no_error(void **state) {
    struct image *image = fixture_picture(90, 70, 1);
    struct image_difference d = compare(image, image);
    assert_true(image_difference_identical(&d));
    assert_true(d.overall.max_error == 0 && d.overall.mean_error == 0 && d.overall.rmse == 0);
    assert_true(isinf(d.overall.psnr_db) && d.overall.psnr_db > 0);
    assert_true(d.ssim == 1 && d.flip.mean == 0 && d.flip.max == 0 && d.flip.weighted_median == 0);
    image_difference_finish(&d);
    image_destroy(image);
}

static void errors_of_four_samples_are_as_by_hand(void **state) {
    struct image *a, *b;
    assert_success(image_create(4, 1, &a, &status));
    image_add_channel(a, "Y", IMAGE_FLOAT);
    b = fixture_copy(a);
    /* 1/255 itself, as a float just above it or below, is near the bound: keep away from it. */
    memcpy(b->channels[0].values, (float[]){0, 0.0078125f, -0.00390625f, 0.0041f}, 16);
    struct image_difference d = compare(a, b);
    double squares = 0.0078125 * 0.0078125 + 0.00390625 * 0.00390625 + (double)0.0041f * 0.0041f;
    assert_true(d.overall.max_error == 0.0078125);
    assert_float_equal(d.overall.mean_error, (0.0078125 + 0.00390625 + 0.0041f) / 4, 1e-15);
    assert_float_equal(d.overall.rmse, sqrt(squares / 4), 1e-15);
    assert_float_equal(d.overall.psnr_db, 10 * log10(4 / squares), 1e-10);
    assert_true(d.overall.over_1_255 == 0.5 && d.overall.over_2_255 == 0);
    assert_int_equal(d.overall.differing, 3);
    assert_false(d.has_color);
    image_difference_finish(&d);
    image_destroy(a);
    image_destroy(b);
}

/* A plain sum would lose each of the small errors to the large one. */
static void sums_of_many_samples_lose_nothing(void **state) {
    enum { SIDE = 1024 };
    struct image *a, *b;
    assert_success(image_create(SIDE, SIDE, &a, &status));
    image_add_channel(a, "Y", IMAGE_FLOAT);
    b = fixture_copy(a);
    for (int i = 1; i < SIDE * SIDE; i++)
        b->channels[0].values[i] = 0x1p-30f;
    b->channels[0].values[0] = 0x1p27f;
    struct image_difference d = compare(a, b);
    const double count = SIDE * SIDE;
    assert_true(d.overall.mean_error == (0x1p27 + (count - 1) * 0x1p-30) / count);
    assert_true(d.overall.rmse == sqrt((0x1p54 + (count - 1) * 0x1p-60) / count));
    image_difference_finish(&d);
    image_destroy(a);
    image_destroy(b);
}

/* Each channel as a grey picture, by the functions themselves. */
static void channels_are_judged_as_grey_pictures(void **state) {
    struct image *a = fixture_picture(60, 50, 3), *b = fixture_copy(a);
    fixture_add_noise(b, 0.1, 4);
    const struct image_compare_options options = {.channel_perception = true};
    struct image_difference d;
    assert_success(image_compare(a, b, &options, &d, &status));
    const float *first[3], *second[3];
    planes_of(a, first);
    planes_of(b, second);
    for (int c = 0; c < 3; c++) {
        const float *const grey_a[3] = {first[c], first[c], first[c]}, *const grey_b[3] = {
                                                                           second[c], second[c],
                                                                           second[c]};
        struct flip_summary flip;
        float map[60 * 50];
        double ssim;
        assert_success(ssim_compare(grey_a, grey_b, 60, 50, &ssim, &status));
        assert_success(
            flip_compare(grey_a, grey_b, 60, 50, FLIP_PIXELS_PER_DEGREE, map, &flip, &status));
        assert_true(d.channels[c].has_perception && d.channels[c].ssim == ssim && ssim < 1);
        assert_true(d.channels[c].flip.mean == flip.mean && d.channels[c].flip.max == flip.max);
    }
    image_difference_finish(&d);
    image_destroy(a);
    image_destroy(b);
}

static void what_is_not_finite_is_counted_and_kept_out(void **state) {
    struct image *a = fixture_bits(6, 1, "Y:f", 1), *b;
    memcpy(a->channels[0].values, (float[]){NAN, INFINITY, 1, 2, 3, NAN}, 24);
    b = fixture_copy(a);
    memcpy(b->channels[0].values + 1, (float[]){INFINITY, -INFINITY, NAN, 3.5f}, 16);
    struct image_difference d = compare(a, b);
    assert_int_equal(d.overall.nan[0], 2);
    assert_int_equal(d.overall.nan[1], 3);
    assert_int_equal(d.overall.infinite[0], 1);
    assert_int_equal(d.overall.infinite[1], 2);
    assert_true(d.overall.max_error == 0.5 && d.overall.mean_error == 0.5);
    image_difference_finish(&d);
    d = compare(a, a);
    assert_true(image_difference_identical(&d));
    assert_int_equal(image_measures_not_finite(&d.overall), 6);
    image_difference_finish(&d);
    image_destroy(a);
    image_destroy(b);
}

static void integers_are_compared_as_numbers_apart(void **state) {
    struct image *a = fixture_bits(5, 5, "ID:u Y:f", 1);
    memset(a->channels[1].values, 0, 100);
    struct image *b = fixture_copy(a);
    a->channels[0].integers[3] = 0xffffffff;
    b->channels[0].integers[3] = 1;
    struct image_difference d = compare(a, b);
    assert_int_equal(d.integer_channels_differing, 1);
    assert_int_equal(d.overall.differing, 1);
    assert_true(d.overall.max_error == 0);
    assert_true(d.channels[0].measures.max_error == 4294967294.0);
    assert_false(image_difference_identical(&d));
    image_difference_finish(&d);
    image_destroy(a);
    image_destroy(b);
}

static void images_of_other_size_or_channels_are_refused(void **state) {
    struct image *a = fixture_bits(4, 4, "R:f G:f", 1), *b = fixture_bits(4, 5, "R:f G:f", 1);
    struct image *c = fixture_bits(4, 4, "R:f", 1), *e = fixture_bits(4, 4, "R:f G:u", 1);
    struct image_difference d;
    struct image_compare_options only = {.only = "R"}, none = {.only = "R,X"};
    assert_failure(image_compare(a, b, NULL, &d, &status), STATUS_INVALID, "4 x 4", "4 x 5");
    assert_failure(image_compare(a, c, NULL, &d, &status), STATUS_INVALID, "'G'", "first");
    assert_failure(image_compare(c, a, NULL, &d, &status), STATUS_INVALID, "'G'", "second");
    assert_failure(image_compare(a, e, NULL, &d, &status), STATUS_INVALID, "'G'", "integers");
    assert_failure(image_compare(a, c, &none, &d, &status), STATUS_INVALID, "'X'", "both");
    assert_success(image_compare(a, c, &only, &d, &status));
    assert_int_equal(d.channel_count, 1);
    image_difference_finish(&d);
    struct image *const all[] = {a, b, c, e};
    for (int i = 0; i < 4; i++)
        image_destroy(all[i]);
}

/* Tiles of 256 x 64 meet in the larger sizes; the last pixels per degree has features wider than
 * contrast. */
static void flip_agrees_with_the_definition(void **state) {
    static const struct {
        int width, height;
        double ppd;
    } cases[] = {
        {40, 30, FLIP_PIXELS_PER_DEGREE}, {270, 70, 20}, {1, 1, 67}, {3, 80, 30}, {33, 9, 9}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        int width = cases[k].width, height = cases[k].height, count = width * height;
        struct image *a = fixture_picture(width, height, k), *b = fixture_copy(a);
        fixture_add_noise(b, 0.2, k);
        fixture_plane(b, "R")[count / 2] = 5;
        fixture_plane(b, "G")[count / 3] = -5;
        const float *pa[3], *pb[3];
        float *map = calloc((size_t)count, sizeof *map);
        double *wanted = calloc((size_t)count, sizeof *wanted), mean = 0;
        struct flip_summary summary;
        planes_of(a, pa);
        planes_of(b, pb);
        assert_success(flip_compare(pa, pb, width, height, cases[k].ppd, map, &summary, &status));
        reference_flip(pa, pb, width, height, cases[k].ppd, wanted);
        for (int i = 0; i < count; i++) {
            /* The decimal matrices of the reference differ from the fractions by 1e-4. */
            assert_float_equal(map[i], wanted[i], 2e-3);
            mean += wanted[i] / count;
        }
        assert_float_equal(summary.mean, mean, 2e-4);
        free(map);
        free(wanted);
        image_destroy(a);
        image_destroy(b);
    }
}

/* Constant images have no features and pass the filters unchanged, so that FLIP is the color term
 * alone. */
static void flip_of_constant_colors_is_in_closed_form(void **state) {
    struct image *a = fixture_picture(50, 50, 1), *b = fixture_picture(50, 50, 1);
    fixture_fill(a, 0, 0, 0);
    fixture_fill(b, 1, 1, 1);
    /* Green (L 87.74, a -86.18, b 83.18) and blue (32.30, 79.19, -107.86), CIE colours of sRGB;
     * black and white are 100 apart. */
    double green[2] = {0.8774 * -86.18, 0.8774 * 83.18},
           blue[2] = {0.3230 * 79.19, 0.3230 * -107.86};
    double largest = pow(87.74 - 32.30 + hypot(green[0] - blue[0], green[1] - blue[1]), 0.7);
    double wanted = 0.95 + 0.05 * (pow(100, 0.7) - 0.4 * largest) / (0.6 * largest);
    struct image_difference d = compare(a, b);
    assert_float_equal(d.flip.mean, wanted, 1e-4);
    assert_float_equal(d.flip.max, wanted, 1e-4);
    assert_float_equal(d.flip.weighted_median, wanted, 1e-4);
    assert_true(d.flip.mean > 0.96);
    image_difference_finish(&d);
    fixture_fill(a, 0, 1, 0);
    fixture_fill(b, 0, 0, 1);
    assert_float_equal(flip_mean(a, b), 1, 1e-6);
    image_destroy(a);
    image_destroy(b);
}

static void flip_is_symmetric_and_grows_with_noise(void **state) {
    struct image *a = fixture_picture(300, 80, 3);
    double last = 0;
    for (double amplitude = 1e-6; amplitude < 0.6; amplitude *= 3) {
        struct image *b = fixture_copy(a);
        fixture_add_noise(b, amplitude, 7);
        double mean = flip_mean(a, b);
        assert_true(mean > last && mean < 1);
        assert_float_equal(mean, flip_mean(b, a), 1e-12);
        last = mean;
        image_destroy(b);
    }
    image_destroy(a);
}

/* The gates of docs: exact against double is FLIP 1e-5, so that the last bit of a float must stay
 * below. */
static void a_last_bit_is_far_below_the_exact_gate(void **state) {
    struct image *a = fixture_picture(100, 60, 3), *b = fixture_copy(a);
    for (int i = 0; i < 6000; i += 3)
        fixture_plane(b, "G")[i] = nextafterf(fixture_plane(b, "G")[i], i % 2 ? 0 : 1);
    double mean = flip_mean(a, b);
    assert_true(mean > 0 && mean < 1e-5);
    image_destroy(a);
    image_destroy(b);
}

/* A control that anybody sees: if a metric passed it, its gate would be worth nothing. */
static void every_metric_rejects_a_visibly_wrong_image(void **state) {
    struct image *a = fixture_picture(160, 120, 5);
    for (int kind = 0; kind < 4; kind++) {
        struct image *b = fixture_copy(a);
        for (int y = 0; y < 120; y++)
            for (int x = 0; x < 160; x++) {
                int at = y * 160 + x;
                if (kind == 0) /* red and blue exchanged */
                    fixture_plane(b, "R")[at] = fixture_plane(a, "B")[at];
                if (kind == 1) /* shifted by four pixels */
                    fixture_plane(b, "G")[at] = fixture_plane(a, "G")[y * 160 + (x + 4) % 160];
                if (kind == 2 && x / 40 == 1 && y / 40 == 1) /* a hole */
                    for (int c = 0; c < 3; c++)
                        fixture_plane(b, (const char *[]){"R", "G", "B"}[c])[at] = 0;
                if (kind == 3) /* 10 % darker */
                    for (int c = 0; c < 3; c++)
                        fixture_plane(b, (const char *[]){"R", "G", "B"}[c])[at] *= 0.9f;
            }
        struct image_difference d = compare(a, b);
        assert_true(d.overall.psnr_db < 50);
        assert_true(d.flip.mean > 0.02);
        assert_true(d.flip.max > 0.05);
        assert_true(d.ssim < 0.9999);
        image_difference_finish(&d);
        image_destroy(b);
    }
    image_destroy(a);
}

static void ssim_agrees_with_the_definition(void **state) {
    struct image *a = fixture_picture(43, 29, 2), *b = fixture_copy(a);
    const float *pa[3], *pb[3];
    planes_of(a, pa);
    planes_of(b, pb);
    double last = 1, mean;
    for (double amplitude = 0.01; amplitude < 0.5; amplitude *= 2) {
        fixture_add_noise(b, amplitude, 4);
        assert_success(ssim_compare(pa, pb, 43, 29, &mean, &status));
        assert_float_equal(mean, reference_ssim(pa, pb, 43, 29), 1e-10);
        assert_true(mean < last);
        last = mean;
    }
    for (int width = 1; width < 13; width++) {
        assert_success(ssim_compare(pa, pa, width, 13 - width, &mean, &status));
        assert_true(mean == 1);
    }
    image_destroy(a);
    image_destroy(b);
}

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void the_weighted_median_is_that_of_a_sort(void **state) {
    struct rng rng = {9};
    float map[1000], sorted[1000];
    for (int round = 0; round < 50; round++) {
        size_t count = 1 + rng_below(&rng, 1000);
        double total = 0, sum = 0;
        for (size_t i = 0; i < count; i++) {
            map[i] = rng_below(&rng, 3) ? (float)pow(rng_unit(&rng), 5) : 0.25f;
            total += map[i];
        }
        memcpy(sorted, map, sizeof sorted);
        qsort(sorted, count, sizeof *sorted, compare_floats);
        size_t at = 0;
        while (at < count - 1 && (sum += sorted[at]) < 0.5 * total)
            at++;
        struct flip_summary summary;
        flip_summarize(map, count, &summary);
        assert_true(fabs(summary.weighted_median - sorted[at]) < 1e-12);
        assert_float_equal(summary.mean, total / (double)count, 1e-12);
        assert_true(summary.max == sorted[count - 1]);
    }
}

static void the_colors_of_the_map_run_from_black_to_pale_yellow(void **state) {
    double rgb[3], last = -1;
    /* Of the published table, in 255ths. */
    static const double table[][4] = {{0, 0, 0, 4}, {0.5, 183, 55, 121}, {1, 252, 253, 191}};
    for (size_t i = 0; i < 3; i++) {
        flip_color((float)table[i][0], rgb);
        for (int c = 0; c < 3; c++)
            assert_float_equal(255 * rgb[c], table[i][c + 1], 6);
    }
    for (int i = 0; i <= 255; i++) {
        flip_color((float)i / 255, rgb);
        double luminance = 0;
        for (int c = 0; c < 3; c++)
            luminance += (const double[]){0.2126, 0.7152, 0.0722}[c] * srgb_to_linear(rgb[c]);
        assert_true(luminance > last - 1e-4);
        last = luminance;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identical_images_have_no_error),
        cmocka_unit_test(errors_of_four_samples_are_as_by_hand),
        cmocka_unit_test(sums_of_many_samples_lose_nothing),
        cmocka_unit_test(channels_are_judged_as_grey_pictures),
        cmocka_unit_test(what_is_not_finite_is_counted_and_kept_out),
        cmocka_unit_test(integers_are_compared_as_numbers_apart),
        cmocka_unit_test(images_of_other_size_or_channels_are_refused),
        cmocka_unit_test(flip_agrees_with_the_definition),
        cmocka_unit_test(flip_of_constant_colors_is_in_closed_form),
        cmocka_unit_test(flip_is_symmetric_and_grows_with_noise),
        cmocka_unit_test(a_last_bit_is_far_below_the_exact_gate),
        cmocka_unit_test(every_metric_rejects_a_visibly_wrong_image),
        cmocka_unit_test(ssim_agrees_with_the_definition),
        cmocka_unit_test(the_weighted_median_is_that_of_a_sort),
        cmocka_unit_test(the_colors_of_the_map_run_from_black_to_pale_yellow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
