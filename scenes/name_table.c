/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/name_table.h"

#include "base/hash.h"
#include "base/status.h"

#include <stdlib.h>
#include <string.h>

/* The entry of this name, or the free one where it belongs; `name` need not end in NUL. */
static struct name_table_entry *table_slot(const struct name_table *table, const char *name,
                                           size_t length, uint64_t hash) {
    size_t mask = table->capacity - 1, i = hash & mask;
    while (table->entries[i].name &&
           (table->entries[i].hash != hash || strncmp(table->entries[i].name, name, length) != 0 ||
            table->entries[i].name[length] != '\0'))
        i = (i + 1) & mask;
    return &table->entries[i];
}

static void table_make_room(struct name_table *table) {
    if ((table->count + 1) * 2 <= table->capacity)
        return;
    struct name_table grown = {.count = table->count,
                               .capacity = table->capacity ? table->capacity * 2 : 64};
    grown.entries = memory_get(grown.capacity, sizeof *grown.entries);
    for (size_t i = 0; i < table->capacity; i++) {
        const struct name_table_entry *entry = &table->entries[i];
        if (entry->name)
            *table_slot(&grown, entry->name, strlen(entry->name), entry->hash) = *entry;
    }
    free(table->entries);
    *table = grown;
}

void *name_table_find(const struct name_table *table, const char *name) {
    if (!table->capacity)
        return NULL;
    size_t length = strlen(name);
    return table_slot(table, name, length, hash_bytes(name, length, 0))->value;
}

void name_table_set(struct name_table *table, const char *name, void *value) {
    size_t length = strlen(name);
    uint64_t hash = hash_bytes(name, length, 0);
    table_make_room(table);
    struct name_table_entry *entry = table_slot(table, name, length, hash);
    if (!entry->name)
        table->count++;
    *entry = (struct name_table_entry){name, hash, value};
}

void name_table_finish(struct name_table *table) {
    free(table->entries);
    *table = (struct name_table){0};
}

const char *name_table_intern(struct name_table *table, struct arena *arena, const char *text,
                              size_t length) {
    uint64_t hash = hash_bytes(text, length, 0);
    table_make_room(table);
    struct name_table_entry *entry = table_slot(table, text, length, hash);
    if (!entry->name) {
        char *copy = arena_copy_string(arena, text, length);
        *entry = (struct name_table_entry){copy, hash, copy};
        table->count++;
    }
    return entry->name;
}
