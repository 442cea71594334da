/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/render_report.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdio.h>

static void add_whole(cJSON *object, const char *key, uint64_t value) {
    char text[32];
    snprintf(text, sizeof text, "%" PRIu64, value);
    cJSON_AddRawToObject(object, key, text);
}

/* Operations that were issued, by name. */
static cJSON *operations_json(const uint64_t operations[SIMD_OPERATION_COUNT]) {
    static const char *const names[SIMD_OPERATION_COUNT] = {
#define OPERATION_NAME(name, key, what) key,
        SIMD_OPERATIONS(OPERATION_NAME)
#undef OPERATION_NAME
    };
    cJSON *object = cJSON_CreateObject();
    for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
        if (operations[o])
            add_whole(object, names[o], operations[o]);
    return object;
}

static cJSON *entry_json(const struct instance_work *work) {
    static const char *const streams[SHADER_STREAM_COUNT] = {"pre_illum", "illum", "post_illum",
                                                             "light", "shared"};
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddStringToObject(entry, "name",
                            work->instance == SHADING_WORK_SHARED ? "positions" : work->name);
    add_whole(entry, "regions", work->regions);
    add_whole(entry, "samples", work->samples);
    cJSON *object = cJSON_AddObjectToObject(entry, "instructions");
    for (int s = 0; s < SHADER_STREAM_COUNT; s++)
        add_whole(object, streams[s], work->streams[s]);
    cJSON_AddItemToObject(entry, "operations", operations_json(work->operations));
    return entry;
}

struct cJSON *render_work_json(const struct work_record *work) {
    cJSON *object = cJSON_CreateObject();
    add_whole(object, "rays", work->rays);
    add_whole(object, "samples_composed", work->composed);
    add_whole(object, "regions_touched", work->regions_touched);
    cJSON *instances = cJSON_AddArrayToObject(object, "instances"),
          *lights = cJSON_AddArrayToObject(object, "lights");
    for (uint32_t i = 0; i < work->count; i++)
        cJSON_AddItemToArray(work->instances[i].instance > SHADING_WORK_SHARED ? lights : instances,
                             entry_json(&work->instances[i]));
    add_whole(object, "modules_loaded", render_modules_loaded(work));
    return object;
}
