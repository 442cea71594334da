/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MESSAGE_H
#define MESSAGE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A message in memory: bytes with a count of holders, so that a broadcast, a forwarded region or a
 * region kept until its frame is complete costs no copy. Bytes are at least 8-byte aligned and do
 * not change once shared; who alone holds a message may change it (message_is_exclusive). */
struct message {
    atomic_int holders;
    size_t length;
    size_t capacity; /* bytes there is room for, `length` or more */
    uint8_t *bytes;
    void (*dispose)(struct message *message); /* frees message and bytes when the last hold goes */
    bool (*is_lent)(const struct message *message); /* NULL: never. Others see the bytes */
};

/* A new message with one holder, contents not set; `room`: bytes that it may grow by. */
struct message *message_create(size_t length);
struct message *message_create_with_room(size_t length, size_t room);
/* Whether the caller, who has one hold, is the only one who can see the bytes. */
bool message_is_exclusive(const struct message *message);
struct message *message_hold(struct message *message);
/* Gives up one hold; the last frees. NULL is accepted. */
void message_release(struct message *message);

#endif
