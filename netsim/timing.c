/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/timing.h"

#include <stdlib.h>
#include <string.h>

/* Symbols as in docs/timing.md. n counts regions through all frames, i rendering nodes, j shading
 * nodes. */
struct timing_model {
    struct machine machine;
    uint32_t rendering_nodes, shading_nodes;
    uint32_t buffers; /* region buffers of a node */

    uint32_t frame;
    ticks geometry_end;    /* of the frame before */
    ticks *frame_released; /* ring of geometry_frame_buffers: when a frame's primitives are all
                              rastered */
    ticks link_free;       /* first composition link, at its sender's end */
    ticks colour_end;      /* of the last colours into the framebuffer */
    ticks frame_end;       /* of the frame before */
    ticks *raster_end;     /* [i] of the last region with work */
    ticks *raster_buffer;  /* [i][buffers]: when the transfer out of that buffer ended */
    uint32_t *raster_next; /* [i] next buffer */
    ticks *shading_end;    /* [j] */
    ticks
        *shading_buffer; /* [j][buffers]: when the colours of the region in that buffer had left */
    uint32_t *shading_next;            /* [j] */
    ticks *raster_busy, *shading_busy; /* of the current frame */
};

const char *timing_resource_name(enum timing_resource resource) {
    static const char *const names[] = {
#define TIMING_RESOURCE_NAME(name, text) text,
        TIMING_RESOURCES(TIMING_RESOURCE_NAME)
#undef TIMING_RESOURCE_NAME
    };
    return names[resource];
}

struct timing_model *timing_model_create(const struct machine *machine, uint32_t rendering_nodes,
                                         uint32_t shading_nodes) {
    struct timing_model *model = memory_get(1, sizeof *model);
    model->machine = *machine;
    model->rendering_nodes = rendering_nodes;
    model->shading_nodes = shading_nodes;
    model->buffers = (uint32_t)machine->composition_region_buffers;
    model->frame_released = memory_get((size_t)machine->geometry_frame_buffers, sizeof(ticks));
    model->raster_end = memory_get(rendering_nodes, sizeof(ticks));
    model->raster_buffer = memory_get((size_t)rendering_nodes * model->buffers, sizeof(ticks));
    model->raster_next = memory_get(rendering_nodes, sizeof(uint32_t));
    model->shading_end = memory_get(shading_nodes, sizeof(ticks));
    model->shading_buffer = memory_get((size_t)shading_nodes * model->buffers, sizeof(ticks));
    model->shading_next = memory_get(shading_nodes, sizeof(uint32_t));
    model->raster_busy = memory_get(rendering_nodes, sizeof(ticks));
    model->shading_busy = memory_get(shading_nodes, sizeof(ticks));
    return model;
}

void timing_model_destroy(struct timing_model *model) {
    if (!model)
        return;
    free(model->frame_released);
    free(model->raster_end);
    free(model->raster_buffer);
    free(model->raster_next);
    free(model->shading_end);
    free(model->shading_buffer);
    free(model->shading_next);
    free(model->raster_busy);
    free(model->shading_busy);
    free(model);
}

/* Raster of one region on every node that has work in it; returns the earliest time at which the
 * first node may begin to send, so that each node is ready when the transfer reaches it. */
static ticks raster_region(struct timing_model *model, const struct timing_region *region,
                           ticks geometry_end) {
    const struct machine *machine = &model->machine;
    ticks ready = geometry_end;
    for (uint32_t w = 0; w < region->work_count; w++) {
        const uint32_t i = region->work[w].node;
        ticks cost = ticks_add(machine->raster_region,
                               ticks_multiply(machine->raster_triangle, region->work[w].triangles));
        ticks begin = ticks_max(model->raster_end[i], geometry_end);
        begin = ticks_max(begin, model->raster_buffer[i * model->buffers + model->raster_next[i]]);
        model->raster_end[i] = ticks_add(begin, cost);
        model->raster_busy[i] = ticks_add(model->raster_busy[i], cost);
        /* the transfer passes node i after i hops */
        ready =
            ticks_max(ready, model->raster_end[i] - ticks_multiply(machine->composition_hop, i));
    }
    return ready;
}

static void hold_raster_buffers(struct timing_model *model, const struct timing_region *region,
                                ticks transfer_end) {
    for (uint32_t w = 0; w < region->work_count; w++) {
        const uint32_t i = region->work[w].node;
        model->raster_buffer[i * model->buffers + model->raster_next[i]] =
            ticks_add(transfer_end, ticks_multiply(model->machine.composition_hop, i));
        model->raster_next[i] = (model->raster_next[i] + 1) % model->buffers;
    }
}

static void add_region(struct timing_model *model, const struct timing_region *region, uint32_t k,
                       ticks geometry_end, struct timing_result *result) {
    const struct machine *machine = &model->machine;
    const ticks hop = machine->composition_hop;
    const uint32_t j = k % model->shading_nodes;
    const ticks chain = ticks_multiply(hop, (int64_t)model->rendering_nodes + j);
    const int64_t samples = machine_region_samples(machine);
    const bool is_token = region->words == 0;
    const ticks transfer = is_token
                               ? machine->composition_word
                               : ticks_multiply(machine->composition_word, samples * region->words);
    ticks *buffer = &model->shading_buffer[j * model->buffers + model->shading_next[j]];

    ticks begin = ticks_max(raster_region(model, region, geometry_end), model->link_free);
    if (!is_token && *buffer > chain)
        begin = ticks_max(begin, *buffer - chain);
    ticks end = ticks_add(begin, transfer);
    model->link_free = end;
    hold_raster_buffers(model, region, end);
    result->composition_busy = ticks_add(result->composition_busy, transfer);
    ticks arrived = ticks_add(end, chain);
    if (is_token) {
        /* the token runs on to the framebuffer */
        arrived = ticks_add(arrived, ticks_multiply(hop, (int64_t)model->shading_nodes - j));
        result->end = ticks_max(result->end, arrived);
        return;
    }
    ticks shaded = ticks_add(ticks_max(arrived, model->shading_end[j]), region->shading);
    model->shading_end[j] = shaded;
    model->shading_busy[j] = ticks_add(model->shading_busy[j], region->shading);
    /* colours of successive regions enter the framebuffer one after the other, in order of regions
     */
    const ticks way = ticks_multiply(hop, (int64_t)model->shading_nodes - j);
    const ticks colours =
        ticks_multiply(machine->composition_word, samples * machine->colour_words);
    model->colour_end = ticks_add(ticks_max(ticks_add(shaded, way), model->colour_end), colours);
    result->framebuffer_busy = ticks_add(result->framebuffer_busy, colours);
    *buffer = model->colour_end - way;
    model->shading_next[j] = (model->shading_next[j] + 1) % model->buffers;
    result->end = ticks_max(result->end, model->colour_end);
}

static enum timing_resource longest_resource(const struct timing_model *model,
                                             const struct timing_result *result) {
    ticks busy[TIMING_RESOURCE_COUNT] = {
        [TIMING_COMPOSITION] = result->composition_busy,
        [TIMING_GEOMETRY] = result->geometry_busy,
        [TIMING_FRAMEBUFFER] = result->framebuffer_busy,
    };
    for (uint32_t i = 0; i < model->rendering_nodes; i++)
        busy[TIMING_RASTER] = ticks_max(busy[TIMING_RASTER], model->raster_busy[i]);
    for (uint32_t j = 0; j < model->shading_nodes; j++)
        busy[TIMING_SHADING] = ticks_max(busy[TIMING_SHADING], model->shading_busy[j]);
    enum timing_resource longest = TIMING_COMPOSITION;
    for (int resource = 0; resource < TIMING_RESOURCE_COUNT; resource++)
        if (busy[resource] > busy[longest])
            longest = (enum timing_resource)resource;
    return longest;
}

bool timing_model_add_frame(struct timing_model *model, const struct timing_frame *frame,
                            struct timing_result *result, struct status *status) {
    const struct machine *machine = &model->machine;
    *result = (struct timing_result){.raster_busy = model->raster_busy,
                                     .shading_busy = model->shading_busy};
    memset(model->raster_busy, 0, model->rendering_nodes * sizeof(ticks));
    memset(model->shading_busy, 0, model->shading_nodes * sizeof(ticks));

    ticks *released = &model->frame_released[model->frame % machine->geometry_frame_buffers];
    const uint64_t word = (uint64_t)machine->geometry_word_bytes;
    const uint64_t words = frame->geometry_bytes / word + (frame->geometry_bytes % word != 0);
    if (words > INT64_MAX)
        return status_fail(status, STATUS_LIMIT, "a frame of more than 2^63 words of geometry");
    result->geometry_busy = ticks_multiply(machine->geometry_word, (int64_t)words);
    result->start = ticks_max(model->geometry_end, *released);
    model->geometry_end = ticks_add(result->start, result->geometry_busy);

    /* a frame is not over before the one before it is */
    result->end = ticks_max(model->geometry_end, model->frame_end);
    for (uint32_t k = 0; k < frame->region_count; k++)
        add_region(model, &frame->regions[k], k, model->geometry_end, result);
    /* the frame's buffers are free when every node has rastered its last region of it */
    *released = model->geometry_end;
    for (uint32_t i = 0; i < model->rendering_nodes; i++)
        *released = ticks_max(*released, model->raster_end[i]);

    if (ticks_overflowed(result->end) || ticks_overflowed(result->composition_busy))
        return status_fail(status, STATUS_LIMIT,
                           "simulated time passes 63 bits of ticks (%llu a second) in frame %u",
                           (unsigned long long)machine->rate.per_s, model->frame);
    result->time = result->end - model->frame_end;
    result->bound_by = longest_resource(model, result);
    model->frame_end = result->end;
    model->frame++;
    return true;
}
