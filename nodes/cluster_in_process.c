/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/cluster_in_process.h"

#include "nodes/framebuffer_node.h"
#include "nodes/rendering_node.h"
#include "nodes/shading_node.h"
#include "nodes/visibility.h"

#include <stdlib.h>
#include <string.h>

bool cluster_in_process_run(struct node *host, uint32_t rendering_nodes, uint32_t shading_nodes,
                            const struct node_services *services, struct trace *trace,
                            const struct driver_options *driver, struct status *status) {
    struct node **nodes = memory_get((size_t)rendering_nodes + shading_nodes + 2, sizeof *nodes);
    size_t count = 0;
    struct visibility_device *device = NULL;
    nodes[count++] = host;
    bool ok = visibility_device_create(&device, status);
    for (uint32_t i = 0; ok && i < rendering_nodes; i++)
        ok = rendering_node_create(i, device, trace, &nodes[count], status), count += ok;
    for (uint32_t i = 0; ok && i < shading_nodes; i++)
        ok = shading_node_create(i, services, trace, &nodes[count], status), count += ok;
    if (ok)
        ok = framebuffer_node_create(services, trace, &nodes[count], status), count += ok;
    ok = ok && driver_in_process_run(nodes, count, driver, status);
    for (size_t i = 1; i < count; i++)
        node_destroy(nodes[i]);
    visibility_device_destroy(device);
    free(nodes);
    return ok;
}

/* Services that keep pictures and pass everything else on. */
struct keeping {
    const struct node_services *inner;
    struct cluster_pictures *pictures;
};

static bool load_shader(void *context, const char *name, const char *c_source,
                        const struct shader_module **module, struct status *status) {
    struct keeping *keeping = context;
    if (!keeping->inner->load_shader(keeping->inner->context, name, c_source, module, status))
        return false;
    if (keeping->pictures->probed && !strcmp(keeping->pictures->probed, c_source))
        keeping->pictures->module = (struct shader_module *)*module;
    return true;
}

static bool keep_image(void *context, struct image *image, const char *path, uint32_t compression,
                       bool as_png_too, struct status *status) {
    struct cluster_pictures *pictures = ((struct keeping *)context)->pictures;
    (void)path, (void)compression, (void)as_png_too, (void)status;
    pictures->images = memory_grow(pictures->images, &pictures->capacity, pictures->count + 1,
                                   sizeof(struct image *));
    pictures->images[pictures->count++] = image;
    return true;
}

static bool finish_images(void *context, struct status *status) {
    (void)context, (void)status;
    return true;
}

bool cluster_in_process_render(const struct host_options *options,
                               const struct node_services *services,
                               struct cluster_pictures *pictures, const volatile sig_atomic_t *stop,
                               struct status *status) {
    struct keeping keeping = {services, pictures};
    const struct node_services keepers = {&keeping, load_shader, keep_image, finish_images};
    struct host_options here = *options;
    here.rendering_nodes = here.shading_nodes = 1;
    here.output = "picture.exr";
    here.write_png = false;
    struct trace trace;
    struct node *host;
    trace_init(&trace, "cluster", NULL);
    if (!host_node_create(&here, NULL, NULL, NULL, &trace, &host, status))
        return false;
    const struct driver_options driver = {.stop = stop};
    const bool ok = cluster_in_process_run(host, 1, 1, &keepers, &trace, &driver, status);
    node_destroy(host);
    return ok;
}

void cluster_pictures_finish(struct cluster_pictures *pictures) {
    for (size_t i = 0; i < pictures->count; i++)
        image_destroy(pictures->images[i]);
    free(pictures->images);
    pictures->images = NULL;
    pictures->count = pictures->capacity = 0;
}
