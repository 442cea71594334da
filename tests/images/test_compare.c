/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/image_compare.h"

#include <cjson/cJSON.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char output[2][8192]; /* what the command wrote to stdout and stderr */

static int redirect(int to, const char *path) {
    int saved = dup(to), file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    dup2(file, to);
    close(file);
    return saved;
}

static void restore(int to, int saved, char *text) {
    size_t got = (size_t)pread(to, text, sizeof output[0] - 1, 0);
    text[got] = 0;
    dup2(saved, to);
    close(saved);
}

/* Runs `sortlast compare` with arguments separated by spaces and returns its exit status. */
static int run(const char *arguments) {
    char words[4096], *argv[24] = {"compare"};
    int argc = 1;
    snprintf(words, sizeof words, "%s", arguments);
    for (char *word = strtok(words, " "); word; word = strtok(NULL, " "))
        argv[argc++] = word;
    fflush(NULL);
    int out = redirect(1, fixture_path("stdout")), err = redirect(2, fixture_path("stderr"));
    int result = image_compare_main(argc, argv);
    fflush(NULL);
    restore(1, out, output[0]);
    restore(2, err, output[1]);
    return result;
}

static int run_pair(const char *options) {
    char arguments[4096];
    snprintf(arguments, sizeof arguments, "%s %s %s", options, fixture_path("a.exr"),
             fixture_path("b.exr"));
    return run(arguments);
}

static void write_exr(const struct image *image, const char *name) {
    assert_success(
        image_write_exr(image, fixture_path(name), IMAGE_COMPRESSION_RLE, NULL, &status));
}

/* The first line of stdout holds the text. */
static void assert_first_line(const char *text) {
    char line[256];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(output[0], "\n"), output[0]);
    if (!strstr(line, text))
        fail_msg("'%s' is not in '%s'", text, line);
}

static void equal_images_say_max_error_0_and_exit_0(void **state) {
    struct image *image = fixture_picture(40, 30, 1);
    write_exr(image, "a.exr");
    write_exr(image, "b.exr");
    assert_int_equal(run_pair(""), 0);
    assert_first_line("equal: max_error 0");
    assert_null(strchr(output[0], '\033'));
    assert_string_equal(output[1], "");
    assert_int_equal(run_pair("--quiet"), 0);
    assert_string_equal(output[0], "");
    image_destroy(image);
}

static void different_images_exit_1_and_never_say_max_error_0(void **state) {
    struct image *a = fixture_picture(40, 30, 1), *b = fixture_copy(a);
    assert_non_null(image_add_channel(a, "ID", IMAGE_UINT));
    assert_non_null(image_add_channel(b, "ID", IMAGE_UINT));
    write_exr(a, "a.exr");
    for (int kind = 0; kind < 3; kind++) {
        struct image *c = fixture_copy(b);
        if (kind == 0) /* one last bit */
            fixture_plane(c, "G")[77] = nextafterf(fixture_plane(c, "G")[77], 2);
        if (kind == 1)
            c->channels[3].integers[5] = 1;
        if (kind == 2) { /* the sign of a zero */
            fixture_plane(c, "R")[0] = -0.0f;
            fixture_plane(a, "R")[0] = 0;
            write_exr(a, "a.exr");
        }
        write_exr(c, "b.exr");
        assert_int_equal(run_pair(""), 1);
        assert_null(strstr(output[0], "max_error 0"));
        assert_int_equal(run_pair("--max-error 1e-6"), kind == 1);
        image_destroy(c);
    }
    image_destroy(a);
    image_destroy(b);
}

static void thresholds_decide_when_given(void **state) {
    struct image *a = fixture_picture(40, 30, 1), *b = fixture_copy(a);
    fixture_fill(a, 0.5f, 0.5f, 0.5f);
    fixture_fill(b, 0.5f, 0.5f, 0.5f + 0.0625f);
    write_exr(a, "a.exr");
    write_exr(b, "b.exr");
    /* rmse = 0.0625 / sqrt(3): 28.85 dB */
    assert_int_equal(run_pair(""), 1);
    assert_int_equal(run_pair("--max-error 0.0625"), 0);
    assert_first_line("within thresholds: max_error 6.25");
    assert_int_equal(run_pair("--max-error 0.0624"), 1);
    assert_first_line("over threshold: max_error 6.25");
    assert_int_equal(run_pair("--min-psnr 28.8"), 0);
    assert_int_equal(run_pair("--min-psnr 28.9"), 1);
    assert_int_equal(run_pair("--max-error 1 --min-psnr 28.9"), 1);
    assert_int_equal(run_pair("--max-flip 0.5 --max-flip-pixel 0.5"), 0);
    assert_int_equal(run_pair("--max-flip 0.01"), 1);
    assert_int_equal(run_pair("--max-flip-pixel 0.01"), 1);
    /* mean = 0.0625 / 3; a third of the samples differ, by some 16/255 */
    assert_int_equal(run_pair("--max-mean 0.0209"), 0);
    assert_int_equal(run_pair("--max-mean 0.0208"), 1);
    assert_int_equal(run_pair("--max-rmse 0.0361"), 0);
    assert_int_equal(run_pair("--max-rmse 0.036"), 1);
    assert_first_line("over threshold: rmse 3.608439e-02 is over 0.036");
    assert_int_equal(run_pair("--max-over-1 0.34 --max-over-2 0.34"), 0);
    assert_int_equal(run_pair("--max-over-1 0.33"), 1);
    assert_int_equal(run_pair("--max-over-2 0.33"), 1);
    assert_int_equal(run_pair("--only R,G"), 0);
    assert_int_equal(run_pair("--only B"), 1);
    image_destroy(a);
    image_destroy(b);
}

static void what_is_not_finite_fails_even_when_shared(void **state) {
    struct image *image = fixture_picture(40, 30, 1);
    fixture_plane(image, "G")[3] = NAN;
    fixture_plane(image, "B")[4] = INFINITY;
    write_exr(image, "a.exr");
    write_exr(image, "b.exr");
    assert_int_equal(run_pair(""), 1);
    assert_first_line("not finite: 2 NaN and 2 infinite");
    assert_int_equal(run_pair("--max-error 1 --max-flip 1"), 1);
    assert_int_equal(run_pair("--only R"), 0);
    image_destroy(image);
}

static double number(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!cJSON_IsNumber(item))
        fail_msg("no number '%s'", key);
    return item->valuedouble;
}

/* cJSON writes the shortest of 15 or 17 digits that comes back to within an epsilon. */
static bool number_is(const cJSON *object, const char *key, double wanted) {
    return fabs(number(object, key) - wanted) <= 1e-14 * fabs(wanted);
}

static void check_json(const cJSON *json, const struct image_difference *d) {
    assert_true(number_is(json, "max_error", d->overall.max_error));
    assert_true(number_is(json, "mean_error", d->overall.mean_error));
    assert_true(number_is(json, "rmse", d->overall.rmse));
    assert_true(number_is(json, "psnr_db", d->overall.psnr_db));
    assert_true(number_is(json, "ssim", d->ssim));
    assert_true(number_is(json, "over_1_255", d->overall.over_1_255));
    assert_true(number_is(json, "over_2_255", d->overall.over_2_255));
    assert_true(number(json, "nan") == 1 && number(json, "inf") == 0);
    const cJSON *flip = cJSON_GetObjectItem(json, "flip"),
                *channels = cJSON_GetObjectItem(json, "channels");
    assert_true(number_is(flip, "mean", d->flip.mean) && number_is(flip, "max", d->flip.max));
    assert_true(number_is(flip, "weighted_median", d->flip.weighted_median));
    const cJSON *green = cJSON_GetObjectItem(channels, "G"),
                *red = cJSON_GetObjectItem(channels, "R");
    assert_true(cJSON_IsFalse(cJSON_GetObjectItem(green, "identical")));
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(red, "identical")));
    assert_true(cJSON_IsNull(cJSON_GetObjectItem(red, "psnr_db")));
    assert_true(number(green, "nan_second") == 1 && number(green, "nan_first") == 0);
    assert_true(number(green, "max_error") == 0.25);
    /* of a channel as a grey picture: red is the same in both */
    const cJSON *flip_of_red = cJSON_GetObjectItem(red, "flip"),
                *flip_of_green = cJSON_GetObjectItem(green, "flip");
    assert_true(number(red, "ssim") == 1 && number(flip_of_red, "max") == 0);
    const struct image_channel_difference *channel = &d->channels[1];
    assert_string_equal(channel->name, "G");
    assert_true(channel->has_perception && channel->ssim < 1 && channel->flip.max > 0);
    assert_true(number_is(green, "ssim", channel->ssim));
    assert_true(number_is(flip_of_green, "mean", channel->flip.mean));
    assert_true(number_is(flip_of_green, "max", channel->flip.max));
    assert_true(number_is(flip_of_green, "weighted_median", channel->flip.weighted_median));
    assert_true(cJSON_IsFalse(cJSON_GetObjectItem(json, "passed")));
}

static void json_holds_the_measures(void **state) {
    struct image *a = fixture_picture(40, 30, 1), *b;
    struct image_difference d;
    fixture_plane(a, "G")[3] = 0.5f;
    b = fixture_copy(a);
    fixture_plane(b, "G")[3] = 0.75f;
    fixture_plane(b, "G")[8] = NAN;
    write_exr(a, "a.exr");
    write_exr(b, "b.exr");
    assert_success(image_compare(a, b, &(struct image_compare_options){.channel_perception = true},
                                 &d, &status));
    assert_int_equal(run_pair("--json -"), 1);
    cJSON *json = cJSON_Parse(output[0]);
    assert_non_null(json);
    check_json(json, &d);
    cJSON_Delete(json);
    char options[600];
    snprintf(options, sizeof options, "--json %s", fixture_path("out.json"));
    assert_int_equal(run_pair(options), 1);
    assert_first_line("not finite");
    size_t size;
    unsigned char *text = fixture_load(fixture_path("out.json"), &size);
    json = cJSON_ParseWithLength((const char *)text, size);
    assert_non_null(json);
    check_json(json, &d);
    cJSON_Delete(json);
    free(text);
    image_difference_finish(&d);
    image_destroy(a);
    image_destroy(b);
}

static void maps_are_images(void **state) {
    struct image *a = fixture_picture(40, 30, 1), *b = fixture_copy(a), *map;
    struct image_difference d;
    fixture_plane(b, "R")[41] += 0.25f;
    write_exr(a, "a.exr");
    write_exr(b, "b.exr");
    char options[2000];
    snprintf(options, sizeof options, "--difference %s --flip-map %s", fixture_path("d.exr"),
             fixture_path("f.png"));
    assert_int_equal(run_pair(options), 1);
    assert_success(image_read(fixture_path("d.exr"), &map, &status));
    assert_float_equal(fixture_plane(map, "R")[41], 0.25, 1e-6);
    assert_true(fixture_plane(map, "R")[40] == 0 && fixture_plane(map, "G")[41] == 0);
    image_destroy(map);
    assert_success(image_read(fixture_path("f.png"), &map, &status));
    assert_int_equal(map->channel_count, 3);
    assert_true(fixture_plane(map, "R")[41] > fixture_plane(map, "R")[1199]);
    image_destroy(map);
    snprintf(options, sizeof options, "--difference %s --flip-map %s", fixture_path("d.png"),
             fixture_path("f.exr"));
    assert_int_equal(run_pair(options), 1);
    assert_success(image_compare(a, b, &(struct image_compare_options){.channel_perception = true},
                                 &d, &status));
    assert_success(image_read(fixture_path("f.exr"), &map, &status));
    assert_memory_equal(fixture_plane(map, "FLIP"), d.flip_map, 40 * 30 * 4);
    image_difference_finish(&d);
    image_destroy(map);
    image_destroy(a);
    image_destroy(b);
}

static void trouble_exits_2_with_a_sentence(void **state) {
    struct image *a = fixture_picture(40, 30, 1), *b = fixture_bits(41, 30, "R:f G:f B:f", 1);
    write_exr(a, "a.exr");
    write_exr(b, "b.exr");
    static const struct {
        const char *options, *words;
    } cases[] = {{"", "differ in size"},
                 {"--max-error", "two images are needed"},
                 {"--max-error -1", "--max-error needs a number"},
                 {"--max-error nan", "--max-error needs a number"},
                 {"--max-flip 1.5", "--max-flip needs a number"},
                 {"--min-psnr x", "--min-psnr needs a number"},
                 {"--nonsense", "--nonsense"},
                 {"--max", "'--max'"},
                 {"-x", "'-x'"},
                 {"--difference out.jpg", "named .exr or .png"},
                 {"third.exr", "3 given"},
                 {"--only Q", "'Q'"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(run_pair(cases[i].options), 2);
        assert_string_equal(output[0], "");
        if (i > 1 && i < sizeof cases / sizeof cases[0] - 1 && !strstr(output[1], cases[i].words))
            fail_msg("'%s': %s", cases[i].options, output[1]);
    }
    assert_int_equal(run("a.exr b.exr --max-error"), 2);
    assert_non_null(strstr(output[1], "'--max-error' needs a value"));
    assert_int_equal(run("/none.exr /none.exr"), 2);
    assert_non_null(strstr(output[1], "/none.exr': No such file"));
    assert_int_equal(run(""), 2);
    image_destroy(a);
    image_destroy(b);
}

static void flip_without_colours_is_trouble_only_when_asked_for(void **state) {
    struct image *image = fixture_bits(4, 4, "Z:f", 1);
    memset(image->channels[0].values, 0, 64);
    write_exr(image, "a.exr");
    write_exr(image, "b.exr");
    assert_int_equal(run_pair(""), 0);
    assert_int_equal(run_pair("--max-flip 0.5"), 2);
    assert_non_null(strstr(output[1], "R, G and B"));
    assert_int_equal(run_pair("--json -"), 0);
    cJSON *json = cJSON_Parse(output[0]);
    assert_true(cJSON_IsNull(cJSON_GetObjectItem(json, "flip")));
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(json, "identical")));
    cJSON_Delete(json);
    image_destroy(image);
}

static void help_names_every_option(void **state) {
    assert_int_equal(run("--help"), 0);
    static const char *const options[] = {
        "--json",     "--max-error",  "--min-psnr",       "--max-flip ",  "--flip-map",
        "--only",     "--difference", "--max-flip-pixel", "--quiet",      "--pixels-per-degree",
        "--max-mean", "--max-rmse",   "--max-over-1",     "--max-over-2", "exit status"};
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++)
        if (!strstr(output[0], options[i]))
            fail_msg("%s", options[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_images_say_max_error_0_and_exit_0),
        cmocka_unit_test(different_images_exit_1_and_never_say_max_error_0),
        cmocka_unit_test(thresholds_decide_when_given),
        cmocka_unit_test(what_is_not_finite_fails_even_when_shared),
        cmocka_unit_test(json_holds_the_measures),
        cmocka_unit_test(maps_are_images),
        cmocka_unit_test(trouble_exits_2_with_a_sentence),
        cmocka_unit_test(flip_without_colours_is_trouble_only_when_asked_for),
        cmocka_unit_test(help_names_every_option),
    };
    return cmocka_run_group_tests(tests, fixture_init, fixture_finish);
}
