/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BUDGET_H
#define BUDGET_H

#include "netsim/what_if.h"

/* `sortlast budget`: what a sample may cost at a target rate, what the shaders of a scene cost, and
 * which changes would meet the target (PF section 6.2.1 does the arithmetic by hand). */

int budget_main(int argc, char **argv);

/* The arithmetic of one frame at a rate. */
struct budget {
    int64_t frames_per_s;
    uint64_t samples; /* of the picture */
    uint32_t regions;
    uint64_t payload_numerator, payload_denominator; /* bytes/s without depth, exactly */
    uint32_t words;            /* whole words a sample for which a frame has time */
    uint32_t usable_bytes;     /* their payload */
    int64_t frame_time_ps;     /* 1 / rate, rounded down */
    int64_t shading_period_ps; /* the same in whole milliseconds, as the paper counts: 33 ms */
    uint32_t regions_per_node; /* of the shading node that gets most */
};
struct budget budget_compute(const struct record_frame *frame, const struct what_if *question,
                             int64_t frames_per_s);
double budget_bytes_per_sample(const struct budget *budget);

/* A change that was solved. */
struct budget_suggestion {
    char change[512];
    int64_t time_ps; /* of a frame, on average */
    bool meets;
    double cost; /* to rank by: changes of the scene before more hardware, little before much */
};
/* What would help, best first; the array is the caller's. `binds` of a suggestion that binds
 * parameters refer to the record. */
struct budget_suggestion *budget_suggest(struct what_if_solver *solver,
                                         const struct run_record *record,
                                         const struct what_if *question, int64_t frames_per_s,
                                         size_t *count);

/* Does the solution keep up the rate, exactly? */
bool budget_meets(const struct what_if *question, const struct what_if_result *result,
                  int64_t frames_per_s);

#endif
