/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "netsim/machine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct machine pixelflow(void) {
    struct machine machine;
    struct status status = {0};
    if (!machine_read_file(MACHINES "/pixelflow.json", &machine, &status))
        fail_msg("%s", status.message);
    return machine;
}

static void figures_of_the_paper_are_in_the_description(void **state) {
    (void)state;
    const struct machine m = pixelflow();
    assert_int_equal(machine_region_samples(&m), 8192);
    assert_int_equal(m.composition_bytes_per_s, 6400000000);
    assert_int_equal(m.composition_bytes_per_s / 32 * 28, 5600000000);
    assert_int_equal(m.geometry_bytes_per_s, 800000000);
    assert_int_equal(m.pixel_memory_bytes, 256);
    /* table 2, in picoseconds: the fits for 2 and 4 bytes give the published fixed-point times */
    const int64_t add[] = {70000, 130000}, multiply[] = {500000, 2000000},
                  divide[] = {1600000, 6400000};
    for (int i = 0; i < 2; i++) {
        const int64_t b = i ? 4 : 2;
        assert_int_equal(m.operation_ps[SIMD_FIXED_ADD_BASE] +
                             b * m.operation_ps[SIMD_FIXED_ADD_BYTE],
                         add[i]);
        assert_int_equal(b * b * m.operation_ps[SIMD_FIXED_MULTIPLY_BYTE2], multiply[i]);
        assert_int_equal(b * b * m.operation_ps[SIMD_FIXED_DIVIDE_BYTE2], divide[i]);
    }
    assert_int_equal(m.operation_ps[SIMD_FLOAT_ADD], 3080000);
    assert_int_equal(m.operation_ps[SIMD_FLOAT_NOISE], 21640000);
    assert_int_equal(m.operation_ps[SIMD_SIN], 81360000); /* table 3 */
    assert_int_equal(m.operation_ps[SIMD_SIN_FAST], 45640000);
}

static void one_tick_is_the_5_ns_clock(void **state) {
    (void)state;
    const struct machine m = pixelflow();
    assert_int_equal(m.rate.per_s, 200000000);
    assert_int_equal(m.composition_word, 1);
    assert_int_equal(m.geometry_word, 1);
    assert_int_equal(m.composition_hop, 4);
    /* one word of every sample of a region takes 40.96 us, of a 1280 x 1024 screen 6.5536 ms */
    assert_int_equal(ticks_to_ps(m.rate, 8192 * m.composition_word), 40960000);
    assert_int_equal(ticks_to_ps(m.rate, 160 * 8192 * m.composition_word), 6553600000);
}

static void maps_take_whole_words(void **state) {
    (void)state;
    const struct machine m = pixelflow();
    assert_int_equal(machine_map_words(&m, 0), 1);  /* 2 bytes */
    assert_int_equal(machine_map_words(&m, 24), 1);  /* 26 */
    assert_int_equal(machine_map_words(&m, 28), 2);  /* 30 */
    assert_int_equal(machine_map_words(&m, 136), 5); /* 138 of 140 */
    assert_int_equal(machine_map_words(&m, 140), 6); /* 142 */
}

static void values_survive_the_wire_form(void **state) {
    (void)state;
    const struct machine m = pixelflow();
    struct machine copy;
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(&m, values);
    assert_true(machine_from_values(m.name, values, &copy, NULL));
    assert_memory_equal(&m.region_width, &copy.region_width,
                        sizeof m - offsetof(struct machine, region_width));
}

static void every_entry_is_checked_against_its_range(void **state) {
    (void)state;
    const struct machine m = pixelflow();
    struct machine copy;
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        int64_t values[MACHINE_VALUE_COUNT];
        struct status status = {0};
        machine_to_values(&m, values);
        values[i] = machine_parameter_at(i).maximum + 1;
        assert_false(machine_from_values("x", values, &copy, &status));
        assert_non_null(strstr(status.message, machine_parameter_at(i).name));
        values[i] = machine_parameter_at(i).minimum - 1;
        assert_false(machine_from_values("x", values, &copy, &status));
    }
}

static char *file_text(void) {
    FILE *file = fopen(MACHINES "/pixelflow.json", "rb");
    char *text = calloc(1, 65536);
    assert_non_null(file);
    assert_true(fread(text, 1, 65535, file) > 1000);
    fclose(file);
    return text;
}

static void replace(char *text, const char *from, const char *to) {
    char *at = strstr(text, from), *rest = strdup(at + strlen(from));
    strcpy(at, to);
    strcat(at, rest);
    free(rest);
}

static void wrong_files_are_refused_by_name(void **state) {
    (void)state;
    static const struct {
        const char *from, *to, *word;
    } cases[] = {
        {"\"region_width\"", "\"region_widht\"", "region_widht"},
        {"\"value\": 6400000000", "\"value\": 6400000000.5", "composition_bytes_per_s"},
        {"\"value\": 6400000000", "\"value\": 1e300", "composition_bytes_per_s"},
        {"\"value\": 6400000000", "\"value\": 0", "composition_bytes_per_s"},
        {"\"value\": 6400000000", "\"value\": \"fast\"", "composition_bytes_per_s"},
        {"\"source\": \"published: PF section 5.2, 32 bits\"", "\"x\": 1", "geometry_word_bytes"},
        {"\"region_height\"", "\"region_width\"", "twice"},
        {"\"parameters\": {", "\"parameters\": [", "m.json:"},
        {"\"value\": 128,", "\"value\": 127,", "region_width"},
        {"\"name\": \"PixelFlow\"", "\"name\": 3", "name"},
        /* a rate with no common tick */
        {"\"value\": 6400000000", "\"value\": 999999999999989", "tick"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = file_text();
        struct machine machine;
        struct status status = {0};
        replace(text, cases[i].from, cases[i].to);
        if (machine_parse("m.json", text, &machine, &status))
            fail_msg("accepted: %s", cases[i].to);
        if (!strstr(status.message, cases[i].word) || !strstr(status.message, "m.json"))
            fail_msg("for %s: %s", cases[i].to, status.message);
        free(text);
    }
}

static void odd_rates_stay_exact(void **state) {
    (void)state;
    char *text = file_text();
    struct machine machine;
    struct status status = {0};
    replace(text, "\"value\": 6400000000", "\"value\": 999999937");
    if (!machine_parse("m.json", text, &machine, &status))
        fail_msg("%s", status.message);
    /* 999999937 words of 32 bytes take exactly 32 seconds */
    assert_true(ticks_multiply(machine.composition_word, 999999937) ==
                (ticks)(32 * machine.rate.per_s));
    free(text);
}

/* What calibration rests on: it rounds the two rates that it measures to three digits. */
static void rates_of_three_digits_have_a_tick_in_common(void **state) {
    (void)state;
    struct machine machine = pixelflow();
    int64_t values[MACHINE_VALUE_COUNT];
    struct status status = {0};
    machine_to_values(&machine, values);
    values[MACHINE_INDEX_raster_region_ps] = 999999937;
    for (int64_t a = 900; a < 1000; a++)
        for (int64_t b = 900; b < 1000; b++)
            for (int64_t unit = 1; unit <= 1000000000; unit *= 1000) {
                values[MACHINE_INDEX_composition_bytes_per_s] = a * unit;
                values[MACHINE_INDEX_geometry_bytes_per_s] = b * 1000000;
                if (!machine_from_values("three digits", values, &machine, &status))
                    fail_msg("%s", status.message);
            }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_of_the_paper_are_in_the_description),
        cmocka_unit_test(one_tick_is_the_5_ns_clock),
        cmocka_unit_test(maps_take_whole_words),
        cmocka_unit_test(values_survive_the_wire_form),
        cmocka_unit_test(every_entry_is_checked_against_its_range),
        cmocka_unit_test(wrong_files_are_refused_by_name),
        cmocka_unit_test(odd_rates_stay_exact),
        cmocka_unit_test(rates_of_three_digits_have_a_tick_in_common),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
