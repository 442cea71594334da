/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHARED_POOL_H
#define SHARED_POOL_H

#include "base/status.h"
#include "netsim/message.h"

#include <stdbool.h>
#include <stdint.h>

/* Memory that the nodes of a local cluster share, so that a region goes from node to node without
 * its bytes going through sockets: a small SHARED message says where it lies. Each node fills a
 * shelf of its own and reuses what nobody holds any more; anyone may pass on a block as it
 * is. Where the pool does not reach (other machines, a full shelf, clusters started by hand)
 * messages go through the socket as ever: what they say is the same. */
struct shared_pool;

/* Makes the memory, a shelf for each of `shelves` nodes; returns a descriptor for children to
 * inherit, or -1. Pages are only taken as they are used. */
int shared_pool_create(uint32_t shelves);
/* Maps it, to write to one shelf; NULL when the descriptor is not a pool with such a shelf. */
struct shared_pool *shared_pool_open(int descriptor, uint32_t shelf);
void shared_pool_close(struct shared_pool *pool);

/* Where a message lies in the pool. */
struct shared_reference {
    uint64_t offset, length;
};

/* How many references go together at most: to be woken for each costs as much as to compose it. */
enum { SHARED_REFERENCES_MAX = 4 };

/* Puts a message into the pool, unless it came from there; takes over its hold. False, and the hold
 * stays with the caller, when it is better sent as it is: small, no room, no pool. */
bool shared_pool_put(struct shared_pool *pool, struct message *message,
                     struct shared_reference *reference);
/* The SHARED message to send instead of 1 to SHARED_REFERENCES_MAX messages. */
struct message *shared_references_encode(const struct shared_reference *references, size_t count);
bool shared_references_decode(const struct message *message, struct shared_reference *references,
                              size_t *count, struct status *status);
/* The message that a reference speaks of, for the caller to release. */
bool shared_pool_get(struct shared_pool *pool, struct shared_reference reference,
                     struct message **message, struct status *status);

#endif
