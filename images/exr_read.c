/* SPDX-License-Identifier: Apache-2.0 */
#include "images/exr_error.h"
#include "images/half.h"
#include "images/image.h"
#include "images/image_files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Decoding follows the file's own chunks; each lands straight in the planes, half channels through
 * a scratch. Nothing in a file is believed before it has been compared with the file's length and
 * our limits. */
struct exr_reader {
    const char *path;
    struct status *status;
    int descriptor;
    uint64_t size_bytes;
    exr_context_t context;
    exr_attr_box2i_t window;
    exr_compression_t compression;
    bool tiled;
    int32_t chunk_width, chunk_height; /* the largest chunk, in pixels */
    struct image *image;               /* channels in the file's order */
    uint16_t *halves;                  /* one chunk of every half channel */
    exr_decode_pipeline_t pipeline;
    bool started;
};

static int64_t exr_reader_size(exr_const_context_t context, void *user) {
    return (int64_t)((struct exr_reader *)user)->size_bytes;
}

static int64_t exr_reader_get(exr_const_context_t context, void *user, void *bytes, uint64_t size,
                              uint64_t offset, exr_stream_error_func_ptr_t report) {
    struct exr_reader *reader = user;
    if (offset > INT64_MAX - size)
        return -1;
    int64_t got = image_read_bytes(reader->descriptor, bytes, size, offset);
    if (got < 0 && report)
        report(context, EXR_ERR_READ_IO, "%s", strerror(errno));
    return got;
}

/* Room behind every buffer that a decompressor fills: a damaged chunk that makes the library write
 * a little past the end then does no harm. */
enum { DECODE_MARGIN_BYTES = 1 << 16 };

static void *exr_reader_allocate(exr_transcoding_pipeline_buffer_id_t id, size_t size) {
    return size > SIZE_MAX - DECODE_MARGIN_BYTES ? NULL : calloc(1, size + DECODE_MARGIN_BYTES);
}

static void exr_reader_release(exr_transcoding_pipeline_buffer_id_t id, void *memory) {
    free(memory);
}

static bool exr_reader_fail(struct exr_reader *reader, exr_result_t result, const char *what) {
    return status_fail(reader->status,
                       result == EXR_ERR_OUT_OF_MEMORY ? STATUS_LIMIT : STATUS_INVALID,
                       "cannot read '%s': %s: %s", reader->path, what, exr_error_text(result));
}

static bool exr_reader_refuse(struct exr_reader *reader, const char *why) {
    return status_fail(reader->status, STATUS_INVALID, "cannot read '%s': %s", reader->path, why);
}

static bool exr_reader_open(struct exr_reader *reader) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = exr_error_keep;
    options.user_data = reader;
    options.read_fn = exr_reader_get;
    options.size_fn = exr_reader_size;
    options.max_image_width = options.max_image_height = (int)IMAGE_PIXELS_MAX;
    options.max_tile_width = options.max_tile_height = 1 << 16;
    options.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t result = exr_start_read(&reader->context, reader->path, &options);
    if (result != EXR_ERR_SUCCESS)
        return exr_reader_fail(reader, result, "not a readable OpenEXR header");
    int parts;
    exr_storage_t storage;
    result = exr_get_count(reader->context, &parts);
    if (result == EXR_ERR_SUCCESS && parts != 1)
        return exr_reader_refuse(reader, "it has more than one part");
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_storage(reader->context, 0, &storage);
    if (result != EXR_ERR_SUCCESS)
        return exr_reader_fail(reader, result, "not a readable OpenEXR header");
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return exr_reader_refuse(reader, "deep images are not supported");
    reader->tiled = storage == EXR_STORAGE_TILED;
    return true;
}

/* Dimensions, compression and the shape of chunks, held against the limits and the file's length.
 */
static bool exr_reader_measure(struct exr_reader *reader) {
    exr_result_t result = exr_get_data_window(reader->context, 0, &reader->window);
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_compression(reader->context, 0, &reader->compression);
    if (result != EXR_ERR_SUCCESS)
        return exr_reader_fail(reader, result, "its header is incomplete");
    int64_t width = (int64_t)reader->window.max.x - reader->window.min.x + 1;
    int64_t height = (int64_t)reader->window.max.y - reader->window.min.y + 1;
    if (width < 1 || height < 1)
        return exr_reader_refuse(reader, "its data window is empty");
    if (width > (int64_t)IMAGE_PIXELS_MAX || height > (int64_t)IMAGE_PIXELS_MAX / width)
        return status_fail(reader->status, STATUS_LIMIT,
                           "cannot read '%s': %lld x %lld pixels are over the limit of %llu",
                           reader->path, (long long)width, (long long)height,
                           (unsigned long long)IMAGE_PIXELS_MAX);
    reader->chunk_width = (int32_t)width;
    result = reader->tiled ? exr_get_tile_sizes(reader->context, 0, 0, 0, &reader->chunk_width,
                                                &reader->chunk_height)
                           : exr_get_scanlines_per_chunk(reader->context, 0, &reader->chunk_height);
    int32_t chunks = 0;
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_chunk_count(reader->context, 0, &chunks);
    if (result != EXR_ERR_SUCCESS || reader->chunk_width < 1 || reader->chunk_height < 1)
        return exr_reader_fail(reader, result, "its header is inconsistent");
    if (reader->chunk_width > width)
        reader->chunk_width = (int32_t)width;
    if (reader->chunk_height > height)
        reader->chunk_height = (int32_t)height;
    /* A chunk takes 8 bytes in the table and 8 of its own at least. */
    int64_t across = (width + reader->chunk_width - 1) / reader->chunk_width;
    int64_t down = (height + reader->chunk_height - 1) / reader->chunk_height;
    if (chunks < across * down || (uint64_t)(across * down) > reader->size_bytes / 16)
        return exr_reader_refuse(reader, "the file is too short for its dimensions");
    return image_create((int)width, (int)height, &reader->image, reader->status) ||
           status_prefix(reader->status, "cannot read '%s'", reader->path);
}

static enum image_channel_type exr_reader_type(const exr_attr_chlist_entry_t *entry) {
    return entry->pixel_type == EXR_PIXEL_HALF    ? IMAGE_HALF
           : entry->pixel_type == EXR_PIXEL_FLOAT ? IMAGE_FLOAT
                                                  : IMAGE_UINT;
}

/* Before memory is taken: refuses channels we do not read and more pixels than the file can hold.
 */
static bool exr_reader_check_channels(struct exr_reader *reader, const exr_attr_chlist_t *list) {
    uint64_t pixel_bytes = 0;
    for (int c = 0; c < list->num_channels; c++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[c];
        if (entry->x_sampling != 1 || entry->y_sampling != 1)
            return status_fail(reader->status, STATUS_INVALID,
                               "cannot read '%s': channel '%.40s' is subsampled %d x %d, which is "
                               "not supported",
                               reader->path, entry->name.str, entry->x_sampling, entry->y_sampling);
        pixel_bytes += exr_reader_type(entry) == IMAGE_HALF ? 2 : 4;
    }
    if (!list->num_channels)
        return exr_reader_refuse(reader, "it has no channels");
    /* No compression does better than deflate's 1032 to 1. */
    uint64_t ratio = reader->compression == EXR_COMPRESSION_NONE ? 1 : 2048;
    uint64_t pixels = (uint64_t)reader->image->width * (uint64_t)reader->image->height;
    if (pixels * pixel_bytes / ratio > reader->size_bytes)
        return exr_reader_refuse(reader, "the file is too short for its dimensions");
    if ((uint64_t)reader->chunk_width * (uint64_t)reader->chunk_height * pixel_bytes > INT32_MAX)
        return exr_reader_refuse(reader, "its chunks are larger than 2 GiB");
    return true;
}

static bool exr_reader_channels(struct exr_reader *reader) {
    const exr_attr_chlist_t *list;
    exr_result_t result = exr_get_channels(reader->context, 0, &list);
    if (result != EXR_ERR_SUCCESS)
        return exr_reader_fail(reader, result, "its header has no channels");
    if (!exr_reader_check_channels(reader, list))
        return false;
    size_t half_channels = 0;
    for (int c = 0; c < list->num_channels; c++) {
        const char *name = list->entries[c].name.str;
        enum image_channel_type type = exr_reader_type(&list->entries[c]);
        if (!image_add_channel(reader->image, name, type))
            return status_fail(reader->status, STATUS_LIMIT,
                               "cannot read '%s': no room for channel '%.40s' (a name of 1 to 31 "
                               "bytes, once, and %llu MiB of pixels in all)",
                               reader->path, name, (unsigned long long)(IMAGE_BYTES_MAX >> 20));
        half_channels += type == IMAGE_HALF;
    }
    size_t chunk_pixels = (size_t)reader->chunk_width * (size_t)reader->chunk_height;
    reader->halves = memory_try(half_channels * chunk_pixels, 2, reader->status);
    return reader->halves || status_prefix(reader->status, "cannot read '%s'", reader->path);
}

/* Decodes one chunk into the planes; x and y are of its first pixel within the image. */
static exr_result_t exr_reader_decode(struct exr_reader *reader, const exr_chunk_info_t *info,
                                      int x, int y) {
    exr_decode_pipeline_t *pipeline = &reader->pipeline;
    bool first = !reader->started;
    exr_result_t result = first ? exr_decoding_initialize(reader->context, 0, info, pipeline)
                                : exr_decoding_update(reader->context, 0, info, pipeline);
    if (result != EXR_ERR_SUCCESS)
        return result;
    reader->started = true;
    pipeline->alloc_fn = exr_reader_allocate;
    pipeline->free_fn = exr_reader_release;
    if (pipeline->channel_count != reader->image->channel_count)
        return EXR_ERR_BAD_CHUNK_LEADER;
    uint16_t *halves = reader->halves;
    size_t chunk_pixels = (size_t)reader->chunk_width * (size_t)reader->chunk_height;
    for (int c = 0; c < pipeline->channel_count; c++) {
        struct image_channel *channel = &reader->image->channels[c];
        exr_coding_channel_info_t *coding = &pipeline->channels[c];
        bool half = channel->type == IMAGE_HALF;
        if (coding->width != info->width || coding->height != info->height)
            return EXR_ERR_BAD_CHUNK_LEADER;
        coding->user_data_type = coding->data_type;
        coding->user_bytes_per_element = half ? 2 : 4;
        coding->user_pixel_stride = half ? 2 : 4;
        coding->user_line_stride = half ? 2 * info->width : 4 * reader->image->width;
        coding->decode_to_ptr =
            half ? (uint8_t *)halves
                 : (uint8_t *)(channel->values + (size_t)y * (size_t)reader->image->width +
                               (size_t)x);
        halves += half ? chunk_pixels : 0;
    }
    if (first) {
        result = exr_decoding_choose_default_routines(reader->context, 0, pipeline);
        if (result != EXR_ERR_SUCCESS)
            return result;
    }
    return exr_decoding_run(reader->context, 0, pipeline);
}

static void exr_reader_widen(struct exr_reader *reader, const exr_chunk_info_t *info, int x,
                             int y) {
    const uint16_t *halves = reader->halves;
    for (int c = 0; c < reader->image->channel_count; c++) {
        struct image_channel *channel = &reader->image->channels[c];
        if (channel->type != IMAGE_HALF)
            continue;
        for (int row = 0; row < info->height; row++) {
            float *to =
                channel->values + (size_t)(y + row) * (size_t)reader->image->width + (size_t)x;
            const uint16_t *from = halves + (size_t)row * (size_t)info->width;
            for (int i = 0; i < info->width; i++)
                to[i] = half_to_float(from[i]);
        }
        halves += (size_t)reader->chunk_width * (size_t)reader->chunk_height;
    }
}

static bool exr_reader_chunk(struct exr_reader *reader, int x, int y) {
    exr_chunk_info_t info;
    int column = x / reader->chunk_width, row = y / reader->chunk_height;
    exr_error_forget();
    exr_result_t result =
        reader->tiled
            ? exr_read_tile_chunk_info(reader->context, 0, column, row, 0, 0, &info)
            : exr_read_scanline_chunk_info(reader->context, 0, reader->window.min.y + y, &info);
    if (result == EXR_ERR_SUCCESS) {
        int width = reader->image->width - x, height = reader->image->height - y;
        if (width > reader->chunk_width)
            width = reader->chunk_width;
        if (height > reader->chunk_height)
            height = reader->chunk_height;
        if (info.width != width || info.height != height || info.data_offset > reader->size_bytes ||
            info.packed_size > reader->size_bytes - info.data_offset ||
            (reader->compression == EXR_COMPRESSION_NONE && info.packed_size != info.unpacked_size))
            result = EXR_ERR_BAD_CHUNK_LEADER;
    }
    if (result == EXR_ERR_SUCCESS)
        result = exr_reader_decode(reader, &info, x, y);
    if (result == EXR_ERR_SUCCESS) {
        exr_reader_widen(reader, &info, x, y);
        return true;
    }
    char what[64];
    snprintf(what, sizeof what, "its %s at line %d, column %d", reader->tiled ? "tile" : "chunk", y,
             x);
    return exr_reader_fail(reader, result, what);
}

static bool exr_reader_fill(struct exr_reader *reader) {
    for (int y = 0; y < reader->image->height; y += reader->chunk_height)
        for (int x = 0; x < reader->image->width; x += reader->chunk_width)
            if (!exr_reader_chunk(reader, x, y))
                return false;
    return true;
}

bool image_read_exr(const char *path, struct image **image, struct status *status) {
    struct exr_reader reader = {.path = path, .status = status};
    *image = NULL;
    if (!image_open_file(path, &reader.descriptor, &reader.size_bytes, status))
        return false;
    exr_error_forget();
    bool done = exr_reader_open(&reader) && exr_reader_measure(&reader) &&
                exr_reader_channels(&reader) && exr_reader_fill(&reader);
    if (reader.started)
        exr_decoding_destroy(reader.context, &reader.pipeline);
    if (reader.context)
        exr_finish(&reader.context);
    close(reader.descriptor);
    free(reader.halves);
    if (done)
        *image = reader.image;
    else
        image_destroy(reader.image);
    return done;
}
