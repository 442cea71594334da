/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image.h"
#include "netsim/region.h"
#include "nodes/framebuffer_node.h"
#include "nodes/host_node.h"
#include "nodes/local_services.h"
#include "nodes/programs/calibrate.h"
#include "nodes/rendering_node.h"
#include "nodes/shading_node.h"
#include "nodes/visibility.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <zmq.h>

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare_times(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, size_t count) {
    qsort(values, count, sizeof *values, compare_times);
    return count ? values[count / 2] : 0;
}

/* ---- whole frames ---- */

enum { NODES = 4, FRAMES = 3, SAMPLES_MAX = 4096 };
/* How finely a sphere is diced: triangles of some eight samples, as those of the sample scenes. */
#define CHORD_PIXELS 0.35

/* Four nodes, and how long each step that handles a region took. */
struct bench_cluster {
    struct node *nodes[NODES];
    struct {
        size_t to;
        struct message *message;
    } * queue;
    size_t first, count, capacity;
    double times[NODES][SAMPLES_MAX];
    size_t time_count[NODES];
};

static bool step(struct bench_cluster *cluster, size_t i, const struct node_event *event,
                 struct status *status) {
    struct node_outputs outputs = {0};
    const bool is_region = event->kind == NODE_WORK ||
                           (event->kind == NODE_MESSAGE && event->header.kind == WIRE_COLOUR);
    const double begin = now_s();
    const bool ok = node_step(cluster->nodes[i], event, &outputs, status);
    if (is_region && cluster->time_count[i] < SAMPLES_MAX)
        cluster->times[i][cluster->time_count[i]++] = now_s() - begin;
    for (size_t o = 0; o < outputs.count; o++) {
        size_t to = 0;
        while (cluster->nodes[to]->address.role != outputs.items[o].to.role)
            to++;
        cluster->queue = memory_grow(cluster->queue, &cluster->capacity, cluster->count + 1,
                                     sizeof *cluster->queue);
        cluster->queue[cluster->count].to = to;
        cluster->queue[cluster->count++].message = outputs.items[o].message;
    }
    free(outputs.items);
    return ok;
}

static bool drive(struct bench_cluster *cluster, struct status *status) {
    bool ok = true;
    for (size_t i = 0; ok && i < NODES; i++)
        ok = step(cluster, i, &(struct node_event){.kind = NODE_START}, status);
    while (ok && !cluster->nodes[0]->is_finished) {
        if (cluster->first < cluster->count) {
            struct message *message = cluster->queue[cluster->first].message;
            const size_t to = cluster->queue[cluster->first++].to;
            struct node_event event = {.kind = NODE_MESSAGE, .message = message};
            ok = wire_open(message->bytes, message->length, &event.header, status) &&
                 step(cluster, to, &event, status);
            message_release(message);
            continue;
        }
        cluster->first = cluster->count = 0;
        size_t i = NODES;
        while (i > 0 && !cluster->nodes[i - 1]->has_work)
            i--;
        if (!i)
            return status_fail(status, STATUS_INTERNAL, "the cluster stands still");
        ok = step(cluster, i - 1, &(struct node_event){.kind = NODE_WORK}, status);
    }
    return ok;
}

static bool drop_image(void *context, struct image *image, const char *path, uint32_t compression,
                       bool png, struct status *status) {
    image_destroy(image);
    return true;
}

static bool nothing_to_finish(void *context, struct status *status) {
    return true;
}

static bool load(void *context, const char *name, const char *source,
                 const struct shader_module **module, struct status *status) {
    const struct node_services *inner = local_services_interface(context);
    return inner->load_shader(inner->context, name, source, module, status);
}

static void summarize(struct bench_cluster *cluster, struct calibrate_run *run) {
    const struct host_report *report = host_node_report(cluster->nodes[0]);
    const struct frame_record *frame = &report->frames[0];
    *run = (struct calibrate_run){
        .rendering_region_s = median(cluster->times[1], cluster->time_count[1]),
        .shading_region_s = median(cluster->times[2], cluster->time_count[2]),
        .framebuffer_region_s = median(cluster->times[3], cluster->time_count[3]),
        .regions = frame->regions,
        .shading_count = (double)frame->shading_busy_ps[0] * 1e-6 / frame->regions,
        .raster_count = (double)frame->raster_busy_ps[0] * 1e-6 / frame->regions,
    };
}

bool calibrate_render(const char *folder, const char *scene, const struct machine *machine,
                      struct calibrate_run *run, struct status *status) {
    char path[4200];
    static struct trace trace;
    trace_init(&trace, "calibrate", NULL);
    snprintf(path, sizeof path, "%s/scene.rib", folder);
    FILE *file = fopen(path, "w");
    if (!file || fputs(scene, file) < 0 || fclose(file))
        return status_fail(status, STATUS_IO, "cannot write %s", path);
    struct bench_cluster *cluster = memory_get(1, sizeof *cluster);
    struct local_services *services = local_services_create(&trace, NULL);
    const struct node_services interface = {services, load, drop_image, nothing_to_finish};
    const struct host_options options = {.scene = path,
                                         .rendering_nodes = 1,
                                         .shading_nodes = 1,
                                         .machine = *machine,
                                         .shader_folders = &folder,
                                         .shader_folder_count = 1,
                                         .reading = {.chord_pixels = CHORD_PIXELS},
                                         .frames = FRAMES,
                                         .seed = 1};
    struct visibility_device *device = NULL;
    size_t made = 0;
    bool ok = visibility_device_create(&device, status);
    ok = ok && host_node_create(&options, NULL, NULL, NULL, &trace, &cluster->nodes[0], status);
    made += ok;
    ok = ok && rendering_node_create(0, device, &trace, &cluster->nodes[1], status);
    made += ok;
    ok = ok && shading_node_create(0, &interface, &trace, &cluster->nodes[2], status);
    made += ok;
    ok = ok && framebuffer_node_create(&interface, &trace, &cluster->nodes[3], status);
    made += ok;
    ok = ok && drive(cluster, status);
    if (ok)
        summarize(cluster, run);
    while (cluster->first < cluster->count)
        message_release(cluster->queue[cluster->first++].message);
    for (size_t i = 0; i < made; i++)
        node_destroy(cluster->nodes[i]);
    visibility_device_destroy(device);
    local_services_destroy(services);
    free(cluster->queue);
    free(cluster);
    return ok;
}

/* ---- composition ---- */

static struct message *full_region(uint32_t samples, uint32_t floats, float depth) {
    struct region_draft draft = region_draft_create((struct region_head){
        .run_count = 1, .sample_count = samples, .slots = floats, .longest_map = floats});
    draft.runs[0] = (struct region_run){0, samples};
    for (uint32_t i = 0; i < samples; i++) {
        draft.depth[i] = depth + (float)(i % 2); /* either is in front in half the samples */
        draft.primitive[i] = i;
        draft.shader[i] = 1;
    }
    for (size_t i = 0; i < (size_t)samples * floats; i++)
        draft.slots[i] = (float)i;
    return region_seal(&draft, 0, 0, 0);
}

double calibrate_composition_s(const struct machine *machine, uint32_t floats) {
    enum { ROUNDS = 200 };
    const uint32_t samples = (uint32_t)machine_region_samples(machine);
    struct message *a = full_region(samples, floats, 1), *b = full_region(samples, floats, 1.5f);
    uint8_t *handed_on = memory_get(a->length, 1);
    double times[ROUNDS];
    for (int i = 0; i < ROUNDS; i++) {
        const double begin = now_s();
        struct region_view view_a, view_b;
        if (!region_open(a->bytes, a->length, samples, &view_a, NULL) ||
            !region_open(b->bytes, b->length, samples, &view_b, NULL))
            break;
        struct message *both = region_compose(&view_a, &view_b, 0, 0, 0);
        memcpy(handed_on, both->bytes, both->length);
        message_release(both);
        times[i] = now_s() - begin;
    }
    free(handed_on);
    message_release(a);
    message_release(b);
    return median(times, ROUNDS);
}

/* ---- sockets ---- */

enum { ECHOES = 400, BLOCKS = 2000, BLOCK_BYTES = 65536 };

struct echo {
    void *context;
    char there[4300], back[4300];
};

/* Sends small messages back, then takes blocks and says when all are here. */
static void *run_echo(void *argument) {
    struct echo *echo = argument;
    void *in = zmq_socket(echo->context, ZMQ_PULL), *out = zmq_socket(echo->context, ZMQ_PUSH);
    char *buffer = memory_get(BLOCK_BYTES, 1);
    zmq_bind(in, echo->there);
    zmq_connect(out, echo->back);
    zmq_send(out, "", 0, 0);
    for (int i = 0; i < ECHOES; i++) {
        const int length = zmq_recv(in, buffer, BLOCK_BYTES, 0);
        zmq_send(out, buffer, length > 0 ? (size_t)length : 0, 0);
    }
    for (int i = 0; i < BLOCKS; i++)
        zmq_recv(in, buffer, BLOCK_BYTES, 0);
    zmq_send(out, "", 0, 0);
    free(buffer);
    zmq_close(in);
    zmq_close(out);
    return NULL;
}

bool calibrate_sockets(const char *folder, double *latency_s, double *bytes_per_s,
                       struct status *status) {
    struct echo echo = {.context = zmq_ctx_new()};
    char *block = memory_get(BLOCK_BYTES, 1);
    double times[ECHOES];
    pthread_t thread;
    snprintf(echo.there, sizeof echo.there, "ipc://%s/there", folder);
    snprintf(echo.back, sizeof echo.back, "ipc://%s/back", folder);
    void *in = zmq_socket(echo.context, ZMQ_PULL), *out = zmq_socket(echo.context, ZMQ_PUSH);
    bool ok = !zmq_bind(in, echo.back) && !pthread_create(&thread, NULL, run_echo, &echo);
    if (!ok) {
        status_fail(status, STATUS_IO, "cannot open sockets in %s", folder);
    } else {
        zmq_recv(in, block, BLOCK_BYTES, 0);
        zmq_connect(out, echo.there);
        for (int i = 0; i < ECHOES; i++) {
            const double begin = now_s();
            zmq_send(out, block, 64, 0);
            zmq_recv(in, block, BLOCK_BYTES, 0);
            times[i] = (now_s() - begin) / 2;
        }
        const double begin = now_s();
        for (int i = 0; i < BLOCKS; i++)
            zmq_send(out, block, BLOCK_BYTES, 0);
        zmq_recv(in, block, BLOCK_BYTES, 0);
        *bytes_per_s = (double)BLOCKS * BLOCK_BYTES / (now_s() - begin);
        *latency_s = median(times, ECHOES);
        pthread_join(thread, NULL);
    }
    zmq_close(in);
    zmq_close(out);
    zmq_ctx_term(echo.context);
    free(block);
    return ok;
}
