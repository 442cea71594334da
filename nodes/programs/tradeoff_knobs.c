/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/tradeoff.h"

#include <stdlib.h>
#include <string.h>

enum {
    SHADER_NAME_MAX = 90,
    PLACE_BYTES = 128,
    KEY_BYTES = sizeof((struct tradeoff_knob *)0)->key
};

void tradeoff_add_table_knobs(struct tradeoff_study *study, bool has_several_shading_nodes) {
#define KNOB_NUMBER(name, ...) KNOB_##name,
    enum { TRADEOFF_KNOBS(KNOB_NUMBER) };
#undef KNOB_NUMBER
#define KNOB_ADD(name, key_text, option_text, value_list, about_text)                              \
    if (KNOB_##name != KNOB_ASSIGNMENT || has_several_shading_nodes) {                             \
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

int tradeoff_find_knob(const struct tradeoff_study *study, const char *key) {
    for (int k = 0; k < study->knob_count; k++)
        if (!strcmp(study->knobs[k].key, key))
            return k;
    return -1;
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

/* "LINE:COLUMN", or in an included file "FILE:LINE:COLUMN". */
static void describe_place(const cJSON *call, char *text, size_t size) {
    const char *file = cJSON_GetStringValue(cJSON_GetObjectItem(call, "file"));
    snprintf(text, size, "%.90s%s%d:%d", file ? file : "", file ? ":" : "",
             (int)number_of(call, "line"), (int)number_of(call, "column"));
}

/* Adds ",SHADER:PLACE" to what a knob makes fast. */
static void add_call(struct tradeoff_knob *knob, const char *shader, const char *place) {
    const size_t used = knob->calls ? strlen(knob->calls) : 0;
    char *text = memory_get(used + strlen(shader) + strlen(place) + 3, 1);
    sprintf(text, "%s%s%s:%s", used ? knob->calls : "", used ? "," : "", shader, place);
    free(knob->calls);
    knob->calls = text;
}

/* The knob of this key, which is made when it is not there; -1: there is no room. */
static int get_knob(struct tradeoff_study *study, const char *key, const char *about) {
    const int found = tradeoff_find_knob(study, key);
    if (found >= 0 || study->knob_count == TRADEOFF_KNOBS_MAX)
        return found;
    struct tradeoff_knob *knob = &study->knobs[study->knob_count];
    *knob = (struct tradeoff_knob){
        .values = {"exact", "fast"}, .value_count = 2, .about = about, .shader = -1};
    snprintf(knob->key, sizeof knob->key, "%s", key);
    return study->knob_count++;
}

static void drop_last_knob(struct tradeoff_study *study) {
    struct tradeoff_knob *knob = &study->knobs[--study->knob_count];
    free(knob->calls);
    free(knob->use);
    knob->calls = knob->use = NULL;
}

static void shader_key(const char *shader, char key[KEY_BYTES]) {
    snprintf(key, KEY_BYTES, "math.%.90s", shader);
}

/* Into the knob of its shader, once for each place; false when there is no room for it. */
static bool add_to_shader(struct tradeoff_study *study, const char *shader, const cJSON *call,
                          const cJSON *calls) {
    char key[KEY_BYTES], place[PLACE_BYTES], other[PLACE_BYTES];
    shader_key(shader, key);
    const int knob = get_knob(study, key, "functions of one shader");
    if (knob < 0)
        return false;
    describe_place(call, place, sizeof place);
    for (const cJSON *before = calls->child; before != call; before = before->next) {
        describe_place(before, other, sizeof other);
        if (shader_of(before) && !strcmp(shader_of(before), shader) && !strcmp(other, place))
            return true;
    }
    add_call(&study->knobs[knob], shader, place);
    return true;
}

/* Knobs for the places of one shader: for all of them, or for none. */
static void add_places(struct tradeoff_study *study, int shader, const cJSON *calls) {
    const int before = study->knob_count;
    const char *name = study->knobs[shader].key + strlen("math.");
    const cJSON *call;
    bool fits = true;
    cJSON_ArrayForEach(call, calls) {
        char key[KEY_BYTES], place[PLACE_BYTES];
        if (!fits || !shader_of(call) || strcmp(shader_of(call), name))
            continue;
        describe_place(call, place, sizeof place);
        snprintf(key, sizeof key, "math.%.90s.%s", name, place);
        const int knob = get_knob(study, key, "functions called at one place");
        fits = knob >= 0;
        if (!fits || study->knobs[knob].calls)
            continue;
        study->knobs[knob].shader = shader;
        add_call(&study->knobs[knob], name, place);
    }
    if (!fits)
        fprintf(stderr,
                "tradeoff: %d knobs are not enough for the calls in %s: its functions are fast "
                "together or not at all\n",
                TRADEOFF_KNOBS_MAX, name);
    const int places = study->knob_count - before;
    while (study->knob_count > before && (!fits || places == 1))
        drop_last_knob(study);
}

void tradeoff_add_call_knobs(struct tradeoff_study *study, const cJSON *calls) {
    const cJSON *call;
    cJSON_ArrayForEach(call, calls) {
        const char *shader = shader_of(call);
        if (shader && strlen(shader) <= SHADER_NAME_MAX &&
            !add_to_shader(study, shader, call, calls))
            fprintf(stderr, "tradeoff: there are %d knobs, so the functions of %s have none\n",
                    TRADEOFF_KNOBS_MAX, shader);
    }
    const int shaders = study->knob_count;
    for (int k = 0; k < shaders; k++)
        if (!study->knobs[k].option)
            add_places(study, k, calls);
}

void tradeoff_finish_knobs(struct tradeoff_study *study) {
    while (study->knob_count)
        drop_last_knob(study);
}

bool tradeoff_contradicts(const struct tradeoff_study *study,
                          const struct tradeoff_setting *setting) {
    for (int f = 0; f < study->knob_count; f++) {
        if (!study->knobs[f].use || !setting->choice[f])
            continue;
        const char *shader = study->knobs[f].key + strlen("fixed.");
        const size_t length = strlen(shader);
        for (int k = 0; k < study->knob_count; k++) {
            const char *key = study->knobs[k].key + strlen("math.");
            if (study->knobs[k].calls && setting->choice[k] && !strncmp(key, shader, length) &&
                (!key[length] || key[length] == '.'))
                return true;
        }
    }
    return false;
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

char **tradeoff_arguments(const struct tradeoff_study *study,
                          const struct tradeoff_setting *setting, int *count, char **text) {
    char **list = memory_get((size_t)study->knob_count * 2 + 4, sizeof *list);
    size_t length = 1;
    for (int k = 0; k < study->knob_count; k++)
        length += study->knobs[k].calls ? strlen(study->knobs[k].calls) + 1 : 0;
    char *end = *text = memory_get(length, 1);
    *count = 0;
    for (int k = 0; k < study->knob_count; k++) {
        const struct tradeoff_knob *knob = &study->knobs[k];
        if (knob->use) {
            if (setting->choice[k]) {
                list[(*count)++] = (char *)knob->option;
                list[(*count)++] = knob->use;
            }
        } else if (knob->option) {
            list[(*count)++] = (char *)knob->option;
            list[(*count)++] = (char *)knob->values[setting->choice[k]];
        } else if (setting->choice[k]) {
            if (end != *text)
                *end++ = ',';
            end = stpcpy(end, knob->calls);
        }
    }
    if (end != *text) {
        list[(*count)++] = (char *)"--fast-calls";
        list[(*count)++] = *text;
    }
    return list;
}
