/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CALIBRATE_H
#define CALIBRATE_H

#include "netsim/machine.h"

/* `sortlast machine calibrate`: measures this host and describes it as a machine, one core a node.
 */
int calibrate_main(int argc, char **argv);

/* What one node of each kind needed for a small frame, with what the frame consisted of. */
struct calibrate_run {
    double rendering_region_s, shading_region_s, framebuffer_region_s; /* median of the regions */
    int64_t regions;
    double shading_count, raster_count; /* operations (of those with a price of 1 us) and triangles
                                           per region */
};
/* Renders the scene text on nodes in this process. `machine` prices what is to be counted. */
bool calibrate_render(const char *folder, const char *scene, const struct machine *machine,
                      struct calibrate_run *run, struct status *status);

/* Seconds to compose two full regions of `floats` parameters and hand the result on. */
double calibrate_composition_s(const struct machine *machine, uint32_t floats);
/* Between two threads over ipc sockets: one way of a small message, and bytes a second. */
bool calibrate_sockets(const char *folder, double *latency_s, double *bytes_per_s,
                       struct status *status);

#endif
