/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REFERENCE_BATCH_H
#define REFERENCE_BATCH_H

#include "shaders/simd/shader_module.h"

/* A batch of samples for a module that computes in double precision (real_bytes 8): the planes of a
 * batch of floats, widened, and its colours, rounded back once. */
struct reference_batch {
    size_t samples, material_capacity, light_capacity;
    double *planes;
    const double **material;
    double *position[3], *incident[3], *color[3], *opacity[3];
    double *light_scratch;
};

/* Room for batches of `samples` samples and that many vectors of results of lights, kept from one
 * call to the next. */
void reference_batch_reserve(struct reference_batch *batch, size_t samples, size_t material_count,
                             size_t light_vectors);
void reference_batch_finish(struct reference_batch *batch);
/* Shades what `call` describes in floats; positions and directions are those already in the batch,
 * `padded` samples of them. Fills the colours of `call`, and its overrun. */
void reference_batch_shade(struct reference_batch *batch, const struct shader_module *module,
                           struct shader_call *call, size_t padded);

#endif
