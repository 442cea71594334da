/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"
#include "nodes/programs/shader_command.h"

/* The report for programs: the same figures as the text, keys as docs/shaders.md lists them. */

static cJSON *parameters_json(const struct shader_program *program) {
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *p = &program->parameters[i];
        cJSON *entry = cJSON_CreateObject();
        char type[64];
        shader_parameter_type(p, type);
        cJSON_AddStringToObject(entry, "name", p->name);
        cJSON_AddStringToObject(entry, "type", type);
        cJSON_AddStringToObject(entry, "storage", shader_parameter_storage(p));
        cJSON_AddBoolToObject(entry, "live", p->is_live);
        json_add_whole(entry, "bytes", p->bytes);
        cJSON_AddItemToArray(list, entry);
    }
    return list;
}

static cJSON *map_json(const struct shader_program *program) {
    cJSON *map = cJSON_CreateObject();
    json_add_whole(map, "bytes", SHADER_ID_BYTES + program->material_bytes);
    cJSON *list = cJSON_AddArrayToObject(map, "parameters");
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *p = &program->parameters[i];
        if (!p->is_material)
            continue;
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddStringToObject(entry, "name", p->name);
        json_add_whole(entry, "offset", p->map_byte);
        json_add_whole(entry, "bytes", p->bytes);
        cJSON_AddItemToArray(list, entry);
    }
    return map;
}

static cJSON *memory_json(const struct shader_memory *m) {
    cJSON *memory = cJSON_CreateObject();
    json_add_whole(memory, "total", m->total);
    json_add_whole(memory, "varying", m->varying);
    json_add_whole(memory, "allocated", m->allocated);
    json_add_whole(memory, "free", m->free);
    json_add_whole(memory, "available", m->available);
    json_add_whole(memory, "transfer_map", m->parameters);
    json_add_whole(memory, "position", m->position);
    json_add_whole(memory, "communication", m->communication);
    json_add_whole(memory, "retained", m->retained);
    json_add_whole(memory, "spilled", m->spilled);
    cJSON *list = cJSON_AddArrayToObject(memory, "lifetimes");
    for (int i = 0; i < m->lifetime_count; i++) {
        const struct shader_lifetime *life = &m->lifetimes[i];
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddStringToObject(entry, "name", life->name);
        json_add_whole(entry, "line", life->line);
        json_add_whole(entry, "bytes", life->bytes);
        json_add_whole(entry, "first", life->first);
        json_add_whole(entry, "last", life->last);
        json_add_whole(entry, "address", life->address);
        cJSON_AddItemToArray(list, entry);
    }
    return memory;
}

static int64_t picoseconds(const struct shader_report *report, ticks time) {
    return ticks_to_ps(report->machine->rate, time);
}

static void add_times(cJSON *object, const char *key, const struct shader_report *report,
                      ticks exact, ticks fast) {
    cJSON *times = cJSON_AddObjectToObject(object, key);
    json_add_whole(times, "exact", picoseconds(report, exact));
    json_add_whole(times, "fast", picoseconds(report, fast));
}

static void add_costs(cJSON *object, const struct shader_report *report) {
    static const char *const keys[] = {
#define OPERATION_KEY(name, key, what) key,
        SIMD_OPERATIONS(OPERATION_KEY)
#undef OPERATION_KEY
    };
    add_times(object, "time_per_region_ps", report, shader_report_time(report, false),
              shader_report_time(report, true));
    const uint64_t *lights = report->counts.lights;
    add_times(object, "lights_ps", report, shader_report_price(report->machine, lights, false),
              shader_report_price(report->machine, lights, true));
    cJSON *streams = cJSON_AddObjectToObject(object, "streams");
    for (int s = 0; s < SHADER_STREAM_COUNT; s++) {
        const uint64_t *operations = report->counts.operations[s];
        const ticks exact = shader_report_price(report->machine, operations, false);
        if (!exact)
            continue;
        cJSON *stream = cJSON_AddObjectToObject(streams, shader_stream_name(s));
        add_times(stream, "time_ps", report, exact,
                  shader_report_price(report->machine, operations, true));
        cJSON *counts = cJSON_AddObjectToObject(stream, "operations");
        for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
            if (operations[o])
                json_add_whole(counts, keys[o], (int64_t)operations[o]);
    }
}

cJSON *shader_report_json(const struct shader_report *report) {
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "shader", report->program->name);
    cJSON_AddStringToObject(object, "kind", shader_kind_name(report->program->kind));
    cJSON_AddStringToObject(object, "file", report->path);
    cJSON_AddStringToObject(object, "machine", report->machine->name);
    cJSON_AddItemToObject(object, "parameters", parameters_json(report->program));
    cJSON_AddItemToObject(object, "transfer_map", map_json(report->program));
    cJSON_AddItemToObject(object, "memory", memory_json(&report->program->memory));
    if (report->is_measured)
        add_costs(object, report);
    cJSON_AddItemToObject(object, "calls", shader_report_calls_json(report));
    cJSON *diagnostics = cJSON_AddArrayToObject(object, "diagnostics");
    for (int i = 0; i < report->warning_count; i++)
        cJSON_AddItemToArray(diagnostics, cJSON_CreateString(report->warnings[i]));
    return object;
}
