/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_TEXTS_H
#define SHADER_TEXTS_H

#include "base/arena.h"
#include "shaders/simd/shader_module.h"

#include <stdbool.h>

/* The texts behind the identity numbers of strings, for shaders that put strings together at run
 * time. What does not fit (texts of more than 4 KiB, 1 MiB in all) becomes the empty string. */
struct text_table {
    struct shader_texts texts; /* first: what generated code sees */
    struct arena arena;
    struct text_entry {
        int32_t identity;
        const char *text;
        struct text_entry *next;
    } * buckets[256];
};

/* With the strings written out in the module, and `count` others as texts one behind the other,
 * each ended by a NUL. The module must outlive the table. */
void text_table_init(struct text_table *table, const struct shader_module *module,
                     const char *others, size_t bytes);
void text_table_finish(struct text_table *table);
/* "" when no such string was seen. */
const char *text_table_find(const struct text_table *table, int32_t identity);
int32_t text_table_add(struct text_table *table, const char *text);

/* Whether `pattern` is found in `text`: a regular expression of . [] * + ? ^ $ | and \ without
 * groups. Gives up, and says no, after a million steps. */
bool text_matches(const char *pattern, const char *text);
/* Whether a light of this category ("a,b" is of both) is wanted by illuminance(wanted): one of
 * the names in `wanted`, or, where that begins with '-', none of them. */
bool text_category_matches(const char *wanted, const char *category);

#endif
