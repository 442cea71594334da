/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SOCKET_CONNECTIONS_H
#define SOCKET_CONNECTIONS_H

#include "nodes/driver_sockets.h"
#include "nodes/pacer.h"
#include "nodes/shared_pool.h"

#include <time.h>

/* The sockets of one node, shared by driver_sockets.c, which runs the node, and
 * socket_connections.c, which opens and closes them. */

enum { ENDPOINT_BYTES = 256, LINGER_MS = 1000 };

/* Another node as this one reaches it. */
struct peer {
    struct node_address address;
    char routing[24];              /* its name at the host's ROUTER */
    char endpoint[ENDPOINT_BYTES]; /* of its PULL socket */
    void *push;                    /* opened when first needed */
    bool is_known;                 /* host: has said hello */
    bool is_ready;
    struct message **queue; /* what could not be sent yet */
    size_t queue_first, queue_count, queue_capacity;
    /* messages in shared memory that it is not told of yet */
    struct shared_reference shared[SHARED_REFERENCES_MAX];
    size_t shared_count;
};

struct socket_driver {
    struct node *node;
    const struct socket_options *options;
    void *context, *control, *input, *monitor;
    struct peer *peers; /* every node but this one */
    size_t peer_count;
    size_t blocked;                /* messages waiting in queues */
    size_t untold;                 /* messages in shared memory that their peers are not told of */
    char bound[2][ENDPOINT_BYTES]; /* addresses this node listens at: control, input */
    bool is_started, is_probing;
    struct timespec last_news, probe_begin;
    struct pacer *pacer; /* NULL: not paced */
    int timer;           /* of the pacer */
};

bool socket_is_host(const struct socket_driver *driver);
/* Fails with what errno says about `where`. */
bool socket_failure(const char *what, const char *where, struct status *status);
/* The name of a node at the host's ROUTER. */
void socket_routing_name(struct node_address address, char name[24]);

/* Where this node takes regions; `endpoint` gets the address others can connect to, "" at the
 * host. */
bool socket_open_input(struct socket_driver *driver, char *endpoint, struct status *status);
/* To the host, or at the host to everybody. */
bool socket_open_control(struct socket_driver *driver, struct status *status);
/* To another node that takes regions. */
bool socket_open_push(struct socket_driver *driver, struct peer *peer, struct status *status);
/* Closes everything; `linger_ms`: how long what was sent may still take to leave. */
void socket_close_all(struct socket_driver *driver, int linger_ms);

#endif
