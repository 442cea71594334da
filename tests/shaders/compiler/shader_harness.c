/* SPDX-License-Identifier: Apache-2.0 */
#include "shader_harness.h"

#include "base/simd_operations.h"
#include "compiled_object.h"

#include <dlfcn.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct shader_program *harness_compile(const char *source, const char *const *material,
                                       struct status *status) {
    struct shader_compile_options options = {
        .material = material, .exports = material, .allows_external = true};
    struct shader_program *program = NULL;
    int count = 0;
    while (material && material[count])
        count++;
    if (!strncmp(source, "light ", 6))
        options.export_count = count;
    else
        options.material_count = count;
    shader_compile("test.sl", source, strlen(source), &options, &program, status);
    return program;
}

/* The running sums that a node keeps: per block the sum over control paths of the largest trip
 * count. */
struct seen {
    uint32_t block;
    uint64_t key, trips;
};
static struct seen seen[4096];
static int seen_count;

static void report(struct shader_counters *counters, uint32_t block, uint64_t key, uint64_t trips) {
    assert_true(block < HARNESS_BLOCKS);
    for (int i = 0; i < seen_count; i++)
        if (seen[i].block == block && seen[i].key == key) {
            if (trips > seen[i].trips) {
                counters->block_executions[block] += trips - seen[i].trips;
                seen[i].trips = trips;
            }
            return;
        }
    assert_true(seen_count < 4096);
    seen[seen_count++] = (struct seen){block, key, trips};
    counters->block_executions[block] += trips;
}

static const char *flags_for(int width) {
    return width == 4 ? "-msse2" : width == 8 && __builtin_cpu_supports("avx2") ? "-mavx2" : "";
}

void harness_open(struct harness *h, const char *source, int width, const char *const *material) {
    struct status status = {0};
    struct shader_program *program = harness_compile(source, material, &status);
    if (!program)
        fail_msg("%s\n%s", source, status.message);
    harness_open_program(h, program, width);
}

struct shader_program *harness_compile_with(const char *source, const char *displacement,
                                            const char *atmosphere) {
    struct shader_companion before = {"displacement.sl", displacement, 0},
                            after = {"atmosphere.sl", atmosphere, 0};
    struct shader_compile_options options = {0};
    struct shader_program *program = NULL;
    struct status status = {0};
    before.length = displacement ? strlen(displacement) : 0;
    after.length = atmosphere ? strlen(atmosphere) : 0;
    options.displacement = displacement ? &before : NULL;
    options.atmosphere = atmosphere ? &after : NULL;
    if (!shader_compile("test.sl", source, strlen(source), &options, &program, &status))
        fail_msg("%s", status.message);
    return program;
}

void harness_open_program(struct harness *h, struct shader_program *program, int width) {
    char compiler[512];
    struct status status = {0};
    memset(h, 0, sizeof *h);
    h->program = program;
    snprintf(compiler, sizeof compiler,
             "cc -std=gnu11 -O1 -ffp-contract=off -fno-math-errno -fno-trapping-math -Wall -Wextra "
             "-Werror -Wno-psabi %s -DSHADER_WIDTH=%d",
             flags_for(width), width);
    h->library = compiled_object_load(program->c_source, program->c_length, compiler, &status);
    if (!h->library)
        fail_msg("%s", status.message);
    h->module = dlsym(h->library, SHADER_MODULE_SYMBOL);
    assert_non_null(h->module);
    assert_int_equal(h->module->width, width);
    h->uniform = calloc((size_t)h->module->uniform_count + 1, sizeof *h->uniform);
    h->counters = (struct shader_counters){h->executions, report};
    for (int s = 0; s < SHADER_SPACE_COUNT; s++)
        for (int i = 0; i < 4; i++)
            h->matrices.from_camera[s][i * 5] = h->matrices.to_camera[s][i * 5] = 1;
}

void harness_close(struct harness *h) {
    shader_program_destroy(h->program);
    dlclose(h->library);
    free(h->uniform);
}

const struct shader_parameter *harness_parameter(const struct shader_program *program,
                                                 const char *name) {
    for (int i = 0; i < program->parameter_count; i++)
        if (!strcmp(program->parameters[i].name, name))
            return &program->parameters[i];
    fail_msg("no parameter %s", name);
    return NULL;
}

void harness_bind(struct harness *h, const char *name, const float *values) {
    const struct shader_parameter *parameter = harness_parameter(h->program, name);
    assert_true(parameter->bound_offset >= 0);
    memcpy(h->bound + parameter->bound_offset, values,
           (size_t)parameter->components * sizeof *values);
    memset(h->given + parameter->bound_offset, 1, (size_t)parameter->components);
}

void harness_bind_string(struct harness *h, const char *name, const char *text) {
    float bits;
    int32_t identity = shader_string_identity(text);
    memcpy(&bits, &identity, sizeof bits);
    harness_bind(h, name, &bits);
    size_t length = strlen(text) + 1;
    assert_true(h->bound_text_bytes + length <= sizeof h->bound_texts);
    memcpy(h->bound_texts + h->bound_text_bytes, text, length);
    h->bound_text_bytes += length;
}

/* The samples of a shader that asks about neighbours are quads side by side. */
static int column_of(const struct harness *h, int i) {
    return h->module->uses_neighbours ? i / 4 * 2 + (i & 1) : i;
}

static int row_of(const struct harness *h, int i) {
    return h->module->uses_neighbours ? i >> 1 & 1 : 0;
}

static float material_of(const struct harness *h, const struct shader_parameter *parameter, int c,
                         int i) {
    bool is_quad = h->module->uses_neighbours;
    float value = (float)(i + 100 * c);
    if (!parameter->is_global)
        return value;
    if (parameter->type == SHADER_NORMAL)
        return c == 2 ? -1 : 0;
    if (is_quad && (!strcmp(parameter->name, "s") || !strcmp(parameter->name, "u")))
        return (float)column_of(h, i);
    if (is_quad && (!strcmp(parameter->name, "t") || !strcmp(parameter->name, "v")))
        return 0.5f + (float)row_of(h, i);
    return !strcmp(parameter->name, "t") ? 0.5f : value;
}

static void set_material(struct harness *h, float (*planes)[HARNESS_SAMPLES]) {
    for (int p = 0; p < h->program->parameter_count; p++) {
        const struct shader_parameter *parameter = &h->program->parameters[p];
        for (int c = 0; parameter->is_material && c < parameter->components; c++)
            for (int i = 0; i < HARNESS_SAMPLES; i++)
                planes[parameter->map_offset + c][i] = material_of(h, parameter, c, i);
    }
}

static void harness_prepare(struct harness *h) {
    text_table_init(&h->texts, h->module, h->bound_texts, h->bound_text_bytes);
    h->module->prepare(h->bound, h->given, &h->matrices, &h->texts.texts, h->uniform);
}

static uint64_t categories_of(const struct shader_module *surface, const char *category) {
    uint64_t found = 0;
    for (int c = 0; c < surface->category_count; c++)
        found |= (uint64_t)text_category_matches(surface->categories[c], category) << c;
    return found;
}

static void answer(const struct shader_module *surface, const struct shader_module *light,
                   int *offsets) {
    for (int q = 0; q < surface->query_count; q++) {
        offsets[q] = -1;
        for (int e = 0, at = 7; e < light->export_count; at += light->exports[e++].components)
            if (!strcmp(light->exports[e].name, surface->queries[q].name) &&
                light->exports[e].components == surface->queries[q].components)
                offsets[q] = at;
    }
}

void harness_run(struct harness *h, struct harness *const *lights, int light_count,
                 struct harness_result *result) {
    static _Alignas(64) float planes[64][HARNESS_SAMPLES], position[3][HARNESS_SAMPLES],
        incident[3][HARNESS_SAMPLES], color[3][HARNESS_SAMPLES], opacity[3][HARNESS_SAMPLES],
        scratch[4 * 8 * HARNESS_LIGHT_VECTORS * HARNESS_SAMPLES];
    static _Alignas(64) int32_t present[HARNESS_SAMPLES];
    const float *material[64];
    struct shader_light light_table[8];
    static int offsets[8][64];
    seen_count = 0;
    set_material(h, planes);
    for (int i = 0; i < 64; i++)
        material[i] = planes[i];
    for (int i = 0; i < HARNESS_SAMPLES; i++) {
        position[0][i] = (float)column_of(h, i);
        position[1][i] = 2 + (float)row_of(h, i);
        present[i] = h->absent >> i & 1 ? 0 : -1;
        position[2][i] = 3;
        incident[2][i] = 1;
    }
    for (int i = 0; i < light_count; i++) {
        harness_prepare(lights[i]);
        light_table[i] = (struct shader_light){
            .module = lights[i]->module,
            .uniform = lights[i]->uniform,
            .matrices = &lights[i]->matrices,
            .counters = &lights[i]->counters,
            .texts = &lights[i]->texts.texts,
            .categories = categories_of(h->module, lights[i]->program->category),
            .query_offsets = offsets[i],
        };
        answer(h->module, lights[i]->module, offsets[i]);
    }
    harness_prepare(h);
    struct shader_call call = {.count = HARNESS_SAMPLES,
                               .material = material,
                               .position = {position[0], position[1], position[2]},
                               .incident = {incident[0], incident[1], incident[2]},
                               .present = present,
                               .uniform = h->uniform,
                               .matrices = &h->matrices,
                               .lights = light_table,
                               .light_count = light_count,
                               .light_vectors = HARNESS_LIGHT_VECTORS,
                               .light_scratch = scratch,
                               .texts = &h->texts.texts,
                               .counters = &h->counters,
                               .color = {color[0], color[1], color[2]},
                               .opacity = {opacity[0], opacity[1], opacity[2]}};
    h->module->shade(&call);
    memcpy(result->color, color, sizeof color);
    text_table_finish(&h->texts);
    for (int i = 0; i < light_count; i++)
        text_table_finish(&lights[i]->texts);
    memcpy(result->opacity, opacity, sizeof opacity);
    result->overrun = call.overrun;
}

uint32_t harness_operations(const struct shader_module *module, int stream, int operation) {
    uint32_t sum = 0;
    for (int b = 0; b < module->block_count; b++)
        sum += module->blocks[b].operations[stream][operation];
    return sum;
}
