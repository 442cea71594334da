/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/pacer.h"

#include "nodes/protocol.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FULL_COUNT = 8, FRAMES_KNOWN = 4 };

#define NEVER INT64_MAX

/* Something that will be due at a known time. */
struct due_item {
    int64_t at;
    uint64_t sequence; /* equal times go in order */
    struct pacer_action action;
};

/* A region that waits at a rendering node for its turn on the link. */
struct waiting_region {
    struct message *message;
    struct node_address to;
    uint32_t frame, region;
    int64_t arrived, transfer, raster; /* raster: of this node's own work in it; -1 none */
    bool is_region;                    /* not a stretch of empty ones: somebody has work in it */
    bool is_covered;                   /* has samples: goes to a shading node at last */
};

/* The raster buffers of a rendering node, or the region buffers of a shading node as the last
 * rendering node knows them: a ring of times at which each is free again, NEVER while unknown. */
struct buffer_ring {
    int64_t *free_at;
    uint32_t *frame, *region; /* what is in it */
    uint32_t next;
};

/* What the framebuffer was sent, until its turn has come. */
struct received_region {
    uint32_t frame, region, count;
    int64_t arrived;
    struct message *message; /* colours; NULL for regions without */
    struct node_address from;
};

struct pacer {
    double scale;
    bool is_shaped;
    struct node_address self;
    bool has_machine;
    struct configuration configuration;
    double ns_per_tick;
    int64_t begin; /* host: of the first charged byte */

    struct due_item *due;
    size_t due_count, due_capacity;
    uint64_t sequence;

    int64_t link_free;            /* when the token bucket of this sender is even */
    double link_remainder;        /* of a nanosecond, carried on */
    struct message *last_charged; /* host: a broadcast is charged once */

    /* rendering */
    struct waiting_region *waiting;
    size_t waiting_first, waiting_count, waiting_capacity;
    int64_t geometry_end[FRAMES_KNOWN];
    int64_t raster_end;
    struct buffer_ring own;      /* buffers entries */
    struct buffer_ring *shading; /* last rendering node: one ring for each shading node */

    /* shading, framebuffer */
    struct received_region *received;
    size_t received_count, received_capacity;
    int64_t busy_until;                   /* shading: the array; framebuffer: its link */
    uint32_t next_frame, next_region;     /* framebuffer: whose turn it is */
    uint32_t region_counts[FRAMES_KNOWN]; /* of frames begun */
    uint32_t frames_begun;
};

static int64_t later(int64_t a, int64_t b) {
    return a > b ? a : b;
}

static int64_t duration(const struct pacer *pacer, ticks time) {
    return (int64_t)llround((double)time * pacer->ns_per_tick);
}

static struct buffer_ring ring_make(uint32_t count) {
    return (struct buffer_ring){memory_get(count, sizeof(int64_t)),
                                memory_get(count, sizeof(uint32_t)),
                                memory_get(count, sizeof(uint32_t)), 0};
}

static void ring_finish(struct buffer_ring *ring) {
    free(ring->free_at);
    free(ring->frame);
    free(ring->region);
}

static void ring_fill(struct buffer_ring *ring, uint32_t count, uint32_t frame, uint32_t region) {
    ring->free_at[ring->next] = NEVER;
    ring->frame[ring->next] = frame;
    ring->region[ring->next] = region;
    ring->next = (ring->next + 1) % count;
}

static void ring_release(struct buffer_ring *ring, uint32_t count, uint32_t frame, uint32_t region,
                         int64_t at) {
    for (uint32_t i = 0; i < count; i++)
        if (ring->free_at[i] == NEVER && ring->frame[i] == frame && ring->region[i] == region)
            ring->free_at[i] = at;
}

static uint32_t buffer_count(const struct pacer *pacer) {
    return (uint32_t)pacer->configuration.machine.composition_region_buffers;
}

struct pacer *pacer_create(double scale, bool is_shaped, struct node_address self) {
    struct pacer *pacer = memory_get(1, sizeof *pacer);
    pacer->scale = scale;
    pacer->is_shaped = is_shaped;
    pacer->self = self;
    pacer->begin = INT64_MIN;
    pacer->link_free = pacer->raster_end = pacer->busy_until = INT64_MIN;
    return pacer;
}

void pacer_destroy(struct pacer *pacer) {
    if (!pacer)
        return;
    for (size_t i = 0; i < pacer->due_count; i++)
        message_release(pacer->due[i].action.message);
    for (size_t i = 0; i < pacer->waiting_count; i++)
        message_release(pacer->waiting[pacer->waiting_first + i].message);
    for (size_t i = 0; i < pacer->received_count; i++)
        message_release(pacer->received[i].message);
    for (uint32_t j = 0; pacer->shading && j < pacer->configuration.shading_nodes; j++)
        ring_finish(&pacer->shading[j]);
    message_release(pacer->last_charged);
    ring_finish(&pacer->own);
    free(pacer->shading);
    free(pacer->due);
    free(pacer->waiting);
    free(pacer->received);
    free(pacer);
}

static bool is_last_rendering_node(const struct pacer *pacer) {
    return pacer->self.role == NODE_RENDERING &&
           pacer->self.index + 1 == pacer->configuration.rendering_nodes;
}

static void configure(struct pacer *pacer, const struct message *message) {
    if (pacer->has_machine || !configuration_decode(message, &pacer->configuration, NULL))
        return; /* the node itself will say what is wrong with it */
    pacer->has_machine = true;
    pacer->ns_per_tick = 1e9 / ((double)pacer->configuration.machine.rate.per_s * pacer->scale);
    if (pacer->self.role == NODE_RENDERING)
        pacer->own = ring_make(buffer_count(pacer));
    if (!is_last_rendering_node(pacer))
        return;
    pacer->shading = memory_get(pacer->configuration.shading_nodes, sizeof *pacer->shading);
    for (uint32_t j = 0; j < pacer->configuration.shading_nodes; j++)
        pacer->shading[j] = ring_make(buffer_count(pacer));
}

static void add_due(struct pacer *pacer, int64_t at, struct pacer_action action) {
    pacer->due =
        memory_grow(pacer->due, &pacer->due_capacity, pacer->due_count + 1, sizeof *pacer->due);
    pacer->due[pacer->due_count++] = (struct due_item){at, pacer->sequence++, action};
}

static void send_credit(struct pacer *pacer, int64_t at, struct node_address to, uint32_t frame,
                        uint32_t region) {
    add_due(pacer, at,
            (struct pacer_action){.to = to,
                                  .message = signal_encode(WIRE_CREDIT, frame, region,
                                                           node_address_pack(pacer->self))});
}

/* Occupies the sender's link from `start` on; returns when the transfer ends. Fractions of a
 * nanosecond are carried on, so that many small messages take what one large one takes. */
static int64_t occupy_link(struct pacer *pacer, int64_t start, double duration_ns) {
    if (start > pacer->link_free) {
        pacer->link_free = start;
        pacer->link_remainder = 0;
    }
    const double end = pacer->link_remainder + duration_ns;
    pacer->link_free += (int64_t)floor(end);
    pacer->link_remainder = end - floor(end);
    return pacer->link_free;
}

/* ---- host: the geometry network ---- */

static bool output_geometry(struct pacer *pacer, struct node_address to, struct message *message,
                            int64_t now) {
    struct wire_header header;
    if (!wire_open(message->bytes, message->length, &header, NULL))
        return false;
    if (header.kind == WIRE_CONFIGURATION)
        configure(pacer, message);
    const uint64_t charged = header.charged_bytes[0] + header.charged_bytes[1];
    if (charged && message != pacer->last_charged && pacer->has_machine) {
        const struct machine *machine = &pacer->configuration.machine;
        if (pacer->begin == INT64_MIN)
            pacer->begin = now;
        occupy_link(pacer, now,
                    (double)charged / (double)machine->geometry_word_bytes *
                        (double)machine->geometry_word * pacer->ns_per_tick);
        message_release(pacer->last_charged);
        pacer->last_charged = message_hold(message);
    }
    add_due(pacer, later(now, pacer->link_free), (struct pacer_action){false, to, message});
    return true;
}

/* ---- rendering nodes: raster work and the composition link ---- */

static bool describe_region(const struct pacer *pacer, const struct message *message,
                            const struct wire_header *header, struct waiting_region *waiting) {
    const struct machine *machine = &pacer->configuration.machine;
    uint32_t count;
    waiting->transfer = duration(pacer, machine->composition_word);
    if (header->kind == WIRE_EMPTY_REGIONS) {
        if (!empty_regions_decode(message, &count, NULL))
            return false;
        waiting->transfer =
            duration(pacer, ticks_multiply(machine->composition_word, (int64_t)count));
        return true;
    }
    struct region_view view;
    const int64_t samples = machine_region_samples(machine);
    waiting->is_region = true;
    if (!region_open(message->bytes, message->length, (uint32_t)samples, &view, NULL))
        return false;
    waiting->is_covered = view.head.sample_count > 0;
    if (waiting->is_covered)
        waiting->transfer = duration(
            pacer, ticks_multiply(machine->composition_word,
                                  samples * machine_map_words(machine, view.head.longest_map)));
    for (uint32_t w = 0; w < view.head.work_count; w++)
        if (view.work[w].node == pacer->self.index)
            waiting->raster = duration(
                pacer, ticks_add(machine->raster_region,
                                 ticks_multiply(machine->raster_triangle, view.work[w].triangles)));
    return true;
}

static bool output_region(struct pacer *pacer, struct node_address to, struct message *message,
                          const struct wire_header *header, int64_t now) {
    struct waiting_region waiting = {.message = message,
                                     .to = to,
                                     .frame = header->frame,
                                     .region = header->region,
                                     .arrived = now,
                                     .raster = -1};
    if (!pacer->has_machine || !describe_region(pacer, message, header, &waiting))
        return false;
    if (pacer->waiting_first &&
        pacer->waiting_first + pacer->waiting_count == pacer->waiting_capacity) {
        memmove(pacer->waiting, pacer->waiting + pacer->waiting_first,
                pacer->waiting_count * sizeof *pacer->waiting);
        pacer->waiting_first = 0;
    }
    pacer->waiting =
        memory_grow(pacer->waiting, &pacer->waiting_capacity,
                    pacer->waiting_first + pacer->waiting_count + 1, sizeof *pacer->waiting);
    pacer->waiting[pacer->waiting_first + pacer->waiting_count++] = waiting;
    return true;
}

/* What the machine would have sent of a covered region besides the bytes of its message. */
static struct message *make_filler(const struct pacer *pacer, const struct waiting_region *region) {
    const struct machine *machine = &pacer->configuration.machine;
    struct region_view view;
    if (!region_open(region->message->bytes, region->message->length,
                     (uint32_t)machine_region_samples(machine), &view, NULL))
        return NULL;
    const size_t charged = (size_t)(machine_region_samples(machine) *
                                    machine_map_words(machine, view.head.longest_map) *
                                    machine->composition_word_bytes);
    const size_t sent = region->message->length + WIRE_HEADER_BYTES;
    struct message *filler =
        message_create(WIRE_HEADER_BYTES + (charged > sent ? charged - sent : 0));
    memset(filler->bytes, 0, filler->length);
    wire_seal(filler, (struct wire_header){.kind = WIRE_FILLER,
                                           .frame = region->frame,
                                           .region = region->region,
                                           .sender = node_address_pack(pacer->self)});
    return filler;
}

/* The network below takes its time over the region; its ARRIVAL says when the link is free. */
static void start_shaped(struct pacer *pacer, const struct waiting_region *head, int64_t start) {
    struct message *filler = make_filler(pacer, head);
    if (filler)
        add_due(pacer, start, (struct pacer_action){false, head->to, filler});
    add_due(pacer, start, (struct pacer_action){false, head->to, head->message});
    ring_fill(&pacer->shading[head->to.index], buffer_count(pacer), head->frame, head->region);
    pacer->link_free = NEVER;
}

static void take_arrival(struct pacer *pacer, const struct wire_header *header, int64_t now) {
    pacer->link_free = now;
    ring_release(&pacer->own, buffer_count(pacer), header->frame, header->region, now);
}

/* When the region at the head may go; NEVER while a credit is missing. */
static int64_t head_start(const struct pacer *pacer, const struct waiting_region *head) {
    int64_t start = later(head->arrived, pacer->link_free);
    if (start == NEVER)
        return NEVER;
    if (head->raster >= 0) {
        const int64_t buffer = pacer->own.free_at[pacer->own.next];
        if (buffer == NEVER)
            return NEVER;
        int64_t begin = later(pacer->raster_end, pacer->geometry_end[head->frame % FRAMES_KNOWN]);
        start = later(start, later(begin, buffer) + head->raster);
    }
    if (pacer->shading && head->is_covered) {
        const struct buffer_ring *ring = &pacer->shading[head->to.index];
        start = later(start, ring->free_at[ring->next]);
    }
    return start;
}

/* The head's transfer begins. */
static void start_head(struct pacer *pacer, int64_t start) {
    const struct waiting_region head = pacer->waiting[pacer->waiting_first];
    const struct configuration *configuration = &pacer->configuration;
    const uint32_t buffers = buffer_count(pacer);
    const ticks hop = configuration->machine.composition_hop;
    pacer->waiting_first = --pacer->waiting_count ? pacer->waiting_first + 1 : 0;
    if (head.raster >= 0) {
        const int64_t begin =
            later(pacer->raster_end, pacer->geometry_end[head.frame % FRAMES_KNOWN]);
        pacer->raster_end = later(begin, pacer->own.free_at[pacer->own.next]) + head.raster;
        ring_fill(&pacer->own, buffers, head.frame, head.region);
    }
    if (pacer->is_shaped && head.is_covered) {
        start_shaped(pacer, &head, start);
        return;
    }
    const int64_t end = occupy_link(pacer, start, (double)head.transfer);
    if (!is_last_rendering_node(pacer)) {
        add_due(pacer, start + duration(pacer, hop),
                (struct pacer_action){false, head.to, head.message});
        return;
    }
    if (head.is_covered)
        ring_fill(&pacer->shading[head.to.index], buffers, head.frame, head.region);
    const uint32_t hops = 1 + (head.is_covered ? head.to.index : configuration->shading_nodes);
    add_due(pacer, end + duration(pacer, ticks_multiply(hop, hops)),
            (struct pacer_action){false, head.to, head.message});
    ring_release(&pacer->own, buffers, head.frame, head.region, end);
    if (pacer->self.index && head.is_region)
        send_credit(pacer, end, (struct node_address){NODE_RENDERING, pacer->self.index - 1},
                    head.frame, head.region);
}

static void take_credit(struct pacer *pacer, const struct wire_header *header, int64_t now) {
    const struct node_address from = node_address_unpack(header->sender);
    if (!pacer->has_machine)
        return;
    if (pacer->self.role == NODE_SHADING) {
        send_credit(pacer, now,
                    (struct node_address){NODE_RENDERING, pacer->configuration.rendering_nodes - 1},
                    header->frame, header->region);
    } else if (pacer->self.role == NODE_RENDERING && from.role == NODE_RENDERING) {
        ring_release(&pacer->own, buffer_count(pacer), header->frame, header->region, now);
        if (pacer->self.index)
            send_credit(pacer, now, (struct node_address){NODE_RENDERING, pacer->self.index - 1},
                        header->frame, header->region);
    } else if (pacer->shading && from.index < pacer->configuration.shading_nodes) {
        ring_release(&pacer->shading[from.index], buffer_count(pacer), header->frame,
                     header->region, now);
    }
}

/* ---- shading nodes: the price of a region ---- */

static struct received_region *find_received(struct pacer *pacer, uint32_t frame, uint32_t region) {
    for (size_t i = 0; i < pacer->received_count; i++) {
        struct received_region *received = &pacer->received[i];
        if (received->frame == frame && region - received->region < received->count)
            return received;
    }
    return NULL;
}

static void add_received(struct pacer *pacer, struct received_region received) {
    pacer->received = memory_grow(pacer->received, &pacer->received_capacity,
                                  pacer->received_count + 1, sizeof *pacer->received);
    pacer->received[pacer->received_count++] = received;
}

static void remove_received(struct pacer *pacer, struct received_region *received) {
    *received = pacer->received[--pacer->received_count];
}

static bool output_colours(struct pacer *pacer, struct node_address to, struct message *message,
                           const struct wire_header *header, int64_t now) {
    const struct configuration *configuration = &pacer->configuration;
    struct received_region *received = find_received(pacer, header->frame, header->region);
    struct colour_view view;
    if (!pacer->has_machine || !received ||
        !colour_open(message, (uint32_t)machine_region_samples(&configuration->machine),
                     configuration->rendering_nodes, &view, NULL))
        return false;
    const ticks price =
        shading_work_price(&configuration->machine, view.shading_work, view.shading_work_count);
    const ticks way = ticks_multiply(configuration->machine.composition_hop,
                                     (int64_t)configuration->shading_nodes - pacer->self.index);
    pacer->busy_until = later(received->arrived, pacer->busy_until) + duration(pacer, price);
    remove_received(pacer, received);
    add_due(pacer, later(now, pacer->busy_until) + duration(pacer, way),
            (struct pacer_action){false, to, message});
    return true;
}

/* ---- framebuffer: colours in order of regions ---- */

static void take_turns(struct pacer *pacer) {
    const struct machine *machine = &pacer->configuration.machine;
    const int64_t colours =
        duration(pacer, ticks_multiply(machine->composition_word,
                                       machine_region_samples(machine) * machine->colour_words));
    for (struct received_region *received;
         (received = find_received(pacer, pacer->next_frame, pacer->next_region));) {
        pacer->next_region = received->region + received->count;
        if (received->message) {
            pacer->busy_until = later(pacer->busy_until, received->arrived) + colours;
            add_due(pacer, pacer->busy_until,
                    (struct pacer_action){.is_delivery = true, .message = received->message});
            send_credit(pacer, pacer->busy_until, received->from, received->frame,
                        received->region);
        }
        remove_received(pacer, received);
        if (pacer->next_frame < pacer->frames_begun &&
            pacer->next_region >= pacer->region_counts[pacer->next_frame % FRAMES_KNOWN]) {
            pacer->next_frame++;
            pacer->next_region = 0;
        }
    }
}

static bool input_framebuffer(struct pacer *pacer, const struct node_event *event, int64_t now) {
    const struct wire_header *header = &event->header;
    struct received_region received = {
        header->frame, header->region, 1, now, NULL, node_address_unpack(header->sender)};
    if (header->kind == WIRE_FRAME_BEGIN) {
        struct frame_payload frame;
        if (!frame_payload_decode(event->message, &frame, NULL) ||
            !region_grid_check(&frame, &pacer->configuration.machine,
                               pacer->configuration.shading_nodes, NULL))
            return false;
        pacer->region_counts[header->frame % FRAMES_KNOWN] =
            region_grid_make(&frame, &pacer->configuration.machine).count;
        pacer->frames_begun = header->frame + 1;
        take_turns(pacer);
        return false;
    }
    if (header->kind == WIRE_EMPTY_REGIONS &&
        !empty_regions_decode(event->message, &received.count, NULL))
        return false;
    if (header->kind == WIRE_COLOUR)
        received.message = message_hold(event->message);
    add_received(pacer, received);
    take_turns(pacer);
    return header->kind == WIRE_COLOUR;
}

/* ---- what drivers call ---- */

bool pacer_output(struct pacer *pacer, struct node_address to, struct message *message,
                  int64_t now_ns) {
    struct wire_header header;
    if (pacer->self.role == NODE_HOST)
        return output_geometry(pacer, to, message, now_ns);
    if (to.role == NODE_HOST || !wire_open(message->bytes, message->length, &header, NULL))
        return false;
    if (pacer->self.role == NODE_RENDERING)
        return output_region(pacer, to, message, &header, now_ns);
    return header.kind == WIRE_COLOUR && output_colours(pacer, to, message, &header, now_ns);
}

bool pacer_input(struct pacer *pacer, const struct node_event *event, int64_t now_ns) {
    const struct wire_header *header = &event->header;
    switch (header->kind) {
    case WIRE_CONFIGURATION:
        configure(pacer, event->message);
        return false;
    case WIRE_FILLER:
        return true;
    case WIRE_ARRIVAL:
        if (pacer->is_shaped && pacer->shading)
            take_arrival(pacer, header, now_ns);
        return true;
    case WIRE_CREDIT:
        take_credit(pacer, header, now_ns);
        return true;
    case WIRE_FRAME_END:
        pacer->geometry_end[header->frame % FRAMES_KNOWN] = now_ns;
        return false;
    case WIRE_FRAME_BEGIN:
    case WIRE_REGION:
    case WIRE_EMPTY_REGIONS:
    case WIRE_COLOUR:
        if (pacer->has_machine && pacer->self.role == NODE_FRAMEBUFFER)
            return input_framebuffer(pacer, event, now_ns);
        if (pacer->self.role == NODE_SHADING && header->kind == WIRE_REGION && pacer->is_shaped)
            add_due(pacer, now_ns,
                    (struct pacer_action){
                        .to = {NODE_RENDERING, 0},
                        .message = signal_encode(WIRE_ARRIVAL, header->frame, header->region,
                                                 node_address_pack(pacer->self))});
        if (pacer->self.role == NODE_SHADING && header->kind == WIRE_REGION)
            add_received(pacer, (struct received_region){.frame = header->frame,
                                                         .region = header->region,
                                                         .count = 1,
                                                         .arrived = now_ns});
        return false;
    default:
        return false;
    }
}

/* The earliest of what is due; NULL: none. */
static struct due_item *earliest(const struct pacer *pacer) {
    struct due_item *first = NULL;
    for (size_t i = 0; i < pacer->due_count; i++) {
        struct due_item *item = &pacer->due[i];
        if (!first || item->at < first->at ||
            (item->at == first->at && item->sequence < first->sequence))
            first = item;
    }
    return first;
}

bool pacer_next(struct pacer *pacer, int64_t now_ns, struct pacer_action *action) {
    while (pacer->waiting_count) {
        const int64_t start = head_start(pacer, &pacer->waiting[pacer->waiting_first]);
        if (start > now_ns)
            break;
        start_head(pacer, start);
    }
    struct due_item *item = earliest(pacer);
    if (!item || item->at > now_ns)
        return false;
    *action = item->action;
    memmove(item, item + 1, (size_t)(pacer->due + --pacer->due_count - item) * sizeof *item);
    return true;
}

int64_t pacer_wake_ns(const struct pacer *pacer) {
    const struct due_item *item = earliest(pacer);
    int64_t wake = item ? item->at : NEVER;
    if (pacer->waiting_count) {
        const int64_t start = head_start(pacer, &pacer->waiting[pacer->waiting_first]);
        wake = start < wake ? start : wake;
    }
    return wake;
}

bool pacer_is_full(const struct pacer *pacer) {
    return pacer->waiting_count >= FULL_COUNT;
}

int64_t pacer_begin_ns(const struct pacer *pacer) {
    return pacer->begin;
}
