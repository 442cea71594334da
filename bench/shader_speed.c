/* SPDX-License-Identifier: Apache-2.0 */
/* Samples shaded a second on one core: whole calls of compiled shaders with their lights, in
 * batches as the shading node makes them, beside the same shaders written by hand in scalar C and
 * beside the bare noise kernel. Says, too, how long each takes to compile from nothing.
 *
 * usage: shader_speed [SECONDS-EACH] (0.3 when not given) */
#include "scalar_shaders.h"
#include "shaders/compiler/shader_compile.h"
#include "shaders/loader/shader_cache.h"
#include "shaders/simd/vector_kernels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BATCH = 512, PLANES = 32 };

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static _Noreturn void die(const char *message) {
    fprintf(stderr, "shader_speed: %s\n", message);
    exit(1);
}

/* A compiled shader with its default parameters. */
struct compiled {
    struct shader_program *program;
    const struct shader_module *module;
    float *uniform;
    struct shader_counters counters;
    uint64_t *executions;
};

static void ignore_trips(struct shader_counters *counters, uint32_t block, uint64_t key,
                         uint64_t trips) {
}

static struct shader_matrices matrices;

static struct compiled compile(struct shader_cache *cache, const char *name, const char *text) {
    const struct shader_compile_options options = {0};
    struct status status = {0};
    struct compiled c = {0};
    if (!shader_compile(name, text, strlen(text), &options, &c.program, &status) ||
        !shader_cache_load(cache,
                           (struct shader_cache_source){c.program->name, c.program->c_source},
                           &c.module, &status))
        die(status.message);
    float bound[256] = {0};
    uint8_t given[256] = {0};
    c.uniform = calloc((size_t)c.module->uniform_count + 1, sizeof *c.uniform);
    c.executions = calloc((size_t)c.module->block_count + 1, sizeof *c.executions);
    c.counters = (struct shader_counters){c.executions, ignore_trips};
    c.module->prepare(bound, given, &matrices, NULL, c.uniform);
    return c;
}

static char *library_text(const char *name) {
    static char text[1 << 16];
    char path[512];
    snprintf(path, sizeof path, SHADERS "/%s.sl", name);
    FILE *file = fopen(path, "rb");
    if (!file)
        die(path);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

static struct compiled compile_library(struct shader_cache *cache, const char *name) {
    return compile(cache, name, library_text(name));
}

/* Marble whose turbulence has no octaves: all of the shader but its noise. */
static struct compiled compile_without_noise(struct shader_cache *cache) {
    char *text = library_text("marble"), *octaves = strstr(text, "octaves = 6");
    if (!octaves)
        die("marble has other octaves than it had");
    octaves[strlen("octaves = ")] = '0';
    return compile(cache, "marble", text);
}

/* ---- what is shaded: a curved patch seen in perspective ---- */

static _Alignas(64) float position[3][BATCH], planes[PLANES][BATCH], color[6][BATCH],
    scratch[4 * 7 * 16];
static struct scalar_sample samples[BATCH];

static void set_samples(void) {
    for (int i = 0; i < BATCH; i++) {
        const float s = (float)(i % 32) / 32, t = (float)(i / 32) / 16;
        samples[i] = (struct scalar_sample){.p = {4 * s - 2, 3 * t - 1.5f, 5 + s * t},
                                            .n = {0.1f * s, 0.2f * t, -1},
                                            .dpdu = {4, 0, t},
                                            .dpdv = {0, 3, s},
                                            .s = s,
                                            .t = t};
        for (int c = 0; c < 3; c++)
            position[c][i] = samples[i].i[c] = samples[i].p[c];
    }
}

static float material_value(const struct scalar_sample *sample, const char *name, int c) {
    return !strcmp(name, "s") || !strcmp(name, "u")    ? sample->s
           : !strcmp(name, "t") || !strcmp(name, "v")  ? sample->t
           : !strcmp(name, "N") || !strcmp(name, "Ng") ? sample->n[c]
           : !strcmp(name, "dPdu")                     ? sample->dpdu[c]
                                                       : sample->dpdv[c];
}

static struct shader_call make_call(struct compiled *shader, struct shader_light *lights,
                                    int light_count, const float *material[PLANES]) {
    for (int p = 0; p < shader->program->parameter_count; p++) {
        const struct shader_parameter *parameter = &shader->program->parameters[p];
        for (int c = 0; parameter->is_material && c < parameter->components; c++)
            for (int i = 0; i < BATCH; i++)
                planes[parameter->map_offset + c][i] =
                    material_value(&samples[i], parameter->name, c);
    }
    for (int p = 0; p < PLANES; p++)
        material[p] = planes[p];
    struct shader_call call = {.count = BATCH,
                               .material = material,
                               .uniform = shader->uniform,
                               .matrices = &matrices,
                               .lights = lights,
                               .light_count = light_count,
                               .light_vectors = 7,
                               .light_scratch = scratch,
                               .counters = &shader->counters};
    for (int c = 0; c < 3; c++) {
        call.position[c] = call.incident[c] = position[c];
        call.color[c] = color[c];
        call.opacity[c] = color[3 + c];
    }
    return call;
}

/* ---- timing: the best of several stretches, in nanoseconds a sample ---- */

enum { STRETCHES = 400 }; /* short ones: some go by undisturbed even on a busy machine */
static double seconds_each = 0.3;

#define BEST_NS(work)                                                                              \
    ({                                                                                             \
        double best = INFINITY;                                                                    \
        for (int stretch = 0; stretch < STRETCHES; stretch++) {                                    \
            double started = now_s(), end = started;                                               \
            long batches = 0;                                                                      \
            while (end - started < seconds_each / STRETCHES) {                                     \
                for (int again = 0; again < 4; again++, batches++)                                 \
                    work;                                                                          \
                end = now_s();                                                                     \
            }                                                                                      \
            best = fmin(best, (end - started) * 1e9 / ((double)batches * BATCH));                  \
        }                                                                                          \
        best;                                                                                      \
    })

static void run_scalar(scalar_shader *shader, const struct scalar_lights *lights) {
    static float out[BATCH][3];
    for (int i = 0; i < BATCH; i++)
        shader(&samples[i], lights, out[i]);
    __asm__ volatile("" : : "r"(out) : "memory");
}

static double time_noise_kernel(void) {
    const struct vector_function *noise = vector_kernels_find(vector_kernels_best(), "noise3");
    const float *in[3] = {position[0], position[1], position[2]};
    float *out[1] = {color[0]};
    return BEST_NS(noise->apply(in, out, BATCH));
}

static void measure_library(struct shader_cache *cache, struct shader_light *lights, double noise) {
    static const struct {
        const char *name;
        scalar_shader *scalar;
    } rows[] = {{"matte", scalar_matte},
                {"plastic", scalar_plastic},
                {"marble", scalar_marble},
                {"planks", scalar_planks},
                {"fancy_brick", scalar_fancy_brick},
                {"ripple_reflection", scalar_ripple_reflection}};
    const struct scalar_lights by_hand = {{1, 1, 1}, {1, 1, 1}, {0, 0, 1}};
    printf("%-18s %12s %12s %8s %10s\n", "shader", "M samples/s", "scalar C", "ratio",
           "ready in s");
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        const float *material[PLANES];
        const double begin = now_s();
        struct compiled shader = compile_library(cache, rows[r].name);
        const double ready = now_s() - begin;
        struct shader_call call = make_call(&shader, lights, 2, material);
        const double vector = BEST_NS(shader.module->shade(&call)),
                     scalar = BEST_NS(run_scalar(rows[r].scalar, &by_hand));
        double largest = 0;
        for (int i = 0; i < BATCH; i++) {
            float expected[3];
            rows[r].scalar(&samples[i], &by_hand, expected);
            for (int c = 0; c < 3; c++)
                largest = fmax(largest, fabs((double)(expected[c] - color[c][i])));
        }
        printf("%-18s %12.1f %12.1f %8.2f %10.2f   largest difference %.1g", rows[r].name,
               1e3 / vector, 1e3 / scalar, scalar / vector, ready, largest);
        if (!strcmp(rows[r].name, "marble")) {
            struct compiled silent = compile_without_noise(cache);
            struct shader_call rest = make_call(&silent, lights, 2, material);
            const double share = vector - BEST_NS(silent.module->shade(&rest));
            printf("; %.2f times six bare noises, of which its six octaves %.2f",
                   vector / (6 * noise), share / (6 * noise));
        }
        printf("\n");
    }
}

/* Points a second in the terms in which shading systems are compared: no lights. */
static void measure_points(struct shader_cache *cache, double kernel) {
    static const struct {
        const char *name, *text;
    } rows[] = {
        {"noise", "surface n() { Ci = float noise(P); }"},
        {"six-octave marble",
         "surface m() { point q = 2 * P; float i, size = 1, sum = 0;\n"
         "  for (i = 0; i < 6; i += 1) { sum += abs(noise(q) - 0.5) * size; size *= 0.5; q *= 2; "
         "}\n"
         "  Ci = spline(sin(ycomp(P) + 3 * sum) * 0.5 + 0.5, color 0.1, color 0.2, color 0.5,\n"
         "              color 0.9, color 1); }"},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        const float *material[PLANES];
        struct compiled shader = compile(cache, rows[r].name, rows[r].text);
        struct shader_call call = make_call(&shader, NULL, 0, material);
        printf("%-18s %12.1f M points/s\n", rows[r].name,
               1e3 / BEST_NS(shader.module->shade(&call)));
    }
    printf("%-18s %12.1f M points/s\n", "bare noise kernel", 1e3 / kernel);
}

int main(int argc, char **argv) {
    struct shader_cache *cache = NULL;
    struct status status = {0};
    if (argc > 1)
        seconds_each = atof(argv[1]);
    for (int s = 0; s < SHADER_SPACE_COUNT; s++)
        for (int i = 0; i < 16; i += 5)
            matrices.from_camera[s][i] = matrices.to_camera[s][i] = 1;
    if (!shader_cache_open(&cache, &status))
        die(status.message);
    printf("%s, kernel %s\n", shader_cache_vectors(cache), vector_kernels_best()->name);
    set_samples();
    struct compiled ambient = compile_library(cache, "ambient"),
                    distant = compile_library(cache, "distant");
    struct shader_light lights[2] = {{.module = ambient.module,
                                      .uniform = ambient.uniform,
                                      .matrices = &matrices,
                                      .counters = &ambient.counters},
                                     {.module = distant.module,
                                      .uniform = distant.uniform,
                                      .matrices = &matrices,
                                      .counters = &distant.counters}};
    const double kernel = time_noise_kernel();
    measure_library(cache, lights, kernel);
    measure_points(cache, kernel);
    return 0;
}
