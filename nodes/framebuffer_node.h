/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FRAMEBUFFER_NODE_H
#define FRAMEBUFFER_NODE_H

#include "nodes/node.h"

/* The framebuffer node: collects shaded regions, blends samples into pixels, writes the picture,
 * and solves the simulated time of the frame from the costs that came with the regions. */
bool framebuffer_node_create(const struct node_services *services, struct trace *trace,
                             struct node **node, struct status *status);

#endif
