/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/region.h"
#include "netsim/region_select.h"

#include <stdlib.h>
#include <string.h>

/* Composition in two steps: walk both lists of runs once into segments (only a, only b, both), then
 * go through plane after plane with straight copies and selects, which the compiler turns into
 * vector code. */

struct segment {
    uint32_t a, b; /* index of the first entry in each side's planes */
    uint32_t out;  /* index of the first entry in the result */
    uint32_t count;
    enum { ONLY_A, ONLY_B, BOTH } from;
};

struct plan {
    struct segment *segments;
    uint32_t segment_count;
    struct region_run *runs;
    uint32_t run_count;
    uint32_t sample_count;
};

static void plan_add(struct plan *plan, uint32_t first, uint32_t count, int from, uint32_t *at_a,
                     uint32_t *at_b) {
    plan->segments[plan->segment_count++] =
        (struct segment){*at_a, *at_b, plan->sample_count, count, from};
    if (from != ONLY_B)
        *at_a += count;
    if (from != ONLY_A)
        *at_b += count;
    struct region_run *last = plan->run_count ? &plan->runs[plan->run_count - 1] : NULL;
    if (last && last->first + last->count == first)
        last->count += count;
    else
        plan->runs[plan->run_count++] = (struct region_run){first, count};
    plan->sample_count += count;
}

/* Each step ends at least one run of either side or a gap between them: at most 2 * (runs + runs)
 * segments. */
static struct plan plan_runs(const struct region_view *a, const struct region_view *b) {
    size_t most = 2 * ((size_t)a->head.run_count + b->head.run_count) + 1;
    struct plan plan = {.segments = malloc(most * sizeof *plan.segments),
                        .runs = malloc(most * sizeof *plan.runs)};
    if (!plan.segments || !plan.runs)
        abort();
    uint32_t i = 0, j = 0, at_a = 0, at_b = 0;
    uint32_t done_a = 0, done_b = 0; /* samples of the current runs already planned */
    while (i < a->head.run_count || j < b->head.run_count) {
        const uint32_t none = UINT32_MAX;
        uint32_t first_a = i < a->head.run_count ? a->runs[i].first + done_a : none;
        uint32_t first_b = j < b->head.run_count ? b->runs[j].first + done_b : none;
        uint32_t left_a = first_a == none ? 0 : a->runs[i].count - done_a;
        uint32_t left_b = first_b == none ? 0 : b->runs[j].count - done_b;
        uint32_t count;
        if (first_a == first_b) {
            count = left_a < left_b ? left_a : left_b;
            plan_add(&plan, first_a, count, BOTH, &at_a, &at_b);
            done_a += count;
            done_b += count;
        } else if (first_a < first_b) {
            count = first_b - first_a < left_a ? first_b - first_a : left_a;
            plan_add(&plan, first_a, count, ONLY_A, &at_a, &at_b);
            done_a += count;
        } else {
            count = first_a - first_b < left_b ? first_a - first_b : left_b;
            plan_add(&plan, first_b, count, ONLY_B, &at_a, &at_b);
            done_b += count;
        }
        if (i < a->head.run_count && done_a == a->runs[i].count)
            i++, done_a = 0;
        if (j < b->head.run_count && done_b == b->runs[j].count)
            j++, done_b = 0;
    }
    return plan;
}

static void select_segment(const struct region_view *a, const struct region_view *b,
                           const struct segment *s, uint32_t *mask) {
    region_select_nearer(a->depth + s->a, a->primitive + s->a, b->depth + s->b, b->primitive + s->b,
                         s->count, mask + s->out);
}

static void blend_words(uint32_t *restrict out, const uint32_t *restrict a,
                        const uint32_t *restrict b, const uint32_t *restrict mask, uint32_t count) {
    for (uint32_t k = 0; k < count; k++)
        out[k] = (a[k] & ~mask[k]) | (b[k] & mask[k]);
}

static void blend_halfwords(uint16_t *restrict out, const uint16_t *restrict a,
                            const uint16_t *restrict b, const uint32_t *restrict mask,
                            uint32_t count) {
    for (uint32_t k = 0; k < count; k++)
        out[k] = (uint16_t)((a[k] & ~mask[k]) | (b[k] & mask[k]));
}

/* One 4-byte plane; a side without the plane counts as zeros. */
static void compose_plane(const struct plan *plan, const uint32_t *mask, void *out_plane,
                          const void *plane_a, const void *plane_b, const uint32_t *zeros) {
    uint32_t *out = out_plane;
    const uint32_t *a = plane_a, *b = plane_b;
    for (uint32_t i = 0; i < plan->segment_count; i++) {
        const struct segment *s = &plan->segments[i];
        const uint32_t *from_a = a ? a + s->a : zeros, *from_b = b ? b + s->b : zeros;
        if (s->from == BOTH)
            blend_words(out + s->out, from_a, from_b, mask + s->out, s->count);
        else
            memcpy(out + s->out, s->from == ONLY_A ? from_a : from_b, (size_t)s->count * 4);
    }
}

static void compose_shader_plane(const struct plan *plan, const uint32_t *mask, uint16_t *out,
                                 const uint16_t *a, const uint16_t *b) {
    for (uint32_t i = 0; i < plan->segment_count; i++) {
        const struct segment *s = &plan->segments[i];
        if (s->from == BOTH)
            blend_halfwords(out + s->out, a + s->a, b + s->b, mask + s->out, s->count);
        else
            memcpy(out + s->out, s->from == ONLY_A ? a + s->a : b + s->b, (size_t)s->count * 2);
    }
}

/* Both lists ascend by node. */
static void merge_work(struct region_draft *draft, const struct region_view *a,
                       const struct region_view *b) {
    uint32_t i = 0, j = 0;
    for (uint32_t w = 0; w < draft->head.work_count; w++) {
        const bool from_a = j == b->head.work_count ||
                            (i < a->head.work_count && a->work[i].node < b->work[j].node);
        draft->work[w] = from_a ? a->work[i++] : b->work[j++];
    }
}

struct message *region_compose(const struct region_view *a, const struct region_view *b,
                               uint32_t frame, uint32_t region, uint32_t sender) {
    struct plan plan = plan_runs(a, b);
    const uint32_t slots = a->head.slots > b->head.slots ? a->head.slots : b->head.slots;
    const uint32_t longest =
        a->head.longest_map > b->head.longest_map ? a->head.longest_map : b->head.longest_map;
    struct region_draft draft = region_draft_create((struct region_head){
        .run_count = plan.run_count,
        .sample_count = plan.sample_count,
        .slots = slots,
        .longest_map = longest,
        .work_count = a->head.work_count + b->head.work_count,
        .nan_depths = a->head.nan_depths + b->head.nan_depths,
        .rays = a->head.rays + b->head.rays,
        .composed = a->head.composed + b->head.composed + plan.sample_count,
    });
    merge_work(&draft, a, b);
    memcpy(draft.runs, plan.runs, plan.run_count * sizeof *plan.runs);

    uint32_t *mask = calloc((size_t)plan.sample_count + 1, 4);
    uint32_t *zeros = calloc((size_t)plan.sample_count + 1, 4);
    if (!mask || !zeros)
        abort();
    for (uint32_t i = 0; i < plan.segment_count; i++)
        if (plan.segments[i].from == BOTH)
            select_segment(a, b, &plan.segments[i], mask);
    compose_plane(&plan, mask, draft.depth, a->depth, b->depth, zeros);
    compose_plane(&plan, mask, draft.primitive, a->primitive, b->primitive, zeros);
    compose_shader_plane(&plan, mask, draft.shader, a->shader, b->shader);
    for (uint32_t p = 0; p < slots; p++)
        compose_plane(&plan, mask, draft.slots + (size_t)p * plan.sample_count,
                      p < a->head.slots ? a->slots + (size_t)p * a->head.sample_count : NULL,
                      p < b->head.slots ? b->slots + (size_t)p * b->head.sample_count : NULL,
                      zeros);
    free(mask);
    free(zeros);
    free(plan.segments);
    free(plan.runs);
    return region_seal(&draft, frame, region, sender);
}
