/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/rendering_node.h"

#include "base/hash.h"
#include "nodes/region_exchange.h"
#include "nodes/visibility.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Frames a node holds at once: one being composed, one being received. */
enum { RENDERING_FRAMES = 2 };

struct frame_slot {
    bool is_begun, is_complete;
    bool is_reported; /* the host knows the work of its chunks */
    uint32_t index;
    struct frame_payload frame;
    struct message *frame_message; /* holds what `frame` points into */
    struct region_grid grid;
    struct message **messages; /* chunks */
    size_t message_count, message_capacity, chunk_capacity;
    struct chunk_payload *chunks;
    uint64_t content; /* hash of frame and chunks */
};

/* What came from upstream and waits: a region message, or a stretch of regions empty so far. */
struct pending {
    struct message *message; /* NULL: empty stretch */
    uint32_t frame, region, count;
};

struct rendering_node {
    struct node node;
    bool is_configured;
    struct configuration configuration;
    struct visibility_device *device;
    struct frame_slot frames[RENDERING_FRAMES];
    struct visibility *visibility; /* of the frame being composed */
    uint64_t visibility_content;
    struct frame_slot kept;    /* the chunks `visibility` points into, when its frame is over */
    struct schedule *schedule; /* of a switched network; NULL: the chain */
    struct region_exchange *exchange; /* with the other nodes of that network */
    struct early_messages early;      /* before the configuration */
    struct pending *queue;
    size_t queue_first, queue_count, queue_capacity;
};

static struct frame_slot *slot_of(struct rendering_node *self, uint32_t frame) {
    return &self->frames[frame % RENDERING_FRAMES];
}

static void slot_finish(struct frame_slot *slot) {
    for (size_t i = 0; i < slot->message_count; i++)
        message_release(slot->messages[i]);
    free(slot->messages);
    free(slot->chunks);
    message_release(slot->frame_message);
    *slot = (struct frame_slot){0};
}

static void queue_push(struct rendering_node *self, struct pending pending) {
    if (self->queue_first && self->queue_first + self->queue_count == self->queue_capacity) {
        memmove(self->queue, self->queue + self->queue_first,
                self->queue_count * sizeof *self->queue);
        self->queue_first = 0;
    }
    self->queue = memory_grow(self->queue, &self->queue_capacity,
                              self->queue_first + self->queue_count + 1, sizeof *self->queue);
    self->queue[self->queue_first + self->queue_count++] = pending;
}

static void update_has_work(struct rendering_node *self) {
    self->node.has_work = self->queue_count &&
                          (!self->exchange || region_exchange_has_room(self->exchange)) &&
                          slot_of(self, self->queue[self->queue_first].frame)->is_complete &&
                          slot_of(self, self->queue[self->queue_first].frame)->index ==
                              self->queue[self->queue_first].frame;
}

static void queue_pop(struct rendering_node *self) {
    self->queue_first++;
    if (!--self->queue_count)
        self->queue_first = 0;
}

static bool begin_frame(struct rendering_node *self, const struct node_event *event,
                        struct status *status) {
    struct frame_slot *slot = slot_of(self, event->header.frame);
    if (!self->is_configured || slot->is_begun)
        return status_fail(status, STATUS_INTERNAL, "frame %u begins before frame %u is over",
                           event->header.frame, slot->index);
    if (!frame_payload_decode(event->message, &slot->frame, status) ||
        !region_grid_check(&slot->frame, &self->configuration.machine,
                           self->configuration.shading_nodes, status))
        return false;
    slot->frame_message = message_hold(event->message);
    slot->is_begun = true;
    slot->index = event->header.frame;
    slot->grid = region_grid_make(&slot->frame, &self->configuration.machine);
    const double view[] = {
        slot->frame.screen_window[0], slot->frame.screen_window[1], slot->frame.screen_window[2],
        slot->frame.screen_window[3], slot->frame.near_plane,       slot->frame.far_plane,
        slot->grid.samples_wide,      slot->grid.samples_high,      slot->frame.is_perspective};
    slot->content = hash_bytes(view, sizeof view, 0);
    return true;
}

static bool add_chunk(struct rendering_node *self, const struct node_event *event,
                      struct status *status) {
    struct frame_slot *slot = slot_of(self, event->header.frame);
    if (!slot->is_begun || slot->index != event->header.frame)
        return status_fail(status, STATUS_INTERNAL, "chunk of frame %u outside its frame",
                           event->header.frame);
    struct chunk_payload chunk;
    if (!chunk_payload_decode(event->message, &chunk, status))
        return false;
    slot->chunks = memory_grow(slot->chunks, &slot->chunk_capacity, slot->message_count + 1,
                               sizeof *slot->chunks);
    slot->messages = memory_grow(slot->messages, &slot->message_capacity, slot->message_count + 1,
                                 sizeof *slot->messages);
    slot->chunks[slot->message_count] = chunk;
    slot->messages[slot->message_count++] = message_hold(event->message);
    const uint64_t payload = wire_payload_hash(event->message->bytes);
    slot->content = hash_bytes(&payload, sizeof payload, slot->content);
    return true;
}

static bool end_frame(struct rendering_node *self, const struct node_event *event,
                      struct status *status) {
    struct frame_slot *slot = slot_of(self, event->header.frame);
    if (!slot->is_begun || slot->index != event->header.frame)
        return status_fail(status, STATUS_INTERNAL, "frame %u ends before it begins",
                           event->header.frame);
    slot->is_complete = true;
    trace_line(self->node.trace, "frame %d received: %zu chunks", slot->frame.number,
               slot->message_count);
    if (self->node.address.index == 0 || self->exchange)
        queue_push(self, (struct pending){NULL, slot->index, 0, slot->grid.count});
    return true;
}

static bool accept_upstream(struct rendering_node *self, const struct node_event *event,
                            struct node_outputs *outputs, struct status *status) {
    if (!self->is_configured) {
        early_messages_add(&self->early, event);
        return true;
    }
    if (self->exchange)
        return event->header.kind == WIRE_REGION
                   ? region_exchange_receive(self->exchange, event, outputs, status)
                   : status_fail(status, STATUS_INVALID,
                                 "empty regions were sent outside the chain");
    struct pending pending = {
        .frame = event->header.frame, .region = event->header.region, .count = 1};
    if (event->header.kind == WIRE_EMPTY_REGIONS) {
        if (!empty_regions_decode(event->message, &pending.count, status))
            return false;
    } else {
        pending.message = message_hold(event->message);
    }
    queue_push(self, pending);
    return true;
}

/* The scene of the frame at the head of the queue; built once, and kept over frames whose geometry
 * is the same, byte for byte. */
static bool prepare_visibility(struct rendering_node *self, struct frame_slot *slot,
                               struct status *status) {
    if (self->visibility && slot->content == self->visibility_content)
        return true;
    visibility_destroy(self->visibility);
    self->visibility = NULL;
    slot_finish(&self->kept);
    if (!visibility_create(self->device, &slot->frame, &slot->grid, slot->chunks,
                           slot->message_count, self->configuration.is_recorded, &self->visibility,
                           status))
        return false;
    self->visibility_content = slot->content;
    trace_line(self->node.trace, "frame %d: scene built", slot->frame.number);
    return true;
}

static void end_composition(struct rendering_node *self, struct frame_slot *slot) {
    /* the scene refers to the chunks of the frame it was built from: those stay with it */
    if (!self->kept.messages && !self->kept.frame_message)
        self->kept = *slot;
    else
        slot_finish(slot);
    *slot = (struct frame_slot){0};
}

/* When the run is recorded: what each chunk costs in each region, once a frame. */
static void report_work(struct rendering_node *self, struct frame_slot *slot,
                        struct node_outputs *outputs) {
    const struct region_bins *bins = visibility_bins(self->visibility);
    if (!self->configuration.is_recorded || slot->is_reported)
        return;
    slot->is_reported = true;
    node_send(outputs, (struct node_address){NODE_HOST, 0},
              chunk_work_encode(bins->entries, bins->entry_count, slot->index,
                                node_address_pack(self->node.address)));
}

static void send_empty(struct rendering_node *self, uint32_t frame, uint32_t first, uint32_t count,
                       struct node_outputs *outputs) {
    const uint32_t index = self->node.address.index;
    const struct node_address next = index + 1 < self->configuration.rendering_nodes
                                         ? (struct node_address){NODE_RENDERING, index + 1}
                                         : (struct node_address){NODE_FRAMEBUFFER, 0};
    node_send(outputs, next,
              empty_regions_encode(frame, first, count, node_address_pack(self->node.address)));
}

/* Downstream: the next rendering node; from the last one the shading node of the region, or
 * straight the framebuffer node when there is nothing to shade. */
static void send_region(struct rendering_node *self, const struct frame_slot *slot, uint32_t region,
                        struct message *message, uint32_t sample_count,
                        struct node_outputs *outputs) {
    const uint32_t index = self->node.address.index;
    struct node_address next = {NODE_RENDERING, index + 1};
    if (next.index == self->configuration.rendering_nodes)
        next = sample_count
                   ? (struct node_address){NODE_SHADING, frame_payload_shading_node(
                                                             &slot->frame, region,
                                                             self->configuration.shading_nodes)}
                   : (struct node_address){NODE_FRAMEBUFFER, 0};
    node_send(outputs, next, message);
}

static bool compose_region(struct rendering_node *self, const struct pending *pending, bool has_own,
                           struct node_outputs *outputs, struct status *status) {
    const struct frame_slot *slot = slot_of(self, pending->frame);
    const struct region_grid *grid = &slot->grid;
    const uint32_t samples = grid->region_width * grid->region_height;
    const uint32_t sender = node_address_pack(self->node.address);
    struct region_view upstream = {0};
    if (!has_own) { /* passed on as it came */
        send_region(self, slot, pending->region, message_hold(pending->message),
                    region_sample_count(pending->message->bytes, pending->message->length),
                    outputs);
        return true;
    }
    if (pending->message &&
        !region_open(pending->message->bytes, pending->message->length, samples, &upstream, status))
        return status_prefix(status, "frame %d, region %u", slot->frame.number, pending->region);
    struct region_draft mine =
        visibility_render(self->visibility, pending->region, self->node.address.index);
    const struct region_view own = region_draft_view(&mine);
    const uint32_t count = own.head.sample_count + upstream.head.sample_count;
    struct message *drawn = mine.message, *out;
    if (!pending->message)
        out = region_seal(&mine, pending->frame, pending->region, sender);
    else if (region_compose_in_place(pending->message, &upstream, &own, pending->frame,
                                     pending->region, sender))
        out = message_hold(pending->message);
    else if (region_compose_in_place(drawn, &own, &upstream, pending->frame, pending->region,
                                     sender))
        out = drawn;
    else
        out = region_compose(&upstream, &own, pending->frame, pending->region, sender);
    if (out != drawn)
        message_release(drawn);
    send_region(self, slot, pending->region, out, count, outputs);
    return true;
}

/* On a switched network: the next region, from what this node alone has of it. */
static bool begin_exchange(struct rendering_node *self, struct pending *head, bool has_own,
                           struct node_outputs *outputs, struct status *status) {
    const uint32_t region = head->region;
    self->node.region = region;
    head->region++;
    head->count--;
    struct region_draft draft =
        has_own ? visibility_render(self->visibility, region, self->node.address.index)
                : region_draft_create((struct region_head){0});
    struct message *own =
        region_seal(&draft, head->frame, region, node_address_pack(self->node.address));
    return region_exchange_begin(self->exchange, head->frame, region,
                                 frame_payload_shading_node(&slot_of(self, head->frame)->frame,
                                                            region,
                                                            self->configuration.shading_nodes),
                                 own, outputs, status);
}

/* Takes the queue's head as far as the next region that carries anything. */
static bool advance(struct rendering_node *self, struct node_outputs *outputs,
                    struct status *status) {
    struct pending *head = &self->queue[self->queue_first];
    struct frame_slot *slot = slot_of(self, head->frame);
    if (head->count > slot->grid.count || head->region > slot->grid.count - head->count)
        return status_fail(status, STATUS_INVALID, "frame %d has no region %u", slot->frame.number,
                           head->region);
    if (!prepare_visibility(self, slot, status))
        return status_prefix(status, "frame %d", slot->frame.number);
    report_work(self, slot, outputs);
    const struct region_bins *bins = visibility_bins(self->visibility);
    const uint32_t frame = head->frame, end = head->region + head->count;
    uint32_t region = head->region;
    node_works_on(&self->node, slot->frame.number, region);
    if (self->exchange) {
        if (!begin_exchange(self, head, bins->bins[region], outputs, status))
            return false;
        region = end; /* no further by the chain */
    } else if (!head->message) {
        while (region < end && !bins->bins[region])
            region++;
        if (region > head->region)
            send_empty(self, frame, head->region, region - head->region, outputs);
        head->count = end - region;
        head->region = region;
    }
    if (region < end) {
        struct pending one = {head->message, frame, region, 1};
        self->node.region = region;
        if (!compose_region(self, &one, bins->bins[region], outputs, status))
            return false;
        message_release(head->message);
        head->message = NULL;
        head->region++;
        head->count--;
    }
    if (head->count)
        return true;
    queue_pop(self);
    if (end == slot->grid.count)
        end_composition(self, slot);
    return true;
}

static void join_network(struct rendering_node *self) {
    const struct configuration *configuration = &self->configuration;
    self->schedule = schedule_create(configuration->strategy->plan, configuration->rendering_nodes,
                                     (uint32_t)machine_region_samples(&configuration->machine));
    self->exchange = region_exchange_create(self->schedule, self->node.address.index);
    self->node.takes_always = true;
}

static bool configure(struct rendering_node *self, const struct node_event *event,
                      struct node_outputs *outputs, struct status *status) {
    if (self->is_configured)
        return status_fail(status, STATUS_INVALID, "configured twice");
    if (!configuration_decode(event->message, &self->configuration, status))
        return false;
    if (self->node.address.index >= self->configuration.rendering_nodes)
        return status_fail(status, STATUS_INVALID, "the cluster has %u rendering nodes",
                           self->configuration.rendering_nodes);
    self->is_configured = true;
    if (self->configuration.strategy->plan)
        join_network(self);
    bool ok = true;
    for (size_t i = 0; ok && i < self->early.count; i++)
        ok = accept_upstream(self, &self->early.events[i], outputs, status);
    early_messages_finish(&self->early);
    return ok;
}

static bool handle_message(struct rendering_node *self, const struct node_event *event,
                           struct node_outputs *outputs, struct status *status) {
    switch (event->header.kind) {
    case WIRE_CONFIGURATION:
        return configure(self, event, outputs, status);
    case WIRE_FRAME_BEGIN:
        return begin_frame(self, event, status);
    case WIRE_CHUNK:
        return add_chunk(self, event, status);
    case WIRE_FRAME_END:
        return end_frame(self, event, status);
    case WIRE_REGION:
    case WIRE_EMPTY_REGIONS:
        return accept_upstream(self, event, outputs, status);
    case WIRE_QUIT:
        self->node.is_finished = true;
        return true;
    default:
        return status_fail(status, STATUS_INVALID, "a rendering node was sent a %s message",
                           wire_kind_name(event->header.kind));
    }
}

static bool rendering_node_step(struct node *node, const struct node_event *event,
                                struct node_outputs *outputs, struct status *status) {
    struct rendering_node *self = (struct rendering_node *)node;
    bool ok = true;
    if (event->kind == NODE_MESSAGE)
        ok = handle_message(self, event, outputs, status);
    else if (event->kind == NODE_WORK && node->has_work)
        ok = advance(self, outputs, status);
    update_has_work(self);
    return ok;
}

static void rendering_node_describe(const struct node *node, char *text, size_t size) {
    const struct rendering_node *self = (const struct rendering_node *)node;
    uint32_t frame, region, from;
    if (!self->is_configured)
        snprintf(text, size, "waits for the host's configuration");
    else if (node->has_work)
        snprintf(text, size, "works on frame %d, region %u", node->frame, node->region);
    else if (self->queue_count)
        snprintf(text, size, "waits for the host to end the frame of the region it has");
    else if (self->exchange && region_exchange_waits_for(self->exchange, &frame, &region, &from))
        snprintf(text, size, "waits for its part of frame %d, region %u from rendering node %u",
                 self->frames[frame % RENDERING_FRAMES].frame.number, region, from);
    else if (node->address.index && (self->frames[0].is_complete || self->frames[1].is_complete))
        snprintf(text, size, "waits for regions after region %u of frame %d from rendering node %u",
                 node->region, node->frame, node->address.index - 1);
    else
        snprintf(text, size, "waits for the next frame from the host");
}

static void rendering_node_destroy(struct node *node) {
    struct rendering_node *self = (struct rendering_node *)node;
    visibility_destroy(self->visibility);
    for (int i = 0; i < RENDERING_FRAMES; i++)
        slot_finish(&self->frames[i]);
    slot_finish(&self->kept);
    for (size_t i = 0; i < self->queue_count; i++)
        message_release(self->queue[self->queue_first + i].message);
    free(self->queue);
    early_messages_finish(&self->early);
    region_exchange_destroy(self->exchange);
    schedule_destroy(self->schedule);
    free(self);
}

bool rendering_node_create(uint32_t index, struct visibility_device *device, struct trace *trace,
                           struct node **node, struct status *status) {
    static const struct node_type type = {rendering_node_step, rendering_node_describe,
                                          rendering_node_destroy};
    struct rendering_node *self = memory_get(1, sizeof *self);
    self->node = (struct node){.type = &type, .address = {NODE_RENDERING, index}, .trace = trace};
    self->device = device;
    *node = &self->node;
    return true;
}
