/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SIMD_TEST_SAMPLES_H
#define SIMD_TEST_SAMPLES_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "shaders/simd/vector_kernels.h"
#include "shaders/simd/vector_reference.h"

/* Inputs of the tests: the same on every machine. Blocks hold SAMPLE_BLOCK floats. */
#define SAMPLE_BLOCK 4096

float sample_float(uint32_t bits);
uint32_t sample_bits(float x);

/* Block `block` of `blocks`: every float pattern range is hit evenly (each block spans all signs
 * and exponents), at a random place within each stratum. */
void sample_stratified(float *x, uint32_t block, uint32_t blocks);

/* Random bit patterns; numbers uniform in [low, high). `seed` and `block` choose the sequence. */
void sample_patterns(float *x, uint64_t seed, uint32_t block);
void sample_uniform(float *x, uint64_t seed, uint32_t block, double low, double high);

/* Zeros, denormals, ones, thresholds of every function and their neighbours, multiples of pi/2,
 * infinities, NaNs; both signs. Returns how many there are (at most SAMPLE_BLOCK). */
int sample_special(float *x);

#endif
