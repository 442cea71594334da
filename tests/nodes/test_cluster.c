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

/* A cluster in this process with its messages tapped. */
struct tapped {
    uint64_t charged[CAUSE_COUNT]; /* geometry messages, broadcasts once */
    struct message *last; /* of the broadcast at hand; held, so that no other takes its address */
    uint64_t regions_sent, region_bytes, empty_messages;
    uint64_t shader_loads;
};

static void tap(void *context, struct node_address from, const struct node_output *output) {
    struct tapped *tapped = context;
    struct wire_header header;
    assert_true(wire_open(output->message->bytes, output->message->length, &header, NULL));
    tapped->regions_sent += header.kind == WIRE_REGION;
    tapped->region_bytes += header.kind == WIRE_REGION ? output->message->length : 0;
    tapped->empty_messages += header.kind == WIRE_EMPTY_REGIONS;
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
        cmocka_unit_test(a_still_scene_repeats_its_frame),
        cmocka_unit_test(an_empty_frame_costs_one_message_a_hop_and_loads_no_shader),
        cmocka_unit_test(only_instances_in_view_are_made_and_loaded),
        cmocka_unit_test(instances_equal_in_everything_are_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
