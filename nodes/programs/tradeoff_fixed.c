/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/program_process.h"
#include "nodes/programs/tradeoff.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Knobs for shaders in fixed-point: `sortlast shader --fix` makes each surface shader of the scene
 * one that keeps an error, as a file in the study's folder. */

enum { PATH_BYTES = 4096, KEY_BYTES = sizeof((struct tradeoff_knob *)0)->key };

static bool is_for_shaders(const char *option) {
    return !strcmp(option, "--machine") || !strcmp(option, "--format") ||
           !strcmp(option, "--shaders");
}

/* Whether the shader could be made fixed-point; when not, the command has said why. */
static bool make(const struct tradeoff_options *o, const char *shader, const char *path,
                 struct status *status) {
    char **list = memory_get((size_t)o->forwarded_count + 12, sizeof *list);
    const char *own[] = {"sortlast",    "shader", shader, "--fix",     o->scene,
                         "--max-error", o->fixed, "-o",   (char *)path};
    int count = 0;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        list[count++] = (char *)own[i];
    for (int i = 0; i + 1 < o->forwarded_count; i += 2)
        if (is_for_shaders(o->forwarded[i])) {
            list[count++] = o->forwarded[i];
            list[count++] = o->forwarded[i + 1];
        }
    int exit_status = 0;
    fprintf(stderr, "tradeoff: makes %s fixed-point\n", shader);
    char *report = program_output(list, &exit_status);
    const bool ok = report && !exit_status;
    free(report);
    free(list);
    if (program_stop)
        status_fail(status, STATUS_LOST, "interrupted; run it again to go on");
    return ok;
}

static void add_knob(struct tradeoff_study *study, const char *key, const char *shader,
                     const char *path) {
    if (study->knob_count == TRADEOFF_KNOBS_MAX) {
        fprintf(stderr, "tradeoff: there are %d knobs, so %s stays in floats\n", TRADEOFF_KNOBS_MAX,
                shader);
        return;
    }
    struct tradeoff_knob *knob = &study->knobs[study->knob_count++];
    *knob = (struct tradeoff_knob){.values = {"float", "fixed"},
                                   .value_count = 2,
                                   .option = "--use",
                                   .shader = -1,
                                   .about = "variables of one shader in fixed-point"};
    snprintf(knob->key, sizeof knob->key, "%s", key);
    knob->use = memory_get(strlen(shader) + strlen(path) + 2, 1);
    sprintf(knob->use, "%s=%s", shader, path);
}

bool tradeoff_add_fixed_knobs(const struct tradeoff_options *o, struct tradeoff_study *study,
                              const cJSON *instances, struct status *status) {
    const cJSON *instance;
    char folder[PATH_BYTES], path[PATH_BYTES + 128], key[KEY_BYTES];
    if (!o->fixed)
        return true;
    const int used = snprintf(folder, sizeof folder, "%s/fixed-%s", o->folder, o->fixed);
    for (int i = (int)strlen(o->folder) + 1; i < used && folder[i];
         i++) /* a folder for each bound */
        folder[i] = folder[i] == '/' ? '_' : folder[i];
    if (mkdir(folder, 0777) && errno != EEXIST)
        return status_fail(status, STATUS_IO, "cannot make the folder %s: %s", folder,
                           strerror(errno));
    cJSON_ArrayForEach(instance, instances) {
        const char *shader = cJSON_GetStringValue(cJSON_GetObjectItem(instance, "shader"));
        if (!shader || strlen(shader) > 90 || strchr(shader, '/'))
            continue;
        snprintf(key, sizeof key, "fixed.%.90s", shader);
        if (tradeoff_find_knob(study, key) >= 0)
            continue;
        snprintf(path, sizeof path, "%s/%.90s.sl", folder, shader);
        if (!access(path, R_OK) || make(o, shader, path, status))
            add_knob(study, key, shader, path);
        if (program_stop)
            return false;
    }
    return true;
}
