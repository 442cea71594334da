/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/call_sites_json.h"
#include "nodes/programs/json_output.h"
#include "nodes/programs/render_report.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

static void add_frame(cJSON *frames, const struct frame_record *f,
                      const struct explanation *explanation, uint32_t index) {
    cJSON *frame = cJSON_CreateObject();
    json_add_whole(frame, "frame", f->number);
    json_add_whole(frame, "time_ps", f->time_ps);
    json_add_whole(frame, "start_ps", f->start_ps);
    json_add_whole(frame, "end_ps", f->end_ps);
    json_add_whole(frame, "time_ticks", f->time);
    json_add_whole(frame, "start_ticks", f->start);
    json_add_whole(frame, "end_ticks", f->end);
    cJSON_AddStringToObject(frame, "bound_by", timing_resource_name(f->bound_by));
    json_add_whole(frame, "regions", f->regions);
    json_add_whole(frame, "regions_covered", f->regions_covered);
    json_add_whole(frame, "samples_covered", (int64_t)f->samples_covered);
    cJSON *composition = cJSON_AddObjectToObject(frame, "composition");
    cJSON *bytes = cJSON_AddObjectToObject(composition, "bytes");
    json_add_whole(bytes, "depth", (int64_t)f->composition.depth);
    json_add_whole(bytes, "shader_id", (int64_t)f->composition.shader_id);
    json_add_whole(bytes, "parameters", (int64_t)f->composition.parameters);
    json_add_whole(bytes, "padding", (int64_t)f->composition.padding);
    json_add_whole(bytes, "total", (int64_t)f->composition.total);
    json_add_whole(composition, "sent_bytes", (int64_t)f->composition.sent);
    json_add_whole(composition, "busy_ps", f->composition.busy_ps);
    cJSON *geometry = cJSON_AddObjectToObject(frame, "geometry");
    bytes = cJSON_AddObjectToObject(geometry, "bytes");
    json_add_whole(bytes, "primitives", (int64_t)f->geometry.bytes[CAUSE_PRIMITIVES]);
    json_add_whole(bytes, "bound_parameters", (int64_t)f->geometry.bytes[CAUSE_BOUND_PARAMETERS]);
    json_add_whole(bytes, "shaders", (int64_t)f->geometry.bytes[CAUSE_SHADERS]);
    json_add_whole(bytes, "control", (int64_t)f->geometry.bytes[CAUSE_CONTROL]);
    json_add_whole(bytes, "total", (int64_t)f->geometry.total);
    json_add_whole(geometry, "busy_ps", f->geometry.busy_ps);
    cJSON *framebuffer = cJSON_AddObjectToObject(frame, "framebuffer");
    json_add_whole(framebuffer, "bytes", (int64_t)f->framebuffer.bytes);
    json_add_whole(framebuffer, "busy_ps", f->framebuffer.busy_ps);
    json_add_wholes(frame, "raster_busy_ps", f->raster_busy_ps, f->rendering_nodes);
    json_add_wholes(frame, "shading_busy_ps", f->shading_busy_ps, f->shading_nodes);
    cJSON *streams = cJSON_AddObjectToObject(frame, "instruction_streams");
    json_add_whole(streams, "generated", f->streams_generated);
    json_add_whole(streams, "reused", f->streams_reused);
    json_add_whole(frame, "nan_depths", (int64_t)f->nan_depths);
    json_add_whole(frame, "nan_colours", (int64_t)f->nan_colours);
    if (f->work.is_kept)
        cJSON_AddItemToObject(frame, "work", render_work_json(&f->work));
    if (explanation)
        explain_add_json(frame, explanation, index);
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
    json_add_whole(instance, "transfer_map_bytes", report->map_bytes);
    cJSON *parameters = cJSON_AddArrayToObject(instance, "parameters");
    for (int p = 0; p < report->parameter_count; p++) {
        cJSON *parameter = cJSON_CreateObject();
        cJSON_AddStringToObject(parameter, "name", report->parameters[p].name);
        json_add_whole(parameter, "bytes", report->parameters[p].bytes);
        cJSON_AddItemToArray(parameters, parameter);
    }
    json_add_whole(instance, "bound_bytes", (int64_t)report->bound_bytes);
    cJSON_AddItemToArray(instances, instance);
}

/* Calls of functions with a fast version, in the form of --fast-calls. */
static void add_calls(cJSON *calls, const struct shader_variant *variant) {
    for (int i = 0; i < variant->program->call_site_count; i++) {
        const struct shader_call_site *site = &variant->program->call_sites[i];
        cJSON *call = cJSON_CreateObject();
        cJSON_AddStringToObject(call, "shader", shader_variant_site_shader(variant, site));
        call_site_add_json(call, site);
        cJSON_AddItemToArray(calls, call);
    }
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
        json_add_whole(frame, "frame", report->frames[i].number);
        cJSON_AddNumberToObject(frame, "wall_s", wall_ns * 1e-9);
        json_add_whole(frame, "scaled_wall_ps", (int64_t)(wall_ns * 1000 * pace->scale + 0.5));
        json_add_whole(frame, "time_ps", report->frames[i].time_ps);
        cJSON_AddItemToArray(frames, frame);
    }
}

static cJSON *make_document(const struct render_options *options, const struct host_report *report,
                            double wall_s, const struct pace_report *pace,
                            const struct explanation *explanation) {
    cJSON *document = cJSON_CreateObject();
    const bool in_process = options->driver == DRIVER_IN_PROCESS;
    cJSON_AddStringToObject(document, "scene", options->host.scene);
    cJSON_AddStringToObject(document, "machine", options->host.machine.name);
    cJSON_AddStringToObject(document, "composition_strategy", options->host.strategy->name);
    cJSON_AddStringToObject(document, "assignment", options->by_cost ? "by-cost" : "round-robin");
    json_add_whole(document, "rendering_nodes", options->host.rendering_nodes);
    json_add_whole(document, "shading_nodes", options->host.shading_nodes);
    cJSON_AddStringToObject(document, "driver", in_process ? "in-process" : "processes");
    cJSON_AddStringToObject(document, "transport",
                            in_process                            ? "none"
                            : options->transport == TRANSPORT_TCP ? "tcp"
                                                                  : "ipc");
    json_add_whole(document, "ticks_per_s", (int64_t)options->host.machine.rate.per_s);
    cJSON *frames = cJSON_AddArrayToObject(document, "frames");
    for (size_t i = 0; i < report->frame_count; i++)
        add_frame(frames, &report->frames[i], explanation, (uint32_t)i);
    cJSON *instances = cJSON_AddArrayToObject(document, "instances");
    for (size_t i = 0; i < report->instance_count; i++)
        add_instance(instances, &report->instances[i]);
    cJSON *calls = cJSON_AddArrayToObject(document, "calls");
    for (uint32_t i = 0; i < shader_library_count(report->shaders); i++)
        add_calls(calls, shader_library_at(report->shaders, i));
    cJSON_AddNumberToObject(document, "wall_s", wall_s);
    if (pace->scale > 0)
        add_pace(document, report, pace);
    cJSON *warnings = cJSON_AddArrayToObject(document, "warnings");
    for (size_t i = 0; i < report->warning_count; i++)
        cJSON_AddItemToArray(warnings, cJSON_CreateString(report->warnings[i]));
    return document;
}

bool render_json_write(const struct render_options *options, const struct host_report *report,
                       double wall_s, const struct pace_report *pace,
                       const struct explanation *explanation, struct status *status) {
    cJSON *document = make_document(options, report, wall_s, pace, explanation);
    const bool ok = json_write_document(options->json, document, status);
    cJSON_Delete(document);
    return ok;
}
