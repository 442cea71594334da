/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/region_bins.h"

#include <math.h>
#include <stdlib.h>

void region_bins_init(struct region_bins *bins, const struct region_grid *grid, bool records_work) {
    *bins = (struct region_bins){.grid = *grid, .records_work = records_work};
    bins->tile_columns = (grid->region_width + TILE_SAMPLES - 1) / TILE_SAMPLES;
    bins->tile_rows = (grid->region_height + TILE_SAMPLES - 1) / TILE_SAMPLES;
    bins->tile_words = (bins->tile_columns + 63) / 64;
    bins->bins = memory_get(grid->count, sizeof *bins->bins);
}

void region_bins_finish(struct region_bins *bins) {
    for (uint32_t k = 0; bins->bins && k < bins->grid.count; k++)
        free(bins->bins[k]);
    free(bins->bins);
    free(bins->entries);
    *bins = (struct region_bins){0};
}

/* A rectangle in sample units, grown point by point. */
struct rectangle {
    double x0, x1, y0, y1;
};

static void rectangle_add(struct rectangle *r, const struct region_bins *bins,
                          const struct frame_payload *frame, const double p[3]) {
    const double *w = frame->screen_window;
    double scale = frame->is_perspective ? 1 / p[2] : 1;
    double x = (p[0] * scale - w[0]) / (w[1] - w[0]) * bins->grid.samples_wide - 0.5;
    double y = (p[1] * scale - w[3]) / (w[2] - w[3]) * bins->grid.samples_high - 0.5;
    r->x0 = fmin(r->x0, x);
    r->x1 = fmax(r->x1, x);
    r->y0 = fmin(r->y0, y);
    r->y1 = fmax(r->y1, y);
}

/* The screen rectangle of the part of the triangle behind the near plane; false when there is none.
 */
static bool screen_rectangle(const struct region_bins *bins, const struct frame_payload *frame,
                             const float *const v[3], struct rectangle *r) {
    const double clip = frame->is_perspective ? fmax(frame->near_plane, 1e-30) : frame->near_plane;
    *r = (struct rectangle){INFINITY, -INFINITY, INFINITY, -INFINITY};
    bool any = false;
    for (int i = 0; i < 3; i++) {
        const float *a = v[i], *b = v[(i + 1) % 3];
        if (!isfinite(a[0]) || !isfinite(a[1]) || !isfinite(a[2]))
            return false;
        if (a[2] >= clip) {
            rectangle_add(r, bins, frame, (double[3]){a[0], a[1], a[2]});
            any = true;
        }
        if ((a[2] >= clip) != (b[2] >= clip)) {
            double f = (clip - a[2]) / ((double)b[2] - a[2]);
            rectangle_add(r, bins, frame,
                          (double[3]){a[0] + f * ((double)b[0] - a[0]),
                                      a[1] + f * ((double)b[1] - a[1]), clip});
            any = true;
        }
    }
    return any;
}

static struct region_bin *bin_at(struct region_bins *bins, uint32_t region) {
    if (!bins->bins[region])
        bins->bins[region] =
            memory_get(1, sizeof(struct region_bin) +
                              (size_t)bins->tile_rows * bins->tile_words * sizeof(uint64_t));
    return bins->bins[region];
}

/* Sets the tiles of one region between two sample columns and rows (relative to the region,
 * inclusive). */
static void mark_tiles(const struct region_bins *bins, struct region_bin *bin, uint32_t x0,
                       uint32_t x1, uint32_t y0, uint32_t y1) {
    uint32_t first = x0 / TILE_SAMPLES, last = x1 / TILE_SAMPLES;
    for (uint32_t row = y0 / TILE_SAMPLES; row <= y1 / TILE_SAMPLES; row++) {
        uint64_t *words = bin->tiles + (size_t)row * bins->tile_words;
        for (uint32_t word = first / 64; word <= last / 64; word++) {
            uint64_t from = word == first / 64 ? ~0ull << (first % 64) : ~0ull;
            uint64_t to = word == last / 64 ? ~0ull >> (63 - last % 64) : ~0ull;
            words[word] |= from & to;
        }
    }
}

/* The columns of one row that can lie inside all three edges, a sample to spare on either side;
 * false when there are none. */
static bool row_columns(const struct region_bins *bins, const struct frame_payload *frame,
                        const struct triangle_setup *setup, const struct sample_box *box, double y,
                        uint32_t *first, uint32_t *last) {
    const double *window = frame->screen_window;
    const double reach = fmax(fabs(window[0]), fabs(window[1]));
    const double tolerance = 2 * triangle_setup_tolerance(reach, y);
    const double per_unit = bins->grid.samples_wide / (window[1] - window[0]);
    double low = box->x0, high = box->x1;
    for (int i = 0; i < 3; i++) {
        const double *w = setup->weight[i];
        const double rest = w[1] * y + w[2] + tolerance * (fabs(w[0]) + fabs(w[1]));
        if (w[0] == 0) {
            if (rest < 0)
                return false;
            continue;
        }
        const double column = (-rest / w[0] - window[0]) * per_unit - 0.5;
        if ((w[0] > 0) == (per_unit > 0))
            low = fmax(low, column - 1);
        else
            high = fmin(high, column + 1);
    }
    if (!(low <= high))
        return false;
    *first = (uint32_t)low;
    *last = (uint32_t)high;
    return true;
}

/* Does the triangle cover a sample of the box between the near and the far plane? By the rules of
 * visibility (triangle_setup.h), but whatever lies in front of it: which of its own triangles a
 * node hides depends on which it has, and this must not. */
static bool covers_sample(const struct region_bins *bins, const struct frame_payload *frame,
                          const struct binned_triangle *triangle, const struct sample_box *box) {
    const struct triangle_setup *setup = triangle->setup;
    const float *const *v = triangle->v;
    if (fmaxf(v[0][2], fmaxf(v[1][2], v[2][2])) < frame->near_plane ||
        fminf(v[0][2], fminf(v[1][2], v[2][2])) > frame->far_plane)
        return false;
    for (uint32_t row = box->y0; row <= box->y1; row++) {
        const float y = region_grid_screen_y(&bins->grid, frame, row);
        uint32_t first, last;
        if (!row_columns(bins, frame, setup, box, y, &first, &last))
            continue;
        for (uint32_t column = first; column <= last; column++) {
            const float x = region_grid_screen_x(&bins->grid, frame, column);
            if (!triangle_setup_is_inside(setup, x, y))
                continue;
            const float depth = triangle_setup_depth(setup, x, y);
            if (depth >= frame->near_plane && depth <= frame->far_plane)
                return true;
        }
    }
    return false;
}

/* The entry of the triangle's chunk in a region's list of work; NULL when nobody records. */
static struct chunk_work *work_entry(struct region_bins *bins, struct region_bin *bin,
                                     uint32_t region, uint32_t chunk) {
    if (!bins->records_work)
        return NULL;
    if (!bin->entry || bins->entries[bin->entry - 1].chunk != chunk) {
        bins->entries = memory_grow(bins->entries, &bins->entry_capacity, bins->entry_count + 1,
                                    sizeof *bins->entries);
        bins->entries[bins->entry_count++] = (struct chunk_work){chunk, region, 0, 0};
        bin->entry = (uint32_t)bins->entry_count;
    }
    return &bins->entries[bin->entry - 1];
}

/* Notes whether the triangle can make the region's transfer longer. */
static void mark_coverage(const struct region_bins *bins, const struct frame_payload *frame,
                          const struct binned_triangle *triangle, const struct sample_box *box,
                          struct region_bin *bin, struct chunk_work *entry) {
    const bool is_longer = !bin->is_covered || triangle->map_bytes > bin->longest_map;
    if (!(is_longer || (entry && !entry->covers)) || !covers_sample(bins, frame, triangle, box))
        return;
    if (entry)
        entry->covers = 1;
    if (is_longer) {
        bin->is_covered = true;
        bin->longest_map = triangle->map_bytes;
    }
}

static uint32_t clamp_index(double value, uint32_t limit) {
    return value <= 0 ? 0 : value >= limit ? limit - 1 : (uint32_t)value;
}

struct sample_box region_bins_add(struct region_bins *bins, const struct frame_payload *frame,
                                  const struct binned_triangle *triangle) {
    const struct sample_box none = {UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX};
    const struct region_grid *grid = &bins->grid;
    struct rectangle r;
    if (!screen_rectangle(bins, frame, triangle->v, &r))
        return none;
    /* a margin for the rounding of positions and of Embree's edges: a hundredth of a sample, and
     * 2^-20 of the picture for very large ones */
    const double margin =
        0.01 + 0x1p-20 * (grid->samples_wide > grid->samples_high ? grid->samples_wide
                                                                  : grid->samples_high);
    r.x0 -= margin, r.x1 += margin, r.y0 -= margin, r.y1 += margin;
    if (!(r.x1 >= -0.5 && r.y1 >= -0.5 && r.x0 <= grid->samples_wide - 0.5 &&
          r.y0 <= grid->samples_high - 0.5))
        return none;
    const uint32_t touch_x0 = clamp_index(r.x0 + 0.5, grid->samples_wide),
                   touch_x1 = clamp_index(r.x1 + 0.5, grid->samples_wide),
                   touch_y0 = clamp_index(r.y0 + 0.5, grid->samples_high),
                   touch_y1 = clamp_index(r.y1 + 0.5, grid->samples_high);
    /* sample centres inside the rectangle; none when it falls between two columns or rows */
    const double low_x = ceil(r.x0), high_x = floor(r.x1), low_y = ceil(r.y0), high_y = floor(r.y1);
    const bool has_samples = low_x <= high_x && low_y <= high_y;
    const uint32_t x0 = clamp_index(low_x, grid->samples_wide),
                   x1 = clamp_index(high_x, grid->samples_wide),
                   y0 = clamp_index(low_y, grid->samples_high),
                   y1 = clamp_index(high_y, grid->samples_high);
    const struct sample_box all = {x0, x1, y0, y1};
    const uint32_t w = grid->region_width, h = grid->region_height;
    for (uint32_t row = touch_y0 / h; row <= touch_y1 / h; row++)
        for (uint32_t column = touch_x0 / w; column <= touch_x1 / w; column++) {
            const uint32_t region = row * grid->columns + column;
            struct region_bin *bin = bin_at(bins, region);
            struct chunk_work *entry = work_entry(bins, bin, region, triangle->chunk);
            bin->triangles++;
            if (entry)
                entry->triangles++;
            if (!has_samples || x0 / w > column || x1 / w < column || y0 / h > row || y1 / h < row)
                continue;
            const struct sample_box box = {
                x0 / w < column ? column * w : x0, x1 / w > column ? column * w + w - 1 : x1,
                y0 / h < row ? row * h : y0, y1 / h > row ? row * h + h - 1 : y1};
            mark_tiles(bins, bin, box.x0 % w, box.x1 % w, box.y0 % h, box.y1 % h);
            mark_coverage(bins, frame, triangle, &box, bin, entry);
        }
    return has_samples ? all : none;
}
