/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/render_options.h"

#include "images/image.h"
#include "images/replacement_file.h"
#include "nodes/pacer.h"
#include "shaders/compiler/parameter_precision.h"

#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum { NODES_MAX = 4096, FRAMES_MAX = 1000000, SIZE_MAX_PIXELS = 65536, SAMPLES_MAX = 64 };

enum {
    OPTION_DRIVER = 256,
    OPTION_TRANSPORT,
    OPTION_FRAMES,
    OPTION_MACHINE,
    OPTION_SEED,
    OPTION_FORMAT,
    OPTION_SAMPLES,
    OPTION_PNG,
    OPTION_JSON,
    OPTION_RECORD,
    OPTION_EXPLAIN_TIME,
    OPTION_COMPRESSION,
    OPTION_MATH,
    OPTION_SHADERS,
    OPTION_DEADLINE,
    OPTION_SCHEDULE_SEED,
    OPTION_PACE,
    OPTION_PACE_SHAPED,
    OPTION_COMPOSITION,
    OPTION_BIND,
    OPTION_BOARD,
    OPTION_SUPERVISOR,
    OPTION_CHORD,
    OPTION_FAST_SHADERS,
    OPTION_FAST_CALLS,
    OPTION_USE,
    OPTION_SKIP,
    OPTION_PARAMETERS,
    OPTION_EXPLAIN_WORK,
    OPTION_LINK,
    OPTION_ASSIGNMENT,
    OPTION_COSTS_FROM,
    OPTION_CHUNK_TRIANGLES,
};

static const struct option long_options[] = {
    {"rendering-nodes", required_argument, NULL, 'r'},
    {"shading-nodes", required_argument, NULL, 's'},
    {"output", required_argument, NULL, 'o'},
    {"verbose", no_argument, NULL, 'v'},
    {"quiet", no_argument, NULL, 'q'},
    {"help", no_argument, NULL, 'h'},
    {"driver", required_argument, NULL, OPTION_DRIVER},
    {"transport", required_argument, NULL, OPTION_TRANSPORT},
    {"frames", required_argument, NULL, OPTION_FRAMES},
    {"machine", required_argument, NULL, OPTION_MACHINE},
    {"seed", required_argument, NULL, OPTION_SEED},
    {"format", required_argument, NULL, OPTION_FORMAT},
    {"samples", required_argument, NULL, OPTION_SAMPLES},
    {"png", no_argument, NULL, OPTION_PNG},
    {"json", required_argument, NULL, OPTION_JSON},
    {"record", required_argument, NULL, OPTION_RECORD},
    {"explain-time", no_argument, NULL, OPTION_EXPLAIN_TIME},
    {"compression", required_argument, NULL, OPTION_COMPRESSION},
    {"math", required_argument, NULL, OPTION_MATH},
    {"explain-work", no_argument, NULL, OPTION_EXPLAIN_WORK},
    {"fast-shaders", required_argument, NULL, OPTION_FAST_SHADERS},
    {"fast-calls", required_argument, NULL, OPTION_FAST_CALLS},
    {"use", required_argument, NULL, OPTION_USE},
    {"skip", required_argument, NULL, OPTION_SKIP},
    {"parameters", required_argument, NULL, OPTION_PARAMETERS},
    {"chord", required_argument, NULL, OPTION_CHORD},
    {"shaders", required_argument, NULL, OPTION_SHADERS},
    {"link", required_argument, NULL, OPTION_LINK},
    {"deadline", required_argument, NULL, OPTION_DEADLINE},
    {"schedule-seed", required_argument, NULL, OPTION_SCHEDULE_SEED},
    {"composition", required_argument, NULL, OPTION_COMPOSITION},
    {"assignment", required_argument, NULL, OPTION_ASSIGNMENT},
    {"costs-from", required_argument, NULL, OPTION_COSTS_FROM},
    {"chunk-triangles", required_argument, NULL, OPTION_CHUNK_TRIANGLES},
    {"pace", required_argument, NULL, OPTION_PACE},
    {"pace-shaped", no_argument, NULL, OPTION_PACE_SHAPED},
    {"bind", required_argument, NULL, OPTION_BIND},
    {"status-board", required_argument, NULL, OPTION_BOARD},
    {"supervisor", required_argument, NULL, OPTION_SUPERVISOR},
    {0},
};

int render_option_values(const char *name) {
    for (const struct option *option = long_options; option->name; option++)
        if (!strcmp(option->name, name))
            return option->has_arg == required_argument;
    return -1;
}

static bool parse_whole(const char *text, const char *what, long long minimum, long long maximum,
                        long long *value, struct status *status) {
    char *end;
    errno = 0;
    *value = strtoll(text, &end, 10);
    if (end == text || *end || errno || *value < minimum || *value > maximum)
        return status_fail(status, STATUS_INVALID,
                           "%s must be a whole number from %lld to %lld, not \"%s\"", what, minimum,
                           maximum, text);
    return true;
}

static bool parse_pair(const char *text, const char *what, const char *example, int maximum, int *a,
                       int *b, struct status *status) {
    char rest;
    if (sscanf(text, "%dx%d%c", a, b, &rest) != 2 || *a < 1 || *b < 1 || *a > maximum ||
        *b > maximum)
        return status_fail(status, STATUS_INVALID,
                           "%s must be like %s, each from 1 to %d, not \"%s\"", what, example,
                           maximum, text);
    return true;
}

static bool parse_samples(const char *text, struct host_options *host, struct status *status) {
    long long count;
    if (strchr(text, 'x'))
        return parse_pair(text, "--samples", "4x2", SAMPLES_MAX, &host->reading.samples_x,
                          &host->reading.samples_y, status);
    if (!parse_whole(text, "--samples", 1, SAMPLES_MAX * SAMPLES_MAX, &count, status))
        return false;
    int side = 1;
    while (side * side < count)
        side++;
    if (side * side != count)
        return status_fail(
            status, STATUS_INVALID,
            "--samples %lld is not a square number; say how many across and down, like 4x2", count);
    host->reading.samples_x = host->reading.samples_y = side;
    return true;
}

static bool check_output_name(const char *name, struct status *status) {
    const size_t length = strlen(name);
    if (!length || (length > 4 && !strcasecmp(name + length - 4, ".exr")))
        return true;
    return status_fail(status, STATUS_INVALID,
                       "the picture is an OpenEXR file: its name must end in .exr, not \"%s\" "
                       "(--png writes a PNG beside it)",
                       name);
}

static bool parse_choice(const char *text, const char *what, const char *const *choices, int *value,
                         struct status *status) {
    char all[256] = "";
    for (int i = 0; choices[i]; i++) {
        if (!strcmp(text, choices[i])) {
            *value = i;
            return true;
        }
        const size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", choices[i]);
    }
    return status_fail(status, STATUS_INVALID, "%s must be one of %s, not \"%s\"", what, all, text);
}

static bool add_shader_file(struct render_options *options, const char *text,
                            struct status *status) {
    struct shader_precision *precision = &options->host.precision;
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1])
        return status_fail(status, STATUS_INVALID, "--use is NAME=FILE.sl, not %s", text);
    if (precision->file_count == sizeof options->shader_files / sizeof *options->shader_files)
        return status_fail(status, STATUS_INVALID, "--use is given too often");
    options->shader_files[precision->file_count++] = text;
    precision->files = options->shader_files;
    return true;
}

static void add_folder(struct render_options *options, const char *folder, size_t length) {
    const int count = options->host.shader_folder_count;
    if (count == sizeof options->folders / sizeof *options->folders)
        return;
    options->folders[count] = memory_get(length + 1, 1);
    memcpy(options->folders[count], folder, length);
    options->host.shader_folder_count++;
}

static bool parse_chord(const char *text, double *chord, struct status *status) {
    char *end;
    *chord = strtod(text, &end);
    if (end == text || *end || !(*chord >= 0.001 && *chord <= 1000))
        return status_fail(status, STATUS_INVALID,
                           "--chord must be from 0.001 to 1000 pixels, not \"%s\"", text);
    return true;
}

static bool parse_composition(const char *text, const struct strategy **strategy,
                              struct status *status) {
    char all[256] = "";
    *strategy = strategy_find(text);
    for (int i = 0; !*strategy && strategy_at(i); i++) {
        const size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", i ? ", " : "", strategy_at(i)->name);
    }
    return *strategy || status_fail(status, STATUS_INVALID,
                                    "--composition must be one of %s, not \"%s\"", all, text);
}

static bool parse_pace(const char *text, double *pace, struct status *status) {
    char *end;
    *pace = strtod(text, &end);
    if (end == text || *end || !(*pace >= PACER_SCALE_MIN && *pace <= PACER_SCALE_MAX))
        return status_fail(status, STATUS_INVALID, "--pace must be from %g to %g, not \"%s\"",
                           PACER_SCALE_MIN, PACER_SCALE_MAX, text);
    return true;
}

static bool parse_one(int option, const char *text, struct render_options *o,
                      struct status *status) {
    static const char *const drivers[] = {"processes", "in-process", NULL};
    static const char *const transports[] = {"ipc", "tcp", NULL};
    static const char *const compressions[] = {"none", "rle", "zips", "zip", "piz", NULL};
    static const char *const maths[] = {"exact", "fast", "reference", NULL};
    static const char *const assignments[] = {"round-robin", "by-cost", NULL};
    long long whole = 0;
    int choice = 0;
    bool ok = true;
    switch (option) {
    case 'r':
        ok = parse_whole(text, "-r (rendering nodes)", 1, NODES_MAX, &whole, status);
        o->host.rendering_nodes = (uint32_t)whole;
        return ok;
    case 's':
        ok = parse_whole(text, "-s (shading nodes)", 1, NODES_MAX, &whole, status);
        o->host.shading_nodes = (uint32_t)whole;
        return ok;
    case 'o':
        o->host.output = text;
        return check_output_name(text, status);
    case 'v':
        o->verbosity = 1;
        return true;
    case 'q':
        o->verbosity = -1;
        return true;
    case OPTION_DRIVER:
        ok = parse_choice(text, "--driver", drivers, &choice, status);
        o->driver = (enum render_driver)choice;
        return ok;
    case OPTION_TRANSPORT:
        ok = parse_choice(text, "--transport", transports, &choice, status);
        o->transport = (enum render_transport)choice;
        return ok;
    case OPTION_FRAMES:
        ok = parse_whole(text, "--frames", 1, FRAMES_MAX, &whole, status);
        o->host.frames = (int)whole;
        return ok;
    case OPTION_MACHINE:
        snprintf(o->machine_file, sizeof o->machine_file, "%s", text);
        return true;
    case OPTION_SEED:
        ok = parse_whole(text, "--seed", 0, LLONG_MAX, &whole, status);
        o->host.seed = (uint64_t)whole;
        return ok;
    case OPTION_FORMAT:
        return parse_pair(text, "--format", "1280x1024", SIZE_MAX_PIXELS, &o->host.reading.width,
                          &o->host.reading.height, status);
    case OPTION_SAMPLES:
        return parse_samples(text, &o->host, status);
    case OPTION_PNG:
        o->host.write_png = true;
        return true;
    case OPTION_JSON:
        o->json = text;
        return true;
    case OPTION_EXPLAIN_TIME:
        o->explain_time = true;
        o->host.is_recorded = true;
        return true;
    case OPTION_RECORD:
        o->record = text;
        o->host.is_recorded = true;
        return true;
    case OPTION_COMPRESSION:
        ok = parse_choice(text, "--compression", compressions, &choice, status);
        o->host.compression = (uint32_t)choice;
        return ok;
    case OPTION_MATH:
        ok = parse_choice(text, "--math", maths, &choice, status);
        o->host.precision.fast_math = choice == 1;
        o->host.precision.reference_math = choice == 2;
        return ok;
    case OPTION_EXPLAIN_WORK:
        o->host.explain_work = true;
        return true;
    case OPTION_FAST_SHADERS:
        o->host.precision.fast_shaders = text;
        return true;
    case OPTION_FAST_CALLS:
        fast_calls_finish(&o->host.precision.fast_calls);
        return fast_calls_parse("--fast-calls", text, NULL, &o->host.precision.fast_calls, status);
    case OPTION_USE:
        return add_shader_file(o, text, status);
    case OPTION_SKIP:
        ok = parse_whole(text, "--skip", 0, FRAMES_MAX, &whole, status);
        o->host.skipped_frames = (int)whole;
        return ok;
    case OPTION_PARAMETERS:
        ok = parse_choice(text, "--parameters", parameter_precision_names, &choice, status);
        o->host.precision.parameters = (enum parameter_precision)choice;
        return ok;
    case OPTION_CHORD:
        return parse_chord(text, &o->host.reading.chord_pixels, status);
    case OPTION_SHADERS:
        add_folder(o, text, strlen(text));
        return true;
    case OPTION_LINK:
        o->link = text;
        o->host.allows_external = true;
        return true;
    case OPTION_DEADLINE:
        ok = parse_whole(text, "--deadline", 1, 86400, &whole, status);
        o->deadline_s = (int)whole;
        return ok;
    case OPTION_SCHEDULE_SEED:
        ok = parse_whole(text, "--schedule-seed", 0, LLONG_MAX, &whole, status);
        o->schedule_seed = (uint64_t)whole;
        return ok;
    case OPTION_PACE_SHAPED:
        o->is_shaped = true;
        return true;
    case OPTION_COMPOSITION:
        return parse_composition(text, &o->host.strategy, status);
    case OPTION_ASSIGNMENT:
        ok = parse_choice(text, "--assignment", assignments, &choice, status);
        o->by_cost = choice == 1;
        return ok;
    case OPTION_COSTS_FROM:
        o->costs_from = text;
        return true;
    case OPTION_CHUNK_TRIANGLES:
        ok = parse_whole(text, "--chunk-triangles", 1, CHUNK_TRIANGLES_MAX, &whole, status);
        o->host.chunk_triangles = (uint32_t)whole;
        return ok;
    case OPTION_PACE:
        return parse_pace(text, &o->pace, status);
    case OPTION_BIND:
        o->bind = text;
        return true;
    case OPTION_BOARD:
        ok = parse_whole(text, "--status-board", 0, INT_MAX, &whole, status);
        o->board = (int)whole;
        return ok;
    case OPTION_SUPERVISOR:
        ok = parse_whole(text, "--supervisor", 1, INT_MAX, &whole, status);
        o->supervisor = (pid_t)whole;
        return ok;
    default:
        return status_fail(status, STATUS_INVALID, "unknown option");
    }
}

bool program_folder(char *path, size_t size) {
    const ssize_t length = readlink("/proc/self/exe", path, size - 1);
    if (length <= 0)
        return false;
    path[length] = 0;
    char *slash = strrchr(path, '/');
    if (slash)
        *slash = 0;
    return slash != NULL;
}

static void add_default_folders(struct render_options *options) {
    char folder[4096], program[3072];
    const char *more = getenv("SORTLAST_SHADERS");
    for (const char *at = more; at && *at;) {
        const size_t length = strcspn(at, ":");
        add_folder(options, at, length);
        at += length + (at[length] == ':');
    }
    if (program_folder(program, sizeof program)) {
        snprintf(folder, sizeof folder, "%s/../shaders/library", program);
        add_folder(options, folder, strlen(folder));
        snprintf(folder, sizeof folder, "%s/../share/sortlast/shaders", program);
        add_folder(options, folder, strlen(folder));
    }
    /* a build folder outside the source tree */
    add_folder(options, SORTLAST_SOURCE "/shaders/library",
               strlen(SORTLAST_SOURCE "/shaders/library"));
}

static void add_scene_folders(struct render_options *options) {
    const char *scene = options->host.scene, *slash = strrchr(scene, '/');
    char folder[4096];
    const int length = slash ? (int)(slash - scene) : 1;
    snprintf(folder, sizeof folder, "%.*s", length, slash ? scene : ".");
    add_folder(options, folder, strlen(folder));
    snprintf(folder, sizeof folder, "%.*s/shaders", length, slash ? scene : ".");
    add_folder(options, folder, strlen(folder));
}

bool machine_find_file(const char *name, char *path, size_t size, struct status *status) {
    char program[3072];
    if (strchr(name, '/') || strchr(name, '.'))
        return snprintf(path, size, "%s", name) < (int)size ||
               status_fail(status, STATUS_INVALID,
                           "the name of the machine description is too long");
    if (!program_folder(program, sizeof program))
        program[0] = 0;
    for (int place = 0; place < 3; place++) {
        const int length =
            place == 0 ? snprintf(path, size, "%s/../machines/%s.json", program, name)
            : place == 1
                ? snprintf(path, size, "%s/../share/sortlast/machines/%s.json", program, name)
                : snprintf(path, size, "%s/machines/%s.json", SORTLAST_SOURCE, name);
        if (length > 0 && (size_t)length < size && !access(path, R_OK))
            return true;
    }
    return status_fail(status, STATUS_NOT_FOUND,
                       "there is no machine description \"%s\" (sortlast machine list names them)",
                       name);
}

static bool read_machine(struct render_options *options, struct status *status) {
    char path[4096];
    return machine_find_file(options->machine_file[0] ? options->machine_file : "pixelflow", path,
                             sizeof path, status) &&
           machine_read_file(path, &options->host.machine, status);
}

static bool read_costs(struct render_options *options, struct status *status) {
    if (options->by_cost != (options->costs_from != NULL))
        return status_fail(status, STATUS_INVALID,
                           options->by_cost
                               ? "--assignment by-cost needs --costs-from FILE: a record of the "
                                 "same picture (render --record)"
                               : "--costs-from is for --assignment by-cost");
    if (options->costs_from && !record_read_file(options->costs_from, &options->costs, status))
        return false;
    options->host.costs = options->costs;
    return true;
}

static int usage_error(const struct status *status) {
    fprintf(stderr, "sortlast: %s\n(see --help)\n", status->message);
    return 2;
}

/* What cannot be written should be known before anything is rendered. The picture of a cluster
 * started by hand is written by its framebuffer node, perhaps on another machine. */
static bool can_write_results(const struct render_options *options, bool is_host_program,
                              struct status *status) {
    const char *output = options->host.output && !is_host_program ? options->host.output : "",
               *json = options->json && strcmp(options->json, "-") ? options->json : "";
    const char *const paths[] = {output, json};
    const uint64_t pixels =
        (uint64_t)options->host.reading.width * (uint64_t)options->host.reading.height;
    if (output[0] && pixels > IMAGE_PIXELS_MAX)
        return status_fail(status, STATUS_INVALID,
                           "a picture of %d x %d pixels is over the limit of %llu pixels",
                           options->host.reading.width, options->host.reading.height,
                           (unsigned long long)IMAGE_PIXELS_MAX);
    for (int i = 0; i < 2; i++) {
        struct replacement_file file;
        if (!paths[i][0])
            continue;
        if (!replacement_file_open(&file, paths[i], status))
            return false;
        replacement_file_abandon(&file);
    }
    return true;
}

int render_options_parse(int argc, char **argv, bool is_host_program,
                         struct render_options *options) {
    struct status status = {0};
    *options = (struct render_options){.deadline_s = 60, .board = -1};
    options->host.rendering_nodes = options->host.shading_nodes = 1;
    options->host.seed = 1;
    options->host.strategy = strategy_at(0);
    options->host.compression = IMAGE_COMPRESSION_ZIP;
    options->host.shader_folders = (const char *const *)options->folders;
    int option;
    opterr = 0;
    optind = 1;
    /* the scene's own folders come first: find the scene before the options are worked through */
    char **order = memory_get((size_t)argc + 1, sizeof *order);
    memcpy(order, argv, (size_t)argc * sizeof *order);
    while ((option = getopt_long(argc, order, "r:s:o:vqh", long_options, NULL)) != -1) {
        if (option == 'h') {
            render_help_print(is_host_program);
            free(order);
            return 1;
        }
        if (option == '?' ||
            (!is_host_program && option >= OPTION_BIND && option <= OPTION_SUPERVISOR)) {
            status_fail(&status, STATUS_INVALID, "unknown option or missing value: %s",
                        order[optind - 1]);
            free(order);
            return usage_error(&status);
        }
    }
    if (optind + 1 != argc) {
        status_fail(&status, STATUS_INVALID,
                    optind < argc ? "more than one scene is given" : "no scene is given");
        free(order);
        return usage_error(&status);
    }
    options->host.scene = order[optind];
    free(order);
    add_scene_folders(options);
    optind = 1;
    while ((option = getopt_long(argc, argv, "r:s:o:vqh", long_options, NULL)) != -1)
        if (!parse_one(option, optarg, options, &status))
            return usage_error(&status);
    add_default_folders(options);
    if (is_host_program && !options->bind) {
        status_fail(&status, STATUS_INVALID, "--bind is missing: where should the nodes call?");
        return usage_error(&status);
    }
    if (options->pace > 0 && options->host.strategy->plan) {
        status_fail(&status, STATUS_INVALID, "--pace follows the chain only, not --composition %s",
                    options->host.strategy->name);
        return usage_error(&status);
    }
    if (options->is_shaped && (options->pace <= 0 || options->host.rendering_nodes != 1)) {
        status_fail(&status, STATUS_INVALID, "--pace-shaped needs --pace and -r 1");
        return usage_error(&status);
    }
    if (options->pace > 0 && options->driver == DRIVER_IN_PROCESS) {
        status_fail(&status, STATUS_INVALID,
                    "--pace throttles sockets, of which --driver in-process has none");
        return usage_error(&status);
    }
    if (!read_machine(options, &status) || !read_costs(options, &status))
        return usage_error(&status);
    if (can_write_results(options, is_host_program, &status))
        return 0;
    fprintf(stderr, "sortlast: %s\n", status.message);
    return 1 + status_exit_code(status.code);
}

void render_options_finish(struct render_options *options) {
    for (int i = 0; i < options->host.shader_folder_count; i++)
        free(options->folders[i]);
    options->host.shader_folder_count = 0;
    fast_calls_finish(&options->host.precision.fast_calls);
    record_destroy(options->costs);
    options->costs = NULL;
}
