/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/parameter_precision.h"

const char *const parameter_precision_names[] = {
#define PRECISION_NAME(name, text, bits, small_bits) text,
    PARAMETER_PRECISIONS(PRECISION_NAME)
#undef PRECISION_NAME
        NULL};

static const struct {
    int bits, small_bits;
} sizes[] = {
#define PRECISION_SIZE(name, text, bits, small_bits) {bits, small_bits},
    PARAMETER_PRECISIONS(PRECISION_SIZE)
#undef PRECISION_SIZE
};

bool parameter_precision_applies(const struct shader_parameter *parameter) {
    return parameter->type != SHADER_FIXED && parameter->type != SHADER_STRING;
}

int parameter_precision_bits(enum parameter_precision precision,
                             const struct shader_parameter *parameter) {
    const bool is_small = parameter->type == SHADER_NORMAL || parameter->type == SHADER_COLOR;
    return is_small ? sizes[precision].small_bits : sizes[precision].bits;
}
