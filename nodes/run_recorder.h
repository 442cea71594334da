/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RUN_RECORDER_H
#define RUN_RECORDER_H

#include "netsim/record.h"
#include "nodes/frame_plan.h"

/* Puts the record of a run together on the host: what it sent, what the rendering nodes say of
 * their chunks, and what the framebuffer node says of the regions. Messages of a frame may come in
 * any order once it is begun. */
struct run_recorder;

struct run_recorder *run_recorder_create(const char *scene, const struct machine *machine,
                                         uint64_t seed, uint32_t chunk_triangles, bool fast_math,
                                         uint32_t rendering_nodes);
void run_recorder_destroy(struct run_recorder *recorder);

/* The next frame, in order of indices from 0. */
void run_recorder_begin_frame(struct run_recorder *recorder, int number,
                              const struct frame_payload *frame);
/* What the frame begun last is made of. */
void run_recorder_add_plan(struct run_recorder *recorder, const struct frame_plan *plan);
void run_recorder_add_chunks(struct run_recorder *recorder, const struct record_frame *chunks);
/* ... or that it is made of the same as the one before it. */
void run_recorder_repeat(struct run_recorder *recorder);
void run_recorder_end_frame(struct run_recorder *recorder, const uint64_t bytes[CAUSE_COUNT]);

/* A CHUNK_WORK or REGION_COSTS message. */
bool run_recorder_accept(struct run_recorder *recorder, const struct message *message,
                         const struct wire_header *header, struct status *status);
/* Has all of every frame begun arrived? */
bool run_recorder_is_complete(const struct run_recorder *recorder);
/* Belongs to the recorder. */
const struct run_record *run_recorder_record(const struct run_recorder *recorder);

#endif
