/* SPDX-License-Identifier: Apache-2.0 */
#ifndef DRIVER_IN_PROCESS_H
#define DRIVER_IN_PROCESS_H

#include "nodes/node.h"

#include <signal.h>

/* Hosts a whole cluster in one process and one thread. Links between nodes keep order; which link
 * or node goes next is the driver's choice: with seed 0 the node furthest downstream (a region
 * stays in cache until it is in the picture), otherwise drawn from the seed, so that any order a
 * real cluster may fall into can be tried and tried again. */
struct driver_options {
    uint64_t seed;
    /* Sees every message as it is sent; NULL: nobody does. For tests. */
    void (*tap)(void *context, struct node_address from, const struct node_output *output);
    void *tap_context;
    const volatile sig_atomic_t *stop; /* set by a signal: give up with STATUS_OK; NULL: never */
};

/* Runs `nodes` (one host, one framebuffer node, any number of others) until the host is finished.
 */
bool driver_in_process_run(struct node **nodes, size_t count, const struct driver_options *options,
                           struct status *status);

#endif
