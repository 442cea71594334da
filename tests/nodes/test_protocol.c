/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/rng.h"
#include "nodes/protocol.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
#include "tests/nodes/fuzz_wire.c" /* the same consumer, on seeded damage */

static struct message *sample_region(void) {
    struct region_draft draft = region_draft_create((struct region_head){
        .run_count = 2, .sample_count = 5, .slots = 2, .longest_map = 3, .work_count = 1});
    draft.work[0] = (struct region_work){2, 17};
    draft.runs[0] = (struct region_run){10, 2};
    draft.runs[1] = (struct region_run){100, 3};
    for (uint32_t i = 0; i < 5; i++) {
        draft.depth[i] = (float)i;
        draft.primitive[i] = i;
        draft.shader[i] = 1;
        draft.slots[i] = draft.slots[5 + i] = 0.5f;
    }
    return region_seal(&draft, 3, 7, 1);
}

static struct message *sample_colour(void) {
    struct message *region = sample_region();
    struct region_view view;
    assert_true(region_open(region->bytes, region->length, 8192, &view, NULL));
    struct colour_draft draft = colour_draft_create(&view, &(struct region_sums){10, 5, 10}, 2);
    draft.work[1].operations[SIMD_SIN] = 4;
    for (int c = 0; c < 3; c++)
        memset(draft.color[c], 0, 5 * sizeof(float));
    message_release(region);
    return colour_seal(&draft, 3, 7, 1);
}

static struct message *sample_instance(void) {
    static const float bound[] = {1, 2, 3}, matrices[64] = {1};
    static const uint8_t given[] = {1, 0, 1};
    static const uint32_t lights[] = {0, 4};
    static const int32_t names[] = {SHADER_STRING_HASHED | 7};
    const struct instance_payload payload = {.id = 1,
                                             .shader = 2,
                                             .bound_count = 3,
                                             .bound = bound,
                                             .given = given,
                                             .spaces = 0x14,
                                             .matrices = matrices,
                                             .named_count = 1,
                                             .names = names,
                                             .named_matrices = matrices,
                                             .light_count = 2,
                                             .lights = lights,
                                             .text_bytes = 6,
                                             .texts = "a\0bcd",
                                             .category = "key"};
    return instance_payload_encode(&payload, WIRE_INSTANCE, 0);
}

static struct message *sample_chunk(void) {
    static const struct slot_format formats[2] = {{SLOT_HALF, 16, 0, 0}, {SLOT_FIXED, 8, 1, -3}};
    static const float positions[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9}, material[6] = {1, 2, 3, 4, 5, 6};
    static const uint16_t triangles[3] = {2, 0, 1};
    const struct chunk_payload payload = {5, 1000, 7, 3, 1, 2, 8, formats, positions, material, triangles};
    return chunk_payload_encode(&payload, 0);
}

static struct message *sample_configuration(void) {
    struct configuration configuration = {
        .rendering_nodes = 4, .shading_nodes = 3, .strategy = strategy_at(0)};
    assert_true(machine_read_file(MACHINES "/pixelflow.json", &configuration.machine, NULL));
    return configuration_encode(&configuration);
}

static struct message *sample_record(void) {
    int64_t busy[3] = {1, 2, 3};
    const struct frame_record record = {.frame = 2,
                                        .rendering_nodes = 3,
                                        .shading_nodes = 2,
                                        .raster_busy_ps = busy,
                                        .shading_busy_ps = busy,
                                        .time_ps = 5,
                                        .image_path = "x.exr"};
    return frame_record_encode(&record, 0);
}

/* Four regions of 128 x 64 samples, assigned. */
static struct message *sample_frame(void) {
    static const uint16_t assigned[] = {2, 0, 0, 1};
    const struct frame_payload frame = {.width = 200,
                                        .height = 100,
                                        .samples_x = 1,
                                        .samples_y = 1,
                                        .assigned_count = 4,
                                        .assigned = assigned,
                                        .image_path = "x.exr"};
    return frame_payload_encode(&frame, 0);
}

static struct message *sample_chunk_work(void) {
    static const struct chunk_work work[] = {{0, 3, 12, 1}, {0, 4, 1, 0}, {2, 3, 7, 1}};
    return chunk_work_encode(work, 3, 1, 2);
}

static struct message *sample_region_costs(void) {
    const struct shading_work work[] = {
        {.instance = SHADING_WORK_SHARED, .operations = {[SIMD_FLOAT_ADD] = 2}},
        {.instance = 3, .operations = {[SIMD_SIN] = 4}}};
    const struct region_costs costs[] = {
        {.region = 1, .samples = 5, .work = work, .work_count = 2},
        {.region = 9, .samples = 6, .work = work, .work_count = 1}};
    return region_costs_encode(costs, 2, 1, 0);
}

static void charges_are_what_the_messages_carry(void **state) {
    (void)state;
    struct wire_header header;
    struct message *instance = sample_instance(), *chunk = sample_chunk();
    assert_true(wire_open(instance->bytes, instance->length, &header, NULL));
    /* two floats were given, two coordinate systems and a named one are used, texts of 6 bytes and
     * a category of 3; identity, shader and two lights are control */
    assert_int_equal(header.cause, CAUSE_BOUND_PARAMETERS);
    assert_int_equal(header.charged_bytes[0], 2 * 4 + 3 * 64 + 6 + 3);
    assert_int_equal(header.charged_bytes[1], 8 + 2 * 4);
    assert_true(wire_open(chunk->bytes, chunk->length, &header, NULL));
    assert_int_equal(header.cause, CAUSE_PRIMITIVES);
    assert_int_equal(header.charged_bytes[0], 3 * 12 + 3 * 2 * 4 + 6);
    message_release(instance);
    message_release(chunk);
}

static void what_is_encoded_is_decoded(void **state) {
    (void)state;
    struct message *message = sample_chunk();
    struct chunk_payload chunk;
    assert_true(chunk_payload_decode(message, &chunk, NULL));
    assert_int_equal(chunk.first_primitive, 1000);
    assert_true(chunk.material[5] == 6);
    assert_int_equal(chunk.triangles[0], 2);
    message_release(message);
    message = sample_record();
    struct frame_record record;
    assert_true(frame_record_decode(message, &record, NULL));
    assert_int_equal(record.time_ps, 5);
    assert_int_equal(record.raster_busy_ps[2], 3);
    assert_string_equal(record.image_path, "x.exr");
    frame_record_finish(&record);
    message_release(message);
    message = sample_region_costs();
    struct region_costs *costs;
    size_t count;
    assert_true(region_costs_decode(message, &costs, &count, NULL));
    assert_int_equal(count, 2);
    assert_int_equal(costs[1].region, 9);
    assert_int_equal(costs[0].work[1].operations[SIMD_SIN], 4);
    free(costs);
    message_release(message);
    message = sample_configuration();
    struct configuration configuration;
    assert_true(configuration_decode(message, &configuration, NULL));
    assert_int_equal(configuration.shading_nodes, 3);
    assert_int_equal(configuration.machine.rate.per_s, 200000000);
    message_release(message);
}

typedef struct message *maker(void);
static maker *const makers[] = {sample_region,     sample_colour,        sample_instance,
                                sample_chunk,      sample_configuration, sample_record,
                                sample_chunk_work, sample_region_costs,  sample_frame};

static void a_flipped_bit_is_noticed_by_who_takes_the_message_apart(void **state) {
    (void)state;
    for (size_t m = 0; m < sizeof makers / sizeof *makers; m++) {
        struct message *message = makers[m]();
        for (size_t bit = 0; bit < message->length * 8; bit++) {
            struct wire_header header;
            struct region_view region;
            struct colour_view colour;
            message->bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
            bool accepted = wire_open(message->bytes, message->length, &header, NULL);
            if (accepted && header.kind == WIRE_REGION)
                accepted = region_open(message->bytes, message->length, 8192, &region, NULL);
            else if (accepted && header.kind == WIRE_COLOUR)
                accepted = colour_open(message, 8192, 16, &colour, NULL);
            if (accepted)
                fail_msg("message %zu: bit %zu can be flipped unnoticed", m, bit);
            message->bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
        }
        message_release(message);
    }
}

static void damaged_payloads_under_good_checksums_do_no_harm(void **state) {
    (void)state;
    struct rng rng = {6};
    static const enum wire_kind kinds[] = {WIRE_REGION,     WIRE_COLOUR,        WIRE_INSTANCE,
                                           WIRE_CHUNK,      WIRE_CONFIGURATION, WIRE_FRAME_DONE,
                                           WIRE_CHUNK_WORK, WIRE_REGION_COSTS,  WIRE_FRAME_BEGIN};
    for (size_t m = 0; m < sizeof makers / sizeof *makers; m++) {
        struct message *message = makers[m]();
        const size_t length = message->length - WIRE_HEADER_BYTES;
        uint8_t *input = malloc(length + 1);
        for (int round = 0; round < 20000; round++) {
            input[0] = (uint8_t)kinds[m];
            memcpy(input + 1, message->bytes + WIRE_HEADER_BYTES, length);
            for (uint64_t damage = 1 + rng_below(&rng, 4); damage; damage--)
                input[1 + rng_below(&rng, length)] =
                    (uint8_t)(rng_below(&rng, 2) ? rng_next(&rng) : rng_below(&rng, 2) * 255);
            LLVMFuzzerTestOneInput(input,
                                   1 + (rng_below(&rng, 4) ? length : rng_below(&rng, length + 1)));
        }
        free(input);
        message_release(message);
    }
}

static void a_frame_assigns_its_regions_to_nodes_that_are_there(void **state) {
    (void)state;
    const struct machine machine = {.region_width = 128, .region_height = 64};
    struct message *message = sample_frame();
    struct frame_payload frame;
    assert_true(frame_payload_decode(message, &frame, NULL));
    assert_true(region_grid_check(&frame, &machine, 3, NULL));
    assert_int_equal(frame_payload_shading_node(&frame, 3, 3), 1);
    assert_false(region_grid_check(&frame, &machine, 2, NULL));
    frame.assigned_count = 3;
    assert_false(region_grid_check(&frame, &machine, 3, NULL));
    frame.assigned_count = 0;
    assert_true(region_grid_check(&frame, &machine, 2, NULL));
    assert_int_equal(frame_payload_shading_node(&frame, 3, 2), 1);
    message_release(message);
}

static void messages_of_another_build_are_named(void **state) {
    (void)state;
    struct message *message = sample_chunk();
    struct wire_header header;
    struct status status = {0};
    message->bytes[4]++;
    assert_false(wire_open(message->bytes, message->length, &header, &status));
    assert_non_null(strstr(status.message, "version"));
    message->bytes[0]++;
    assert_false(wire_open(message->bytes, message->length, &header, &status));
    assert_non_null(strstr(status.message, "another program"));
    assert_false(wire_open(message->bytes, 10, &header, &status));
    message_release(message);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charges_are_what_the_messages_carry),
        cmocka_unit_test(what_is_encoded_is_decoded),
        cmocka_unit_test(a_flipped_bit_is_noticed_by_who_takes_the_message_apart),
        cmocka_unit_test(damaged_payloads_under_good_checksums_do_no_harm),
        cmocka_unit_test(a_frame_assigns_its_regions_to_nodes_that_are_there),
        cmocka_unit_test(messages_of_another_build_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
