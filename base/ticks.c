/* SPDX-License-Identifier: Apache-2.0 */
#include "base/ticks.h"

#define TICK_RATE_MAX 1000000000000000000u

static uint64_t greatest_common_divisor(uint64_t a, uint64_t b) {
    while (b) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

bool tick_rate_include(struct tick_rate *rate, uint64_t numerator, uint64_t denominator,
                       struct status *status) {
    uint64_t reduced = denominator / greatest_common_divisor(numerator, denominator);
    uint64_t missing = reduced / greatest_common_divisor(rate->per_s, reduced);
    unsigned __int128 raised = (unsigned __int128)rate->per_s * missing;
    if (raised > TICK_RATE_MAX)
        return status_fail(
            status, STATUS_LIMIT,
            "no common tick for these rates: more than 10^18 ticks a second would be "
            "needed; choose rates with more factors in common");
    rate->per_s = (uint64_t)raised;
    return true;
}

bool ticks_from_seconds(struct tick_rate rate, uint64_t numerator, uint64_t denominator, ticks *out,
                        struct status *status) {
    unsigned __int128 scaled = (unsigned __int128)numerator * rate.per_s;
    if (numerator && scaled / numerator != rate.per_s)
        return status_fail(status, STATUS_LIMIT, "a duration does not fit 128-bit arithmetic");
    if (scaled % denominator)
        return status_fail(status, STATUS_INTERNAL, "a duration is not a whole number of ticks");
    if (scaled / denominator >= TICKS_MAX)
        return status_fail(status, STATUS_LIMIT, "a duration does not fit 63 bits of ticks");
    *out = (ticks)(scaled / denominator);
    return true;
}

int64_t ticks_to_ps(struct tick_rate rate, ticks time) {
    unsigned __int128 scaled = (unsigned __int128)(uint64_t)time * 2000000000000u + rate.per_s;
    unsigned __int128 ps = scaled / ((unsigned __int128)rate.per_s * 2);
    return ps > INT64_MAX ? INT64_MAX : (int64_t)ps;
}

double ticks_to_s(struct tick_rate rate, ticks time) {
    return (double)time / (double)rate.per_s;
}
