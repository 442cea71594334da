/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/srgb.h"

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

/* Decodes with libpng's simplified interface, which shares no code of ours. */
static png_bytep load_codes(const char *path, int format, int *width, int *height) {
    png_image png = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&png, path))
        fail_msg("%s", png.message);
    png.format = (png_uint_32)format;
    png_bytep codes = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, codes, 0, NULL));
    *width = (int)png.width;
    *height = (int)png.height;
    return codes;
}

static struct image *colors(int width, const char *channels) {
    struct image *image = fixture_bits(width, 1, channels, 1);
    for (int c = 0; c < image->channel_count; c++)
        memset(image->channels[c].values, 0, (size_t)width * 4);
    return image;
}

static void known_linear_values_get_their_srgb_codes(void **state) {
    /* Codes of IEC 61966-2-1: 18 % grey is 118 (0.4613), one half is 188 (0.7354), 0.0031308 is 10.
     */
    static const float linear[] = {0,         1,       0.5f,     0.18f,      0.0031308f, 0.2126f,
                                   0.7152f,   0.0722f, 2.5f,     -0.5f,      NAN,        INFINITY,
                                   -INFINITY, 1e-9f,   0.99999f, 0.21404114f};
    static const png_byte wanted[] = {0,   255, 188, 118, 10, 127, 220, 76,
                                      255, 0,   0,   255, 0,  0,   255, 128};
    enum { COUNT = sizeof linear / sizeof linear[0] };
    struct image *image = colors(COUNT, "B:f G:f R:f");
    memcpy(fixture_plane(image, "G"), linear, sizeof linear);
    assert_success(image_write_png(image, fixture_path("known.png"), &status));
    int width, height;
    png_bytep codes = load_codes(fixture_path("known.png"), PNG_FORMAT_RGB, &width, &height);
    assert_int_equal(width, COUNT);
    assert_int_equal(height, 1);
    for (int i = 0; i < COUNT; i++) {
        assert_int_equal(codes[3 * i], 0);
        assert_int_equal(codes[3 * i + 1], wanted[i]);
    }
    free(codes);
    image_destroy(image);
}

static void codes_are_the_nearest_by_the_formula(void **state) {
    struct srgb_codes codes;
    srgb_codes_init(&codes);
    for (int i = -1000; i <= 1001000; i++) {
        float linear = (float)(i * 1e-6);
        double clamped = linear < 0 ? 0 : linear > 1 ? 1 : linear;
        double exact = 255 * srgb_from_linear(clamped);
        assert_true(fabs(srgb_code(&codes, linear) - exact) <= 0.5 + 1e-9);
    }
}

static void every_code_survives_reading_and_writing(void **state) {
    struct image *image = colors(256, "R:f G:f B:f"), *back;
    for (int i = 0; i < 256; i++) {
        fixture_plane(image, "R")[i] = (float)srgb_to_linear(i / 255.0);
        fixture_plane(image, "G")[i] = (float)srgb_to_linear((255 - i) / 255.0);
    }
    assert_success(image_write_png(image, fixture_path("codes.png"), &status));
    assert_success(image_read(fixture_path("codes.png"), &back, &status));
    assert_images_equal(image, back);
    int width, height;
    png_bytep codes = load_codes(fixture_path("codes.png"), PNG_FORMAT_RGB, &width, &height);
    for (int i = 0; i < 256; i++)
        assert_int_equal(codes[3 * i], i);
    free(codes);
    image_destroy(back);
    image_destroy(image);
}

static void colours_are_divided_by_alpha_and_multiplied_again(void **state) {
    struct image *image = colors(4, "R:f G:f B:f A:f"), *back;
    memcpy(fixture_plane(image, "A"), (float[]){0.6f, 0, 1, 0.2f}, 16);
    memcpy(fixture_plane(image, "R"), (float[]){0.3f, 0.7f, 0.5f, 0.2f}, 16);
    assert_success(image_write_png(image, fixture_path("alpha.png"), &status));
    int width, height;
    png_bytep codes = load_codes(fixture_path("alpha.png"), PNG_FORMAT_RGBA, &width, &height);
    static const png_byte red[] = {188, 0, 188, 255}, alpha[] = {153, 0, 255, 51};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(codes[4 * i], red[i]);
        assert_int_equal(codes[4 * i + 3], alpha[i]);
    }
    free(codes);
    assert_success(image_read_png(fixture_path("alpha.png"), &back, &status));
    assert_int_equal(back->channel_count, 4);
    assert_float_equal(fixture_plane(back, "R")[0], 0.3, 0.003);
    assert_float_equal(fixture_plane(back, "A")[0], 0.6, 1e-6);
    assert_float_equal(fixture_plane(back, "R")[1], 0, 0);
    image_destroy(back);
    image_destroy(image);
}

/* Writes rows of `bits` a sample with plain libpng. */
static void write_foreign(const char *path, int width, int height, int bits, int type,
                          int interlace, png_bytep rows, size_t stride) {
    FILE *file = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    assert_int_equal(setjmp(png_jmpbuf(png)), 0);
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, bits, type, interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (type == PNG_COLOR_TYPE_PALETTE) {
        static const png_color palette[2] = {{10, 20, 30}, {255, 0, 128}};
        png_set_PLTE(png, info, palette, 2);
    }
    png_write_info(png, info);
    int passes = png_set_interlace_handling(png);
    for (int pass = 0; pass < passes; pass++)
        for (int y = 0; y < height; y++)
            png_write_row(png, rows + (size_t)y * stride);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

static void other_kinds_of_png_are_read(void **state) {
    struct image *back;
    png_byte grey[13 * 11], deep[5 * 2 * 6];
    for (size_t i = 0; i < sizeof grey; i++)
        grey[i] = (png_byte)(i * 37);
    for (int interlace = 0; interlace < 2; interlace++) {
        write_foreign(fixture_path("grey.png"), 13, 11, 8, PNG_COLOR_TYPE_GRAY, interlace, grey,
                      13);
        assert_success(image_read_png(fixture_path("grey.png"), &back, &status));
        for (size_t i = 0; i < sizeof grey; i++)
            for (int c = 0; c < 3; c++)
                assert_true(back->channels[c].values[i] == (float)srgb_to_linear(grey[i] / 255.0));
        image_destroy(back);
    }
    for (size_t i = 0; i < sizeof deep; i++)
        deep[i] = (png_byte)(i * 91 + 3);
    write_foreign(fixture_path("deep.png"), 5, 2, 16, PNG_COLOR_TYPE_RGB, 0, deep, 30);
    assert_success(image_read_png(fixture_path("deep.png"), &back, &status));
    for (int i = 0; i < 30; i++)
        assert_true(back->channels[i % 3].values[i / 3] ==
                    (float)srgb_to_linear((deep[2 * i] * 256 + deep[2 * i + 1]) / 65535.0));
    image_destroy(back);
    write_foreign(fixture_path("palette.png"), 2, 1, 1, PNG_COLOR_TYPE_PALETTE, 0,
                  (png_byte[]){0x40}, 1);
    assert_success(image_read_png(fixture_path("palette.png"), &back, &status));
    assert_true(back->channels[0].values[0] == (float)srgb_to_linear(10 / 255.0));
    assert_true(back->channels[2].values[1] == (float)srgb_to_linear(128 / 255.0));
    image_destroy(back);
}

static void images_that_no_png_can_hold_are_refused(void **state) {
    struct image *grey = colors(4, "Y:f"), *integers = colors(4, "R:u G:u B:u");
    int before = fixture_count_files();
    assert_failure(image_write_png(grey, fixture_path("no.png"), &status), STATUS_INVALID, "no.png",
                   "has no R");
    assert_failure(image_write_png(integers, fixture_path("no.png"), &status), STATUS_INVALID,
                   "no.png", "integers");
    assert_int_equal(fixture_count_files(), before);
    image_destroy(grey);
    image_destroy(integers);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_linear_values_get_their_srgb_codes),
        cmocka_unit_test(codes_are_the_nearest_by_the_formula),
        cmocka_unit_test(every_code_survives_reading_and_writing),
        cmocka_unit_test(colours_are_divided_by_alpha_and_multiplied_again),
        cmocka_unit_test(other_kinds_of_png_are_read),
        cmocka_unit_test(images_that_no_png_can_hold_are_refused),
    };
    return cmocka_run_group_tests(tests, fixture_init, fixture_finish);
}
