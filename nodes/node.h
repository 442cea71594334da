/* SPDX-License-Identifier: Apache-2.0 */
#ifndef NODE_H
#define NODE_H

#include "base/status.h"
#include "base/trace.h"
#include "netsim/message.h"
#include "netsim/wire.h"

#include <stdbool.h>
#include <stdint.h>

/* A node is a state machine without sockets, clocks, threads or randomness: an event goes in,
 * messages come out. Drivers (driver_in_process.h, driver_sockets.h) host the very same nodes, so
 * that the picture and the simulated time cannot depend on how they are run (contracts C1, C2). */

/* X(NAME, name for people, name of its program) */
#define NODE_ROLES(X)                                                                              \
    X(HOST, "host", "sortlast-host")                                                               \
    X(RENDERING, "rendering node", "sortlast-rendering-node")                                      \
    X(SHADING, "shading node", "sortlast-shading-node")                                            \
    X(FRAMEBUFFER, "framebuffer node", "sortlast-framebuffer-node")
enum node_role {
#define NODE_ROLE_ENUM(name, text, program) NODE_##name,
    NODE_ROLES(NODE_ROLE_ENUM)
#undef NODE_ROLE_ENUM
        NODE_ROLE_COUNT
};

struct node_address {
    enum node_role role;
    uint32_t index; /* among the nodes of its role; 0 for host and framebuffer node */
};

const char *node_role_name(enum node_role role);
const char *node_role_program(enum node_role role);
uint32_t node_address_pack(struct node_address address);
struct node_address node_address_unpack(uint32_t packed);
/* "rendering node 3", "framebuffer node"; the text lives in `text`. */
enum { NODE_NAME_BYTES = 40 };
const char *node_address_name(struct node_address address, char text[NODE_NAME_BYTES]);

enum node_event_kind {
    NODE_START,   /* once, before anything else */
    NODE_MESSAGE, /* `message` arrived; its header is checked and taken apart in `header` */
    NODE_WORK,    /* the node said has_work, and the driver has nothing more urgent */
};

struct node_event {
    enum node_event_kind kind;
    struct message *message; /* the driver's; hold it to keep it */
    struct wire_header header;
};

struct node_output {
    struct node_address to;
    struct message *message; /* one hold, passed on */
};

struct node_outputs {
    struct node_output *items;
    size_t count, capacity;
};

/* Takes over one hold of the message. */
void node_send(struct node_outputs *outputs, struct node_address to, struct message *message);

struct node;

struct node_type {
    /* Handles one event; appends what is to be sent. A failure ends the run: the status names node,
     * frame and region where they apply. */
    bool (*step)(struct node *node, const struct node_event *event, struct node_outputs *outputs,
                 struct status *status);
    /* Says in a line what the node waits for and from whom, for people: on SIGUSR1 and expired
     * deadlines. */
    void (*describe)(const struct node *node, char *text, size_t size);
    void (*destroy)(struct node *node);
};

/* The head of every node's own structure. */
struct node {
    const struct node_type *type;
    struct node_address address;
    bool has_work;     /* wants NODE_WORK events */
    bool takes_always; /* others may wait for it while it waits for them: its driver gives it
                          messages even while its own cannot be sent */
    bool is_finished;  /* has nothing more to do; its driver may end */
    bool is_closing; /* host: all others but the framebuffer node, which says goodbye, may leave */
    /* what it works on, for people: the frame as the scene counts (FrameBegin) */
    bool has_frame;
    int32_t frame;
    uint32_t region;
    struct trace *trace;
};

bool node_step(struct node *node, const struct node_event *event, struct node_outputs *outputs,
               struct status *status);
void node_destroy(struct node *node);

/* Notes what the node works on. */
void node_works_on(struct node *node, int32_t frame, uint32_t region);
/* "in frame 3, region 17", or that it has not come to a region of a frame yet; the text lives in
 * `text`. */
enum { NODE_PLACE_BYTES = 64 };
const char *node_place(bool has_frame, int32_t frame, uint32_t region, char text[NODE_PLACE_BYTES]);

/* What nodes need from the world around them; drivers of tests may replace them. */
struct shader_module;
struct image;
struct node_services {
    void *context;
    /* The compiled module of a shader's C source; lives until the program ends. Blocks while it
     * compiles. */
    bool (*load_shader)(void *context, const char *name, const char *c_source,
                        const struct shader_module **module, struct status *status);
    /* Takes the image over and writes it; may return before it is written. */
    bool (*write_image)(void *context, struct image *image, const char *path, uint32_t compression,
                        bool as_png_too, struct status *status);
    /* Waits until all images are written. */
    bool (*finish_images)(void *context, struct status *status);
};

#endif
