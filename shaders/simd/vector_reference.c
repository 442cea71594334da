/* SPDX-License-Identifier: Apache-2.0 */
#include "vector_reference.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static double reference_round(double x) {
    return round(x);
}

static double reference_inversesqrt(double x) {
    return 1.0 / sqrt(x);
}

static double reference_mod(double a, double b) {
    if (b == 0.0 && isfinite(a))
        return 0.0;
    if (!isfinite(a) || !isfinite(b))
        return NAN;
    double rest = fmod(a, b);
    return rest != 0.0 && (rest < 0.0) != (b < 0.0) ? rest + b : rest;
}

static double reference_min(double a, double b) {
    return a < b ? a : b;
}

static double reference_max(double a, double b) {
    return a > b ? a : b;
}

const struct vector_reference vector_references[] = {
    {"sqrt", 1, 1, sqrt, NULL},
    {"abs", 1, 0, fabs, NULL},
    {"floor", 1, 1, floor, NULL},
    {"ceil", 1, 1, ceil, NULL},
    {"round", 1, 1, reference_round, NULL},
    {"inversesqrt", 1, 0, reference_inversesqrt, NULL},
    {"sin", 1, 0, sin, NULL},
    {"cos", 1, 0, cos, NULL},
    {"tan", 1, 0, tan, NULL},
    {"asin", 1, 1, asin, NULL},
    {"acos", 1, -1, acos, NULL},
    {"atan", 1, 1, atan, NULL},
    {"exp", 1, 1, exp, NULL},
    {"exp2", 1, 1, exp2, NULL},
    {"log", 1, 1, log, NULL},
    {"log2", 1, 1, log2, NULL},
    {"min", 2, 0, NULL, reference_min},
    {"max", 2, 0, NULL, reference_max},
    {"mod", 2, 0, NULL, reference_mod},
    {"atan2", 2, 0, NULL, atan2},
    {"pow", 2, 0, NULL, pow},
};
const int vector_reference_count = sizeof vector_references / sizeof *vector_references;

const struct vector_reference *vector_reference_find(const char *name) {
    size_t length = strlen(name);
    if (length > 5 && strcmp(name + length - 5, "_fast") == 0)
        length -= 5;
    for (int i = 0; i < vector_reference_count; i++)
        if (strlen(vector_references[i].name) == length &&
            strncmp(vector_references[i].name, name, length) == 0)
            return &vector_references[i];
    return NULL;
}

double vector_ulp_error(float result, double reference) {
    if (isnan(reference) || isnan(result))
        return isnan(reference) && isnan(result) ? 0.0 : INFINITY;
    double value = (double)result;
    if (isinf(value))
        value = copysign(0x1p128, value);
    if (isinf(reference) || fabs(reference) > 0x1p128)
        reference = copysign(0x1p128, reference);
    /* 2^-23 of the power of two at or below |reference|, which is that of a normal float at least
     */
    double size = fabs(reference);
    if (size >= 0x1p128)
        size = 0x1.fp127;
    if (size < 0x1p-126)
        size = 0x1p-126;
    uint64_t bits;
    memcpy(&bits, &size, sizeof bits);
    bits = (bits & 0x7ff0000000000000u) - ((uint64_t)23 << 52);
    double ulp;
    memcpy(&ulp, &bits, sizeof ulp);
    return fabs(value - reference) / ulp;
}

/* ---- noise, after Perlin's reference implementation of 2002 ---- */

static const int permutation[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103,
    30,  69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,
    197, 62,  94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174,
    20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231,
    83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143,
    54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196,
    135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124,
    123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,
    182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101,
    155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185,
    112, 104, 218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,
    51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176,
    115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114, 67,  29,  24,  72,  243,
    141, 128, 195, 78,  66,  215, 61,  156, 180};

static double fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

static double lerp(double t, double a, double b) {
    return a + t * (b - a);
}

static double gradient(int hash, double x, double y, double z) {
    int h = hash & 15;
    double u = h < 8 ? x : y, v = h < 4 ? y : h == 12 || h == 14 ? x : z;
    return ((h & 1) == 0 ? u : -u) + ((h & 2) == 0 ? v : -v);
}

/* The cell of x modulo 256, and the position in it. */
static int cell(double *x) {
    double down = floor(*x), wrapped = fmod(down, 256.0);
    *x -= down;
    return (int)(wrapped < 0.0 ? wrapped + 256.0 : wrapped);
}

static int permute(int i) {
    return permutation[i & 255];
}

double vector_reference_noise(double x, double y, double z) {
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return NAN;
    int i = cell(&x), j = cell(&y), k = cell(&z);
    double u = fade(x), v = fade(y), w = fade(z);
    int a = permute(i) + j, aa = permute(a) + k, ab = permute(a + 1) + k;
    int b = permute(i + 1) + j, ba = permute(b) + k, bb = permute(b + 1) + k;
    return lerp(
        w,
        lerp(v, lerp(u, gradient(permute(aa), x, y, z), gradient(permute(ba), x - 1, y, z)),
             lerp(u, gradient(permute(ab), x, y - 1, z), gradient(permute(bb), x - 1, y - 1, z))),
        lerp(v,
             lerp(u, gradient(permute(aa + 1), x, y, z - 1),
                  gradient(permute(ba + 1), x - 1, y, z - 1)),
             lerp(u, gradient(permute(ab + 1), x, y - 1, z - 1),
                  gradient(permute(bb + 1), x - 1, y - 1, z - 1))));
}
