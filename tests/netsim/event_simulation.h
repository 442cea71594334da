/* SPDX-License-Identifier: Apache-2.0 */
#ifndef EVENT_SIMULATION_H
#define EVENT_SIMULATION_H

#include "tests/netsim/timing_cases.h"

/* The machine of docs/timing.md simulated event by event: nodes, networks and buffers as agents
 * that hand each other messages and credits through one queue of events ordered by time. It shares
 * no code with the timing model and knows nothing of its recurrence: no node looks back at a region
 * "B regions earlier", it waits for a credit; colours wait for their turn because the framebuffer
 * holds what comes early; a frame ends when its last message is there.
 *
 * Fills in the end of each frame. */
void simulate_events(const struct timing_case *timing_case, ticks frame_end[CASE_FRAMES]);

#endif
