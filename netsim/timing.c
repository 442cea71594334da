/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/timing.h"

#include "netsim/timeline.h"

#include <stdlib.h>
#include <string.h>

/* Symbols as in docs/timing.md. n counts regions through all frames, i rendering nodes, j shading
 * nodes. */
struct raster_node {
    ticks end;       /* of the last region with work */
    ticks busy;      /* of the current frame */
    uint32_t buffer; /* next of its region buffers */
};

struct shading_node_time {
    ticks end, busy;
    uint32_t buffer;
};

struct timing_model {
    struct machine machine;
    const struct strategy *strategy;
    void *links; /* the strategy's state */
    uint32_t rendering_nodes, shading_nodes;
    uint32_t buffers; /* region buffers of a node */
    ticks colours;    /* of one region, over a link */

    uint32_t frame;
    ticks geometry_end;    /* of the frame before */
    ticks *frame_released; /* ring of geometry_frame_buffers: when a frame's primitives are all
                              rastered */
    ticks colour_end;      /* of the last colours into the framebuffer */
    ticks frame_end;       /* of the frame before */
    struct raster_node *raster;
    ticks *raster_buffer; /* [i][buffers]: when the transfer out of that buffer ended */
    struct shading_node_time *shading;
    ticks
        *shading_buffer; /* [j][buffers]: when the colours of the region in that buffer had left */
    ticks *ready, *released;           /* scratch of one region, by work entry */
    ticks *raster_busy, *shading_busy; /* of the current frame, as results show them */
    struct timeline *timeline;         /* NULL: nobody asks */
};

const char *timing_resource_name(enum timing_resource resource) {
    static const char *const names[] = {
#define TIMING_RESOURCE_NAME(name, text) text,
        TIMING_RESOURCES(TIMING_RESOURCE_NAME)
#undef TIMING_RESOURCE_NAME
    };
    return names[resource];
}

struct timing_model *timing_model_create(const struct machine *machine,
                                         const struct strategy *strategy, uint32_t rendering_nodes,
                                         uint32_t shading_nodes) {
    struct timing_model *model = memory_get(1, sizeof *model);
    model->machine = *machine;
    model->strategy = strategy;
    model->links = strategy->create(machine, rendering_nodes, shading_nodes);
    model->rendering_nodes = rendering_nodes;
    model->shading_nodes = shading_nodes;
    model->buffers = (uint32_t)machine->composition_region_buffers;
    model->colours = ticks_multiply(machine->composition_word,
                                    machine_region_samples(machine) * machine->colour_words);
    model->frame_released = memory_get((size_t)machine->geometry_frame_buffers, sizeof(ticks));
    model->raster = memory_get(rendering_nodes, sizeof *model->raster);
    model->raster_buffer = memory_get((size_t)rendering_nodes * model->buffers, sizeof(ticks));
    model->shading = memory_get(shading_nodes, sizeof *model->shading);
    model->shading_buffer = memory_get((size_t)shading_nodes * model->buffers, sizeof(ticks));
    model->ready = memory_get(rendering_nodes, sizeof(ticks));
    model->released = memory_get(rendering_nodes, sizeof(ticks));
    model->raster_busy = memory_get(rendering_nodes, sizeof(ticks));
    model->shading_busy = memory_get(shading_nodes, sizeof(ticks));
    return model;
}

void timing_model_destroy(struct timing_model *model) {
    if (!model)
        return;
    model->strategy->destroy(model->links);
    free(model->frame_released);
    free(model->raster);
    free(model->raster_buffer);
    free(model->shading);
    free(model->shading_buffer);
    free(model->ready);
    free(model->released);
    free(model->raster_busy);
    free(model->shading_busy);
    free(model);
}

void timing_model_record(struct timing_model *model, struct timeline *timeline) {
    model->timeline = timeline;
}

/* Raster of one region on every node that has work in it: fills in when each is ready. */
static void raster_region(struct timing_model *model, const struct timing_region *region,
                          ticks geometry_end) {
    const ticks per_region = model->machine.raster_region,
                per_triangle = model->machine.raster_triangle;
    const uint32_t buffers = model->buffers;
    for (uint32_t w = 0; w < region->work_count; w++) {
        const uint32_t i = region->work[w].node;
        struct raster_node *node = &model->raster[i];
        const ticks cost =
            ticks_add(per_region, ticks_multiply(per_triangle, region->work[w].triangles));
        ticks begin = ticks_max(node->end, geometry_end);
        begin = ticks_max(begin, model->raster_buffer[(size_t)i * buffers + node->buffer]);
        node->end = model->ready[w] = ticks_add(begin, cost);
        node->busy = ticks_add(node->busy, cost);
    }
}

static void hold_raster_buffers(struct timing_model *model, const struct timing_region *region) {
    const uint32_t buffers = model->buffers;
    for (uint32_t w = 0; w < region->work_count; w++) {
        const uint32_t i = region->work[w].node;
        struct raster_node *node = &model->raster[i];
        model->raster_buffer[(size_t)i * buffers + node->buffer] = model->released[w];
        node->buffer = node->buffer + 1 == buffers ? 0 : node->buffer + 1;
    }
}

/* Shading and colours of a region that arrived at shading node j. */
static void shade_region(struct timing_model *model, uint32_t j, ticks arrival, ticks cost,
                         ticks way, struct timeline_region *happened) {
    struct shading_node_time *node = &model->shading[j];
    const ticks begin = ticks_max(arrival, node->end), shaded = ticks_add(begin, cost);
    node->end = shaded;
    node->busy = ticks_add(node->busy, cost);
    /* colours of successive regions enter the framebuffer one after the other, in order of regions
     */
    const ticks colour_begin = ticks_max(ticks_add(shaded, way), model->colour_end);
    model->colour_end = ticks_add(colour_begin, model->colours);
    model->shading_buffer[(size_t)j * model->buffers + node->buffer] = model->colour_end - way;
    node->buffer = node->buffer + 1 == model->buffers ? 0 : node->buffer + 1;
    happened->shading_begin = begin;
    happened->shading_end = shaded;
    happened->colour_begin = colour_begin;
    happened->end = model->colour_end;
}

static void add_region(struct timing_model *model, const struct timing_frame *frame, uint32_t k,
                       struct timing_result *result) {
    const struct machine *machine = &model->machine;
    const struct timing_region *region = &frame->regions[k];
    const uint32_t j = frame->shading_node ? frame->shading_node[k] : k % model->shading_nodes;
    const bool is_token = region->words == 0;
    const struct shading_node_time *shading = &model->shading[j];
    const struct strategy_region composed = {
        .frame = model->frame,
        .region = k,
        .shading_node = j,
        .words = region->words,
        .transfer = is_token ? machine->composition_word
                             : ticks_multiply(machine->composition_word,
                                              machine_region_samples(machine) * region->words),
        .earliest = model->geometry_end,
        .room = is_token ? 0 : model->shading_buffer[(size_t)j * model->buffers + shading->buffer],
        .work_count = region->work_count,
        .work = region->work,
        .ready = model->ready,
        .wants_hold = model->timeline != NULL,
    };
    struct strategy_times times = {.released = model->released};
    struct timeline_region happened = {.composed = &composed, .times = &times};
    raster_region(model, region, model->geometry_end);
    model->strategy->compose(model->links, &composed, &times);
    hold_raster_buffers(model, region);
    result->composition_busy = ticks_add(result->composition_busy, times.busy);
    result->composition_bytes =
        ticks_add(result->composition_bytes,
                  ticks_multiply(times.arriving_words, machine->composition_word_bytes));
    result->composition_sent_bytes =
        ticks_add(result->composition_sent_bytes,
                  ticks_multiply(times.sent_words, machine->composition_word_bytes));
    const ticks way = model->strategy->plan ? machine->composition_hop
                                            : ticks_multiply(machine->composition_hop,
                                                             (int64_t)model->shading_nodes - j);
    if (is_token) { /* runs on to the framebuffer */
        happened.end = ticks_add(times.arrival, way);
    } else {
        shade_region(model, j, times.arrival, region->shading, way, &happened);
        result->framebuffer_busy = ticks_add(result->framebuffer_busy, model->colours);
    }
    result->end = ticks_max(result->end, happened.end);
    if (model->timeline)
        timeline_add_region(model->timeline, &happened);
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

/* Geometry of the next frame over its network; returns where its release will be noted. */
static bool add_geometry(struct timing_model *model, const struct timing_frame *frame,
                         struct timing_result *result, struct status *status) {
    const struct machine *machine = &model->machine;
    const uint64_t word = (uint64_t)machine->geometry_word_bytes;
    const uint64_t words = frame->geometry_bytes / word + (frame->geometry_bytes % word != 0);
    if (words > INT64_MAX)
        return status_fail(status, STATUS_LIMIT, "a frame of more than 2^63 words of geometry");
    result->geometry_busy = ticks_multiply(machine->geometry_word, (int64_t)words);
    result->start = ticks_max(
        model->geometry_end, model->frame_released[model->frame % machine->geometry_frame_buffers]);
    model->geometry_end = ticks_add(result->start, result->geometry_busy);
    if (model->timeline)
        timeline_begin_frame(model->timeline, result->start, model->geometry_end);
    return true;
}

/* The frame's buffers are free when every node has rastered its last region of it. Collects what
 * each node was busy. Overflow of any raster shows in the release: ends never decrease. */
static ticks release_frame(struct timing_model *model) {
    ticks released = model->geometry_end;
    for (uint32_t i = 0; i < model->rendering_nodes; i++) {
        released = ticks_max(released, model->raster[i].end);
        model->raster_busy[i] = model->raster[i].busy;
        model->raster[i].busy = 0;
    }
    for (uint32_t j = 0; j < model->shading_nodes; j++) {
        model->shading_busy[j] = model->shading[j].busy;
        model->shading[j].busy = 0;
    }
    return released;
}

bool timing_model_add_frame(struct timing_model *model, const struct timing_frame *frame,
                            struct timing_result *result, struct status *status) {
    const struct machine *machine = &model->machine;
    *result = (struct timing_result){.raster_busy = model->raster_busy,
                                     .shading_busy = model->shading_busy};
    ticks *released = &model->frame_released[model->frame % machine->geometry_frame_buffers];
    if (!add_geometry(model, frame, result, status))
        return false;
    /* a frame is not over before the one before it is */
    result->end = ticks_max(model->geometry_end, model->frame_end);
    for (uint32_t k = 0; k < frame->region_count; k++)
        add_region(model, frame, k, result);
    *released = release_frame(model);
    if (ticks_overflowed(result->end) || ticks_overflowed(result->composition_busy) ||
        ticks_overflowed(*released))
        return status_fail(status, STATUS_LIMIT,
                           "simulated time passes 63 bits of ticks (%llu a second) in frame %u",
                           (unsigned long long)machine->rate.per_s, model->frame);
    if (ticks_overflowed(result->composition_sent_bytes))
        return status_fail(status, STATUS_LIMIT,
                           "more than 2^63 bytes on the composition network in frame %u",
                           model->frame);
    result->time = result->end - model->frame_end;
    result->bound_by = longest_resource(model, result);
    if (model->timeline)
        timeline_end_frame(model->timeline, result->end);
    model->frame_end = result->end;
    model->frame++;
    return true;
}
