/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/driver_sockets.h"

#include "nodes/protocol.h"
#include "nodes/socket_connections.h"
#include "nodes/socket_message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>
#include <zmq.h>

enum {
    POLL_MS = 100,
    START_DEADLINE_S = 20, /* for the other nodes to say hello */
    WORDS_PATIENCE_NS = 400000000,
    UNTOLD_MAX = 2 * SHARED_REFERENCES_MAX, /* regions that wait for others to be told with */
};

#define LAST_WORDS_S 0.3

static double seconds_since(const struct timespec *then) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - then->tv_sec) + 1e-9 * (double)(now.tv_nsec - then->tv_nsec);
}

static int64_t now_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static struct peer *find_peer(struct socket_driver *driver, struct node_address address) {
    for (size_t i = 0; i < driver->peer_count; i++)
        if (driver->peers[i].address.role == address.role &&
            driver->peers[i].address.index == address.index)
            return &driver->peers[i];
    return NULL;
}

static void add_peer(struct socket_driver *driver, struct node_address address) {
    if (address.role == driver->node->address.role && address.index == driver->node->address.index)
        return;
    struct peer *peer = &driver->peers[driver->peer_count++];
    *peer = (struct peer){.address = address};
    socket_routing_name(address, peer->routing);
}

static void add_all_peers(struct socket_driver *driver, uint32_t rendering_nodes,
                          uint32_t shading_nodes) {
    driver->peers = memory_get((size_t)rendering_nodes + shading_nodes + 2, sizeof *driver->peers);
    add_peer(driver, (struct node_address){NODE_HOST, 0});
    for (uint32_t i = 0; i < rendering_nodes; i++)
        add_peer(driver, (struct node_address){NODE_RENDERING, i});
    for (uint32_t i = 0; i < shading_nodes; i++)
        add_peer(driver, (struct node_address){NODE_SHADING, i});
    add_peer(driver, (struct node_address){NODE_FRAMEBUFFER, 0});
}

static bool lost_peer(const struct socket_driver *driver, const struct peer *peer,
                      struct status *status) {
    char name[NODE_NAME_BYTES], place[NODE_PLACE_BYTES];
    const struct node *node = driver->node;
    return status_fail(status, STATUS_LOST, "%s was lost %s or near: its process ended",
                       node_address_name(peer->address, name),
                       node_place(node->has_frame, node->frame, node->region, place));
}

/* 1 sent, 0 would block, -1 failed. Takes the hold when sent. */
static int try_send(struct socket_driver *driver, struct peer *peer, struct message *message,
                    struct status *status) {
    void *socket = peer->push;
    const char *routing = NULL;
    if (socket_is_host(driver)) {
        socket = driver->control;
        routing = peer->routing;
    } else if (peer->address.role == NODE_HOST) {
        socket = driver->control;
    } else if (!socket) {
        if (!socket_open_push(driver, peer, status))
            return -1;
        socket = peer->push;
    }
    const int sent = socket_message_send(socket, routing, message);
    if (sent < 0) {
        if (errno == EHOSTUNREACH)
            lost_peer(driver, peer, status);
        else
            socket_failure("send to", peer->routing, status);
    }
    return sent;
}

/* Sends, or queues behind what could not be sent yet. Takes over the hold. */
static bool send_or_queue(struct socket_driver *driver, struct peer *peer, struct message *message,
                          struct status *status) {
    if (!peer->queue_count) {
        const int sent = try_send(driver, peer, message, status);
        if (sent < 0)
            message_release(message);
        if (sent)
            return sent > 0;
    }
    if (peer->queue_first && peer->queue_first + peer->queue_count == peer->queue_capacity) {
        memmove(peer->queue, peer->queue + peer->queue_first,
                peer->queue_count * sizeof *peer->queue);
        peer->queue_first = 0;
    }
    peer->queue = memory_grow(peer->queue, &peer->queue_capacity,
                              peer->queue_first + peer->queue_count + 1, sizeof *peer->queue);
    peer->queue[peer->queue_first + peer->queue_count++] = message;
    driver->blocked++;
    return true;
}

/* Tells a node of all that lies in shared memory for it. */
static bool send_references(struct socket_driver *driver, struct peer *peer,
                            struct status *status) {
    const size_t count = peer->shared_count;
    peer->shared_count = 0;
    driver->untold -= count;
    return !count ||
           send_or_queue(driver, peer, shared_references_encode(peer->shared, count), status);
}

static bool send_all_references(struct socket_driver *driver, struct status *status) {
    for (size_t i = 0; driver->untold && i < driver->peer_count; i++)
        if (!send_references(driver, &driver->peers[i], status))
            return false;
    return true;
}

/* Takes over the hold. What goes through shared memory is told when several have come together, for
 * one node or for all, or when there is nothing else to do. */
static bool send_to(struct socket_driver *driver, struct peer *peer, struct message *message,
                    struct status *status) {
    const bool may_share = !socket_is_host(driver) && peer->address.role != NODE_HOST;
    if (may_share &&
        shared_pool_put(driver->options->pool, message, &peer->shared[peer->shared_count])) {
        peer->shared_count++;
        driver->untold++;
        if (driver->untold == UNTOLD_MAX)
            return send_all_references(driver, status);
        return (peer->shared_count < SHARED_REFERENCES_MAX && !driver->pacer) ||
               send_references(driver, peer, status);
    }
    if (!send_references(driver, peer, status)) {
        message_release(message);
        return false;
    }
    return send_or_queue(driver, peer, message, status);
}

static bool flush_queues(struct socket_driver *driver, struct status *status) {
    for (size_t i = 0; driver->blocked && i < driver->peer_count; i++) {
        struct peer *peer = &driver->peers[i];
        while (peer->queue_count) {
            const int sent = try_send(driver, peer, peer->queue[peer->queue_first], status);
            if (sent < 0)
                return false;
            if (!sent)
                break;
            peer->queue_first = --peer->queue_count ? peer->queue_first + 1 : 0;
            driver->blocked--;
        }
    }
    return true;
}

static bool step(struct socket_driver *driver, const struct node_event *event,
                 struct status *status) {
    struct node_outputs outputs = {0};
    bool ok = node_step(driver->node, event, &outputs, status);
    for (size_t i = 0; i < outputs.count; i++) {
        const struct node_output *output = &outputs.items[i];
        if (ok && driver->pacer &&
            pacer_output(driver->pacer, output->to, output->message, now_ns()))
            continue;
        struct peer *peer = ok ? find_peer(driver, output->to) : NULL;
        if (peer)
            ok = send_to(driver, peer, output->message, status);
        else
            message_release(output->message);
    }
    free(outputs.items);
    if (driver->options->board) {
        atomic_store_explicit(&driver->options->board->frame, driver->node->frame,
                              memory_order_relaxed);
        atomic_store_explicit(&driver->options->board->region, driver->node->region,
                              memory_order_relaxed);
        atomic_store_explicit(&driver->options->board->has_frame, driver->node->has_frame,
                              memory_order_release);
    }
    clock_gettime(CLOCK_MONOTONIC, &driver->last_news); /* own work is no silence */
    return ok;
}

static bool start_pacing(struct socket_driver *driver, double scale, bool is_shaped,
                         struct status *status) {
    if (scale == 0)
        return true;
    if (!(scale >= PACER_SCALE_MIN && scale <= PACER_SCALE_MAX))
        return status_fail(status, STATUS_INVALID, "damaged topology message: pace");
    driver->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    if (driver->timer < 0)
        return status_fail(status, STATUS_IO, "cannot make a timer: %s", strerror(errno));
    driver->pacer = pacer_create(scale, is_shaped, driver->node->address);
    return true;
}

/* Sends and hands to the node what has been held back long enough. */
static bool follow_pacer(struct socket_driver *driver, bool *any, struct status *status) {
    struct pacer_action action;
    bool ok = true;
    while (ok && driver->pacer && pacer_next(driver->pacer, now_ns(), &action)) {
        struct peer *peer = action.is_delivery ? NULL : find_peer(driver, action.to);
        struct node_event event = {.kind = NODE_MESSAGE, .message = action.message};
        *any = true;
        if (peer) {
            ok = send_to(driver, peer, action.message, status);
            continue;
        }
        if (action.is_delivery)
            ok = wire_open(action.message->bytes, action.message->length, &event.header, status) &&
                 step(driver, &event, status);
        message_release(action.message);
    }
    if (driver->pacer && driver->options->pace_begin_ns)
        *driver->options->pace_begin_ns = pacer_begin_ns(driver->pacer);
    return ok;
}

static bool takes_regions(const struct socket_driver *driver) {
    return driver->input && (!driver->blocked || driver->node->takes_always);
}

static bool may_work(const struct socket_driver *driver) {
    return driver->node->has_work && !driver->blocked &&
           !(driver->pacer && pacer_is_full(driver->pacer));
}

/* An event from another node: at once, or when the pacer says so. */
static bool take_event(struct socket_driver *driver, const struct node_event *event,
                       struct status *status) {
    return (driver->pacer && pacer_input(driver->pacer, event, now_ns())) ||
           step(driver, event, status);
}

/* The host has everybody's address: tell everybody. */
static bool send_topology(struct socket_driver *driver, struct status *status) {
    struct wire_writer writer = {0};
    wire_put_u32(&writer, driver->options->rendering_nodes);
    wire_put_u32(&writer, driver->options->shading_nodes);
    wire_put_f64(&writer, driver->options->pace);
    wire_put_u32(&writer, driver->options->is_shaped);
    for (size_t i = 0; i < driver->peer_count; i++) {
        wire_put_u32(&writer, node_address_pack(driver->peers[i].address));
        wire_put_string(&writer, driver->peers[i].endpoint);
    }
    struct message *message = wire_finish(&writer, (struct wire_header){.kind = WIRE_TOPOLOGY});
    bool ok = true;
    for (size_t i = 0; ok && i < driver->peer_count; i++)
        ok = send_to(driver, &driver->peers[i], message_hold(message), status);
    message_release(message);
    return ok;
}

static bool take_topology(struct socket_driver *driver, const struct message *message,
                          struct status *status) {
    struct wire_reader reader = wire_payload(message->bytes, message->length);
    const uint32_t rendering_nodes = wire_get_u32(&reader), shading_nodes = wire_get_u32(&reader);
    const double pace = wire_get_f64(&reader);
    const bool is_shaped = wire_get_u32(&reader);
    if (driver->peers || rendering_nodes > 65536 || shading_nodes > 65536)
        return status_fail(status, STATUS_INVALID, "damaged topology message");
    add_all_peers(driver, rendering_nodes, shading_nodes);
    for (uint32_t i = 0; i < rendering_nodes + shading_nodes + 1; i++) {
        struct node_address address = node_address_unpack(wire_get_u32(&reader));
        const char *endpoint = wire_get_string(&reader);
        struct peer *peer = find_peer(driver, address);
        if (peer)
            snprintf(peer->endpoint, sizeof peer->endpoint, "%s", endpoint);
    }
    if (!wire_reader_done(&reader, "topology", status) ||
        !start_pacing(driver, pace, is_shaped, status))
        return false;
    driver->is_started = true;
    return send_to(driver, find_peer(driver, (struct node_address){NODE_HOST, 0}),
                   signal_encode(WIRE_READY, 0, 0, node_address_pack(driver->node->address)),
                   status) &&
           step(driver, &(struct node_event){.kind = NODE_START}, status);
}

/* HELLO and READY at the host: when all have said it, the next thing happens. */
static bool take_greeting(struct socket_driver *driver, const struct message *message,
                          const struct wire_header *header, struct status *status) {
    struct peer *peer = find_peer(driver, node_address_unpack(header->sender));
    char name[NODE_NAME_BYTES];
    if (!peer)
        return status_fail(status, STATUS_INVALID,
                           "%s said hello, but this cluster has %u rendering and %u shading nodes",
                           node_address_name(node_address_unpack(header->sender), name),
                           driver->options->rendering_nodes, driver->options->shading_nodes);
    if (header->kind == WIRE_HELLO) {
        const char *endpoint = text_decode(message, status);
        if (!endpoint)
            return false;
        if (peer->is_known)
            return status_fail(status, STATUS_INVALID,
                               "there are two nodes that call themselves %s",
                               node_address_name(peer->address, name));
        snprintf(peer->endpoint, sizeof peer->endpoint, "%s", endpoint);
        peer->is_known = true;
    } else {
        peer->is_ready = true;
    }
    size_t known = 0, ready = 0;
    for (size_t i = 0; i < driver->peer_count; i++) {
        known += driver->peers[i].is_known;
        ready += driver->peers[i].is_ready;
    }
    if (header->kind == WIRE_HELLO)
        return known < driver->peer_count || send_topology(driver, status);
    if (ready < driver->peer_count)
        return true;
    trace_line(driver->node->trace, "all %zu nodes are ready", driver->peer_count);
    driver->is_started = true;
    return step(driver, &(struct node_event){.kind = NODE_START}, status);
}

static bool dispatch_shared(struct socket_driver *driver, const struct message *message,
                            struct status *status) {
    struct shared_reference references[SHARED_REFERENCES_MAX];
    size_t count;
    bool ok = shared_references_decode(message, references, &count, status);
    for (size_t i = 0; ok && i < count; i++) {
        struct node_event event = {.kind = NODE_MESSAGE};
        ok = shared_pool_get(driver->options->pool, references[i], &event.message, status);
        if (!ok)
            return false;
        ok = wire_open(event.message->bytes, event.message->length, &event.header, status) &&
             take_event(driver, &event, status);
        message_release(event.message);
    }
    return ok;
}

static bool dispatch(struct socket_driver *driver, struct message *message, struct status *status) {
    struct node_event event = {.kind = NODE_MESSAGE, .message = message};
    clock_gettime(CLOCK_MONOTONIC, &driver->last_news);
    if (!wire_open(message->bytes, message->length, &event.header, status))
        return false;
    switch (event.header.kind) {
    case WIRE_HELLO:
    case WIRE_READY:
        if (socket_is_host(driver))
            return take_greeting(driver, message, &event.header, status);
        break;
    case WIRE_TOPOLOGY:
        if (!socket_is_host(driver))
            return take_topology(driver, message, status);
        break;
    case WIRE_PROBE:
        return true;
    case WIRE_SHARED:
        return dispatch_shared(driver, message, status);
    default:
        break;
    }
    return take_event(driver, &event, status);
}

/* Takes all that waits at a socket, up to `most` messages. */
static bool drain(struct socket_driver *driver, void *socket, bool is_router, size_t most,
                  bool *any, struct status *status) {
    char routing[64];
    struct message *message;
    for (size_t i = 0; i < most; i++) {
        const int got =
            socket_message_receive(socket, is_router ? routing : NULL, sizeof routing, &message);
        if (got < 0)
            return errno == EINTR || socket_failure("receive from", "a socket", status);
        if (!got)
            return true;
        *any = true;
        const bool ok = dispatch(driver, message, status);
        message_release(message);
        if (!ok)
            return false;
    }
    return true;
}

/* A connection broke. At a node it can only be the host's; the host finds out whose by sending to
 * each. */
static bool take_disconnect(struct socket_driver *driver, struct status *status) {
    zmq_msg_t part;
    char place[NODE_PLACE_BYTES];
    bool any = false;
    zmq_msg_init(&part);
    while (zmq_msg_recv(&part, driver->monitor, ZMQ_DONTWAIT) >= 0)
        any = true;
    zmq_msg_close(&part);
    if (!any || driver->node->is_finished)
        return true;
    if (!socket_is_host(driver))
        return status_fail(
            status, STATUS_LOST, "the host was lost %s or near",
            node_place(driver->node->has_frame, driver->node->frame, driver->node->region, place));
    driver->is_probing = true;
    clock_gettime(CLOCK_MONOTONIC, &driver->probe_begin);
    return true;
}

/* A node that gave up told why before it left: that is worth more than that it is gone. Listens for
 * a moment; true when the cluster had ended well after all. */
static bool hear_last_words(struct socket_driver *driver, struct status *loss) {
    struct timespec begin;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    do {
        struct status failure = {0};
        struct message *message;
        char routing[64];
        while (socket_message_receive(driver->control, routing, sizeof routing, &message) > 0) {
            struct node_event event = {.kind = NODE_MESSAGE, .message = message};
            bool ok = true;
            if (wire_open(message->bytes, message->length, &event.header, NULL) &&
                (event.header.kind == WIRE_FAILURE || event.header.kind == WIRE_GOODBYE))
                ok = step(driver, &event, &failure);
            message_release(message);
            if (!ok) {
                *loss = failure;
                return false;
            }
        }
        if (driver->node->is_finished)
            return true;
        nanosleep(&(struct timespec){0, 5000000}, NULL);
    } while (seconds_since(&begin) < LAST_WORDS_S);
    return false;
}

static bool probe_peers(struct socket_driver *driver, struct status *status) {
    struct message *probe = signal_encode(WIRE_PROBE, 0, 0, 0);
    bool ok = true;
    for (size_t i = 0; ok && i < driver->peer_count; i++)
        if (driver->peers[i].is_known &&
            (!driver->node->is_closing || driver->peers[i].address.role == NODE_FRAMEBUFFER))
            ok = send_to(driver, &driver->peers[i], message_hold(probe), status);
    message_release(probe);
    if (seconds_since(&driver->probe_begin) > 1)
        driver->is_probing = false;
    return ok;
}

static void describe(const struct socket_driver *driver, char *text, size_t size) {
    char name[NODE_NAME_BYTES], what[256];
    if (!driver->is_started && socket_is_host(driver)) {
        size_t missing = 0, known = 0;
        const struct peer *first = NULL;
        for (size_t i = 0; i < driver->peer_count; i++)
            known += driver->peers[i].is_known;
        for (size_t i = 0; i < driver->peer_count; i++)
            if (known < driver->peer_count ? !driver->peers[i].is_known
                                           : !driver->peers[i].is_ready) {
                first = first ? first : &driver->peers[i];
                missing++;
            }
        snprintf(what, sizeof what, "waits for %zu of %zu nodes to join, the first of them %s",
                 missing, driver->peer_count,
                 first ? node_address_name(first->address, name) : "none");
    } else if (!driver->is_started) {
        snprintf(what, sizeof what, "waits for the host at %s to begin", driver->options->host);
    } else {
        driver->node->type->describe(driver->node, what, sizeof what);
    }
    snprintf(text, size, "%s %s", node_address_name(driver->node->address, name), what);
    if (driver->blocked) {
        const size_t used = strlen(text);
        snprintf(text + used, size - used, "; %zu messages wait to be taken by other nodes",
                 driver->blocked);
    }
}

static void describe_on_request(struct socket_driver *driver) {
    char text[512];
    if (!driver->options->describe || !*driver->options->describe)
        return;
    *driver->options->describe = 0;
    describe(driver, text, sizeof text);
    fprintf(stderr, "sortlast: %s\n", text);
    trace_dump(driver->node->trace, stderr, 8);
}

static bool check_deadline(struct socket_driver *driver, struct status *status) {
    const int limit = driver->is_started || !socket_is_host(driver) ? driver->options->deadline_s
                                                                    : START_DEADLINE_S;
    if (seconds_since(&driver->last_news) < limit ||
        (!socket_is_host(driver) && driver->is_started))
        return true; /* a node that has begun trusts the host's judgement, and its own connection to
                        it */
    char text[512];
    if (driver->options->supervisor) { /* all who still can say what they wait for */
        kill(driver->options->supervisor, SIGUSR1);
        nanosleep(&(struct timespec){0, WORDS_PATIENCE_NS}, NULL);
        describe_on_request(driver);
    }
    describe(driver, text, sizeof text);
    return status_fail(status, STATUS_TIMEOUT, "nothing happened for %d s: %s", limit, text);
}

/* Waits until there is something to do. Regions are not taken while something cannot be sent. */
static void wait_for_events(struct socket_driver *driver) {
    zmq_pollitem_t *items = memory_get(4 + driver->peer_count, sizeof *items);
    int count = 0;
    items[count++] = (zmq_pollitem_t){.socket = driver->control, .events = ZMQ_POLLIN};
    items[count++] = (zmq_pollitem_t){.socket = driver->monitor, .events = ZMQ_POLLIN};
    if (takes_regions(driver))
        items[count++] = (zmq_pollitem_t){.socket = driver->input, .events = ZMQ_POLLIN};
    for (size_t i = 0; driver->blocked && i < driver->peer_count; i++)
        if (driver->peers[i].queue_count && driver->peers[i].push)
            items[count++] =
                (zmq_pollitem_t){.socket = driver->peers[i].push, .events = ZMQ_POLLOUT};
    if (driver->pacer && pacer_wake_ns(driver->pacer) != INT64_MAX) {
        const int64_t wake = pacer_wake_ns(driver->pacer);
        const struct itimerspec time = {
            .it_value = {(time_t)(wake / 1000000000), (long)(wake % 1000000000)}};
        timerfd_settime(driver->timer, TFD_TIMER_ABSTIME, &time, NULL);
        items[count++] = (zmq_pollitem_t){.fd = driver->timer, .events = ZMQ_POLLIN};
    }
    zmq_poll(items, count, may_work(driver) ? 0 : driver->is_probing ? 20 : POLL_MS);
    free(items);
}

static bool loop(struct socket_driver *driver, struct status *status) {
    while (!driver->node->is_finished) {
        bool any = false;
        describe_on_request(driver); /* even when it is asked to stop meanwhile */
        if (*driver->options->stop)
            return false;
        if (!flush_queues(driver, status) || !follow_pacer(driver, &any, status) ||
            !drain(driver, driver->control, socket_is_host(driver), 64, &any, status))
            return false;
        const bool works = may_work(driver);
        if (takes_regions(driver) && !works &&
            !drain(driver, driver->input, false, 1, &any, status))
            return false;
        if (works && may_work(driver) && !driver->node->is_finished) {
            if (!step(driver, &(struct node_event){.kind = NODE_WORK}, status))
                return false;
            any = true;
        }
        if (driver->is_probing && !probe_peers(driver, status))
            return false;
        if (any)
            continue;
        if (!send_all_references(driver, status) || !take_disconnect(driver, status) ||
            !check_deadline(driver, status))
            return false;
        wait_for_events(driver);
    }
    if (!send_all_references(driver, status))
        return false;
    while (driver->blocked && !*driver->options->stop) { /* last words */
        if (!flush_queues(driver, status))
            return false;
        wait_for_events(driver);
    }
    return true;
}

/* Tells the host why this node gives up. */
static void report_failure(struct socket_driver *driver, const struct status *status) {
    if (socket_is_host(driver) || !driver->control || status->code == STATUS_LOST ||
        status->code == STATUS_OK)
        return;
    struct message *message = text_encode(WIRE_FAILURE, status->message, status->code, 0,
                                          node_address_pack(driver->node->address));
    if (socket_message_send(driver->control, NULL, message) <= 0)
        message_release(message);
}

bool driver_sockets_run(struct node *node, const struct socket_options *options,
                        struct status *status) {
    struct socket_driver driver = {.node = node, .options = options, .timer = -1};
    char endpoint[ENDPOINT_BYTES];
    driver.context = zmq_ctx_new();
    zmq_ctx_set(driver.context, ZMQ_MAX_SOCKETS,
                (int)(options->rendering_nodes + options->shading_nodes) + 4096);
    clock_gettime(CLOCK_MONOTONIC, &driver.last_news);
    status->code = STATUS_OK;
    if (socket_is_host(&driver))
        add_all_peers(&driver, options->rendering_nodes, options->shading_nodes);
    bool ok = (!socket_is_host(&driver) ||
               start_pacing(&driver, options->pace, options->is_shaped, status)) &&
              socket_open_input(&driver, endpoint, status) && socket_open_control(&driver, status);
    if (ok && !socket_is_host(&driver)) {
        struct message *hello =
            text_encode(WIRE_HELLO, endpoint, 0, 0, node_address_pack(node->address));
        ok = socket_message_send(driver.control, NULL, hello) > 0 ||
             socket_failure("say hello to the host at", options->host, status);
    }
    if (ok && options->board)
        atomic_store(&options->board->is_started, 1);
    ok = ok && loop(&driver, status);
    if (!ok && socket_is_host(&driver) && status->code == STATUS_LOST)
        ok = hear_last_words(&driver, status);
    if (!ok)
        report_failure(&driver, status);
    /* asked to stop, or the cluster has come apart: nobody waits for what is still under way */
    const bool is_hopeless = !ok && (status->code == STATUS_OK || status->code == STATUS_LOST);
    socket_close_all(&driver, is_hopeless ? 0 : LINGER_MS);
    return ok;
}
