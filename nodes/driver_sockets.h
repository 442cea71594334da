/* SPDX-License-Identifier: Apache-2.0 */
#ifndef DRIVER_SOCKETS_H
#define DRIVER_SOCKETS_H

#include "nodes/node.h"
#include "nodes/shared_pool.h"
#include "nodes/status_board.h"

#include <signal.h>
#include <sys/types.h>

/* Hosts one node of a cluster in this process and connects it to the others by libzmq.
 *
 * The geometry network is a ROUTER socket at the host and a DEALER at every other node. The
 * composition network is a PULL socket at each node that takes regions, with a PUSH from each node
 * that sends it some; a node that cannot send stops taking regions, so memory stays bounded. At
 * start every node says HELLO with the address of its PULL socket, the host answers with
 * everybody's (TOPOLOGY), nodes connect and say READY. */

struct socket_options {
    const char *host;   /* where the host listens: ipc://PATH or tcp://ADDRESS:PORT */
    const char *listen; /* where this node takes regions; NULL: beside the host's ipc socket, or for
                           tcp a free port on the loopback interface */
    uint32_t rendering_nodes, shading_nodes; /* host only: who must say hello */
    int deadline_s;                          /* longest silence that is believed to be work */
    struct status_board_entry *board;        /* may be NULL */
    struct shared_pool *pool;                /* may be NULL: all bytes go through sockets */
    const volatile sig_atomic_t *stop;       /* set by a signal: leave quietly */
    volatile sig_atomic_t *describe;         /* set by SIGUSR1: say what the node waits for */
    double pace;    /* host only: the cluster runs at this fraction of the machine's speed
                       (nodes/pacer.h); 0: as fast as it can */
    bool is_shaped; /* host only, with pace: the network below throttles the composition link */
    int64_t *pace_begin_ns; /* host only, may be NULL: when the first charged byte was sent, on
                               CLOCK_MONOTONIC */
    pid_t supervisor; /* hands SIGUSR1 on to all nodes when the host's deadline expires; 0: none */
};

/* Runs the node until it is finished. When another node is lost the status code is STATUS_LOST (for
 * the host the message names which); a failure of this node is told to the host before returning.
 * Stopped by *stop it returns false with STATUS_OK. */
bool driver_sockets_run(struct node *node, const struct socket_options *options,
                        struct status *status);

#endif
