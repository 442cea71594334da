/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "images/image.h"
#include "nodes/framebuffer_node.h"
#include "nodes/host_node.h"
#include "nodes/local_services.h"
#include "nodes/pacer.h"
#include "nodes/rendering_node.h"
#include "nodes/shading_node.h"
#include "nodes/visibility.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Whole clusters on a virtual clock: every node with its pacer, messages that arrive at once, nodes
 * that compute in no time. The pacers know nothing of the timing model, each only what passes at
 * its node; when the last colours are in, the clock must show what the model solved. */

enum { NODES_MAX = 32, FRAMES_MAX = 8 };
static const double scale = 1e-3;

struct arrival {
    size_t to;
    struct message *message;
};

struct cluster {
    struct node *nodes[NODES_MAX];
    struct pacer *pacers[NODES_MAX];
    size_t count;
    struct arrival *arrivals;
    size_t first, arrival_count, capacity;
    int64_t now, frame_done[FRAMES_MAX];
    int frames_done;
};

static void push(struct cluster *cluster, struct node_address to, struct message *message) {
    for (size_t i = 0; i < cluster->count; i++)
        if (cluster->nodes[i]->address.role == to.role &&
            cluster->nodes[i]->address.index == to.index) {
            cluster->arrivals = memory_grow(cluster->arrivals, &cluster->capacity,
                                            cluster->arrival_count + 1, sizeof(struct arrival));
            cluster->arrivals[cluster->arrival_count++] = (struct arrival){i, message};
            return;
        }
    fail_msg("a message goes to nobody");
}

static void step(struct cluster *cluster, size_t i, const struct node_event *event) {
    struct node_outputs outputs = {0};
    struct status status = {0};
    if (!node_step(cluster->nodes[i], event, &outputs, &status))
        fail_msg("%s", status.message);
    for (size_t o = 0; o < outputs.count; o++)
        if (!pacer_output(cluster->pacers[i], outputs.items[o].to, outputs.items[o].message,
                          cluster->now))
            push(cluster, outputs.items[o].to, outputs.items[o].message);
    free(outputs.items);
}

static void deliver(struct cluster *cluster, size_t i, struct message *message, bool is_paced) {
    struct node_event event = {.kind = NODE_MESSAGE, .message = message};
    assert_true(wire_open(message->bytes, message->length, &event.header, NULL));
    if (event.header.kind == WIRE_FRAME_DONE)
        cluster->frame_done[cluster->frames_done++] = cluster->now;
    if (is_paced || !pacer_input(cluster->pacers[i], &event, cluster->now))
        step(cluster, i, &event);
    message_release(message);
}

/* Everything that can happen at this instant. */
static void settle(struct cluster *cluster) {
    for (bool any = true; any;) {
        any = false;
        while (cluster->first < cluster->arrival_count) {
            const struct arrival arrival = cluster->arrivals[cluster->first++];
            deliver(cluster, arrival.to, arrival.message, false);
            any = true;
        }
        cluster->first = cluster->arrival_count = 0;
        for (size_t i = 0; i < cluster->count; i++) {
            struct pacer_action action;
            while (pacer_next(cluster->pacers[i], cluster->now, &action)) {
                any = true;
                if (action.is_delivery)
                    deliver(cluster, i, action.message, true);
                else
                    push(cluster, action.to, action.message);
            }
            if (cluster->nodes[i]->has_work && !pacer_is_full(cluster->pacers[i])) {
                step(cluster, i, &(struct node_event){.kind = NODE_WORK});
                any = true;
            }
        }
    }
}

static void run(struct cluster *cluster) {
    for (size_t i = 0; i < cluster->count; i++)
        step(cluster, i, &(struct node_event){.kind = NODE_START});
    for (;;) {
        settle(cluster);
        if (cluster->nodes[0]->is_finished)
            return;
        int64_t wake = INT64_MAX;
        for (size_t i = 0; i < cluster->count; i++) {
            const int64_t at = pacer_wake_ns(cluster->pacers[i]);
            wake = at < wake ? at : wake;
        }
        assert_true(wake < INT64_MAX); /* else nothing would ever happen again */
        assert_true(wake > cluster->now);
        cluster->now = wake;
    }
}

static bool keep_nothing(void *context, struct image *image, const char *path, uint32_t compression,
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

/* A change of one number of the machine. */
struct change {
    const char *parameter;
    int64_t value;
};

static void change_machine(struct machine *machine, const struct change *change) {
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(machine, values);
    for (int i = 0; i < MACHINE_VALUE_COUNT && change; i++)
        if (!strcmp(machine_parameter_at(i).name, change->parameter))
            values[i] = change->value;
    assert_true(machine_from_values("changed", values, machine, NULL));
}

/* Runs the bowling scene; every frame must end within `tolerance` of its solved end. */
static void check_cluster(uint32_t r, uint32_t s, int frames, const struct change *change,
                          double tolerance) {
    static const char *const folders[] = {SHADERS, SCENES "/bowling/shaders"};
    static struct trace trace;
    struct cluster cluster = {.now = 1000000000};
    struct visibility_device *device;
    trace_init(&trace, "test", NULL);
    struct local_services *services = local_services_create(&trace, NULL);
    const struct node_services interface = {services, load, keep_nothing, nothing_to_finish};
    struct host_options options = {.scene = SCENES "/bowling/bowling.rib",
                                   .rendering_nodes = r,
                                   .shading_nodes = s,
                                   .shader_folders = folders,
                                   .shader_folder_count = 2,
                                   .frames = frames,
                                   .seed = 1};
    options.reading.width = 640;
    options.reading.height = 512;
    assert_true(visibility_device_create(&device, NULL));
    assert_true(machine_read_file(MACHINES "/pixelflow.json", &options.machine, NULL));
    change_machine(&options.machine, change);
    assert_true(host_node_create(&options, NULL, NULL, NULL, &trace,
                                 &cluster.nodes[cluster.count++], NULL));
    for (uint32_t i = 0; i < r; i++)
        rendering_node_create(i, device, &trace, &cluster.nodes[cluster.count++], NULL);
    for (uint32_t i = 0; i < s; i++)
        shading_node_create(i, &interface, &trace, &cluster.nodes[cluster.count++], NULL);
    framebuffer_node_create(&interface, &trace, &cluster.nodes[cluster.count++], NULL);
    for (size_t i = 0; i < cluster.count; i++)
        cluster.pacers[i] = pacer_create(scale, false, cluster.nodes[i]->address);
    run(&cluster);
    const struct host_report *report = host_node_report(cluster.nodes[0]);
    assert_int_equal(report->frame_count, (size_t)frames);
    for (int f = 0; f < frames; f++) {
        const double wall_ps =
            1000.0 * (double)(cluster.frame_done[f] - pacer_begin_ns(cluster.pacers[0]));
        const double solved_ps = (double)report->frames[f].end_ps;
        const double error = wall_ps * scale / solved_ps - 1;
        if (getenv("PACER_VERBOSE"))
            printf("%u + %u, %s, frame %d (%s): %+.5f %%\n", r, s, change ? change->parameter : "",
                   f, timing_resource_name(report->frames[f].bound_by), 100 * error);
        if (!(fabs(error) <= tolerance))
            fail_msg("%u + %u nodes, frame %d: wall %.0f ps, solved %.0f ps: %+.4f %%", r, s, f,
                     wall_ps * scale, solved_ps, 100 * error);
    }
    for (size_t i = 0; i < cluster.count; i++) {
        node_destroy(cluster.nodes[i]);
        pacer_destroy(cluster.pacers[i]);
    }
    for (size_t i = cluster.first; i < cluster.arrival_count; i++)
        message_release(cluster.arrivals[i].message);
    free(cluster.arrivals);
    visibility_device_destroy(device);
    local_services_destroy(services);
}

static void a_paced_frame_takes_the_solved_time(void **state) {
    (void)state;
    check_cluster(1, 1, 1, NULL, 1e-4);
    check_cluster(4, 4, 1, NULL, 1e-4);
    check_cluster(3, 7, 1, NULL, 1e-4);
    check_cluster(2, 16, 1, NULL, 1e-4);
}

static void whatever_bounds_it(void **state) {
    (void)state;
    check_cluster(3, 5, 1, &(struct change){"composition_bytes_per_s", 100000000}, 1e-4);
    check_cluster(3, 5, 1, &(struct change){"geometry_bytes_per_s", 1000000}, 1e-4);
    check_cluster(3, 5, 1, &(struct change){"raster_triangle_ps", 50000000}, 1e-4);
    check_cluster(3, 5, 1, &(struct change){"raster_region_ps", 1000000000}, 1e-4);
    check_cluster(3, 5, 1, &(struct change){"composition_region_buffers", 1}, 1e-4);
    check_cluster(3, 5, 1, &(struct change){"colour_words", 64}, 1e-4);
}

static void frames_follow_each_other_as_solved(void **state) {
    (void)state;
    check_cluster(2, 3, 4, NULL, 1e-4);
    check_cluster(2, 3, 3, &(struct change){"composition_bytes_per_s", 100000000}, 1e-4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_paced_frame_takes_the_solved_time),
        cmocka_unit_test(whatever_bounds_it),
        cmocka_unit_test(frames_follow_each_other_as_solved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
