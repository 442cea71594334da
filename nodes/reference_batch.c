/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/reference_batch.h"

#include "base/status.h"

#include <stdlib.h>
#include <string.h>

enum { PLANE_ALIGNMENT = 64, FIXED_PLANES = 12, VECTOR_LANES_MAX = 16 };

static double *numbers_create(size_t count) {
    double *numbers =
        aligned_alloc(PLANE_ALIGNMENT, (count * sizeof(double) + PLANE_ALIGNMENT - 1) /
                                           PLANE_ALIGNMENT * PLANE_ALIGNMENT);
    if (!numbers)
        abort();
    memset(numbers, 0, count * sizeof *numbers);
    return numbers;
}

void reference_batch_reserve(struct reference_batch *batch, size_t samples, size_t material_count,
                             size_t light_vectors) {
    if (!batch->planes || material_count > batch->material_capacity) {
        free(batch->planes);
        free(batch->material);
        batch->samples = samples;
        batch->material_capacity = material_count;
        batch->planes = numbers_create((material_count + FIXED_PLANES) * samples);
        batch->material = memory_get(material_count, sizeof *batch->material);
        double *next = batch->planes;
        for (int c = 0; c < 3; c++, next += samples) {
            batch->position[c] = next;
            batch->incident[c] = next + 3 * samples;
            batch->color[c] = next + 6 * samples;
            batch->opacity[c] = next + 9 * samples;
        }
        for (size_t p = 0; p < material_count; p++)
            batch->material[p] = batch->planes + (FIXED_PLANES + p) * samples;
    }
    if (!batch->light_scratch || light_vectors > batch->light_capacity) {
        free(batch->light_scratch);
        batch->light_capacity = light_vectors;
        batch->light_scratch = numbers_create((light_vectors + 1) * VECTOR_LANES_MAX);
    }
}

void reference_batch_finish(struct reference_batch *batch) {
    free(batch->planes);
    free(batch->material);
    free(batch->light_scratch);
    *batch = (struct reference_batch){0};
}

/* The module takes doubles where this file's declarations say float: shader_real. */
static float *as_real(double *numbers) {
    return (float *)(void *)numbers;
}

void reference_batch_shade(struct reference_batch *batch, const struct shader_module *module,
                           struct shader_call *call, size_t padded) {
    struct shader_call wide = *call;
    for (int p = 0; p < module->material_count; p++) {
        double *plane = batch->planes + (FIXED_PLANES + (size_t)p) * batch->samples;
        for (size_t k = 0; k < padded; k++)
            plane[k] = (double)call->material[p][k];
    }
    wide.material = (const float *const *)(const void *)batch->material;
    wide.light_scratch = as_real(batch->light_scratch);
    for (int c = 0; c < 3; c++) {
        wide.position[c] = as_real(batch->position[c]);
        wide.incident[c] = as_real(batch->incident[c]);
        wide.color[c] = as_real(batch->color[c]);
        wide.opacity[c] = as_real(batch->opacity[c]);
    }
    module->shade(&wide);
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < call->count; k++) {
            call->color[c][k] = (float)batch->color[c][k];
            call->opacity[c][k] = (float)batch->opacity[c][k];
        }
    call->overrun = wide.overrun;
}
