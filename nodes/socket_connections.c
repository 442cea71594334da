/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/socket_connections.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

enum {
    REGIONS_IN_FLIGHT =
        8, /* per link and side: enough to hide a wake-up, few enough to stay in cache */
    HEARTBEAT_MS = 1000,
    HEARTBEAT_TIMEOUT_MS = 20000,
};

bool socket_is_host(const struct socket_driver *driver) {
    return driver->node->address.role == NODE_HOST;
}

bool socket_failure(const char *what, const char *where, struct status *status) {
    return status_fail(status, STATUS_IO, "cannot %s %s: %s", what, where, zmq_strerror(errno));
}

void socket_routing_name(struct node_address address, char name[24]) {
    snprintf(name, 24, "node-%08x", node_address_pack(address));
}

/* The ipc socket of this node's input beside that of the host, or any loopback port. */
static void default_listen(const struct socket_driver *driver, char *endpoint) {
    const char *host = driver->options->host, *slash = strrchr(host, '/');
    char name[24];
    socket_routing_name(driver->node->address, name);
    if (!strncmp(host, "ipc://", 6) && slash)
        snprintf(endpoint, ENDPOINT_BYTES, "%.*s/%s", (int)(slash - host), host, name);
    else
        snprintf(endpoint, ENDPOINT_BYTES, "tcp://127.0.0.1:*");
}

static void set_option(void *socket, int option, int value) {
    zmq_setsockopt(socket, option, &value, sizeof value);
}

bool socket_open_input(struct socket_driver *driver, char *endpoint, struct status *status) {
    size_t size = ENDPOINT_BYTES;
    endpoint[0] = 0;
    if (socket_is_host(driver))
        return true;
    driver->input = zmq_socket(driver->context, ZMQ_PULL);
    if (!driver->input)
        return socket_failure("open a socket for", "regions", status);
    set_option(driver->input, ZMQ_RCVHWM, REGIONS_IN_FLIGHT);
    set_option(driver->input, ZMQ_LINGER, 0);
    if (driver->options->listen)
        snprintf(endpoint, ENDPOINT_BYTES, "%s", driver->options->listen);
    else
        default_listen(driver, endpoint);
    if (zmq_bind(driver->input, endpoint))
        return socket_failure("listen at", endpoint, status);
    snprintf(driver->bound[1], ENDPOINT_BYTES, "%s", endpoint);
    zmq_getsockopt(driver->input, ZMQ_LAST_ENDPOINT, endpoint, &size);
    return true;
}

bool socket_open_control(struct socket_driver *driver, struct status *status) {
    char name[24];
    driver->control = zmq_socket(driver->context, socket_is_host(driver) ? ZMQ_ROUTER : ZMQ_DEALER);
    if (!driver->control)
        return socket_failure("open a socket for", "the host", status);
    set_option(driver->control, ZMQ_SNDHWM, 0);
    set_option(driver->control, ZMQ_RCVHWM, 0);
    set_option(driver->control, ZMQ_LINGER, LINGER_MS);
    set_option(driver->control, ZMQ_HEARTBEAT_IVL, HEARTBEAT_MS);
    set_option(driver->control, ZMQ_HEARTBEAT_TIMEOUT, HEARTBEAT_TIMEOUT_MS);
    if (zmq_socket_monitor(driver->control, "inproc://monitor", ZMQ_EVENT_DISCONNECTED))
        return socket_failure("watch", "connections", status);
    driver->monitor = zmq_socket(driver->context, ZMQ_PAIR);
    set_option(driver->monitor, ZMQ_LINGER, 0);
    zmq_connect(driver->monitor, "inproc://monitor");
    if (socket_is_host(driver)) {
        set_option(driver->control, ZMQ_ROUTER_MANDATORY, 1);
        if (zmq_bind(driver->control, driver->options->host))
            return socket_failure("listen at", driver->options->host, status);
        snprintf(driver->bound[0], ENDPOINT_BYTES, "%s", driver->options->host);
        return true;
    }
    socket_routing_name(driver->node->address, name);
    zmq_setsockopt(driver->control, ZMQ_ROUTING_ID, name, strlen(name));
    if (zmq_connect(driver->control, driver->options->host))
        return socket_failure("connect to the host at", driver->options->host, status);
    return true;
}

bool socket_open_push(struct socket_driver *driver, struct peer *peer, struct status *status) {
    peer->push = zmq_socket(driver->context, ZMQ_PUSH);
    if (!peer->push)
        return socket_failure("open a socket for", peer->routing, status);
    /* a paced cluster is held by credits, and these must always get through */
    set_option(peer->push, ZMQ_SNDHWM, driver->pacer ? 0 : REGIONS_IN_FLIGHT);
    set_option(peer->push, ZMQ_LINGER, LINGER_MS);
    if (!peer->endpoint[0] || zmq_connect(peer->push, peer->endpoint))
        return socket_failure("connect to", peer->endpoint[0] ? peer->endpoint : peer->routing,
                              status);
    return true;
}

void socket_close_all(struct socket_driver *driver, int linger_ms) {
    pacer_destroy(driver->pacer);
    if (driver->timer >= 0)
        close(driver->timer);
    if (driver->control)
        set_option(driver->control, ZMQ_LINGER, linger_ms);
    for (size_t i = 0; i < driver->peer_count; i++) {
        struct peer *peer = &driver->peers[i];
        for (size_t m = 0; m < peer->queue_count; m++)
            message_release(peer->queue[peer->queue_first + m]);
        free(peer->queue);
        if (peer->push) {
            set_option(peer->push, ZMQ_LINGER, linger_ms);
            zmq_close(peer->push);
        }
    }
    free(driver->peers);
    /* in this order: libzmq's own thread blocks on an event that nobody can receive any more */
    if (driver->control)
        zmq_socket_monitor(driver->control, NULL, 0);
    if (driver->monitor)
        zmq_close(driver->monitor);
    if (driver->control)
        zmq_close(driver->control);
    if (driver->input)
        zmq_close(driver->input);
    zmq_ctx_term(driver->context);
    for (int i = 0; i < 2; i++) /* libzmq leaves the files of ipc sockets behind */
        if (!strncmp(driver->bound[i], "ipc://", 6) && driver->bound[i][6] != '@')
            unlink(driver->bound[i] + 6);
}
