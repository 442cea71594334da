/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/calibrate.h"
#include "nodes/programs/json_output.h"
#include "nodes/programs/program_process.h"
#include "nodes/programs/render_options.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Whatever else happens on this host only adds to a time: the least of so many rounds, between
 * which all the other measurements are made, counts. */
enum { LOOPS = 32, COUNT_PS = 1000000, ROUNDS = 3 };

/* Operations that are measured: X(operation, statement of the loop). Others take over the price of
 * one that is like them, below. */
#define MEASURED(X)                                                                                \
    X(FLOAT_ADD, "x = x + k")                                                                      \
    X(FLOAT_MULTIPLY, "x = x * k")                                                                 \
    X(FLOAT_DIVIDE, "x = k / x")                                                                   \
    X(FLOAT_SQRT, "x = sqrt(x)")                                                                   \
    X(FLOAT_NOISE, "x = noise(x)")                                                                 \
    X(FLOAT_FLOOR, "x = floor(x)")                                                                 \
    X(FLOAT_SELECT, "x = min(x, k)")                                                               \
    X(SIN, "x = sin(x)")                                                                           \
    X(COS, "x = cos(x)")                                                                           \
    X(TAN, "x = tan(x)")                                                                           \
    X(ASIN, "x = asin(x)")                                                                         \
    X(ACOS, "x = acos(x)")                                                                         \
    X(ATAN, "x = atan(x)")                                                                         \
    X(ATAN2, "x = atan(x, k)")                                                                     \
    X(EXP, "x = exp(x)")                                                                           \
    X(LOG, "x = log(x)")                                                                           \
    X(POW, "x = pow(x, k)")

/* X(operation, the measured one it is priced like) */
#define LIKE(X)                                                                                    \
    X(FLOAT_COMPARE, FLOAT_SELECT)                                                                 \
    X(FLOAT_SIGN, FLOAT_SELECT)                                                                    \
    X(FLOAT_MOVE, FLOAT_SELECT)                                                                    \
    X(FLOAT_DIFFERENCE, FLOAT_ADD)                                                                 \
    X(LOGIC, FLOAT_SELECT)                                                                         \
    X(EXP2, EXP)                                                                                   \
    X(LOG2, LOG)

struct calibration {
    struct machine machine; /* of which everything is taken over that is not measured */
    int64_t values[MACHINE_VALUE_COUNT];
    const char *sources[MACHINE_VALUE_COUNT];
    char folder[4096];
    bool is_quiet;
};

static void set(struct calibration *c, int index, double value, const char *source) {
    const struct machine_parameter parameter = machine_parameter_at(index);
    const double most = (double)parameter.maximum, least = (double)parameter.minimum;
    value = value > most ? most : value < least ? least : value;
    c->values[index] = llround(value);
    c->sources[index] = source;
}

/* A machine on which only what is to be counted costs: COUNT_PS a piece. */
static bool counting_machine(const struct calibration *c, int counted, struct machine *machine,
                             struct status *status) {
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(&c->machine, values);
    for (int i = MACHINE_PARAMETER_COUNT; i < MACHINE_VALUE_COUNT; i++)
        values[i] = 0;
    values[MACHINE_INDEX_raster_triangle_ps] = COUNT_PS;
    values[MACHINE_INDEX_raster_region_ps] = 0;
    if (counted >= 0)
        values[counted] = COUNT_PS;
    return machine_from_values("counting", values, machine, status);
}

static bool write_shader(const struct calibration *c, const char *name, const char *statement,
                         const char *colour, struct status *status) {
    char path[4200];
    snprintf(path, sizeof path, "%s/%s.sl", c->folder, name);
    FILE *file = fopen(path, "w");
    if (file)
        fprintf(file,
                "surface %s(uniform float k = 1.01;) {\n    varying float x = 0.3 + 0.4 * s;\n"
                "    uniform float i;\n    for (i = 0; i < %d; i = i + 1) {\n        %s;\n    }\n"
                "    Oi = Os;\n    Ci = %s;\n}\n",
                name, LOOPS, statement, colour);
    return (file && !fclose(file)) || status_fail(status, STATUS_IO, "cannot write %s", path);
}

/* A picture of which all is covered: 4 x 4 regions by two triangles, or 10 x 16, as many as caches
 * have to hold of real ones, by a sphere, diced as spheres are. */
static char *make_scene(const struct calibration *c, const char *shader, bool is_curved) {
    static const char flat[] = "Polygon \"P\" [-2 -2 2 2 -2 2 2 2 2 -2 2 2] \"s\" [0 1 1 0] "
                               "\"t\" [0 0 1 1]\n",
                      curved[] = "Translate 0 0 4\nSphere 3.5 -3.5 3.5 360\n";
    char *text;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    fprintf(stream,
            "Format %" PRId64 " %" PRId64
            " 1\nProjection \"perspective\" \"fov\" [90]\nScreenWindow -1 1 -1 1\n"
            "WorldBegin\nSurface \"%s\"\n%sWorldEnd\n",
            (is_curved ? 10 : 4) * c->machine.region_width,
            (is_curved ? 16 : 4) * c->machine.region_height, shader, is_curved ? curved : flat);
    fclose(stream);
    return text;
}

static bool measure(const struct calibration *c, const char *shader, bool is_curved, int counted,
                    struct calibrate_run *run, struct status *status) {
    struct machine machine;
    if (!counting_machine(c, counted, &machine, status))
        return false;
    char *scene = make_scene(c, shader, is_curved);
    const bool ok = calibrate_render(c->folder, scene, &machine, run, status);
    free(scene);
    return ok || status_prefix(status, "measuring %s", shader);
}

/* The quicker of two runs of one scene, step by step. */
static void keep_quickest(struct calibrate_run *best, const struct calibrate_run *run, int round) {
    if (!round)
        *best = *run;
    best->rendering_region_s = fmin(best->rendering_region_s, run->rendering_region_s);
    best->shading_region_s = fmin(best->shading_region_s, run->shading_region_s);
    best->framebuffer_region_s = fmin(best->framebuffer_region_s, run->framebuffer_region_s);
}

static bool measure_operations(struct calibration *c, struct calibrate_run *plain,
                               struct status *status) {
    static const struct {
        int operation;
        const char *name, *statement;
    } measured[] = {
#define MEASURED_ENTRY(operation, statement) {SIMD_##operation, "loop_" #operation, statement},
        MEASURED(MEASURED_ENTRY)
#undef MEASURED_ENTRY
    };
    enum { COUNT = sizeof measured / sizeof *measured };
    struct calibrate_run run, quickest[COUNT];
    bool ok = write_shader(c, "plain", "", "color(x, x, x)", status);
    for (int i = 0; ok && i < COUNT; i++)
        ok = write_shader(c, measured[i].name, measured[i].statement, "color(x, x, x)", status);
    for (int round = 0; ok && round < ROUNDS; round++) {
        ok = measure(c, "plain", false, -1, &run, status);
        if (ok)
            keep_quickest(plain, &run, round);
        for (int i = 0; ok && i < COUNT; i++) {
            ok = measure(c, measured[i].name, false,
                         MACHINE_PARAMETER_COUNT + measured[i].operation, &run, status);
            if (ok)
                keep_quickest(&quickest[i], &run, round);
        }
    }
    if (!ok)
        return false;
    for (int i = 0; i < COUNT; i++) {
        const int index = MACHINE_PARAMETER_COUNT + measured[i].operation;
        const double s = quickest[i].shading_region_s - plain->shading_region_s;
        set(c, index,
            quickest[i].shading_count > 0 && s > 0 ? 1e12 * s / quickest[i].shading_count : 1,
            "measured: a loop of it in a shader, less the empty shader");
        if (!c->is_quiet)
            printf("  %-20s %10.3f us a region\n", machine_parameter_at(index).name,
                   1e-6 * (double)c->values[index]);
    }
#define LIKE_ENTRY(operation, other)                                                               \
    set(c, MACHINE_PARAMETER_COUNT + SIMD_##operation,                                             \
        (double)c->values[MACHINE_PARAMETER_COUNT + SIMD_##other], "ours: like " #other);
    LIKE(LIKE_ENTRY)
#undef LIKE_ENTRY
    /* what no loop measured: as much slower or faster than PixelFlow as an addition is */
    const double pace =
        (double)c->values[MACHINE_PARAMETER_COUNT + SIMD_FLOAT_ADD] /
        (double)machine_value(&c->machine, MACHINE_PARAMETER_COUNT + SIMD_FLOAT_ADD);
    for (int i = MACHINE_PARAMETER_COUNT; i < MACHINE_VALUE_COUNT; i++)
        if (!c->sources[i])
            set(c, i, pace * (double)machine_value(&c->machine, i),
                "ours: PixelFlow's, in the proportion of an addition");
    return true;
}

/* Three digits. Two such rates always have a tick in common: the ticks of a second are 10^12 by
 * less than 1000 by less than 1000, and 10^18 are allowed. */
static double round_rate(double bytes_per_s) {
    double unit = 1;
    while (bytes_per_s / unit >= 999.5)
        unit *= 10;
    return round(bytes_per_s / unit) * unit;
}

/* Rays, composition, sockets. */
static bool measure_rest(struct calibration *c, const struct calibrate_run *plain,
                         struct status *status) {
    enum { FLOATS = 12 };
    struct calibrate_run run, coarse, fine;
    double latency_s, bytes_per_s;
    const double samples = (double)machine_region_samples(&c->machine);
    if (!write_shader(c, "mapped", "", "color(xcomp(N) + s, ycomp(N) + t, zcomp(N) + x)", status))
        return false;
    for (int round = 0; round < ROUNDS; round++)
        for (int curved = 0; curved < 2; curved++) {
            if (!measure(c, "mapped", curved, -1, &run, status))
                return false;
            keep_quickest(curved ? &fine : &coarse, &run, round);
        }
    if (!calibrate_sockets(c->folder, &latency_s, &bytes_per_s, status))
        return false;
    const double triangle_s = (fine.rendering_region_s - coarse.rendering_region_s) /
                              (fine.raster_count - coarse.raster_count);
    const double words = (double)machine_map_words(&c->machine, FLOATS);
    const double composition_s = calibrate_composition_s(&c->machine, FLOATS);
    const double word_s = composition_s / (samples * words);
    set(c, MACHINE_INDEX_raster_triangle_ps, 1e12 * triangle_s,
        "measured: regions of a sphere, some eight samples a triangle, against regions of two "
        "triangles");
    set(c, MACHINE_INDEX_raster_region_ps,
        1e12 * (coarse.rendering_region_s - coarse.raster_count * triangle_s),
        "measured: rays and interpolation of a full region");
    set(c, MACHINE_INDEX_shading_region_ps, 1e12 * plain->shading_region_s,
        "measured: a full region under an empty shader");
    const double rate =
        round_rate((double)c->machine.composition_word_bytes / (word_s > 0 ? word_s : 1e-12));
    set(c, MACHINE_INDEX_composition_bytes_per_s, rate,
        "measured: composing two full regions and copying the result, one core");
    set(c, MACHINE_INDEX_composition_hop_latency_ps, 1e12 * latency_s,
        "measured: one way of a small message between threads, ipc");
    set(c, MACHINE_INDEX_geometry_bytes_per_s, round_rate(bytes_per_s),
        "measured: 64 KiB messages between threads, ipc");
    set(c, MACHINE_INDEX_colour_words, ceil(plain->framebuffer_region_s / (samples * word_s)),
        "measured: a region into the picture, in words of the composition network");
    set(c, MACHINE_INDEX_composition_region_buffers, 16, "ours: regions in sockets on both sides");
    if (!c->is_quiet)
        printf(
            "  rays %.1f us a region and %.3f us a triangle; composition %.2f GB/s; sockets %.1f "
            "us, %.2f GB/s;\n  framebuffer %.1f us a region; an empty shader %.1f us a region\n",
            1e6 * coarse.rendering_region_s, 1e6 * triangle_s, 1e-9 * rate, 1e6 * latency_s,
            1e-9 * bytes_per_s, 1e6 * plain->framebuffer_region_s, 1e6 * plain->shading_region_s);
    return true;
}

static bool write_description(const struct calibration *c, const char *path,
                              struct status *status) {
    cJSON *document = cJSON_CreateObject();
    struct machine machine;
    cJSON_AddStringToObject(document, "name", "this host");
    cJSON_AddStringToObject(document, "about",
                            "Measured by sortlast machine calibrate: one core a node.");
    cJSON *parameters = cJSON_AddObjectToObject(document, "parameters");
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++) {
        const struct machine_parameter parameter = machine_parameter_at(i);
        cJSON *entry = cJSON_AddObjectToObject(parameters, parameter.name);
        json_add_whole(entry, "value", c->values[i]);
        cJSON_AddStringToObject(entry, "unit", parameter.unit);
        cJSON_AddStringToObject(entry, "source",
                                c->sources[i] ? c->sources[i] : "ours: as PixelFlow");
    }
    const bool ok = machine_from_values("this host", c->values, &machine, status) &&
                    json_write_document(path, document, status);
    cJSON_Delete(document);
    return ok;
}

/* Wall seconds of a run of so many frames, and the simulated time of the last. */
static bool run_frames(const char *scene, const char *machine, int frames, double *wall_s,
                       double *simulated_s, struct status *status) {
    char count[16];
    snprintf(count, sizeof count, "%d", frames);
    char *arguments[] = {"sortlast", "render",    "--quiet",       "--json",      "-", "--frames",
                         count,      "--machine", (char *)machine, (char *)scene, NULL};
    int exit_status;
    char *text = program_output(arguments, &exit_status);
    cJSON *document = text ? cJSON_Parse(text) : NULL;
    const cJSON *list = cJSON_GetObjectItem(document, "frames");
    const cJSON *last = cJSON_GetArrayItem(list, cJSON_GetArraySize(list) - 1);
    const cJSON *wall = cJSON_GetObjectItem(document, "wall_s");
    const bool ok = cJSON_IsObject(last) && cJSON_IsNumber(wall);
    if (ok) {
        *wall_s = wall->valuedouble;
        *simulated_s = 1e-12 * cJSON_GetObjectItem(last, "time_ps")->valuedouble;
    }
    cJSON_Delete(document);
    free(text);
    return ok || status_fail(status, STATUS_IO, "%s could not be rendered for comparison", scene);
}

/* The description at work: a frame as it is predicted, and as it is. */
static bool compare(const char *scene, const char *machine, struct status *status) {
    enum { RUNS = 3, FRAMES = 8 };
    double wall_s = 0, one_s, many_s, simulated_s = 0;
    for (int i = 0; i < RUNS; i++) { /* the quickest: others on this host only add to it */
        if (!run_frames(scene, machine, 1, &one_s, &simulated_s, status) ||
            !run_frames(scene, machine, 1 + FRAMES, &many_s, &simulated_s, status))
            return false;
        const double frame_s = (many_s - one_s) / FRAMES;
        wall_s = !i || frame_s < wall_s ? frame_s : wall_s;
    }
    printf("%s on 1 + 1 nodes: predicted %.1f ms a frame, measured %.1f ms (%+.0f %%)\n", scene,
           1e3 * simulated_s, 1e3 * wall_s, wall_s > 0 ? 100 * (simulated_s / wall_s - 1) : 0);
    return true;
}

static void remove_folder(const char *folder) {
    DIR *directory = opendir(folder);
    for (struct dirent *entry; directory && (entry = readdir(directory));)
        if (strcmp(entry->d_name, ".") && strcmp(entry->d_name, ".."))
            unlinkat(dirfd(directory), entry->d_name, 0);
    if (directory)
        closedir(directory);
    rmdir(folder);
}

static bool calibrate(struct calibration *c, const char *output, const char *scene,
                      struct status *status) {
    struct calibrate_run plain;
    char path[4096];
    if (!machine_find_file("pixelflow", path, sizeof path, status) ||
        !machine_read_file(path, &c->machine, status))
        return false;
    machine_to_values(&c->machine, c->values);
    const char *base = getenv("TMPDIR");
    snprintf(c->folder, sizeof c->folder, "%.60s/sortlast-XXXXXX", base && *base ? base : "/tmp");
    if (!mkdtemp(c->folder))
        return status_fail(status, STATUS_IO, "cannot make a folder %s: %s", c->folder,
                           strerror(errno));
    const bool ok = measure_operations(c, &plain, status) && measure_rest(c, &plain, status);
    remove_folder(c->folder);
    return ok && write_description(c, output, status) && (!scene || compare(scene, output, status));
}

int calibrate_main(int argc, char **argv) {
    const char *output = "host.json", *scene = NULL;
    struct status status = {0};
    struct calibration *c = memory_get(1, sizeof *c);
    bool ok = true;
    for (int i = 1; ok && i < argc; i++) {
        if (!strcmp(argv[i], "-o") && i + 1 < argc)
            output = argv[++i];
        else if (!strcmp(argv[i], "-q"))
            c->is_quiet = true;
        else if (argv[i][0] != '-' && !scene)
            scene = argv[i];
        else
            ok = status_fail(&status, STATUS_INVALID,
                             "machine calibrate takes [-q] [-o FILE.json] [SCENE.rib], not \"%s\"",
                             argv[i]);
    }
    ok = ok && calibrate(c, output, scene, &status);
    if (ok && !c->is_quiet)
        printf("written to %s\n", output);
    if (!ok)
        fprintf(stderr, "sortlast: %s\n", status.message);
    free(c);
    return ok ? 0 : status_exit_code(status.code);
}
