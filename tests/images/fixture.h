/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TESTS_IMAGES_FIXTURE_H
#define TESTS_IMAGES_FIXTURE_H

/* cmocka wants these before itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/rng.h"
#include "images/image.h"

/* A folder of the test's own, removed with what is in it by fixture_finish. */
int fixture_init(void **state);
int fixture_finish(void **state);
/* "FOLDER/NAME"; four answers stay valid at a time. */
const char *fixture_path(const char *name);
/* The number of files in the folder. */
int fixture_count_files(void);

#define assert_success(call)                                                                       \
    do {                                                                                           \
        struct status status = {0};                                                                \
        if (!(call))                                                                               \
            fail_msg("%s: %s", #call, status.message);                                             \
    } while (0)

/* The call fails with this code and a message that has both texts in it. */
#define assert_failure(call, wanted, text1, text2)                                                 \
    do {                                                                                           \
        struct status status = {0};                                                                \
        if (call)                                                                                  \
            fail_msg("%s succeeded", #call);                                                       \
        if (status.code != (wanted) || !strstr(status.message, text1) ||                           \
            !strstr(status.message, text2))                                                        \
            fail_msg("%s: code %d, message '%s'", #call, status.code, status.message);             \
    } while (0)

/* Channels by a specification such as "R:f G:h ID:u", filled with what the type can hold exactly,
 * all bit patterns of it: NaN, infinities and denormals too. */
struct image *fixture_bits(int width, int height, const char *channels, uint64_t seed);
/* R, G, B with smooth shapes, edges and a little noise, in [0,1]. */
struct image *fixture_picture(int width, int height, uint64_t seed);
struct image *fixture_copy(const struct image *image);
/* Adds uniform noise of this amplitude to R, G and B, kept in [0,1]. */
void fixture_add_noise(struct image *image, double amplitude, uint64_t seed);
/* R, G and B to these values. */
void fixture_fill(struct image *image, float red, float green, float blue);
float *fixture_plane(struct image *image, const char *name);
/* Same size, channels by name, types and bits. */
void assert_images_equal(const struct image *a, const struct image *b);

/* The whole file, for the caller to free. */
unsigned char *fixture_load(const char *path, size_t *size);
void fixture_store(const char *path, const void *bytes, size_t size);

#endif
