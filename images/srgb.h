/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_SRGB_H
#define IMAGES_SRGB_H

#include <stdint.h>

/* The transfer curve of IEC 61966-2-1 between linear values and display values, both in [0,1]. */
double srgb_to_linear(double encoded);
double srgb_from_linear(double linear);

/* Linear values to the nearest 8-bit code without a power per pixel: limits[k] is the smallest
 * float that rounds to code k or above. */
struct srgb_codes {
    float limits[256];
};
void srgb_codes_init(struct srgb_codes *codes);
/* Values below 0 and NaN give 0, values above 1 give 255. */
uint8_t srgb_code(const struct srgb_codes *codes, float linear);

#endif
