/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image.h"
#include "images/image_files.h"
#include "images/srgb.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* As in png_write.c, everything that must survive libpng's longjmp is here. */
struct png_reader {
    const char *path;
    struct status *status;
    int descriptor;
    uint64_t offset_bytes;
    png_structp png;
    png_infop info;
    struct image *image;
    int channels; /* 3 or 4 samples of 16 bits a pixel after libpng's expansions */
    uint16_t *samples;
    float *linear; /* 65536 values */
};

static void png_reader_error(png_structp png, png_const_charp message) {
    struct png_reader *reader = png_get_error_ptr(png);
    status_fail(reader->status, STATUS_INVALID, "cannot read '%s': %s", reader->path, message);
    png_longjmp(png, 1);
}

static void png_reader_warning(png_structp png, png_const_charp message) {
}

static void png_reader_get(png_structp png, png_bytep bytes, size_t size) {
    struct png_reader *reader = png_get_io_ptr(png);
    int64_t got = image_read_bytes(reader->descriptor, bytes, size, reader->offset_bytes);
    if (got < 0)
        png_error(png, strerror(errno));
    if ((size_t)got < size)
        png_error(png, "the file is truncated");
    reader->offset_bytes += size;
}

/* One row of expanded samples into the planes. */
static void png_reader_row(struct png_reader *reader, int y, const uint16_t *samples) {
    size_t first = (size_t)y * (size_t)reader->image->width;
    for (size_t i = first; i < first + (size_t)reader->image->width; i++) {
        float alpha = 1;
        if (reader->channels == 4) {
            alpha = (float)samples[3] / 65535;
            reader->image->channels[3].values[i] = alpha;
        }
        for (int c = 0; c < 3; c++)
            reader->image->channels[c].values[i] = reader->linear[samples[c]] * alpha;
        samples += reader->channels;
    }
}

/* 8-bit codes arrive as code * 257, so that one table serves both depths exactly. */
static void png_reader_expand(struct png_reader *reader) {
    png_structp png = reader->png;
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    if (png_get_bit_depth(png, reader->info) < 16)
        png_set_expand_16(png);
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    png_set_swap(png);
#endif
}

static bool png_reader_prepare(struct png_reader *reader) {
    static const char names[4][2] = {"R", "G", "B", "A"};
    int width = (int)png_get_image_width(reader->png, reader->info);
    int height = (int)png_get_image_height(reader->png, reader->info);
    if (!image_create(width, height, &reader->image, reader->status))
        return status_prefix(reader->status, "cannot read '%s'", reader->path);
    for (int c = 0; c < reader->channels; c++)
        if (!image_add_channel(reader->image, names[c], IMAGE_FLOAT))
            return status_fail(reader->status, STATUS_LIMIT, "cannot read '%s': out of memory",
                               reader->path);
    bool whole = png_get_interlace_type(reader->png, reader->info) != PNG_INTERLACE_NONE;
    reader->samples = memory_try((size_t)width * (size_t)reader->channels * 2,
                                 whole ? (size_t)height : 1, reader->status);
    reader->linear = memory_get(65536, sizeof *reader->linear);
    for (int i = 0; i < 65536; i++)
        reader->linear[i] = (float)srgb_to_linear(i / 65535.0);
    return reader->samples || status_prefix(reader->status, "cannot read '%s'", reader->path);
}

static bool png_reader_fill(struct png_reader *reader) {
    reader->png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, png_reader_error, png_reader_warning);
    reader->info = reader->png ? png_create_info_struct(reader->png) : NULL;
    if (!reader->info)
        return status_fail(reader->status, STATUS_LIMIT, "cannot read '%s': out of memory",
                           reader->path);
    if (setjmp(png_jmpbuf(reader->png)))
        return false;
    png_structp png = reader->png;
    png_set_read_fn(png, reader, png_reader_get);
    png_set_user_limits(png, (png_uint_32)IMAGE_PIXELS_MAX, (png_uint_32)IMAGE_PIXELS_MAX);
    png_read_info(png, reader->info);
    png_reader_expand(reader);
    int passes = png_set_interlace_handling(png);
    png_read_update_info(png, reader->info);
    reader->channels = png_get_channels(png, reader->info);
    if (reader->channels != 3 && reader->channels != 4)
        png_error(png, "an unexpected number of channels");
    if (!png_reader_prepare(reader))
        return false;
    size_t stride = (size_t)reader->image->width * (size_t)reader->channels;
    for (int pass = 0; pass < passes; pass++)
        for (int y = 0; y < reader->image->height; y++) {
            uint16_t *row = reader->samples + (passes > 1 ? (size_t)y * stride : 0);
            png_read_row(png, (png_bytep)row, NULL);
            if (pass == passes - 1)
                png_reader_row(reader, y, row);
        }
    png_read_end(png, NULL);
    return true;
}

bool image_read_png(const char *path, struct image **image, struct status *status) {
    struct png_reader reader = {.path = path, .status = status};
    *image = NULL;
    uint64_t size_bytes;
    if (!image_open_file(path, &reader.descriptor, &size_bytes, status))
        return false;
    bool done = png_reader_fill(&reader);
    png_destroy_read_struct(&reader.png, &reader.info, NULL);
    close(reader.descriptor);
    free(reader.samples);
    free(reader.linear);
    if (done)
        *image = reader.image;
    else
        image_destroy(reader.image);
    return done;
}
