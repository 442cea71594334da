/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/region.h"

#include <string.h>

/* What of a region lies in a span of its samples. */
struct cut {
    uint32_t first_run, run_count;
    uint32_t first_entry, sample_count; /* in the planes */
};

static struct cut cut_runs(const struct region_view *view, uint32_t first, uint32_t end) {
    struct cut cut = {0};
    uint32_t entry = 0;
    for (uint32_t i = 0; i < view->head.run_count; i++) {
        const struct region_run run = view->runs[i];
        const uint32_t from = run.first > first ? run.first : first;
        const uint32_t to = run.first + run.count < end ? run.first + run.count : end;
        if (from < to) {
            if (!cut.run_count) {
                cut.first_run = i;
                cut.first_entry = entry + (from - run.first);
            }
            cut.run_count++;
            cut.sample_count += to - from;
        }
        entry += run.count;
    }
    return cut;
}

struct message *region_extract(const struct region_view *view, uint32_t first, uint32_t end,
                               bool with_work, uint32_t frame, uint32_t region, uint32_t sender) {
    const struct cut cut = cut_runs(view, first, end);
    struct region_head head = view->head;
    head.run_count = cut.run_count;
    head.sample_count = cut.sample_count;
    if (!with_work)
        head.work_count = head.nan_depths = head.rays = head.composed = 0;
    struct region_draft draft = region_draft_create(head);
    memcpy(draft.work, view->work, head.work_count * sizeof *view->work);
    for (uint32_t i = 0; i < cut.run_count; i++) {
        const struct region_run run = view->runs[cut.first_run + i];
        const uint32_t from = run.first > first ? run.first : first;
        const uint32_t to = run.first + run.count < end ? run.first + run.count : end;
        draft.runs[i] = (struct region_run){from, to - from};
    }
    memcpy(draft.depth, view->depth + cut.first_entry, cut.sample_count * sizeof *view->depth);
    memcpy(draft.primitive, view->primitive + cut.first_entry,
           cut.sample_count * sizeof *view->primitive);
    memcpy(draft.shader, view->shader + cut.first_entry, cut.sample_count * sizeof *view->shader);
    for (size_t p = 0; p < head.slots; p++)
        memcpy(draft.slots + p * cut.sample_count,
               view->slots + p * view->head.sample_count + cut.first_entry,
               cut.sample_count * sizeof *view->slots);
    return region_seal(&draft, frame, region, sender);
}
