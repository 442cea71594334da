/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_SSIM_H
#define IMAGES_SSIM_H

#include "base/status.h"

/* Mean structural similarity (Wang, Bovik, Sheikh, Simoncelli, 2004) of luminance on the display
 * scale: an 11 x 11 Gaussian of deviation 1.5 over the windows that lie within the image, K1 =
 * 0.01, K2 = 0.03, range 1. Where the image is smaller than the window, the window is cut to the
 * image. Printed for comparison with other work, never a gate: it hides small coloured errors.
 *
 * Planes as in flip_compare. Fails only for want of memory. */
bool ssim_compare(const float *const a[3], const float *const b[3], int width, int height,
                  double *mean, struct status *status);

#endif
