/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TESTS_IMAGES_REFERENCE_METRICS_H
#define TESTS_IMAGES_REFERENCE_METRICS_H

/* FLIP and SSIM written down a second time, pixel by pixel with full two-dimensional filters as the
 * papers give them, sharing no code with images/. Planes of linear values, not clamped. Slow: 441
 * taps a pixel and filter. */
void reference_flip(const float *const a[3], const float *const b[3], int width, int height,
                    double pixels_per_degree, double *map);
double reference_ssim(const float *const a[3], const float *const b[3], int width, int height);

#endif
