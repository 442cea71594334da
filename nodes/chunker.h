/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CHUNKER_H
#define CHUNKER_H

#include "netsim/record.h"
#include "nodes/frame_plan.h"

/* Sealed CHUNK messages in order, owned by whoever takes them out; and, when `is_recorded`, what a
 * record keeps of each (netsim/record.h). */
struct chunk_list {
    struct message **messages;
    size_t count, capacity;
    bool is_recorded;
    struct record_frame recorded; /* of which only chunks and sharing are filled in */
};
/* Frees the arrays, not the messages. */
void chunk_list_finish(struct chunk_list *list);

struct chunk_cutting {
    uint32_t frame_index;
    uint32_t triangles; /* of a chunk, at most: 1 to CHUNK_TRIANGLES_MAX */
    enum parameter_precision precision;
};

/* Cuts the meshes of a frame into chunks of consecutive triangles, each vertex with exactly the
 * material parameters of its instance's transfer map. Triangles of one-sided meshes that face away
 * are left out; primitive numbers count every triangle of the scene all the same. After a failure
 * `list` holds what there was by then. */
bool chunker_cut(const struct scene_frame *frame, const struct frame_plan *plan,
                 const struct chunk_cutting *cutting, struct chunk_list *list,
                 struct status *status);

#endif
