/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_FLIP_H
#define IMAGES_FLIP_H

#include "base/status.h"

/* LDR-FLIP: how visible a difference is to a person who flips between two images, from Andersson,
 * Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild: "FLIP: A Difference Evaluator for
 * Alternating Images", HPG 2020.
 *
 * Computed in double where the authors' programs use float: the color term grows with the 0.7th
 * power of the difference, so that float noise alone would be worth 1e-5. *
 * What is checked (tests/images/test_metrics.c): the whole map against a second writing of the
 * paper's definition with plain two-dimensional filters; constant colours against the closed form
 * (black against white 0.9674, green against blue 1); symmetry, growth with noise, visibly wrong
 * controls. The authors publish a mean of 0.159691 for their own pair of pictures, which is not in
 * this tree: that value is not checked.
 */

/* The paper's observer: 0.7 m from a screen of 3840 pixels on 0.7 m (67.02 pixels a degree). */
#define FLIP_PIXELS_PER_DEGREE (3840 * 0.017453292519943295)
#define FLIP_PIXELS_PER_DEGREE_MAX 1000.0

struct flip_summary {
    double mean;
    double weighted_median; /* half of the total error is in pixels up to this error */
    double max;
};

/* Planes of linear sRGB, width * height each, red, green, blue; values are clamped to [0,1] and NaN
 * counts as 0. `map` takes the error of each pixel in [0,1]. Fails for want of memory or for a
 * resolution outside [1, FLIP_PIXELS_PER_DEGREE_MAX]. */
bool flip_compare(const float *const reference[3], const float *const test[3], int width,
                  int height, double pixels_per_degree, float *map, struct flip_summary *summary,
                  struct status *status);
void flip_summarize(const float *map, size_t count, struct flip_summary *summary);

/* The colour of an error in [0,1] in the style of matplotlib's magma, as the authors show maps:
 * display values (not linear) in [0,1]. A polynomial of degree 6, 3/255 from the table on average.
 */
void flip_color(float error, double rgb[3]);

#endif
