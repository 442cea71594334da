/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/exr_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const enum image_compression compressions[] = {IMAGE_COMPRESSION_NONE, IMAGE_COMPRESSION_RLE,
                                                      IMAGE_COMPRESSION_ZIPS, IMAGE_COMPRESSION_ZIP,
                                                      IMAGE_COMPRESSION_PIZ};

static void check_round_trip(int width, int height, const char *channels,
                             enum image_compression compression) {
    struct image *image = fixture_bits(width, height, channels, (uint64_t)width * 31 + compression);
    struct image *back;
    uint64_t clamped = 99;
    assert_success(
        image_write_exr(image, fixture_path("round.exr"), compression, &clamped, &status));
    assert_int_equal(clamped, 0);
    assert_success(image_read(fixture_path("round.exr"), &back, &status));
    assert_images_equal(image, back);
    image_destroy(back);
    image_destroy(image);
}

static void every_bit_pattern_of_every_type_survives_every_compression(void **state) {
    static const char *const channels[] = {"R:f G:f B:f A:f Z:f ID:u", "R:h G:h B:h A:h Z:f",
                                           "b:u a:h B:f A:u ab:h", "Y:h", "z:u"};
    static const int sizes[][2] = {{1, 1},    {1, 77},   {127, 63}, {129, 65},
                                   {300, 16}, {300, 17}, {3000, 2}, {160, 90}};
    for (size_t c = 0; c < sizeof channels / sizeof channels[0]; c++)
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
            for (size_t k = 0; k < sizeof compressions / sizeof compressions[0]; k++)
                check_round_trip(sizes[s][0], sizes[s][1], channels[c], compressions[k]);
}

static void a_very_wide_and_a_very_high_image_survive(void **state) {
    check_round_trip(65536, 1, "R:f", IMAGE_COMPRESSION_ZIP);
    check_round_trip(1, 65536, "R:h", IMAGE_COMPRESSION_ZIP);
}

static void the_same_image_gives_the_same_file(void **state) {
    struct image *image = fixture_bits(700, 500, "R:h G:h B:h Z:f", 5);
    size_t size1, size2;
    assert_success(
        image_write_exr(image, fixture_path("1.exr"), IMAGE_COMPRESSION_ZIP, NULL, &status));
    unsigned char *first = fixture_load(fixture_path("1.exr"), &size1);
    for (int i = 0; i < 10; i++) {
        assert_success(
            image_write_exr(image, fixture_path("2.exr"), IMAGE_COMPRESSION_ZIP, NULL, &status));
        unsigned char *second = fixture_load(fixture_path("2.exr"), &size2);
        assert_int_equal(size1, size2);
        assert_memory_equal(first, second, size1);
        free(second);
    }
    free(first);
    image_destroy(image);
}

static void halfs_out_of_range_are_clamped_and_counted(void **state) {
    struct image *image, *back;
    assert_success(image_create(4, 1, &image, &status));
    struct image_channel *channel = image_add_channel(image, "R", IMAGE_HALF);
    memcpy(channel->values, (float[]){70000, -1e20f, INFINITY, 65504}, 16);
    uint64_t clamped;
    assert_success(
        image_write_exr(image, fixture_path("c.exr"), IMAGE_COMPRESSION_RLE, &clamped, &status));
    assert_int_equal(clamped, 2);
    assert_success(image_read_exr(fixture_path("c.exr"), &back, &status));
    const float wanted[4] = {65504, -65504, INFINITY, 65504};
    assert_memory_equal(back->channels[0].values, wanted, sizeof wanted);
    image_destroy(back);
    image_destroy(image);
}

static void channels_are_in_the_file_by_name(void **state) {
    struct image *image = fixture_bits(3, 3, "Z:f R:h a:u B:h", 1), *back;
    assert_success(
        image_write_exr(image, fixture_path("n.exr"), IMAGE_COMPRESSION_NONE, NULL, &status));
    assert_success(image_read_exr(fixture_path("n.exr"), &back, &status));
    static const char *const wanted[] = {"B", "R", "Z", "a"};
    for (int c = 0; c < 4; c++)
        assert_string_equal(back->channels[c].name, wanted[c]);
    image_destroy(back);
    image_destroy(image);
}

/* A file written through the library's own calls, for what image_write_exr never writes. */
struct foreign {
    exr_storage_t storage;
    exr_compression_t compression;
    exr_attr_box2i_t window;
    int tile_width, tile_height;
};

static exr_attr_box2i_t box(int left, int top, int right, int bottom) {
    exr_attr_box2i_t window;
    window.min.x = left;
    window.min.y = top;
    window.max.x = right;
    window.max.y = bottom;
    return window;
}

static void check_exr(exr_result_t result) {
    if (result != EXR_ERR_SUCCESS)
        fail_msg("%s", exr_error_text(result));
}

static void foreign_chunk(exr_context_t context, const exr_chunk_info_t *info,
                          const struct image *image, int x, int y) {
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    check_exr(exr_encoding_initialize(context, 0, info, &pipeline));
    for (int c = 0; c < pipeline.channel_count; c++) {
        exr_coding_channel_info_t *coding = &pipeline.channels[c];
        coding->encode_from_ptr =
            (const uint8_t *)(image->channels[c].values + (size_t)y * (size_t)image->width + x);
        coding->user_bytes_per_element = coding->user_pixel_stride = 4;
        coding->user_data_type = coding->data_type;
        coding->user_line_stride = 4 * image->width;
    }
    check_exr(exr_encoding_choose_default_routines(context, 0, &pipeline));
    check_exr(exr_encoding_run(context, 0, &pipeline));
    check_exr(exr_encoding_destroy(context, &pipeline));
}

static void foreign_chunks(exr_context_t context, const struct foreign *foreign,
                           const struct image *image) {
    exr_chunk_info_t info;
    if (foreign->storage == EXR_STORAGE_SCANLINE) {
        int lines;
        check_exr(exr_get_scanlines_per_chunk(context, 0, &lines));
        for (int y = 0; y < image->height; y += lines) {
            check_exr(exr_write_scanline_chunk_info(context, 0, foreign->window.min.y + y, &info));
            foreign_chunk(context, &info, image, 0, y);
        }
        return;
    }
    for (int y = 0; y < image->height; y += foreign->tile_height)
        for (int x = 0; x < image->width; x += foreign->tile_width) {
            check_exr(exr_write_tile_chunk_info(context, 0, x / foreign->tile_width,
                                                y / foreign->tile_height, 0, 0, &info));
            foreign_chunk(context, &info, image, x, y);
        }
}

/* Channels of `image` in order of their names, FLOAT and UINT. */
static void foreign_write(const struct foreign *foreign, const struct image *image,
                          const char *path) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = exr_error_keep;
    exr_attr_v2f_t centre;
    memset(&centre, 0, sizeof centre);
    exr_context_t context;
    int part;
    check_exr(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &options));
    check_exr(exr_add_part(context, "part", foreign->storage, &part));
    check_exr(exr_initialize_required_attr(context, part, &foreign->window, &foreign->window, 1,
                                           &centre, 1, EXR_LINEORDER_INCREASING_Y,
                                           foreign->compression));
    if (foreign->storage == EXR_STORAGE_TILED)
        check_exr(exr_set_tile_descriptor(context, part, (uint32_t)foreign->tile_width,
                                          (uint32_t)foreign->tile_height, EXR_TILE_ONE_LEVEL,
                                          EXR_TILE_ROUND_DOWN));
    for (int c = 0; c < image->channel_count; c++)
        check_exr(exr_add_channel(context, part, image->channels[c].name,
                                  image->channels[c].type == IMAGE_UINT ? EXR_PIXEL_UINT
                                                                        : EXR_PIXEL_FLOAT,
                                  EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    check_exr(exr_write_header(context));
    foreign_chunks(context, foreign, image);
    check_exr(exr_finish(&context));
}

static void windows_off_the_origin_are_read(void **state) {
    struct image *image = fixture_bits(61, 47, "B:f ID:u R:f", 3), *back;
    for (exr_compression_t k = EXR_COMPRESSION_NONE; k <= EXR_COMPRESSION_PIZ; k++) {
        struct foreign foreign = {EXR_STORAGE_SCANLINE, k, box(-20, 13, 40, 59), 0, 0};
        foreign_write(&foreign, image, fixture_path("window.exr"));
        assert_success(image_read_exr(fixture_path("window.exr"), &back, &status));
        assert_images_equal(image, back);
        image_destroy(back);
    }
    image_destroy(image);
}

static void tiled_files_are_read(void **state) {
    struct image *image = fixture_bits(100, 75, "B:f ID:u R:f", 4), *back;
    static const int tiles[][2] = {{32, 32}, {64, 16}, {100, 75}, {256, 256}, {7, 5}};
    for (exr_compression_t k = EXR_COMPRESSION_NONE; k <= EXR_COMPRESSION_PIZ; k++)
        for (size_t t = 0; t < sizeof tiles / sizeof tiles[0]; t++) {
            struct foreign foreign = {EXR_STORAGE_TILED, k, box(5, -3, 104, 71), tiles[t][0],
                                      tiles[t][1]};
            foreign_write(&foreign, image, fixture_path("tiled.exr"));
            assert_success(image_read_exr(fixture_path("tiled.exr"), &back, &status));
            assert_images_equal(image, back);
            image_destroy(back);
        }
    image_destroy(image);
}

/* Overwrites bytes of a written file's header, `offset` after the end of the text `mark`. */
static void patch_header(const char *path, const char *mark, size_t mark_size, size_t offset,
                         const int32_t *words, size_t count) {
    size_t size;
    unsigned char *bytes = fixture_load(path, &size);
    unsigned char *at = memmem(bytes, size, mark, mark_size);
    assert_non_null(at);
    memcpy(at + mark_size + offset, words, count * sizeof *words);
    fixture_store(path, bytes, size);
    free(bytes);
}

static void subsampled_channels_are_refused_by_name(void **state) {
    struct image *image = fixture_bits(8, 8, "RY:f", 6), *back;
    assert_success(
        image_write_exr(image, fixture_path("sub.exr"), IMAGE_COMPRESSION_NONE, NULL, &status));
    patch_header(fixture_path("sub.exr"), "RY", 3, 8, (const int32_t[]){2, 2}, 2);
    assert_failure(image_read_exr(fixture_path("sub.exr"), &back, &status), STATUS_INVALID,
                   "sub.exr", "'RY' is subsampled 2 x 2");
    assert_null(back);
    image_destroy(image);
}

static void a_small_file_that_claims_many_pixels_is_refused(void **state) {
    static const int32_t windows[][4] = {{0, 0, 16383, 16383},
                                         {0, 0, 1 << 27, 0},
                                         {0, 0, 0, 1 << 27},
                                         {0, 0, 99999, 99999},
                                         {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX},
                                         {5, 5, 4, 4}};
    struct image *image = fixture_bits(8, 8, "R:f", 6), *back;
    for (size_t k = 0; k < sizeof compressions / sizeof compressions[0]; k++)
        for (size_t i = 0; i < sizeof windows / sizeof windows[0]; i++) {
            assert_success(
                image_write_exr(image, fixture_path("bomb.exr"), compressions[k], NULL, &status));
            patch_header(fixture_path("bomb.exr"), "dataWindow\0box2i", 17, 4, windows[i], 4);
            struct status status = {0};
            assert_false(image_read_exr(fixture_path("bomb.exr"), &back, &status));
            assert_non_null(strstr(status.message, "bomb.exr"));
        }
    image_destroy(image);
}

/* A fault of the library known to its authors: it takes a compressed chunk for raw pixels when their lengths agree.
 */
static void chunks_that_compress_to_their_own_length_survive(void **state) {
    for (uint64_t seed = 0; seed < 60; seed++)
        for (size_t k = 0; k < sizeof compressions / sizeof compressions[0]; k++) {
            struct image *image = fixture_bits(1, 64, "R:h", seed), *back;
            assert_success(
                image_write_exr(image, fixture_path("eq.exr"), compressions[k], NULL, &status));
            assert_success(image_read_exr(fixture_path("eq.exr"), &back, &status));
            assert_images_equal(image, back);
            image_destroy(back);
            image_destroy(image);
        }
}

static void sizes_and_names_have_limits(void **state) {
    struct image *image;
    assert_failure(image_create(0, 5, &image, &status), STATUS_INVALID, "0 x 5", "no pixels");
    assert_failure(image_create(16385, 16384, &image, &status), STATUS_LIMIT, "16385", "limit");
    assert_failure(image_create(INT32_MAX, INT32_MAX, &image, &status), STATUS_LIMIT, "2147483647",
                   "limit");
    assert_success(image_create(4, 4, &image, &status));
    assert_null(image_add_channel(image, "", IMAGE_FLOAT));
    assert_null(image_add_channel(image, "a name of thirty-two characters.", IMAGE_FLOAT));
    assert_non_null(image_add_channel(image, "a name of thirty-one characters", IMAGE_FLOAT));
    assert_null(image_add_channel(image, "a name of thirty-one characters", IMAGE_UINT));
    assert_int_equal(image->channel_count, 1);
    image_destroy(image);
    image_destroy(NULL);
}

static void what_cannot_be_read_is_named_with_its_cause(void **state) {
    struct image *back;
    assert_failure(image_read(fixture_path("none.exr"), &back, &status), STATUS_NOT_FOUND,
                   "none.exr", "No such file");
    assert_failure(image_read("/tmp", &back, &status), STATUS_INVALID, "/tmp", "a directory");
    assert_failure(image_read("/dev/null", &back, &status), STATUS_INVALID, "/dev/null",
                   "not a regular file");
    fixture_store(fixture_path("text"), "some text", 9);
    assert_failure(image_read(fixture_path("text"), &back, &status), STATUS_INVALID, "text",
                   "neither");
    assert_failure(image_read_exr(fixture_path("text"), &back, &status), STATUS_INVALID, "text",
                   "header");
    fixture_store(fixture_path("empty"), "", 0);
    assert_failure(image_read(fixture_path("empty"), &back, &status), STATUS_INVALID, "empty",
                   "the file is empty");
    assert_null(back);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bit_pattern_of_every_type_survives_every_compression),
        cmocka_unit_test(a_very_wide_and_a_very_high_image_survive),
        cmocka_unit_test(the_same_image_gives_the_same_file),
        cmocka_unit_test(halfs_out_of_range_are_clamped_and_counted),
        cmocka_unit_test(channels_are_in_the_file_by_name),
        cmocka_unit_test(windows_off_the_origin_are_read),
        cmocka_unit_test(tiled_files_are_read),
        cmocka_unit_test(subsampled_channels_are_refused_by_name),
        cmocka_unit_test(a_small_file_that_claims_many_pixels_is_refused),
        cmocka_unit_test(chunks_that_compress_to_their_own_length_survive),
        cmocka_unit_test(sizes_and_names_have_limits),
        cmocka_unit_test(what_cannot_be_read_is_named_with_its_cause),
    };
    return cmocka_run_group_tests(tests, fixture_init, fixture_finish);
}
