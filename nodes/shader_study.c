/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shader_study.h"

#include "nodes/frame_plan.h"
#include "nodes/local_services.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The shader is put into a scene of one patch, written as RIB, so that it is found, bound, lit and
 * prepared by the code that serves a cluster; then its module is called on a grid instead of on
 * what a camera sees. */

enum { PATH_BYTES = 4096, BATCH = 512, PLANES_FIXED = 12, VECTOR_FLOATS_MAX = 16 };

struct shader_study {
    char path[PATH_BYTES];
    struct trace trace;
    struct local_services *services;
    struct shader_library *library;
    const struct shader_variant *variant; /* of the shader itself */
    struct scene_frame *scene;
    struct frame_plan plan;
    bool has_plan;
    struct shader_table table;
    struct shading_frame frame;
    struct prepared_shader *instance; /* NULL: nothing to run */
    bool has_overrun;
    uint64_t *executions;
    struct fast_call *fast_calls; /* that the library looks at */
};

/* Text that grows. */
struct text {
    char *bytes;
    size_t length, capacity;
};

static void add(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void add(struct text *text, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    text->bytes = memory_grow(text->bytes, &text->capacity, text->length + (size_t)length + 1, 1);
    vsnprintf(text->bytes + text->length, (size_t)length + 1, format, again);
    va_end(again);
    text->length += (size_t)length;
}

static const struct shader_parameter *find_parameter(const struct shader_program *program,
                                                     const char *name, size_t length) {
    for (int i = 0; i < program->parameter_count; i++)
        if (!program->parameters[i].is_global && strlen(program->parameters[i].name) == length &&
            !memcmp(program->parameters[i].name, name, length))
            return &program->parameters[i];
    return NULL;
}

static const char *scene_type_name(const struct shader_parameter *parameter) {
    return parameter->type == SHADER_FIXED ? "float" : shader_type_name(parameter->type);
}

/* ' "uniform color[2] name" [1 2 3 4 5 6]' */
static bool add_definition(struct text *text, const struct shader_program *program,
                           const char *definition, struct status *status) {
    const char *equals = strchr(definition, '=');
    const struct shader_parameter *parameter =
        equals ? find_parameter(program, definition, (size_t)(equals - definition)) : NULL;
    if (!equals)
        return status_fail(status, STATUS_INVALID,
                           "-D %s: a parameter is set with NAME=VALUE, several numbers with commas",
                           definition);
    if (!parameter)
        return status_fail(status, STATUS_INVALID, "-D %s: shader %s has no parameter \"%.*s\"",
                           definition, program->name, (int)(equals - definition), definition);
    char length[32] = "";
    if (parameter->array_length)
        snprintf(length, sizeof length, "[%d]", parameter->array_length);
    add(text, " \"uniform %s%s %s\" [", scene_type_name(parameter), length, parameter->name);
    int count = 0;
    for (const char *at = equals + 1;; count++) {
        const size_t size = strcspn(at, ",");
        if (parameter->type == SHADER_STRING) {
            add(text, " \"%.*s\"", (int)size, at);
        } else {
            char *end;
            const double number = strtod(at, &end);
            if (end != at + size || !size)
                return status_fail(status, STATUS_INVALID, "-D %s: \"%.*s\" is not a number",
                                   definition, (int)size, at);
            add(text, " %.9g", number);
        }
        if (!at[size])
            break;
        at += size + 1;
    }
    if (count + 1 != parameter->components)
        return status_fail(status, STATUS_INVALID, "-D %s: parameter %s takes %d values, not %d",
                           definition, parameter->name, parameter->components, count + 1);
    add(text, "]");
    return true;
}

/* Which request of the scene the shader goes with. */
static const char *request_of(enum shader_kind kind) {
    switch (kind) {
    case SHADER_KIND_DISPLACEMENT:
        return "Displacement";
    case SHADER_KIND_VOLUME:
        return "Atmosphere";
    case SHADER_KIND_LIGHT:
        return "LightSource";
    default:
        return "Surface";
    }
}

static bool write_scene(const struct shader_study *study,
                        const struct shader_study_options *options, struct text *text,
                        struct status *status) {
    const struct shader_program *program = study->variant->program;
    static const char *const usual[] = {"ambient", "distant"};
    const char *const *lights = options->light_count ? options->lights : usual;
    const int count = options->light_count ? options->light_count : 2;
    add(text, "Format 128 64 1\nProjection \"perspective\"\nTranslate 0 0 3\nWorldBegin\n");
    for (int i = 0; i < count && program->kind != SHADER_KIND_LIGHT; i++)
        add(text, "LightSource \"%s\" %d\n", lights[i], i + 1);
    if (program->kind != SHADER_KIND_SURFACE)
        add(text, "Surface \"matte\"\n");
    if (program->kind == SHADER_KIND_LIGHT)
        add(text, "LightSource \"%s\" 1", study->path);
    else
        add(text, "%s \"%s\"", request_of(program->kind), study->path);
    for (int i = 0; i < options->definition_count; i++)
        if (!add_definition(text, program, options->definitions[i], status))
            return false;
    add(text, "\nPatch \"bilinear\" \"P\" [-1 1 0 1 1 0 -1 -1 0 1 -1 0]");
    for (int i = 0; i < options->material_count; i++) {
        const char *name = options->material[i];
        const struct shader_parameter *parameter = find_parameter(program, name, strlen(name));
        if (!parameter)
            return status_fail(status, STATUS_INVALID, "shader %s has no parameter \"%s\"",
                               program->name, name);
        add(text, " \"varying %s%s %s\" [", scene_type_name(parameter), "", name);
        for (int k = 0; k < 4 * parameter->components; k++)
            add(text, " %g", 0.5);
        add(text, "]");
    }
    add(text, "\nWorldEnd\n");
    return true;
}

static bool read_scene(struct shader_study *study, const struct text *text, struct status *status) {
    struct rib_reader *reader;
    const struct scene_options reading = {0};
    bool ok = rib_reader_open_memory("(the shader's scene)", text->bytes, text->length, &reading,
                                     &reader, status);
    if (!ok)
        return false;
    ok = rib_reader_next(reader, &study->scene, status);
    rib_reader_destroy(reader);
    return ok;
}

static bool load_frame(struct shader_study *study, struct status *status) {
    study->table.services = local_services_interface(study->services);
    for (uint32_t i = 0; i < shader_library_count(study->library); i++) {
        const struct shader_program *program = shader_library_at(study->library, i)->program;
        const struct shader_payload payload = {i, program->name, program->c_source};
        struct message *message = shader_payload_encode(&payload, 0);
        const bool ok = shader_table_announce(&study->table, message, status);
        message_release(message);
        if (!ok)
            return false;
    }
    for (size_t i = 0; i < study->plan.light_count; i++)
        if (!shading_frame_add(&study->frame, study->plan.lights[i].message, WIRE_LIGHT, status))
            return false;
    for (size_t i = 0; i < study->plan.instance_count; i++)
        if (!shading_frame_add(&study->frame, study->plan.instances[i].message, WIRE_INSTANCE,
                               status))
            return false;
    return shading_frame_instance(&study->frame, &study->table, 1, &study->instance, status);
}

static bool find_kind(struct shader_study *study, struct status *status) {
    const struct scene_location nowhere = {.file = study->path, .line = 1, .column = 1};
    struct status first = {0};
    for (int kind = 0; kind < SHADER_KIND_COUNT; kind++) {
        const struct shader_wanted wanted = {.name = study->path, .kind = (enum shader_kind)kind};
        struct status one = {0};
        if (shader_library_variant(study->library, &wanted, &nowhere, &study->variant, &one))
            return true;
        if (!kind)
            first = one;
        if (!shader_library_count(study->library)) { /* it does not compile */
            *status = one;
            return false;
        }
    }
    *status = first;
    return false;
}

static bool prepare(struct shader_study *study, const struct shader_study_options *options,
                    struct status *status) {
    struct text text = {0};
    bool ok = write_scene(study, options, &text, status) && read_scene(study, &text, status);
    free(text.bytes);
    if (!ok)
        return false;
    study->has_plan = frame_plan_make(study->scene, study->library, &study->plan, status);
    if (!study->has_plan)
        return false;
    if (study->variant->program->kind == SHADER_KIND_SURFACE)
        study->variant = study->plan.instances[0].variant; /* with its material parameters */
    return load_frame(study, status);
}

bool shader_study_create(const struct shader_study_options *options, struct shader_study **out,
                         struct status *status) {
    struct shader_study *study = memory_get(1, sizeof *study);
    char resolved[PATH_BYTES];
    *out = NULL;
    if (!realpath(options->path, resolved)) {
        free(study);
        return status_fail(status, STATUS_NOT_FOUND, "cannot open shader %s: %s", options->path,
                           strerror(errno));
    }
    snprintf(study->path, sizeof study->path, "%s", resolved);
    trace_init(&study->trace, "shader", NULL);
    study->services = local_services_create(&study->trace, NULL);
    struct shader_precision precision = {.fast_math = options->compile.fast_math,
                                         .fast_calls = options->fast_calls,
                                         .parameters = options->compile.parameters};
    precision.fast_calls.list = study->fast_calls =
        memory_get((size_t)precision.fast_calls.count, sizeof *study->fast_calls);
    for (int i = 0; i < precision.fast_calls.count; i++)
        study->fast_calls[i] = (struct fast_call){study->path, options->fast_calls.list[i].call};
    study->library = shader_library_create(options->folders, options->folder_count, &precision);
    struct shader_compile_options base = options->compile;
    base.allows_external = options->link != NULL;
    local_services_set_link(study->services, options->link);
    shader_library_set_base(study->library, &base);
    bool ok = find_kind(study, status);
    if (ok && study->variant->program->kind != SHADER_KIND_IMAGER)
        ok = prepare(study, options, status);
    if (!ok) {
        shader_study_destroy(study);
        return false;
    }
    *out = study;
    return true;
}

void shader_study_destroy(struct shader_study *study) {
    if (!study)
        return;
    shading_frame_finish(&study->frame);
    shader_table_finish(&study->table);
    if (study->has_plan)
        frame_plan_finish(&study->plan);
    scene_frame_destroy(study->scene);
    shader_library_destroy(study->library);
    local_services_destroy(study->services);
    free(study->executions);
    free(study->fast_calls);
    free(study);
}

const struct shader_program *shader_study_program(const struct shader_study *study) {
    return study->variant->program;
}

const char *shader_study_warning(struct shader_study *study) {
    return shader_library_warning(study->library);
}

/* Where lane `k` of the grid lies: quads of four lanes side by side, row by row of quads. */
static void lane_place(uint32_t width, size_t k, uint32_t *x, uint32_t *y) {
    const size_t quad = k / 4, across = width / 2;
    *x = (uint32_t)(quad % across) * 2 + (k & 1);
    *y = (uint32_t)(quad / across) * 2 + (k >> 1 & 1);
}

struct grid {
    uint32_t width, height;
    float *planes, *scratch;
    const float **material;
    int32_t *present;
};

/* What the sample at (s, t) brings for each component of the transfer map. */
static float component(const struct shader_parameter *parameter, int c, float s, float t) {
    const char *name = parameter->name;
    if (!parameter->is_global)
        return 0.5f;
    if (!strcmp(name, "s") || !strcmp(name, "u"))
        return s;
    if (!strcmp(name, "t") || !strcmp(name, "v"))
        return t;
    if (!strcmp(name, "N") || !strcmp(name, "Ng"))
        return c == 2 ? -1.0f : 0.0f;
    if (!strcmp(name, "dPdu"))
        return c == 0 ? 2.0f : 0.0f;
    if (!strcmp(name, "dPdv"))
        return c == 1 ? -2.0f : 0.0f;
    return 1.0f;
}

static void fill_batch(const struct shader_study *study, const struct grid *grid, size_t first,
                       size_t count, struct shader_call *call) {
    const struct shader_program *program = study->plan.instances[0].variant->program;
    float *position = grid->planes + (size_t)program->material_count * BATCH;
    for (size_t k = 0; k < count; k++) {
        uint32_t x, y;
        lane_place(grid->width, first + k, &x, &y);
        const float s = ((float)x + 0.5f) / (float)grid->width,
                    t = ((float)y + 0.5f) / (float)grid->height;
        for (int p = 0; p < program->parameter_count; p++) {
            const struct shader_parameter *parameter = &program->parameters[p];
            for (int c = 0; parameter->is_material && c < parameter->components; c++)
                grid->planes[(size_t)(parameter->map_offset + c) * BATCH + k] =
                    component(parameter, c, s, t);
        }
        position[k] = 2 * s - 1;
        position[BATCH + k] = 1 - 2 * t;
        position[2 * BATCH + k] = 3;
        grid->present[k] = -1;
    }
    for (int c = 0; c < 3; c++) {
        call->position[c] = call->incident[c] = position + c * BATCH;
        call->color[c] = position + (3 + c) * BATCH;
        call->opacity[c] = position + (6 + c) * BATCH;
    }
    call->count = count;
    call->material = grid->material;
    call->present = grid->present;
}

static void store_batch(const struct grid *grid, struct image *image, size_t first,
                        const struct shader_call *call) {
    for (size_t k = 0; k < call->count; k++) {
        uint32_t x, y;
        lane_place(grid->width, first + k, &x, &y);
        for (int c = 0; c < 3; c++)
            image->channels[c].values[(size_t)y * grid->width + x] = call->color[c][k];
    }
}

static void begin_counts(struct shader_study *study) {
    execution_counts_reset(&study->instance->counts);
    for (size_t l = 0; l < study->frame.light_count; l++)
        if (study->frame.lights[l].module)
            execution_counts_reset(&study->frame.lights[l].counts);
    study->has_overrun = false;
}

bool shader_study_run(struct shader_study *study, uint32_t width, uint32_t height,
                      struct image *image, struct status *status) {
    struct prepared_shader *instance = study->instance;
    if (!instance)
        return status_fail(status, STATUS_INVALID,
                           "%s is an imager shader: there is nothing to shade with it alone",
                           study->path);
    const struct shader_module *module = instance->module;
    const int materials = module->material_count;
    struct grid grid = {.width = width, .height = height};
    const size_t light_floats = (size_t)module->light_sets * (size_t)instance->light_count *
                                (size_t)instance->light_vectors * VECTOR_FLOATS_MAX;
    grid.planes = aligned_alloc(64, (size_t)(materials + PLANES_FIXED) * BATCH * sizeof(float));
    grid.scratch = aligned_alloc(64, (light_floats + VECTOR_FLOATS_MAX) * sizeof(float));
    grid.present = aligned_alloc(64, BATCH * sizeof *grid.present);
    grid.material = memory_get((size_t)materials, sizeof *grid.material);
    if (!grid.planes || !grid.scratch || !grid.present)
        abort();
    for (int p = 0; p < materials; p++)
        grid.material[p] = grid.planes + (size_t)p * BATCH;
    begin_counts(study);
    for (size_t first = 0; first < (size_t)width * height; first += BATCH) {
        const size_t left = (size_t)width * height - first;
        struct shader_call call = {
            .uniform = instance->uniform,
            .matrices = instance->matrices,
            .lights = instance->lights,
            .instance = 1,
            .light_count = instance->light_count,
            .light_vectors = instance->light_vectors,
            .light_scratch = grid.scratch,
            .texts = instance->texts ? &instance->texts->texts : NULL,
            .counters = &instance->counts.counters,
        };
        fill_batch(study, &grid, first, left < BATCH ? left : BATCH, &call);
        module->shade(&call);
        study->has_overrun |= call.overrun != 0;
        if (image)
            store_batch(&grid, image, first, &call);
    }
    free(grid.planes);
    free(grid.scratch);
    free(grid.present);
    free(grid.material);
    return true;
}

void shader_study_count(const struct shader_study *study, struct shader_study_counts *counts) {
    *counts = (struct shader_study_counts){.has_overrun = study->has_overrun};
    if (!study->instance)
        return;
    const struct execution_counts *own = &study->instance->counts;
    counts->block_executions = own->counters.block_executions;
    for (int b = 0; b < own->module->block_count; b++)
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
                counts->operations[s][o] +=
                    counts->block_executions[b] * own->module->blocks[b].operations[s][o];
    uint64_t streams[SHADER_STREAM_COUNT] = {0};
    for (size_t l = 0; l < study->frame.light_count; l++)
        if (study->frame.lights[l].module)
            execution_counts_add_operations(&study->frame.lights[l].counts, counts->lights,
                                            streams);
}
