/* SPDX-License-Identifier: Apache-2.0 */
#include "fixture.h"

#include "images/half.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char fixture_folder[64];

int fixture_init(void **state) {
    /* In memory where there is such a place: the tests write thousands of small files. */
    snprintf(fixture_folder, sizeof fixture_folder, "%s/sortlast-images-XXXXXX",
             access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    return mkdtemp(fixture_folder) ? 0 : -1;
}

int fixture_finish(void **state) {
    DIR *folder = opendir(fixture_folder);
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlink(fixture_path(entry->d_name));
    if (folder)
        closedir(folder);
    return rmdir(fixture_folder);
}

const char *fixture_path(const char *name) {
    static _Thread_local char paths[4][512];
    static _Thread_local int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", fixture_folder, name);
    return path;
}

int fixture_count_files(void) {
    int count = -2;
    DIR *folder = opendir(fixture_folder);
    while (readdir(folder))
        count++;
    closedir(folder);
    return count;
}

static void fixture_fill_bits(struct image_channel *channel, size_t count, struct rng *rng) {
    for (size_t i = 0; i < count; i++) {
        /* Runs of equal values and of noise, so that compression has both. */
        bool repeat = i && rng_below(rng, 3);
        uint32_t bits = (uint32_t)rng_next(rng);
        if (repeat)
            channel->integers[i] = channel->integers[i - 1];
        else if (channel->type == IMAGE_HALF)
            channel->values[i] = half_to_float((uint16_t)bits);
        else
            channel->integers[i] = bits;
    }
}

struct image *fixture_bits(int width, int height, const char *channels, uint64_t seed) {
    struct image *image;
    struct rng rng = {seed};
    assert_success(image_create(width, height, &image, &status));
    char name[32], type;
    int used;
    for (; sscanf(channels, " %31[^:]:%c%n", name, &type, &used) == 2; channels += used) {
        struct image_channel *channel = image_add_channel(image, name,
                                                          type == 'f'   ? IMAGE_FLOAT
                                                          : type == 'h' ? IMAGE_HALF
                                                                        : IMAGE_UINT);
        assert_non_null(channel);
        fixture_fill_bits(channel, (size_t)width * (size_t)height, &rng);
    }
    return image;
}

struct image *fixture_picture(int width, int height, uint64_t seed) {
    struct image *image;
    struct rng rng = {seed};
    assert_success(image_create(width, height, &image, &status));
    for (int c = 0; c < 3; c++) {
        struct image_channel *channel =
            image_add_channel(image, (const char *[]){"R", "G", "B"}[c], IMAGE_FLOAT);
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                double value = 0.5 + 0.3 * sin(0.11 * x * (c + 1) + seed) * cos(0.07 * y);
                value += ((x / 9 + y / 7) % 3 == c ? 0.15 : 0) + 0.05 * (rng_unit(&rng) - 0.5);
                channel->values[(size_t)y * (size_t)width + (size_t)x] = (float)value;
            }
    }
    return image;
}

struct image *fixture_copy(const struct image *image) {
    struct image *copy;
    assert_success(image_create(image->width, image->height, &copy, &status));
    for (int c = 0; c < image->channel_count; c++) {
        const struct image_channel *from = &image->channels[c];
        struct image_channel *to = image_add_channel(copy, from->name, from->type);
        memcpy(to->values, from->values, (size_t)image->width * (size_t)image->height * 4);
    }
    return copy;
}

float *fixture_plane(struct image *image, const char *name) {
    const struct image_channel *channel = image_find_channel(image, name);
    assert_non_null(channel);
    return channel->values;
}

void fixture_add_noise(struct image *image, double amplitude, uint64_t seed) {
    struct rng rng = {seed};
    size_t count = (size_t)image->width * (size_t)image->height;
    for (int c = 0; c < 3; c++) {
        float *plane = fixture_plane(image, (const char *[]){"R", "G", "B"}[c]);
        for (size_t i = 0; i < count; i++) {
            double value = plane[i] + amplitude * (2 * rng_unit(&rng) - 1);
            plane[i] = (float)(value < 0 ? 0 : value > 1 ? 1 : value);
        }
    }
}

void fixture_fill(struct image *image, float red, float green, float blue) {
    size_t count = (size_t)image->width * (size_t)image->height;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++)
            fixture_plane(image, (const char *[]){"R", "G", "B"}[c])[i] =
                (const float[]){red, green, blue}[c];
}

void assert_images_equal(const struct image *a, const struct image *b) {
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_int_equal(a->channel_count, b->channel_count);
    for (int c = 0; c < a->channel_count; c++) {
        const struct image_channel *first = &a->channels[c];
        const struct image_channel *second = image_find_channel(b, first->name);
        assert_non_null(second);
        assert_int_equal(first->type, second->type);
        assert_memory_equal(first->values, second->values,
                            (size_t)a->width * (size_t)a->height * 4);
    }
}

unsigned char *fixture_load(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size + 1);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

void fixture_store(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}
