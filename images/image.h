/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGE_H
#define IMAGE_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A picture in memory: named channels, each a plane of width * height 32-bit values, rows from the
 * top. */
enum image_channel_type { IMAGE_FLOAT, IMAGE_HALF, IMAGE_UINT };

struct image_channel {
    char name[32];
    enum image_channel_type type; /* how it is (or was) stored in a file; in memory HALF is float */
    union {
        float *values;      /* FLOAT, HALF */
        uint32_t *integers; /* UINT */
    };
};

/* The largest image: 16384 x 16384 pixels or as many in another shape, and 16 such planes. */
#define IMAGE_PIXELS_MAX ((uint64_t)1 << 28)
#define IMAGE_BYTES_MAX ((uint64_t)1 << 34)

struct image {
    int width, height;
    struct image_channel *channels;
    int channel_count;
};

enum image_compression {
    IMAGE_COMPRESSION_NONE,
    IMAGE_COMPRESSION_RLE,
    IMAGE_COMPRESSION_ZIPS,
    IMAGE_COMPRESSION_ZIP,
    IMAGE_COMPRESSION_PIZ
};

/* Zeroed planes; the image is the caller's to destroy. */
bool image_create(int width, int height, struct image **image, struct status *status);
/* Adds a zeroed channel and returns it (valid until the next is added). NULL when the name is
 * empty, longer than 31 bytes or taken, when the image would pass IMAGE_BYTES_MAX, or when there is
 * no memory. */
struct image_channel *image_add_channel(struct image *image, const char *name,
                                        enum image_channel_type type);
const struct image_channel *image_find_channel(const struct image *image, const char *name);
void image_destroy(struct image *image);

/* Writes OpenEXR through OpenEXRCore: to a temporary name beside `path` (".PATH.PID.tmp" in the
 * same folder), then renamed, so that `path` is never half a file; the temporary is removed on
 * every failure. HALF channels are rounded to nearest even; finite values beyond 65504 are clamped
 * to it and counted in *clamped (may be NULL). */
bool image_write_exr(const struct image *image, const char *path,
                     enum image_compression compression, uint64_t *clamped, struct status *status);
/* One part of scanlines or tiles (the full-resolution level), any compression OpenEXRCore decodes;
 * the image covers the data window. Subsampled channels, deep data and files of several parts are
 * refused. */
bool image_read_exr(const char *path, struct image **image, struct status *status);
/* 8-bit sRGB PNG of channels R G B (and A when present: un-premultiplied), values clamped to [0,1],
 * NaN as 0; written under a temporary name and renamed in the same way. */
bool image_write_png(const struct image *image, const char *path, struct status *status);
/* Any PNG as sRGB into linear FLOAT channels R G B (and A: premultiplied), the inverse of writing;
 * other colour spaces that the file may name are not applied. */
bool image_read_png(const char *path, struct image **image, struct status *status);
/* Chooses by the file's first bytes. */
bool image_read(const char *path, struct image **image, struct status *status);

#endif
