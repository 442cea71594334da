/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/socket_message.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

/* Messages smaller than this are copied: cheaper than sharing them. */
enum { COPY_BYTES_MAX = 4096, ALIGNMENT_NEEDED = 8 };

struct received_message {
    struct message message; /* first */
    zmq_msg_t content;
};

static void dispose_received(struct message *message) {
    struct received_message *received = (struct received_message *)message;
    zmq_msg_close(&received->content);
    free(received);
}

static void release_sent(void *bytes, void *message) {
    (void)bytes;
    message_release(message);
}

int socket_message_send(void *socket, const char *routing, struct message *message) {
    zmq_msg_t content;
    if (routing && zmq_send(socket, routing, strlen(routing), ZMQ_SNDMORE | ZMQ_DONTWAIT) < 0)
        return errno == EAGAIN ? 0 : -1;
    if (message->length <= COPY_BYTES_MAX) {
        if (zmq_msg_init_size(&content, message->length))
            return -1;
        memcpy(zmq_msg_data(&content), message->bytes, message->length);
    } else if (zmq_msg_init_data(&content, message->bytes, message->length, release_sent,
                                 message_hold(message))) {
        message_release(message);
        return -1;
    }
    if (zmq_msg_send(&content, socket, ZMQ_DONTWAIT) < 0) {
        const int cause = errno;
        zmq_msg_close(&content);
        errno = cause;
        return cause == EAGAIN ? 0 : -1;
    }
    message_release(message);
    return 1;
}

static struct message *wrap(zmq_msg_t *content) {
    const size_t length = zmq_msg_size(content);
    uint8_t *bytes = zmq_msg_data(content);
    if (length <= COPY_BYTES_MAX || (uintptr_t)bytes % ALIGNMENT_NEEDED) {
        struct message *copy = message_create(length);
        memcpy(copy->bytes, bytes, length);
        zmq_msg_close(content);
        return copy;
    }
    struct received_message *received = memory_get(1, sizeof *received);
    zmq_msg_init(&received->content);
    zmq_msg_move(&received->content, content);
    atomic_init(&received->message.holders, 1);
    received->message.length = received->message.capacity = length;
    received->message.bytes = zmq_msg_data(&received->content);
    received->message.dispose = dispose_received;
    return &received->message;
}

int socket_message_receive(void *socket, char *routing, size_t size, struct message **message) {
    zmq_msg_t content;
    if (routing) {
        const int length = zmq_recv(socket, routing, size - 1, ZMQ_DONTWAIT);
        if (length < 0)
            return errno == EAGAIN ? 0 : -1;
        routing[(size_t)length < size - 1 ? (size_t)length : size - 1] = 0;
    }
    zmq_msg_init(&content);
    if (zmq_msg_recv(&content, socket, ZMQ_DONTWAIT) < 0) {
        const int cause = errno;
        zmq_msg_close(&content);
        errno = cause;
        return cause == EAGAIN ? 0 : -1;
    }
    *message = wrap(&content);
    return 1;
}
