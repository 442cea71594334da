/* SPDX-License-Identifier: Apache-2.0 */
#include "images/replacement_file.h"
#include "nodes/programs/render_report.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Whole numbers go in as text: doubles would round those beyond 2^53. */
static void add_whole(cJSON *object, const char *key, int64_t value) {
    char text[32];
    snprintf(text, sizeof text, "%" PRId64, value);
    cJSON_AddRawToObject(object, key, text);
}

static void add_times(cJSON *object, const char *key, const int64_t *times, uint32_t count) {
    cJSON *array = cJSON_AddArrayToObject(object, key);
    for (uint32_t i = 0; i < count; i++) {
        char text[32];
        snprintf(text, sizeof text, "%" PRId64, times[i]);
        cJSON_AddItemToArray(array, cJSON_CreateRaw(text));
    }
}

static void add_frame(cJSON *frames, const struct frame_record *f) {
    cJSON *frame = cJSON_CreateObject();
    add_whole(frame, "frame", f->number);
    add_whole(frame, "time_ps", f->time_ps);
    add_whole(frame, "start_ps", f->start_ps);
    add_whole(frame, "end_ps", f->end_ps);
    add_whole(frame, "time_ticks", f->time);
    add_whole(frame, "start_ticks", f->start);
    add_whole(frame, "end_ticks", f->end);
    cJSON_AddStringToObject(frame, "bound_by", timing_resource_name(f->bound_by));
    add_whole(frame, "regions", f->regions);
    add_whole(frame, "regions_covered", f->regions_covered);
    add_whole(frame, "samples_covered", (int64_t)f->samples_covered);
    cJSON *composition = cJSON_AddObjectToObject(frame, "composition");
    cJSON *bytes = cJSON_AddObjectToObject(composition, "bytes");
    add_whole(bytes, "depth", (int64_t)f->composition.depth);
    add_whole(bytes, "shader_id", (int64_t)f->composition.shader_id);
    add_whole(bytes, "parameters", (int64_t)f->composition.parameters);
    add_whole(bytes, "padding", (int64_t)f->composition.padding);
    add_whole(bytes, "total", (int64_t)f->composition.total);
    add_whole(composition, "busy_ps", f->composition.busy_ps);
    cJSON *geometry = cJSON_AddObjectToObject(frame, "geometry");
    bytes = cJSON_AddObjectToObject(geometry, "bytes");
    add_whole(bytes, "primitives", (int64_t)f->geometry.bytes[CAUSE_PRIMITIVES]);
    add_whole(bytes, "bound_parameters", (int64_t)f->geometry.bytes[CAUSE_BOUND_PARAMETERS]);
    add_whole(bytes, "shaders", (int64_t)f->geometry.bytes[CAUSE_SHADERS]);
    add_whole(bytes, "control", (int64_t)f->geometry.bytes[CAUSE_CONTROL]);
    add_whole(bytes, "total", (int64_t)f->geometry.total);
    add_whole(geometry, "busy_ps", f->geometry.busy_ps);
    cJSON *framebuffer = cJSON_AddObjectToObject(frame, "framebuffer");
    add_whole(framebuffer, "bytes", (int64_t)f->framebuffer.bytes);
    add_whole(framebuffer, "busy_ps", f->framebuffer.busy_ps);
    add_times(frame, "raster_busy_ps", f->raster_busy_ps, f->rendering_nodes);
    add_times(frame, "shading_busy_ps", f->shading_busy_ps, f->shading_nodes);
    add_whole(frame, "nan_depths", (int64_t)f->nan_depths);
    add_whole(frame, "nan_colours", (int64_t)f->nan_colours);
    if (f->work.is_kept)
        cJSON_AddItemToObject(frame, "work", render_work_json(&f->work));
    if (f->image_path[0])
        cJSON_AddStringToObject(frame, "image", f->image_path);
    else
        cJSON_AddNullToObject(frame, "image");
    cJSON_AddItemToArray(frames, frame);
}

static void add_instance(cJSON *instances, const struct instance_report *report) {
    cJSON *instance = cJSON_CreateObject();
    cJSON_AddStringToObject(instance, "name", report->name);
    cJSON_AddStringToObject(instance, "shader", report->shader);
    add_whole(instance, "transfer_map_bytes", report->map_bytes);
    cJSON *parameters = cJSON_AddArrayToObject(instance, "parameters");
    for (int p = 0; p < report->parameter_count; p++) {
        cJSON *parameter = cJSON_CreateObject();
        cJSON_AddStringToObject(parameter, "name", report->parameters[p].name);
        add_whole(parameter, "bytes", report->parameters[p].bytes);
        cJSON_AddItemToArray(parameters, parameter);
    }
    add_whole(instance, "bound_bytes", (int64_t)report->bound_bytes);
    cJSON_AddItemToArray(instances, instance);
}

/* How the wall time of each frame, times the scale, compares with the solved time. */
static void add_pace(cJSON *document, const struct host_report *report,
                     const struct pace_report *pace) {
    cJSON *object = cJSON_AddObjectToObject(document, "pace");
    cJSON_AddNumberToObject(object, "scale", pace->scale);
    cJSON *frames = cJSON_AddArrayToObject(object, "frames");
    for (size_t i = 0; i < report->frame_count; i++) {
        const double wall_ns = (double)pace_frame_ns(pace, i);
        cJSON *frame = cJSON_CreateObject();
        add_whole(frame, "frame", report->frames[i].number);
        cJSON_AddNumberToObject(frame, "wall_s", wall_ns * 1e-9);
        add_whole(frame, "scaled_wall_ps", (int64_t)(wall_ns * 1000 * pace->scale + 0.5));
        add_whole(frame, "time_ps", report->frames[i].time_ps);
        cJSON_AddItemToArray(frames, frame);
    }
}

static cJSON *make_document(const struct render_options *options, const struct host_report *report,
                            double wall_s, const struct pace_report *pace) {
    cJSON *document = cJSON_CreateObject();
    const bool in_process = options->driver == DRIVER_IN_PROCESS;
    cJSON_AddStringToObject(document, "scene", options->host.scene);
    cJSON_AddStringToObject(document, "machine", options->host.machine.name);
    add_whole(document, "rendering_nodes", options->host.rendering_nodes);
    add_whole(document, "shading_nodes", options->host.shading_nodes);
    cJSON_AddStringToObject(document, "driver", in_process ? "in-process" : "processes");
    cJSON_AddStringToObject(document, "transport",
                            in_process                            ? "none"
                            : options->transport == TRANSPORT_TCP ? "tcp"
                                                                  : "ipc");
    add_whole(document, "ticks_per_s", (int64_t)options->host.machine.rate.per_s);
    cJSON *frames = cJSON_AddArrayToObject(document, "frames");
    for (size_t i = 0; i < report->frame_count; i++)
        add_frame(frames, &report->frames[i]);
    cJSON *instances = cJSON_AddArrayToObject(document, "instances");
    for (size_t i = 0; i < report->instance_count; i++)
        add_instance(instances, &report->instances[i]);
    cJSON_AddNumberToObject(document, "wall_s", wall_s);
    if (pace->scale > 0)
        add_pace(document, report, pace);
    cJSON *warnings = cJSON_AddArrayToObject(document, "warnings");
    for (size_t i = 0; i < report->warning_count; i++)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(report->warnings[i]));
    return document;
}

static bool write_file(const char *path, const char *text, struct status *status) {
    struct replacement_file file;
    if (!strcmp(path, "-"))
        return (puts(text) >= 0 && !fflush(stdout)) ||
               status_fail(status, STATUS_IO, "cannot write the JSON summary to standard output");
    if (!replacement_file_open(&file, path, status))
        return false;
    replacement_file_append(&file, text, strlen(text));
    replacement_file_append(&file, "\n", 1);
    return replacement_file_commit(&file, status); /* carries the cause of a failed write */
}

bool render_json_write(const struct render_options *options, const struct host_report *report,
                       double wall_s, const struct pace_report *pace, struct status *status) {
    cJSON *document = make_document(options, report, wall_s, pace);
    char *text = cJSON_Print(document);
    cJSON_Delete(document);
    bool ok = text ? write_file(options->json, text, status)
                   : status_fail(status, STATUS_LIMIT, "no memory for the JSON summary");
    free(text);
    return ok;
}
