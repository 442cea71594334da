/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/scenes/scene_test.h"

#include <stdio.h>

static void transforms_apply_the_last_one_first(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading, IN_VIEW("Translate 1 2 3 Rotate 90 0 0 1 Scale 2 3 4 Sphere 1 -1 1 360"), NULL);
    /* (1,0,0) -> scaled (2,0,0) -> turned from x to y (0,2,0) -> moved (1,4,3) -> camera (1,4,11).
     */
    struct vec3 p = mat4_point(&frame->meshes[0].object_to_camera, vec3_make(1, 0, 0));
    assert_true(fabs(p.x - 1) < 1e-12 && fabs(p.y - 4) < 1e-12 && fabs(p.z - 11) < 1e-12);
    frame_close(&reading, frame);
}

static void transform_requests_match_their_matrices(void **state) {
    static const char *const pairs[][2] = {
        {"Identity Scale 2 2 2", "Transform [2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1]"},
        {"Translate 1 2 3", "ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1]"},
        {"Skew 45 0 1 0 1 0 0", "ConcatTransform [1 0 0 0 1 1 0 0 0 0 1 0 0 0 0 1]"},
        {"TransformBegin Scale 9 9 9 TransformEnd Scale [1 2 3]",
         "ConcatTransform [1 0 0 0 0 2 0 0 0 0 3 0 0 0 0 1]"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        struct mat4 matrices[2];
        for (int k = 0; k < 2; k++) {
            char text[512];
            struct reading reading;
            snprintf(text, sizeof text, IN_VIEW("%s Sphere 0.1 -1 1 360"), pairs[i][k]);
            struct scene_frame *frame = read_frame(&reading, text, NULL);
            matrices[k] = frame->meshes[0].object_to_camera;
            frame_close(&reading, frame);
        }
        for (int k = 0; k < 16; k++)
            assert_true(fabs(matrices[0].m[k / 4][k % 4] - matrices[1].m[k / 4][k % 4]) < 1e-14);
    }
}

static void attributes_end_with_their_block(void **state) {
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading,
                   IN_VIEW("Color 1 0 0 Surface \"a\"\nAttributeBegin\n"
                           "Color 0 1 0 Opacity .5 .5 .5 Sides 1 Surface \"b\"\n"
                           "Translate 1 0 0 Sphere 1 -1 1 360 AttributeEnd\n"
                           "Sphere 1 -1 1 360"),
                   NULL);
    const struct scene_mesh *inner = &frame->meshes[0], *outer = &frame->meshes[1];
    assert_true(inner->color[1] == 1 && inner->opacity[0] == .5f && !inner->is_two_sided);
    assert_string_equal(inner->surface->name, "b");
    assert_true(outer->color[0] == 1 && outer->opacity[0] == 1 && outer->is_two_sided);
    assert_string_equal(outer->surface->name, "a");
    assert_true(outer->object_to_camera.m[3][0] == 0);
    frame_close(&reading, frame);
}

static void check_lights(const struct scene_mesh *mesh, const char *names) {
    assert_int_equal(mesh->light_count, (int)strlen(names));
    for (int i = 0; i < mesh->light_count; i++)
        assert_true(mesh->lights[i]->name[0] == names[i]);
}

static void lights_are_on_in_their_scope_in_order_of_definition(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        "LightSource \"a\" 1\n" IN_VIEW("LightSource \"b\" 2 Illuminate 1 0 Sphere 1 -1 1 360\n"
                                        "AttributeBegin LightSource \"c\" \"two\"\n"
                                        "Illuminate 1 1 Sphere 1 -1 1 360 AttributeEnd\n"
                                        "Sphere 1 -1 1 360\n"
                                        "Illuminate \"two\" 1 Illuminate 2 0 Sphere 1 -1 1 360"),
        NULL);
    check_lights(&frame->meshes[0], "b");
    check_lights(&frame->meshes[1], "abc");
    check_lights(&frame->meshes[2], "b");
    check_lights(&frame->meshes[3], "c");
    assert_int_equal(frame->light_count, 3);
    assert_ptr_equal(frame->meshes[3].lights[0], frame->lights[2]);
    frame_close(&reading, frame);
    expect_error_part("WorldBegin Illuminate 3 1", NULL,
                      "test.rib:1:23: error: Illuminate: there is no light");
}

static void lights_of_a_world_end_with_it_and_others_stay(void **state) {
    struct reading reading;
    reading_open(
        &reading,
        "Translate 0 0 8 LightSource \"a\" 1\nFrameBegin 3 LightSource \"b\" 1 WorldBegin\n"
        "LightSource \"c\" 1 Sphere 1 -1 1 360 WorldEnd FrameEnd\n"
        "FrameBegin 4 WorldBegin Sphere 1 -1 1 360 Illuminate 1 0 Sphere 1 -1 1 360 "
        "WorldEnd FrameEnd",
        NULL);
    struct scene_frame *frame = reading_next(&reading);
    assert_int_equal(frame->number, 3);
    check_lights(&frame->meshes[0], "abc");
    scene_frame_destroy(frame);
    frame = reading_next(&reading);
    assert_int_equal(frame->number, 4);
    assert_int_equal(frame->light_count, 1);
    check_lights(&frame->meshes[0], "a");
    check_lights(&frame->meshes[1], "");
    scene_frame_destroy(frame);
    assert_null(reading_next(&reading));
    reading_close(&reading);
}

static void shaders_keep_the_space_they_were_given_in(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        "Translate 0 0 3 LightSource \"a\" 1 Translate 0 0 5\nWorldBegin Translate 2 0 0 "
        "LightSource \"b\" 2 WorldEnd",
        NULL);
    assert_true(frame->lights[0]->shader_to_camera.m[3][2] == 3);
    assert_true(frame->lights[1]->shader_to_camera.m[3][0] == 2);
    assert_true(frame->lights[1]->shader_to_camera.m[3][2] == 8);
    frame_close(&reading, frame);
}

static void frames_are_pulled_one_by_one(void **state) {
    struct reading reading;
    reading_open(
        &reading,
        "Format 8 4 1\nFrameBegin 1 Format 10 10 1 Display \"one.exr\" \"file\" \"rgb\"\n"
        "Color 1 0 0 WorldBegin WorldEnd FrameEnd\nFrameBegin 2 Translate 0 0 5 WorldBegin\n"
        "Sphere 1 -1 1 360 WorldEnd FrameEnd\nColor oops",
        NULL);
    struct scene_frame *first = reading_next(&reading), *second = reading_next(&reading), *third;
    assert_int_equal(first->number, 1);
    assert_int_equal(first->camera.width, 10);
    assert_string_equal(first->display_name, "one.exr");
    assert_int_equal(second->number, 2);
    assert_int_equal(second->camera.width, 8); /* FrameEnd restores the options */
    assert_null(second->display_name);
    assert_true(second->meshes[0].color[1] == 1);
    assert_false(rib_reader_next(reading.reader, &third, &reading.status));
    scene_frame_destroy(first);
    frame_close(&reading, second);
}

static void screen_windows_follow_the_specification(void **state) {
    static const struct {
        const char *text;
        double window[4];
    } cases[] = {
        {"Format 200 100 1", {-2, 2, -1, 1}},
        {"Format 100 200 1", {-1, 1, -2, 2}},
        {"Format 100 100 2", {-2, 2, -1, 1}},
        {"Format 100 100 -1", {-1, 1, -1, 1}},
        {"Format 100 100 1 FrameAspectRatio 4", {-4, 4, -1, 1}},
        {"ScreenWindow -1 3 -2 2", {-1, 3, -2, 2}},
        {"Format 200 100 1 Projection \"perspective\"", {-2, 2, -1, 1}},
        {"Format 100 100 1 Projection \"perspective\" \"fov\" 60",
         {-0.57735026918962576, 0.57735026918962576, -0.57735026918962576, 0.57735026918962576}},
        {"", {-4. / 3, 4. / 3, -1, 1}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        struct reading reading;
        snprintf(text, sizeof text, "%s WorldBegin WorldEnd", cases[i].text);
        struct scene_frame *frame = read_frame(&reading, text, NULL);
        for (int k = 0; k < 4; k++)
            assert_true(fabs(frame->camera.screen_window[k] - cases[i].window[k]) < 1e-12);
        frame_close(&reading, frame);
    }
}

static void options_override_format_and_samples(void **state) {
    struct scene_options options = {.width = 30, .height = 10, .samples_x = 3, .samples_y = 2};
    struct reading reading;
    struct scene_frame *frame =
        read_frame(&reading, "Format 640 480 1 PixelSamples 8 8 WorldBegin WorldEnd", &options);
    assert_int_equal(frame->camera.width, 30);
    assert_int_equal(frame->camera.height, 10);
    assert_int_equal(frame->camera.samples_x, 3);
    assert_int_equal(frame->camera.samples_y, 2);
    assert_true(frame->camera.screen_window[1] == 3);
    frame_close(&reading, frame);
    expect_error_part("Clipping 2 2", NULL, "near must not be negative and less than far");
    expect_error_part("Projection \"perspective\" \"fov\" 180", NULL, "below 180 degrees");
}

static void instances_equal_what_is_written_out(void **state) {
    static const char *const objects =
        "ObjectBegin 7 Scale 2 1 1 Torus 1 .3 0 360 360\n"
        "Polygon \"P\" [0 0 0 0 1 0 1 0 0] \"uniform float w\" 3 ObjectEnd\n";
    static const char *const written =
        "TransformBegin Scale 2 1 1 Torus 1 .3 0 360 360\n"
        "Polygon \"P\" [0 0 0 0 1 0 1 0 0] \"uniform float w\" 3 TransformEnd\n";
    char texts[2][1024];
    struct scene_frame *frames[2];
    struct reading readings[2];
    const char *format = IN_VIEW("Color 0 0 1 Surface \"x\" Translate 1 0 1 %s Rotate 30 1 1 0 %s");
    strcpy(texts[0], objects);
    snprintf(texts[0] + strlen(objects), 512, format, "ObjectInstance 7",
             "Color 1 0 0 ObjectInstance 7");
    char coloured[512];
    snprintf(coloured, sizeof coloured, "Color 1 0 0 %s", written);
    snprintf(texts[1], sizeof texts[1], format, written, coloured);
    for (int i = 0; i < 2; i++)
        frames[i] = read_frame(&readings[i], texts[i], NULL);
    assert_int_equal(frames[0]->mesh_count, 4);
    for (size_t m = 0; m < 4; m++) {
        const struct scene_mesh *a = &frames[0]->meshes[m], *b = &frames[1]->meshes[m];
        assert_int_equal(a->vertex_count, b->vertex_count);
        assert_int_equal(a->triangle_count, b->triangle_count);
        assert_memory_equal(a->positions, b->positions, a->vertex_count * 12);
        assert_memory_equal(a->triangles, b->triangles, a->triangle_count * 12);
        assert_memory_equal(a->color, b->color, 12);
        assert_int_equal(a->variable_count, b->variable_count);
        for (int k = 0; k < a->variable_count; k++)
            assert_memory_equal(a->variables[k].values, b->variables[k].values,
                                a->vertex_count * (size_t)a->variables[k].components * 4);
    }
    for (int i = 0; i < 2; i++)
        frame_close(&readings[i], frames[i]);
    expect_error_part("WorldBegin ObjectInstance 1", NULL, "there is no object with this handle");
}

static void motion_blocks_use_their_first_sample(void **state) {
    struct reading reading;
    struct scene_frame *frame = read_frame(
        &reading,
        IN_VIEW("MotionBegin [0 1] Translate 1 0 0 Translate 5 0 0 MotionEnd Sphere 1 -1 1 360"),
        NULL);
    assert_true(frame->meshes[0].object_to_camera.m[3][0] == 1);
    assert_non_null(strstr(reading.warnings, "the first sample"));
    frame_close(&reading, frame);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transforms_apply_the_last_one_first),
        cmocka_unit_test(transform_requests_match_their_matrices),
        cmocka_unit_test(attributes_end_with_their_block),
        cmocka_unit_test(lights_are_on_in_their_scope_in_order_of_definition),
        cmocka_unit_test(lights_of_a_world_end_with_it_and_others_stay),
        cmocka_unit_test(shaders_keep_the_space_they_were_given_in),
        cmocka_unit_test(frames_are_pulled_one_by_one),
        cmocka_unit_test(screen_windows_follow_the_specification),
        cmocka_unit_test(options_override_format_and_samples),
        cmocka_unit_test(instances_equal_what_is_written_out),
        cmocka_unit_test(motion_blocks_use_their_first_sample),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
