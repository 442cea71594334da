/* SPDX-License-Identifier: Apache-2.0 */
#include "reference_metrics.h"

#include <math.h>
#include <stdlib.h>

struct color {
    double v[3];
};

static double unit(double value) {
    return fmin(fmax(value, 0), 1);
}

/* The decimal sRGB matrix and white of the standard, not the fractions of the implementation. */
static struct color xyz_of(struct color c) {
    return (struct color){{0.4124 * c.v[0] + 0.3576 * c.v[1] + 0.1805 * c.v[2],
                           0.2126 * c.v[0] + 0.7152 * c.v[1] + 0.0722 * c.v[2],
                           0.0193 * c.v[0] + 0.1192 * c.v[1] + 0.9505 * c.v[2]}};
}

static struct color rgb_of(struct color c) {
    return (struct color){{3.2406 * c.v[0] - 1.5372 * c.v[1] - 0.4986 * c.v[2],
                           -0.9689 * c.v[0] + 1.8758 * c.v[1] + 0.0415 * c.v[2],
                           0.0557 * c.v[0] - 0.2040 * c.v[1] + 1.0570 * c.v[2]}};
}

static const double white[3] = {0.9505, 1, 1.089};

static struct color ycxcz_of(struct color rgb) {
    struct color c = xyz_of(rgb);
    double x = c.v[0] / white[0], y = c.v[1] / white[1], z = c.v[2] / white[2];
    return (struct color){{116 * y - 16, 500 * (x - y), 200 * (y - z)}};
}

static struct color linear_of_ycxcz(struct color c) {
    double y = (c.v[0] + 16) / 116;
    return rgb_of((struct color){
        {(y + c.v[1] / 500) * white[0], y * white[1], (y - c.v[2] / 200) * white[2]}});
}

static double lab_curve(double t) {
    return t > pow(6.0 / 29, 3) ? pow(t, 1.0 / 3) : t / (3 * 36.0 / 841) + 4.0 / 29;
}

static struct color hunt_lab_of(struct color rgb) {
    struct color c = xyz_of(rgb);
    double x = lab_curve(c.v[0] / white[0]), y = lab_curve(c.v[1] / white[1]),
           z = lab_curve(c.v[2] / white[2]);
    double lightness = 116 * y - 16;
    return (struct color){
        {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)}};
}

static double hyab(struct color a, struct color b) {
    return fabs(a.v[0] - b.v[0]) + hypot(a.v[1] - b.v[1], a.v[2] - b.v[2]);
}

static struct color pixel_of(const float *const planes[3], int width, int height, int x, int y) {
    x = x < 0 ? 0 : x >= width ? width - 1 : x;
    y = y < 0 ? 0 : y >= height ? height - 1 : y;
    struct color c;
    for (int i = 0; i < 3; i++)
        c.v[i] = unit(planes[i][y * width + x]);
    return ycxcz_of(c);
}

static double contrast(int channel, double degrees_squared) {
    static const double a[3][2] = {{1, 0}, {1, 0}, {34.1, 13.5}};
    static const double b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
    double sum = 0;
    for (int i = 0; i < 2; i++)
        sum += a[channel][i] * sqrt(M_PI / b[channel][i]) *
               exp(-M_PI * M_PI * degrees_squared / b[channel][i]);
    return sum;
}

static struct color filtered(const float *const planes[3], int width, int height, int x, int y,
                             double ppd) {
    int radius = (int)ceil(3 * sqrt(0.04 / (2 * M_PI * M_PI)) * ppd);
    struct color sum = {{0}}, weights = {{0}};
    for (int j = -radius; j <= radius; j++)
        for (int i = -radius; i <= radius; i++) {
            struct color c = pixel_of(planes, width, height, x + i, y + j);
            for (int k = 0; k < 3; k++) {
                double weight = contrast(k, (i * i + j * j) / (ppd * ppd));
                sum.v[k] += weight * c.v[k];
                weights.v[k] += weight;
            }
        }
    for (int k = 0; k < 3; k++)
        sum.v[k] /= weights.v[k];
    struct color rgb = linear_of_ycxcz(sum);
    for (int k = 0; k < 3; k++)
        rgb.v[k] = unit(rgb.v[k]);
    return hunt_lab_of(rgb);
}

/* The length of the response to edges, or with `points` to points, in both directions. */
static double feature(const float *const planes[3], int width, int height, int x, int y, double ppd,
                      int points) {
    double deviation = 0.5 * 0.082 * ppd, sums[2][2] = {{0}}, weights[2] = {0};
    int radius = (int)ceil(3 * deviation);
    for (int j = -radius; j <= radius; j++)
        for (int i = -radius; i <= radius; i++) {
            double gauss = exp(-(i * i + j * j) / (2 * deviation * deviation));
            double kernel = (points ? i * i / (deviation * deviation) - 1 : -i) * gauss;
            int negative = kernel < 0;
            weights[negative] += fabs(kernel);
            sums[0][negative] +=
                kernel * (pixel_of(planes, width, height, x + i, y + j).v[0] + 16) / 116;
            sums[1][negative] +=
                kernel * (pixel_of(planes, width, height, x + j, y + i).v[0] + 16) / 116;
        }
    return hypot(sums[0][0] / weights[0] + sums[0][1] / weights[1],
                 sums[1][0] / weights[0] + sums[1][1] / weights[1]);
}

void reference_flip(const float *const a[3], const float *const b[3], int width, int height,
                    double ppd, double *map) {
    double largest = pow(
        hyab(hunt_lab_of((struct color){{0, 1, 0}}), hunt_lab_of((struct color){{0, 0, 1}})), 0.7);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            double color = pow(
                hyab(filtered(a, width, height, x, y, ppd), filtered(b, width, height, x, y, ppd)),
                0.7);
            color = color < 0.4 * largest ? 0.95 * color / (0.4 * largest)
                                          : 0.95 + 0.05 * (color / largest - 0.4) / 0.6;
            double edge = fabs(feature(a, width, height, x, y, ppd, 0) -
                               feature(b, width, height, x, y, ppd, 0));
            double point = fabs(feature(a, width, height, x, y, ppd, 1) -
                                feature(b, width, height, x, y, ppd, 1));
            map[y * width + x] = pow(color, 1 - pow(fmax(edge, point) / sqrt(2), 0.5));
        }
}

static double luma_of(const float *const planes[3], int at) {
    double y =
        0.2126 * unit(planes[0][at]) + 0.7152 * unit(planes[1][at]) + 0.0722 * unit(planes[2][at]);
    return y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1 / 2.4) - 0.055;
}

double reference_ssim(const float *const a[3], const float *const b[3], int width, int height) {
    double total = 0;
    for (int y = 5; y < height - 5; y++)
        for (int x = 5; x < width - 5; x++) {
            double mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, cov = 0, sum = 0;
            for (int pass = 0; pass < 2; pass++)
                for (int j = -5; j <= 5; j++)
                    for (int i = -5; i <= 5; i++) {
                        double weight = exp(-(i * i + j * j) / 4.5);
                        double u = luma_of(a, (y + j) * width + x + i);
                        double v = luma_of(b, (y + j) * width + x + i);
                        if (pass == 0) {
                            mean_a += weight * u;
                            mean_b += weight * v;
                            sum += weight;
                        } else {
                            var_a += weight / sum * (u - mean_a / sum) * (u - mean_a / sum);
                            var_b += weight / sum * (v - mean_b / sum) * (v - mean_b / sum);
                            cov += weight / sum * (u - mean_a / sum) * (v - mean_b / sum);
                        }
                    }
            mean_a /= sum;
            mean_b /= sum;
            total += (2 * mean_a * mean_b + 1e-4) * (2 * cov + 9e-4) /
                     ((mean_a * mean_a + mean_b * mean_b + 1e-4) * (var_a + var_b + 9e-4));
        }
    return total / ((width - 10.0) * (height - 10.0));
}
