/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/work_names.h"

#include "nodes/protocol.h"

#include <stdlib.h>
#include <string.h>

static struct instance_work name_entry(uint32_t number, const struct planned_instance *planned) {
    struct instance_work entry = {.instance = number, .module = planned->variant->number};
    memcpy(entry.name, planned->name, sizeof entry.name);
    return entry;
}

void work_names_take(struct work_names *names, const struct frame_plan *plan) {
    work_names_finish(names);
    names->entries = memory_get(plan->instance_count + plan->light_count, sizeof *names->entries);
    for (size_t i = 0; i < plan->instance_count; i++)
        names->entries[names->count++] = name_entry((uint32_t)i + 1, &plan->instances[i]);
    for (size_t l = 0; l < plan->light_count; l++)
        names->entries[names->count++] =
            name_entry(SHADING_WORK_SHARED + 1 + (uint32_t)l, &plan->lights[l]);
}

void work_names_copy(struct work_names *names, const struct work_names *before) {
    work_names_finish(names);
    if (!before->count)
        return;
    names->entries = memory_get(before->count, sizeof *names->entries);
    memcpy(names->entries, before->entries, before->count * sizeof *names->entries);
    names->count = before->count;
}

void work_names_apply(const struct work_names *names, struct work_record *record) {
    if (!record->is_kept)
        return;
    for (uint32_t i = 0; i < names->count; i++) {
        struct instance_work *entry = work_record_entry(record, names->entries[i].instance);
        memcpy(entry->name, names->entries[i].name, sizeof entry->name);
        entry->module = names->entries[i].module;
    }
    work_record_sort(record);
}

void work_names_finish(struct work_names *names) {
    free(names->entries);
    *names = (struct work_names){0};
}
