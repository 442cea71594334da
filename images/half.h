/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_HALF_H
#define IMAGES_HALF_H

#include <stdint.h>
#include <string.h>

/* IEEE 754 binary16, converted with integers so that every machine gives the same bits, NaN
 * payloads included: all 65536 halfs survive the way to float and back. */

/* Exact. */
static inline float half_to_float(uint16_t half) {
    uint32_t sign = (uint32_t)(half & 0x8000) << 16, exponent = half & 0x7c00,
             mantissa = half & 0x3ff;
    uint32_t bits;
    if (exponent == 0x7c00) {
        bits = sign | 0x7f800000 | mantissa << 13;
    } else if (exponent) {
        bits = sign | (((uint32_t)(half & 0x7fff) << 13) + 0x38000000);
    } else {
        float magnitude = (float)mantissa * 0x1p-24f;
        memcpy(&bits, &magnitude, sizeof bits);
        bits |= sign;
    }
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Rounds to nearest even. Finite values beyond 65504, the largest half, become 65504 and add one to
 * *clamped; infinities stay infinite; a NaN stays a NaN, with the upper bits of its payload where
 * they are not all zero. */
static inline uint16_t half_from_float(float value, uint64_t *clamped) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000, magnitude = bits & 0x7fffffff;
    if (magnitude > 0x7f800000) {
        uint32_t payload = magnitude >> 13 & 0x3ff;
        return (uint16_t)(sign | 0x7c00 | (payload ? payload : 0x200));
    }
    if (magnitude == 0x7f800000)
        return (uint16_t)(sign | 0x7c00);
    if (magnitude > 0x477fe000) {
        ++*clamped;
        return (uint16_t)(sign | 0x7bff);
    }
    if (magnitude < 0x38800000) {
        /* Below 2^-14 a half counts in steps of 2^-24, as a float between 0.5 and 1 does: the sum
         * rounds. */
        float sum;
        memcpy(&sum, &magnitude, sizeof sum);
        sum += 0.5f;
        memcpy(&magnitude, &sum, sizeof magnitude);
        return (uint16_t)(sign | (magnitude - 0x3f000000));
    }
    magnitude += 0xfff + (magnitude >> 13 & 1);
    return (uint16_t)(sign | (magnitude - 0x38000000) >> 13);
}

#endif
