/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHARED_POOL_H
#define SHARED_POOL_H

#include "base/status.h"
#include "netsim/message.h"

#include <stdbool.h>
#include <stdint.h>

/* Memory that the nodes of a local cluster share, so that a region goes from node to node without
 * its bytes going through sockets: a small SHARED message says where it lies. Each node fills a
 * ring of its own and reuses blocks that nobody holds any more; anyone may pass on a block as it
 * is. Where the pool does not reach (other machines, a full ring, clusters started by hand)
 * messages go through the socket as ever: what they say is the same. */
struct shared_pool;

/* Makes the memory, a ring for each of `rings` nodes; returns a descriptor for children to inherit,
 * or -1. Pages are only taken as they are used. */
int shared_pool_create(uint32_t rings);
/* Maps it, to write to ring `ring`; NULL when the descriptor is not a pool with such a ring. */
struct shared_pool *shared_pool_open(int descriptor, uint32_t ring);
void shared_pool_close(struct shared_pool *pool);

/* The SHARED message to send in place of `message`, whose hold it takes over; or `message` itself
 * when it is better sent as it is. */
struct message *shared_pool_share(struct shared_pool *pool, struct message *message);
/* The message that a SHARED message speaks of, for the caller to release. */
bool shared_pool_receive(struct shared_pool *pool, const struct message *reference,
                         struct message **message, struct status *status);

#endif
