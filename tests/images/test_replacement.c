/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/replacement_file.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

typedef bool writer(const struct image *image, const char *path, struct status *status);

static bool write_none(const struct image *image, const char *path, struct status *status) {
    return image_write_exr(image, path, IMAGE_COMPRESSION_NONE, NULL, status);
}

static bool write_zip(const struct image *image, const char *path, struct status *status) {
    return image_write_exr(image, path, IMAGE_COMPRESSION_ZIP, NULL, status);
}

static writer *const writers[] = {write_none, write_zip, image_write_png};

/* A limit on the length of files stands for a full disk: a write past it fails after some that did
 * not. */
static void limit_files(rlim_t bytes) {
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes < limit.rlim_max ? bytes : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void a_failed_write_leaves_no_file(void **state) {
    struct image *image = fixture_bits(400, 300, "A:f B:f G:f R:f", 1);
    signal(SIGXFSZ, SIG_IGN);
    int before = fixture_count_files();
    for (size_t w = 0; w < sizeof writers / sizeof writers[0]; w++) {
        struct stat about;
        assert_success(writers[w](image, fixture_path("full"), &status));
        assert_int_equal(stat(fixture_path("full"), &about), 0);
        unlink(fixture_path("full"));
        rlim_t whole = (rlim_t)about.st_size;
        const rlim_t lengths[] = {0, 1, 100, 400, 1000, whole / 3, whole / 2, whole - 1};
        for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
            limit_files(lengths[i]);
            assert_failure(writers[w](image, fixture_path("full"), &status), STATUS_IO,
                           fixture_path("full"), "File too large");
            limit_files(RLIM_INFINITY);
            assert_int_equal(fixture_count_files(), before);
        }
    }
    image_destroy(image);
}

static void a_failed_write_leaves_the_old_file(void **state) {
    struct image *image = fixture_bits(400, 300, "A:f B:f G:f R:f", 1);
    fixture_store(fixture_path("old"), "precious", 8);
    signal(SIGXFSZ, SIG_IGN);
    for (size_t w = 0; w < sizeof writers / sizeof writers[0]; w++) {
        size_t size;
        limit_files(3000);
        struct status status = {0};
        assert_false(writers[w](image, fixture_path("old"), &status));
        limit_files(RLIM_INFINITY);
        unsigned char *bytes = fixture_load(fixture_path("old"), &size);
        assert_int_equal(size, 8);
        assert_memory_equal(bytes, "precious", 8);
        free(bytes);
    }
    unlink(fixture_path("old"));
    image_destroy(image);
}

static void a_folder_that_is_not_there_is_named(void **state) {
    struct image *image = fixture_bits(4, 4, "B:f G:f R:f", 1);
    for (size_t w = 0; w < sizeof writers / sizeof writers[0]; w++)
        assert_failure(writers[w](image, fixture_path("no/such.exr"), &status), STATUS_IO,
                       "no/such.exr", "No such file or directory");
    image_destroy(image);
}

static void what_is_not_a_regular_file_is_never_replaced(void **state) {
    struct image *image = fixture_bits(4, 4, "B:f G:f R:f", 1);
    struct stat about;
    for (size_t w = 0; w < sizeof writers / sizeof writers[0]; w++) {
        assert_failure(writers[w](image, "/dev/null", &status), STATUS_INVALID, "/dev/null",
                       "not a regular file");
        assert_failure(writers[w](image, "/tmp", &status), STATUS_INVALID, "/tmp", "a directory");
        assert_failure(writers[w](image, "", &status), STATUS_INVALID, "empty name", "");
    }
    assert_int_equal(stat("/dev/null", &about), 0);
    assert_true(S_ISCHR(about.st_mode));
    image_destroy(image);
}

static void a_symbolic_link_stays_and_its_file_is_replaced(void **state) {
    struct image *image = fixture_bits(4, 4, "B:f G:f R:f", 1), *back;
    struct stat about;
    fixture_store(fixture_path("target.exr"), "", 0);
    assert_int_equal(symlink("target.exr", fixture_path("link.exr")), 0);
    assert_success(write_zip(image, fixture_path("link.exr"), &status));
    assert_int_equal(lstat(fixture_path("link.exr"), &about), 0);
    assert_true(S_ISLNK(about.st_mode));
    assert_success(image_read(fixture_path("target.exr"), &back, &status));
    assert_images_equal(image, back);
    image_destroy(back);
    image_destroy(image);
}

static void a_name_of_255_bytes_is_written(void **state) {
    struct image *image = fixture_bits(4, 4, "B:f G:f R:f", 1), *back;
    char name[256];
    memset(name, 'n', 255);
    name[255] = 0;
    assert_success(write_zip(image, fixture_path(name), &status));
    assert_success(image_read(fixture_path(name), &back, &status));
    image_destroy(back);
    image_destroy(image);
}

static void *write_again_and_again(void *argument) {
    struct status status = {0};
    for (int i = 0; i < 50; i++)
        if (!write_zip(argument, fixture_path("raced.exr"), &status))
            return "failed";
    return NULL;
}

static void whoever_reads_while_two_write_finds_a_whole_image(void **state) {
    struct image *image = fixture_bits(100, 100, "B:f G:h R:f", 1), *back;
    pthread_t threads[2];
    char path[256];
    strcpy(path, fixture_path("raced.exr"));
    assert_success(write_zip(image, path, &status));
    for (int i = 0; i < 2; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, write_again_and_again, image), 0);
    for (int i = 0; i < 50; i++) {
        assert_success(image_read(path, &back, &status));
        assert_images_equal(image, back);
        image_destroy(back);
    }
    for (int i = 0; i < 2; i++) {
        void *result;
        assert_int_equal(pthread_join(threads[i], &result), 0);
        assert_null(result);
    }
    image_destroy(image);
}

static void an_abandoned_file_is_gone_and_abandoning_again_is_harmless(void **state) {
    struct replacement_file file;
    int before = fixture_count_files();
    assert_success(replacement_file_open(&file, fixture_path("given up"), &status));
    assert_true(replacement_file_append(&file, "text", 4));
    assert_int_equal(fixture_count_files(), before + 1);
    replacement_file_abandon(&file);
    replacement_file_abandon(&file);
    assert_int_equal(fixture_count_files(), before);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_failed_write_leaves_no_file),
        cmocka_unit_test(a_failed_write_leaves_the_old_file),
        cmocka_unit_test(a_folder_that_is_not_there_is_named),
        cmocka_unit_test(what_is_not_a_regular_file_is_never_replaced),
        cmocka_unit_test(a_symbolic_link_stays_and_its_file_is_replaced),
        cmocka_unit_test(a_name_of_255_bytes_is_written),
        cmocka_unit_test(whoever_reads_while_two_write_finds_a_whole_image),
        cmocka_unit_test(an_abandoned_file_is_gone_and_abandoning_again_is_harmless),
    };
    return cmocka_run_group_tests(tests, fixture_init, fixture_finish);
}
