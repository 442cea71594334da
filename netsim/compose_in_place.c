/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/region.h"
#include "netsim/region_select.h"

#include <stdlib.h>
#include <string.h>

/* Composition where one side covers all that the other does, which is the rule behind a node that
 * has the background: the samples of the other side are visited run by run. */

/* A run of the other side, and where its first sample is in the planes of either. */
struct visit {
    uint32_t first, other, count;
};

/* Every run of `other` inside a run of `view`: where they are; false when one is not. */
static bool find_visits(const struct region_view *view, const struct region_view *other,
                        struct visit *visits) {
    uint32_t at = 0, entry = 0, other_entry = 0;
    for (uint32_t i = 0; i < other->head.run_count; i++) {
        const struct region_run run = other->runs[i];
        while (at < view->head.run_count &&
               view->runs[at].first + view->runs[at].count <= run.first)
            entry += view->runs[at++].count;
        if (at == view->head.run_count || view->runs[at].first > run.first ||
            view->runs[at].first + view->runs[at].count < run.first + run.count)
            return false;
        visits[i] =
            (struct visit){entry + (run.first - view->runs[at].first), other_entry, run.count};
        other_entry += run.count;
    }
    return true;
}

/* Whether any sample of the other side is in front there; `mask` says which. */
static bool select_visit(const struct region_view *view, const struct region_view *other,
                         struct visit v, uint32_t *mask) {
    return region_select_nearer(view->depth + v.first, view->primitive + v.first,
                                other->depth + v.other, other->primitive + v.other, v.count, mask);
}

/* One 4-byte plane; `from` NULL counts as zeros. */
static void put_words(void *restrict into, const void *restrict from, const uint32_t *restrict mask,
                      uint32_t count) {
    uint32_t *out = into;
    const uint32_t *in = from;
    if (in)
        for (uint32_t k = 0; k < count; k++)
            out[k] = (out[k] & ~mask[k]) | (in[k] & mask[k]);
    else
        for (uint32_t k = 0; k < count; k++)
            out[k] &= ~mask[k];
}

static void put_halfwords(uint16_t *restrict out, const uint16_t *restrict in,
                          const uint32_t *restrict mask, uint32_t count) {
    for (uint32_t k = 0; k < count; k++)
        out[k] = (uint16_t)((out[k] & ~mask[k]) | (in[k] & mask[k]));
}

static void put_samples(const struct region_view *view, const struct region_view *other,
                        struct visit visit, const uint32_t *mask) {
    /* the planes are those of the caller's message */
    put_words((void *)(view->depth + visit.first), other->depth + visit.other, mask, visit.count);
    put_words((void *)(view->primitive + visit.first), other->primitive + visit.other, mask,
              visit.count);
    put_halfwords((uint16_t *)(view->shader + visit.first), other->shader + visit.other, mask,
                  visit.count);
    for (uint32_t p = 0; p < view->head.slots; p++)
        put_words((void *)(view->slots + (size_t)p * view->head.sample_count + visit.first),
                  p < other->head.slots
                      ? other->slots + (size_t)p * other->head.sample_count + visit.other
                      : NULL,
                  mask, visit.count);
}

/* Joins the other side's entries, from the last on, so that none is overwritten before it is read.
 */
static void merge_work(struct region_work *work, uint32_t count, const struct region_work *other,
                       uint32_t other_count) {
    uint32_t left = count, other_left = other_count;
    for (uint32_t at = count + other_count; other_left; at--) {
        const bool from_other = !left || other[other_left - 1].node >= work[left - 1].node;
        work[at - 1] = from_other ? other[--other_left] : work[--left];
    }
}

bool region_compose_in_place(struct message *message, const struct region_view *view,
                             const struct region_view *other, uint32_t frame, uint32_t region,
                             uint32_t sender) {
    const size_t growth = other->head.work_count * sizeof *other->work;
    if (other->head.slots > view->head.slots || message->capacity - message->length < growth ||
        !message_is_exclusive(message))
        return false;
    struct visit *visits = malloc((other->head.run_count + 1) * sizeof *visits);
    uint32_t *mask = malloc(((size_t)other->head.sample_count + 1) * sizeof *mask);
    if (!visits || !mask)
        abort();
    const bool fits = find_visits(view, other, visits);
    for (uint32_t i = 0; fits && i < other->head.run_count; i++)
        if (select_visit(view, other, visits[i], mask))
            put_samples(view, other, visits[i], mask);
    if (fits) {
        struct region_head head = view->head;
        merge_work((struct region_work *)view->work, head.work_count, other->work,
                   other->head.work_count);
        head.work_count += other->head.work_count;
        head.longest_map =
            other->head.longest_map > head.longest_map ? other->head.longest_map : head.longest_map;
        head.nan_depths += other->head.nan_depths;
        head.rays += other->head.rays;
        head.composed += other->head.composed + head.sample_count;
        memcpy(message->bytes + WIRE_HEADER_BYTES, &head, sizeof head);
        message->length += growth;
        struct region_draft draft = {.message = message, .head = head};
        region_seal(&draft, frame, region, sender);
    }
    free(visits);
    free(mask);
    return fits;
}
