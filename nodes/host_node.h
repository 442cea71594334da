/* SPDX-License-Identifier: Apache-2.0 */
#ifndef HOST_NODE_H
#define HOST_NODE_H

#include "netsim/record.h"
#include "nodes/frame_plan.h"
#include "nodes/node.h"
#include "nodes/protocol.h"

/* The host: reads the scene frame by frame, hands primitives out, broadcasts everything else, and
 * keeps two frames under way (FACTS: double buffering). */

struct host_options {
    const char *scene;
    struct scene_options reading;
    uint32_t rendering_nodes, shading_nodes;
    struct machine machine;
    const struct strategy *strategy; /* of composition; NULL: the chain */
    const char *const *shader_folders;
    int shader_folder_count;
    int skipped_frames; /* of the scene, at its start */
    int frames;         /* 0: as many as the scene has; more than that repeat the last */
    uint64_t seed;
    const struct run_record *costs; /* regions go to shading nodes by what they cost there; NULL:
                                       region k to node k mod s */
    uint32_t chunk_triangles;       /* of a chunk, at most; 0: CHUNK_TRIANGLES_DEFAULT */
    const char
        *output; /* picture to write; NULL or "": none. See image_name.h for several frames */
    bool write_png;
    uint32_t compression; /* enum image_compression */
    struct shader_precision precision;
    struct shader_library *library; /* to compile shaders with instead of one of its own, which then
                                       has folders and precision; stays the caller's; NULL: none */
    bool allows_external; /* shaders may call extern "C" functions, which the nodes link */
    bool explain_work;    /* keep a work_record of each frame */
    bool is_recorded;     /* keep what every chunk and region cost, for host_report.record */
};

/* What the host tells whoever shows things to people; called from within node_step. All may be
 * NULL. */
struct host_observer {
    void *context;
    void (*warning)(void *context, const char *text);
    void (*shaders_compiled)(void *context, size_t shaders, size_t compiled);
    void (*progress)(void *context, int number, uint32_t regions_done, uint32_t regions);
    void (*frame_done)(void *context, const struct frame_record *record);
};

/* One shader instance as reports show it. */
struct instance_report {
    char name[64];
    const char *shader;
    uint32_t map_bytes; /* shader ID and parameters */
    struct planned_parameter *parameters;
    int parameter_count;
    uint64_t bound_bytes;
};

struct host_report {
    struct frame_record *frames;
    size_t frame_count;
    struct instance_report *instances; /* of the first frame */
    size_t instance_count;
    char **warnings;
    size_t warning_count;
    const struct shader_library *shaders;
    const struct run_record *record; /* complete once the run is over; NULL: not recorded */
};

/* `build_shaders` compiles the C sources of new shaders before any node is told of them; NULL to
 * let the shading nodes do it. Options are copied, except strings. */
bool host_node_create(const struct host_options *options, const struct host_observer *observer,
                      bool (*build_shaders)(void *context, const char *const *names,
                                            const char *const *sources, size_t count,
                                            size_t *compiled, struct status *status),
                      void *build_context, struct trace *trace, struct node **node,
                      struct status *status);
/* What is known by now; belongs to the node. */
const struct host_report *host_node_report(const struct node *node);
/* The name of the picture of a frame (docs/rendering.md): the pattern itself for a single frame;
 * otherwise the frame number replaces a "%04d"-like part, or is put before the suffix as ".0001".
 */
bool host_image_name(const char *pattern, bool is_sequence, int number, char *name, size_t size,
                     struct status *status);

#endif
