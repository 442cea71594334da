/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_reader.h"

#include <string.h>

/* The names that RIB knows without Declare: those of primitives and of the standard shaders and
 * options.
 *
 * X(NAME, declaration) */
#define STANDARD_DECLARATIONS(X)                                                                   \
    X("P", "vertex point")                                                                         \
    X("Pz", "vertex float")                                                                        \
    X("Pw", "vertex hpoint")                                                                       \
    X("N", "varying normal")                                                                       \
    X("Np", "uniform normal")                                                                      \
    X("Cs", "varying color")                                                                       \
    X("Os", "varying color")                                                                       \
    X("s", "varying float")                                                                        \
    X("t", "varying float")                                                                        \
    X("st", "varying float[2]")                                                                    \
    X("Ka", "uniform float")                                                                       \
    X("Kd", "uniform float")                                                                       \
    X("Ks", "uniform float")                                                                       \
    X("Kr", "uniform float")                                                                       \
    X("roughness", "uniform float")                                                                \
    X("specularcolor", "uniform color")                                                            \
    X("texturename", "uniform string")                                                             \
    X("background", "uniform color")                                                               \
    X("distance", "uniform float")                                                                 \
    X("mindistance", "uniform float")                                                              \
    X("maxdistance", "uniform float")                                                              \
    X("amplitude", "uniform float")                                                                \
    X("intensity", "uniform float")                                                                \
    X("lightcolor", "uniform color")                                                               \
    X("from", "uniform point")                                                                     \
    X("to", "uniform point")                                                                       \
    X("coneangle", "uniform float")                                                                \
    X("conedeltaangle", "uniform float")                                                           \
    X("beamdistribution", "uniform float")                                                         \
    X("fov", "uniform float")                                                                      \
    X("origin", "uniform integer[2]")                                                              \
    X("quantize", "uniform float[4]")                                                              \
    X("dither", "uniform float")                                                                   \
    X("compression", "uniform string")

void rib_declare_standard(struct rib_reader *reader) {
    const char *problem;
#define DECLARE(name, text)                                                                        \
    name_table_set(&reader->declarations, name,                                                    \
                   (void *)rib_parse_declaration(reader, text, false, &problem));
    STANDARD_DECLARATIONS(DECLARE)
#undef DECLARE
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/* A word ends at a blank or bracket. */
static size_t word_read(const char **text) {
    while (is_blank(**text))
        ++*text;
    const char *end = *text;
    while (*end && !is_blank(*end) && *end != '[' && *end != ']')
        end++;
    return (size_t)(end - *text);
}

static bool word_is(const char *word, size_t length, const char *name) {
    return strlen(name) == length && memcmp(word, name, length) == 0;
}

static bool parse_storage(const char *word, size_t length, enum storage_class *storage) {
    static const char *const names[] = {"constant", "uniform", "varying", "vertex", "facevarying"};
    for (int i = 0; i < 5; i++)
        if (word_is(word, length, names[i])) {
            *storage = (enum storage_class)i;
            return true;
        }
    return false;
}

static bool parse_type(const char *word, size_t length, enum rib_type *type) {
    for (int i = RIB_FLOAT; i <= RIB_STRING; i++)
        if (word_is(word, length, rib_type_name((enum rib_type)i))) {
            *type = (enum rib_type)i;
            return true;
        }
    if (word_is(word, length, "int")) {
        *type = RIB_INTEGER;
        return true;
    }
    return false;
}

/* "[ n ]" or nothing. */
static bool parse_array_length(const char **text, int *array_length, const char **problem) {
    const char *at = *text;
    while (is_blank(*at))
        at++;
    *array_length = 0;
    if (*at != '[')
        return true;
    at++;
    while (is_blank(*at))
        at++;
    long length = 0;
    for (; *at >= '0' && *at <= '9'; at++)
        if (length < 100000)
            length = length * 10 + (*at - '0');
    while (is_blank(*at))
        at++;
    if (*at != ']' || length < 1 || length > 4096) {
        *problem = "the array length must be 1 to 4096";
        return false;
    }
    *array_length = (int)length;
    *text = at + 1;
    return true;
}

const struct declaration *rib_parse_declaration(struct rib_reader *reader, const char *text,
                                                bool is_inline, const char **problem) {
    struct declaration declaration = {.storage = STORAGE_UNIFORM};
    size_t length = word_read(&text);
    if (parse_storage(text, length, &declaration.storage)) {
        text += length;
        length = word_read(&text);
    }
    *problem = "it must be [constant|uniform|varying|vertex|facevarying] "
               "float|integer|color|point|vector|normal|string[n]";
    if (!parse_type(text, length, &declaration.type))
        return NULL;
    text += length;
    if (!parse_array_length(&text, &declaration.array_length, problem))
        return NULL;
    length = word_read(&text);
    if (is_inline) {
        if (!length) {
            *problem = "the name is missing";
            return NULL;
        }
        declaration.name = rib_intern(reader, text, length);
        text += length;
        if (!declaration.array_length &&
            !parse_array_length(&text, &declaration.array_length, problem))
            return NULL;
        length = word_read(&text);
    }
    if (length || *text)
        return NULL;
    struct declaration *kept = arena_get(&reader->strings, sizeof *kept);
    *kept = declaration;
    return kept;
}
