/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_requests.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool read_version(struct rib_reader *reader) {
    double version;
    return rib_read_number(reader, "version", &version);
}

bool read_declare(struct rib_reader *reader) {
    const char *name, *text, *problem;
    if (!rib_read_string(reader, "name", &name))
        return false;
    struct rib_location location = rib_peek(reader)->location;
    if (!rib_read_string(reader, "declaration", &text))
        return false;
    const struct declaration *declaration = rib_parse_declaration(reader, text, false, &problem);
    if (!declaration)
        return rib_error(reader, &location, "\"%.100s\" is not a declaration: %s", text, problem);
    name_table_set(&reader->declarations, name, (void *)declaration);
    return true;
}

bool read_ignored(struct rib_reader *reader) {
    return rib_skip_arguments(reader);
}

bool read_unsupported(struct rib_reader *reader) {
    rib_warn(reader, &reader->request_at, reader->request, "%s is not supported: skipped",
             reader->request);
    return rib_skip_arguments(reader);
}

/* Reads a parameter list only to check it. */
static bool check_parameters(struct rib_reader *reader) {
    struct parameter_list list;
    bool is_good = rib_read_parameters(reader, PARAMETERS_LENIENT, &list);
    parameter_list_finish(&list);
    return is_good;
}

/* Option and Attribute: a category, then parameters. Those in `harmless` cannot change the picture.
 */
static bool read_category(struct rib_reader *reader, const char *const *harmless) {
    const char *category;
    struct rib_location location = rib_peek(reader)->location;
    if (!rib_read_string(reader, "name", &category))
        return false;
    for (; *harmless; harmless++)
        if (strcmp(*harmless, category) == 0)
            return rib_skip_arguments(reader);
    char key[256];
    snprintf(key, sizeof key, "%s %.200s", reader->request, category);
    rib_warn(reader, &location, key, "%s \"%.100s\" is not supported: skipped", reader->request,
             category);
    return check_parameters(reader);
}

bool read_option(struct rib_reader *reader) {
    static const char *const harmless[] = {"limits", "statistics", "render",     "rib",
                                           "user",   "runtime",    "searchpath", NULL};
    return read_category(reader, harmless);
}

bool read_attribute(struct rib_reader *reader) {
    static const char *const harmless[] = {"identifier", "dice",       "cull", "displacementbound",
                                           "trimcurve",  "irradiance", "user", "grouping",
                                           "stochastic", NULL};
    return read_category(reader, harmless);
}

bool read_format(struct rib_reader *reader) {
    struct camera_options *camera = &reader->camera;
    struct rib_location location;
    bool is_bracketed = rib_peek(reader)->kind == RIB_TOKEN_OPEN;
    double values[3];
    if (is_bracketed) {
        if (!rib_read_numbers(reader, "width height pixelaspectratio", values, 3))
            return false;
        location = reader->request_at;
    } else {
        int width, height;
        if (!rib_read_integer(reader, "width", 1, 65536, &width) ||
            !rib_read_integer(reader, "height", 1, 65536, &height))
            return false;
        location = rib_peek(reader)->location;
        if (!rib_read_number(reader, "pixel aspect ratio", &values[2]))
            return false;
        values[0] = width;
        values[1] = height;
    }
    for (int i = 0; i < 2; i++)
        if (values[i] != floor(values[i]) || values[i] < 1 || values[i] > 65536)
            return rib_error(reader, &location, "Format: width and height must be 1 to 65536");
    if (values[2] == 0 || values[2] > 1e6)
        return rib_error(reader, &location, "Format: the pixel aspect ratio must be positive");
    camera->width = (int)values[0];
    camera->height = (int)values[1];
    camera->pixel_aspect = values[2] < 0 ? 1 : values[2]; /* negative: the renderer's own */
    return true;
}

bool read_frame_aspect_ratio(struct rib_reader *reader) {
    double ratio;
    if (!rib_read_number(reader, "ratio", &ratio))
        return false;
    if (!(ratio > 1e-6 && ratio < 1e6))
        return rib_error(reader, &reader->request_at, "FrameAspectRatio must be positive");
    reader->camera.frame_aspect_ratio = ratio;
    return true;
}

bool read_screen_window(struct rib_reader *reader) {
    double window[4];
    if (!rib_read_numbers(reader, "left right bottom top", window, 4))
        return false;
    if (!(window[0] < window[1] && window[2] < window[3]))
        return rib_error(reader, &reader->request_at,
                         "ScreenWindow: left must be less than right and bottom less than top");
    memcpy(reader->camera.screen_window, window, sizeof window);
    reader->camera.has_screen_window = true;
    return true;
}

bool read_crop_window(struct rib_reader *reader) {
    double window[4];
    if (!rib_read_numbers(reader, "xmin xmax ymin ymax", window, 4))
        return false;
    if (window[0] != 0 || window[1] != 1 || window[2] != 0 || window[3] != 1)
        rib_warn(reader, &reader->request_at, "CropWindow",
                 "CropWindow is not supported: the whole image is rendered");
    return true;
}

bool read_projection(struct rib_reader *reader) {
    struct rib_location location = rib_peek(reader)->location;
    const char *name;
    if (!rib_read_string(reader, "name", &name))
        return false;
    bool is_perspective = strcmp(name, "perspective") == 0;
    if (!is_perspective && strcmp(name, "orthographic") != 0)
        return rib_error(reader, &location,
                         "Projection \"%.100s\": \"perspective\" or \"orthographic\" expected",
                         name);
    struct parameter_list list;
    bool is_good = rib_read_parameters(reader, PARAMETERS_LENIENT, &list);
    const struct primitive_variable *fov = is_good ? parameter_list_find(&list, "fov") : NULL;
    double degrees = 90;
    if (fov) {
        degrees = fov->count == 1 && fov->values ? fov->values[0] : 0;
        if (!(degrees > 0 && degrees < 180))
            is_good =
                rib_error(reader, &list.locations[fov - list.items],
                          "Projection: \"fov\" takes one number above 0 and below 180 degrees");
    }
    parameter_list_finish(&list);
    reader->camera.is_perspective = is_perspective;
    reader->camera.fov_degrees = degrees;
    return is_good;
}

bool read_clipping(struct rib_reader *reader) {
    double planes[2];
    if (!rib_read_numbers(reader, "near far", planes, 2))
        return false;
    if (planes[0] < 0 || !(planes[0] < planes[1]))
        return rib_error(reader, &reader->request_at,
                         "Clipping: near must not be negative and less than far");
    reader->camera.near_plane = planes[0];
    reader->camera.far_plane = planes[1] >= 1e30 ? INFINITY : planes[1];
    return true;
}

bool read_pixel_samples(struct rib_reader *reader) {
    double samples[2];
    if (!rib_read_numbers(reader, "xsamples ysamples", samples, 2))
        return false;
    for (int i = 0; i < 2; i++)
        if (!(samples[i] >= 1 && samples[i] <= 64))
            return rib_error(reader, &reader->request_at, "PixelSamples must be 1 to 64");
    reader->camera.samples_x = samples[0];
    reader->camera.samples_y = samples[1];
    return true;
}

bool read_display(struct rib_reader *reader) {
    const char *name, *type, *mode;
    if (!rib_read_string(reader, "name", &name) || !rib_read_string(reader, "type", &type) ||
        !rib_read_string(reader, "mode", &mode) || !check_parameters(reader))
        return false;
    /* "+name" adds an output to the first one, which is all that we make. */
    if (name[0] == '+') {
        rib_warn(reader, &reader->request_at, "Display +",
                 "Display \"%.100s\": only one output is made", name);
        return true;
    }
    reader->camera.display_name = strcmp(type, "framebuffer") == 0 ? NULL : name;
    return true;
}

bool read_depth_of_field(struct rib_reader *reader) {
    if (rib_peek(reader)->kind == RIB_TOKEN_NUMBER || rib_peek(reader)->kind == RIB_TOKEN_OPEN)
        rib_warn(reader, &reader->request_at, "DepthOfField",
                 "DepthOfField is not supported: everything is in focus");
    return rib_skip_arguments(reader);
}

bool read_exposure(struct rib_reader *reader) {
    double values[2];
    if (!rib_read_numbers(reader, "gain gamma", values, 2))
        return false;
    if (values[0] != 1 || values[1] != 1)
        rib_warn(reader, &reader->request_at, "Exposure",
                 "Exposure is not supported: the image holds linear colours");
    return true;
}
