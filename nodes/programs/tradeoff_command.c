/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image_compare.h"
#include "images/image_files.h"
#include "nodes/programs/program_process.h"
#include "nodes/programs/tradeoff.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

struct tradeoff_options {
    const char *scene, *folder;
    double min_psnr, max_flip, max_time_ms; /* NAN: no limit */
    long runs;                              /* at most */
    const char *reference_samples;
    char **forwarded; /* to `sortlast render` */
    int forwarded_count;
};

static void print_help(void) {
    puts("usage: sortlast tradeoff [options] SCENE.rib\n"
         "\n"
         "Says what speed costs in accuracy for a scene: renders it with knobs turned one by one, "
         "then\n"
         "with combinations that promise something, against a reference in double precision with "
         "many\n"
         "samples, and keeps what no other setting beats in simulated time and error.\n"
         "\n"
         "knobs (the first value is the most accurate):");
#define KNOB_HELP(name, key, option, values, about)                                                \
    {                                                                                              \
        static const char *const list[] = TRADEOFF_UNWRAP values;                                  \
        printf("  %-12s", key);                                                                    \
        for (size_t i = 0; i < sizeof list / sizeof *list; i++)                                    \
            printf(" %s", list[i]);                                                                \
        printf("\n               %s\n", about);                                                    \
    }
#define TRADEOFF_UNWRAP(...) __VA_ARGS__
    TRADEOFF_KNOBS(KNOB_HELP)
#undef KNOB_HELP
    puts("  math.SHADER  exact fast\n"
         "               the functions of one shader: shading time against their digits\n"
         "\n"
         "  -o, --output FOLDER  tradeoff.json, index.html and pictures (default tradeoff); a "
         "folder\n"
         "                       with results of the same study is gone on with\n"
         "      --min-psnr DB    choose the quickest setting with at least this PSNR\n"
         "      --max-flip F     ... and at most this mean of FLIP\n"
         "      --max-time MS    choose the most accurate setting that takes at most this long\n"
         "      --reference-samples N  a pixel of the reference (default 64)\n"
         "      --runs N         stop after N settings (default 40)\n"
         "  -h, --help           this text\n"
         "\n"
         "-r, -s, --machine, --format, --frames, --composition and --shaders go to `sortlast "
         "render`.\n"
         "\n"
         "exit status: 0 done, 1 no setting is within the limits or something is wrong, 2 trouble");
}

static bool parse_number(const char *name, const char *text, double *value, struct status *status) {
    char *end;
    *value = strtod(text, &end);
    return (end != text && !*end && isfinite(*value)) ||
           status_fail(status, STATUS_INVALID, "%s needs a number, not \"%s\"", name, text);
}

static bool is_forwarded(const char *name) {
    static const char *const names[] = {"-r",       "-s",        "--machine",    "--format",
                                        "--frames", "--shaders", "--composition"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(name, names[i]))
            return true;
    return false;
}

static bool parse(int argc, char **argv, struct tradeoff_options *o, struct status *status) {
    *o = (struct tradeoff_options){.folder = "tradeoff",
                                   .min_psnr = NAN,
                                   .max_flip = NAN,
                                   .max_time_ms = NAN,
                                   .runs = 40,
                                   .reference_samples = "64",
                                   .forwarded = memory_get((size_t)argc + 2, sizeof(char *))};
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (name[0] != '-') {
            if (o->scene)
                return status_fail(status, STATUS_INVALID, "more than one scene is given");
            o->scene = name;
            continue;
        }
        if (!value)
            return status_fail(status, STATUS_INVALID, "%s is unknown or needs a value", name);
        double runs = 0;
        i++;
        if (is_forwarded(name)) {
            o->forwarded[o->forwarded_count++] = (char *)name;
            o->forwarded[o->forwarded_count++] = (char *)value;
        } else if (!strcmp(name, "-o") || !strcmp(name, "--output")) {
            o->folder = value;
        } else if (!strcmp(name, "--reference-samples")) {
            o->reference_samples = value;
        } else if (!strcmp(name, "--min-psnr")) {
            if (!parse_number(name, value, &o->min_psnr, status))
                return false;
        } else if (!strcmp(name, "--max-flip")) {
            if (!parse_number(name, value, &o->max_flip, status))
                return false;
        } else if (!strcmp(name, "--max-time")) {
            if (!parse_number(name, value, &o->max_time_ms, status))
                return false;
        } else if (!strcmp(name, "--runs")) {
            if (!parse_number(name, value, &runs, status))
                return false;
            if (!(runs >= 1 && runs <= 100000))
                return status_fail(status, STATUS_INVALID, "--runs must be from 1 to 100000");
            o->runs = (long)runs;
        } else {
            return status_fail(status, STATUS_INVALID, "unknown option %s", name);
        }
    }
    return o->scene || status_fail(status, STATUS_INVALID, "no scene is given");
}

/* Runs `sortlast render` with these arguments, quietly; its JSON goes to a file. */
static bool run_render(char **arguments, struct status *status) {
    fflush(NULL);
    const pid_t child = fork();
    if (!child) {
        program_signals_reset();
        execv("/proc/self/exe", arguments);
        _exit(2);
    }
    int result = -1;
    while (child > 0 && waitpid(child, &result, 0) < 0 && errno == EINTR)
        ;
    if (program_stop)
        return status_fail(status, STATUS_LOST, "interrupted; run it again to go on");
    return (WIFEXITED(result) && !WEXITSTATUS(result)) ||
           status_fail(status, STATUS_INVALID, "a run of the scene failed");
}

static cJSON *read_json(const char *path) {
    char *text = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "rb"), *memory = open_memstream(&text, &size);
    char block[4096];
    for (size_t got; file && (got = fread(block, 1, sizeof block, file)) > 0;)
        fwrite(block, 1, got, memory);
    fclose(memory);
    if (file)
        fclose(file);
    cJSON *document = cJSON_Parse(text);
    free(text);
    return document;
}

/* Renders into FOLDER/NAME.exr (the first frame, however many are timed), .png and .json. */
static bool render(const struct tradeoff_options *o, const char *name, char **more, int more_count,
                   cJSON **summary, struct status *status) {
    char picture[4096], json[4096];
    char **list = memory_get((size_t)(o->forwarded_count + more_count) + 16, sizeof *list);
    int count = 0;
    snprintf(picture, sizeof picture, "%s/%s.exr", o->folder, name);
    snprintf(json, sizeof json, "%s/run.json", o->folder);
    const char *own[] = {
        "sortlast", "render",        "--quiet", "--driver", "in-process", "--frames", "1",
        "--png",    "--compression", "rle",     "-o",       picture,      "--json",   json};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        list[count++] = (char *)own[i];
    for (int i = 0; i < o->forwarded_count; i++)
        list[count++] = o->forwarded[i];
    for (int i = 0; i < more_count; i++)
        list[count++] = more[i];
    list[count++] = (char *)o->scene;
    bool ok = run_render(list, status);
    *summary = ok ? read_json(json) : NULL;
    ok = ok && (*summary || status_fail(status, STATUS_IO, "cannot read %s", json));
    unlink(json);
    free(list);
    return ok;
}

static double json_sum(const cJSON *array) {
    const cJSON *item;
    double sum = 0;
    cJSON_ArrayForEach(item, array) sum += item->valuedouble;
    return sum;
}

static void read_costs(const cJSON *summary, struct tradeoff_result *result) {
    const cJSON *frame, *instance;
    double bytes = 0, samples = 0;
    cJSON_ArrayForEach(frame, cJSON_GetObjectItem(summary, "frames")) {
        const cJSON *composition = cJSON_GetObjectItem(frame, "composition");
        result->time_ps += (int64_t)cJSON_GetNumberValue(cJSON_GetObjectItem(frame, "time_ps"));
        result->shading_ps += (int64_t)json_sum(cJSON_GetObjectItem(frame, "shading_busy_ps"));
        bytes += cJSON_GetNumberValue(
            cJSON_GetObjectItem(cJSON_GetObjectItem(composition, "bytes"), "total"));
        samples += cJSON_GetNumberValue(cJSON_GetObjectItem(frame, "samples_covered"));
    }
    result->bytes_per_sample = samples > 0 ? bytes / samples : 0;
    cJSON_ArrayForEach(instance, cJSON_GetObjectItem(summary, "instances")) {
        const int64_t map =
            (int64_t)cJSON_GetNumberValue(cJSON_GetObjectItem(instance, "transfer_map_bytes"));
        result->map_bytes = map > result->map_bytes ? map : result->map_bytes;
    }
    result->wall_s = cJSON_GetNumberValue(cJSON_GetObjectItem(summary, "wall_s"));
}

static bool judge(const struct tradeoff_options *o, const char *name,
                  struct tradeoff_result *result, struct status *status) {
    char paths[2][4096];
    struct image *images[2] = {NULL, NULL};
    struct image_difference difference = {0};
    snprintf(paths[0], sizeof paths[0], "%s/reference.exr", o->folder);
    snprintf(paths[1], sizeof paths[1], "%s/%s.exr", o->folder, name);
    const struct image_compare_options options = {.only = "R,G,B"};
    bool ok = image_read(paths[0], &images[0], status) &&
              image_read(paths[1], &images[1], status) &&
              image_compare(images[0], images[1], &options, &difference, status);
    if (ok && image_measures_not_finite(&difference.overall))
        ok = status_fail(status, STATUS_INVALID, "the picture or the reference is not finite");
    if (ok) {
        result->max_error = difference.overall.max_error;
        result->psnr_db = difference.overall.psnr_db;
        result->square_error = difference.overall.rmse * difference.overall.rmse;
        result->flip_mean = difference.flip.mean;
        result->flip_max = difference.flip.max;
    }
    image_difference_finish(&difference);
    image_destroy(images[0]);
    image_destroy(images[1]);
    unlink(paths[1]);
    return ok;
}

/* The options of a setting; `fast` receives the shaders with fast functions. */
static int setting_arguments(const struct tradeoff_study *study,
                             const struct tradeoff_setting *setting, char *fast, size_t fast_size,
                             char **arguments) {
    int count = 0;
    size_t used = 0;
    fast[0] = 0;
    for (int k = 0; k < study->knob_count; k++) {
        const struct tradeoff_knob *knob = &study->knobs[k];
        if (knob->option) {
            arguments[count++] = (char *)knob->option;
            arguments[count++] = (char *)knob->values[setting->choice[k]];
        } else if (setting->choice[k] && used < fast_size) {
            used += (size_t)snprintf(fast + used, fast_size - used, "%s%s", used ? "," : "",
                                     knob->key + strlen("math."));
        }
    }
    if (used) {
        arguments[count++] = (char *)"--fast-shaders";
        arguments[count++] = fast;
    }
    return count;
}

static bool run_setting(const struct tradeoff_options *o, struct tradeoff_study *study,
                        const struct tradeoff_setting *setting, struct status *status) {
    char fast[TRADEOFF_KNOBS_MAX * 80], name[32];
    char *arguments[2 * TRADEOFF_KNOBS_MAX + 2];
    struct tradeoff_result result = {.setting = *setting};
    cJSON *summary = NULL;
    const int count = setting_arguments(study, setting, fast, sizeof fast, arguments);
    snprintf(name, sizeof name, "setting-%03zu", study->result_count);
    snprintf(result.picture, sizeof result.picture, "%s.png", name);
    bool ok = render(o, name, arguments, count, &summary, status);
    if (ok)
        read_costs(summary, &result);
    cJSON_Delete(summary);
    ok = ok && judge(o, name, &result, status);
    if (!ok)
        return false;
    study->results = memory_grow(study->results, &study->result_capacity, study->result_count + 1,
                                 sizeof *study->results);
    study->results[study->result_count++] = result;
    return true;
}

/* A knob for the functions of a shader; `name` may have the number of an instance after a dot. */
static void add_math_knob(struct tradeoff_study *study, const char *name) {
    struct tradeoff_knob knob = {
        .values = {"exact", "fast"}, .value_count = 2, .about = "functions of one shader"};
    if (!name || study->knob_count == TRADEOFF_KNOBS_MAX)
        return;
    snprintf(knob.key, sizeof knob.key, "math.%.*s", (int)strcspn(name, "."), name);
    for (int k = 0; k < study->knob_count; k++)
        if (!strcmp(study->knobs[k].key, knob.key))
            return;
    study->knobs[study->knob_count++] = knob;
}

/* The reference, and a knob for the functions of each shader that it ran. */
static bool make_reference(const struct tradeoff_options *o, struct tradeoff_study *study,
                           struct status *status) {
    char *arguments[] = {(char *)"--math",        (char *)"reference",
                         (char *)"--samples",     (char *)o->reference_samples,
                         (char *)"--chord",       (char *)"0.02",
                         (char *)"--explain-work"};
    cJSON *summary;
    if (!render(o, "reference", arguments, sizeof arguments / sizeof *arguments, &summary, status))
        return false;
    const cJSON *work =
        cJSON_GetObjectItem(cJSON_GetArrayItem(cJSON_GetObjectItem(summary, "frames"), 0), "work");
    const cJSON *entry;
    cJSON_ArrayForEach(entry, cJSON_GetObjectItem(summary, "instances"))
        add_math_knob(study, cJSON_GetStringValue(cJSON_GetObjectItem(entry, "shader")));
    cJSON_ArrayForEach(entry, cJSON_GetObjectItem(work, "lights"))
        add_math_knob(study, cJSON_GetStringValue(cJSON_GetObjectItem(entry, "name")));
    cJSON_Delete(summary);
    return true;
}

static void add_table_knobs(struct tradeoff_study *study) {
#define KNOB_ADD(name, key_text, option_text, value_list, about_text)                              \
    {                                                                                              \
        static const char *const list[] = TRADEOFF_UNWRAP value_list;                              \
        struct tradeoff_knob *knob = &study->knobs[study->knob_count++];                           \
        snprintf(knob->key, sizeof knob->key, "%s", key_text);                                     \
        knob->option = option_text;                                                                \
        knob->about = about_text;                                                                  \
        knob->value_count = (int)(sizeof list / sizeof *list);                                     \
        memcpy(knob->values, list, sizeof list);                                                   \
    }
    TRADEOFF_KNOBS(KNOB_ADD)
#undef KNOB_ADD
}

/* The quickest within the limits of error, or with a limit of time the most accurate. */
static void choose(const struct tradeoff_options *o, struct tradeoff_study *study) {
    study->chosen = -1;
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i],
                                     *best =
                                         study->chosen < 0 ? NULL : &study->results[study->chosen];
        if (r->psnr_db < o->min_psnr || r->flip_mean > o->max_flip ||
            (double)r->time_ps * 1e-9 > o->max_time_ms)
            continue;
        if (!best || (isnan(o->max_time_ms) ? r->time_ps < best->time_ps
                                            : r->square_error < best->square_error))
            study->chosen = (int)i;
    }
}

static void show_progress(const struct tradeoff_study *study, size_t left, long runs,
                          double spent_s, size_t done_here) {
    const size_t all = study->result_count + left;
    const double rest = (double)((long)all < runs ? left : (size_t)runs - study->result_count);
    fprintf(stderr, "tradeoff: %zu settings done, some %.0f to go", study->result_count, rest);
    if (done_here)
        fprintf(stderr, ", %.0f s left", rest * spent_s / (double)done_here);
    fprintf(stderr, "\n");
}

static void print_results(const struct tradeoff_study *study) {
    const struct tradeoff_result *base = &study->results[0];
    printf("%s: %zu settings\n", study->scene, study->result_count);
    printf("  time ms  shading ms  speed-up  bytes/sample   PSNR dB  FLIP mean  setting\n");
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        char text[512];
        if (!r->is_on_frontier && (int)i != study->chosen)
            continue;
        tradeoff_describe(study, &r->setting, text, sizeof text);
        printf("%s%8.3f  %10.3f  %8.2f  %12.2f  %8.2f  %9.5f  %s\n",
               (int)i == study->chosen ? "*" : " ", (double)r->time_ps * 1e-9,
               (double)r->shading_ps * 1e-9,
               (double)base->shading_ps / fmax((double)r->shading_ps, 1), r->bytes_per_sample,
               r->psnr_db, r->flip_mean, text);
    }
    printf("  (speed-up: of shading, against the most accurate setting; * chosen)\n");
}

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static bool explore(const struct tradeoff_options *o, struct tradeoff_study *study,
                    struct status *status) {
    char json[4096], page[4096];
    snprintf(json, sizeof json, "%s/tradeoff.json", o->folder);
    snprintf(page, sizeof page, "%s/index.html", o->folder);
    add_table_knobs(study);
    if (!make_reference(o, study, status) || !tradeoff_read_json(study, json, status))
        return false;
    struct tradeoff_setting setting;
    size_t left, done_here = 0;
    const double begin = now_s();
    while ((long)study->result_count < o->runs && tradeoff_next(study, &setting, &left)) {
        show_progress(study, left, o->runs, now_s() - begin, done_here);
        if (!run_setting(o, study, &setting, status))
            return false;
        done_here++;
        tradeoff_mark_frontier(study);
        choose(o, study);
        if (!tradeoff_write_json(study, json, status))
            return false;
    }
    tradeoff_mark_frontier(study);
    choose(o, study);
    return tradeoff_write_json(study, json, status) && tradeoff_write_page(study, page, status);
}

int tradeoff_main(int argc, char **argv) {
    struct tradeoff_options options;
    struct status status = {0};
    struct tradeoff_study study = {.chosen = -1};
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "-h") || !strcmp(argv[i], "--help")) {
            print_help();
            return 0;
        }
    program_signals_install();
    bool ok = parse(argc, argv, &options, &status);
    if (ok && mkdir(options.folder, 0777) && errno != EEXIST)
        ok = status_fail(&status, STATUS_IO, "cannot make the folder %s: %s", options.folder,
                         strerror(errno));
    if (ok) {
        size_t used = (size_t)snprintf(study.identity, sizeof study.identity, "%s, %s samples",
                                       options.scene, options.reference_samples);
        for (int i = 0; i < options.forwarded_count && used < sizeof study.identity; i++)
            used += (size_t)snprintf(study.identity + used, sizeof study.identity - used, " %s",
                                     options.forwarded[i]);
        study.scene = options.scene;
        ok = explore(&options, &study, &status);
    }
    const bool has_limits =
        !isnan(options.min_psnr) || !isnan(options.max_flip) || !isnan(options.max_time_ms);
    if (ok)
        print_results(&study);
    if (ok && has_limits && study.chosen < 0)
        ok = status_fail(&status, STATUS_INVALID, "no setting is within the limits");
    if (!ok)
        fprintf(stderr, "sortlast tradeoff: %s\n", status.message);
    free(study.results);
    free(options.forwarded);
    return ok ? 0 : status_exit_code(status.code);
}
