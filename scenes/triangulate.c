/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/triangulate.h"

#include <math.h>
#include <stdlib.h>

/* A ring of corners, linked both ways; bridges to holes put a corner into it twice. */
struct ring_node {
    double x, y;
    uint32_t corner;
    int previous, next;
};

struct ring {
    struct ring_node *nodes;
    int count;
};

/* Twice the signed area of a triangle. */
static double turn(const struct ring_node *a, const struct ring_node *b,
                   const struct ring_node *c) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static bool is_same_place(const struct ring_node *a, const struct ring_node *b) {
    return a->x == b->x && a->y == b->y;
}

static double loop_area(const double *points, int count) {
    double area = 0;
    for (int i = 0; i < count; i++) {
        const double *p = points + 2 * i, *q = points + 2 * ((i + 1) % count);
        area += (p[0] - points[0]) * (q[1] - points[1]) - (q[0] - points[0]) * (p[1] - points[1]);
    }
    return area;
}

/* Whether a fan from corner 0 covers the loop: every corner and every triangle of the fan turns the
 * same way. */
static bool is_convex(const double *points, int count) {
    double sign = loop_area(points, count) < 0 ? -1 : 1;
    for (int i = 0; i < count; i++) {
        const double *a = points + 2 * i, *b = points + 2 * ((i + 1) % count),
                     *c = points + 2 * ((i + 2) % count);
        if (sign * ((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])) < 0)
            return false;
        if (i + 2 < count && sign * ((b[0] - points[0]) * (c[1] - points[1]) -
                                     (b[1] - points[1]) * (c[0] - points[0])) <
                                 0)
            return false;
    }
    return true;
}

/* Adds a loop as a ring of its own, counter-clockwise or clockwise; returns a node of it. */
static int ring_add_loop(struct ring *ring, const double *points, int first, int count,
                         bool is_reversed) {
    int start = ring->count;
    for (int i = 0; i < count; i++) {
        int corner = first + (is_reversed ? count - 1 - i : i);
        ring->nodes[start + i] = (struct ring_node){.x = points[2 * corner],
                                                    .y = points[2 * corner + 1],
                                                    .corner = (uint32_t)corner,
                                                    .previous = start + (i + count - 1) % count,
                                                    .next = start + (i + 1) % count};
    }
    ring->count += count;
    return start;
}

/* Whether p lies in triangle abc (counter-clockwise) or on its edge. */
static bool contains(const struct ring_node *a, const struct ring_node *b,
                     const struct ring_node *c, const struct ring_node *p) {
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

/* Whether the direction from a node to h starts within the ring. */
static bool looks_inside(const struct ring_node *nodes, int at, const struct ring_node *h) {
    const struct ring_node *p = &nodes[at], *before = &nodes[p->previous], *after = &nodes[p->next];
    if (turn(before, p, after) > 0)
        return turn(p, after, h) >= 0 && turn(before, p, h) >= 0;
    return turn(p, after, h) > 0 || turn(before, p, h) > 0;
}

/* The outline node that the hole's leftmost node sees: the ray to the left meets an edge; of the
 * edge's left end and the nodes within the triangle it makes with the ray, the one closest in
 * direction is visible. */
static int find_bridge(const struct ring *ring, int hole, int outline) {
    const struct ring_node *nodes = ring->nodes, *h = &nodes[hole];
    double best_x = -INFINITY;
    int bridge = -1, at = outline;
    do {
        const struct ring_node *p = &nodes[at], *q = &nodes[p->next];
        if (h->y <= p->y && h->y >= q->y && p->y != q->y) {
            double x = p->x + (h->y - p->y) * (q->x - p->x) / (q->y - p->y);
            if (x <= h->x && x > best_x) {
                best_x = x;
                bridge = p->x < q->x ? at : p->next;
                if (x == h->x)
                    return bridge; /* the hole touches the outline */
            }
        }
        at = p->next;
    } while (at != outline);
    if (bridge < 0)
        return -1;
    const struct ring_node edge = {.x = best_x, .y = h->y}, corner = nodes[bridge];
    double best_slope = INFINITY;
    int stop = bridge;
    at = bridge;
    do {
        const struct ring_node *p = &nodes[at];
        bool is_within =
            corner.y < h->y ? contains(&edge, &corner, h, p) : contains(h, &corner, &edge, p);
        if (p->x < h->x && p->x >= corner.x && is_within && looks_inside(nodes, at, h)) {
            double slope = fabs(h->y - p->y) / (h->x - p->x);
            if (slope < best_slope || (slope == best_slope && p->x > nodes[bridge].x)) {
                bridge = at;
                best_slope = slope;
            }
        }
        at = p->next;
    } while (at != stop);
    return bridge;
}

/* Joins two rings, or splits one, along the line between two nodes, which both become double. */
static void ring_join(struct ring *ring, int a, int b) {
    struct ring_node *nodes = ring->nodes;
    int a2 = ring->count++, b2 = ring->count++;
    int after = nodes[a].next, before = nodes[b].previous;
    nodes[a2] = nodes[a];
    nodes[b2] = nodes[b];
    nodes[a].next = b;
    nodes[b].previous = a;
    nodes[a2].next = after;
    nodes[after].previous = a2;
    nodes[b2].next = a2;
    nodes[a2].previous = b2;
    nodes[before].next = b2;
    nodes[b2].previous = before;
}

/* A hole and its leftmost node, for sorting from left to right. */
struct hole {
    double x, y;
    int node;
};

static int compare_holes(const void *a, const void *b) {
    const struct hole *p = a, *q = b;
    if (p->x != q->x)
        return p->x < q->x ? -1 : 1;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return p->node - q->node;
}

static struct hole find_leftmost(const struct ring *ring, int start) {
    struct hole hole = {ring->nodes[start].x, ring->nodes[start].y, start};
    for (int at = ring->nodes[start].next; at != start; at = ring->nodes[at].next) {
        const struct ring_node *p = &ring->nodes[at];
        if (p->x < hole.x || (p->x == hole.x && p->y < hole.y))
            hole = (struct hole){p->x, p->y, at};
    }
    return hole;
}

static int ring_add_holes(struct ring *ring, const double *points, const int *loop_corners,
                          int loop_count, int outline) {
    struct hole *holes = memory_get((size_t)loop_count, sizeof *holes);
    int first = loop_corners[0];
    for (int i = 1; i < loop_count; i++) {
        bool is_reversed = loop_area(points + 2 * (size_t)first, loop_corners[i]) > 0;
        holes[i - 1] =
            find_leftmost(ring, ring_add_loop(ring, points, first, loop_corners[i], is_reversed));
        first += loop_corners[i];
    }
    qsort(holes, (size_t)loop_count - 1, sizeof *holes, compare_holes);
    for (int i = 0; i < loop_count - 1; i++) {
        int bridge = find_bridge(ring, holes[i].node, outline);
        if (bridge >= 0)
            ring_join(ring, bridge, holes[i].node);
    }
    free(holes);
    return outline;
}

/* Whether the corner can be cut off: it turns left and no reflex corner lies in its triangle. */
static bool is_ear(const struct ring *ring, const int *reflex, int reflex_count, int at) {
    const struct ring_node *nodes = ring->nodes, *b = &nodes[at];
    const struct ring_node *a = &nodes[b->previous], *c = &nodes[b->next];
    if (!(turn(a, b, c) > 0))
        return false;
    double low_x = fmin(a->x, fmin(b->x, c->x)), high_x = fmax(a->x, fmax(b->x, c->x));
    double low_y = fmin(a->y, fmin(b->y, c->y)), high_y = fmax(a->y, fmax(b->y, c->y));
    for (int i = 0; i < reflex_count; i++) {
        const struct ring_node *p = &nodes[reflex[i]];
        if (p->next < 0 || p->x < low_x || p->x > high_x || p->y < low_y || p->y > high_y)
            continue;
        if (p == a || p == b || p == c)
            continue;
        if (is_same_place(p, a) || is_same_place(p, b) || is_same_place(p, c))
            continue; /* the other side of a bridge */
        if (contains(a, b, c, p))
            return false;
    }
    return true;
}

static void cut_ear(struct ring *ring, int at, bool is_reversed, uint32_t *triangles,
                    size_t *count) {
    struct ring_node *b = &ring->nodes[at], *a = &ring->nodes[b->previous],
                     *c = &ring->nodes[b->next];
    uint32_t *out = triangles + 3 * (*count)++;
    out[0] = is_reversed ? c->corner : a->corner;
    out[1] = b->corner;
    out[2] = is_reversed ? a->corner : c->corner;
    a->next = b->next;
    c->previous = b->previous;
    b->next = -1; /* gone */
}

/* Nodes that turn right or not at all, which alone can lie in ears; cutting never adds one. */
static int find_reflex(const struct ring *ring, int start, int *reflex, int *length) {
    const struct ring_node *nodes = ring->nodes;
    int count = 0, at = start;
    *length = 0;
    do {
        const struct ring_node *p = &nodes[at];
        if (!(turn(&nodes[p->previous], p, &nodes[p->next]) > 0))
            reflex[count++] = at;
        ++*length;
        at = p->next;
    } while (at != start);
    return count;
}

static void cut_ears(struct ring *ring, int at, bool is_reversed, uint32_t *triangles,
                     size_t *count) {
    int length, *reflex = memory_get((size_t)ring->count, sizeof *reflex);
    int reflex_count = find_reflex(ring, at, reflex, &length);
    int tried = 0;
    while (length > 2) {
        const struct ring_node *node = &ring->nodes[at];
        int previous = node->previous, next = node->next;
        bool has_no_area = turn(&ring->nodes[previous], node, &ring->nodes[next]) == 0 &&
                           is_same_place(node, &ring->nodes[next]);
        /* After a round without an ear the outline crosses itself: anything goes. */
        if (has_no_area || tried >= length || is_ear(ring, reflex, reflex_count, at)) {
            cut_ear(ring, at, is_reversed, triangles, count);
            length--;
            tried = 0;
            /* Skipping a corner avoids fans of needles. */
            at = ring->nodes[next].next;
            if (length % 64 == 0)
                reflex_count = length > 2 ? find_reflex(ring, next, reflex, &length) : 0;
        } else {
            tried++;
            at = next;
        }
    }
    free(reflex);
}

bool triangulate_polygon(const double *points, const int *loop_corners, int loop_count,
                         uint32_t *triangles, size_t *triangle_count, struct status *status) {
    int corners = 0;
    *triangle_count = 0;
    for (int i = 0; i < loop_count; i++)
        corners += loop_corners[i];
    if (corners < 3)
        return true;
    if (loop_count == 1 && (corners == 3 || is_convex(points, corners))) {
        for (int i = 1; i + 1 < corners; i++) {
            uint32_t *out = triangles + 3 * (*triangle_count)++;
            out[0] = 0;
            out[1] = (uint32_t)i;
            out[2] = (uint32_t)i + 1;
        }
        return true;
    }
    if (corners > TRIANGULATE_CORNERS_MAX)
        return status_fail(
            status, STATUS_LIMIT,
            "a polygon of %d corners that is not convex or has holes; at most %d can be cut",
            corners, TRIANGULATE_CORNERS_MAX);
    struct ring ring = {
        .nodes = memory_get((size_t)corners + 2 * (size_t)loop_count, sizeof *ring.nodes)};
    bool is_reversed = loop_area(points, loop_corners[0]) < 0;
    int outline = ring_add_loop(&ring, points, 0, loop_corners[0], is_reversed);
    if (loop_count > 1)
        outline = ring_add_holes(&ring, points, loop_corners, loop_count, outline);
    cut_ears(&ring, outline, is_reversed, triangles, triangle_count);
    free(ring.nodes);
    return true;
}
