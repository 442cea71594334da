/* SPDX-License-Identifier: Apache-2.0 */
#include "program_comparison.h"

#include "reference_evaluator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 16, PLANES = 192, LIGHT_SETS = 8 };

/* One program, both ways. */
struct subject {
    struct random_program program;
    struct shader_program *compiled;
    const struct shader_module *module;
    struct reference *reference;
    const char *text;
    float *uniform;
    uint64_t executions[512];
    struct shader_counters counters;
    bool is_there;
};

struct scene {
    struct subject lights[COMPARISON_LIGHTS];
    struct shader_matrices matrices;
    _Alignas(64) float position[3][SAMPLES], incident[3][SAMPLES];
};

static bool is_material(const struct random_program *program, const char *name) {
    static const char *const bound[] = {"Cs", "Os"};
    for (int i = 0; i < program->material_count; i++)
        if (!strcmp(program->material[i], name))
            return true;
    bool is_parameter = (name[0] == 'p' || name[0] == 'w') && name[1] >= '0' && name[1] <= '9';
    return !is_parameter && strcmp(name, bound[0]) && strcmp(name, bound[1]);
}

struct input_context {
    const struct random_program *program;
    int sample;
};

static bool input(const void *context, const char *name, int component, float *value) {
    const struct input_context *in = context;
    return random_program_input(in->program->seed, name, is_material(in->program, name), component,
                                in->sample, value);
}

static void no_report(struct shader_counters *counters, uint32_t block, uint64_t key,
                      uint64_t trips) {
}

/* Rotations and shears with numbers that are not round, as cameras have them. */
static void set_scene(struct scene *scene, uint64_t seed) {
    for (int s = 0; s < SHADER_SPACE_COUNT; s++)
        for (int i = 0; i < 16; i++) {
            const bool is_camera = s <= SHADER_SPACE_CAMERA, is_diagonal = i % 5 == 0;
            float a, b;
            random_program_input(seed, "from", true, i, s, &a);
            random_program_input(seed, "to", true, i, s, &b);
            scene->matrices.from_camera[s][i] = is_camera ? is_diagonal : i % 4 == 3 ? i == 15 : a;
            scene->matrices.to_camera[s][i] = is_camera ? is_diagonal : i % 4 == 3 ? i == 15 : b;
        }
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < SAMPLES; i++) {
            random_program_input(seed, "position", true, c, i, &scene->position[c][i]);
            random_program_input(seed, "incident", true, c, i, &scene->incident[c][i]);
        }
}

/* The evaluator on a text; that of a surface is there only while it is compared, since a bundle of
 * them is a lot of memory to touch. */
static bool subject_evaluate(struct subject *s, const char *text, char *message, size_t size) {
    s->reference = reference_open(text, s->program.fast_math, message, size);
    return s->reference != NULL;
}

/* The compiler on the text; false with a message when it refuses. */
static bool subject_open(struct subject *s, const char *text, char *message, size_t size) {
    struct status status = {0};
    struct shader_compile_options options = {.material = s->program.material,
                                             .material_count = s->program.material_count,
                                             .fast_math = s->program.fast_math,
                                             .passes_left_out = s->program.passes_left_out};
    if (!shader_compile("program.sl", text, strlen(text), &options, &s->compiled, &status)) {
        snprintf(message, size, "%s", status.message);
        return false;
    }
    s->text = text;
    s->is_there = true;
    return true;
}

static void subject_close(struct subject *s) {
    reference_close(s->reference);
    shader_program_destroy(s->compiled);
    random_program_finish(&s->program);
    free(s->uniform);
    *s = (struct subject){0};
}

/* Bound values, then the uniform code. */
static void subject_prepare(struct subject *s, const struct scene *scene) {
    float bound[512] = {0};
    uint8_t given[512] = {0};
    s->counters = (struct shader_counters){s->executions, no_report};
    s->uniform = calloc((size_t)s->module->uniform_count + 1, sizeof *s->uniform);
    for (int p = 0; p < s->compiled->parameter_count; p++) {
        const struct shader_parameter *parameter = &s->compiled->parameters[p];
        struct input_context context = {&s->program, 0};
        for (int i = 0; parameter->bound_offset >= 0 && i < parameter->components; i++)
            given[parameter->bound_offset + i] =
                input(&context, parameter->name, i, &bound[parameter->bound_offset + i]);
    }
    s->module->prepare(bound, given, &scene->matrices, NULL, s->uniform);
}

static void run_compiled(struct subject *s, struct scene *scene, struct subject *const *lights,
                         int light_count, float color[3][SAMPLES]) {
    static _Alignas(64) float planes[PLANES][SAMPLES], out[6][SAMPLES],
        scratch[LIGHT_SETS * COMPARISON_LIGHTS * 7 * SAMPLES];
    const float *material[PLANES];
    struct shader_light table[COMPARISON_LIGHTS];
    for (int p = 0; p < s->compiled->parameter_count; p++) {
        const struct shader_parameter *parameter = &s->compiled->parameters[p];
        for (int c = 0; parameter->is_material && c < parameter->components; c++)
            for (int i = 0; i < SAMPLES; i++) {
                struct input_context context = {&s->program, i};
                input(&context, parameter->name, c, &planes[parameter->map_offset + c][i]);
            }
    }
    if (s->module->light_sets > LIGHT_SETS)
        abort();
    for (int p = 0; p < PLANES; p++)
        material[p] = planes[p];
    for (int i = 0; i < light_count; i++)
        table[i] = (struct shader_light){.module = lights[i]->module,
                                         .uniform = lights[i]->uniform,
                                         .matrices = &scene->matrices,
                                         .counters = &lights[i]->counters};
    struct shader_call call = {.count = SAMPLES,
                               .material = material,
                               .uniform = s->uniform,
                               .matrices = &scene->matrices,
                               .lights = table,
                               .light_count = light_count,
                               .light_vectors = 7,
                               .light_scratch = scratch,
                               .counters = &s->counters};
    for (int c = 0; c < 3; c++) {
        call.position[c] = scene->position[c];
        call.incident[c] = scene->incident[c];
        call.color[c] = out[c];
        call.opacity[c] = out[3 + c];
    }
    s->module->shade(&call);
    memcpy(color, out, 3 * sizeof *out);
}

static bool run_reference(struct subject *s, const struct scene *scene,
                          struct subject *const *lights, int light_count, int sample,
                          float color[3]) {
    struct reference_light table[COMPARISON_LIGHTS];
    struct input_context context = {&s->program, sample};
    struct reference_world world = {input, &context, .matrices = &scene->matrices, .lights = table,
                                    .light_count = light_count};
    bool ok = true;
    for (int c = 0; c < 3; c++) {
        world.position[c] = scene->position[c][sample];
        world.incident[c] = scene->incident[c][sample];
    }
    for (int i = 0; i < light_count; i++) {
        struct input_context of_light = {&lights[i]->program, sample};
        world.context = &of_light;
        ok &= reference_run_light(lights[i]->reference, &world, &table[i]);
    }
    world.context = &context;
    return reference_shade(s->reference, &world, color) && ok;
}

static bool is_same(float a, float b) {
    return (isnan(a) && isnan(b)) || !memcmp(&a, &b, sizeof a);
}

/* Counts a difference; true when it is the first, of which more is told. */
static bool note(struct comparison_result *result, uint64_t seed) {
    if (result->differences++)
        return false;
    result->seed = seed;
    return true;
}

/* Compares sample by sample until the first difference. */
static void compare_samples(struct subject *s, struct scene *scene,
                            struct comparison_result *result) {
    struct subject *lights[COMPARISON_LIGHTS];
    float color[3][SAMPLES];
    int count = (int)(s->program.seed % 4);
    for (int i = 0; i < count; i++)
        lights[i] = &scene->lights[(s->program.seed / 4 + (uint64_t)i * 3) % COMPARISON_LIGHTS];
    subject_prepare(s, scene);
    run_compiled(s, scene, lights, count, color);
    for (int i = 0; i < SAMPLES; i++) {
        float expected[3];
        const bool ends = run_reference(s, scene, lights, count, i, expected);
        if (ends && is_same(color[0][i], expected[0]) && is_same(color[1][i], expected[1]) &&
            is_same(color[2][i], expected[2]))
            continue;
        if (!note(result, s->program.seed))
            return;
        result->sample = i;
        for (int c = 0; c < 3; c++) {
            result->compiled[c] = color[c][i];
            result->reference[c] = expected[c];
        }
        if (!ends)
            snprintf(result->message, sizeof result->message, "a loop does not end");
        return;
    }
}

static void compare(struct subject *s, struct scene *scene, struct comparison_result *result) {
    char message[1024];
    if (subject_evaluate(s, s->text, message, sizeof message))
        compare_samples(s, scene, result);
    else if (note(result, s->program.seed))
        snprintf(result->message, sizeof result->message, "%s", message);
    reference_close(s->reference);
    s->reference = NULL;
}

/* Compiles and compares all that are there. */
static void compare_all(struct scene *scene, struct subject *subjects, int count,
                        const struct bundle_settings *settings, struct comparison_result *result) {
    struct shader_program **programs = calloc((size_t)count + COMPARISON_LIGHTS, sizeof *programs);
    struct program_bundle bundle = {0};
    struct status status = {0};
    int there = 0;
    for (; there < COMPARISON_LIGHTS; there++)
        programs[there] = scene->lights[there].compiled;
    for (int i = 0; i < count; i++)
        if (subjects[i].is_there)
            programs[there++] = subjects[i].compiled;
    bool ok = program_bundle_open(&bundle, programs, there, settings, &status);
    if (!ok && note(result, subjects[0].program.seed))
        snprintf(result->message, sizeof result->message, "%s", status.message);
    if (!ok)
        result->differences = count;
    for (int i = 0; ok && i < COMPARISON_LIGHTS; i++) {
        scene->lights[i].module = bundle.modules[i];
        free(scene->lights[i].uniform);
        subject_prepare(&scene->lights[i], scene);
    }
    there = COMPARISON_LIGHTS;
    for (int i = 0; ok && i < count; i++) {
        if (!subjects[i].is_there)
            continue;
        subjects[i].module = bundle.modules[there++];
        compare(&subjects[i], scene, result);
    }
    program_bundle_close(&bundle);
    free(programs);
}

const struct bundle_settings *comparison_settings_of(uint64_t first_seed) {
    static const struct bundle_settings quick[] = {
        {8, "-O0", "clang"}, {16, "-O0", "clang"}, {4, "-O0", "clang"}, {8, "-O0", "clang"},
        {16, "-O0", "cc"},   {4, "-O0", "clang"},  {8, "-O0", "cc"},    {16, "-O0", "clang"},
        {4, "-O0", "clang"}, {8, "-O0", "clang"},  {16, "-O0", "clang"}};
    static const struct bundle_settings full[] = {
        {16, "-O2", "cc"}, {8, "-O2", "cc"}, {4, "-O2", "cc"}};
    const uint64_t bundle = first_seed / COMPARISON_BUNDLE;
    if (bundle % COMPARISON_FULL == COMPARISON_FULL - 1)
        return &full[bundle / COMPARISON_FULL % (sizeof full / sizeof *full)];
    return &quick[bundle % (sizeof quick / sizeof *quick)];
}

static bool open_scene(struct scene *scene, uint64_t seed, struct comparison_result *result) {
    char message[sizeof result->message];
    set_scene(scene, seed);
    for (int i = 0; i < COMPARISON_LIGHTS; i++) {
        struct subject *light = &scene->lights[i];
        random_program_make(&light->program, seed + (uint64_t)i, true);
        if (!subject_open(light, light->program.text, message, sizeof message) ||
            !subject_evaluate(light, light->program.text, message, sizeof message)) {
            note(result, seed + (uint64_t)i);
            snprintf(result->message, sizeof result->message, "light: %.1024s", message);
            return false;
        }
    }
    return true;
}

static void close_scene(struct scene *scene) {
    for (int i = 0; i < COMPARISON_LIGHTS; i++)
        subject_close(&scene->lights[i]);
    free(scene);
}

static struct scene *new_scene(void) {
    struct scene *scene = aligned_alloc(64, (sizeof *scene + 63) / 64 * 64);
    memset(scene, 0, sizeof *scene);
    return scene;
}

bool comparison_run(uint64_t first_seed, int count, const struct bundle_settings *settings,
                    struct comparison_result *result) {
    struct scene *scene = new_scene();
    struct subject *subjects = calloc((size_t)count, sizeof *subjects);
    char message[sizeof result->message];
    *result = (struct comparison_result){0};
    bool ok = open_scene(scene, first_seed, result);
    for (int i = 0; ok && i < count; i++) {
        struct subject *s = &subjects[i];
        random_program_make(&s->program, first_seed + (uint64_t)i, false);
        if (!subject_open(s, s->program.text, message, sizeof message) &&
            note(result, s->program.seed))
            snprintf(result->message, sizeof result->message, "%s", message);
    }
    if (ok)
        compare_all(scene, subjects, count, settings, result);
    for (int i = 0; i < count; i++)
        subject_close(&subjects[i]);
    free(subjects);
    close_scene(scene);
    return result->differences == 0;
}

/* ---- reduction ---- */

static bool still_differs(struct scene *scene, const struct random_program *program,
                          const char *text, const struct bundle_settings *settings) {
    struct comparison_result result = {0};
    struct subject s = {.program = *program};
    char message[2048];
    s.program.text = NULL;
    for (int i = 0; i < s.program.material_count; i++)
        s.program.material[i] = program->material[i];
    if (subject_open(&s, text, message, sizeof message))
        compare_all(scene, &s, 1, settings, &result);
    subject_close(&s);
    return result.differences && !result.message[0];
}

static char *without(const char *text, const char *from, const char *to) {
    char *rest = malloc(strlen(text) + 1);
    memcpy(rest, text, (size_t)(from - text));
    strcpy(rest + (from - text), to);
    return rest;
}

/* The end of the line at `at`, and of the block that it opens when `whole`. */
static const char *end_of(const char *at, bool whole) {
    int depth = 0;
    for (; *at; at++) {
        depth += *at == '{';
        depth -= *at == '}';
        if (*at == '\n' && (!whole || depth <= 0))
            return at + 1;
    }
    return at;
}

/* The program with statements removed for as long as it still differs. */
static char *reduce(struct scene *scene, const struct random_program *program,
                    const struct bundle_settings *settings) {
    char *text = strdup(program->text);
    for (bool has_changed = true; has_changed;) {
        has_changed = false;
        for (const char *at = text; *at;) {
            const char *end = end_of(at, true);
            char *shorter = without(text, at, end);
            size_t offset = (size_t)(at - text);
            if (still_differs(scene, program, shorter, settings)) {
                free(text);
                text = shorter;
                at = text + offset;
                has_changed = true;
            } else {
                free(shorter);
                at = end_of(at, false);
            }
        }
    }
    return text;
}

static char *describe(const struct scene *scene, uint64_t first_seed, const char *text,
                      const struct bundle_settings *settings,
                      const struct comparison_result *result) {
    char *report = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&report, &length);
    const uint64_t seed = result->seed;
    const float *c = result->compiled, *r = result->reference;
    fprintf(out, "%s", text);
    for (unsigned i = 0; !result->message[0] && i < seed % 4; i++)
        fprintf(out, "%s", scene->lights[(seed / 4 + i * 3) % COMPARISON_LIGHTS].program.text);
    fprintf(out,
            "program %llu (of the bundle from %llu), %d lanes, %s %s: ", (unsigned long long)seed,
            (unsigned long long)first_seed, settings->width, settings->compiler,
            settings->optimisation);
    if (result->message[0])
        fprintf(out, "%s", result->message);
    else
        fprintf(out, "sample %d is %a %a %a compiled and %a %a %a by reference", result->sample,
                (double)c[0], (double)c[1], (double)c[2], (double)r[0], (double)r[1], (double)r[2]);
    fclose(out);
    return report;
}

char *comparison_report(uint64_t first_seed, const struct bundle_settings *settings,
                        const struct comparison_result *result) {
    struct scene *scene = new_scene();
    struct comparison_result ignored = {0};
    struct random_program program;
    random_program_make(&program, result->seed, false);
    char *text = NULL;
    if (!result->message[0] && open_scene(scene, first_seed, &ignored))
        text = reduce(scene, &program, settings);
    char *report = describe(scene, first_seed, text ? text : program.text, settings, result);
    free(text);
    random_program_finish(&program);
    close_scene(scene);
    return report;
}
