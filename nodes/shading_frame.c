/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shading_frame.h"

#include <stdlib.h>
#include <string.h>

bool shader_table_announce(struct shader_table *table, struct message *message,
                           struct status *status) {
    struct announced_shader shader = {0};
    if (!shader_payload_decode(message, &shader.payload, status))
        return false;
    if (shader.payload.number != table->count)
        return status_fail(status, STATUS_INVALID, "shader %u announced out of order",
                           shader.payload.number);
    shader.message = message_hold(message);
    table->shaders =
        memory_grow(table->shaders, &table->capacity, table->count + 1, sizeof *table->shaders);
    table->shaders[table->count++] = shader;
    return true;
}

void shader_table_finish(struct shader_table *table) {
    for (size_t i = 0; i < table->count; i++)
        message_release(table->shaders[i].message);
    free(table->shaders);
    *table = (struct shader_table){0};
}

static bool table_module(struct shader_table *table, uint32_t number,
                         const struct shader_module **module, struct status *status) {
    if (number >= table->count)
        return status_fail(status, STATUS_INVALID, "shader %u was never announced", number);
    struct announced_shader *shader = &table->shaders[number];
    if (!shader->module &&
        !table->services->load_shader(table->services->context, shader->payload.name,
                                      shader->payload.c_source, &shader->module, status))
        return false;
    *module = shader->module;
    return true;
}

static void prepared_finish(struct prepared_shader *prepared) {
    message_release(prepared->message);
    if (prepared->matrices)
        free((void *)prepared->matrices->named);
    free(prepared->matrices);
    free(prepared->uniform);
    free(prepared->lights);
    free(prepared->query_offsets);
    if (prepared->texts)
        text_table_finish(prepared->texts);
    free(prepared->texts);
    if (prepared->module)
        execution_counts_finish(&prepared->counts);
    *prepared = (struct prepared_shader){0};
}

bool shading_frame_add(struct shading_frame *frame, struct message *message, enum wire_kind kind,
                       struct status *status) {
    struct prepared_shader prepared = {0};
    if (!instance_payload_decode(message, &prepared.payload, status))
        return false;
    const bool is_light = kind == WIRE_LIGHT;
    const size_t expected = is_light ? frame->light_count : frame->instance_count + 1;
    if (prepared.payload.id != expected)
        return status_fail(status, STATUS_INVALID, "%s %u defined out of order",
                           is_light ? "light" : "instance", prepared.payload.id);
    prepared.message = message_hold(message);
    if (is_light) {
        frame->lights = memory_grow(frame->lights, &frame->light_capacity, frame->light_count + 1,
                                    sizeof *frame->lights);
        frame->lights[frame->light_count++] = prepared;
    } else {
        frame->instances = memory_grow(frame->instances, &frame->instance_capacity,
                                       frame->instance_count + 1, sizeof *frame->instances);
        frame->instances[frame->instance_count++] = prepared;
    }
    return true;
}

static void load_matrices(struct prepared_shader *prepared) {
    static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    prepared->matrices = memory_get(1, sizeof *prepared->matrices);
    const float *next = prepared->payload.matrices;
    for (int space = 0; space < SHADER_SPACE_COUNT; space++) {
        const bool is_sent = prepared->payload.spaces >> space & 1;
        memcpy(prepared->matrices->to_camera[space], is_sent ? next : identity, sizeof identity);
        memcpy(prepared->matrices->from_camera[space], is_sent ? next + 16 : identity,
               sizeof identity);
        next += is_sent ? 32 : 0;
    }
    const struct instance_payload *payload = &prepared->payload;
    struct shader_named_space *named = memory_get(payload->named_count, sizeof *named);
    for (uint32_t i = 0; i < payload->named_count; i++) {
        named[i].name = payload->names[i];
        memcpy(named[i].to_camera, payload->named_matrices + 32 * (size_t)i, sizeof identity);
        memcpy(named[i].from_camera, payload->named_matrices + 32 * (size_t)i + 16,
               sizeof identity);
    }
    prepared->matrices->named = named;
    prepared->matrices->named_count = (int)payload->named_count;
}

static bool prepare(struct prepared_shader *prepared, struct shader_table *table, bool is_light,
                    struct status *status) {
    const struct shader_module *module = NULL;
    if (!table_module(table, prepared->payload.shader, &module, status))
        return false;
    if ((int)prepared->payload.bound_count != module->bound_count || !module->is_light != !is_light)
        return status_fail(status, STATUS_INVALID, "%s %u does not fit its shader %s",
                           is_light ? "light" : "instance", prepared->payload.id, module->name);
    load_matrices(prepared);
    const size_t uniform_bytes =
        ((size_t)module->uniform_count * module->real_bytes + 64) / 64 * 64;
    prepared->uniform = aligned_alloc(64, uniform_bytes);
    if (!prepared->uniform)
        abort();
    memset(prepared->uniform, 0, uniform_bytes);
    if (module->uses_texts) {
        prepared->texts = memory_get(1, sizeof *prepared->texts);
        text_table_init(prepared->texts, module, prepared->payload.texts,
                        prepared->payload.text_bytes);
    }
    module->prepare(prepared->payload.bound, prepared->payload.given, prepared->matrices,
                    prepared->texts ? &prepared->texts->texts : NULL, prepared->uniform);
    prepared->module = module;
    execution_counts_init(&prepared->counts, module);
    return true;
}

/* Where the light's results hold the answer to each question of the surface. */
static void answer_queries(const struct shader_module *surface, const struct shader_module *light,
                           int *offsets) {
    for (int q = 0; q < surface->query_count; q++) {
        int at = 7;
        offsets[q] = -1;
        for (int e = 0; e < light->export_count; e++) {
            if (!strcmp(light->exports[e].name, surface->queries[q].name) &&
                light->exports[e].components == surface->queries[q].components)
                offsets[q] = at;
            at += light->exports[e].components;
        }
    }
}

static int result_vectors(const struct shader_module *light) {
    int vectors = 7;
    for (int e = 0; e < light->export_count; e++)
        vectors += light->exports[e].components;
    return vectors;
}

static uint64_t categories_of(const struct shader_module *surface, const char *category) {
    uint64_t found = 0;
    for (int c = 0; c < surface->category_count; c++)
        found |= (uint64_t)text_category_matches(surface->categories[c], category) << c;
    return found;
}

/* The lights of an instance as its shader meets them; lights themselves are prepared on first use.
 */
static bool connect_lights(struct shading_frame *frame, struct shader_table *table,
                           struct prepared_shader *instance, struct status *status) {
    const int count = instance->module->uses_lights ? (int)instance->payload.light_count : 0;
    instance->lights = memory_get((size_t)count, sizeof *instance->lights);
    instance->light_count = count;
    instance->light_vectors = 7;
    const int queries = instance->module->query_count;
    instance->query_offsets =
        memory_get((size_t)count * (size_t)queries, sizeof *instance->query_offsets);
    for (int i = 0; i < count; i++) {
        const uint32_t index = instance->payload.lights[i];
        if (index >= frame->light_count)
            return status_fail(status, STATUS_INVALID, "instance %u names light %u of %zu",
                               instance->payload.id, index, frame->light_count);
        struct prepared_shader *light = &frame->lights[index];
        if (!light->module && !prepare(light, table, true, status))
            return false;
        int *offsets = instance->query_offsets + (size_t)i * (size_t)queries;
        answer_queries(instance->module, light->module, offsets);
        if (result_vectors(light->module) > instance->light_vectors)
            instance->light_vectors = result_vectors(light->module);
        instance->lights[i] = (struct shader_light){
            .module = light->module,
            .uniform = light->uniform,
            .matrices = light->matrices,
            .counters = &light->counts.counters,
            .texts = light->texts ? &light->texts->texts : NULL,
            .categories = categories_of(instance->module, light->payload.category),
            .query_offsets = offsets,
        };
    }
    return true;
}

bool shading_frame_instance(struct shading_frame *frame, struct shader_table *table,
                            uint32_t shader_id, struct prepared_shader **out,
                            struct status *status) {
    if (!shader_id || shader_id > frame->instance_count)
        return status_fail(status, STATUS_INVALID, "shader ID %u, but the frame has %zu instances",
                           shader_id, frame->instance_count);
    struct prepared_shader *instance = &frame->instances[shader_id - 1];
    if (!instance->module && !prepare(instance, table, false, status))
        return false;
    if (!instance->lights && !connect_lights(frame, table, instance, status))
        return false;
    *out = instance;
    return true;
}

bool shading_frame_sum_arrivals(const struct shading_frame *frame, struct shader_table *table,
                                const struct region_arrivals *arrivals, uint32_t composed,
                                struct region_sums *sums, struct status *status) {
    if (!arrivals->count) {
        sums->arrived_samples = composed;
        sums->arrived_map_bytes = sums->map_bytes;
    }
    for (size_t i = 0; i < arrivals->count; i++) {
        const struct shader_samples *some = &arrivals->shaders[i];
        const struct shader_module *module = NULL;
        if (!some->shader || some->shader > frame->instance_count)
            return status_fail(status, STATUS_INVALID,
                               "shader ID %u, but the frame has %zu instances", some->shader,
                               frame->instance_count);
        if (!table_module(table, frame->instances[some->shader - 1].payload.shader, &module,
                          status))
            return false;
        sums->arrived_samples += some->samples;
        sums->arrived_map_bytes += (uint64_t)some->samples * (uint64_t)module->material_bytes;
    }
    return true;
}

static bool same_payload(const struct prepared_shader *a, const struct prepared_shader *b) {
    return a->message->length == b->message->length &&
           !memcmp(a->message->bytes + WIRE_HEADER_BYTES, b->message->bytes + WIRE_HEADER_BYTES,
                   a->message->length - WIRE_HEADER_BYTES);
}

static size_t inherit(struct prepared_shader *fresh, size_t fresh_count,
                      struct prepared_shader *old, size_t old_count) {
    size_t kept = 0;
    for (size_t i = 0; i < fresh_count && i < old_count; i++) {
        if (fresh[i].module || !old[i].module || !same_payload(&fresh[i], &old[i]))
            continue;
        fresh[i].module = old[i].module;
        fresh[i].matrices = old[i].matrices;
        fresh[i].uniform = old[i].uniform;
        fresh[i].texts = old[i].texts;
        fresh[i].counts = old[i].counts;
        old[i].module = NULL;
        old[i].matrices = NULL;
        old[i].uniform = NULL;
        old[i].texts = NULL;
        kept++;
    }
    return kept;
}

size_t shading_frame_inherit(struct shading_frame *fresh, struct shading_frame *old) {
    return inherit(fresh->lights, fresh->light_count, old->lights, old->light_count) +
           inherit(fresh->instances, fresh->instance_count, old->instances, old->instance_count);
}

void shading_frame_finish(struct shading_frame *frame) {
    for (size_t i = 0; i < frame->instance_count; i++)
        prepared_finish(&frame->instances[i]);
    for (size_t i = 0; i < frame->light_count; i++)
        prepared_finish(&frame->lights[i]);
    free(frame->instances);
    free(frame->lights);
    message_release(frame->frame_message);
    *frame = (struct shading_frame){0};
}
