/* SPDX-License-Identifier: Apache-2.0 */
#ifndef VISIBILITY_H
#define VISIBILITY_H

#include "netsim/region.h"
#include "nodes/protocol.h"
#include "nodes/region_bins.h"

#include <stdint.h>

/* What a rendering node sees: its chunks of one frame in an Embree scene, and regions rendered from
 * it. */
struct visibility;

/* One Embree device for all rendering nodes of a process. */
struct visibility_device;
bool visibility_device_create(struct visibility_device **device, struct status *status);
void visibility_device_destroy(struct visibility_device *device);

/* Builds the scene of a frame; `records_work`: its bins list the work of every chunk. The chunks
 * are held by the messages, which the caller keeps until destroy. */
bool visibility_create(struct visibility_device *device, const struct frame_payload *frame,
                       const struct region_grid *grid, const struct chunk_payload *chunks,
                       size_t chunk_count, bool records_work, struct visibility **visibility,
                       struct status *status);
void visibility_destroy(struct visibility *visibility);

const struct region_bins *visibility_bins(const struct visibility *visibility);

/* Renders a region that has a bin: casts a ray through each sample of the marked tiles and returns
 * depth, primitive, shader ID and the material parameters interpolated there, not sealed; raster
 * work is entered for rendering node `node`. The caller seals the draft or releases its message. */
struct region_draft visibility_render(struct visibility *visibility, uint32_t region,
                                      uint32_t node);

#endif
