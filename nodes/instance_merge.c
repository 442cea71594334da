/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/instance_merge.h"

#include <string.h>

static bool is_loaded(const struct shader_module *module, int slot) {
    for (int i = 0; i < module->loaded_count; i++)
        if (module->loaded[i] == slot)
            return true;
    return false;
}

static bool same_uniform(const struct prepared_shader *a, const struct prepared_shader *b) {
    const struct shader_module *module = a->module;
    const size_t bytes = (size_t)module->real_bytes;
    const char *x = (const char *)a->uniform, *y = (const char *)b->uniform;
    for (int slot = 0; slot < module->uniform_count; slot++)
        if (memcmp(x + (size_t)slot * bytes, y + (size_t)slot * bytes, bytes) &&
            !is_loaded(module, slot))
            return false;
    return true;
}

static bool same_arrays(const void *a, size_t a_bytes, const void *b, size_t b_bytes) {
    return a_bytes == b_bytes && (!a_bytes || !memcmp(a, b, a_bytes));
}

/* Matrices and lights are uniform values, too. */
static bool same_surroundings(const struct instance_payload *a, const struct instance_payload *b) {
    enum { MATRIX_BYTES = 32 * sizeof(float) };
    return a->spaces == b->spaces &&
           same_arrays(a->matrices, (size_t)__builtin_popcount(a->spaces) * MATRIX_BYTES,
                       b->matrices, (size_t)__builtin_popcount(b->spaces) * MATRIX_BYTES) &&
           same_arrays(a->names, a->named_count * sizeof *a->names, b->names,
                       b->named_count * sizeof *b->names) &&
           same_arrays(a->named_matrices, a->named_count * MATRIX_BYTES, b->named_matrices,
                       b->named_count * MATRIX_BYTES) &&
           same_arrays(a->lights, a->light_count * sizeof *a->lights, b->lights,
                       b->light_count * sizeof *b->lights) &&
           same_arrays(a->texts, a->text_bytes, b->texts, b->text_bytes);
}

void instance_merge(struct prepared_shader *const *instances, size_t count, uint32_t *leaders) {
    for (size_t i = 0; i < count; i++) {
        leaders[i] = (uint32_t)i;
        for (size_t j = 0; j < i && leaders[i] == i; j++)
            if (leaders[j] == j && instances[j]->module == instances[i]->module &&
                same_surroundings(&instances[j]->payload, &instances[i]->payload) &&
                same_uniform(instances[j], instances[i]))
                leaders[i] = (uint32_t)j;
    }
}
