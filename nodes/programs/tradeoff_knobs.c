/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/tradeoff.h"

#include <stdlib.h>
#include <string.h>

void tradeoff_add_table_knobs(struct tradeoff_study *study) {
#define KNOB_ADD(name, key_text, option_text, value_list, about_text)                              \
    {                                                                                              \
        static const char *const list[] = TRADEOFF_UNWRAP value_list;                              \
        struct tradeoff_knob *knob = &study->knobs[study->knob_count++];                           \
        snprintf(knob->key, sizeof knob->key, "%s", key_text);                                     \
        knob->option = option_text;                                                                \
        knob->shader = -1;                                                                         \
        knob->about = about_text;                                                                  \
        knob->value_count = (int)(sizeof list / sizeof *list);                                     \
        memcpy(knob->values, list, sizeof list);                                                   \
    }
    TRADEOFF_KNOBS(KNOB_ADD)
#undef KNOB_ADD
}

static int find_knob(const struct tradeoff_study *study, const char *key) {
    for (int k = 0; k < study->knob_count; k++)
        if (!strcmp(study->knobs[k].key, key))
            return k;
    return -1;
}

static struct tradeoff_knob functions_knob(const char *about) {
    return (struct tradeoff_knob){
        .values = {"exact", "fast"}, .value_count = 2, .about = about, .shader = -1};
}

static double number_of(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItem(object, key);
    return cJSON_IsNumber(item) ? item->valuedouble : 0;
}

/* The shader of a call that costs the array something, else NULL. */
static const char *shader_of(const cJSON *call) {
    return number_of(call, "issued") > 0 ? cJSON_GetStringValue(cJSON_GetObjectItem(call, "shader"))
                                         : NULL;
}

static void add_shader_knob(struct tradeoff_study *study, const char *shader) {
    struct tradeoff_knob knob = functions_knob("functions of one shader");
    if (strlen(shader) >= sizeof knob.argument)
        return;
    snprintf(knob.key, sizeof knob.key, "math.%s", shader);
    memcpy(knob.argument, shader, strlen(shader) + 1);
    if (find_knob(study, knob.key) >= 0)
        return;
    if (study->knob_count == TRADEOFF_KNOBS_MAX)
        fprintf(stderr, "tradeoff: there are %d knobs, so the functions of %s have none\n",
                TRADEOFF_KNOBS_MAX, shader);
    else
        study->knobs[study->knob_count++] = knob;
}

/* Knobs for the places of one shader: for all of them, or for none. */
static void add_place_knobs(struct tradeoff_study *study, int shader, const cJSON *calls) {
    const int before = study->knob_count;
    const char *name = study->knobs[shader].argument;
    const cJSON *call;
    bool fits = true;
    cJSON_ArrayForEach(call, calls) {
        struct tradeoff_knob knob = functions_knob("functions called at one place");
        const char *called = shader_of(call),
                   *file = cJSON_GetStringValue(cJSON_GetObjectItem(call, "file"));
        if (!called || strcmp(called, name))
            continue;
        const int length =
            snprintf(knob.argument, sizeof knob.argument, "%s:%s%s%d:%d", name, file ? file : "",
                     file ? ":" : "", (int)number_of(call, "line"), (int)number_of(call, "column"));
        snprintf(knob.key, sizeof knob.key, "math.%s.%s", name, knob.argument + strlen(name) + 1);
        knob.shader = shader;
        if (find_knob(study, knob.key) >= 0)
            continue;
        fits = fits && length < (int)sizeof knob.argument && study->knob_count < TRADEOFF_KNOBS_MAX;
        if (fits)
            study->knobs[study->knob_count++] = knob;
    }
    if (!fits)
        fprintf(stderr,
                "tradeoff: %d knobs are not enough for the calls in %s: its functions are fast "
                "together or not at all\n",
                TRADEOFF_KNOBS_MAX, name);
    if (!fits || study->knob_count == before + 1)
        study->knob_count = before;
}

void tradeoff_add_call_knobs(struct tradeoff_study *study, const cJSON *calls) {
    const cJSON *call;
    cJSON_ArrayForEach(call, calls) if (shader_of(call)) add_shader_knob(study, shader_of(call));
    const int shaders = study->knob_count;
    for (int k = 0; k < shaders; k++)
        if (!study->knobs[k].option)
            add_place_knobs(study, k, calls);
}

void tradeoff_describe(const struct tradeoff_study *study, const struct tradeoff_setting *setting,
                       char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < study->knob_count && used < size; k++)
        if (setting->choice[k])
            used +=
                (size_t)snprintf(text + used, size - used, "%s%s=%s", used ? " " : "",
                                 study->knobs[k].key, study->knobs[k].values[setting->choice[k]]);
    if (!used)
        snprintf(text, size, "most accurate");
}

/* The arguments of all knobs of functions of one kind that say fast, with commas, from `text` on;
 * returns what comes after. */
static char *join_fast(const struct tradeoff_study *study, const struct tradeoff_setting *setting,
                       bool places, char *text) {
    char *end = text;
    for (int k = 0; k < study->knob_count; k++) {
        const struct tradeoff_knob *knob = &study->knobs[k];
        if (knob->option || !setting->choice[k] || (knob->shader >= 0) != places)
            continue;
        if (end != text)
            *end++ = ',';
        end = stpcpy(end, knob->argument);
    }
    return end + 1;
}

char **tradeoff_arguments(const struct tradeoff_study *study,
                          const struct tradeoff_setting *setting, int *count, char **text) {
    char **list = memory_get((size_t)study->knob_count * 2 + 4, sizeof *list);
    *text =
        memory_get((size_t)study->knob_count * sizeof study->knobs->argument + 2, sizeof **text);
    *count = 0;
    for (int k = 0; k < study->knob_count; k++)
        if (study->knobs[k].option) {
            list[(*count)++] = (char *)study->knobs[k].option;
            list[(*count)++] = (char *)study->knobs[k].values[setting->choice[k]];
        }
    char *shaders = *text, *calls = join_fast(study, setting, false, shaders);
    join_fast(study, setting, true, calls);
    if (*shaders) {
        list[(*count)++] = (char *)"--fast-shaders";
        list[(*count)++] = shaders;
    }
    if (*calls) {
        list[(*count)++] = (char *)"--fast-calls";
        list[(*count)++] = calls;
    }
    return list;
}
