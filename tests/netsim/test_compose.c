/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/test_harness.h"

#include "base/rng.h"
#include "netsim/region.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 512, SLOTS_MAX = 5 };

/* A region as plain arrays: the independent way to compose. */
struct dense {
    bool covered[SAMPLES];
    float depth[SAMPLES], slots[SLOTS_MAX][SAMPLES];
    uint32_t primitive[SAMPLES];
    uint16_t shader[SAMPLES];
    uint32_t slot_count;
};

static struct dense *random_dense(struct rng *rng, uint32_t first_primitive) {
    struct dense *d = calloc(1, sizeof *d);
    d->slot_count = (uint32_t)rng_below(rng, SLOTS_MAX + 1);
    const uint64_t density = rng_below(rng, 5); /* none to all, in stretches of random length */
    bool covered = false;
    for (int i = 0; i < SAMPLES; i++) {
        if (rng_below(rng, 9) == 0)
            covered = rng_below(rng, 4) < density;
        d->covered[i] = covered;
        if (!covered)
            continue;
        d->depth[i] = (float)rng_below(rng, 4); /* few values: many ties */
        d->primitive[i] = first_primitive + (uint32_t)rng_below(rng, 3) * 10;
        d->shader[i] = (uint16_t)(d->primitive[i] + 1);
        for (uint32_t p = 0; p < d->slot_count; p++)
            d->slots[p][i] = (float)(d->primitive[i] * 8 + p);
    }
    return d;
}

static struct message *encode(const struct dense *d, uint32_t node) {
    struct region_head head = {
        .slots = d->slot_count, .longest_map = d->slot_count, .work_count = 1};
    for (int i = 0; i < SAMPLES; i++) {
        head.sample_count += d->covered[i];
        head.run_count += d->covered[i] && (i == 0 || !d->covered[i - 1]);
    }
    struct region_draft draft = region_draft_create(head);
    uint32_t at = 0, run = 0;
    draft.work[0] = (struct region_work){node, node + 1};
    for (uint32_t i = 0; i < SAMPLES; i++) {
        if (!d->covered[i])
            continue;
        if (i == 0 || !d->covered[i - 1])
            draft.runs[run++] = (struct region_run){i, 0};
        draft.runs[run - 1].count++;
        draft.depth[at] = d->depth[i];
        draft.primitive[at] = d->primitive[i];
        draft.shader[at] = d->shader[i];
        for (uint32_t p = 0; p < d->slot_count; p++)
            draft.slots[(size_t)p * head.sample_count + at] = d->slots[p][i];
        at++;
    }
    return region_seal(&draft, 1, 2, 3);
}

static void compose_dense(struct dense *into, const struct dense *other) {
    for (int i = 0; i < SAMPLES; i++) {
        const bool wins =
            other->covered[i] &&
            (!into->covered[i] || other->depth[i] < into->depth[i] ||
             (other->depth[i] == into->depth[i] && other->primitive[i] < into->primitive[i]));
        if (!wins)
            continue;
        into->covered[i] = true;
        into->depth[i] = other->depth[i];
        into->primitive[i] = other->primitive[i];
        into->shader[i] = other->shader[i];
        for (uint32_t p = 0; p < SLOTS_MAX; p++)
            into->slots[p][i] = p < other->slot_count ? other->slots[p][i] : 0;
    }
    into->slot_count = into->slot_count > other->slot_count ? into->slot_count : other->slot_count;
}

static void assert_same(const struct message *message, const struct dense *d) {
    struct region_view view;
    struct status status = {0};
    if (!region_open(message->bytes, message->length, SAMPLES, &view, &status))
        fail_msg("%s", status.message);
    assert_int_equal(view.head.slots, d->slot_count);
    uint32_t at = 0;
    bool covered[SAMPLES] = {false};
    for (uint32_t r = 0; r < view.head.run_count; r++)
        for (uint32_t k = 0; k < view.runs[r].count; k++, at++) {
            const uint32_t i = view.runs[r].first + k;
            covered[i] = true;
            assert_true(view.depth[at] == d->depth[i]);
            assert_int_equal(view.primitive[at], d->primitive[i]);
            assert_int_equal(view.shader[at], d->shader[i]);
            for (uint32_t p = 0; p < view.head.slots; p++)
                assert_true(view.slots[(size_t)p * view.head.sample_count + at] == d->slots[p][i]);
        }
    assert_memory_equal(covered, d->covered, sizeof covered);
}

static struct message *compose(const struct message *a, const struct message *b) {
    struct region_view va, vb;
    assert_true(region_open(a->bytes, a->length, SAMPLES, &va, NULL));
    assert_true(region_open(b->bytes, b->length, SAMPLES, &vb, NULL));
    return region_compose(&va, &vb, 1, 2, 3);
}

/* Where it can be done, the message itself becomes what composition would have made. */
static void composition_in_place_makes_the_same_bytes(void **state) {
    (void)state;
    struct rng rng = {8};
    int done = 0, with_fewer_slots = 0, refused = 0;
    for (int round = 0; round < 6000; round++) {
        struct dense *a = random_dense(&rng, 0), *b = random_dense(&rng, 1);
        for (int i = 0; round % 3 && i < SAMPLES; i++) /* else it is hardly ever inside */
            b->covered[i] &= a->covered[i];
        struct message *into = encode(a, round % 2 ? 1 : 0), *other = encode(b, round % 2 ? 0 : 1),
                       *both = compose(into, other);
        const bool is_held = round % 7 == 0;
        struct message *before = message_create(into->length);
        memcpy(before->bytes, into->bytes, into->length);
        if (is_held)
            message_hold(into);
        struct region_view va, vb;
        bool is_inside = true;
        for (int i = 0; i < SAMPLES; i++)
            is_inside &= a->covered[i] || !b->covered[i];
        assert_true(region_open(into->bytes, into->length, SAMPLES, &va, NULL));
        assert_true(region_open(other->bytes, other->length, SAMPLES, &vb, NULL));
        const bool can = is_inside && vb.head.slots <= va.head.slots && !is_held;
        const bool fewer_slots = vb.head.slots < va.head.slots && vb.head.sample_count;
        assert_int_equal(region_compose_in_place(into, &va, &vb, 1, 2, 3), can);
        const struct message *expected = can ? both : before;
        assert_int_equal(into->length, expected->length);
        assert_memory_equal(into->bytes, expected->bytes, into->length);
        done += can;
        refused += !can;
        with_fewer_slots += can && fewer_slots;
        if (is_held)
            message_release(into);
        struct message *all[] = {into, other, both, before};
        for (size_t i = 0; i < sizeof all / sizeof *all; i++)
            message_release(all[i]);
        free(a);
        free(b);
    }
    assert_true(done > 1000 && refused > 1000 && with_fewer_slots > 300);
}

/* A message grows until its room for work entries is used up. */
static void there_is_room_for_many_nodes_and_then_none(void **state) {
    (void)state;
    struct dense *d = calloc(1, sizeof *d);
    for (int i = 0; i < SAMPLES; i++)
        d->covered[i] = true;
    struct message *into = encode(d, 0);
    uint32_t node = 1;
    for (;; node++) {
        struct message *other = encode(d, node), *copy = NULL;
        struct region_view va, vb;
        assert_true(region_open(into->bytes, into->length, SAMPLES, &va, NULL));
        assert_true(region_open(other->bytes, other->length, SAMPLES, &vb, NULL));
        copy = region_compose(&va, &vb, 1, 2, 3);
        const bool fits = region_compose_in_place(into, &va, &vb, 1, 2, 3);
        if (fits)
            assert_memory_equal(into->bytes, copy->bytes, copy->length);
        message_release(other);
        message_release(copy);
        if (!fits)
            break;
    }
    assert_in_range(node, 16, 1000);
    message_release(into);
    free(d);
}

static void composition_equals_the_plain_way_in_any_order(void **state) {
    (void)state;
    struct rng rng = {5};
    for (int round = 0; round < 3000; round++) {
        struct dense *d[3];
        struct message *m[3];
        for (uint32_t i = 0; i < 3; i++) {
            d[i] = random_dense(&rng, i); /* primitive numbers differ between nodes */
            m[i] = encode(d[i], i);
        }
        struct message *ab = compose(m[0], m[1]), *ba = compose(m[1], m[0]),
                       *ab_c = compose(ab, m[2]), *bc = compose(m[1], m[2]),
                       *a_bc = compose(m[0], bc);
        compose_dense(d[0], d[1]);
        assert_same(ab, d[0]);
        assert_same(ba, d[0]);
        compose_dense(d[0], d[2]);
        assert_same(ab_c, d[0]);
        assert_same(a_bc, d[0]);
        struct region_view view;
        assert_true(region_open(ab_c->bytes, ab_c->length, SAMPLES, &view, NULL));
        assert_int_equal(view.head.work_count, 3);
        for (uint32_t i = 0; i < 3; i++)
            assert_int_equal(view.work[i].node, i);
        struct message *all[] = {ab, ba, ab_c, bc, a_bc, m[0], m[1], m[2]};
        for (size_t i = 0; i < sizeof all / sizeof *all; i++)
            message_release(all[i]);
        for (int i = 0; i < 3; i++)
            free(d[i]);
    }
}

/* Cuts a region into parts at random and composes them again: every byte as before. */
static void parts_of_a_region_compose_to_the_region(void **state) {
    (void)state;
    struct rng rng = {6};
    for (int round = 0; round < 2000; round++) {
        struct dense *d = random_dense(&rng, 1);
        struct message *whole = encode(d, 7), *sum = NULL;
        struct region_view view;
        const uint32_t carrier = (uint32_t)rng_below(&rng, 4);
        uint32_t first = 0;
        assert_true(region_open(whole->bytes, whole->length, SAMPLES, &view, NULL));
        for (uint32_t part = 0; part < 4; part++) {
            const uint32_t end =
                part == 3 ? SAMPLES : first + (uint32_t)rng_below(&rng, SAMPLES - first + 1);
            struct message *cut = region_extract(&view, first, end, part == carrier, 1, 2, 3);
            struct message *both = sum ? compose(sum, cut) : message_hold(cut);
            message_release(sum);
            message_release(cut);
            sum = both;
            first = end;
        }
        assert_same(sum, d);
        struct region_view joined;
        assert_true(region_open(sum->bytes, sum->length, SAMPLES, &joined, NULL));
        assert_int_equal(joined.head.work_count, 1);
        assert_int_equal(joined.work[0].triangles, 8);
        assert_int_equal(joined.head.longest_map, view.head.longest_map);
        message_release(sum);
        message_release(whole);
        free(d);
    }
}

static void runs_are_merged_where_regions_touch(void **state) {
    (void)state;
    struct dense *a = calloc(1, sizeof *a), *b = calloc(1, sizeof *b);
    for (int i = 0; i < SAMPLES; i++)
        (i < 100 ? a : b)->covered[i] = true;
    struct message *ma = encode(a, 0), *mb = encode(b, 1), *both = compose(mb, ma);
    struct region_view view;
    assert_true(region_open(both->bytes, both->length, SAMPLES, &view, NULL));
    assert_int_equal(view.head.run_count, 1);
    assert_int_equal(view.head.sample_count, SAMPLES);
    message_release(ma);
    message_release(mb);
    message_release(both);
    free(a);
    free(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(composition_equals_the_plain_way_in_any_order),
        cmocka_unit_test(composition_in_place_makes_the_same_bytes),
        cmocka_unit_test(there_is_room_for_many_nodes_and_then_none),
        cmocka_unit_test(parts_of_a_region_compose_to_the_region),
        cmocka_unit_test(runs_are_merged_where_regions_touch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
