/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/scenes/scene_test.h"

#include "scenes/rib_number.h"

#include <locale.h>
#include <stdio.h>
#include <unistd.h>

static void errors_name_the_place_and_show_the_line(void **state) {
    expect_error(
        "version 3.03\n  Color [1 0\nWorldBegin\n", NULL,
        "test.rib:3:1: error: Color: three numbers of a colour expected before 'WorldBegin'\n"
        "WorldBegin\n^");
    expect_error("Rotate 10 0 1\t\"x\"\n", NULL,
                 "test.rib:1:15: error: Rotate: angle dx dy dz expected\nRotate 10 0 1 \"x\"\n"
                 "              ^");
    expect_error("Format 640 0 1\n", NULL,
                 "test.rib:1:12: error: Format: height must be 1 to 65536, not 0\nFormat 640 0 1\n"
                 "           ^");
    expect_error(
        "Surface \"plastic\" \"Kx\" 1\n", NULL,
        "test.rib:1:19: error: Surface: parameter \"Kx\" is not declared; declare it: Declare "
        "\"Kx\" \"uniform float\"\nSurface \"plastic\" \"Kx\" 1\n                  ^");
    expect_error("Surface \"plastic\" \"Kd\" [1 2]\n", NULL,
                 "test.rib:1:19: error: Surface: \"Kd\" takes 1 number(s), not 2\n"
                 "Surface \"plastic\" \"Kd\" [1 2]\n                  ^");
    expect_error("WorldBegin\nPolygon \"P\" [0 0 0 1 0 0 1 1 0] \"Cs\" [1 0 0]\nWorldEnd", NULL,
                 "test.rib:2:33: error: Polygon: \"Cs\" (varying color) takes 9 values, not 3\n"
                 "Polygon \"P\" [0 0 0 1 0 0 1 1 0] \"Cs\" [1 0 0]\n"
                 "                                ^");
}

static void long_lines_are_cut_around_the_caret(void **state) {
    char text[4096];
    size_t length = 0;
    length += (size_t)sprintf(text, "Format [");
    for (int i = 0; i < 500; i++)
        length += (size_t)sprintf(text + length, "1 ");
    strcpy(text + length, "]");
    expect_error_part(text, NULL,
                      "test.rib:1:15: error: Format: width height pixelaspectratio: only 3");
    memset(text, ' ', 1000);
    strcpy(text + 1000, "?");
    expect_error_part(text, NULL, "test.rib:1:1001: error: unexpected character\n...");
}

static void numbers_that_are_none_are_refused(void **state) {
    static const char *const bad[] = {
        "nan", "NaN", "inf", "-inf",  "+nan", "1e999", "0x10", "1.2.3",
        "1e",  "--1", "1,5", "12abc", ".",    "-",     "1e+",  "1e9999999999999999999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[128];
        snprintf(text, sizeof text, "Translate 0 0 %s\nWorldBegin WorldEnd\n", bad[i]);
        expect_error_part(text, NULL, "test.rib:1:1");
        expect_error_part(text, NULL, "error: ");
    }
}

static void numbers_are_correctly_rounded(void **state) {
    static const char *const texts[] = {"0",
                                        "-0",
                                        "1e22",
                                        "1e23",
                                        "9007199254740993",
                                        "0.1",
                                        ".5",
                                        "5.",
                                        "-.25e2",
                                        "4.9e-324",
                                        "1.7976931348623157e308",
                                        "123456789012345678901234567890",
                                        "0.000000000000000000000000000000000000001",
                                        "1E-5",
                                        "+7"};
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        double value, expected = strtod(texts[i], NULL);
        assert_true(rib_number_parse(texts[i], strlen(texts[i]), c_locale, &value));
        assert_memory_equal(&value, &expected, sizeof value);
    }
    uint64_t seed = 1;
    for (int i = 0; i < 200000; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        char text[64];
        double value, expected, number = (double)(int64_t)seed / (1 << (seed % 30));
        snprintf(text, sizeof text, i & 1 ? "%.9g" : "%.17g", number);
        expected = strtod(text, NULL);
        assert_true(rib_number_parse(text, strlen(text), c_locale, &value));
        assert_true(value == expected);
    }
    freelocale(c_locale);
}

static void decimal_commas_of_the_locale_do_not_matter(void **state) {
    static const char *const names[] = {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "da_DK.UTF-8"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (setlocale(LC_ALL, names[i]))
            break;
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading, "Clipping 0.12345678901234567890123 1.5e30 WorldBegin WorldEnd", NULL);
    assert_true(frame->camera.near_plane == 0x1.f9add3746f65fp-4);
    setlocale(LC_ALL, "C");
    frame_close(&reading, frame);
}

static void strings_know_escapes(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading, "Display \"a\\\"b\\\\c\\101\\n\\\nd\" \"file\" \"rgb\" WorldBegin WorldEnd",
        NULL);
    assert_string_equal(frame->display_name, "a\"b\\cA\nd");
    frame_close(&reading, frame);
    expect_error_part("Display \"a", NULL, "test.rib:1:9: error: a string is not closed");
    expect_error_part("Display \"a\\000\"", NULL, "octal escape");
}

static void unknown_requests_warn_once_for_each_name(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(&reading,
                                           "Foo 1 [2 3] \"x\"\n Foo\nBar [\"a\" \"b\"]\nFoo 3\n"
                                           "WorldBegin NuPatch 1 NuPatch 2\nWorldEnd",
                                           NULL);
    assert_string_equal(
        reading.warnings,
        "test.rib:1:1: warning: unknown request 'Foo': skipped\nFoo 1 [2 3] \"x\"\n^\n"
        "test.rib:3:1: warning: unknown request 'Bar': skipped\nBar [\"a\" \"b\"]\n^\n"
        "test.rib:5:12: warning: NuPatch is not supported: skipped\n"
        "WorldBegin NuPatch 1 NuPatch 2\n           ^\n");
    frame_close(&reading, frame);
}

static void harmless_requests_are_silent(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        "##RenderMan RIB-Structure 1.0\nversion 3.04\nShutter 0 1\nPixelFilter \"gaussian\" 2 2\n"
        "Quantize \"rgba\" 255 0 255 .5\nHider \"hidden\"\nExposure 1 1\nDepthOfField\n"
        "Option \"limits\" \"bucketsize\" [16 16]\nShadingRate 1\nCropWindow 0 1 0 1\n"
        "WorldBegin\nAttribute \"identifier\" \"name\" [\"a\"]\nCoordinateSystem "
        "\"here\"\nWorldEnd",
        NULL);
    assert_string_equal(reading.warnings, "");
    frame_close(&reading, frame);
}

static void requests_out_of_place_are_errors(void **state) {
    expect_error_part("Sphere 1 -1 1 360", NULL, "Sphere is not allowed outside of WorldBegin");
    expect_error_part("WorldBegin Format 1 1 1", NULL, "Format is not allowed between WorldBegin");
    expect_error_part("WorldBegin WorldBegin", NULL, "WorldBegin is not allowed");
    expect_error_part(
        "AttributeBegin\nTransformEnd", NULL,
        "test.rib:2:1: error: TransformEnd, but the AttributeBegin of line 1 is still open");
    expect_error_part("AttributeEnd", NULL, "AttributeEnd without AttributeBegin");
    expect_error_part("ObjectBegin 1 LightSource \"x\" 1", NULL, "LightSource is not allowed");
    expect_error_part("WorldBegin 3", NULL,
                      "a request expected here; too many arguments of WorldBegin");
}

static void truncated_files_are_errors_at_the_open_block(void **state) {
    expect_error(
        "FrameBegin 1\n WorldBegin\nSphere 1 -1 1 360\n", NULL,
        "test.rib:2:2: error: the file ends before WorldEnd for this WorldBegin\n WorldBegin\n ^");
    expect_error_part("WorldBegin\nPolygon \"P\" [0 0", NULL,
                      "the file ends where Polygon should be: P");
}

static void empty_files_have_no_frames(void **state) {
    static const char *const texts[] = {"", "\n\n", "# only a comment", "version 3.03"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct reading reading;
        reading_open(&reading, texts[i], NULL);
        assert_null(reading_next(&reading));
        assert_null(reading_next(&reading));
        reading_close(&reading);
    }
}

static void a_failure_stays(void **state) {
    struct reading reading;
    struct scene_frame *frame;
    reading_open(&reading, "WorldBegin WorldEnd ?", NULL);
    scene_frame_destroy(reading_next(&reading));
    for (int i = 0; i < 2; i++) {
        assert_false(rib_reader_next(reading.reader, &frame, &reading.status));
        assert_null(frame);
        assert_int_equal(reading.status.code, STATUS_INVALID);
    }
    reading_close(&reading);
}

static void deep_nesting_is_a_clear_limit(void **state) {
    size_t count = 100000, length = 0;
    char *text = malloc(count * 16 + 1);
    for (size_t i = 0; i < count; i++, length += 15)
        memcpy(text + length, "AttributeBegin ", 15);
    text[length] = '\0';
    expect_error_part(text, NULL, "more than 4096 nested blocks");
    free(text);
    expect_error_part("WorldBegin [[1]]", NULL, "a request expected here");
    expect_error_part("Foo [[1]]", NULL, "unexpected '['");
}

/* Archives in a folder of their own. */
static void write_file(const char *folder, const char *name, const char *text) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void archives_are_read_beside_their_file_and_cycles_refused(void **state) {
    char folder[] = "/tmp/scenes_archive_XXXXXX", path[512], command[600];
    assert_non_null(mkdtemp(folder));
    write_file(folder, "main.rib",
               "WorldBegin\nTranslate 0 0 5\nReadArchive \"one.rib\" Color 0 1 0\n"
               "ReadArchive \"one.rib\"\nWorldEnd\n");
    write_file(folder, "one.rib", "Bar\nSphere 1 -1 1 360\n");
    write_file(folder, "loop.rib", "ReadArchive \"again.rib\"\n");
    write_file(folder, "again.rib", "Color 1 1 1\n  ReadArchive \"loop.rib\"\n");
    write_file(folder, "bad.rib", "ReadArchive \"wrong.rib\"\n");
    write_file(folder, "wrong.rib", "\nColor 1 1\n");
    write_file(folder, "missing.rib", "ReadArchive \"nowhere.rib\"\n");
    struct reading reading = {0};
    snprintf(path, sizeof path, "%s/main.rib", folder);
    assert_true(rib_reader_open(path, NULL, &reading.reader, &reading.status));
    struct scene_frame *frame = reading_next(&reading);
    assert_int_equal(frame->mesh_count, 2);
    assert_true(frame->meshes[0].color[0] == 1 && frame->meshes[1].color[0] == 0);
    assert_true(strstr(frame->meshes[0].location.file, "one.rib") != NULL);
    assert_non_null(strstr(reading.warnings, "one.rib:1:1: warning: unknown request 'Bar'"));
    frame_close(&reading, frame);
    static const char *const cases[][2] = {
        {"loop.rib",
         "/again.rib:2:15: error: the archive \"loop.rib\" reads itself\n  ReadArchive"},
        {"bad.rib", "/wrong.rib:3:1: error: the file ends where Color should be"},
        {"missing.rib", "/missing.rib:1:13: error: nowhere.rib: No such file"}};
    for (size_t i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, cases[i][0]);
        assert_true(rib_reader_open(path, NULL, &reading.reader, &reading.status));
        assert_false(rib_reader_next(reading.reader, &frame, &reading.status));
        if (!strstr(reading.status.message, cases[i][1]))
            fail_msg("%s", reading.status.message);
        reading_close(&reading);
    }
    assert_false(rib_reader_open(folder, NULL, &reading.reader, &reading.status));
    assert_null(reading.reader);
    assert_false(rib_reader_open("/dev/zero", NULL, &reading.reader, &reading.status));
    assert_int_equal(reading.status.code, STATUS_LIMIT);
    assert_false(rib_reader_open("/no/such.rib", NULL, &reading.reader, &reading.status));
    assert_int_equal(reading.status.code, STATUS_NOT_FOUND);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

static void files_longer_than_the_window_keep_places_and_tokens(void **state) {
    char path[] = "/tmp/scenes_long_XXXXXX";
    int descriptor = mkstemp(path);
    FILE *file = fdopen(descriptor, "w");
    for (int i = 0; i < 60000; i++)
        fprintf(file, "Translate %d.25 0 -1e-3 # %d\n", i % 7, i);
    fprintf(file, "Translate 0 x\n");
    fclose(file);
    struct reading reading = {0};
    struct scene_frame *frame;
    assert_true(rib_reader_open(path, NULL, &reading.reader, &reading.status));
    assert_false(rib_reader_next(reading.reader, &frame, &reading.status));
    assert_non_null(strstr(reading.status.message, ":60001:13: error: "));
    assert_non_null(strstr(reading.status.message, "\nTranslate 0 x\n            ^"));
    reading_close(&reading);
    unlink(path);
}

static void undeclared_parameters_of_options_warn_and_are_skipped(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        "Projection \"orthographic\" \"zoom\" [1 2]\nProjection \"orthographic\" \"zoom\" 3\n"
        "Projection \"perspective\" \"uniform float fov\" 90 WorldBegin WorldEnd",
        NULL);
    assert_string_equal(
        reading.warnings,
        "test.rib:1:27: warning: Projection: parameter \"zoom\" is not declared: skipped\n"
        "Projection \"orthographic\" \"zoom\" [1 2]\n                          ^\n");
    assert_true(frame->camera.is_perspective);
    frame_close(&reading, frame);
}

static void declarations_are_checked(void **state) {
    expect_error_part("Declare \"a\" \"uniform flaot\"", NULL,
                      "test.rib:1:13: error: \"uniform flaot\"");
    expect_error_part("Declare \"a\" \"float[0]\"", NULL, "array length");
    expect_error_part("Surface \"x\" \"uniform float\" 1", NULL, "the name is missing");
    expect_error_part("Surface \"x\" \"Kd\" 1 \"Kd\" 2", NULL, "given twice");
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        IN_VIEW("Declare \"w\" \"color[2]\" Surface \"x\" \"w\" [1 2 3 4 5 6] \"string name\" \"n\""
                " \"float[2] two\" [1 2] \"point p[1]\" [1 2 3] Sphere 1 -1 1 360"),
        NULL);
    const struct scene_shader *surface = frame->meshes[0].surface;
    assert_int_equal(surface->parameter_count, 4);
    assert_string_equal(surface->parameters[0].name, "w");
    assert_int_equal(surface->parameters[0].type, SCENE_COLOR);
    assert_int_equal(surface->parameters[0].array_length, 2);
    assert_true(surface->parameters[0].values[5] == 6);
    assert_string_equal(surface->parameters[1].strings[0], "n");
    assert_string_equal(surface->parameters[2].name, "two");
    assert_int_equal(surface->parameters[3].type, SCENE_POINT);
    assert_int_equal(surface->parameters[3].location.line, 4);
    frame_close(&reading, frame);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_name_the_place_and_show_the_line),
        cmocka_unit_test(long_lines_are_cut_around_the_caret),
        cmocka_unit_test(numbers_that_are_none_are_refused),
        cmocka_unit_test(numbers_are_correctly_rounded),
        cmocka_unit_test(decimal_commas_of_the_locale_do_not_matter),
        cmocka_unit_test(strings_know_escapes),
        cmocka_unit_test(unknown_requests_warn_once_for_each_name),
        cmocka_unit_test(harmless_requests_are_silent),
        cmocka_unit_test(requests_out_of_place_are_errors),
        cmocka_unit_test(truncated_files_are_errors_at_the_open_block),
        cmocka_unit_test(empty_files_have_no_frames),
        cmocka_unit_test(a_failure_stays),
        cmocka_unit_test(deep_nesting_is_a_clear_limit),
        cmocka_unit_test(archives_are_read_beside_their_file_and_cycles_refused),
        cmocka_unit_test(files_longer_than_the_window_keep_places_and_tokens),
        cmocka_unit_test(undeclared_parameters_of_options_warn_and_are_skipped),
        cmocka_unit_test(declarations_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
