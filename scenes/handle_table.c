/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_reader.h"

#include <stdlib.h>

void *handle_table_find(const struct handle_table *table, const char *key) {
    size_t at = (size_t)name_table_find(&table->names, key);
    return at ? table->handles[at - 1].value : NULL;
}

void handle_table_add(struct handle_table *table, const char *key, void *value, int scope) {
    table->handles =
        memory_grow(table->handles, &table->capacity, table->count + 1, sizeof *table->handles);
    table->handles[table->count++] =
        (struct handle){key, value, (size_t)name_table_find(&table->names, key), scope};
    name_table_set(&table->names, key, (void *)table->count);
}

void handle_table_leave(struct handle_table *table, int scope) {
    while (table->count && table->handles[table->count - 1].scope > scope) {
        const struct handle *handle = &table->handles[--table->count];
        name_table_set(&table->names, handle->key, (void *)handle->hidden);
        table->release(handle->value);
    }
}

void handle_table_finish(struct handle_table *table) {
    handle_table_leave(table, -1);
    name_table_finish(&table->names);
    free(table->handles);
    *table = (struct handle_table){0};
}
