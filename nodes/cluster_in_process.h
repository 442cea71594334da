/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CLUSTER_IN_PROCESS_H
#define CLUSTER_IN_PROCESS_H

#include "images/image.h"
#include "nodes/driver_in_process.h"
#include "nodes/host_node.h"

/* A whole cluster in this process and thread: makes rendering, shading and framebuffer nodes beside
 * the host, which stays the caller's, and runs them until it is finished. */
bool cluster_in_process_run(struct node *host, uint32_t rendering_nodes, uint32_t shading_nodes,
                            const struct node_services *services, struct trace *trace,
                            const struct driver_options *driver, struct status *status);

/* Pictures kept in memory instead of written. */
struct cluster_pictures {
    struct image **images; /* one a frame; owned */
    size_t count, capacity;
    const char *probed;           /* a shader's name, whose module is wanted; NULL: none */
    struct shader_module *module; /* that one; NULL: never loaded */
};

/* Renders frames with one rendering node and one shading node. `options->output` is not looked at;
 * modules come from `services`. The caller finishes `pictures`, which it has zeroed but for
 * `probed`. */
bool cluster_in_process_render(const struct host_options *options,
                               const struct node_services *services,
                               struct cluster_pictures *pictures, const volatile sig_atomic_t *stop,
                               struct status *status);
void cluster_pictures_finish(struct cluster_pictures *pictures);

#endif
