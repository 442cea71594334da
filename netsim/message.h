/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MESSAGE_H
#define MESSAGE_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

/* A message in memory: bytes with a count of holders, so that a broadcast, a forwarded region or a
 * region kept until its frame is complete costs no copy. Bytes are at least 8-byte aligned and do
 * not change once shared. */
struct message {
    atomic_int holders;
    size_t length;
    uint8_t *bytes;
    void (*dispose)(struct message *message); /* frees message and bytes when the last hold goes */
};

/* A new message with one holder, contents not set. */
struct message *message_create(size_t length);
struct message *message_hold(struct message *message);
/* Gives up one hold; the last frees. NULL is accepted. */
void message_release(struct message *message);

#endif
