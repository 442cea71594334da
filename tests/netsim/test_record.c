/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/hash.h"
#include "base/rng.h"
#include "netsim/record_file.h"
#include "netsim/what_if.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
#include "tests/netsim/fuzz_record.c" /* the same consumer, on seeded damage */

static struct machine pixelflow(void) {
    struct machine machine;
    assert_true(machine_read_file(MACHINES "/pixelflow.json", &machine, NULL));
    return machine;
}

static void add_instance(struct record_frame *frame, const char *name, uint32_t own_floats) {
    struct record_instance *instance = &frame->instances[frame->instance_count++];
    instance->name = memory_copy_string(name);
    instance->shader = memory_copy_string("shader");
    instance->bound_bytes = 20;
    instance->parameters = memory_get(3, sizeof *instance->parameters);
    instance->parameter_count = 3;
    instance->parameters[0] =
        (struct record_parameter){memory_copy_string("N"), 3, 12, RECORD_MATERIAL, true};
    instance->parameters[1] = (struct record_parameter){memory_copy_string(name), own_floats,
                                                        4 * own_floats, RECORD_MATERIAL, false};
    instance->parameters[2] =
        (struct record_parameter){memory_copy_string("Kd"), 1, 4, RECORD_BOUND, false};
}

static void fill_regions(struct record_frame *frame, struct rng *rng) {
    for (uint32_t k = 0; k < frame->region_count; k++) {
        struct record_region *region = &frame->regions[k];
        for (uint32_t c = 0; c < frame->chunk_count; c++)
            if (rng_below(rng, 3) == 0)
                record_add_entry(
                    frame, region,
                    (struct record_entry){c, 1 + (uint32_t)rng_below(rng, 300), rng_below(rng, 2)});
        if (!region->entry_count || rng_below(rng, 4) == 0)
            continue;
        region->samples = 1 + (uint32_t)rng_below(rng, 8192);
        region->map_bytes = 12 * (uint64_t)region->samples;
        for (uint32_t w = 0; w < 3; w++) {
            uint64_t operations[SIMD_OPERATION_COUNT] = {0};
            operations[SIMD_FLOAT_ADD] = 1 + rng_below(rng, 200);
            operations[SIMD_SIN] = rng_below(rng, 3);
            operations[SIMD_POW_FAST] = rng_below(rng, 3);
            record_add_work(frame, region, w == 0 ? RECORD_SHARED : w, operations);
        }
    }
}

/* Two frames of 12 regions, the second with the same shaders and chunks. */
static struct run_record *sample_record(uint64_t seed) {
    struct rng rng = {seed};
    struct run_record *record = memory_get(1, sizeof *record);
    record->scene = memory_copy_string("sample.rib");
    record->machine = pixelflow();
    record->seed = 5;
    record->chunk_triangles = 256;
    for (int f = 0; f < 2; f++) {
        struct record_frame *frame = record_add_frame(record);
        frame->number = f + 1;
        frame->width = 512;
        frame->height = 192;
        frame->samples_x = frame->samples_y = 1;
        frame->region_count = 12;
        frame->regions = memory_get(12, sizeof *frame->regions);
        if (f) {
            record_copy_shaders(frame, frame - 1);
            record_copy_chunks(frame, frame - 1);
        } else {
            frame->instances = memory_get(2, sizeof *frame->instances);
            add_instance(frame, "short", 1);
            add_instance(frame, "long", 9);
            frame->lights = memory_get(1, sizeof *frame->lights);
            frame->light_count = 1;
            frame->lights[0] = memory_copy_string("lamp");
            /* two runs of twenty; each chunk has 10 vertices in common with the one before, and 3
             * with the one before that */
            static const struct record_sharing sharing[] = {{1, 10}, {2, 3}};
            for (uint32_t c = 0; c < 40; c++)
                record_add_chunk(frame,
                                 (struct record_chunk){1 + c / 20, 150, 256, c % 20 == 0, 0, 0},
                                 sharing, c % 20 < 2 ? c % 20 : 2);
        }
        const uint32_t floats[] = {4, 12};
        frame->geometry_bytes[CAUSE_PRIMITIVES] = record_primitive_bytes(frame, floats, NULL);
        frame->geometry_bytes[CAUSE_CONTROL] = 100;
        fill_regions(frame, &rng);
    }
    return record;
}

static void encode(const struct run_record *record, uint8_t **bytes, size_t *length) {
    assert_true(record_encode(record, bytes, length, NULL));
}

static void what_is_written_is_read(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        struct run_record *record = sample_record(seed), *read;
        uint8_t *bytes, *again;
        size_t length, length_again;
        encode(record, &bytes, &length);
        assert_true(record_decode("sample", bytes, length, &read, NULL));
        assert_string_equal(read->scene, "sample.rib");
        assert_int_equal(read->frames[1].entry_count, record->frames[1].entry_count);
        encode(read, &again, &length_again);
        assert_int_equal(length, length_again);
        assert_memory_equal(bytes, again, length);
        record_destroy(read);
        record_destroy(record);
        free(bytes);
        free(again);
    }
}

static void damage_of_a_file_is_noticed_and_named(void **state) {
    (void)state;
    struct run_record *record = sample_record(1), *read;
    uint8_t *bytes;
    size_t length;
    struct status status = {0};
    encode(record, &bytes, &length);
    for (size_t bit = 0; bit < length * 8; bit++) {
        bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
        if (record_decode("run.rec", bytes, length, &read, &status))
            fail_msg("bit %zu can be flipped unnoticed", bit);
        assert_ptr_equal(strstr(status.message, "run.rec"), status.message);
        bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
    }
    for (size_t cut = 0; cut < length; cut++)
        assert_false(record_decode("run.rec", bytes, cut, &read, &status));
    bytes[RECORD_AT_VERSION]++;
    assert_false(record_decode("run.rec", bytes, length, &read, &status));
    assert_non_null(strstr(status.message, "version 3"));
    bytes[RECORD_AT_MAGIC]++;
    assert_false(record_decode("run.rec", bytes, length, &read, &status));
    assert_non_null(strstr(status.message, "not a record"));
    free(bytes);
    record_destroy(record);
}

static void damaged_contents_under_good_checksums_do_no_harm(void **state) {
    (void)state;
    struct rng rng = {8};
    struct run_record *record = sample_record(1);
    uint8_t *bytes;
    size_t length;
    encode(record, &bytes, &length);
    uint64_t payload_length;
    memcpy(&payload_length, bytes + RECORD_AT_LENGTH, 8);
    uint8_t *payload = memory_get(payload_length, 1), *damaged = memory_get(payload_length, 1);
    uLongf size = payload_length;
    assert_int_equal(
        uncompress(payload, &size, bytes + RECORD_HEAD_BYTES, length - RECORD_HEAD_BYTES), Z_OK);
    const uint64_t accepted_before = fuzz_accepted;
    for (int round = 0; round < 10000; round++) {
        const size_t some = rng_below(&rng, 8) ? payload_length : rng_below(&rng, payload_length);
        /* the machine takes most of the bytes: half of the damage goes to what follows it */
        const size_t from = rng_below(&rng, 2) && some > 2500 ? 2000 : 0;
        memcpy(damaged, payload, some);
        for (uint64_t damage = 1 + rng_below(&rng, 3); damage && some > from; damage--)
            damaged[from + rng_below(&rng, some - from)] =
                (uint8_t)(rng_below(&rng, 2) ? rng_next(&rng) : rng_below(&rng, 2) * 255);
        LLVMFuzzerTestOneInput(damaged, some);
    }
    /* numbers may change without breaking a rule */
    assert_true(fuzz_accepted > accepted_before + 100);
    free(payload);
    free(damaged);
    free(bytes);
    record_destroy(record);
}

static struct what_if_result answer(const struct run_record *record, const struct what_if *question,
                                    struct what_if_frame frames[2]) {
    struct what_if_solver *solver = what_if_solver_create(record);
    struct what_if_result result;
    assert_true(what_if_solve(solver, question, NULL, &result, NULL));
    memcpy(frames, result.frames, 2 * sizeof *frames);
    what_if_solver_destroy(solver);
    return result;
}

/* Maps are 18 and 50 bytes with the ID: one word and two; together 14 floats, 58 bytes, three. */
static void maps_change_words_and_bytes_as_arithmetic_says(void **state) {
    (void)state;
    struct run_record *record = sample_record(3);
    struct what_if question = what_if_default(record);
    struct what_if_frame base[2], other[2];
    assert_int_equal(what_if_map_bytes(&record->frames[0], 0, &question), 16);
    assert_int_equal(what_if_map_bytes(&record->frames[0], 1, &question), 48);
    answer(record, &question, base);
    question.maps = WHAT_IF_MAPS_UNION;
    assert_int_equal(what_if_map_bytes(&record->frames[0], 1, &question), 4 * (3 + 1 + 9));
    answer(record, &question, other);
    uint64_t bytes = 0;
    for (uint32_t k = 0; k < 12; k++)
        bytes += record->frames[0].regions[k].samples ? 8192 * 32 * 2 : 32;
    assert_int_equal(other[0].times.composition_bytes, bytes);
    assert_int_equal(other[0].geometry_bytes, base[0].geometry_bytes);
    question.maps = WHAT_IF_MAPS_UNBOUND;
    answer(record, &question, other);
    assert_int_equal(other[0].geometry_bytes, base[0].geometry_bytes + 40 * 150 * 4);
    question.maps = WHAT_IF_MAPS_SPECIFIC;
    question.binds = &(struct what_if_bind){"long", "long"};
    question.bind_count = 1;
    assert_int_equal(what_if_map_bytes(&record->frames[0], 1, &question), 12);
    answer(record, &question, other);
    assert_int_equal(other[0].geometry_bytes, base[0].geometry_bytes - 20 * 150 * 4 * 9 + 4 * 9);
    bytes = 0;
    for (uint32_t k = 0; k < 12; k++)
        bytes += record->frames[0].regions[k].samples ? 8192 * 32 : 32;
    assert_int_equal(other[0].times.composition_bytes, bytes);
    record_destroy(record);
}

static void repricing_goes_both_ways(void **state) {
    (void)state;
    struct run_record *record = sample_record(4);
    struct what_if question = what_if_default(record);
    const struct machine *m = &question.machine;
    for (uint32_t k = 0; k < 12; k++) {
        const struct record_frame *frame = &record->frames[0];
        const struct record_region *region = &frame->regions[k];
        int64_t sin = 0, pow = 0, add = 0;
        for (uint32_t w = 0; w < region->work_count; w++) {
            const struct record_work *work = &frame->works[region->first_work + w];
            for (uint32_t o = 0; o < work->operation_count; o++) {
                const struct record_operation *operation =
                    &frame->operations[work->first_operation + o];
                *(operation->operation == SIMD_SIN         ? &sin
                  : operation->operation == SIMD_FLOAT_ADD ? &add
                                                           : &pow) += (int64_t)operation->count;
            }
        }
        const ticks adds = add * m->operation[SIMD_FLOAT_ADD];
        question.math = WHAT_IF_MATH_AS_RECORDED;
        assert_int_equal(what_if_shading(frame, region, &question),
                         adds + sin * m->operation[SIMD_SIN] + pow * m->operation[SIMD_POW_FAST]);
        question.math = WHAT_IF_MATH_EXACT;
        assert_int_equal(what_if_shading(frame, region, &question),
                         adds + sin * m->operation[SIMD_SIN] + pow * m->operation[SIMD_POW]);
        question.math = WHAT_IF_MATH_FAST;
        assert_int_equal(what_if_shading(frame, region, &question),
                         adds + sin * m->operation[SIMD_SIN_FAST] +
                             pow * m->operation[SIMD_POW_FAST]);
    }
    record_destroy(record);
}

/* The machine again with one parameter changed. */
static struct machine with(const struct machine *machine, int index, int64_t value) {
    int64_t values[MACHINE_VALUE_COUNT];
    struct machine changed;
    machine_to_values(machine, values);
    values[index] = value;
    assert_true(machine_from_values("changed", values, &changed, NULL));
    return changed;
}

/* Rates whose least common multiples make the clock tick 2, 7 and 64 times as fine: a price of the
 * array that nobody pays. */
static void a_finer_clock_reports_the_same_rational_times(void **state) {
    (void)state;
    struct run_record *record = sample_record(6);
    struct what_if question = what_if_default(record);
    struct what_if_frame frames[2];
    const struct what_if_result base = answer(record, &question, frames);
    const uint64_t rate = question.machine.rate.per_s;
    static const int64_t prices_ps[] = {2500, 5000 / 8, 40, 8, 1};
    uint64_t finest = rate;
    for (size_t i = 0; i < sizeof prices_ps / sizeof *prices_ps; i++) {
        question.machine =
            with(&record->machine, MACHINE_PARAMETER_COUNT + SIMD_ATAN2, prices_ps[i]);
        const uint64_t finer = question.machine.rate.per_s / rate;
        assert_int_equal(finer * rate, question.machine.rate.per_s);
        assert_int_equal(answer(record, &question, frames).end, base.end * (ticks)finer);
        finest = question.machine.rate.per_s > finest ? question.machine.rate.per_s : finest;
    }
    assert_true(finest > 1000 * rate);
    record_destroy(record);
}

static void extremes_are_exact_or_refused_in_words(void **state) {
    (void)state;
    struct run_record *record = sample_record(7);
    struct what_if_solver *solver = what_if_solver_create(record);
    struct what_if question = what_if_default(record);
    struct what_if_result result;
    struct status status = {0};
    static const int64_t rates[] = {1, 7, 999999937, 1000000000000000};
    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++) {
        question = what_if_default(record);
        question.machine = with(&record->machine, MACHINE_INDEX_composition_bytes_per_s, rates[i]);
        assert_true(what_if_solve(solver, &question, NULL, &result, &status));
        uint64_t bytes = 0;
        for (uint32_t f = 0; f < 2; f++)
            bytes += result.frames[f].times.composition_bytes;
        ticks busy =
            result.frames[0].times.composition_busy + result.frames[1].times.composition_busy;
        /* every byte takes exactly 1 / rate seconds */
        assert_true((unsigned __int128)busy * (uint64_t)rates[i] ==
                    (unsigned __int128)bytes * question.machine.rate.per_s);
    }
    question = what_if_default(record);
    question.rendering_nodes = question.shading_nodes = 16384;
    question.machine = with(&record->machine, MACHINE_INDEX_composition_hop_latency_ps,
                            1000000000000); /* a second */
    assert_true(what_if_solve(solver, &question, NULL, &result, &status));
    /* colours cross every hop of the chain */
    assert_true(result.end >= (ticks)32768 * (ticks)question.machine.rate.per_s);
    question.machine.region_width = 64;
    assert_false(what_if_solve(solver, &question, NULL, &result, &status));
    assert_non_null(strstr(status.message, "64"));
    record->frames[0].operations[0].count = UINT64_MAX;
    question = what_if_default(record);
    assert_false(what_if_solve(solver, &question, NULL, &result, &status));
    assert_int_equal(status.code, STATUS_LIMIT);
    what_if_solver_destroy(solver);
    record_destroy(record);
}

/* Chunks of twice, three and twenty times the triangles: vertices in common come once. A vertex
 * takes 12 bytes and 16 of parameters in the first run, 48 in the second. */
static void longer_chunks_have_vertices_in_common(void **state) {
    (void)state;
    struct run_record *record = sample_record(9);
    struct what_if question = what_if_default(record);
    struct what_if_frame as_recorded[2], longer[2];
    struct status status = {0};
    static const struct {
        uint32_t factor, shared; /* of a run */
    } cases[] = {{1, 0}, {2, 10 * 10}, {3, 7 * 10 + 6 * 13}, {20, 19 * 10 + 18 * 3}, {50, 244}};
    answer(record, &question, as_recorded);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        question.chunk_triangles = 256 * cases[i].factor;
        answer(record, &question, longer);
        assert_int_equal(longer[0].geometry_bytes,
                         as_recorded[0].geometry_bytes - cases[i].shared * (12 + 16 + 12 + 48));
    }
    struct what_if_solver *solver = what_if_solver_create(record);
    struct what_if_result result;
    question.chunk_triangles = 300;
    assert_false(what_if_solve(solver, &question, NULL, &result, &status));
    assert_non_null(strstr(status.message, "300"));
    what_if_solver_destroy(solver);
    record_destroy(record);
}

static void chunks_dealt_together_stay_together(void **state) {
    (void)state;
    struct run_record *record = sample_record(9);
    struct what_if question = what_if_default(record);
    struct what_if_frame one[2], other[2];
    question.rendering_nodes = 40;
    const ticks apart = answer(record, &question, one).end;
    question.chunk_triangles = 256 * 20;
    answer(record, &question, one);
    question.rendering_nodes = 2; /* two groups of twenty chunks, one for each instance */
    answer(record, &question, other);
    assert_int_equal(one[0].raster_longest, other[0].raster_longest);
    question.chunk_triangles = 256;
    question.rendering_nodes = 40;
    assert_int_equal(answer(record, &question, one).end, apart);
    record_destroy(record);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(damage_of_a_file_is_noticed_and_named),
        cmocka_unit_test(damaged_contents_under_good_checksums_do_no_harm),
        cmocka_unit_test(maps_change_words_and_bytes_as_arithmetic_says),
        cmocka_unit_test(repricing_goes_both_ways),
        cmocka_unit_test(a_finer_clock_reports_the_same_rational_times),
        cmocka_unit_test(extremes_are_exact_or_refused_in_words),
        cmocka_unit_test(longer_chunks_have_vertices_in_common),
        cmocka_unit_test(chunks_dealt_together_stay_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
