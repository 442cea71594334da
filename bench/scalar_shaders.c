/* SPDX-License-Identifier: Apache-2.0 */
#include "scalar_shaders.h"

#include "shaders/simd/vector_permutation.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef const struct scalar_sample in;
typedef const struct scalar_lights with;

/* ---- Perlin's improved noise, 2002 ---- */

static int hash(int i) {
    return simd_permutation[i & 255];
}

static float fade(float t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

static float lerp(float t, float a, float b) {
    return a + t * (b - a);
}

static float gradient(int h, float x, float y, float z) {
    float u = (h & 8) ? y : x, v = (h & 12) == 0 ? y : (h & 13) == 12 ? x : z;
    return ((h & 1) ? -u : u) + ((h & 2) ? -v : v);
}

static float noise3(float x, float y, float z) {
    float fx = floorf(x), fy = floorf(y), fz = floorf(z);
    int i = (int)fx, j = (int)fy, k = (int)fz;
    x -= fx, y -= fy, z -= fz;
    float u = fade(x), v = fade(y), w = fade(z);
    int a = hash(i) + j, b = hash(i + 1) + j;
    int aa = hash(a) + k, ab = hash(a + 1) + k, ba = hash(b) + k, bb = hash(b + 1) + k;
    float low = lerp(v, lerp(u, gradient(hash(aa), x, y, z), gradient(hash(ba), x - 1, y, z)),
                     lerp(u, gradient(hash(ab), x, y - 1, z), gradient(hash(bb), x - 1, y - 1, z)));
    float high = lerp(
        v, lerp(u, gradient(hash(aa + 1), x, y, z - 1), gradient(hash(ba + 1), x - 1, y, z - 1)),
        lerp(u, gradient(hash(ab + 1), x, y - 1, z - 1),
             gradient(hash(bb + 1), x - 1, y - 1, z - 1)));
    return 0.5f + 0.5f * lerp(w, low, high);
}

static float noise2(float x, float y) {
    float fx = floorf(x), fy = floorf(y);
    int i = (int)fx, j = (int)fy;
    x -= fx, y -= fy;
    float u = fade(x);
    int a = hash(i) + j, b = hash(i + 1) + j;
    float low = lerp(u, gradient(hash(hash(a)), x, y, 0), gradient(hash(hash(b)), x - 1, y, 0));
    float high = lerp(u, gradient(hash(hash(a + 1)), x, y - 1, 0),
                      gradient(hash(hash(b + 1)), x - 1, y - 1, 0));
    return 0.5f + 0.5f * lerp(fade(y), low, high);
}

/* ---- helpers ---- */

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalize(const float a[3], float result[3]) {
    float scale = 1 / sqrtf(dot(a, a));
    for (int c = 0; c < 3; c++)
        result[c] = a[c] * scale;
}

static float clamp(float x, float low, float high) {
    return x < low ? low : x > high ? high : x;
}

static float smoothstep(float low, float high, float x) {
    float f = clamp((x - low) / (high - low), 0, 1);
    return f * f * (3 - 2 * f);
}

static float mix(float a, float b, float f) {
    return a + (b - a) * f;
}

static void mix3(const float a[3], const float b[3], float f, float result[3]) {
    for (int c = 0; c < 3; c++)
        result[c] = mix(a[c], b[c], f);
}

static float modulo(float a, float b) {
    return a - b * floorf(a / b);
}

static void face(const float normal[3], const float incident[3], float result[3]) {
    normalize(normal, result);
    if (dot(result, incident) > 0)
        for (int c = 0; c < 3; c++)
            result[c] = -result[c];
}

/* Towards the viewer and towards the light, and the cosines with the normal of the latter and of
 * the direction between. */
struct lit {
    float view[3], facing, between;
};

static struct lit light_up(in *x, with *lights, const float normal[3]) {
    struct lit lit;
    float towards[3], half[3];
    normalize(x->i, lit.view);
    normalize(lights->direction, towards);
    for (int c = 0; c < 3; c++) {
        lit.view[c] = -lit.view[c];
        towards[c] = -towards[c];
        half[c] = towards[c] + lit.view[c];
    }
    normalize(half, half);
    lit.facing = dot(normal, towards);
    lit.between = fmaxf(0, dot(normal, half));
    return lit;
}

static float facing(with *lights, const float normal[3]) {
    float towards[3];
    normalize(lights->direction, towards);
    return fmaxf(0, -dot(normal, towards));
}

/* ---- the shaders ---- */

void scalar_matte(in *x, with *lights, float color[3]) {
    float normal[3];
    face(x->n, x->i, normal);
    float diffuse = facing(lights, normal);
    for (int c = 0; c < 3; c++)
        color[c] = lights->ambient[c] + diffuse * lights->color[c];
}

void scalar_plastic(in *x, with *lights, float color[3]) {
    float normal[3];
    face(x->n, x->i, normal);
    struct lit lit = light_up(x, lights, normal);
    float shine = lit.facing > 0 ? powf(lit.between, 1 / 0.1f) : 0;
    for (int c = 0; c < 3; c++)
        color[c] =
            lights->ambient[c] + (0.5f * fmaxf(0, lit.facing) + 0.5f * shine) * lights->color[c];
}

void scalar_marble(in *x, with *lights, float color[3]) {
    static const float pale[3] = {0.80f, 0.78f, 0.74f}, dark[3] = {0.06f, 0.05f, 0.08f},
                       tint[3] = {0.50f, 0.42f, 0.36f};
    float q[3], cloud = 0, size = 1, stone[3], normal[3];
    for (int c = 0; c < 3; c++)
        q[c] = 2 * x->p[c];
    for (int octave = 0; octave < 6; octave++, size *= 0.5f)
        cloud += fabsf(noise3(q[0] / size, q[1] / size, q[2] / size) - 0.5f) * size;
    cloud *= 2;
    float wave = 0.5f + 0.5f * sinf(3.14159265f * (q[0] + 0.4f * q[1] + 1.5f * cloud));
    float vein = wave * wave;
    vein *= vein;
    vein *= vein;
    mix3(pale, tint, smoothstep(0.25f, 1.1f, cloud), stone);
    mix3(stone, dark, 0.85f * vein, stone);
    face(x->n, x->i, normal);
    struct lit lit = light_up(x, lights, normal);
    float front = fmaxf(0, lit.facing);
    float shine = powf(lit.between, 1 / 0.02f) * smoothstep(0, 0.05f, front);
    for (int c = 0; c < 3; c++)
        color[c] = stone[c] * (lights->ambient[c] + 0.8f * front * lights->color[c]) +
                   0.5f * shine * lights->color[c];
}

void scalar_planks(in *x, with *lights, float color[3]) {
    static const float light[3] = {0.62f, 0.40f, 0.20f}, dark[3] = {0.34f, 0.18f, 0.07f};
    const float width = 0.1f, length = 0.6f, gap = 0.003f, edge = 0.003f;
    float across = x->t / width, row = floorf(across);
    float shifted = x->s + length * noise2(row * 3.37f + 0.5f, 0);
    float column = floorf(shifted / length), along_plank = shifted - column * length;
    float y = (across - row) * width, id = noise2(row * 7.91f + 0.5f, column * 5.13f + 0.5f);
    float offset = id * 40, along = x->s / width + offset;
    float bend = noise2(along * 0.11f, across * 0.9f + offset);
    float ring = modulo(3 * (across + 2.2f * bend) + offset, 1);
    ring = smoothstep(0, 0.7f, ring) * (1 - smoothstep(0.78f, 1, ring));
    float fibres = noise2(along * 0.7f, across * 19 + offset) - 0.5f, wood[3], normal[3];
    mix3(light, dark, clamp(0.6f * ring + 0.5f * fibres + 1.5f * 0.3f * (id - 0.4f), 0, 1), wood);
    float joint = fminf(fminf(y, width - y), fminf(along_plank, length - along_plank));
    float inside = smoothstep(gap / 2 - edge, gap / 2 + edge, joint);
    float tone = (1 + 0.35f * fibres) * (1 + 2 * 0.3f * (id - 0.5f)) * (0.2f + 0.8f * inside);
    face(x->n, x->i, normal);
    struct lit lit = light_up(x, lights, normal);
    float front = fmaxf(0, lit.facing);
    float shine = powf(lit.between, 1 / 0.08f) * smoothstep(0, 0.05f, front);
    for (int c = 0; c < 3; c++) /* the varnish mirrors nothing by default */
        color[c] = tone * wood[c] * (lights->ambient[c] + 0.8f * front * lights->color[c]) +
                   inside * 0.25f * shine * lights->color[c];
}

static float profile(float x, float size, float mortar, float bevel, float *slope) {
    float centred = x - size / 2;
    float ramp = (size / 2 - mortar / 2 - fabsf(centred)) / bevel;
    *slope = ramp > 0 && ramp < 1 ? (centred > 0) - (centred < 0) : 0;
    return clamp(ramp, 0, 1);
}

void scalar_fancy_brick(in *x, with *lights, float color[3]) {
    static const float brick[3] = {0.52f, 0.17f, 0.11f}, mortar_color[3] = {0.62f, 0.58f, 0.52f};
    const float width = 0.25f, height = 0.1f, mortar = 0.012f, bevel = 0.008f, grain = 0.35f;
    float a = x->s / height, b = x->t / height, slope_s, slope_t;
    float fine = noise2(a * 22, b * 22) - 0.5f, coarse = noise2(a * 7, b * 7) - 0.5f;
    float row = floorf(b), ss = x->s + (modulo(row, 2) == 0 ? width / 2 : 0);
    float column = floorf(ss / width), fray = 0.5f * bevel * coarse;
    float on_s = profile(ss - column * width + fray, width, mortar, bevel, &slope_s);
    float on_t = profile(x->t - row * height + fray, height, mortar, bevel, &slope_t);
    float on_brick = smoothstep(0.1f, 0.9f, fminf(on_s, on_t));
    float tone = noise2(column * 7.13f + 0.5f, row * 5.77f + 0.5f) - 0.5f;
    float around = noise2(a * 1.3f + column * 3.7f, b * 1.3f + row * 9.1f);
    float streaks = noise2(a * 2 + around * 5, b * 4 + around * 3 + row * 4.3f) - 0.5f;
    float clay = 1 + 0.35f * 2 * tone + 0.4f * 2 * streaks, joint = 1 + 0.4f * coarse;
    float rounded = 0.7f * (1 - on_brick), bumped[3], du[3], dv[3], normal[3];
    normalize(x->n, bumped);
    normalize(x->dpdu, du);
    normalize(x->dpdv, dv);
    for (int c = 0; c < 3; c++)
        bumped[c] += du[c] * (rounded * slope_s + grain * fine) +
                     dv[c] * (rounded * slope_t + grain * coarse);
    face(bumped, x->i, normal);
    float diffuse = facing(lights, normal);
    for (int c = 0; c < 3; c++)
        color[c] = fmaxf(0, mix(mortar_color[c] * joint, brick[c] * clay, on_brick) *
                                (1 + grain * (fine + coarse))) *
                   (lights->ambient[c] + 0.9f * diffuse * lights->color[c]);
}

static void ripple(in *x, float cs, float ct, float frequency, float slope[2]) {
    float ds = x->s - cs, dt = x->t - ct, r = sqrtf(ds * ds + dt * dt) + 0.02f;
    float height = cosf(6.2831853f * (frequency * r)) / (1 + 3 * r * r);
    slope[0] += ds / r * height;
    slope[1] += dt / r * height;
}

static void environment_color(const float from[3], const float direction[3], float color[3]) {
    static const float sky[3] = {0.15f, 0.32f, 0.72f}, haze_color[3] = {0.75f, 0.80f, 0.86f},
                       cloud_color[3] = {1, 1, 1}, tile[3] = {0.75f, 0.12f, 0.08f},
                       other[3] = {0.92f, 0.90f, 0.85f};
    float rise = direction[1], down = fmaxf(-rise, 0.0001f), far = (from[1] + 2) / down;
    float fx = from[0] + far * direction[0], fz = from[2] + far * direction[2];
    float blur = clamp(0.02f * fabsf(far), 0.02f, 0.5f), floor_color[3], air[3];
    float ax = fabsf(modulo(fx - 0.5f, 2) - 1) - 0.5f, az = fabsf(modulo(fz - 0.5f, 2) - 1) - 0.5f;
    float check =
        0.5f - 0.5f * (2 * smoothstep(-blur, blur, ax) - 1) * (2 * smoothstep(-blur, blur, az) - 1);
    mix3(tile, other, check, floor_color);
    mix3(floor_color, haze_color, smoothstep(3, 30, fabsf(far)), floor_color);
    float high = fmaxf(rise, 0.05f);
    float cloud = noise3(2 * direction[0] / high, 3, 2 * direction[2] / high);
    cloud = smoothstep(0.5f, 0.8f, cloud) * smoothstep(0.05f, 0.3f, rise);
    mix3(haze_color, sky, smoothstep(0, 0.6f, rise), air);
    mix3(air, cloud_color, cloud, air);
    mix3(floor_color, air, smoothstep(-0.01f, 0.01f, rise), color);
}

void scalar_ripple_reflection(in *x, with *lights, float color[3]) {
    static const float tint[3] = {0.92f, 0.96f, 1};
    float slope[2] = {0, 0}, normal[3], du[3], dv[3], incoming[3], mirrored[3], seen[3];
    ripple(x, 0.35f, 0.4f, 9, slope);
    ripple(x, 0.7f, 0.65f, 9 * 1.3f, slope);
    normalize(x->n, normal);
    normalize(x->dpdu, du);
    normalize(x->dpdv, dv);
    for (int c = 0; c < 3; c++)
        normal[c] -= 0.12f * (slope[0] * du[c] + slope[1] * dv[c]);
    face(normal, x->i, normal);
    normalize(x->i, incoming);
    float along = 2 * dot(incoming, normal);
    for (int c = 0; c < 3; c++)
        mirrored[c] = incoming[c] - along * normal[c];
    normalize(mirrored, mirrored);
    environment_color(x->p, mirrored, seen);
    struct lit lit = light_up(x, lights, normal);
    float shine = lit.facing > 0 ? powf(lit.between, 1 / 0.02f) : 0;
    for (int c = 0; c < 3; c++)
        color[c] = tint[c] * seen[c] + 0.6f * shine * lights->color[c];
}
