/* SPDX-License-Identifier: Apache-2.0 */
#include "images/ssim.h"

#include "images/srgb.h"

#include <math.h>
#include <stdlib.h>

enum { WINDOW = 11, MOMENTS = 5 }; /* the means of x, y, xx, yy, xy */

struct ssim {
    const float *const *planes[2];
    int width, height;
    int taps_across, taps_down;
    double across[WINDOW], down[WINDOW];
    double *luminance[2];          /* one row */
    double *rows[WINDOW][MOMENTS]; /* the last rows, filtered across */
};

static void ssim_gaussian(double *taps, int count) {
    double sum = 0, middle = (count - 1) * 0.5;
    for (int i = 0; i < count; i++)
        sum += taps[i] = exp(-(i - middle) * (i - middle) / (2 * 1.5 * 1.5));
    for (int i = 0; i < count; i++)
        taps[i] /= sum;
}

static double ssim_clamp(double value) {
    return value > 0 ? value < 1 ? value : 1 : 0;
}

static void ssim_row(struct ssim *ssim, int y) {
    double *const *moments = ssim->rows[y % WINDOW];
    for (int image = 0; image < 2; image++)
        for (int x = 0; x < ssim->width; x++) {
            size_t at = (size_t)y * (size_t)ssim->width + (size_t)x;
            const float *const *planes = ssim->planes[image];
            double luminance = 0.2126 * ssim_clamp(planes[0][at]) +
                               0.7152 * ssim_clamp(planes[1][at]) +
                               0.0722 * ssim_clamp(planes[2][at]);
            ssim->luminance[image][x] = srgb_from_linear(luminance);
        }
    for (int x = 0; x <= ssim->width - ssim->taps_across; x++) {
        double sums[MOMENTS] = {0};
        for (int k = 0; k < ssim->taps_across; k++) {
            double a = ssim->luminance[0][x + k], b = ssim->luminance[1][x + k];
            const double values[MOMENTS] = {a, b, a * a, b * b, a * b};
            for (int m = 0; m < MOMENTS; m++)
                sums[m] += ssim->across[k] * values[m];
        }
        for (int m = 0; m < MOMENTS; m++)
            moments[m][x] = sums[m];
    }
}

/* The window whose last row is y and whose first column is x. */
static double ssim_window(const struct ssim *ssim, int x, int y) {
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double m[MOMENTS] = {0};
    for (int k = 0; k < ssim->taps_down; k++)
        for (int i = 0; i < MOMENTS; i++)
            m[i] += ssim->down[k] * ssim->rows[(y - ssim->taps_down + 1 + k) % WINDOW][i][x];
    double variance_a = m[2] - m[0] * m[0], variance_b = m[3] - m[1] * m[1];
    double covariance = m[4] - m[0] * m[1];
    return (2 * m[0] * m[1] + c1) * (2 * covariance + c2) /
           ((m[0] * m[0] + m[1] * m[1] + c1) * (variance_a + variance_b + c2));
}

bool ssim_compare(const float *const a[3], const float *const b[3], int width, int height,
                  double *mean, struct status *status) {
    struct ssim ssim = {.planes = {a, b}, .width = width, .height = height};
    ssim.taps_across = width < WINDOW ? width : WINDOW;
    ssim.taps_down = height < WINDOW ? height : WINDOW;
    ssim_gaussian(ssim.across, ssim.taps_across);
    ssim_gaussian(ssim.down, ssim.taps_down);
    double *memory = memory_try((size_t)width * (2 + WINDOW * MOMENTS), sizeof *memory, status);
    if (!memory)
        return false;
    for (int i = 0; i < 2 + WINDOW * MOMENTS; i++)
        *(i < 2 ? &ssim.luminance[i] : &ssim.rows[(i - 2) / MOMENTS][(i - 2) % MOMENTS]) =
            memory + (size_t)i * (size_t)width;
    double sum = 0;
    for (int y = 0; y < height; y++) {
        ssim_row(&ssim, y);
        for (int x = 0; y >= ssim.taps_down - 1 && x <= width - ssim.taps_across; x++)
            sum += ssim_window(&ssim, x, y);
    }
    free(memory);
    *mean = sum / ((double)(width - ssim.taps_across + 1) * (double)(height - ssim.taps_down + 1));
    return true;
}
