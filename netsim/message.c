/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/message.h"

#include <stdio.h>
#include <stdlib.h>

static void dispose_own(struct message *message) {
    free(message);
}

struct message *message_create(size_t length) {
    return message_create_with_room(length, 0);
}

struct message *message_create_with_room(size_t length, size_t room) {
    enum { ALIGNMENT = 64 };
    size_t head = (sizeof(struct message) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    size_t total = (head + length + room + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    struct message *message = aligned_alloc(ALIGNMENT, total);
    if (!message) {
        fprintf(stderr, "sortlast: out of memory (a message of %zu bytes)\n", length);
        abort();
    }
    atomic_init(&message->holders, 1);
    message->dispose = dispose_own;
    message->is_lent = NULL;
    message->length = length;
    message->capacity = length + room;
    message->bytes = (uint8_t *)message + head;
    return message;
}

bool message_is_exclusive(const struct message *message) {
    return atomic_load_explicit(&message->holders, memory_order_acquire) == 1 &&
           !(message->is_lent && message->is_lent(message));
}

struct message *message_hold(struct message *message) {
    atomic_fetch_add_explicit(&message->holders, 1, memory_order_relaxed);
    return message;
}

void message_release(struct message *message) {
    if (message && atomic_fetch_sub_explicit(&message->holders, 1, memory_order_acq_rel) == 1)
        message->dispose(message);
}
