/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/slot_formats.h"

#include "images/half.h"
#include "nodes/vertex_components.h"
#include "shaders/compiler/parameter_precision.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { EXPONENT_MIN = -128, EXPONENT_MAX = 127, HALF_BITS = 16 };

/* The values that one component has at vertices. */
struct extent {
    float lowest, highest;
};

static void extend(struct extent *extent, const struct vertex_component *component, size_t count) {
    count = component->stride ? count : count > 0;
    for (size_t v = 0; v < count; v++) {
        const float value = component->values[v * component->stride];
        if (isfinite(value)) {
            extent->lowest = fminf(extent->lowest, value);
            extent->highest = fmaxf(extent->highest, value);
        }
    }
}

struct slot_format slot_format_for(int bits, float lowest, float highest) {
    const bool is_unsigned = lowest >= 0;
    const int magnitude_bits = bits - !is_unsigned;
    const double largest = fmax(fabs((double)lowest), fabs((double)highest));
    const double span = ldexp(1, magnitude_bits);
    int exponent = EXPONENT_MAX;
    while (exponent > EXPONENT_MIN && ldexp(largest, exponent) > span)
        exponent--;
    return (struct slot_format){.rounding = SLOT_FIXED,
                                .bits = (uint8_t)bits,
                                .is_unsigned = is_unsigned,
                                .exponent = (int8_t)exponent};
}

static void choose_for_parameter(const struct shader_parameter *parameter,
                                 enum parameter_precision precision, const struct extent *extents,
                                 struct slot_format *formats) {
    if (!parameter->is_material || !parameter_precision_applies(parameter))
        return;
    const int bits = parameter_precision_bits(precision, parameter);
    for (int c = 0; c < parameter->components; c++) {
        const int slot = parameter->map_offset + c;
        formats[slot] = precision == PARAMETERS_HALF
                            ? (struct slot_format){.rounding = SLOT_HALF, .bits = HALF_BITS}
                            : slot_format_for(bits, extents[slot].lowest, extents[slot].highest);
    }
}

void slot_formats_choose(const struct scene_frame *frame, const struct frame_plan *plan,
                         enum parameter_precision precision, struct slot_formats *formats) {
    formats->instance_count = plan->instance_count;
    formats->instances = memory_get(plan->instance_count, sizeof *formats->instances);
    struct extent **extents = memory_get(plan->instance_count, sizeof *extents);
    for (size_t i = 0; i < plan->instance_count; i++) {
        const size_t count = (size_t)plan->instances[i].variant->program->material_count;
        formats->instances[i] = memory_get(count, sizeof **formats->instances);
        extents[i] = memory_get(count, sizeof **extents);
    }
    const bool is_fixed = precision != PARAMETERS_FLOAT && precision != PARAMETERS_HALF;
    for (size_t m = 0; is_fixed && m < frame->mesh_count; m++) {
        const size_t i = plan->mesh_instance[m] - 1u;
        struct vertex_components components;
        vertex_components_list(&frame->meshes[m], plan->instances[i].variant->program, &components);
        for (uint32_t c = 0; c < components.count; c++)
            extend(&extents[i][c], &components.list[c], frame->meshes[m].vertex_count);
        vertex_components_finish(&components);
    }
    for (size_t i = 0; i < plan->instance_count; i++) {
        const struct shader_program *program = plan->instances[i].variant->program;
        for (int p = 0; precision != PARAMETERS_FLOAT && p < program->parameter_count; p++)
            choose_for_parameter(&program->parameters[p], precision, extents[i],
                                 formats->instances[i]);
        free(extents[i]);
    }
    free(extents);
}

void slot_formats_finish(struct slot_formats *formats) {
    for (size_t i = 0; i < formats->instance_count; i++)
        free(formats->instances[i]);
    free(formats->instances);
    *formats = (struct slot_formats){0};
}

static void round_to_halves(float *values, uint32_t count) {
    uint64_t clamped = 0;
    for (uint32_t k = 0; k < count; k++)
        values[k] = half_to_float(half_from_float(values[k], &clamped));
}

static void round_to_fixed(struct slot_format format, float *values, uint32_t count) {
    const double scale = ldexp(1, format.exponent), step = ldexp(1, -format.exponent);
    const double span = ldexp(1, format.bits - !format.is_unsigned);
    /* one format has -2^128 */
    const double least = format.is_unsigned ? 0 : fmax(-span, -FLT_MAX * scale), most = span - 1;
    for (uint32_t k = 0; k < count; k++) {
        const double raw = rint((double)values[k] * scale);
        /* not a number is neither */
        values[k] = raw >= most    ? (float)(most * step)
                    : raw >= least ? (float)(raw * step)
                    : raw < least  ? (float)(least * step)
                                   : 0;
    }
}

void slot_format_round(struct slot_format format, float *values, uint32_t count) {
    if (format.rounding == SLOT_HALF)
        round_to_halves(values, count);
    else if (format.rounding == SLOT_FIXED)
        round_to_fixed(format, values, count);
}
