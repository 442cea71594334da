/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VECTOR_REFERENCE_H
#define VECTOR_REFERENCE_H

/* What the functions of vector_math.h are measured against: the C library in double precision,
 * whose error is some 2^-29 of a float's ulp, and noise written out in double precision. */

struct vector_reference {
    const char
        *name; /* as in vector_math.h; the fast functions have the reference of the exact ones */
    int inputs;
    int monotone; /* 1: never decreases as x grows, -1: never increases, 0: neither */
    double (*f1)(double x);
    double (*f2)(double x, double y);
};

extern const struct vector_reference vector_references[];
extern const int vector_reference_count;

/* The reference of that name; a trailing "_fast" is ignored. NULL if there is none. */
const struct vector_reference *vector_reference_find(const char *name);

/* Perlin's improved noise, signed. */
double vector_reference_noise(double x, double y, double z);

/* |result - reference| in units of a float's last place at the reference; where the reference is
 * beyond the floats, the next power of two stands for infinity. 0 if both are NaN, infinite if one
 * is. */
double vector_ulp_error(float result, double reference);

#endif
