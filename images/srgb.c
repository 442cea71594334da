/* SPDX-License-Identifier: Apache-2.0 */
#include "images/srgb.h"

#include <math.h>

double srgb_to_linear(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

void srgb_codes_init(struct srgb_codes *codes) {
    codes->limits[0] = -INFINITY;
    for (int code = 1; code < 256; code++) {
        double limit = srgb_to_linear((code - 0.5) / 255);
        float rounded = (float)limit;
        codes->limits[code] = rounded < limit ? nextafterf(rounded, 2) : rounded;
    }
}

uint8_t srgb_code(const struct srgb_codes *codes, float linear) {
    int code = 0;
    for (int step = 128; step; step >>= 1)
        if (linear >= codes->limits[code + step])
            code += step;
    return (uint8_t)code;
}
