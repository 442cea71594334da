/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADING_NODE_H
#define SHADING_NODE_H

#include "nodes/node.h"

/* A shading node: takes composed regions, rebuilds positions from depth, runs the surface shader of
 * each instance present and the lights they share, and sends colours to the framebuffer node (PF
 * section 6.1). */
bool shading_node_create(uint32_t index, const struct node_services *services, struct trace *trace,
                         struct node **node, struct status *status);

#endif
