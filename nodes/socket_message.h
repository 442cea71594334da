/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SOCKET_MESSAGE_H
#define SOCKET_MESSAGE_H

#include "base/status.h"
#include "netsim/message.h"

#include <stdbool.h>

/* Messages in and out of libzmq sockets without copying their bytes where that can be avoided. */

/* Sends one hold of the message, not waiting: 1 sent, 0 the socket would block (the hold stays with
 * the caller), -1 failed with errno set. `routing`, if given, is sent in front as the address of a
 * ROUTER's peer. */
int socket_message_send(void *socket, const char *routing, struct message *message);

/* Receives a message if one is there, not waiting: 1 received, 0 none, -1 failed. A ROUTER's
 * address frame goes into `routing` (`size` bytes) when given. */
int socket_message_receive(void *socket, char *routing, size_t size, struct message **message);

#endif
