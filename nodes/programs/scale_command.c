/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/scale.h"

#include "base/hash.h"
#include "nodes/programs/analysis_options.h"
#include "nodes/programs/analysis_values.h"
#include "nodes/programs/program_process.h"
#include "nodes/programs/render_options.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { NODES_MAX = 16384, LIVE_MAX = 128, LIVE_DEFAULT = 16, SIZE_MAX_PIXELS = 65536 };

struct scale_options {
    const char *scene, *json, *csv, *plot, *state;
    const struct strategy *strategy;
    int64_t *rendering, *shading; /* numbers of nodes, ascending */
    size_t rendering_count, shading_count;
    int64_t live_max; /* processes of the largest cluster that is run */
    bool is_weak, is_quiet;
    char **forwarded; /* options of render */
    int forwarded_count;
};

static void print_help(void) {
    puts(
        "usage: sortlast scale [options] SCENE.rib|RECORD\n"
        "\n"
        "Strong or weak scaling: predicts the frame times of clusters of all these sizes from one\n"
        "recorded run, runs the smaller ones live, and shows both side by side.\n"
        "\n"
        "  -r, --rendering-nodes LIST  like 1,2,4 or 1..16 or 1..64*2 (default 4)\n"
        "  -s, --shading-nodes LIST    (default 1..32*2)\n"
        "      --weak                  the picture grows with the shading nodes: s times the "
        "pixels\n"
        "      --composition NAME      how regions come together (default chain)\n"
        "      --live N                run clusters of up to N processes live (default 16, at most "
        "128,\n"
        "                              0: none); a record is never run\n"
        "      --state FILE            keep finished live runs here, and go on from it\n"
        "      --json FILE, --csv FILE write the results; - for standard output\n"
        "      --plot PREFIX           PREFIX.svg by gnuplot, and its PREFIX.dat and PREFIX.gp\n"
        "  -q, --quiet                 no table, no progress\n"
        "  -h, --help                  this text\n"
        "\n"
        "Options of `sortlast render` that describe the run (--machine, --format, --samples, "
        "--frames,\n"
        "--math, --seed, --shaders) go to every run. Speed-up is against the first cluster, "
        "efficiency\n"
        "against the fewest shading nodes with the same rendering nodes. docs/scaling.md "
        "explains.\n"
        "\n"
        "Exit status: 0 done; 1 the input or an option is wrong; 2 something around it failed, or\n"
        "a live run took another simulated time than predicted; 3 a node was lost.");
}

static int compare_numbers(const void *a, const void *b) {
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static bool parse_nodes(const char *what, const char *text, int64_t **values, size_t *count,
                        struct status *status) {
    free(*values);
    *values = NULL;
    if (!values_parse(what, text, 1, NODES_MAX, values, count, status))
        return false;
    qsort(*values, *count, sizeof **values, compare_numbers);
    size_t kept = 0;
    for (size_t i = 0; i < *count; i++)
        if (!kept || (*values)[kept - 1] != (*values)[i])
            (*values)[kept++] = (*values)[i];
    *count = kept;
    return true;
}

/* An option of scale itself with a value; *is_known tells whether it is one. */
static bool parse_own(const char *name, const char *value, struct scale_options *options,
                      bool *is_known, struct status *status) {
    static const struct {
        const char *name;
        size_t offset;
    } texts[] = {{"--json", offsetof(struct scale_options, json)},
                 {"--csv", offsetof(struct scale_options, csv)},
                 {"--plot", offsetof(struct scale_options, plot)},
                 {"--state", offsetof(struct scale_options, state)}};
    *is_known = true;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (!strcmp(name, texts[i].name)) {
            *(const char **)((char *)options + texts[i].offset) = value;
            return true;
        }
    if (!strcmp(name, "-r") || !strcmp(name, "--rendering-nodes"))
        return parse_nodes("-r (rendering nodes)", value, &options->rendering,
                           &options->rendering_count, status);
    if (!strcmp(name, "-s") || !strcmp(name, "--shading-nodes"))
        return parse_nodes("-s (shading nodes)", value, &options->shading, &options->shading_count,
                           status);
    if (!strcmp(name, "--composition")) {
        options->strategy = strategy_find(value);
        return options->strategy ||
               status_fail(status, STATUS_INVALID, "there is no composition \"%s\"", value);
    }
    if (!strcmp(name, "--live")) {
        char *end;
        options->live_max = strtol(value, &end, 10);
        return (end != value && !*end && options->live_max >= 0 && options->live_max <= LIVE_MAX) ||
               status_fail(status, STATUS_INVALID, "--live must be from 0 to %d, not \"%s\"",
                           LIVE_MAX, value);
    }
    if (!strcmp(name, "--assignment") || !strcmp(name, "--costs-from"))
        return status_fail(status, STATUS_INVALID,
                           "scale assigns regions in turn; sortlast predict answers for %s", name);
    *is_known = false;
    return true;
}

static bool parse(int argc, char **argv, struct scale_options *options, struct status *status) {
    for (int at = 1; at < argc; at++) {
        const char *argument = argv[at];
        bool is_known;
        if (argument[0] != '-' || !argument[1]) {
            if (options->scene)
                return status_fail(status, STATUS_INVALID, "more than one scene is given");
            options->scene = argument;
        } else if (!strcmp(argument, "--weak")) {
            options->is_weak = true;
        } else if (!strcmp(argument, "-q") || !strcmp(argument, "--quiet")) {
            options->is_quiet = true;
        } else {
            char name[64];
            const char *equals = argument[1] == '-' ? strchr(argument, '=') : NULL;
            const bool is_short = argument[1] != '-' && argument[2];
            snprintf(name, sizeof name, "%.*s",
                     equals     ? (int)(equals - argument)
                     : is_short ? 2
                                : (int)strlen(argument),
                     argument);
            const char *value = equals          ? equals + 1
                                : is_short      ? argument + 2
                                : at + 1 < argc ? argv[at + 1]
                                                : NULL;
            const int taken = !equals && !is_short;
            if (value && !parse_own(name, value, options, &is_known, status))
                return false;
            const int values = render_option_values(name + 2 * (argument[1] == '-'));
            if (!value || (!is_known && (values < 0 || argument[1] != '-')))
                return status_fail(status, STATUS_INVALID, "unknown option or missing value: %s",
                                   argument);
            if (!is_known) {
                options->forwarded[options->forwarded_count++] = argv[at];
                if (values && taken)
                    options->forwarded[options->forwarded_count++] = argv[at + 1];
            }
            at += taken && (is_known || values);
        }
    }
    return options->scene || status_fail(status, STATUS_INVALID, "no scene or record is given");
}

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- prediction ---- */

/* Records the scene, at `format` when that is not empty. Returns an exit status. */
static int obtain_record(const struct scale_options *options, const char *format,
                         struct run_record **record) {
    struct analysis_options analysis = {.input = options->scene};
    char **list = memory_get((size_t)options->forwarded_count + 3, sizeof *list);
    memcpy(list, options->forwarded, (size_t)options->forwarded_count * sizeof *list);
    analysis.forwarded = list;
    analysis.forwarded_count = options->forwarded_count;
    if (format[0]) {
        list[analysis.forwarded_count++] = (char *)"--format";
        list[analysis.forwarded_count++] = (char *)format;
    }
    const int result = analysis_record_obtain(&analysis, record);
    free(list);
    return result;
}

static bool predict(const struct scale_options *options, const struct run_record *record,
                    struct what_if_solver *solver, struct scale_point *point,
                    struct status *status) {
    struct what_if question = what_if_default(record);
    struct what_if_result result;
    question.strategy = options->strategy;
    question.rendering_nodes = point->rendering_nodes;
    question.shading_nodes = point->shading_nodes;
    if (!what_if_solve(solver, &question, NULL, &result, status))
        return false;
    ticks busy[TIMING_RESOURCE_COUNT] = {0};
    for (uint32_t f = 0; f < result.frame_count; f++) {
        const struct what_if_frame *frame = &result.frames[f];
        busy[TIMING_COMPOSITION] += frame->times.composition_busy;
        busy[TIMING_GEOMETRY] += frame->times.geometry_busy;
        busy[TIMING_RASTER] += frame->raster_longest;
        busy[TIMING_SHADING] += frame->shading_longest;
        busy[TIMING_FRAMEBUFFER] += frame->times.framebuffer_busy;
        point->regions += record->frames[f].region_count;
    }
    point->time = result.end;
    point->ticks_per_s = question.machine.rate.per_s;
    point->bound_by = result.bound_by;
    for (int resource = 0; resource < TIMING_RESOURCE_COUNT; resource++)
        point->busy[resource] = result.end ? (double)busy[resource] / (double)result.end : 0;
    return true;
}

/* The picture of weak scaling: s times the pixels, sides in proportion. */
static bool grown_format(const struct run_record *first, int64_t shading_nodes, char format[32],
                         struct status *status) {
    const double side = sqrt((double)shading_nodes);
    const long width = lround(first->frames[0].width * side),
               height = lround(first->frames[0].height * side);
    snprintf(format, 32, "%ldx%ld", width, height);
    return (width <= SIZE_MAX_PIXELS && height <= SIZE_MAX_PIXELS) ||
           status_fail(status, STATUS_LIMIT, "a picture of %s pixels is too large: start smaller",
                       format);
}

/* All points with this number of shading nodes. */
static int predict_column(const struct scale_options *options, const struct run_record *first,
                          size_t column, struct scale_study *study, struct status *status) {
    struct run_record *grown = NULL;
    char format[32] = "";
    if (options->is_weak) {
        if (!grown_format(first, options->shading[column], format, status))
            return status_exit_code(status->code);
        const int result = obtain_record(options, format, &grown);
        if (result)
            return result;
    }
    const struct run_record *record = grown ? grown : first;
    struct what_if_solver *solver = what_if_solver_create(record);
    bool ok = true;
    for (size_t r = 0; ok && r < options->rendering_count; r++)
        ok = predict(options, record, solver, &study->points[r * study->shading_count + column],
                     status);
    what_if_solver_destroy(solver);
    record_destroy(grown);
    return ok ? 0 : status_exit_code(status->code);
}

/* ---- live runs ---- */

/* Runs one cluster; returns an exit status. */
static int run_live(const struct scale_options *options, const struct run_record *first,
                    struct scale_point *point, struct status *status) {
    char r[16], s[16], format[32];
    char **list = memory_get((size_t)options->forwarded_count + 16, sizeof *list);
    int count = 0, exit_status = 2;
    snprintf(r, sizeof r, "%u", point->rendering_nodes);
    snprintf(s, sizeof s, "%u", point->shading_nodes);
    const char *own[] = {"sortlast",
                         "render",
                         "--quiet",
                         "--json",
                         "-",
                         "-r",
                         r,
                         "-s",
                         s,
                         "--composition",
                         options->strategy->name};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        list[count++] = (char *)own[i];
    for (int i = 0; i < options->forwarded_count; i++)
        list[count++] = options->forwarded[i];
    if (options->is_weak && grown_format(first, point->shading_nodes, format, status)) {
        list[count++] = (char *)"--format";
        list[count++] = format;
    }
    list[count++] = (char *)options->scene;
    char *text = program_output(list, &exit_status);
    cJSON *document = text && !exit_status ? cJSON_Parse(text) : NULL;
    const cJSON *frames = cJSON_GetObjectItem(document, "frames");
    const cJSON *last = cJSON_GetArrayItem(frames, cJSON_GetArraySize(frames) - 1);
    const cJSON *end = cJSON_GetObjectItem(last, "end_ticks");
    if (cJSON_IsNumber(end)) {
        point->has_live = true;
        point->live_time = (ticks)end->valuedouble;
        point->live_wall_s = cJSON_GetObjectItem(document, "wall_s")->valuedouble;
    } else if (!exit_status || !text) {
        exit_status = 2;
        status_fail(status, STATUS_IO, "the run of %u + %u nodes said nothing",
                    point->rendering_nodes, point->shading_nodes);
    }
    cJSON_Delete(document);
    free(text);
    free(list);
    return exit_status;
}

static bool is_to_run(const struct scale_options *options, const struct scale_point *point) {
    return (int64_t)point->rendering_nodes + point->shading_nodes + 2 <= options->live_max;
}

static void show_progress(const struct scale_options *options, const struct scale_point *point,
                          size_t done, size_t all, double begin_s, size_t before) {
    const double each_s = done > before ? (now_s() - begin_s) / (double)(done - before) : 0;
    if (options->is_quiet)
        return;
    fprintf(stderr, "%slive run %zu of %zu: %u + %u nodes", isatty(STDERR_FILENO) ? "\r\033[K" : "",
            done + 1, all, point->rendering_nodes, point->shading_nodes);
    if (done > before)
        fprintf(stderr, ", about %.0f s left", each_s * (double)(all - done));
    fputs(isatty(STDERR_FILENO) ? "" : "\n", stderr);
    fflush(stderr);
}

static int run_points(const struct scale_options *options, const struct run_record *first,
                      struct scale_study *study, struct scale_state *state, struct status *status) {
    const size_t count = study->rendering_count * study->shading_count;
    size_t all = 0, done = 0;
    int result = 0;
    for (size_t i = 0; i < count; i++) {
        all += is_to_run(options, &study->points[i]);
        done += is_to_run(options, &study->points[i]) && scale_state_find(state, &study->points[i]);
    }
    const size_t before = done;
    const double begin_s = now_s();
    for (size_t i = 0; !result && i < count && !program_stop; i++) {
        struct scale_point *point = &study->points[i];
        if (!is_to_run(options, point) || point->has_live)
            continue;
        show_progress(options, point, done, all, begin_s, before);
        result = run_live(options, first, point, status);
        if (!result && !scale_state_add(state, point, status))
            result = 2;
        done++;
    }
    if (!options->is_quiet && isatty(STDERR_FILENO))
        fputs("\r\033[K", stderr);
    return result;
}

/* ---- the study ---- */

/* What results depend on besides node counts, as a line of text. */
static bool identify(const struct scale_options *options, const struct run_record *record,
                     char identity[128], struct status *status) {
    uint8_t *bytes;
    size_t length;
    if (!record_encode(record, &bytes, &length, status))
        return false;
    snprintf(identity, 128, "%016" PRIx64 " %s %s", hash_bytes(bytes, length, 0),
             options->strategy->name, options->is_weak ? "weak" : "strong");
    free(bytes);
    return true;
}

static int put_out(const struct scale_options *options, struct scale_study *study,
                   struct status *status) {
    bool is_drawn = true, differs = false;
    scale_compare(study);
    if (!options->is_quiet)
        scale_print(stdout, study);
    if ((options->csv && !scale_write_csv(options->csv, study, status)) ||
        (options->json && !scale_write_json(options->json, study, status)) ||
        (options->plot && !scale_plot(options->plot, study, &is_drawn, status)))
        return status_exit_code(status->code);
    if (!is_drawn && !options->is_quiet)
        fprintf(stderr, "gnuplot is not there: %s.gp draws %s.svg where it is\n", options->plot,
                options->plot);
    for (size_t i = 0; i < study->rendering_count * study->shading_count; i++)
        differs |= study->points[i].has_live && study->points[i].live_time != study->points[i].time;
    if (differs)
        status_fail(status, STATUS_INTERNAL,
                    "a live run took another simulated time than predicted");
    return differs ? 2 : 0;
}

static int study_scene(struct scale_options *options, struct status *status) {
    struct run_record *record = NULL;
    struct scale_state *state = NULL;
    char identity[128];
    int result = obtain_record(options, "", &record);
    if (result)
        return result;
    struct scale_study study = {
        .scene = record->scene,
        .machine = record->machine.name,
        .strategy = options->strategy->name,
        .is_weak = options->is_weak,
        .points = memory_get(options->rendering_count * options->shading_count,
                             sizeof(struct scale_point)),
        .rendering_count = options->rendering_count,
        .shading_count = options->shading_count,
        .frame_count = record->frame_count,
    };
    for (size_t r = 0; r < study.rendering_count; r++)
        for (size_t s = 0; s < study.shading_count; s++) {
            struct scale_point *point = &study.points[r * study.shading_count + s];
            point->rendering_nodes = (uint32_t)options->rendering[r];
            point->shading_nodes = (uint32_t)options->shading[s];
        }
    for (size_t s = 0; !result && s < study.shading_count; s++)
        result = predict_column(options, record, s, &study, status);
    if (!result && (!identify(options, record, identity, status) ||
                    !scale_state_open(options->state, identity, &state, status)))
        result = status_exit_code(status->code);
    if (!result && !record_is_file(options->scene))
        result = run_points(options, record, &study, state, status);
    if (!result)
        result = put_out(options, &study, status);
    if (!result && program_stop)
        result = 128 + (int)program_stop;
    scale_state_close(state);
    free(study.points);
    record_destroy(record);
    return result;
}

int scale_main(int argc, char **argv) {
    struct scale_options options = {.strategy = strategy_at(0), .live_max = LIVE_DEFAULT};
    struct status status = {0};
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) {
            print_help();
            return 0;
        }
    options.forwarded = memory_get((size_t)argc + 2, sizeof *options.forwarded);
    program_streams_ensure();
    program_signals_install();
    bool ok = parse_nodes("-r", "4", &options.rendering, &options.rendering_count, &status) &&
              parse_nodes("-s", "1..32*2", &options.shading, &options.shading_count, &status) &&
              parse(argc, argv, &options, &status);
    if (ok && options.is_weak && record_is_file(options.scene))
        ok = status_fail(&status, STATUS_INVALID,
                         "weak scaling renders pictures of other sizes: it needs the scene");
    int result = ok ? study_scene(&options, &status) : status_exit_code(status.code);
    if (result && status.code != STATUS_OK)
        fprintf(stderr, "sortlast: %s\n", status.message);
    free(options.forwarded);
    free(options.rendering);
    free(options.shading);
    return result;
}
