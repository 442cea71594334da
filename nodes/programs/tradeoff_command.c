/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/program_process.h"
#include "nodes/programs/shader_command.h"
#include "nodes/programs/tradeoff.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

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
    TRADEOFF_KNOBS(KNOB_HELP)
#undef KNOB_HELP
    puts(
        "  math.SHADER  exact fast\n"
        "               the functions of one shader that the array pays for: shading time against "
        "digits\n"
        "  math.SHADER.LINE:COLUMN  exact fast\n"
        "               those called at one place of it; looked at where a shader has several and\n"
        "               is not as good with all of them fast\n"
        "  fixed.SHADER  float fixed\n"
        "               variables of one surface shader, with --fixed: shading time against "
        "digits\n"
        "\n"
        "  -o, --output FOLDER  tradeoff.json, index.html and pictures (default tradeoff); a "
        "folder\n"
        "                       with results of the same study is gone on with\n"
        "      --min-psnr DB    choose the quickest setting with at least this PSNR\n"
        "      --max-flip F     ... and at most this mean of FLIP\n"
        "      --max-error E    ... and at most this difference in any channel of any pixel\n"
        "      --max-time MS    choose the most accurate setting that takes at most this long\n"
        "      --reference-samples N  a pixel of the reference (default 64)\n"
        "      --fixed E        make a version in fixed-point of each surface shader that keeps "
        "this "
        "error\n"
        "                       (sortlast shader --fix), and look at those, too\n"
        "      --runs N         stop after N settings (default 40)\n"
        "      --tune-frames F  frames of the scene to search on, like 1,3-5, counted from 1 "
        "(default 1)\n"
        "      --judge-frames F frames to judge on what the search found, or none; the choice has "
        "to keep\n"
        "                       the limits there, too (default: all others among the first 64; of "
        "more\n"
        "                       than 8 so many, evenly spread)\n"
        "  -h, --help           this text\n"
        "\n"
        "Of several frames the worst error counts, and the sum of times; --max-time is for a frame "
        "on average.\n"
        "-r, -s, --machine, --format, --composition, --link and --shaders go to `sortlast "
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
    static const char *const names[] = {"-r",     "-s",        "--machine",    "--format",
                                        "--link", "--shaders", "--composition"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(name, names[i]))
            return true;
    return false;
}

static bool parse(int argc, char **argv, struct tradeoff_options *o, struct status *status) {
    *o = (struct tradeoff_options){.folder = "tradeoff",
                                   .min_psnr = NAN,
                                   .max_flip = NAN,
                                   .max_error = NAN,
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
        } else if (!strcmp(name, "--fixed")) {
            double bound;
            o->fixed = value;
            if (!shader_error_bound(value, &bound))
                return status_fail(status, STATUS_INVALID,
                                   "--fixed is above 0 and at most 1, as 0.01 or 2/255, not %s",
                                   value);
        } else if (!strcmp(name, "--tune-frames")) {
            o->tune_frames = value;
        } else if (!strcmp(name, "--judge-frames")) {
            o->judge_frames = value;
        } else if (!strcmp(name, "--min-psnr")) {
            if (!parse_number(name, value, &o->min_psnr, status))
                return false;
        } else if (!strcmp(name, "--max-flip")) {
            if (!parse_number(name, value, &o->max_flip, status))
                return false;
        } else if (!strcmp(name, "--max-error")) {
            if (!parse_number(name, value, &o->max_error, status))
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

static bool is_within(const struct tradeoff_options *o, const struct tradeoff_error *error,
                      int64_t time_ps, int frames) {
    return !(error->psnr_db < o->min_psnr || error->flip_mean > o->max_flip ||
             error->max_error > o->max_error || (double)time_ps * 1e-9 > o->max_time_ms * frames);
}

/* Whether it keeps the limits on all frames that it was run on; notes when only on those tuned on.
 */
static bool keeps_limits(const struct tradeoff_options *o, const struct tradeoff_study *study,
                         struct tradeoff_result *r) {
    const bool is_tuned = is_within(o, &r->error, r->time_ps, study->tuned.count);
    r->is_refused = is_tuned && r->is_judged &&
                    !is_within(o, &r->judged, r->judged_time_ps, study->unseen.count);
    return is_tuned && !r->is_refused;
}

/* The quickest within the limits of error, or with a limit of time the most accurate. */
static void choose(const struct tradeoff_options *o, struct tradeoff_study *study) {
    study->chosen = -1;
    for (size_t i = 0; i < study->result_count; i++) {
        struct tradeoff_result *r = &study->results[i],
                               *best = study->chosen < 0 ? NULL : &study->results[study->chosen];
        if (!keeps_limits(o, study, r))
            continue;
        if (!best || (isnan(o->max_time_ms) ? r->time_ps < best->time_ps
                                            : r->error.square_error < best->error.square_error))
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
    char tuned[512], judged[512];
    tradeoff_describe_frames(&study->tuned, tuned, sizeof tuned);
    tradeoff_describe_frames(&study->unseen, judged, sizeof judged);
    const bool has_judged = study->unseen.count > 0;
    printf("%s: %zu settings", study->scene, study->result_count);
    if (has_judged)
        printf(", tuned on frame %s, judged on frame %s", tuned, judged);
    printf("\n  time ms  shading ms  speed-up  bytes/sample   PSNR dB  FLIP mean%s  setting\n",
           has_judged ? "  judged: PSNR dB  FLIP mean" : "");
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        char text[512], unseen[64] = "";
        if (!r->is_on_frontier && (int)i != study->chosen)
            continue;
        tradeoff_describe(study, &r->setting, text, sizeof text);
        if (r->is_judged)
            snprintf(unseen, sizeof unseen, "  %15.2f  %9.5f", r->judged.psnr_db,
                     r->judged.flip_mean);
        else if (has_judged)
            snprintf(unseen, sizeof unseen, "  %15s  %9s", "-", "-");
        printf("%s%8.3f  %10.3f  %8.2f  %12.2f  %8.2f  %9.5f%s  %s\n",
               (int)i == study->chosen ? "*" : " ", (double)r->time_ps * 1e-9,
               (double)r->shading_ps * 1e-9,
               (double)base->shading_ps / fmax((double)r->shading_ps, 1), r->bytes_per_sample,
               r->error.psnr_db, r->error.flip_mean, unseen, text);
    }
    printf("  (speed-up: of shading, against the most accurate setting; * chosen)\n");
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        char text[512];
        if (!r->is_refused)
            continue;
        tradeoff_describe(study, &r->setting, text, sizeof text);
        printf("within the limits on frame %s only, so not chosen (judged: PSNR %.2f dB, FLIP mean "
               "%.5f, largest error %.4f, %.3f ms a frame): %s\n",
               tuned, r->judged.psnr_db, r->judged.flip_mean, r->judged.max_error,
               (double)r->judged_time_ps * 1e-9 / study->unseen.count, text);
    }
}

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

static bool judge_one(const struct tradeoff_options *o, struct tradeoff_study *study, int number,
                      const char *json, struct status *status) {
    struct tradeoff_result *result = &study->results[number];
    char text[512];
    if (result->is_judged)
        return true;
    tradeoff_describe(study, &result->setting, text, sizeof text);
    fprintf(stderr, "tradeoff: judging %s\n", text);
    return tradeoff_judge(o, study, result, status) && tradeoff_write_json(study, json, status);
}

/* Judges what would be chosen, until one keeps the limits on unseen frames, and the frontier. */
static bool judge_results(const struct tradeoff_options *o, struct tradeoff_study *study,
                          const char *json, struct status *status) {
    bool is_complete = study->chosen < 0 || study->results[study->chosen].is_judged;
    for (size_t i = 0; i < study->result_count; i++)
        is_complete &= !study->results[i].is_on_frontier || study->results[i].is_judged;
    if (!study->unseen.count || is_complete)
        return true;
    if (!tradeoff_make_references(o, &study->unseen, NULL, status))
        return false;
    for (; study->chosen >= 0 && !study->results[study->chosen].is_judged; choose(o, study))
        if (!judge_one(o, study, study->chosen, json, status))
            return false;
    for (size_t i = 0; i < study->result_count; i++)
        if (study->results[i].is_on_frontier && !judge_one(o, study, (int)i, json, status))
            return false;
    choose(o, study);
    return true;
}

static bool search(const struct tradeoff_options *o, struct tradeoff_study *study, const char *json,
                   struct status *status) {
    struct tradeoff_setting setting;
    size_t left, done_here = 0;
    const double begin = now_s();
    while ((long)study->result_count < o->runs && tradeoff_next(study, &setting, &left)) {
        show_progress(study, left, o->runs, now_s() - begin, done_here);
        if (!tradeoff_run(o, study, &setting, status))
            return false;
        done_here++;
        tradeoff_mark_frontier(study);
        choose(o, study);
        if (!tradeoff_write_json(study, json, status))
            return false;
    }
    tradeoff_mark_frontier(study);
    choose(o, study);
    return true;
}

static bool has_several_shading_nodes(const struct tradeoff_options *o) {
    bool result = false;
    for (int i = 0; i + 1 < o->forwarded_count; i += 2)
        if (!strcmp(o->forwarded[i], "-s"))
            result = atol(o->forwarded[i + 1]) > 1;
    return result;
}

static bool explore(const struct tradeoff_options *o, struct tradeoff_study *study,
                    struct status *status) {
    char json[4096], page[4096];
    cJSON *summary = NULL;
    snprintf(json, sizeof json, "%s/tradeoff.json", o->folder);
    snprintf(page, sizeof page, "%s/index.html", o->folder);
    tradeoff_add_table_knobs(study, has_several_shading_nodes(o));
    if (!tradeoff_make_references(o, &study->tuned, &summary, status))
        return false;
    tradeoff_add_call_knobs(study, cJSON_GetObjectItem(summary, "calls"));
    const bool ok =
        tradeoff_add_fixed_knobs(o, study, cJSON_GetObjectItem(summary, "instances"), status);
    cJSON_Delete(summary);
    return ok && tradeoff_read_json(study, json, status) && search(o, study, json, status) &&
           judge_results(o, study, json, status) && tradeoff_write_json(study, json, status) &&
           tradeoff_write_page(study, page, status);
}

/* Everything that results depend on but the setting. */
static void make_identity(const struct tradeoff_options *o, struct tradeoff_study *study) {
    char tuned[512], judged[512];
    const size_t size = sizeof study->identity;
    tradeoff_describe_frames(&study->tuned, tuned, sizeof tuned);
    tradeoff_describe_frames(&study->unseen, judged, sizeof judged);
    size_t used = (size_t)snprintf(study->identity, size, "%s, %s samples, frame %s, judged on %s",
                                   o->scene, o->reference_samples, tuned, judged);
    if (o->fixed && used < size)
        used +=
            (size_t)snprintf(study->identity + used, size - used, ", fixed within %s", o->fixed);
    for (int i = 0; i < o->forwarded_count && used < size; i++)
        used += (size_t)snprintf(study->identity + used, size - used, " %s", o->forwarded[i]);
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
    if (ok && (ok = tradeoff_choose_frames(&options, &study, &status))) {
        make_identity(&options, &study);
        study.scene = options.scene;
        ok = explore(&options, &study, &status);
    }
    const bool has_limits = !isnan(options.min_psnr) || !isnan(options.max_flip) ||
                            !isnan(options.max_error) || !isnan(options.max_time_ms);
    if (ok)
        print_results(&study);
    if (ok && has_limits && study.chosen < 0)
        ok = status_fail(&status, STATUS_INVALID, "no setting is within the limits");
    if (!ok)
        fprintf(stderr, "sortlast tradeoff: %s\n", status.message);
    free(study.results);
    tradeoff_finish_knobs(&study);
    free(options.forwarded);
    return ok ? 0 : status_exit_code(status.code);
}
