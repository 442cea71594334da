/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shader_fix_study.h"

#include "nodes/frame_plan.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* "bricks" of ".../bricks.sl" */
static void name_of_file(const char *path, char name[FIX_NAME_BYTES]) {
    const char *slash = strrchr(path, '/'), *begin = slash ? slash + 1 : path;
    const size_t length = strlen(begin);
    const bool has_suffix = length > 3 && !strcmp(begin + length - 3, ".sl");
    snprintf(name, FIX_NAME_BYTES, "%.*s", (int)(has_suffix ? length - 3 : length), begin);
}

/* `is_small`: of the size of trials. `writes`: with the shader that was written instead of the
 * original. Without a precision: with probes, which is that of a library. */
static bool render(struct fix_study *study, bool is_small, bool writes,
                   const struct shader_precision *precision, struct cluster_pictures *pictures,
                   struct status *status) {
    struct host_options host = *study->options->rendering;
    if (is_small) {
        host.reading.width = study->width;
        host.reading.height = study->height;
    }
    if (precision)
        host.precision = *precision;
    else
        host.library = study->probed;
    host.precision.files = (const char *const *)(writes ? &study->written : &study->original);
    host.precision.file_count = writes || study->original;
    study->renderings++;
    return cluster_in_process_render(&host, local_services_interface(study->services), pictures,
                                     study->options->stop, status) &&
           !(study->options->stop && *study->options->stop);
}

/* The largest numbers met so far, at most `capacity` of them, the smallest first. */
struct largest {
    double *values;
    size_t count, capacity;
};

static void keep(struct largest *largest, double value) {
    size_t at = 0;
    if (largest->count == largest->capacity && value <= largest->values[0])
        return;
    if (largest->count < largest->capacity) {
        at = largest->count++;
        for (; at > 0 && largest->values[at - 1] > value; at--)
            largest->values[at] = largest->values[at - 1];
    } else {
        for (; at + 1 < largest->count && largest->values[at + 1] < value; at++)
            largest->values[at] = largest->values[at + 1];
    }
    largest->values[at] = value;
}

/* The largest difference of a colour of the pixel; infinite where one is not finite, but not where
 * both are not. */
static double pixel_error(const float *const a[3], const float *const b[3], size_t pixel) {
    double error = 0;
    for (int c = 0; c < 3; c++) {
        const double difference = fabs((double)a[c][pixel] - (double)b[c][pixel]);
        if (!isfinite(a[c][pixel]) && !isfinite(b[c][pixel]))
            continue;
        if (!isfinite(difference))
            return INFINITY;
        error = fmax(error, difference);
    }
    return error;
}

static bool find_colors(const struct image *image, const float *colors[3]) {
    static const char *const names[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; c++) {
        const struct image_channel *channel = image_find_channel(image, names[c]);
        if (!channel || channel->type == IMAGE_UINT)
            return false;
        colors[c] = channel->values;
    }
    return true;
}

/* `outliers`: their share. */
static bool compare(const struct fix_study *study, double outliers,
                    const struct cluster_pictures *a, const struct cluster_pictures *b,
                    struct shader_fix_error *error, struct status *status) {
    *error = (struct shader_fix_error){0};
    size_t pixels = 0;
    bool ok = a->count == b->count && a->count > 0;
    for (size_t i = 0; ok && i < a->count; i++) {
        pixels += (size_t)a->images[i]->width * (size_t)a->images[i]->height;
        ok = a->images[i]->width == b->images[i]->width &&
             a->images[i]->height == b->images[i]->height;
    }
    struct largest largest = {.capacity = 1 + (size_t)(outliers * (double)pixels)};
    largest.values = memory_get(largest.capacity, sizeof *largest.values);
    for (size_t i = 0; ok && i < a->count; i++) {
        const size_t here = (size_t)a->images[i]->width * (size_t)a->images[i]->height;
        const float *first[3], *second[3];
        ok = find_colors(a->images[i], first) && find_colors(b->images[i], second);
        for (size_t p = 0; ok && p < here; p++) {
            const double difference = pixel_error(first, second, p);
            keep(&largest, difference);
            error->pixels_beyond += difference > study->options->max_error;
        }
    }
    if (ok) {
        error->pixels = pixels;
        error->largest = largest.values[largest.count - 1];
        error->bulk = largest.count == largest.capacity ? largest.values[0] : 0;
    }
    free(largest.values);
    return ok || status_fail(status, STATUS_INTERNAL, "pictures that cannot be compared");
}

/* Which parameters come with the primitives where the scene uses the shader by itself. */
static bool find_material(struct fix_study *study, const struct frame_plan *plan) {
    for (size_t i = 0; i < plan->instance_count; i++) {
        const struct shader_variant *variant = plan->instances[i].variant;
        const struct shader_program *program = variant->program;
        if (strcmp(variant->name, study->name) || variant->has_companions)
            continue;
        for (int p = 0; p < program->parameter_count; p++)
            if (program->parameters[p].is_material && study->material_count < FIX_MATERIAL_MAX)
                study->material[study->material_count++] =
                    memory_copy_string(program->parameters[p].name);
        return true;
    }
    return false;
}

/* Trials are many: a picture of the same shape with as many pixels as a few regions have. */
static void choose_size(struct fix_study *study, int width, int height) {
    enum { PIXELS = 20480 };
    const double scale = fmin(1, sqrt(PIXELS / ((double)width * (double)height)));
    study->width = (int)fmax(1, width * scale);
    study->height = (int)fmax(1, height * scale);
}

static bool read_scene(struct fix_study *study, struct status *status) {
    const struct host_options *rendering = study->options->rendering;
    struct rib_reader *reader;
    struct scene_frame *frame = NULL;
    if (!rib_reader_open(rendering->scene, &rendering->reading, &reader, status))
        return false;
    bool is_found = false, ok = true;
    while (ok && !is_found && (ok = rib_reader_next(reader, &frame, status)) && frame) {
        struct frame_plan plan = {0};
        ok = frame_plan_make(frame, study->library, &plan, status);
        is_found = ok && find_material(study, &plan);
        choose_size(study, frame->camera.width, frame->camera.height);
        if (ok)
            frame_plan_finish(&plan);
        scene_frame_destroy(frame);
        frame = NULL;
    }
    rib_reader_destroy(reader);
    return ok &&
           (is_found || status_fail(status, STATUS_INVALID,
                                    "%s: no surface of the scene has the shader \"%s\" by itself, "
                                    "without displacement and volume shaders",
                                    rendering->scene, study->name));
}

static struct shader_wanted wanted(struct fix_study *study) {
    return (struct shader_wanted){.name = study->name,
                                  .kind = SHADER_KIND_SURFACE,
                                  .material = (const char *const *)study->material,
                                  .material_count = study->material_count};
}

bool fix_study_write(struct fix_study *study, const struct shader_fixing *fixings,
                     struct shader_program **program, struct status *status) {
    const struct shader_wanted shader = wanted(study);
    const struct shader_compile_options extra = {.writes_source = true,
                                                 .fixings = fixings,
                                                 .fixing_count =
                                                     fixings ? study->program->variable_count : 0};
    return shader_library_compile(study->library, &shader, &extra, program, status);
}

bool fix_study_price(struct fix_study *study, const char *source, struct shader_fix_cost *cost,
                     struct status *status) {
    const struct machine *machine = &study->options->rendering->machine;
    const struct shader_compile_options options = {.material = (const char *const *)study->material,
                                                   .material_count = study->material_count,
                                                   .pixel_memory_bytes =
                                                       (int)machine->pixel_memory_bytes};
    struct shader_program *program;
    if (!shader_compile("(fixed-point)", source, strlen(source), &options, &program, status))
        return false;
    cost->time = 0;
    for (int i = 0; i < program->line_cost_count; i++) {
        const struct shader_line_cost *line = &program->line_costs[i];
        cost->time = ticks_add(
            cost->time, ticks_multiply(machine->operation[line->operation], (int64_t)line->count));
    }
    cost->allocated_bytes = program->memory.allocated;
    cost->spilled_bytes = program->memory.spilled;
    shader_program_destroy(program);
    return true;
}

bool fix_study_round(struct fix_study *study, struct shader_fix_error *error,
                     struct status *status) {
    struct cluster_pictures pictures = {0};
    const bool ok = render(study, true, false, NULL, &pictures, status) &&
                    compare(study, 0, &study->floats, &pictures, error, status);
    cluster_pictures_finish(&pictures);
    return ok;
}

static bool write_shader(const char *path, const char *source, struct status *status) {
    FILE *file = fopen(path, "wb");
    const bool is_written = file && fputs(source, file) >= 0;
    if ((file && fclose(file)) || !is_written)
        return status_fail(status, STATUS_IO, "cannot write %s: %s", path, strerror(errno));
    return true;
}

bool fix_study_check(struct fix_study *study, const char *source, struct shader_fix_error *error,
                     struct status *status) {
    const struct shader_precision precision = {0};
    struct cluster_pictures pictures = {0};
    const char *path = study->written + strlen(study->name) + 1;
    const bool ok =
        (!source || write_shader(path, source, status)) &&
        render(study, false, source != NULL, &precision, &pictures, status) &&
        compare(study, study->options->outliers, &study->reference, &pictures, error, status);
    cluster_pictures_finish(&pictures);
    if (source)
        unlink(path);
    return ok;
}

/* The pictures that others are compared with, and what values the variables have in them. */
static bool look(struct fix_study *study, struct status *status) {
    const struct shader_precision reference = {.reference_math = true};
    if (!render(study, false, false, &reference, &study->reference, status))
        return false;
    const struct shader_wanted shader = wanted(study);
    const struct shader_compile_options extra = {.has_probes = true};
    struct shader_program *program;
    if (!shader_library_compile(study->library, &shader, &extra, &program, status))
        return false;
    study->floats.probed = program->c_source; /* of several variants the one looked at */
    struct cluster_pictures large = {0};      /* only for the values that variables have in it */
    const bool ok = render(study, true, false, NULL, &study->floats, status) &&
                    render(study, false, false, NULL, &large, status);
    cluster_pictures_finish(&large);
    shader_program_destroy(program);
    study->floats.probed = NULL;
    if (!ok)
        return false;
    study->module = study->floats.module;
    if (!study->module || study->module->probe_count < study->program->variable_count)
        return status_fail(
            status, STATUS_INVALID,
            "%s: nothing of the frames shows the shader \"%s\" (--frames looks at more)",
            study->options->rendering->scene, study->name);
    return true;
}

/* "NAME=FILE", as libraries take it. */
static char *name_file(const char *name, const char *path) {
    char *text = memory_get(strlen(name) + strlen(path) + 2, 1);
    sprintf(text, "%s=%s", name, path);
    return text;
}

static void make_libraries(struct fix_study *study) {
    const struct host_options *rendering = study->options->rendering;
    const struct shader_compile_options options = {.pixel_memory_bytes =
                                                       (int)rendering->machine.pixel_memory_bytes};
    struct shader_precision precision = {.files = (const char *const *)&study->original,
                                         .file_count = study->original != NULL};
    study->library = shader_library_create(rendering->shader_folders,
                                           rendering->shader_folder_count, &precision);
    precision.probed_shader = study->name;
    study->probed = shader_library_create(rendering->shader_folders, rendering->shader_folder_count,
                                          &precision);
    shader_library_set_base(study->library, &options);
    shader_library_set_base(study->probed, &options);
}

static bool begin(struct fix_study *study, struct status *status) {
    const char *base = getenv("TMPDIR");
    char path[FIX_PATH_BYTES + FIX_NAME_BYTES + 8];
    snprintf(study->folder, sizeof study->folder, "%s/sortlast-fix-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(study->folder)) {
        status_fail(status, STATUS_IO, "cannot make the folder %s: %s", study->folder,
                    strerror(errno));
        study->folder[0] = 0;
        return false;
    }
    study->services = local_services_create(&study->trace, study->options->stop);
    struct stat file; /* otherwise a name, for the folders */
    if (!stat(study->options->path, &file) && !S_ISDIR(file.st_mode))
        study->original = name_file(study->name, study->options->path);
    snprintf(path, sizeof path, "%s/%s.sl", study->folder, study->name);
    study->written = name_file(study->name, path);
    make_libraries(study);
    struct shader_program *program;
    if (!read_scene(study, status) || !fix_study_write(study, NULL, &program, status))
        return false;
    study->program = program;
    return look(study, status);
}

bool fix_study_create(const struct shader_fix_options *options, struct fix_study **out,
                      struct status *status) {
    struct fix_study *study = memory_get(1, sizeof *study);
    study->options = options;
    trace_init(&study->trace, "shader", NULL);
    name_of_file(options->path, study->name);
    *out = NULL;
    if (!begin(study, status)) {
        fix_study_destroy(study);
        return false;
    }
    *out = study;
    return true;
}

void fix_study_destroy(struct fix_study *study) {
    if (!study)
        return;
    cluster_pictures_finish(&study->reference);
    cluster_pictures_finish(&study->floats);
    shader_program_destroy((struct shader_program *)study->program);
    shader_library_destroy(study->library);
    shader_library_destroy(study->probed);
    local_services_destroy(study->services);
    for (int i = 0; i < study->material_count; i++)
        free(study->material[i]);
    if (study->folder[0])
        rmdir(study->folder);
    free(study->original);
    free(study->written);
    free(study);
}
