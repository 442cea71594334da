/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_TICKS_H
#define BASE_TICKS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Simulated time: an integer count of ticks. The tick rate is the least common multiple of the
 * denominators of every duration in a machine description, so that each of them is a whole number
 * of ticks and sums are exact (contract C2). For the PixelFlow description one tick is its 5 ns
 * clock. */
typedef int64_t ticks;

#define TICKS_MAX INT64_MAX

struct tick_rate {
    uint64_t per_s; /* ticks in one second; 1 before the first duration was included */
};

/* Makes `numerator / denominator` seconds a whole number of ticks by raising the rate. Fails with
 * STATUS_LIMIT when the rate would pass 10^18 ticks a second. denominator > 0. */
bool tick_rate_include(struct tick_rate *rate, uint64_t numerator, uint64_t denominator,
                       struct status *status);

/* numerator / denominator seconds in ticks; it must be whole at this rate and fit. */
bool ticks_from_seconds(struct tick_rate rate, uint64_t numerator, uint64_t denominator, ticks *out,
                        struct status *status);

/* Checked arithmetic on times that are never negative: a result past TICKS_MAX stays there, and
 * ticks_overflowed() is how a model asks once at the end whether any did. */
static inline ticks ticks_add(ticks a, ticks b) {
    ticks sum;
    return __builtin_add_overflow(a, b, &sum) ? TICKS_MAX : sum;
}
static inline ticks ticks_multiply(ticks a, int64_t count) {
    ticks product;
    return __builtin_mul_overflow(a, count, &product) ? TICKS_MAX : product;
}
static inline ticks ticks_max(ticks a, ticks b) {
    return a > b ? a : b;
}
static inline bool ticks_overflowed(ticks a) {
    return a == TICKS_MAX;
}

/* Picoseconds, rounded half up (exact at the PixelFlow rate); INT64_MAX when they do not fit. */
int64_t ticks_to_ps(struct tick_rate rate, ticks time);
double ticks_to_s(struct tick_rate rate, ticks time);

#endif
