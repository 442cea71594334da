/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "images/image.h"
#include "nodes/driver_in_process.h"
#include "nodes/framebuffer_node.h"
#include "nodes/host_node.h"
#include "nodes/local_services.h"
#include "nodes/rendering_node.h"
#include "nodes/shading_node.h"
#include "nodes/visibility.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { REGIONS = 40, REGION_SAMPLES = 8192, SHADERS_MAX = 8 };

/* A cluster in this process with its messages tapped. */
struct tapped {
    uint64_t charged[CAUSE_COUNT]; /* geometry messages, broadcasts once */
    struct message *last; /* of the broadcast at hand; held, so that no other takes its address */
    uint64_t regions_sent, region_bytes, empty_messages;
    uint64_t shader_loads;
    /* of REGION messages between nodes: all, and those to shading nodes */
    struct tapped_region {
        uint64_t messages, final_messages;
        bool is_covered;
    } regions[REGIONS];
    uint64_t arrived[SHADERS_MAX]; /* samples that came to shading nodes, by shader ID */
};

static void tap_region(struct tapped *tapped, struct node_address to, uint32_t region,
                       const struct message *message) {
    struct region_view view;
    assert_true(region < REGIONS && (to.role == NODE_RENDERING || to.role == NODE_SHADING));
    assert_true(region_open(message->bytes, message->length, REGION_SAMPLES, &view, NULL));
    tapped->regions[region].messages++;
    tapped->regions[region].final_messages += to.role == NODE_SHADING;
    tapped->regions[region].is_covered |= view.head.sample_count > 0;
    for (uint32_t i = 0; to.role == NODE_SHADING && i < view.head.sample_count; i++) {
        assert_true(view.shader[i] < SHADERS_MAX);
        tapped->arrived[view.shader[i]]++;
    }
}

static void tap(void *context, struct node_address from, const struct node_output *output) {
    struct tapped *tapped = context;
    struct wire_header header;
    assert_true(wire_open(output->message->bytes, output->message->length, &header, NULL));
    tapped->regions_sent += header.kind == WIRE_REGION;
    tapped->region_bytes += header.kind == WIRE_REGION ? output->message->length : 0;
    tapped->empty_messages += header.kind == WIRE_EMPTY_REGIONS;
    if (header.kind == WIRE_REGION && from.role == NODE_RENDERING &&
        output->to.role != NODE_FRAMEBUFFER)
        tap_region(tapped, output->to, header.region, output->message);
    if (from.role != NODE_HOST || output->message == tapped->last ||
        header.kind == WIRE_CONFIGURATION)
        return;
    message_release(tapped->last);
    tapped->last = message_hold(output->message);
    tapped->charged[header.cause] += header.charged_bytes[0];
    tapped->charged[CAUSE_CONTROL] += header.charged_bytes[1];
}

static struct node_services counting;
static struct tapped *counting_into;

static bool count_load(void *context, const char *name, const char *source,
                       const struct shader_module **module, struct status *status) {
    struct node_services *inner = context;
    counting_into->shader_loads++;
    return inner->load_shader(inner->context, name, source, module, status);
}

static bool keep_nothing(void *context, struct image *image, const char *path, uint32_t compression,
                         bool png, struct status *status) {
    image_destroy(image);
    return true;
}

static bool nothing_to_finish(void *context, struct status *status) {
    return true;
}

static const struct strategy *strategy; /* of the clusters to come; NULL: the chain */

/* Renders a scene text; the report stays valid until the cluster is finished by the caller's
 * `check`. */
static void run(const char *text, uint32_t r, uint32_t s, int frames, struct tapped *tapped,
                void (*check)(const struct host_report *report, const struct tapped *tapped)) {
    static const char *const folders[] = {SHADERS};
    char path[] = "/tmp/sortlast-test-XXXXXX";
    const int descriptor = mkstemp(path);
    assert_int_equal(write(descriptor, text, strlen(text)), strlen(text));
    close(descriptor);
    static struct trace trace;
    trace_init(&trace, "test", NULL);
    struct local_services *services = local_services_create(&trace, NULL);
    counting_into = tapped;
    counting = (struct node_services){(void *)local_services_interface(services), count_load,
                                      keep_nothing, nothing_to_finish};
    struct host_options options = {.scene = path,
                                   .rendering_nodes = r,
                                   .shading_nodes = s,
                                   .strategy = strategy,
                                   .shader_folders = folders,
                                   .shader_folder_count = 1,
                                   .frames = frames,
                                   .seed = 1};
    struct status status = {0};
    struct node *nodes[32];
    struct visibility_device *device;
    size_t count = 0;
    assert_true(visibility_device_create(&device, NULL));
    *tapped = (struct tapped){0};
    assert_true(machine_read_file(MACHINES "/pixelflow.json", &options.machine, NULL));
    assert_true(host_node_create(&options, NULL, NULL, NULL, &trace, &nodes[count++], &status));
    for (uint32_t i = 0; i < r; i++)
        assert_true(rendering_node_create(i, device, &trace, &nodes[count++], &status));
    for (uint32_t i = 0; i < s; i++)
        assert_true(shading_node_create(i, &counting, &trace, &nodes[count++], &status));
    assert_true(framebuffer_node_create(&counting, &trace, &nodes[count++], &status));
    const struct driver_options driver = {.tap = tap, .tap_context = tapped};
    if (!driver_in_process_run(nodes, count, &driver, &status))
        fail_msg("%s", status.message);
    check(host_node_report(nodes[0]), tapped);
    message_release(tapped->last);
    tapped->last = NULL;
    for (size_t i = 0; i < count; i++)
        node_destroy(nodes[i]);
    visibility_device_destroy(device);
    local_services_destroy(services);
    unlink(path);
}

#define CAMERA                                                                                     \
    "Format 640 512 1\nProjection \"perspective\" \"fov\" [40]\nWorldBegin\nLightSource "          \
    "\"distant\" 1\n"
static const char two_spheres[] =
    CAMERA "Surface \"plastic\"\nTranslate 0 0 5\nColor [1 0 0]\nSphere 1 -1 1 360\n"
           "Surface \"matte\"\nTranslate 0.5 0 0\nSphere 1 -1 1 360\nWorldEnd\n";

static void check_charges(const struct host_report *report, const struct tapped *tapped) {
    uint64_t reported[CAUSE_COUNT] = {0};
    for (size_t f = 0; f < report->frame_count; f++) {
        uint64_t sum = 0;
        for (int cause = 0; cause < CAUSE_COUNT; cause++) {
            reported[cause] += report->frames[f].geometry.bytes[cause];
            sum += report->frames[f].geometry.bytes[cause];
        }
        assert_int_equal(sum, report->frames[f].geometry.total);
    }
    for (int cause = 0; cause < CAUSE_COUNT; cause++)
        assert_int_equal(reported[cause], tapped->charged[cause]);
}

static void the_geometry_network_is_charged_what_its_messages_say(void **state) {
    (void)state;
    struct tapped tapped;
    run(two_spheres, 3, 2, 1, &tapped, check_charges);
    run(two_spheres, 1, 4, 3, &tapped, check_charges);
}

/* Every covered region is whole words of all its samples, once for each time that it comes, every
 * other a word a message. Both shaders of the scene take one word a sample. */
static void check_composition(const struct host_report *report, const struct tapped *tapped) {
    const struct frame_record *frame = &report->frames[0];
    const bool is_chain = !strategy->plan, is_direct = strategy == strategy_find("direct-send");
    uint64_t words = 0, sent_words = 0, samples = 0, map_bytes = 0;
    for (uint32_t k = 0; k < REGIONS; k++) {
        const struct tapped_region *region = &tapped->regions[k];
        if (region->is_covered) {
            words += REGION_SAMPLES * (is_direct ? frame->rendering_nodes : 1);
            sent_words += REGION_SAMPLES * (uint64_t)frame->rendering_nodes;
        } else {
            words += is_chain ? 1 : region->final_messages;
            sent_words += is_chain ? frame->rendering_nodes : region->messages;
        }
    }
    for (uint32_t id = 1; id < SHADERS_MAX; id++) {
        samples += tapped->arrived[id];
        if (id <= report->instance_count)
            map_bytes += tapped->arrived[id] * (report->instances[id - 1].map_bytes - 2);
    }
    assert_int_equal(frame->composition.total, words * 32);
    assert_int_equal(frame->composition.sent, sent_words * 32);
    assert_int_equal(frame->composition.depth, words * 4);
    assert_int_equal(frame->composition.shader_id, samples * 2);
    assert_int_equal(frame->composition.parameters, map_bytes);
    assert_int_equal(frame->composition.depth + frame->composition.shader_id +
                         frame->composition.parameters + frame->composition.padding,
                     frame->composition.total);
    /* one sphere hides a part of the other, which some node then sends in vain */
    if (is_direct && frame->rendering_nodes > 1)
        assert_true(samples > frame->samples_covered);
    else
        assert_int_equal(samples, frame->samples_covered);
}

static void the_composition_network_is_charged_what_comes_whatever_the_strategy(void **state) {
    (void)state;
    static const uint32_t nodes[] = {1, 2, 5, 8};
    struct tapped tapped;
    for (int i = 0; (strategy = strategy_at(i)); i++)
        for (size_t n = 0; n < sizeof nodes / sizeof *nodes; n++)
            run(two_spheres, nodes[n], 3, 1, &tapped, check_composition);
}

static void check_still(const struct host_report *report, const struct tapped *tapped) {
    assert_int_equal(report->frame_count, 4);
    for (size_t f = 1; f < 4; f++) {
        assert_int_equal(report->frames[f].samples_covered, report->frames[0].samples_covered);
        assert_int_equal(report->frames[f].composition.total, report->frames[0].composition.total);
        assert_int_equal(report->frames[f].geometry.bytes[CAUSE_PRIMITIVES],
                         report->frames[0].geometry.bytes[CAUSE_PRIMITIVES]);
    }
    /* shaders are announced once */
    assert_true(report->frames[0].geometry.bytes[CAUSE_SHADERS] > 0);
    assert_int_equal(report->frames[1].geometry.bytes[CAUSE_SHADERS], 0);
}

static void a_still_scene_repeats_its_frame(void **state) {
    (void)state;
    struct tapped tapped;
    run(two_spheres, 2, 2, 4, &tapped, check_still);
}

static void check_empty(const struct host_report *report, const struct tapped *tapped) {
    assert_int_equal(report->frames[0].regions, 40);
    assert_int_equal(report->frames[0].samples_covered, 0);
    assert_int_equal(tapped->regions_sent, 0);
    assert_int_equal(tapped->empty_messages, 3); /* one a hop for the whole frame */
    assert_int_equal(tapped->shader_loads, 0);
}

static void an_empty_frame_costs_one_message_a_hop_and_loads_no_shader(void **state) {
    (void)state;
    struct tapped tapped;
    run(CAMERA "WorldEnd\n", 3, 2, 1, &tapped, check_empty);
}

static void check_few(const struct host_report *report, const struct tapped *tapped) {
    /* 1000 instances are defined, 3 are in view: 3 surfaces and 1 light are loaded once each */
    assert_int_equal(report->instance_count, 3);
    assert_true(tapped->shader_loads <= 4);
}

static void only_instances_in_view_are_made_and_loaded(void **state) {
    (void)state;
    struct tapped tapped;
    char *text = NULL;
    size_t size = 0;
    FILE *scene = open_memstream(&text, &size);
    fprintf(scene, CAMERA);
    for (int i = 0; i < 1000; i++)
        fprintf(scene,
                "AttributeBegin Surface \"plastic\" \"uniform float roughness\" [%g] Translate %g "
                "0 5 Sphere 0.2 -0.2 0.2 360 "
                "AttributeEnd\n",
                0.01 + i * 1e-4, i < 3 ? i - 1.0 : 100.0 + i);
    fprintf(scene, "WorldEnd\n");
    fclose(scene);
    run(text, 2, 1, 1, &tapped, check_few);
    free(text);
}

static void check_merged(const struct host_report *report, const struct tapped *tapped) {
    assert_int_equal(report->instance_count, 1);
}

static void instances_equal_in_everything_are_one(void **state) {
    (void)state;
    struct tapped tapped;
    run(CAMERA "AttributeBegin Surface \"matte\" Translate 0 0 5 Sphere 1 -1 1 360 AttributeEnd\n"
               "AttributeBegin Translate 1 1 6 Surface \"matte\" Sphere 1 -1 1 360 "
               "AttributeEnd\nWorldEnd\n",
        2, 2, 1, &tapped, check_merged);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_geometry_network_is_charged_what_its_messages_say),
        cmocka_unit_test(the_composition_network_is_charged_what_comes_whatever_the_strategy),
        cmocka_unit_test(a_still_scene_repeats_its_frame),
        cmocka_unit_test(an_empty_frame_costs_one_message_a_hop_and_loads_no_shader),
        cmocka_unit_test(only_instances_in_view_are_made_and_loaded),
        cmocka_unit_test(instances_equal_in_everything_are_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
