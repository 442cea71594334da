/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image_compare.h"
#include "images/image_files.h"
#include "nodes/programs/program_process.h"
#include "nodes/programs/tradeoff.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* A setting on frames of the scene, each by a run of its own: what it costs, and how far its
 * pictures are from those of the reference. */

enum { PATH_BYTES = 4096 };

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

/* Renders a frame into FOLDER/NAME.exr and .png, or without a picture. */
static bool render(const struct tradeoff_options *o, const char *name, int frame, char **more,
                   int more_count, cJSON **summary, struct status *status) {
    char picture[PATH_BYTES], json[PATH_BYTES], skip[32];
    char **list = memory_get((size_t)(o->forwarded_count + more_count) + 20, sizeof *list);
    int count = 0;
    snprintf(picture, sizeof picture, "%s/%s.exr", o->folder, name ? name : "");
    snprintf(json, sizeof json, "%s/run.json", o->folder);
    snprintf(skip, sizeof skip, "%d", frame - 1);
    const char *own[] = {"sortlast", "render", "--quiet", "--driver", "in-process", "--frames",
                         "1",        "--skip", skip,      "--json",   json};
    const char *output[] = {"-o", picture, "--png", "--compression", "rle"};
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        list[count++] = (char *)own[i];
    for (size_t i = 0; name && i < sizeof output / sizeof *output; i++)
        list[count++] = (char *)output[i];
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

/* Renders a frame of a setting. Where regions are assigned by what they cost, what they cost is
 * recorded first. */
static bool render_setting(const struct tradeoff_options *o, const struct tradeoff_study *study,
                           const struct tradeoff_setting *setting, const char *name, int frame,
                           cJSON **summary, struct status *status) {
    const int assignment = tradeoff_find_knob(study, "assignment");
    struct tradeoff_setting recorded = *setting;
    char record[PATH_BYTES], *text;
    bool ok = true;
    int count;
    snprintf(record, sizeof record, "%s/costs.record", o->folder);
    const bool is_by_cost = assignment >= 0 && setting->choice[assignment];
    if (is_by_cost) {
        recorded.choice[assignment] = 0;
        char **arguments = tradeoff_arguments(study, &recorded, &count, &text);
        arguments[count++] = (char *)"--record";
        arguments[count++] = record;
        cJSON *unused = NULL;
        ok = render(o, NULL, frame, arguments, count, &unused, status);
        cJSON_Delete(unused);
        free(arguments);
        free(text);
    }
    char **arguments = tradeoff_arguments(study, setting, &count, &text);
    if (is_by_cost) {
        arguments[count++] = (char *)"--costs-from";
        arguments[count++] = record;
    }
    ok = ok && render(o, name, frame, arguments, count, summary, status);
    if (is_by_cost)
        unlink(record);
    free(arguments);
    free(text);
    return ok;
}

static double json_sum(const cJSON *array) {
    const cJSON *item;
    double sum = 0;
    cJSON_ArrayForEach(item, array) sum += item->valuedouble;
    return sum;
}

/* What a frame costs; bytes and samples are added up over the frames of a result. */
struct costs {
    int64_t time_ps, shading_ps, map_bytes;
    double bytes, samples, wall_s;
};

static void add_costs(const cJSON *summary, struct costs *costs) {
    const cJSON *frame = cJSON_GetArrayItem(cJSON_GetObjectItem(summary, "frames"), 0), *instance;
    const cJSON *composition = cJSON_GetObjectItem(frame, "composition");
    costs->time_ps += (int64_t)cJSON_GetNumberValue(cJSON_GetObjectItem(frame, "time_ps"));
    costs->shading_ps += (int64_t)json_sum(cJSON_GetObjectItem(frame, "shading_busy_ps"));
    costs->bytes += cJSON_GetNumberValue(
        cJSON_GetObjectItem(cJSON_GetObjectItem(composition, "bytes"), "total"));
    costs->samples += cJSON_GetNumberValue(cJSON_GetObjectItem(frame, "samples_covered"));
    cJSON_ArrayForEach(instance, cJSON_GetObjectItem(summary, "instances")) {
        const int64_t map =
            (int64_t)cJSON_GetNumberValue(cJSON_GetObjectItem(instance, "transfer_map_bytes"));
        costs->map_bytes = map > costs->map_bytes ? map : costs->map_bytes;
    }
    costs->wall_s += cJSON_GetNumberValue(cJSON_GetObjectItem(summary, "wall_s"));
}

static void reference_path(const struct tradeoff_options *o, int frame, char path[PATH_BYTES]) {
    snprintf(path, PATH_BYTES, "%s/reference-%04d.exr", o->folder, frame);
}

/* `count` frames went before. */
static void add_error(struct tradeoff_error *error, const struct image_difference *difference,
                      int count) {
    const struct image_measures *all = &difference->overall;
    error->max_error = fmax(error->max_error, all->max_error);
    error->psnr_db = count ? fmin(error->psnr_db, all->psnr_db) : all->psnr_db;
    error->flip_mean = fmax(error->flip_mean, difference->flip.mean);
    error->flip_max = fmax(error->flip_max, difference->flip.max);
    error->square_error =
        (error->square_error * count + all->rmse * all->rmse) / (double)(count + 1);
}

/* Compares FOLDER/NAME.exr, which goes, with the reference of the frame. */
static bool compare(const struct tradeoff_options *o, const char *name, int frame,
                    struct tradeoff_error *error, int count, struct status *status) {
    char paths[2][PATH_BYTES];
    struct image *images[2] = {NULL, NULL};
    struct image_difference difference = {0};
    reference_path(o, frame, paths[0]);
    snprintf(paths[1], sizeof paths[1], "%s/%s.exr", o->folder, name);
    const struct image_compare_options options = {.only = "R,G,B"};
    bool ok = image_read(paths[0], &images[0], status) &&
              image_read(paths[1], &images[1], status) &&
              image_compare(images[0], images[1], &options, &difference, status);
    if (ok && image_measures_not_finite(&difference.overall))
        ok = status_fail(status, STATUS_INVALID, "the picture or the reference is not finite");
    if (ok)
        add_error(error, &difference, count);
    image_difference_finish(&difference);
    image_destroy(images[0]);
    image_destroy(images[1]);
    unlink(paths[1]);
    return ok;
}

/* Runs a setting on these frames. The picture of the first is NAME.png, the others do not stay. */
static bool run_frames(const struct tradeoff_options *o, const struct tradeoff_study *study,
                       const struct tradeoff_setting *setting, const struct tradeoff_frames *frames,
                       const char *name, bool keeps_picture, struct costs *costs,
                       struct tradeoff_error *error, struct status *status) {
    bool ok = true;
    *costs = (struct costs){0};
    *error = (struct tradeoff_error){0};
    for (int i = 0; ok && i < frames->count; i++) {
        const bool is_kept = keeps_picture && !i;
        const char *frame_name = is_kept ? name : "frame";
        cJSON *summary = NULL;
        ok = render_setting(o, study, setting, frame_name, frames->numbers[i], &summary, status);
        if (ok)
            add_costs(summary, costs);
        cJSON_Delete(summary);
        ok = ok && compare(o, frame_name, frames->numbers[i], error, i, status);
        if (!is_kept) {
            char picture[PATH_BYTES];
            snprintf(picture, sizeof picture, "%s/%s.png", o->folder, frame_name);
            unlink(picture);
        }
    }
    return ok;
}

bool tradeoff_run(const struct tradeoff_options *o, struct tradeoff_study *study,
                  const struct tradeoff_setting *setting, struct status *status) {
    char name[32];
    struct tradeoff_result result = {.setting = *setting};
    struct costs costs;
    snprintf(name, sizeof name, "setting-%03zu", study->result_count);
    snprintf(result.picture, sizeof result.picture, "%s.png", name);
    if (!run_frames(o, study, setting, &study->tuned, name, true, &costs, &result.error, status))
        return false;
    result.time_ps = costs.time_ps;
    result.shading_ps = costs.shading_ps;
    result.bytes_per_sample = costs.samples > 0 ? costs.bytes / costs.samples : 0;
    result.map_bytes = costs.map_bytes;
    result.wall_s = costs.wall_s;
    study->results = memory_grow(study->results, &study->result_capacity, study->result_count + 1,
                                 sizeof *study->results);
    study->results[study->result_count++] = result;
    return true;
}

bool tradeoff_judge(const struct tradeoff_options *o, const struct tradeoff_study *study,
                    struct tradeoff_result *result, struct status *status) {
    struct costs costs;
    struct tradeoff_error error;
    if (!run_frames(o, study, &result->setting, &study->unseen, "frame", false, &costs, &error,
                    status))
        return false;
    result->judged = error;
    result->judged_time_ps = costs.time_ps;
    result->is_judged = true;
    return true;
}

bool tradeoff_make_references(const struct tradeoff_options *o,
                              const struct tradeoff_frames *frames, cJSON **summary,
                              struct status *status) {
    char *arguments[] = {(char *)"--math",    (char *)"reference",
                         (char *)"--samples", (char *)o->reference_samples,
                         (char *)"--chord",   (char *)"0.02"};
    bool ok = true;
    for (int i = 0; ok && i < frames->count; i++) {
        char name[64];
        cJSON *own = NULL;
        snprintf(name, sizeof name, "reference-%04d", frames->numbers[i]);
        ok = render(o, name, frames->numbers[i], arguments, sizeof arguments / sizeof *arguments,
                    &own, status);
        if (ok && !i && summary)
            *summary = own;
        else
            cJSON_Delete(own);
    }
    return ok;
}
