/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of visibility for one instruction set: KERNEL_SET names the table, KERNEL_NAME what
 * it is called, KERNEL_SUPPORTED says whether this processor has it, KERNEL_WIDTH how many doubles
 * a vector has. */
#include "nodes/visibility_kernels.h"

#include <string.h>

typedef double doubles __attribute__((vector_size(8 * KERNEL_WIDTH)));
typedef int64_t wholes __attribute__((vector_size(8 * KERNEL_WIDTH)));
typedef float floats __attribute__((vector_size(4 * KERNEL_WIDTH)));
typedef int32_t masks __attribute__((vector_size(4 * KERNEL_WIDTH)));
typedef uint32_t words __attribute__((vector_size(4 * KERNEL_WIDTH)));

/* The first and every KERNEL_WIDTH-th lane after it begin a vector. */
#define LOAD(type, plane, lane)                                                                    \
    ({                                                                                             \
        type loaded;                                                                               \
        memcpy(&loaded, (plane) + (lane), sizeof loaded);                                          \
        loaded;                                                                                    \
    })
#define STORE(plane, lane, value)                                                                  \
    do {                                                                                           \
        const __typeof__(value) stored = (value);                                                  \
        memcpy((plane) + (lane), &stored, sizeof stored);                                          \
    } while (0)
#define CHOOSE(type, mask, yes, no) ((type)(((masks)(yes) & (mask)) | ((masks)(no) & ~(mask))))

static uint32_t consider(struct packet_lanes *lanes, const struct packet_triangle *candidate,
                         int32_t *valid) {
    const double(*w)[3] = candidate->setup->weight;
    const double *n = candidate->setup->depth_numerator, *d = candidate->setup->depth_denominator;
    const struct sample_box box = candidate->box;
    double size[3];
    for (int edge = 0; edge < 3; edge++)
        size[edge] = fabs(w[edge][0]) + fabs(w[edge][1]);
    masks refused = {0};
    for (int i = 0; i < PACKET_LANES; i += KERNEL_WIDTH) {
        const doubles x = LOAD(doubles, lanes->x, i), y = LOAD(doubles, lanes->y, i),
                      tolerance = LOAD(doubles, lanes->tolerance, i);
        const wholes outside = (w[0][0] * x + w[0][1] * y + w[0][2] < -tolerance * size[0]) |
                               (w[1][0] * x + w[1][1] * y + w[1][2] < -tolerance * size[1]) |
                               (w[2][0] * x + w[2][1] * y + w[2][2] < -tolerance * size[2]);
        const floats depth = __builtin_convertvector(
            (n[0] * x + n[1] * y + n[2]) / (d[0] * x + d[1] * y + d[2]), floats);
        const doubles exactly = __builtin_convertvector(depth, doubles);
        const wholes between =
            (exactly >= candidate->near_plane) & (exactly <= candidate->far_plane);
        /* beyond the box, too, where less than its first column or row */
        const masks in_box =
            (LOAD(words, lanes->column, i) - box.x0 <= (words){0} + (box.x1 - box.x0)) &
            (LOAD(words, lanes->row, i) - box.y0 <= (words){0} + (box.y1 - box.y0));
        const masks asked = LOAD(masks, valid, i);
        const masks seen = __builtin_convertvector(~outside & between, masks) & in_box & asked;
        const floats best = LOAD(floats, lanes->depth, i);
        const words primitive = LOAD(words, lanes->primitive, i);
        const masks wins =
            seen &
            ((depth < best) | ((depth == best) & ((words){0} + candidate->primitive < primitive)));
        refused -= (depth != depth) & asked;
        STORE(lanes->depth, i, CHOOSE(floats, wins, depth, best));
        STORE(
            lanes->triangle, i,
            CHOOSE(words, wins, (words){0} + candidate->triangle, LOAD(words, lanes->triangle, i)));
        STORE(lanes->primitive, i,
              CHOOSE(words, wins, (words){0} + candidate->primitive, primitive));
        STORE(valid, i, seen);
    }
    uint32_t count = 0;
    for (int i = 0; i < KERNEL_WIDTH; i++)
        count += (uint32_t)refused[i];
    return count;
}

static void weigh(const struct triangle_setup *setup, const float *restrict x, float row,
                  uint32_t count, float *const barycentric[3]) {
    const double(*w)[3] = setup->weight;
    const double y = row;
    const double c0 = w[0][1] * y + w[0][2], c1 = w[1][1] * y + w[1][2], c2 = w[2][1] * y + w[2][2];
    float *restrict b0 = barycentric[0], *restrict b1 = barycentric[1],
                    *restrict b2 = barycentric[2];
    for (uint32_t k = 0; k < count; k++) {
        const double w0 = w[0][0] * x[k] + c0, w1 = w[1][0] * x[k] + c1, w2 = w[2][0] * x[k] + c2;
        const double scale = 1 / (w0 + w1 + w2);
        b0[k] = (float)(w0 * scale);
        b1[k] = (float)(w1 * scale);
        b2[k] = (float)(w2 * scale);
    }
}

static void interpolate(const float *const barycentric[3], const float corner[3], uint32_t count,
                        float *restrict out) {
    const float *restrict b0 = barycentric[0], *restrict b1 = barycentric[1],
                          *restrict b2 = barycentric[2];
    const float a = corner[0], b = corner[1], c = corner[2];
    for (uint32_t k = 0; k < count; k++)
        out[k] = b0[k] * a + b1[k] * b + b2[k] * c;
}

static bool is_supported(void) {
    __builtin_cpu_init();
    return KERNEL_SUPPORTED;
}

extern const struct visibility_kernels KERNEL_SET;
const struct visibility_kernels KERNEL_SET = {KERNEL_NAME, is_supported, consider, weigh,
                                              interpolate};
