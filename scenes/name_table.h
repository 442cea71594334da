/* SPDX-License-Identifier: Apache-2.0 */
#ifndef NAME_TABLE_H
#define NAME_TABLE_H

#include "base/arena.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Names to pointers, by hashing. Keys are not copied. Zero-initialised is empty. */
struct name_table_entry {
    const char *name; /* NULL: free */
    uint64_t hash;
    void *value;
};

struct name_table {
    struct name_table_entry *entries;
    size_t count, capacity;
};

/* The value of a name; NULL when it is not there. */
void *name_table_find(const struct name_table *table, const char *name);
/* `name` must outlive the table. A NULL value forgets the name for name_table_find. */
void name_table_set(struct name_table *table, const char *name, void *value);
void name_table_finish(struct name_table *table);

/* One copy of each string, in `arena`; equal strings give equal pointers. */
const char *name_table_intern(struct name_table *table, struct arena *arena, const char *text,
                              size_t length);

#endif
