/* SPDX-License-Identifier: Apache-2.0 */
/* The work of a frame without the cluster around it, in one loop each and one thread: Embree rays,
 * shading functions, the select of composition. What a cluster needs beyond their sum is its
 * overhead.
 *
 * usage: bare_kernels SCENE.rib [ROUNDS] */
#include "images/image.h"
#include "nodes/driver_in_process.h"
#include "nodes/framebuffer_node.h"
#include "nodes/host_node.h"
#include "nodes/local_services.h"
#include "nodes/rendering_node.h"
#include "nodes/shading_frame.h"
#include "nodes/shading_node.h"
#include "nodes/visibility.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Everything that passes by while the frame is rendered once by a cluster of one node each. */
struct recording {
    struct message **messages;
    struct wire_header *headers;
    size_t count, message_capacity, header_capacity;
};

static void record(void *context, struct node_address from, const struct node_output *output) {
    struct recording *recording = context;
    struct wire_header header;
    if (!wire_open(output->message->bytes, output->message->length, &header, NULL))
        return;
    const bool is_wanted = header.kind == WIRE_CHUNK ||
                           (output->to.role == NODE_SHADING && header.kind != WIRE_CONFIGURATION);
    if (!is_wanted)
        return;
    const size_t count = recording->count + 1;
    recording->messages =
        memory_grow(recording->messages, &recording->message_capacity, count, sizeof(void *));
    recording->headers =
        memory_grow(recording->headers, &recording->header_capacity, count, sizeof header);
    recording->messages[recording->count] = message_hold(output->message);
    recording->headers[recording->count++] = header;
}

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int die(const struct status *status) {
    fprintf(stderr, "bare_kernels: %s\n", status->message);
    exit(1);
}

static void record_frame(const char *scene, struct machine *machine,
                         struct local_services *services, struct trace *trace,
                         struct recording *recording) {
    static const char *const folders[] = {SHADERS};
    struct status status = {0};
    struct node *nodes[4];
    struct visibility_device *device = NULL;
    if (!machine_read_file(MACHINES "/pixelflow.json", machine, &status))
        die(&status);
    const struct host_options options = {.scene = scene,
                                         .rendering_nodes = 1,
                                         .shading_nodes = 1,
                                         .machine = *machine,
                                         .shader_folders = folders,
                                         .shader_folder_count = 1,
                                         .frames = 1,
                                         .seed = 1};
    const struct node_services *interface = local_services_interface(services);
    const struct driver_options driver = {.tap = record, .tap_context = recording};
    if (!visibility_device_create(&device, &status) ||
        !host_node_create(&options, NULL, NULL, NULL, trace, &nodes[0], &status) ||
        !rendering_node_create(0, device, trace, &nodes[1], &status) ||
        !shading_node_create(0, interface, trace, &nodes[2], &status) ||
        !framebuffer_node_create(interface, trace, &nodes[3], &status) ||
        !driver_in_process_run(nodes, 4, &driver, &status))
        die(&status);
    for (int i = 0; i < 4; i++)
        node_destroy(nodes[i]);
    visibility_device_destroy(device);
}

/* One Embree scene of all triangles, no filter, and all rays of the picture in coherent packets
 * of 16. */
static double time_rays(const struct recording *recording, const struct frame_payload *frame,
                        const struct region_grid *grid, int rounds) {
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    for (size_t i = 0; i < recording->count; i++) {
        struct chunk_payload chunk;
        if (recording->headers[i].kind != WIRE_CHUNK ||
            !chunk_payload_decode(recording->messages[i], &chunk, NULL))
            continue;
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        float *v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           12, chunk.vertex_count);
        uint32_t *t = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              12, chunk.triangle_count);
        memcpy(v, chunk.positions, chunk.vertex_count * 12);
        for (uint32_t k = 0; k < chunk.triangle_count * 3; k++)
            t[k] = chunk.triangles[k];
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    double best = INFINITY;
    for (int round = 0; round < rounds; round++) {
        const double begin = now_s();
        int valid[16] __attribute__((aligned(64)));
        memset(valid, 0xff, sizeof valid);
        for (uint32_t y = 0; y < grid->samples_high; y += 4)
            for (uint32_t x = 0; x < grid->samples_wide; x += 4) {
                struct RTCIntersectContext context;
                struct RTCRayHit16 rays;
                rtcInitIntersectContext(&context);
                context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
                for (uint32_t lane = 0; lane < 16; lane++) {
                    rays.ray.org_x[lane] = rays.ray.org_y[lane] = rays.ray.org_z[lane] = 0;
                    rays.ray.dir_x[lane] = region_grid_screen_x(grid, frame, x + lane % 4);
                    rays.ray.dir_y[lane] = region_grid_screen_y(grid, frame, y + lane / 4);
                    rays.ray.dir_z[lane] = 1;
                    rays.ray.tnear[lane] = rays.ray.time[lane] = 0;
                    rays.ray.tfar[lane] = INFINITY;
                    rays.ray.mask[lane] = UINT32_MAX;
                    rays.ray.flags[lane] = rays.ray.id[lane] = 0;
                    rays.hit.geomID[lane] = rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
                }
                rtcIntersect16(valid, scene, &context, &rays);
            }
        best = fmin(best, now_s() - begin);
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return best;
}

/* Samples of one instance, gathered beforehand. */
struct gathered {
    struct prepared_shader *instance;
    float *planes[64];
    size_t count, capacity;
};

static void gather_samples(struct gathered *to, const struct region_view *view, uint32_t sample,
                           const struct shading_frame *frame, uint32_t region, uint32_t location) {
    const size_t materials = (size_t)to->instance->module->material_count;
    if (to->count == to->capacity) {
        to->capacity = to->capacity ? to->capacity * 2 : 16384;
        for (size_t p = 0; p < materials + 6; p++) {
            float *grown = aligned_alloc(64, to->capacity * sizeof(float));
            if (to->planes[p])
                memcpy(grown, to->planes[p], to->count * sizeof(float));
            free(to->planes[p]);
            to->planes[p] = grown;
        }
    }
    uint32_t x, y;
    region_grid_origin(&frame->grid, region, &x, &y);
    const float z = view->depth[sample];
    const float position[3] = {
        region_grid_screen_x(&frame->grid, &frame->frame, x + location % frame->grid.region_width) *
            z,
        region_grid_screen_y(&frame->grid, &frame->frame, y + location / frame->grid.region_width) *
            z,
        z};
    for (size_t p = 0; p < materials; p++)
        to->planes[p][to->count] = view->slots[p * view->head.sample_count + sample];
    for (size_t c = 0; c < 3; c++)
        to->planes[materials + c][to->count] = position[c];
    to->count++;
}

static double shade_all(struct gathered *all, size_t count, int rounds) {
    enum { BATCH = 512 };
    static float out[6][BATCH] __attribute__((aligned(64))),
        scratch[64 * 7 * 16] __attribute__((aligned(64)));
    double best = INFINITY;
    for (int round = 0; round < rounds; round++) {
        const double begin = now_s();
        for (size_t i = 0; i < count; i++) {
            const struct shader_module *module = all[i].instance ? all[i].instance->module : NULL;
            for (size_t at = 0; module && at + BATCH <= all[i].count; at += BATCH) {
                const float *material[64];
                struct shader_call call = {.count = BATCH,
                                           .material = material,
                                           .uniform = all[i].instance->uniform,
                                           .matrices = all[i].instance->matrices,
                                           .lights = all[i].instance->lights,
                                           .light_count = all[i].instance->light_count,
                                           .light_vectors = 7,
                                           .light_scratch = scratch,
                                           .counters = &all[i].instance->counts.counters};
                for (int p = 0; p < module->material_count; p++)
                    material[p] = all[i].planes[p] + at;
                for (int c = 0; c < 3; c++) {
                    call.position[c] = call.incident[c] =
                        all[i].planes[module->material_count + c] + at;
                    call.color[c] = out[c];
                    call.opacity[c] = out[3 + c];
                }
                module->shade(&call);
            }
        }
        best = fmin(best, now_s() - begin);
    }
    return best;
}

static double time_shading(const struct recording *recording, struct shading_frame *frame,
                           struct shader_table *table, int rounds) {
    struct status status = {0};
    struct gathered *all = memory_get(frame->instance_count + 1, sizeof *all);
    const uint32_t samples = frame->grid.region_width * frame->grid.region_height;
    for (size_t i = 0; i < recording->count; i++) {
        struct region_view view;
        if (recording->headers[i].kind != WIRE_REGION ||
            !region_open(recording->messages[i]->bytes, recording->messages[i]->length, samples,
                         &view, &status))
            continue;
        uint32_t at = 0;
        for (uint32_t r = 0; r < view.head.run_count; r++)
            for (uint32_t k = 0; k < view.runs[r].count; k++, at++) {
                struct gathered *to = &all[view.shader[at]];
                if (!to->instance &&
                    !shading_frame_instance(frame, table, view.shader[at], &to->instance, &status))
                    die(&status);
                gather_samples(to, &view, at, frame, recording->headers[i].region,
                               view.runs[r].first + k);
            }
    }
    const double best = shade_all(all, frame->instance_count + 1, rounds);
    for (size_t i = 0; i <= frame->instance_count; i++)
        for (int p = 0; p < 64; p++)
            free(all[i].planes[p]);
    free(all);
    return best;
}

/* Every region selected once against another of the same shape: what one hop costs at least. */
static double time_selects(const struct recording *recording, int rounds) {
    double best = INFINITY;
    for (int round = 0; round < rounds; round++) {
        const double begin = now_s();
        for (size_t i = 0; i < recording->count; i++) {
            struct region_view view;
            if (recording->headers[i].kind != WIRE_REGION)
                continue;
            struct message *message = recording->messages[i];
            if (region_open(message->bytes, message->length, 1u << 20, &view, NULL))
                message_release(region_compose(&view, &view, 0, 0, 0));
        }
        best = fmin(best, now_s() - begin);
    }
    return best;
}

int main(int argc, char **argv) {
    const int rounds = argc > 2 ? atoi(argv[2]) : 5;
    struct recording recording = {0};
    struct machine machine;
    struct shader_table table = {0};
    struct shading_frame frame = {0};
    struct status status = {0};
    static struct trace trace;
    if (argc < 2) {
        fprintf(stderr, "usage: bare_kernels SCENE.rib [ROUNDS]\n");
        return 1;
    }
    trace_init(&trace, "bench", NULL);
    struct local_services *services = local_services_create(&trace, NULL);
    record_frame(argv[1], &machine, services, &trace, &recording);
    table.services = local_services_interface(services);
    for (size_t i = 0; i < recording.count; i++)
        switch (recording.headers[i].kind) {
        case WIRE_SHADER:
            if (!shader_table_announce(&table, recording.messages[i], &status))
                die(&status);
            break;
        case WIRE_FRAME_BEGIN:
            if (!frame_payload_decode(recording.messages[i], &frame.frame, &status))
                die(&status);
            frame.grid = region_grid_make(&frame.frame, &machine);
            break;
        case WIRE_LIGHT:
        case WIRE_INSTANCE:
            if (!shading_frame_add(&frame, recording.messages[i], recording.headers[i].kind,
                                   &status))
                die(&status);
            break;
        default:
            break;
        }
    const double rays = time_rays(&recording, &frame.frame, &frame.grid, rounds),
                 shading = time_shading(&recording, &frame, &table, rounds),
                 selects = time_selects(&recording, rounds);
    printf("{\"rays_s\": %.6f, \"shading_s\": %.6f, \"select_s\": %.6f}\n", rays, shading, selects);
    for (size_t i = 0; i < recording.count; i++)
        message_release(recording.messages[i]);
    free(recording.messages);
    free(recording.headers);
    shading_frame_finish(&frame);
    shader_table_finish(&table);
    local_services_destroy(services);
    return 0;
}
