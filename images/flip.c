/* SPDX-License-Identifier: Apache-2.0 */
#include "images/flip.h"

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The image is cut into tiles; each needs its pixels and a margin as wide as the largest filter,
 * with the image's border repeated outwards. All filters are products of one across and one down.
 */
enum { TILE_WIDTH = 256, TILE_HEIGHT = 64, RADIUS_MAX = 140, FLIP_THREADS = 2 };

struct flip_kernel {
    double taps[2 * RADIUS_MAX + 1];
};

/* Across: what is filtered along the rows. Down: from which of those, into which result. */
enum flip_across {
    ACROSS_Y,
    ACROSS_SMOOTH,
    ACROSS_EDGE,
    ACROSS_POINT,
    ACROSS_CX,
    ACROSS_CZ1,
    ACROSS_CZ2,
    ACROSS_COUNT
};
enum flip_down {
    DOWN_Y,
    DOWN_CX,
    DOWN_CZ1,
    DOWN_CZ2,
    DOWN_EDGE_X,
    DOWN_EDGE_Y,
    DOWN_POINT_X,
    DOWN_POINT_Y,
    DOWN_COUNT
};
enum flip_feature { FEATURE_L, FEATURE_A, FEATURE_B, FEATURE_EDGE, FEATURE_POINT, FEATURE_COUNT };

struct flip_filters {
    int radius, contrast_radius,
        feature_radius; /* the larger; of the color part; of the feature part */
    struct flip_kernel y, cx, cz1, cz2, smooth, edge, point;
    double cz1_weight, cz2_weight;
    double to_xyz[3][3], from_xyz[3][3], white[3]; /* linear sRGB, white = its sum */
    double color_max; /* the largest HyAB difference to the power 0.7 */
};

struct flip_job {
    const float *const *planes[2]; /* reference, test */
    int width, height;
    float *map;
    const struct flip_filters *filters;
    int next_tile, tile_count, tiles_across; /* next_tile is shared */
    bool out_of_memory;
};

struct flip_tile {
    int x, y, width, height;
    double *source[3];            /* one row of Y, Cx, Cz with its margins */
    double *across[ACROSS_COUNT]; /* TILE_WIDTH by height + 2 radius */
    double *down[DOWN_COUNT];     /* one row */
    double *features[2][FEATURE_COUNT];
};

static double flip_clamp(float value) {
    return value > 0 ? value < 1 ? value : 1 : 0;
}

/* A unit sum for even kernels. */
static double flip_gaussian(struct flip_kernel *kernel, int radius, double inverse_variance) {
    double sum = 0;
    for (int i = -radius; i <= radius; i++)
        sum += kernel->taps[i + radius] = exp(-0.5 * inverse_variance * i * i);
    for (int i = 0; i <= 2 * radius; i++)
        kernel->taps[i] /= sum;
    return sum;
}

/* Positive taps sum to 1 and negative taps to -1 (section 5.2 of the paper). */
static void flip_balance(struct flip_kernel *kernel, int radius) {
    double positive = 0, negative = 0;
    for (int i = 0; i <= 2 * radius; i++)
        *(kernel->taps[i] > 0 ? &positive : &negative) += fabs(kernel->taps[i]);
    for (int i = 0; i <= 2 * radius; i++)
        kernel->taps[i] /= kernel->taps[i] > 0 ? positive : negative;
}

/* Contrast sensitivity of the achromatic, red-green and blue-yellow channels: sums of a sqrt(pi/b)
 * exp(-pi^2 z^2 / b) with z in degrees (section 4.1, table 1). */
static void flip_contrast_init(struct flip_filters *filters, double pixels_per_degree) {
    const double y_b = 0.0047, cx_b = 0.0053, cz_a[2] = {34.1, 13.5}, cz_b[2] = {0.04, 0.025};
    int radius = (int)ceil(3 * sqrt(0.04 / (2 * M_PI * M_PI)) * pixels_per_degree);
    double scale = 2 * M_PI * M_PI / (pixels_per_degree * pixels_per_degree);
    filters->contrast_radius = radius;
    flip_gaussian(&filters->y, radius, scale / y_b);
    flip_gaussian(&filters->cx, radius, scale / cx_b);
    double sum1 = flip_gaussian(&filters->cz1, radius, scale / cz_b[0]);
    double sum2 = flip_gaussian(&filters->cz2, radius, scale / cz_b[1]);
    double weight1 = cz_a[0] * sqrt(M_PI / cz_b[0]) * sum1 * sum1;
    double weight2 = cz_a[1] * sqrt(M_PI / cz_b[1]) * sum2 * sum2;
    filters->cz1_weight = weight1 / (weight1 + weight2);
    filters->cz2_weight = weight2 / (weight1 + weight2);
}

/* First and second derivatives of a Gaussian 0.082 degrees from peak to trough (section 5.2). */
static void flip_features_init(struct flip_filters *filters, double pixels_per_degree) {
    double deviation = 0.5 * 0.082 * pixels_per_degree, variance = deviation * deviation;
    int radius = (int)ceil(3 * deviation);
    filters->feature_radius = radius;
    flip_gaussian(&filters->smooth, radius, 1 / variance);
    for (int i = -radius; i <= radius; i++) {
        filters->edge.taps[i + radius] = -i * filters->smooth.taps[i + radius];
        filters->point.taps[i + radius] = (i * i / variance - 1) * filters->smooth.taps[i + radius];
    }
    flip_balance(&filters->edge, radius);
    flip_balance(&filters->point, radius);
}

static void flip_transform(const double m[3][3], const double in[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = m[i][0] * in[0] + m[i][1] * in[1] + m[i][2] * in[2];
}

/* Linear sRGB in the unit cube to L*a*b* with the Hunt effect: colours weaken in the dark
 * (section 4.2). */
static void flip_hunt_lab(const struct flip_filters *filters, const double rgb[3], double lab[3]) {
    double xyz[3], f[3];
    flip_transform(filters->to_xyz, rgb, xyz);
    for (int i = 0; i < 3; i++) {
        double t = xyz[i] / filters->white[i];
        f[i] = t > 216.0 / 24389 ? cbrt(t) : t * (841.0 / 108) + 4.0 / 29;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 0.01 * lab[0] * 500 * (f[0] - f[1]);
    lab[2] = 0.01 * lab[0] * 200 * (f[1] - f[2]);
}

static double flip_hyab(const double a[3], const double b[3]) {
    return fabs(a[0] - b[0]) + sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void flip_colors_init(struct flip_filters *filters) {
    /* sRGB primaries and D65 as whole numbers. */
    static const double to_xyz[3][3] = {
        {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
        {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
        {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
    memcpy(filters->to_xyz, to_xyz, sizeof to_xyz);
    const double(*m)[3] = to_xyz;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            filters->from_xyz[j][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    double determinant = 0;
    for (int j = 0; j < 3; j++)
        determinant += m[0][j] * filters->from_xyz[j][0];
    for (int i = 0; i < 3; i++) {
        filters->white[i] = m[i][0] + m[i][1] + m[i][2];
        for (int j = 0; j < 3; j++)
            filters->from_xyz[i][j] /= determinant;
    }
    double green[3], blue[3];
    flip_hunt_lab(filters, (const double[3]){0, 1, 0}, green);
    flip_hunt_lab(filters, (const double[3]){0, 0, 1}, blue);
    filters->color_max = pow(flip_hyab(green, blue), 0.7);
}

static void flip_filter_row(const struct flip_kernel *kernel, int radius, const double *centre,
                            double *restrict out, int width) {
    memset(out, 0, (size_t)width * sizeof *out);
    for (int k = -radius; k <= radius; k++) {
        double tap = kernel->taps[k + radius];
        const double *in = centre + k;
        for (int x = 0; x < width; x++)
            out[x] += tap * in[x];
    }
}

/* `rows` points at the first row that the result's first tap needs. */
static void flip_filter_column(const struct flip_kernel *kernel, int radius, const double *rows,
                               double *restrict out, int width) {
    memset(out, 0, (size_t)width * sizeof *out);
    for (int k = 0; k <= 2 * radius; k++) {
        double tap = kernel->taps[k];
        const double *in = rows + (size_t)k * TILE_WIDTH;
        for (int x = 0; x < width; x++)
            out[x] += tap * in[x];
    }
}

static int flip_inside(int position, int size) {
    return position < 0 ? 0 : position < size ? position : size - 1;
}

/* One row of an image in the opponent space YCxCz, Y as relative luminance: what the paper's scale
 * and offset of Y would add cancels, as filters have a unit sum. */
static void flip_source_row(const struct flip_job *job, const float *const planes[3],
                            struct flip_tile *tile, int y) {
    const struct flip_filters *filters = job->filters;
    size_t row = (size_t)flip_inside(y, job->height) * (size_t)job->width;
    for (int i = 0; i < tile->width + 2 * filters->radius; i++) {
        size_t at = row + (size_t)flip_inside(tile->x - filters->radius + i, job->width);
        double rgb[3], xyz[3];
        for (int c = 0; c < 3; c++)
            rgb[c] = flip_clamp(planes[c][at]);
        flip_transform(filters->to_xyz, rgb, xyz);
        for (int c = 0; c < 3; c++)
            xyz[c] /= filters->white[c];
        tile->source[0][i] = xyz[1];
        tile->source[1][i] = xyz[0] - xyz[1];
        tile->source[2][i] = xyz[1] - xyz[2];
    }
}

static void flip_tile_across(const struct flip_job *job, const float *const planes[3],
                             struct flip_tile *tile) {
    const struct flip_filters *f = job->filters;
    const struct {
        const struct flip_kernel *kernel;
        int radius, source;
    } passes[ACROSS_COUNT] = {
        [ACROSS_Y] = {&f->y, f->contrast_radius, 0},
        [ACROSS_SMOOTH] = {&f->smooth, f->feature_radius, 0},
        [ACROSS_EDGE] = {&f->edge, f->feature_radius, 0},
        [ACROSS_POINT] = {&f->point, f->feature_radius, 0},
        [ACROSS_CX] = {&f->cx, f->contrast_radius, 1},
        [ACROSS_CZ1] = {&f->cz1, f->contrast_radius, 2},
        [ACROSS_CZ2] = {&f->cz2, f->contrast_radius, 2},
    };
    for (int row = 0; row < tile->height + 2 * f->radius; row++) {
        flip_source_row(job, planes, tile, tile->y - f->radius + row);
        for (int p = 0; p < ACROSS_COUNT; p++)
            flip_filter_row(passes[p].kernel, passes[p].radius,
                            tile->source[passes[p].source] + f->radius,
                            tile->across[p] + (size_t)row * TILE_WIDTH, tile->width);
    }
}

/* What the comparison needs of one pixel of one image. */
static void flip_pixel_features(const struct flip_filters *filters, double *const down[DOWN_COUNT],
                                int x, double *const features[FEATURE_COUNT], size_t at) {
    double y = down[DOWN_Y][x], cx = down[DOWN_CX][x];
    double cz = filters->cz1_weight * down[DOWN_CZ1][x] + filters->cz2_weight * down[DOWN_CZ2][x];
    double xyz[3] = {(y + cx) * filters->white[0], y * filters->white[1],
                     (y - cz) * filters->white[2]};
    double rgb[3], lab[3];
    flip_transform(filters->from_xyz, xyz, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] = rgb[c] > 0 ? rgb[c] < 1 ? rgb[c] : 1 : 0;
    flip_hunt_lab(filters, rgb, lab);
    for (int c = 0; c < 3; c++)
        features[FEATURE_L + c][at] = lab[c];
    double ex = down[DOWN_EDGE_X][x], ey = down[DOWN_EDGE_Y][x];
    double px = down[DOWN_POINT_X][x], py = down[DOWN_POINT_Y][x];
    features[FEATURE_EDGE][at] = sqrt(ex * ex + ey * ey);
    features[FEATURE_POINT][at] = sqrt(px * px + py * py);
}

static void flip_tile_down(const struct flip_filters *f, struct flip_tile *tile,
                           double *const features[FEATURE_COUNT]) {
    const struct {
        const struct flip_kernel *kernel;
        int radius;
        enum flip_across across;
    } passes[DOWN_COUNT] = {
        [DOWN_Y] = {&f->y, f->contrast_radius, ACROSS_Y},
        [DOWN_CX] = {&f->cx, f->contrast_radius, ACROSS_CX},
        [DOWN_CZ1] = {&f->cz1, f->contrast_radius, ACROSS_CZ1},
        [DOWN_CZ2] = {&f->cz2, f->contrast_radius, ACROSS_CZ2},
        [DOWN_EDGE_X] = {&f->smooth, f->feature_radius, ACROSS_EDGE},
        [DOWN_EDGE_Y] = {&f->edge, f->feature_radius, ACROSS_SMOOTH},
        [DOWN_POINT_X] = {&f->smooth, f->feature_radius, ACROSS_POINT},
        [DOWN_POINT_Y] = {&f->point, f->feature_radius, ACROSS_SMOOTH},
    };
    for (int row = 0; row < tile->height; row++) {
        for (int p = 0; p < DOWN_COUNT; p++)
            flip_filter_column(passes[p].kernel, passes[p].radius,
                               tile->across[passes[p].across] +
                                   (size_t)(row + f->radius - passes[p].radius) * TILE_WIDTH,
                               tile->down[p], tile->width);
        for (int x = 0; x < tile->width; x++)
            flip_pixel_features(f, tile->down, x, features, (size_t)row * TILE_WIDTH + (size_t)x);
    }
}

/* Sections 4.3, 5.2 and 6: the color difference redistributed so that the first 0.4 of its range
 * takes 0.95 of the result (p_c, p_t), raised to a power that edges and points bring down. */
static double flip_pixel(const struct flip_filters *filters, double *const a[FEATURE_COUNT],
                         double *const b[FEATURE_COUNT], size_t at) {
    const double lab_a[3] = {a[FEATURE_L][at], a[FEATURE_A][at], a[FEATURE_B][at]};
    const double lab_b[3] = {b[FEATURE_L][at], b[FEATURE_A][at], b[FEATURE_B][at]};
    double color = pow(flip_hyab(lab_a, lab_b), 0.7), knee = 0.4 * filters->color_max;
    color = color < knee ? 0.95 / knee * color
                         : 0.95 + 0.05 * (color - knee) / (filters->color_max - knee);
    double edge = fabs(a[FEATURE_EDGE][at] - b[FEATURE_EDGE][at]);
    double point = fabs(a[FEATURE_POINT][at] - b[FEATURE_POINT][at]);
    double feature = sqrt((edge > point ? edge : point) * M_SQRT1_2);
    return pow(color < 1 ? color : 1, 1 - feature);
}

/* Whether the two images agree on all that the tile's result depends on. */
static bool flip_tile_equal(const struct flip_job *job, const struct flip_tile *tile) {
    int radius = job->filters->radius;
    int first = flip_inside(tile->x - radius, job->width);
    int last = flip_inside(tile->x + tile->width - 1 + radius, job->width);
    for (int y = flip_inside(tile->y - radius, job->height);
         y <= flip_inside(tile->y + tile->height - 1 + radius, job->height); y++)
        for (int c = 0; c < 3; c++) {
            size_t at = (size_t)y * (size_t)job->width + (size_t)first;
            if (memcmp(job->planes[0][c] + at, job->planes[1][c] + at,
                       (size_t)(last - first + 1) * sizeof(float)) != 0)
                return false;
        }
    return true;
}

static void flip_tile_compare(const struct flip_job *job, struct flip_tile *tile) {
    bool equal = flip_tile_equal(job, tile);
    for (int image = 0; image < 2 && !equal; image++) {
        flip_tile_across(job, job->planes[image], tile);
        flip_tile_down(job->filters, tile, tile->features[image]);
    }
    for (int row = 0; row < tile->height; row++) {
        float *map = job->map + (size_t)(tile->y + row) * (size_t)job->width + (size_t)tile->x;
        for (int x = 0; x < tile->width; x++)
            map[x] = equal ? 0
                           : (float)flip_pixel(job->filters, tile->features[0], tile->features[1],
                                               (size_t)row * TILE_WIDTH + (size_t)x);
    }
}

/* Cuts one allocation into the tile's buffers; the caller frees it. NULL when there is no memory.
 */
static double *flip_tile_init(struct flip_tile *tile, int radius) {
    size_t source = (size_t)(TILE_WIDTH + 2 * radius);
    size_t across = (size_t)TILE_WIDTH * (size_t)(TILE_HEIGHT + 2 * radius);
    size_t features = (size_t)TILE_WIDTH * TILE_HEIGHT;
    double *memory = calloc(3 * source + ACROSS_COUNT * across + DOWN_COUNT * TILE_WIDTH +
                                2 * FEATURE_COUNT * features,
                            sizeof *memory);
    double *at = memory;
    for (int i = 0; memory && i < 3; i++, at += source)
        tile->source[i] = at;
    for (int i = 0; memory && i < ACROSS_COUNT; i++, at += across)
        tile->across[i] = at;
    for (int i = 0; memory && i < DOWN_COUNT; i++, at += TILE_WIDTH)
        tile->down[i] = at;
    for (int i = 0; memory && i < 2 * FEATURE_COUNT; i++, at += features)
        tile->features[i / FEATURE_COUNT][i % FEATURE_COUNT] = at;
    return memory;
}

static void *flip_work(void *argument) {
    struct flip_job *job = argument;
    struct flip_tile tile;
    double *memory = flip_tile_init(&tile, job->filters->radius);
    if (!memory) {
        __atomic_store_n(&job->out_of_memory, true, __ATOMIC_RELAXED);
        return NULL;
    }
    for (;;) {
        int number = __atomic_fetch_add(&job->next_tile, 1, __ATOMIC_RELAXED);
        if (number >= job->tile_count)
            break;
        tile.x = number % job->tiles_across * TILE_WIDTH;
        tile.y = number / job->tiles_across * TILE_HEIGHT;
        tile.width = job->width - tile.x < TILE_WIDTH ? job->width - tile.x : TILE_WIDTH;
        tile.height = job->height - tile.y < TILE_HEIGHT ? job->height - tile.y : TILE_HEIGHT;
        flip_tile_compare(job, &tile);
    }
    free(memory);
    return NULL;
}

bool flip_compare(const float *const reference[3], const float *const test[3], int width,
                  int height, double pixels_per_degree, float *map, struct flip_summary *summary,
                  struct status *status) {
    if (!(pixels_per_degree >= 1 && pixels_per_degree <= FLIP_PIXELS_PER_DEGREE_MAX))
        return status_fail(status, STATUS_INVALID, "FLIP needs 1 to %g pixels per degree, not %g",
                           FLIP_PIXELS_PER_DEGREE_MAX, pixels_per_degree);
    struct flip_filters *filters = memory_get(1, sizeof *filters);
    flip_contrast_init(filters, pixels_per_degree);
    flip_features_init(filters, pixels_per_degree);
    flip_colors_init(filters);
    filters->radius = filters->contrast_radius > filters->feature_radius ? filters->contrast_radius
                                                                         : filters->feature_radius;
    int across = (width - 1) / TILE_WIDTH + 1, down = (height - 1) / TILE_HEIGHT + 1;
    struct flip_job job = {.planes = {reference, test},
                           .width = width,
                           .height = height,
                           .map = map,
                           .filters = filters,
                           .tiles_across = across,
                           .tile_count = across * down};
    pthread_t threads[FLIP_THREADS - 1];
    int started = 0;
    while (started < FLIP_THREADS - 1 && started < job.tile_count - 1 &&
           pthread_create(&threads[started], NULL, flip_work, &job) == 0)
        started++;
    flip_work(&job);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    free(filters);
    if (job.out_of_memory)
        return status_fail(status, STATUS_LIMIT, "out of memory for FLIP");
    flip_summarize(map, (size_t)width * (size_t)height, summary);
    return true;
}

/* The bits of non-negative floats are in the order of their values: two rounds of 65536 buckets
 * find the weighted median without sorting. */
static double flip_weighted_median(const float *map, size_t count, double total) {
    double *weights = memory_get(65536, sizeof *weights), below = 0;
    uint32_t prefix = 0;
    for (int round = 0; round < 2; round++) {
        memset(weights, 0, 65536 * sizeof *weights);
        for (size_t i = 0; i < count; i++) {
            uint32_t bits;
            memcpy(&bits, &map[i], sizeof bits);
            if (round == 0)
                weights[bits >> 16] += map[i];
            else if (bits >> 16 == prefix >> 16)
                weights[bits & 0xffff] += map[i];
        }
        uint32_t bucket = 0, last = 0;
        for (; bucket < 65536; bucket++) {
            if (weights[bucket] == 0)
                continue;
            last = bucket;
            if (below + weights[bucket] >= 0.5 * total)
                break;
            below += weights[bucket];
        }
        bucket = bucket < 65536 ? bucket : last;
        prefix = round == 0 ? bucket << 16 : prefix | bucket;
    }
    free(weights);
    float median;
    memcpy(&median, &prefix, sizeof median);
    return median;
}

void flip_summarize(const float *map, size_t count, struct flip_summary *summary) {
    double total = 0, max = 0;
    for (size_t i = 0; i < count; i++) {
        total += map[i];
        max = map[i] > max ? map[i] : max;
    }
    *summary = (struct flip_summary){.mean = total / (double)count, .max = max};
    if (total > 0)
        summary->weighted_median = flip_weighted_median(map, count, total);
}

void flip_color(float error, double rgb[3]) {
    /* Matt Zucker's fit of matplotlib's magma, in the public domain. */
    static const double fit[7][3] = {
        {-0.002136485053939582, -0.000749655052795221, -0.005386127855323933},
        {0.2516605407371642, 0.6775232436837668, 2.494026599312351},
        {8.353717279216625, -3.577719514958484, 0.3144679030132573},
        {-27.66873308576866, 14.26473078096533, -13.64921318813922},
        {52.17613981234068, -27.94360607168351, 12.94416944238394},
        {-50.76852536473588, 29.04658282127291, 4.23415299384598},
        {18.65570506591883, -11.48977351997711, -5.601961508734096}};
    double t = flip_clamp(error);
    for (int c = 0; c < 3; c++) {
        double value = 0;
        for (int i = 6; i >= 0; i--)
            value = value * t + fit[i][c];
        rgb[c] = value > 0 ? value < 1 ? value : 1 : 0;
    }
}
