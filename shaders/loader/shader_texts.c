/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/loader/shader_texts.h"

#include "shaders/compiler/shader_compile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_BYTES_MAX = 4096, TABLE_BYTES_MAX = 1 << 20, MATCH_STEPS_MAX = 1000000 };

static struct text_entry **bucket_of(const struct text_table *table, int32_t identity) {
    return (struct text_entry **)&table->buckets[(uint32_t)identity % 256];
}

const char *text_table_find(const struct text_table *table, int32_t identity) {
    for (const struct text_entry *e = *bucket_of(table, identity); e; e = e->next)
        if (e->identity == identity)
            return e->text;
    return "";
}

int32_t text_table_add(struct text_table *table, const char *text) {
    int32_t identity = shader_string_identity(text);
    for (const struct text_entry *e = *bucket_of(table, identity); e; e = e->next)
        if (e->identity == identity)
            return identity;
    const size_t length = strlen(text);
    struct text_entry *entry =
        length < TEXT_BYTES_MAX ? arena_get(&table->arena, sizeof *entry) : NULL;
    const char *copy = entry ? arena_copy_string(&table->arena, text, length) : NULL;
    if (!copy)
        return shader_string_identity("");
    *entry = (struct text_entry){identity, copy, *bucket_of(table, identity)};
    *bucket_of(table, identity) = entry;
    return identity;
}

static int32_t join(struct shader_texts *texts, int32_t a, int32_t b) {
    struct text_table *table = (struct text_table *)texts;
    char text[2 * TEXT_BYTES_MAX];
    snprintf(text, sizeof text, "%s%s", text_table_find(table, a), text_table_find(table, b));
    return text_table_add(table, text);
}

/* "%-+ 0#W.Pletter", as the compiler lets through: f, e, g, or d for the whole number towards zero.
 */
static int32_t append_number(struct shader_texts *texts, int32_t text, float number, int32_t how) {
    struct text_table *table = (struct text_table *)texts;
    const char *conversion = text_table_find(table, how), *at = conversion + (*conversion == '%');
    const size_t flags = strspn(at, "-+ 0#");
    const bool is_left = memchr(at, '-', flags) != NULL, has_zeros = memchr(at, '0', flags) != NULL;
    char *end = NULL, digits[512], result[2 * TEXT_BYTES_MAX];
    long width = strtol(at + flags, &end, 10),
         precision = *end == '.' ? strtol(end + 1, &end, 10) : 6;
    const double value = *end == 'd' ? (double)truncf(number) : (double)number;
    width = width > 99 ? 99 : width;
    precision = *end == 'd' ? 0 : precision > 40 ? 40 : precision;
    if (*end == 'g')
        snprintf(digits, sizeof digits,
                 is_left     ? "%-*.*g"
                 : has_zeros ? "%0*.*g"
                             : "%*.*g",
                 (int)width, (int)precision, value);
    else if (*end == 'e')
        snprintf(digits, sizeof digits,
                 is_left     ? "%-*.*e"
                 : has_zeros ? "%0*.*e"
                             : "%*.*e",
                 (int)width, (int)precision, value);
    else
        snprintf(digits, sizeof digits,
                 is_left     ? "%-*.*f"
                 : has_zeros ? "%0*.*f"
                             : "%*.*f",
                 (int)width, (int)precision, value);
    snprintf(result, sizeof result, "%s%s", text_table_find(table, text), digits);
    return text_table_add(table, result);
}

static float match(struct shader_texts *texts, int32_t pattern, int32_t text) {
    const struct text_table *table = (const struct text_table *)texts;
    return text_matches(text_table_find(table, pattern), text_table_find(table, text)) ? 1.0f
                                                                                       : 0.0f;
}

void text_table_init(struct text_table *table, const struct shader_module *module,
                     const char *others, size_t bytes) {
    *table = (struct text_table){.texts = {join, append_number, match}};
    arena_init(&table->arena, TABLE_BYTES_MAX);
    text_table_add(table, "");
    for (int i = 0; i < module->text_count; i++)
        text_table_add(table, module->texts[i]);
    for (size_t at = 0; at < bytes; at += strlen(others + at) + 1)
        text_table_add(table, others + at);
}

void text_table_finish(struct text_table *table) {
    arena_finish(&table->arena);
}

/* Regular expressions: each element is one character, '.', '[set]' or '\' and a character, and may
 * be followed by '*', '+' or '?'. `end` is where the alternative ends. */
struct matcher {
    const char *end;
    int steps;
};

static const char *element_end(const struct matcher *m, const char *p) {
    if (*p == '\\' && p + 1 < m->end)
        return p + 2;
    if (*p != '[')
        return p + 1;
    const char *q = p + 1 + (p[1] == '^');
    for (q += q < m->end && *q == ']'; q < m->end && *q != ']'; q++)
        ;
    return q < m->end ? q + 1 : p + 1; /* never closed: a bracket */
}

static bool fits(const char *p, const char *after, char c) {
    if (!c)
        return false;
    if (*p == '\\' && after == p + 2)
        return p[1] == c;
    if (*p == '[' && after > p + 1) {
        const bool is_inverted = p[1] == '^';
        bool is_in = false;
        for (const char *q = p + 1 + is_inverted; q < after - 1; q++) {
            const bool is_range = q + 2 < after - 1 && q[1] == '-';
            is_in |= is_range ? q[0] <= c && c <= q[2] : *q == c;
            q += is_range ? 2 : 0;
        }
        return is_in != is_inverted;
    }
    return *p == '.' || *p == c;
}

static bool match_here(struct matcher *m, const char *p, const char *text) {
    while (p < m->end) {
        if (*p == '$' && p + 1 == m->end)
            return !*text;
        const char *after = element_end(m, p);
        const char repeat = after < m->end ? *after : '\0';
        if (repeat == '*' || repeat == '+' || repeat == '?') {
            const char *t = text;
            const size_t least = repeat == '+', most = repeat == '?' ? 1 : SIZE_MAX;
            while ((size_t)(t - text) < most && fits(p, after, *t))
                t++;
            for (size_t count = (size_t)(t - text) + 1; count-- > least;)
                if (++m->steps > MATCH_STEPS_MAX || match_here(m, after + 1, text + count))
                    return m->steps <= MATCH_STEPS_MAX;
            return false;
        }
        if (++m->steps > MATCH_STEPS_MAX || !fits(p, after, *text))
            return false;
        p = after;
        text++;
    }
    return true;
}

bool text_matches(const char *pattern, const char *text) {
    struct matcher m = {0};
    for (const char *p = pattern;; p = m.end + 1) {
        for (m.end = p; *m.end && *m.end != '|'; m.end++)
            m.end += *m.end == '\\' && m.end[1];
        for (const char *t = text;; t++) {
            const bool is_anchored = *p == '^';
            if (match_here(&m, p + is_anchored, t))
                return true;
            if (!*t || is_anchored || m.steps > MATCH_STEPS_MAX)
                break;
        }
        if (!*m.end)
            return false;
    }
}

static bool has_name(const char *list, const char *name, size_t length) {
    while (*list) {
        const size_t one = strcspn(list, ",");
        if (one == length && !memcmp(list, name, length))
            return true;
        list += one + (list[one] == ',');
    }
    return false;
}

bool text_category_matches(const char *wanted, const char *category) {
    const bool is_excluded = *wanted == '-';
    bool is_found = false;
    if (!*wanted)
        return true;
    for (const char *at = wanted + is_excluded; *at;) {
        const size_t length = strcspn(at, ",");
        is_found |= has_name(category, at, length);
        at += length + (at[length] == ',');
    }
    return is_found != is_excluded;
}
