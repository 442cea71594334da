/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "nodes/execution_counts.h"
#include "nodes/host_node.h"

#include <string.h>

static const struct shader_block blocks[3] = {
    {-1, {{[SIMD_FLOAT_ADD] = 2}}},
    {0, {[SHADER_ILLUM] = {[SIMD_FLOAT_MULTIPLY] = 3}}},
    {1, {[SHADER_POST_ILLUM] = {[SIMD_SIN] = 1}}},
};
static const struct shader_module module = {.block_count = 3, .blocks = blocks};

static void a_loop_is_issued_as_often_as_the_neediest_vector_runs_it(void **state) {
    (void)state;
    struct execution_counts counts;
    execution_counts_init(&counts, &module);
    /* three vectors enter block 1 on the same path with 4, 7 and 2 turns; on another path with 1 */
    const uint64_t trips[] = {4, 7, 2};
    for (int i = 0; i < 3; i++)
        counts.counters.report_trips(&counts.counters, 1, 99, trips[i]);
    counts.counters.report_trips(&counts.counters, 1, 98, 1);
    /* the same key in another block is another path */
    counts.counters.report_trips(&counts.counters, 2, 99, 5);
    uint64_t operations[SIMD_OPERATION_COUNT] = {0}, streams[SHADER_STREAM_COUNT] = {0};
    execution_counts_add_operations(&counts, operations, streams);
    assert_int_equal(operations[SIMD_FLOAT_ADD], 2);
    assert_int_equal(operations[SIMD_FLOAT_MULTIPLY], 3 * (7 + 1));
    assert_int_equal(operations[SIMD_SIN], 5);
    uint64_t in_streams = 0;
    for (int s = 0; s < SHADER_STREAM_COUNT; s++)
        in_streams += streams[s];
    assert_int_equal(in_streams, 2 + 3 * (7 + 1) + 5);
    /* a new region begins at nothing */
    execution_counts_reset(&counts);
    memset(operations, 0, sizeof operations);
    counts.counters.report_trips(&counts.counters, 1, 99, 3);
    execution_counts_add_operations(&counts, operations, streams);
    assert_int_equal(operations[SIMD_FLOAT_MULTIPLY], 9);
    execution_counts_finish(&counts);
}

static void many_paths_are_kept_apart(void **state) {
    (void)state;
    struct execution_counts counts;
    execution_counts_init(&counts, &module);
    for (int pass = 0; pass < 3; pass++)
        for (uint64_t key = 0; key < 10000; key++)
            counts.counters.report_trips(&counts.counters, 1 + key % 2, key, key % 5);
    uint64_t sums[2] = {0};
    for (uint64_t key = 0; key < 10000; key++)
        sums[key % 2] += key % 5;
    assert_int_equal(counts.counters.block_executions[1], sums[0]);
    assert_int_equal(counts.counters.block_executions[2], sums[1]);
    execution_counts_finish(&counts);
}

static void pictures_are_numbered_where_the_pattern_says(void **state) {
    (void)state;
    static const struct {
        const char *pattern;
        bool is_sequence;
        int number;
        const char *name;
    } cases[] = {
        {"a.exr", false, 1, "a.exr"},           {"a.exr", true, 1, "a.0001.exr"},
        {"d.x/a", true, 12, "d.x/a.0012"},      {"f%03d.exr", true, 7, "f007.exr"},
        {"f%d.exr", false, 7, "f7.exr"},        {"100%.exr", false, 7, "100%.exr"},
        {"%s%n.exr", true, 2, "%s%n.0002.exr"},
    };
    char name[64];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_true(host_image_name(cases[i].pattern, cases[i].is_sequence, cases[i].number, name,
                                    sizeof name, NULL));
        assert_string_equal(name, cases[i].name);
    }
    struct status status = {0};
    assert_false(host_image_name("too-long-a-name", true, 1, name, 8, &status));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_is_issued_as_often_as_the_neediest_vector_runs_it),
        cmocka_unit_test(many_paths_are_kept_apart),
        cmocka_unit_test(pictures_are_numbered_where_the_pattern_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
