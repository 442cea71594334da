/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STATUS_BOARD_H
#define STATUS_BOARD_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* A page shared by a local cluster's supervisor and its nodes, where each node says what it works
 * on: when one is killed, the supervisor still knows in which frame and region. */
struct status_board_entry {
    _Atomic uint32_t is_started, has_frame, region;
    _Atomic int32_t frame;
};

/* Makes an anonymous shared board; returns its file descriptor (inherited by children), or -1. */
int status_board_create(uint32_t entries, struct status_board_entry **board);
/* Maps the board behind an inherited descriptor; NULL when it is not one. */
struct status_board_entry *status_board_open(int descriptor, uint32_t entry);

#endif
