/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Damaged files are read or refused with their name in the message: never a crash, a hang or a word
 * on stderr. SORTLAST_TEST_SEED replays one, SORTLAST_TEST_ROUNDS asks for more. */
static uint64_t rounds = 300, first_seed = 1;

static void damage(unsigned char *bytes, size_t *size, struct rng *rng) {
    static const unsigned char nasty[] = {0, 1, 0x7f, 0x80, 0xff};
    switch (rng_below(rng, 8)) {
    case 0:
        *size = rng_below(rng, *size + 1);
        return;
    case 1: { /* part of the file moves over another part */
        size_t count = rng_below(rng, *size), from = rng_below(rng, *size - count + 1);
        memmove(bytes + rng_below(rng, *size - count + 1), bytes + from, count);
        return;
    }
    case 2: { /* a word of the header */
        size_t header = *size < 400 ? *size : 400;
        bytes[rng_below(rng, header)] = nasty[rng_below(rng, sizeof nasty)];
        return;
    }
    default:
        for (uint64_t i = rng_below(rng, 8) + 1; i; i--)
            bytes[rng_below(rng, *size)] = rng_below(rng, 2) ? nasty[rng_below(rng, sizeof nasty)]
                                                             : (unsigned char)rng_next(rng);
    }
}

/* Returns how many damaged files were refused. */
static uint64_t read_damaged(const char *whole, uint64_t seed) {
    size_t whole_size;
    unsigned char *bytes = fixture_load(whole, &whole_size), *copy = malloc(whole_size);
    uint64_t refused = 0;
    for (uint64_t i = 0; i < rounds; i++) {
        struct rng rng = {seed * 1000003 + i};
        struct status status = {0};
        struct image *image = NULL;
        size_t size = whole_size;
        memcpy(copy, bytes, whole_size);
        damage(copy, &size, &rng);
        fixture_store(fixture_path("damaged"), copy, size);
        if (image_read(fixture_path("damaged"), &image, &status)) {
            assert_non_null(image);
            image_destroy(image);
            continue;
        }
        refused++;
        assert_null(image);
        assert_int_not_equal(status.code, STATUS_OK);
        assert_non_null(strstr(status.message, "damaged"));
    }
    free(bytes);
    free(copy);
    return refused;
}

/* Sends stderr to a file while a test runs; returns the descriptor to restore. */
static int silence(const char *path) {
    fflush(stderr);
    int saved = dup(STDERR_FILENO), to = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(to, STDERR_FILENO);
    close(to);
    return saved;
}

static void check_silent(const char *path, int saved) {
    size_t size;
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(saved);
    unsigned char *words = fixture_load(path, &size);
    words[size] = 0;
    if (size)
        fail_msg("stderr: %.200s", words);
    free(words);
}

static void damaged_exr_files_are_read_or_refused(void **state) {
    struct image *image = fixture_bits(67, 41, "A:h B:h G:f ID:u R:f", 8);
    for (int k = IMAGE_COMPRESSION_NONE; k <= IMAGE_COMPRESSION_PIZ; k++) {
        assert_success(image_write_exr(image, fixture_path("whole.exr"), (enum image_compression)k,
                                       NULL, &status));
        int saved = silence(fixture_path("stderr"));
        uint64_t refused = read_damaged(fixture_path("whole.exr"), first_seed + (uint64_t)k);
        check_silent(fixture_path("stderr"), saved);
        assert_true(refused > rounds / 10);
    }
    image_destroy(image);
}

static void damaged_png_files_are_read_or_refused(void **state) {
    struct image *image = fixture_picture(67, 41, 8);
    assert_success(image_write_png(image, fixture_path("whole.png"), &status));
    int saved = silence(fixture_path("stderr"));
    uint64_t refused = read_damaged(fixture_path("whole.png"), first_seed);
    check_silent(fixture_path("stderr"), saved);
    assert_true(refused > rounds / 2); /* PNG has checksums */
    image_destroy(image);
}

static void no_proper_beginning_of_a_file_is_read(void **state) {
    struct image *image = fixture_picture(40, 37, 8), *back;
    for (int k = 0; k <= IMAGE_COMPRESSION_PIZ + 1; k++) {
        size_t size;
        if (k <= IMAGE_COMPRESSION_PIZ)
            assert_success(image_write_exr(image, fixture_path("whole"), (enum image_compression)k,
                                           NULL, &status));
        else
            assert_success(image_write_png(image, fixture_path("whole"), &status));
        unsigned char *bytes = fixture_load(fixture_path("whole"), &size);
        for (size_t length = 0; length < size;
             length += length < 500 || length + 200 > size ? 1 : 37) {
            struct status status = {0};
            fixture_store(fixture_path("part"), bytes, length);
            if (image_read(fixture_path("part"), &back, &status))
                fail_msg("kind %d: %zu of %zu bytes were read", k, length, size);
        }
        free(bytes);
    }
    image_destroy(image);
}

int main(void) {
    const char *text = getenv("SORTLAST_TEST_ROUNDS");
    rounds = text ? strtoull(text, NULL, 10) : rounds;
    text = getenv("SORTLAST_TEST_SEED");
    first_seed = text ? strtoull(text, NULL, 10) : first_seed;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damaged_exr_files_are_read_or_refused),
        cmocka_unit_test(damaged_png_files_are_read_or_refused),
        cmocka_unit_test(no_proper_beginning_of_a_file_is_read),
    };
    return cmocka_run_group_tests(tests, fixture_init, fixture_finish);
}
