/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CHUNKER_H
#define CHUNKER_H

#include "nodes/frame_plan.h"

/* Cuts the meshes of a frame into chunks of at most CHUNK_TRIANGLES_MAX consecutive triangles, each
 * vertex with exactly the material parameters of its instance's transfer map. Triangles of
 * one-sided meshes that face away are left out; primitive numbers count every triangle of the scene
 * all the same.
 *
 * Returns sealed CHUNK messages, in order; array and messages are the caller's. */
bool chunker_cut(const struct scene_frame *frame, const struct frame_plan *plan,
                 uint32_t frame_index, struct message ***chunks, size_t *chunk_count,
                 struct status *status);

#endif
