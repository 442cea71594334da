/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/framebuffer_node.h"

#include "nodes/frame_image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FRAMEBUFFER_FRAMES = 2,
    PROGRESS_STEPS = 32,       /* progress messages of a frame, */
    PROGRESS_REGIONS_MAX = 64, /* or one for so many regions: silence means that it is stuck */
};

/* What is known of one region: nothing, that it is empty, or its colours and costs. */
struct arrived_region {
    bool has_arrived;
    struct message *message; /* COLOUR, or REGION without samples; NULL: empty */
    bool is_coloured;
};

struct collected_frame {
    bool is_begun, is_complete;
    uint32_t index;
    struct message *frame_message;
    struct frame_payload frame;
    struct region_grid grid;
    uint64_t geometry_bytes[CAUSE_COUNT];
    struct arrived_region *regions;
    uint32_t arrived, added; /* regions here; regions already in the picture, in order */
    struct frame_image image;
    struct frame_record record;
    struct timing_region *timing;
    struct region_costs *costs; /* of covered regions, when the run is recorded; owns their work */
    size_t cost_count, cost_capacity;
};

struct framebuffer_node {
    struct node node;
    const struct node_services *services;
    bool is_configured;
    struct configuration configuration;
    struct timing_model *timing;
    struct collected_frame frames[FRAMEBUFFER_FRAMES];
    uint32_t next_frame; /* frames are finished in order */
    /* regions that arrived before their frame began here */
    struct early_message {
        struct message *message;
        struct wire_header header;
    } * early;
    size_t early_count, early_capacity;
};

static const struct node_address host_address = {NODE_HOST, 0};

static struct collected_frame *frame_of(struct framebuffer_node *self, uint32_t frame) {
    struct collected_frame *slot = &self->frames[frame % FRAMEBUFFER_FRAMES];
    return slot->is_begun && slot->index == frame ? slot : NULL;
}

static void frame_finish(struct collected_frame *frame) {
    for (uint32_t k = 0; frame->regions && k < frame->grid.count; k++)
        message_release(frame->regions[k].message);
    for (uint32_t k = 0; frame->timing && k < frame->grid.count; k++)
        free((void *)frame->timing[k].work);
    for (size_t i = 0; i < frame->cost_count; i++)
        free((void *)frame->costs[i].work);
    free(frame->regions);
    free(frame->timing);
    free(frame->costs);
    frame_image_finish(&frame->image);
    frame_record_finish(&frame->record);
    message_release(frame->frame_message);
    *frame = (struct collected_frame){0};
}

static const struct timing_work *copy_work(const struct region_work *work, uint32_t count) {
    struct timing_work *copy = memory_get(count, sizeof *copy);
    for (uint32_t i = 0; i < count; i++)
        copy[i] = (struct timing_work){work[i].node, work[i].triangles};
    return copy;
}

/* Keeps what the region cost for the record of the run. */
static void keep_costs(struct collected_frame *frame, uint32_t region,
                       const struct colour_view *view) {
    struct shading_work *work = memory_get(view->shading_work_count, sizeof *work);
    memcpy(work, view->shading_work, view->shading_work_count * sizeof *work);
    frame->costs = memory_grow(frame->costs, &frame->cost_capacity, frame->cost_count + 1,
                               sizeof *frame->costs);
    frame->costs[frame->cost_count++] =
        (struct region_costs){.region = region,
                              .samples = view->head.sample_count,
                              .map_bytes = view->sums.map_bytes,
                              .work = work,
                              .work_count = view->shading_work_count};
}

/* Bytes of a frame on the composition network, by cause: whole words, as many as the strategy
 * brings to the shading nodes, and within them what the samples that came there say
 * (docs/timing.md). */
static void charge_composition(struct frame_record *record, const struct machine *machine,
                               const struct timing_result *times) {
    const uint64_t total = (uint64_t)times->composition_bytes;
    record->composition.total = total;
    record->composition.sent = (uint64_t)times->composition_sent_bytes;
    record->composition.depth = total / (uint64_t)machine->composition_word_bytes *
                                (uint64_t)machine->composition_depth_bytes;
    record->composition.padding = total - record->composition.depth -
                                  record->composition.shader_id - record->composition.parameters;
}

/* Adds what one region cost to the record of the frame's work. */
static void keep_work(struct work_record *record, const struct region_head *head) {
    record->regions_touched++;
    record->rays += head->rays;
    record->composed += head->composed;
}

static void keep_shading_work(struct work_record *record, const struct colour_view *view) {
    for (uint32_t i = 0; i < view->shading_work_count; i++) {
        const struct shading_work *work = &view->shading_work[i];
        struct instance_work *entry = work_record_entry(record, work->instance);
        entry->regions++;
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            entry->streams[s] += work->streams[s];
        for (int o = 0; o < SIMD_OPERATION_COUNT; o++)
            entry->operations[o] += work->operations[o];
    }
    for (uint32_t first = 0, i = 1; i <= view->head.sample_count; i++)
        if (i == view->head.sample_count || view->shader[i] != view->shader[first]) {
            work_record_entry(record, view->shader[first])->samples += i - first;
            first = i;
        }
}

/* Brings one region into the picture and the accounts. */
static bool add_region(struct framebuffer_node *self, struct collected_frame *frame, uint32_t k,
                       struct status *status) {
    const struct machine *machine = &self->configuration.machine;
    struct arrived_region *arrived = &frame->regions[k];
    struct timing_region *timing = &frame->timing[k];
    const uint32_t samples = frame->grid.region_width * frame->grid.region_height;
    uint64_t covered = 0;
    if (arrived->is_coloured) {
        struct colour_view view;
        if (!colour_open(arrived->message, samples, self->configuration.rendering_nodes, &view,
                         status))
            return false;
        covered = view.head.sample_count;
        frame->record.composition.shader_id +=
            view.sums.arrived_samples * (uint64_t)machine->composition_shader_id_bytes;
        frame->record.composition.parameters += view.sums.arrived_map_bytes;
        timing->words = (uint32_t)machine_map_words(machine, view.head.longest_map);
        timing->shading = shading_work_price(machine, view.shading_work, view.shading_work_count);
        timing->work = copy_work(view.work, view.head.work_count);
        timing->work_count = view.head.work_count;
        frame->record.nan_depths += view.head.nan_depths;
        if (self->configuration.is_recorded)
            keep_costs(frame, k, &view);
        frame_image_add(&frame->image, k, &view);
        if (frame->frame.explain_work) {
            keep_work(&frame->record.work, &view.head);
            keep_shading_work(&frame->record.work, &view);
        }
    } else if (arrived->message) {
        struct region_view view;
        if (!region_open(arrived->message->bytes, arrived->message->length, samples, &view, status))
            return false;
        for (uint32_t w = 0; w < view.head.work_count; w++)
            if (view.work[w].node >= self->configuration.rendering_nodes)
                return status_fail(status, STATUS_INVALID, "damaged region message: node number");
        timing->work = copy_work(view.work, view.head.work_count);
        timing->work_count = view.head.work_count;
        frame->record.nan_depths += view.head.nan_depths;
        if (frame->frame.explain_work)
            keep_work(&frame->record.work, &view.head);
    }
    frame->record.regions_covered += covered > 0;
    frame->record.samples_covered += covered;
    frame->record.framebuffer.bytes +=
        covered ? (uint64_t)(machine->colour_words * machine->composition_word_bytes) * samples : 0;
    message_release(arrived->message);
    arrived->message = NULL;
    return true;
}

static void fill_times(struct framebuffer_node *self, struct collected_frame *frame,
                       const struct timing_result *result) {
    const struct configuration *configuration = &self->configuration;
    const struct tick_rate rate = configuration->machine.rate;
    struct frame_record *record = &frame->record;
    record->frame = frame->index;
    record->regions = frame->grid.count;
    record->samples_total = (uint64_t)frame->grid.samples_wide * frame->grid.samples_high;
    record->start = result->start;
    record->end = result->end;
    record->time = result->time;
    record->tick_rate = rate.per_s;
    record->start_ps = ticks_to_ps(rate, result->start);
    record->end_ps = ticks_to_ps(rate, result->end);
    record->time_ps = ticks_to_ps(rate, result->time);
    record->bound_by = result->bound_by;
    charge_composition(record, &configuration->machine, result);
    record->composition.busy_ps = ticks_to_ps(rate, result->composition_busy);
    record->geometry.busy_ps = ticks_to_ps(rate, result->geometry_busy);
    record->framebuffer.busy_ps = ticks_to_ps(rate, result->framebuffer_busy);
    record->rendering_nodes = configuration->rendering_nodes;
    record->shading_nodes = configuration->shading_nodes;
    record->raster_busy_ps = memory_get(record->rendering_nodes, sizeof(int64_t));
    record->shading_busy_ps = memory_get(record->shading_nodes, sizeof(int64_t));
    for (uint32_t i = 0; i < record->rendering_nodes; i++)
        record->raster_busy_ps[i] = ticks_to_ps(rate, result->raster_busy[i]);
    for (uint32_t j = 0; j < record->shading_nodes; j++)
        record->shading_busy_ps[j] = ticks_to_ps(rate, result->shading_busy[j]);
    snprintf(record->image_path, sizeof record->image_path, "%s", frame->frame.image_path);
}

static bool solve_time(struct framebuffer_node *self, const struct collected_frame *frame,
                       struct timing_result *result, struct status *status) {
    uint32_t *node = NULL;
    if (frame->frame.assigned_count) {
        node = memory_get(frame->grid.count, sizeof *node);
        for (uint32_t k = 0; k < frame->grid.count; k++)
            node[k] = frame->frame.assigned[k];
    }
    const struct timing_frame costs = {.geometry_bytes = frame->record.geometry.total,
                                       .regions = frame->timing,
                                       .region_count = frame->grid.count,
                                       .shading_node = node};
    const bool ok = timing_model_add_frame(self->timing, &costs, result, status);
    free(node);
    return ok;
}

static bool complete_frame(struct framebuffer_node *self, struct collected_frame *frame,
                           struct node_outputs *outputs, struct status *status) {
    struct frame_record *record = &frame->record;
    for (int cause = 0; cause < CAUSE_COUNT; cause++) {
        record->geometry.bytes[cause] = frame->geometry_bytes[cause];
        record->geometry.total += frame->geometry_bytes[cause];
    }
    struct timing_result result;
    if (!solve_time(self, frame, &result, status))
        return false;
    fill_times(self, frame, &result);
    record->nan_colours = frame->image.nan_colours;
    record->work.is_kept = frame->frame.explain_work != 0;
    if (frame->frame.image_path[0] &&
        !self->services->write_image(self->services->context, frame_image_take(&frame->image),
                                     frame->frame.image_path, frame->frame.compression,
                                     frame->frame.write_png, status))
        return false;
    if (self->configuration.is_recorded)
        node_send(outputs, host_address,
                  region_costs_encode(frame->costs, frame->cost_count, frame->index,
                                      node_address_pack(self->node.address)));
    node_send(outputs, host_address,
              frame_record_encode(record, node_address_pack(self->node.address)));
    trace_line(self->node.trace, "frame %d complete", frame->frame.number);
    frame_finish(frame);
    self->next_frame++;
    return true;
}

/* Adds what has arrived in order; finishes frames that are complete, in order too. */
static bool advance(struct framebuffer_node *self, struct node_outputs *outputs,
                    struct status *status) {
    for (struct collected_frame *frame; (frame = frame_of(self, self->next_frame));) {
        while (frame->added < frame->grid.count && frame->regions[frame->added].has_arrived) {
            node_works_on(&self->node, frame->frame.number, frame->added);
            if (!add_region(self, frame, frame->added, status))
                return status_prefix(status, "frame %d, region %u", frame->frame.number,
                                     frame->added);
            frame->added++;
        }
        if (frame->added < frame->grid.count || !frame->is_complete)
            return true;
        if (!complete_frame(self, frame, outputs, status))
            return false;
    }
    return true;
}

/* After how many regions the host hears of them. */
static uint32_t progress_step(uint32_t regions) {
    const uint32_t step = (regions + PROGRESS_STEPS - 1) / PROGRESS_STEPS;
    return step < PROGRESS_REGIONS_MAX ? step : PROGRESS_REGIONS_MAX;
}

static bool arrive(struct framebuffer_node *self, uint32_t frame_index, uint32_t first,
                   uint32_t count, struct message *message, bool is_coloured,
                   struct node_outputs *outputs, struct status *status) {
    struct collected_frame *frame = frame_of(self, frame_index);
    if (count > frame->grid.count || first > frame->grid.count - count)
        return status_fail(status, STATUS_INVALID, "frame %d has no region %u", frame->frame.number,
                           first);
    for (uint32_t k = first; k < first + count; k++) {
        struct arrived_region *region = &frame->regions[k];
        if (region->has_arrived)
            return status_fail(status, STATUS_INVALID, "frame %d, region %u arrived twice",
                               frame->frame.number, k);
        *region =
            (struct arrived_region){true, message ? message_hold(message) : NULL, is_coloured};
    }
    const uint32_t step = progress_step(frame->grid.count), before = frame->arrived / step;
    frame->arrived += count;
    if (frame->arrived / step != before)
        node_send(outputs, host_address,
                  signal_encode(WIRE_PROGRESS, frame_index, frame->arrived,
                                node_address_pack(self->node.address)));
    return true;
}

static bool accept_region(struct framebuffer_node *self, struct message *message,
                          const struct wire_header *header, struct node_outputs *outputs,
                          struct status *status) {
    if (!frame_of(self, header->frame)) {
        self->early = memory_grow(self->early, &self->early_capacity, self->early_count + 1,
                                  sizeof *self->early);
        self->early[self->early_count++] = (struct early_message){message_hold(message), *header};
        return true;
    }
    uint32_t count = 1;
    if (header->kind == WIRE_EMPTY_REGIONS) {
        if (!empty_regions_decode(message, &count, status))
            return false;
        message = NULL;
    }
    return arrive(self, header->frame, header->region, count, message, header->kind == WIRE_COLOUR,
                  outputs, status);
}

static bool replay_early(struct framebuffer_node *self, struct node_outputs *outputs,
                         struct status *status) {
    struct early_message *early = self->early;
    const size_t count = self->early_count;
    self->early = NULL;
    self->early_count = self->early_capacity = 0;
    bool ok = true;
    for (size_t i = 0; i < count; i++) {
        ok = ok && accept_region(self, early[i].message, &early[i].header, outputs, status);
        message_release(early[i].message);
    }
    free(early);
    return ok;
}

static bool begin_frame(struct framebuffer_node *self, const struct node_event *event,
                        struct node_outputs *outputs, struct status *status) {
    struct collected_frame *frame = &self->frames[event->header.frame % FRAMEBUFFER_FRAMES];
    if (!self->is_configured || frame->is_begun)
        return status_fail(status, STATUS_INTERNAL, "frame %u begins before frame %u is over",
                           event->header.frame, frame->index);
    if (!frame_payload_decode(event->message, &frame->frame, status) ||
        !region_grid_check(&frame->frame, &self->configuration.machine,
                           self->configuration.shading_nodes, status))
        return false;
    frame->frame_message = message_hold(event->message);
    frame->is_begun = true;
    frame->index = event->header.frame;
    frame->grid = region_grid_make(&frame->frame, &self->configuration.machine);
    frame->regions = memory_try(frame->grid.count, sizeof *frame->regions, status);
    frame->timing = memory_try(frame->grid.count, sizeof *frame->timing, status);
    if (!frame->regions || !frame->timing ||
        !frame_image_create(&frame->frame, &frame->grid, &frame->image, status))
        return status_prefix(status, "frame %d", frame->frame.number);
    return replay_early(self, outputs, status);
}

static bool configure(struct framebuffer_node *self, const struct node_event *event,
                      struct status *status) {
    if (self->is_configured)
        return status_fail(status, STATUS_INVALID, "configured twice");
    if (!configuration_decode(event->message, &self->configuration, status))
        return false;
    self->is_configured = true;
    self->timing =
        timing_model_create(&self->configuration.machine, self->configuration.strategy,
                            self->configuration.rendering_nodes, self->configuration.shading_nodes);
    return true;
}

static bool quit(struct framebuffer_node *self, struct node_outputs *outputs,
                 struct status *status) {
    self->node.is_finished = true;
    if (!self->services->finish_images(self->services->context, status))
        return false;
    node_send(outputs, host_address,
              signal_encode(WIRE_GOODBYE, 0, 0, node_address_pack(self->node.address)));
    return true;
}

static bool framebuffer_node_step(struct node *node, const struct node_event *event,
                                  struct node_outputs *outputs, struct status *status) {
    struct framebuffer_node *self = (struct framebuffer_node *)node;
    if (event->kind != NODE_MESSAGE)
        return true;
    bool ok;
    struct collected_frame *frame;
    switch (event->header.kind) {
    case WIRE_CONFIGURATION:
        return configure(self, event, status);
    case WIRE_FRAME_BEGIN:
        ok = begin_frame(self, event, outputs, status);
        break;
    case WIRE_FRAME_END:
        frame = frame_of(self, event->header.frame);
        if (!frame)
            return status_fail(status, STATUS_INTERNAL, "frame %u ends before it begins",
                               event->header.frame);
        frame->is_complete = true;
        ok = frame_end_decode(event->message, frame->geometry_bytes, status);
        break;
    case WIRE_REGION:
    case WIRE_EMPTY_REGIONS:
    case WIRE_COLOUR:
        ok = accept_region(self, event->message, &event->header, outputs, status);
        break;
    case WIRE_QUIT:
        return quit(self, outputs, status);
    default:
        return status_fail(status, STATUS_INVALID, "the framebuffer node was sent a %s message",
                           wire_kind_name(event->header.kind));
    }
    return ok && advance(self, outputs, status);
}

static void framebuffer_node_describe(const struct node *node, char *text, size_t size) {
    const struct framebuffer_node *self = (const struct framebuffer_node *)node;
    const struct collected_frame *frame = &self->frames[self->next_frame % FRAMEBUFFER_FRAMES];
    if (!self->is_configured)
        snprintf(text, size, "waits for the host's configuration");
    else if (!frame->is_begun)
        snprintf(text, size, "waits for the next frame from the host");
    else if (frame->added < frame->grid.count)
        snprintf(text, size,
                 "waits for region %u of frame %d from shading node %u (%u of %u are here)",
                 frame->added, frame->frame.number,
                 frame_payload_shading_node(&frame->frame, frame->added,
                                            self->configuration.shading_nodes),
                 frame->arrived, frame->grid.count);
    else
        snprintf(text, size, "waits for the host to end frame %d", frame->frame.number);
}

static void framebuffer_node_destroy(struct node *node) {
    struct framebuffer_node *self = (struct framebuffer_node *)node;
    for (int i = 0; i < FRAMEBUFFER_FRAMES; i++)
        frame_finish(&self->frames[i]);
    for (size_t i = 0; i < self->early_count; i++)
        message_release(self->early[i].message);
    free(self->early);
    timing_model_destroy(self->timing);
    free(self);
}

bool framebuffer_node_create(const struct node_services *services, struct trace *trace,
                             struct node **node, struct status *status) {
    static const struct node_type type = {framebuffer_node_step, framebuffer_node_describe,
                                          framebuffer_node_destroy};
    struct framebuffer_node *self = memory_get(1, sizeof *self);
    self->node = (struct node){.type = &type, .address = {NODE_FRAMEBUFFER, 0}, .trace = trace};
    self->services = services;
    *node = &self->node;
    return true;
}
