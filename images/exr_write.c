/* SPDX-License-Identifier: Apache-2.0 */
#include "images/exr_error.h"
#include "images/half.h"
#include "images/image.h"
#include "images/image_files.h"
#include "images/replacement_file.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A file is a header and chunks of 1 to 32 lines. Threads take the next chunk each, pack and
 * compress it, and write in the order of the lines, which the format asks for: whoever is early
 * waits for its turn. */
enum { WRITER_THREADS = 2, PARALLEL_SAMPLES_MIN = 1 << 16 };

struct exr_writer {
    const struct image *image;
    const struct image_channel **channels; /* by name, as the file has them */
    exr_context_t context;
    int lines_per_chunk, chunk_count;
    pthread_mutex_t mutex;
    pthread_cond_t turn;
    int next_to_take, next_to_write; /* chunk numbers */
    bool failed;
    char message[512];
    uint64_t clamped;
};

static int64_t exr_writer_put(exr_const_context_t context, void *user, const void *bytes,
                              uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t report) {
    return replacement_file_write(user, bytes, size, offset) ? (int64_t)size : -1;
}

/* The chunk that a thread holds, as the pipeline's user data. Blank chunks, of which a sparse picture has
 * many, are compressed once a thread. */
struct exr_chunk {
    struct exr_writer *writer;
    int number;
    exr_result_t (*pack)(exr_encode_pipeline_t *pipeline); /* the library's own */
    exr_result_t (*compress)(exr_encode_pipeline_t *pipeline);
    bool is_blank; /* every value of every channel is 0 */
    uint8_t *blank; /* the last blank chunk, compressed; NULL: none yet */
    uint64_t blank_bytes, blank_packed_bytes;
    int blank_lines;
};

static bool exr_chunk_is_known_blank(const exr_encode_pipeline_t *pipeline) {
    const struct exr_chunk *chunk = pipeline->encoding_user_data;
    return chunk->is_blank && chunk->blank && chunk->blank_lines == pipeline->chunk.height;
}

static exr_result_t exr_writer_pack(exr_encode_pipeline_t *pipeline) {
    const struct exr_chunk *chunk = pipeline->encoding_user_data;
    if (!exr_chunk_is_known_blank(pipeline))
        return chunk->pack(pipeline);
    pipeline->packed_bytes = chunk->blank_packed_bytes; /* without it nothing would be compressed */
    return EXR_ERR_SUCCESS;
}

static void exr_chunk_keep_blank(struct exr_chunk *chunk, const exr_encode_pipeline_t *pipeline) {
    free(chunk->blank);
    chunk->blank = malloc(pipeline->compressed_bytes);
    if (!chunk->blank)
        return;
    memcpy(chunk->blank, pipeline->compressed_buffer, pipeline->compressed_bytes);
    chunk->blank_bytes = pipeline->compressed_bytes;
    chunk->blank_packed_bytes = pipeline->packed_bytes;
    chunk->blank_lines = pipeline->chunk.height;
}

/* A reader takes a chunk as long as its pixels for uncompressed. The library's ZIP up to 3.4.7
 * writes compressed bytes of just that length now and then, which nobody can read back (a fault
 * known to its authors). */
static exr_result_t exr_writer_compress(exr_encode_pipeline_t *pipeline) {
    struct exr_chunk *chunk = pipeline->encoding_user_data;
    if (exr_chunk_is_known_blank(pipeline)) {
        memcpy(pipeline->compressed_buffer, chunk->blank, chunk->blank_bytes);
        pipeline->compressed_bytes = chunk->blank_bytes;
        return EXR_ERR_SUCCESS;
    }
    exr_result_t result = chunk->compress(pipeline);
    if (result == EXR_ERR_SUCCESS && pipeline->compressed_bytes >= pipeline->packed_bytes) {
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
        pipeline->compressed_bytes = pipeline->packed_bytes;
    }
    if (result == EXR_ERR_SUCCESS && chunk->is_blank)
        exr_chunk_keep_blank(chunk, pipeline);
    return result;
}

static exr_result_t exr_writer_wait(exr_encode_pipeline_t *pipeline) {
    struct exr_chunk *chunk = pipeline->encoding_user_data;
    struct exr_writer *writer = chunk->writer;
    pthread_mutex_lock(&writer->mutex);
    while (!writer->failed && writer->next_to_write != chunk->number)
        pthread_cond_wait(&writer->turn, &writer->mutex);
    bool failed = writer->failed;
    pthread_mutex_unlock(&writer->mutex);
    return failed ? EXR_ERR_WRITE_IO : EXR_ERR_SUCCESS;
}

/* -1 when there is nothing left to do. */
static int exr_writer_take(struct exr_writer *writer) {
    pthread_mutex_lock(&writer->mutex);
    int number =
        writer->failed || writer->next_to_take == writer->chunk_count ? -1 : writer->next_to_take++;
    pthread_mutex_unlock(&writer->mutex);
    return number;
}

static void exr_writer_done(struct exr_writer *writer, exr_result_t result) {
    pthread_mutex_lock(&writer->mutex);
    writer->next_to_write++;
    if (result != EXR_ERR_SUCCESS && !writer->failed) {
        writer->failed = true;
        snprintf(writer->message, sizeof writer->message, "%s", exr_error_text(result));
    }
    pthread_cond_broadcast(&writer->turn);
    pthread_mutex_unlock(&writer->mutex);
}

static size_t exr_writer_chunk_pixels(const struct exr_writer *writer) {
    const struct image *image = writer->image;
    int lines = writer->lines_per_chunk < image->height ? writer->lines_per_chunk : image->height;
    return (size_t)lines * (size_t)image->width;
}

/* Points the pipeline at the planes; half channels go through `halves`, with room for each of them.
 * Returns the number of values clamped. */
static uint64_t exr_chunk_bind(const struct exr_writer *writer, int first_line,
                               exr_encode_pipeline_t *pipeline, uint16_t *halves) {
    uint64_t clamped = 0;
    size_t width = (size_t)writer->image->width;
    size_t first = (size_t)first_line * width, count = (size_t)pipeline->chunk.height * width;
    for (int c = 0; c < pipeline->channel_count; c++) {
        const struct image_channel *channel = writer->channels[c];
        exr_coding_channel_info_t *coding = &pipeline->channels[c];
        int16_t bytes = 4;
        coding->encode_from_ptr = (const uint8_t *)(channel->values + first);
        if (channel->type == IMAGE_HALF) {
            for (size_t i = 0; i < count; i++)
                halves[i] = half_from_float(channel->values[first + i], &clamped);
            coding->encode_from_ptr = (const uint8_t *)halves;
            halves += exr_writer_chunk_pixels(writer);
            bytes = 2;
        }
        coding->user_bytes_per_element = bytes;
        coding->user_data_type = coding->data_type;
        coding->user_pixel_stride = bytes;
        coding->user_line_stride = bytes * writer->image->width;
    }
    return clamped;
}

static bool exr_lines_are_blank(const struct exr_writer *writer, int first_line, int lines) {
    const size_t width = (size_t)writer->image->width;
    for (int c = 0; c < writer->image->channel_count; c++) {
        const uint32_t *values = writer->channels[c]->integers + (size_t)first_line * width;
        uint32_t any = 0;
        for (size_t i = 0; i < (size_t)lines * width; i++)
            any |= values[i];
        if (any)
            return false;
    }
    return true;
}

static exr_result_t exr_chunk_write(struct exr_writer *writer, struct exr_chunk *chunk,
                                    exr_encode_pipeline_t *pipeline, bool *started,
                                    uint16_t *halves, uint64_t *clamped) {
    exr_chunk_info_t info;
    int line = chunk->number * writer->lines_per_chunk;
    exr_result_t result = exr_write_scanline_chunk_info(writer->context, 0, line, &info);
    if (result != EXR_ERR_SUCCESS)
        return result;
    bool first = !*started;
    result = first ? exr_encoding_initialize(writer->context, 0, &info, pipeline)
                   : exr_encoding_update(writer->context, 0, &info, pipeline);
    if (result != EXR_ERR_SUCCESS)
        return result;
    *started = true;
    *clamped += exr_chunk_bind(writer, line, pipeline, halves);
    if (first) {
        result = exr_encoding_choose_default_routines(writer->context, 0, pipeline);
        if (result != EXR_ERR_SUCCESS)
            return result;
        chunk->compress = pipeline->compress_fn;
        if (pipeline->compress_fn) {
            pipeline->compress_fn = exr_writer_compress;
            chunk->pack = pipeline->convert_and_pack_fn;
            if (chunk->pack)
                pipeline->convert_and_pack_fn = exr_writer_pack;
        }
    }
    chunk->is_blank = chunk->compress && exr_lines_are_blank(writer, line, info.height);
    pipeline->encoding_user_data = chunk;
    pipeline->yield_until_ready_fn = exr_writer_wait;
    return exr_encoding_run(writer->context, 0, pipeline);
}

static void *exr_writer_work(void *argument) {
    struct exr_writer *writer = argument;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    bool started = false;
    uint64_t clamped = 0;
    size_t half_channels = 0;
    for (int c = 0; c < writer->image->channel_count; c++)
        half_channels += writer->channels[c]->type == IMAGE_HALF;
    /* Input controls the size: a failure is reported like that of a chunk. */
    uint16_t *halves = calloc(half_channels * exr_writer_chunk_pixels(writer) + 1, sizeof *halves);
    exr_error_forget();
    struct exr_chunk chunk = {.writer = writer};
    while ((chunk.number = exr_writer_take(writer)) >= 0) {
        exr_result_t result = EXR_ERR_OUT_OF_MEMORY;
        if (halves)
            result = exr_chunk_write(writer, &chunk, &pipeline, &started, halves, &clamped);
        exr_writer_done(writer, result);
    }
    if (started)
        exr_encoding_destroy(writer->context, &pipeline);
    free(halves);
    free(chunk.blank);
    pthread_mutex_lock(&writer->mutex);
    writer->clamped += clamped;
    pthread_mutex_unlock(&writer->mutex);
    return NULL;
}

static void exr_writer_run(struct exr_writer *writer, bool parallel) {
    pthread_t threads[WRITER_THREADS - 1];
    int started = 0;
    pthread_mutex_init(&writer->mutex, NULL);
    pthread_cond_init(&writer->turn, NULL);
    while (parallel && started < WRITER_THREADS - 1 &&
           pthread_create(&threads[started], NULL, exr_writer_work, writer) == 0)
        started++;
    exr_writer_work(writer);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    pthread_cond_destroy(&writer->turn);
    pthread_mutex_destroy(&writer->mutex);
}

static int exr_compare_names(const void *a, const void *b) {
    const struct image_channel *const *first = a, *const *second = b;
    return strcmp((*first)->name, (*second)->name);
}

static exr_result_t exr_writer_header(struct exr_writer *writer,
                                      enum image_compression compression) {
    static const exr_compression_t compressions[] = {
        [IMAGE_COMPRESSION_NONE] = EXR_COMPRESSION_NONE,
        [IMAGE_COMPRESSION_RLE] = EXR_COMPRESSION_RLE,
        [IMAGE_COMPRESSION_ZIPS] = EXR_COMPRESSION_ZIPS,
        [IMAGE_COMPRESSION_ZIP] = EXR_COMPRESSION_ZIP,
        [IMAGE_COMPRESSION_PIZ] = EXR_COMPRESSION_PIZ};
    static const exr_pixel_type_t types[] = {[IMAGE_FLOAT] = EXR_PIXEL_FLOAT,
                                             [IMAGE_HALF] = EXR_PIXEL_HALF,
                                             [IMAGE_UINT] = EXR_PIXEL_UINT};
    exr_context_t context = writer->context;
    int part;
    exr_result_t result = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (result == EXR_ERR_SUCCESS)
        result = exr_initialize_required_attr_simple(
            context, part, writer->image->width, writer->image->height, compressions[compression]);
    for (int c = 0; result == EXR_ERR_SUCCESS && c < writer->image->channel_count; c++)
        result =
            exr_add_channel(context, part, writer->channels[c]->name,
                            types[writer->channels[c]->type], EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (result == EXR_ERR_SUCCESS)
        result = exr_write_header(context);
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_scanlines_per_chunk(context, part, &writer->lines_per_chunk);
    if (result == EXR_ERR_SUCCESS)
        result = exr_get_chunk_count(context, part, &writer->chunk_count);
    return result;
}

/* Everything but the file's name: returns false with writer->message. */
static bool exr_writer_fill(struct exr_writer *writer, struct replacement_file *file,
                            enum image_compression compression) {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = exr_error_keep;
    options.user_data = file;
    options.write_fn = exr_writer_put;
    exr_error_forget();
    exr_result_t result =
        exr_start_write(&writer->context, file->path, EXR_WRITE_FILE_DIRECTLY, &options);
    if (result == EXR_ERR_SUCCESS)
        result = exr_writer_header(writer, compression);
    if (result == EXR_ERR_SUCCESS) {
        uint64_t samples = (uint64_t)writer->image->width * (uint64_t)writer->image->height *
                           (uint64_t)writer->image->channel_count;
        exr_writer_run(writer, compression != IMAGE_COMPRESSION_NONE && writer->chunk_count > 1 &&
                                   samples >= PARALLEL_SAMPLES_MIN);
    } else {
        writer->failed = true;
        snprintf(writer->message, sizeof writer->message, "%s", exr_error_text(result));
    }
    if (writer->context) {
        result = exr_finish(&writer->context);
        if (result != EXR_ERR_SUCCESS && !writer->failed) {
            writer->failed = true;
            snprintf(writer->message, sizeof writer->message, "%s", exr_error_text(result));
        }
    }
    return !writer->failed;
}

bool image_write_exr(const struct image *image, const char *path,
                     enum image_compression compression, uint64_t *clamped, struct status *status) {
    if (clamped)
        *clamped = 0;
    if (image->channel_count < 1)
        return status_fail(status, STATUS_INVALID, "cannot write '%s': the image has no channels",
                           path);
    struct replacement_file file;
    if (!replacement_file_open(&file, path, status))
        return false;
    struct exr_writer writer = {.image = image};
    writer.channels = memory_get((size_t)image->channel_count, sizeof(void *));
    for (int c = 0; c < image->channel_count; c++)
        writer.channels[c] = &image->channels[c];
    qsort(writer.channels, (size_t)image->channel_count, sizeof(void *), exr_compare_names);
    bool filled = exr_writer_fill(&writer, &file, compression);
    free(writer.channels);
    if (!filled && !file.error) {
        status_fail(status, STATUS_IO, "cannot write '%s': %s", path, writer.message);
        replacement_file_abandon(&file);
        return false;
    }
    if (!replacement_file_commit(&file, status)) /* carries the cause of a failed write */
        return false;
    if (clamped)
        *clamped = writer.clamped;
    return true;
}
