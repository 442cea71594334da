/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SCALAR_SHADERS_H
#define SCALAR_SHADERS_H

/* Shaders of shaders/library as a C programmer would write them by hand: one sample at a time,
 * plain floats, the C library's functions, Perlin's noise by its tables. Default parameters; one
 * ambient and one distant light; all spaces are camera space. What compiled shaders are measured
 * against. */

struct scalar_sample {
    float p[3], i[3], n[3], dpdu[3], dpdv[3], s, t;
};

struct scalar_lights {
    float ambient[3], color[3], direction[3]; /* from the light */
};

typedef void scalar_shader(const struct scalar_sample *sample, const struct scalar_lights *lights,
                           float color[3]);
scalar_shader scalar_matte, scalar_plastic, scalar_marble, scalar_planks, scalar_fancy_brick,
    scalar_ripple_reflection;

#endif
