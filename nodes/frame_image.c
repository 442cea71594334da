/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/frame_image.h"

#include <stdlib.h>
#include <string.h>

bool frame_image_create(const struct frame_payload *frame, const struct region_grid *grid,
                        struct frame_image *image, struct status *status) {
    *image = (struct frame_image){.frame = *frame, .grid = *grid};
    if (!frame->image_path[0])
        return true;
    image->is_row_covered = memory_get(frame->height, sizeof *image->is_row_covered);
    if (!image_create((int)frame->width, (int)frame->height, &image->image, status))
        return false;
    static const char *const names[] = {"R", "G", "B", "A", "Z"};
    float **const planes[] = {&image->red, &image->green, &image->blue, &image->alpha,
                              &image->depth};
    for (int i = 0; i < 5; i++) {
        struct image_channel *channel = image_add_channel(image->image, names[i], IMAGE_FLOAT);
        if (!channel)
            return status_fail(status, STATUS_LIMIT, "no memory for a picture of %u x %u pixels",
                               frame->width, frame->height);
        *planes[i] = channel->values;
    }
    struct image_channel *channel = image_add_channel(image->image, "shaderID", IMAGE_UINT);
    if (!channel)
        return status_fail(status, STATUS_LIMIT, "no memory for a picture of %u x %u pixels",
                           frame->width, frame->height);
    image->shader = channel->integers;
    return true;
}

static uint64_t count_not_finite(const float *values, uint32_t count) {
    uint32_t bad = 0;
    for (uint32_t k = 0; k < count; k++)
        bad += !(values[k] - values[k] == 0);
    return bad;
}

/* A stretch of samples in one row, one sample a pixel: nothing to blend. */
static void copy_samples(struct frame_image *image, const struct colour_view *colours, uint32_t at,
                         size_t pixel, uint32_t count) {
    memcpy(image->red + pixel, colours->color[0] + at, count * sizeof(float));
    memcpy(image->green + pixel, colours->color[1] + at, count * sizeof(float));
    memcpy(image->blue + pixel, colours->color[2] + at, count * sizeof(float));
    memcpy(image->depth + pixel, colours->depth + at, count * sizeof(float));
    for (uint32_t k = 0; k < count; k++) {
        image->alpha[pixel + k] = 1;
        image->shader[pixel + k] = colours->shader[at + k];
    }
}

static void blend_samples(struct frame_image *image, const struct colour_view *colours, uint32_t at,
                          uint32_t x, uint32_t y, uint32_t count) {
    const uint32_t sx = image->frame.samples_x, sy = image->frame.samples_y;
    image->is_row_covered[y / sy] = true;
    const size_t row = (size_t)(y / sy) * image->frame.width;
    for (uint32_t k = 0; k < count; k++, at++) {
        const size_t pixel = row + (x + k) / sx;
        image->red[pixel] += colours->color[0][at];
        image->green[pixel] += colours->color[1][at];
        image->blue[pixel] += colours->color[2][at];
        if (image->alpha[pixel] == 0 || colours->depth[at] < image->depth[pixel]) {
            image->depth[pixel] = colours->depth[at];
            image->shader[pixel] = colours->shader[at];
        }
        image->alpha[pixel] += 1;
    }
}

void frame_image_add(struct frame_image *image, uint32_t region,
                     const struct colour_view *colours) {
    const struct region_grid *grid = &image->grid;
    const bool is_blended = image->frame.samples_x * image->frame.samples_y > 1;
    uint32_t x0, y0, at = 0;
    region_grid_origin(grid, region, &x0, &y0);
    for (int c = 0; c < 3; c++)
        image->nan_colours += count_not_finite(colours->color[c], colours->head.sample_count);
    if (!image->image)
        return;
    for (uint32_t r = 0; r < colours->head.run_count; r++)
        for (uint32_t done = 0, count; done < colours->runs[r].count; done += count, at += count) {
            const uint32_t sample = colours->runs[r].first + done;
            const uint32_t column = sample % grid->region_width;
            const uint32_t x = x0 + column, y = y0 + sample / grid->region_width;
            count = grid->region_width - column;
            if (count > colours->runs[r].count - done)
                count = colours->runs[r].count - done;
            if (x + count > grid->samples_wide || y >= grid->samples_high)
                continue; /* outside the picture: nodes never send such samples */
            if (is_blended)
                blend_samples(image, colours, at, x, y, count);
            else
                copy_samples(image, colours, at, (size_t)y * image->frame.width + x, count);
        }
}

/* Sums of samples become means; a pixel whose samples are all covered has exactly 1 in alpha. */
static void divide_by_samples(struct frame_image *image) {
    const float samples = (float)(image->frame.samples_x * image->frame.samples_y);
    float *const planes[] = {image->red, image->green, image->blue, image->alpha};
    for (uint32_t y = 0; y < image->frame.height; y++)
        for (int p = 0; p < 4 && image->is_row_covered[y]; p++)
            for (size_t x = 0, row = (size_t)y * image->frame.width; x < image->frame.width; x++)
                planes[p][row + x] /= samples;
}

struct image *frame_image_take(struct frame_image *image) {
    if (image->frame.samples_x * image->frame.samples_y > 1)
        divide_by_samples(image);
    struct image *taken = image->image;
    image->image = NULL;
    return taken;
}

void frame_image_finish(struct frame_image *image) {
    image_destroy(image->image);
    free(image->is_row_covered);
    *image = (struct frame_image){0};
}
