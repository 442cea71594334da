/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/emit.h"
#include "shaders/compiler/passes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OUTPUT_BYTES_MAX = 64 << 20 };

static void emit_arguments(struct emitter *e, const char *format, va_list arguments) {
    struct compilation *c = e->c;
    char text[256];
    int length = vsnprintf(text, sizeof text, format, arguments);
    size_t needed = c->output_length + (size_t)length + 1;
    if (needed > OUTPUT_BYTES_MAX)
        compile_limit(c, NULL, "the C of this shader is longer than %d bytes", OUTPUT_BYTES_MAX);
    c->output = memory_grow(c->output, &c->output_capacity, needed, 1);
    memcpy(c->output + c->output_length, text, (size_t)length + 1);
    c->output_length += (size_t)length;
}

void emit_text(struct emitter *e, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    emit_arguments(e, format, arguments);
    va_end(arguments);
}

void emit_line(struct emitter *e, const char *format, ...) {
    va_list arguments;
    for (int i = 0; i < e->indent; i++)
        emit_text(e, "    ");
    va_start(arguments, format);
    emit_arguments(e, format, arguments);
    va_end(arguments);
    emit_text(e, "\n");
}

/* What every module starts with. Index conversions clamp first, so that no float is out of an int's
 * range; not a number is element 0. */
static const char *const support[] = {
    "#include \"shader_module.h\"\n#include \"vector_math.h\"\n"
    "#ifdef SHADER_REFERENCE\n#define float double\n#endif\n\n",
    "#define SHADER_UNUSED __attribute__((unused))\n"
    "#define SHADER_HELPER static inline SHADER_UNUSED\n\n",
    "SHADER_HELPER vi shader_mask(int truth) {\n    return vi_set(truth ? -1 : 0);\n}\n\n",
    "SHADER_HELPER int shader_index(float index, int length) {\n"
    "    if (!(index > 0.0f))\n        return 0;\n"
    "    return index >= (float)length ? length - 1 : (int)index;\n}\n\n",
    "SHADER_HELPER vf shader_load_lanes_varying(const vf *array, int length, vf index) {\n"
    "    vf result = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        result[i] = array[shader_index(index[i], length)][i];\n"
    "    return result;\n}\n\n",
    "SHADER_HELPER vf shader_load_lanes_uniform(const float *array, int length, vf index) {\n"
    "    vf result = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        result[i] = array[shader_index(index[i], length)];\n"
    "    return result;\n}\n\n",
    "SHADER_HELPER void shader_store_lanes(vf *array, int length, vf index, vi mask, vf value) {\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        if (mask[i])\n"
    "            array[shader_index(index[i], length)][i] = value[i];\n}\n\n",
    "SHADER_HELPER void shader_store_one(vf *element, vi mask, vf value) {\n"
    "    *element = vf_select(mask, value, *element);\n}\n\n",
    "SHADER_HELPER int32_t shader_identity(const void *bits) {\n"
    "    int32_t identity;\n"
    "    __builtin_memcpy(&identity, bits, sizeof identity);\n"
    "    return identity;\n}\n\n",
    "SHADER_HELPER vi shader_load_mask(const float *bits) {\n"
    "    vi mask;\n"
    "    __builtin_memcpy(&mask, bits, sizeof mask);\n"
    "    return mask;\n}\n\n",
    "SHADER_HELPER const shader_bound *shader_matrix(const struct shader_matrices *all, int "
    "is_to_camera,\n"
    "                                         int32_t space) {\n"
    "    static const shader_bound identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
    "1};\n"
    "    if (space > SHADER_SPACE_CAMERA && space < SHADER_SPACE_COUNT)\n"
    "        return is_to_camera ? all->to_camera[space] : all->from_camera[space];\n"
    "    for (int i = 0; i < all->named_count; i++)\n"
    "        if (all->named[i].name == space)\n"
    "            return is_to_camera ? all->named[i].to_camera : all->named[i].from_camera;\n"
    "    return identity;\n}\n\n",
    "SHADER_HELPER float *shader_light_result(const struct shader_call *call, int set, int light) "
    "{\n"
    "    return call->light_scratch + ((size_t)set * (size_t)call->light_count + (size_t)light) *\n"
    "           (size_t)call->light_vectors * SHADER_WIDTH;\n}\n\n",
    "SHADER_HELPER uint64_t shader_key(uint64_t key, uint64_t step) {\n"
    "    key = (key ^ step) * 0x9e3779b97f4a7c15u;\n"
    "    key = (key ^ (key >> 29)) * 0xbf58476d1ce4e5b9u;\n"
    "    return key ^ (key >> 32);\n}\n\n",
    "SHADER_HELPER void shader_report(struct shader_counters *counters, uint32_t block, uint64_t "
    "key,\n"
    "                                 uint64_t trips) {\n"
    "    if (counters && counters->report_trips)\n"
    "        counters->report_trips(counters, block, key, trips);\n}\n\n",
};

/* Only where a shader asks how a value changes between samples. Lanes 4q to 4q + 3 are a quad:
 * (0, 0), (1, 0), (0, 1), (1, 1). A sample without a neighbour in its own row takes the change in
 * the other row. */
static const char *const neighbours[] = {
    "SHADER_HELPER vi shader_load_present(const int32_t *present) {\n"
    "    vi mask = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        mask[i] = present[i];\n"
    "    return mask;\n}\n\n",
    "SHADER_HELPER vi shader_lanes(void) {\n"
    "    vi lanes = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        lanes[i] = i;\n"
    "    return lanes;\n}\n\n",
    "SHADER_HELPER vf shader_swap(vf x, int bit) {\n"
    "#ifdef __clang__\n"
    "    vf result = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        result[i] = x[i ^ bit];\n"
    "    return result;\n"
    "#else\n"
    "    return __builtin_shuffle(x, shader_lanes() ^ bit);\n"
    "#endif\n}\n\n",
    "SHADER_HELPER vi shader_swap_mask(vi x, int bit) {\n"
    "    vf as_floats;\n"
    "    __builtin_memcpy(&as_floats, &x, sizeof x);\n"
    "    as_floats = shader_swap(as_floats, bit);\n"
    "    __builtin_memcpy(&x, &as_floats, sizeof x);\n"
    "    return x;\n}\n\n",
    "SHADER_HELPER vf shader_difference(vf x, vi present, int bit) {\n"
    "    const vi is_second = (shader_lanes() & bit) != 0;\n"
    "    const vf other = shader_swap(x, bit);\n"
    "    const vi both = present & shader_swap_mask(present, bit);\n"
    "    const vf own = vf_select(is_second, x, other) - vf_select(is_second, other, x);\n"
    "    const vf across = shader_swap(own, bit ^ 3);\n"
    "    const vi both_across = shader_swap_mask(both, bit ^ 3);\n"
    "    return vf_select(both, own, vf_select(both_across, across, vf_set(0.0f)));\n}\n\n",
    "SHADER_HELPER vf shader_difference_x(vf x, vi present) {\n"
    "    return shader_difference(x, present, 1);\n}\n\n",
    "SHADER_HELPER vf shader_difference_y(vf x, vi present) {\n"
    "    return shader_difference(x, present, 2);\n}\n\n",
    "SHADER_HELPER float shader_no_difference(float x) {\n"
    "    (void)x;\n    return 0.0f;\n}\n\n",
};

/* Arrays of fixed-point numbers, for shaders that have any. */
static const char *const fixed_support[] = {
    "#include \"vector_fixed.h\"\n\n"
    "typedef int64_t shader_unaligned_fixed __attribute__((aligned(4)));\n\n",
    "SHADER_HELPER vx shader_load_fixed_lanes_varying(const vx *array, int length, vf index) {\n"
    "    vx result = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        result[i] = array[shader_index(index[i], length)][i];\n"
    "    return result;\n}\n\n",
    "SHADER_HELPER vx shader_load_fixed_lanes_uniform(const shader_unaligned_fixed *array, int "
    "length, vf index) {\n"
    "    vx result = {0};\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        result[i] = array[shader_index(index[i], length)];\n"
    "    return result;\n}\n\n",
    "SHADER_HELPER void shader_store_fixed_lanes(vx *array, int length, vf index, vi mask, vx "
    "value) {\n"
    "    for (int i = 0; i < SHADER_WIDTH; i++)\n"
    "        if (mask[i])\n"
    "            array[shader_index(index[i], length)][i] = value[i];\n}\n\n",
    "SHADER_HELPER void shader_store_fixed_one(vx *element, vi mask, vx value) {\n"
    "    *element = vx_select(mask, value, *element);\n}\n\n",
};

/* The uniform block holds floats; fixed-point numbers take two, strings keep their bits, conditions
 * become 0 and 1. */
static void emit_slot_store(struct emitter *e, const struct ir_variable *v) {
    if (v->array_length)
        emit_line(e, "__builtin_memcpy(uniform + %d, v%d, sizeof v%d);", v->slot, v->id, v->id);
    else if (v->type == IR_FLOAT)
        emit_line(e, "uniform[%d] = v%d;", v->slot, v->id);
    else if (v->type == IR_BOOL)
        emit_line(e, "uniform[%d] = v%d ? 1.0f : 0.0f;", v->slot, v->id);
    else
        emit_line(e, "__builtin_memcpy(uniform + %d, &v%d, sizeof v%d);", v->slot, v->id, v->id);
}

static void emit_slot_load(struct emitter *e, const struct ir_variable *v) {
    if (v->array_length && !v->is_written_in_shade) {
        emit_line(e, "const %s *const v%d = (const void *)(uniform + %d);",
                  v->type == IR_FIXED ? "shader_unaligned_fixed" : "float", v->id, v->slot);
    } else if (v->array_length) {
        emit_line(e, "%s v%d[%d];", v->type == IR_FIXED ? "int64_t" : "float", v->id,
                  v->array_length);
        emit_line(e, "__builtin_memcpy(v%d, uniform + %d, sizeof v%d);", v->id, v->slot, v->id);
    } else if (v->type == IR_FLOAT) {
        emit_line(e, "float v%d = uniform[%d];", v->id, v->slot);
    } else if (v->type == IR_BOOL) {
        emit_line(e, "int v%d = uniform[%d] != 0.0f;", v->id, v->slot);
    } else if (v->type == IR_FIXED) {
        emit_line(e, "int64_t v%d;", v->id);
        emit_line(e, "__builtin_memcpy(&v%d, uniform + %d, sizeof v%d);", v->id, v->slot, v->id);
    } else {
        emit_line(e, "int32_t v%d = shader_identity(uniform + %d);", v->id, v->slot);
    }
}

static void emit_prepare(struct emitter *e) {
    e->in_prepare = true;
    e->mask = e->loop_mask = -1;
    emit_text(
        e, "static void shader_prepare(const shader_bound *bound, const uint8_t *given,\n"
           "                           const struct shader_matrices *matrices, struct shader_texts "
           "*texts,\n"
           "                           float *uniform) {\n");
    e->indent = 1;
    emit_line(e, "(void)bound, (void)given, (void)matrices, (void)texts, (void)uniform;");
    if (e->ir->has_prepare_loop) {
        e->steps = e->next_number++;
        emit_line(e, "int overrun = 0;");
        emit_line(e, "uint64_t w%d = 0;", e->steps);
    }
    for (struct ir_variable *v = e->ir->top->variables; v; v = v->next_in_home)
        if (v->in_prepare)
            emit_declaration(e, v);
    emit_list(e, e->ir->top);
    for (struct ir_variable *v = e->ir->top->variables; v; v = v->next_in_home)
        if (v->slot >= 0)
            emit_slot_store(e, v);
    if (e->ir->has_prepare_loop)
        emit_line(e, "uniform[0] = overrun ? 1.0f : 0.0f;");
    emit_text(e, "}\n\n");
    e->in_prepare = false;
}

static void emit_variables(struct emitter *e) {
    for (struct ir_variable *v = e->ir->top->variables; v; v = v->next_in_home) {
        if (v->slot >= 0)
            emit_slot_load(e, v);
        else if (v->in_shade)
            emit_declaration(e, v);
    }
    e->steps = e->next_number++;
    e->key = e->next_number++;
    emit_line(e, "uint64_t w%d SHADER_UNUSED = 0;", e->steps);
    emit_line(e, "vi steps SHADER_UNUSED = {0};");
    if (e->ir->has_prepare_loop)
        emit_line(e, "if (uniform[0] != 0.0f)\n        %s = 1;",
                  e->in_light ? "*overrun" : "call->overrun");
}

/* Runs one light for the vector at hand, into `result`. */
static void emit_run_light(struct emitter *e, const char *key) {
    emit_line(e, "    struct shader_light_sample sample;");
    emit_line(e, "    for (int c = 0; c < 3; c++) {");
    emit_line(e, "        sample.direction[c] = result + c * SHADER_WIDTH;");
    emit_line(e, "        sample.color[c] = result + (3 + c) * SHADER_WIDTH;");
    emit_line(e, "    }");
    emit_line(e, "    sample.lit = (int32_t *)(void *)(result + 6 * SHADER_WIDTH);");
    emit_line(e,
              "    sample.exports = call->light_vectors > 7 ? result + 7 * SHADER_WIDTH : NULL;");
    emit_line(e, "    light->module->light(light, position, %s, &sample, &call->overrun);", key);
}

/* Lights run once per vector of samples, before anything that could need them; every illuminance at
 * the position of the sample and ambient() reads what they left. */
static void emit_run_lights(struct emitter *e) {
    bool runs_all = e->ir->uses_ambient && e->ir->uses_shared_lights;
    emit_line(e, "vf ambient[3] SHADER_UNUSED = {{0}, {0}, {0}};");
    if (!e->ir->uses_ambient && !e->ir->uses_shared_lights)
        return;
    emit_line(e, "for (int i = 0; i < call->light_count; i++) {");
    emit_line(e, "    const struct shader_light *light = &call->lights[i];");
    emit_line(e, "    float *result = shader_light_result(call, 0, i);");
    if (!runs_all) {
        emit_line(e, "    if (%slight->module->is_ambient)", e->ir->uses_ambient ? "!" : "");
        emit_line(e, "        continue;");
    }
    emit_line(
        e, "    const float *const position[3] = {call->position[0] + at, call->position[1] + at,");
    emit_line(e, "                                      call->position[2] + at};");
    emit_run_light(e, "1");
    if (e->ir->uses_ambient) {
        emit_line(e, "    if (light->module->is_ambient)");
        emit_line(e, "        for (int c = 0; c < 3; c++)");
        emit_line(e, "            ambient[c] += vf_load(sample.color[c]);");
    }
    emit_line(e, "}");
}

void emit_lights_at(struct emitter *e, struct ir_node *node) {
    int number = e->next_number++;
    emit_line(e, "_Alignas(64) float p%d[3][SHADER_WIDTH];", number);
    for (int c = 0; c < 3; c++) {
        emit_text(e, "%*svf_store(p%d[%d], ", e->indent * 4, "", number, c);
        emit_operand(e, &node->operands[c], true);
        emit_text(e, ");\n");
    }
    emit_line(e, "for (int i = 0; i < call->light_count; i++) {");
    emit_line(e, "    const struct shader_light *light = &call->lights[i];");
    emit_line(e, "    float *result = shader_light_result(call, %d, i);", node->index);
    emit_line(e, "    if (light->module->is_ambient)");
    emit_line(e, "        continue;");
    emit_line(e, "    const float *const position[3] = {p%d[0], p%d[1], p%d[2]};", number, number,
              number);
    char key[48];
    snprintf(key, sizeof key, "shader_key(k%d ^ call->instance, %du)", e->key,
             (unsigned)node->index + 1);
    emit_line(e, "    shader_report(light->counters, 0, %s, 1);", key);
    emit_run_light(e, key);
    emit_line(e, "}");
    emit_line(e, "v%d = shader_mask(1);", node->results[0]->id);
    emit_line(e, "(void)v%d;", node->results[0]->id);
}

static void emit_shade(struct emitter *e) {
    emit_text(e, "static void shade_vector(struct shader_call *call, size_t at) {\n");
    e->indent = 1;
    emit_line(e, "const float *uniform SHADER_UNUSED = call->uniform;");
    emit_line(e, "const struct shader_matrices *matrices SHADER_UNUSED = call->matrices;");
    emit_line(e, "struct shader_texts *texts SHADER_UNUSED = call->texts;");
    emit_variables(e);
    emit_probe_lanes(e);
    emit_line(e, "const uint64_t k%d SHADER_UNUSED = 0;", e->key);
    if (e->ir->uses_neighbours)
        emit_line(e, "const vi present = shader_load_present(call->present + at);");
    if (e->ir->uses_ambient || e->ir->uses_illuminance)
        emit_run_lights(e);
    emit_list(e, e->ir->top);
    for (int i = 0; i < 3; i++)
        emit_line(e, "vf_store(call->color[%d] + at, vf_canonical(v%d));", i, e->ir->color[i]->id);
    for (int i = 0; i < 3; i++) {
        emit_line(e, "if (call->opacity[%d])", i);
        if (e->ir->kind == SHADER_KIND_DISPLACEMENT)
            emit_line(e, "    vf_store(call->opacity[%d] + at, vf_canonical(v%d));", i,
                      e->ir->direction[i]->id);
        else
            emit_line(e, "    vf_store(call->opacity[%d] + at, vf_set(1.0f));", i);
    }
    emit_text(e, "}\n\nstatic void shader_shade(struct shader_call *call) {\n"
                 "    for (size_t at = 0; at < call->count; at += SHADER_WIDTH)\n"
                 "        shade_vector(call, at);\n}\n\n");
}

static void emit_light(struct emitter *e) {
    e->in_light = true;
    emit_text(e, "static void shader_light_run(const struct shader_light *self, const float *const "
                 "position[3],\n"
                 "                             uint64_t key, struct shader_light_sample *sample,\n"
                 "                             int *overrun) {\n");
    e->indent = 1;
    emit_line(e, "const float *uniform SHADER_UNUSED = self->uniform;");
    emit_line(e, "const struct shader_matrices *matrices SHADER_UNUSED = self->matrices;");
    emit_line(e, "struct shader_texts *texts SHADER_UNUSED = self->texts;");
    emit_line(e, "(void)position, (void)overrun;");
    emit_variables(e);
    emit_probe_lanes(e);
    emit_line(e, "const uint64_t k%d SHADER_UNUSED = key;", e->key);
    emit_list(e, e->ir->top);
    for (int i = 0; i < 3 && !e->ir->is_ambient; i++)
        emit_line(e, "vf_store(sample->direction[%d], vf_canonical(v%d));", i,
                  e->ir->direction[i]->id);
    for (int i = 0; i < 3; i++)
        emit_line(e, "vf_store(sample->color[%d], vf_canonical(v%d));", i, e->ir->color[i]->id);
    emit_line(e, "__builtin_memcpy(sample->lit, &v%d, sizeof v%d);", e->ir->lit->id,
              e->ir->lit->id);
    for (int i = 0, at = 0; i < e->ir->export_count; i++)
        for (int c = 0; c < e->ir->exports[i].components; c++)
            emit_line(e,
                      "if (sample->exports)\n        vf_store(sample->exports + %d * SHADER_WIDTH, "
                      "vf_canonical(v%d));",
                      at++, e->ir->exports[i].value[c]->id);
    emit_text(e, "}\n\n");
}

void emit_quoted(struct emitter *e, const char *text) {
    emit_text(e, "\"");
    for (; *text; text++)
        emit_text(e, *text >= ' ' && *text < 127 && !strchr("\\\"?", *text) ? "%c" : "\\%03o",
                  (unsigned char)*text);
    emit_text(e, "\"");
}

static void emit_messages(struct emitter *e, const char *table, const struct ir_message *messages,
                          int count) {
    emit_text(e, "static const struct shader_message %s[] = {\n", table);
    for (int i = 0; i < count; i++) {
        emit_text(e, "    {");
        emit_quoted(e, messages[i].name);
        emit_text(e, ", %d},\n", messages[i].components);
    }
    emit_text(e, "    {0, 0},\n};\n\n");
}

/* Strings, categories and questions, as far as there are any. */
static void emit_tables(struct emitter *e) {
    struct ir_program *ir = e->ir;
    if (ir->uses_texts) {
        emit_text(e, "static const char *const shader_text_table[] = {\n");
        for (const struct ir_text *t = ir->texts; t; t = t->next) {
            emit_text(e, "    ");
            emit_quoted(e, t->text);
            emit_text(e, ",\n");
        }
        emit_text(e, "};\n\n");
    }
    if (ir->category_count) {
        emit_text(e, "static const char *const shader_categories[] = {\n");
        for (int i = 0; i < ir->category_count; i++) {
            emit_text(e, "    ");
            emit_quoted(e, ir->categories[i]);
            emit_text(e, ",\n");
        }
        emit_text(e, "};\n\n");
    }
    if (e->external_count)
        emit_external_table(e);
    if (ir->query_count)
        emit_messages(e, "shader_queries", ir->queries, ir->query_count);
    if (ir->export_count)
        emit_messages(e, "shader_exports", ir->exports, ir->export_count);
}

static void emit_table_fields(struct emitter *e) {
    struct ir_program *ir = e->ir;
    if (ir->uses_texts)
        emit_text(e,
                  "    .uses_texts = 1,\n    .text_count = %d,\n    .texts = shader_text_table,\n",
                  ir->text_count);
    if (ir->category_count)
        emit_text(e, "    .category_count = %d,\n    .categories = shader_categories,\n",
                  ir->category_count);
    if (ir->query_count)
        emit_text(e, "    .query_count = %d,\n    .queries = shader_queries,\n", ir->query_count);
    if (ir->export_count)
        emit_text(e, "    .export_count = %d,\n    .exports = shader_exports,\n", ir->export_count);
    if (e->external_count)
        emit_text(e, "    .external_count = %d,\n    .externals = shader_externals,\n",
                  e->external_count);
    emit_text(e, "    .light_sets = %d,\n", ir->light_sets);
    emit_probe_fields(e);
}

static void emit_blocks(struct emitter *e) {
    emit_text(e, "static const struct shader_block shader_blocks[] = {\n");
    for (int b = 0; b < e->ir->block_count; b++) {
        const struct shader_block *block = &e->ir->blocks[b];
        emit_text(e, "    {.parent = %d", block->parent);
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
                if (block->operations[s][o])
                    emit_text(e, ", .operations[%d][%d] = %u", s, o, block->operations[s][o]);
        emit_text(e, "},\n");
    }
    emit_text(e, "};\n\n");
}

/* Floats of the uniform block that hold loaded values; returns how many. */
static int emit_loaded(struct emitter *e) {
    int count = 0;
    for (const struct ir_variable *v = e->ir->top->variables; v; v = v->next_in_home) {
        if (v->slot < 0 || !v->is_loaded)
            continue;
        emit_text(e, count ? "" : "static const int shader_loaded[] = {\n");
        for (int i = 0; i < ir_slot_floats(v); i++, count++)
            emit_text(e, "    %d,\n", v->slot + i);
    }
    emit_text(e, count ? "};\n\n" : "");
    return count;
}

static void emit_module(struct emitter *e) {
    const struct shader_program *program = e->c->program;
    bool is_light = e->ir->kind == SHADER_KIND_LIGHT;
    const int loaded = emit_loaded(e);
    emit_text(e, "extern const struct shader_module sortlast_shader_module;\n"
                 "const struct shader_module sortlast_shader_module = {\n");
    emit_text(e, "    .abi = SHADER_MODULE_ABI,\n    .width = SHADER_WIDTH,\n");
    emit_text(e, "    .real_bytes = sizeof(shader_real),\n");
    emit_text(e, "    .name = \"%.128s\",\n", program->name);
    emit_text(e, "    .is_light = %d,\n    .is_ambient = %d,\n", is_light, e->ir->is_ambient);
    emit_text(e, "    .material_count = %d,\n    .material_bytes = %d,\n", program->material_count,
              program->material_bytes);
    emit_text(e, "    .bound_count = %d,\n", program->bound_count);
    emit_text(e, "    .uniform_count = %d,\n    .spaces = %u,\n", e->ir->uniform_count,
              e->ir->spaces);
    if (loaded)
        emit_text(e, "    .loaded_count = %d,\n    .loaded = shader_loaded,\n", loaded);
    emit_text(e, "    .block_count = %d,\n    .blocks = shader_blocks,\n", e->ir->block_count);
    emit_text(e, "    .uses_lights = %d,\n", e->ir->uses_ambient || e->ir->uses_illuminance);
    emit_text(e, "    .uses_neighbours = %d,\n", e->ir->uses_neighbours);
    emit_table_fields(e);
    emit_text(e, "    .prepare = shader_prepare,\n");
    emit_text(e, is_light ? "    .light = shader_light_run,\n" : "    .shade = shader_shade,\n");
    emit_text(e, "};\n");
}

void emit_support_text(struct emitter *e, const char *text) {
    for (; *text; text += strlen(text) < 200 ? strlen(text) : 200)
        emit_text(e, "%.200s", text);
}

static void emit_support(struct emitter *e, const char *const *texts, size_t count) {
    for (size_t i = 0; i < count; i++)
        emit_support_text(e, texts[i]);
}

static bool uses_fixed(const struct ir_program *ir) {
    for (size_t i = 0; i < ir->variable_count; i++)
        if (ir->variables[i]->type == IR_FIXED && ir->variables[i]->is_live)
            return true;
    return false;
}

void pass_emit(struct ir_program *ir) {
    struct emitter emitter = {.c = ir->c, .ir = ir}, *e = &emitter;
    if (ir->c->options && ir->c->options->reference_math)
        emit_text(e, "#define SHADER_REFERENCE 1\n");
    emit_support(e, support, sizeof support / sizeof *support);
    if (ir->uses_neighbours)
        emit_support(e, neighbours, sizeof neighbours / sizeof *neighbours);
    if (uses_fixed(ir))
        emit_support(e, fixed_support, sizeof fixed_support / sizeof *fixed_support);
    emit_externals(e);
    emit_probe_support(e);
    emit_prepare(e);
    e->mask = e->loop_mask = -1;
    if (ir->kind == SHADER_KIND_LIGHT)
        emit_light(e);
    else
        emit_shade(e);
    emit_blocks(e);
    emit_tables(e);
    emit_module(e);
}
