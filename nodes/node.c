/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/node.h"

#include <stdio.h>

const char *node_role_name(enum node_role role) {
    static const char *const names[] = {
#define NODE_ROLE_NAME(name, text, program) text,
        NODE_ROLES(NODE_ROLE_NAME)
#undef NODE_ROLE_NAME
    };
    return names[role];
}

const char *node_role_program(enum node_role role) {
    static const char *const programs[] = {
#define NODE_ROLE_PROGRAM(name, text, program) program,
        NODE_ROLES(NODE_ROLE_PROGRAM)
#undef NODE_ROLE_PROGRAM
    };
    return programs[role];
}

uint32_t node_address_pack(struct node_address address) {
    return (uint32_t)address.role << 24 | (address.index & 0xffffff);
}

struct node_address node_address_unpack(uint32_t packed) {
    uint32_t role = packed >> 24;
    return (struct node_address){role < NODE_ROLE_COUNT ? (enum node_role)role : NODE_HOST,
                                 packed & 0xffffff};
}

const char *node_address_name(struct node_address address, char text[NODE_NAME_BYTES]) {
    if (address.role == NODE_RENDERING || address.role == NODE_SHADING)
        snprintf(text, NODE_NAME_BYTES, "%s %u", node_role_name(address.role), address.index);
    else
        snprintf(text, NODE_NAME_BYTES, "%s", node_role_name(address.role));
    return text;
}

void node_send(struct node_outputs *outputs, struct node_address to, struct message *message) {
    outputs->items =
        memory_grow(outputs->items, &outputs->capacity, outputs->count + 1, sizeof *outputs->items);
    outputs->items[outputs->count++] = (struct node_output){to, message};
}

bool node_step(struct node *node, const struct node_event *event, struct node_outputs *outputs,
               struct status *status) {
    return node->type->step(node, event, outputs, status);
}

void node_destroy(struct node *node) {
    if (node)
        node->type->destroy(node);
}

void node_works_on(struct node *node, int32_t frame, uint32_t region) {
    node->has_frame = true;
    node->frame = frame;
    node->region = region;
}

const char *node_place(bool has_frame, int32_t frame, uint32_t region,
                       char text[NODE_PLACE_BYTES]) {
    if (has_frame)
        snprintf(text, NODE_PLACE_BYTES, "in frame %d, region %u", frame, region);
    else
        snprintf(text, NODE_PLACE_BYTES, "before the first region of its first frame");
    return text;
}
