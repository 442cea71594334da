/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RENDERING_NODE_H
#define RENDERING_NODE_H

#include "nodes/node.h"

/* A rendering node: keeps its chunks of a frame, and as regions come down the chain (the first node
 * begins them) renders its part of each and sends the nearer samples on (PF section 5.1). */
struct visibility_device;

/* `device` is shared by the nodes of one process and outlives them. */
bool rendering_node_create(uint32_t index, struct visibility_device *device, struct trace *trace,
                           struct node **node, struct status *status);

#endif
