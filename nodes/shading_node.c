/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shading_node.h"

#include "nodes/instance_merge.h"
#include "nodes/reference_batch.h"
#include "nodes/region_exchange.h"
#include "nodes/sample_quads.h"
#include "nodes/shading_frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SHADING_FRAMES = 2,
    BATCH_SAMPLES =
        512, /* shaded at a time: all their planes stay in the first or second level cache */
    PLANE_ALIGNMENT = 64,
};

/* Planes of one batch, gathered from the region. */
struct batch {
    size_t material_capacity;
    float *memory; /* material planes, then the fixed planes below */
    const float **material;
    float *position[3], *incident[3], *color[3], *opacity[3];
    int32_t *present;
    size_t light_capacity;
    float *light_scratch;
};

struct shading_node {
    struct node node;
    const struct node_services *services;
    bool is_configured;
    struct configuration configuration;
    struct shader_table shaders;
    struct shading_frame frames[SHADING_FRAMES];
    struct shading_frame
        retired[SHADING_FRAMES]; /* over, kept for what the next frame in the slot shares */
    struct pending_region {
        struct message *message;
        struct wire_header header;
        struct region_arrivals arrivals; /* owned */
    } * queue;
    size_t queue_first, queue_count, queue_capacity;
    uint32_t expected_parts; /* of a region, from as many rendering nodes */
    struct region_gather gather;
    struct early_messages early; /* before the configuration */
    struct batch batch;
    struct reference_batch reference; /* for modules that compute in double precision */
    /* scratch for one region */
    uint32_t *order;    /* covered samples, sorted by instance */
    uint32_t *location; /* sample index in the region of each covered sample */
    float *screen_x, *screen_y;
    uint64_t overruns_warned;
};

static struct shading_frame *frame_of(struct shading_node *self, uint32_t frame) {
    return &self->frames[frame % SHADING_FRAMES];
}

static float *planes_create(size_t count) {
    float *planes = aligned_alloc(PLANE_ALIGNMENT, count * BATCH_SAMPLES * sizeof(float));
    if (!planes)
        abort();
    memset(planes, 0, count * BATCH_SAMPLES * sizeof(float));
    return planes;
}

static void batch_reserve(struct batch *batch, size_t material_count, size_t light_vectors) {
    enum { FIXED_PLANES = 13, VECTOR_FLOATS = 16 };
    if (!batch->memory || material_count > batch->material_capacity) {
        free(batch->memory);
        free(batch->material);
        batch->material_capacity = material_count;
        batch->memory = planes_create(material_count + FIXED_PLANES);
        batch->material = memory_get(material_count, sizeof *batch->material);
        float *next = batch->memory;
        for (size_t p = 0; p < material_count; p++, next += BATCH_SAMPLES)
            batch->material[p] = next;
        for (int c = 0; c < 3; c++) {
            batch->position[c] = next;
            batch->incident[c] = next + 3 * BATCH_SAMPLES;
            batch->color[c] = next + 6 * BATCH_SAMPLES;
            batch->opacity[c] = next + 9 * BATCH_SAMPLES;
            next += BATCH_SAMPLES;
        }
        batch->present = (int32_t *)(void *)(next + 9 * BATCH_SAMPLES);
    }
    if (!batch->light_scratch || light_vectors > batch->light_capacity) {
        free(batch->light_scratch);
        batch->light_capacity = light_vectors;
        batch->light_scratch =
            aligned_alloc(PLANE_ALIGNMENT, (light_vectors + 1) * VECTOR_FLOATS * sizeof(float));
        if (!batch->light_scratch)
            abort();
    }
}

/* Copies the batch's samples out of a plane of the region; the last one is repeated up to a whole
 * vector. */
static void gather(float *restrict out, const float *restrict plane, const uint32_t *restrict order,
                   size_t count, size_t padded, bool ascends) {
    if (ascends && order[count - 1] - order[0] == count - 1) /* side by side */
        memcpy(out, plane + order[0], count * sizeof *out);
    else
        for (size_t k = 0; k < count; k++)
            out[k] = plane[order[k]];
    for (size_t k = count; k < padded; k++)
        out[k] = out[count - 1];
}

/* Pre-shade (PF section 6.1.5.2): position and incident direction from depth and place on the
 * screen. */
static void rebuild_positions(struct shading_node *self, const struct shading_frame *frame,
                              const struct region_view *region, const uint32_t *order, size_t count,
                              size_t padded) {
    struct batch *batch = &self->batch;
    const uint32_t width = frame->grid.region_width;
    for (size_t k = 0; k < padded; k++) {
        const uint32_t sample = order[k < count ? k : count - 1];
        const uint32_t at = self->location[sample];
        const float x = self->screen_x[at % width], y = self->screen_y[at / width];
        const float z = region->depth[sample];
        if (frame->frame.is_perspective) {
            batch->incident[0][k] = batch->position[0][k] = x * z;
            batch->incident[1][k] = batch->position[1][k] = y * z;
            batch->incident[2][k] = z;
        } else {
            batch->position[0][k] = x;
            batch->position[1][k] = y;
            batch->incident[0][k] = batch->incident[1][k] = 0;
            batch->incident[2][k] = 1;
        }
        batch->position[2][k] = z;
    }
}

/* The same in double precision. */
static void rebuild_reference_positions(struct shading_node *self,
                                        const struct shading_frame *frame,
                                        const struct region_view *region, const uint32_t *order,
                                        size_t count, size_t padded) {
    struct reference_batch *batch = &self->reference;
    const uint32_t width = frame->grid.region_width;
    const bool is_perspective = frame->frame.is_perspective;
    for (size_t k = 0; k < padded; k++) {
        const uint32_t sample = order[k < count ? k : count - 1];
        const uint32_t at = self->location[sample];
        const double x = self->screen_x[at % width], y = self->screen_y[at / width];
        const double z = region->depth[sample], scale = is_perspective ? z : 1;
        batch->position[0][k] = x * scale;
        batch->position[1][k] = y * scale;
        batch->position[2][k] = z;
        batch->incident[0][k] = is_perspective ? x * z : 0;
        batch->incident[1][k] = is_perspective ? y * z : 0;
        batch->incident[2][k] = is_perspective ? z : 1;
    }
}

static int shade_batch(struct shading_node *self, const struct shading_frame *frame,
                       const struct region_view *region, struct prepared_shader *instance,
                       struct execution_counts *counts, const uint32_t *order,
                       const uint8_t *present, size_t count, struct colour_draft *draft) {
    const struct shader_module *module = instance->module;
    struct batch *batch = &self->batch;
    const size_t width = module->width, padded = (count + width - 1) / width * width;
    for (int p = 0; p < module->material_count; p++)
        gather((float *)batch->material[p], region->slots + (size_t)p * region->head.sample_count,
               order, count, padded, !present);
    for (size_t k = 0; present && k < padded; k++)
        batch->present[k] = k < count && present[k] ? -1 : 0;
    rebuild_positions(self, frame, region, order, count, padded);
    struct shader_call call = {
        .count = count,
        .material = batch->material,
        .present = batch->present,
        .uniform = instance->uniform,
        .matrices = instance->matrices,
        .lights = instance->lights,
        .instance = instance->payload.id,
        .light_count = instance->light_count,
        .light_vectors = instance->light_vectors,
        .texts = instance->texts ? &instance->texts->texts : NULL,
        .light_scratch = batch->light_scratch,
        .counters = &counts->counters,
    };
    for (int c = 0; c < 3; c++) {
        call.position[c] = batch->position[c];
        call.incident[c] = batch->incident[c];
        call.color[c] = batch->color[c];
        call.opacity[c] = batch->opacity[c];
    }
    if (module->real_bytes == sizeof(double)) {
        rebuild_reference_positions(self, frame, region, order, count, padded);
        reference_batch_shade(&self->reference, module, &call, padded);
    } else {
        module->shade(&call);
    }
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < count; k++)
            if (!present || present[k])
                draft->color[c][order[k]] = batch->color[c][k];
    return call.overrun;
}

/* One instance over all its samples in the region; `leader` is the one it runs with, which keeps
 * the counts. */
static void shade_instance(struct shading_node *self, const struct shading_frame *frame,
                           const struct region_view *region, struct prepared_shader *instance,
                           struct prepared_shader *leader, const uint32_t *order, size_t count,
                           struct colour_draft *draft, struct node_outputs *outputs) {
    const struct shader_module *module = instance->module;
    batch_reserve(&self->batch, (size_t)module->material_count,
                  (size_t)(module->light_sets * instance->light_count * instance->light_vectors));
    if (module->real_bytes == sizeof(double))
        reference_batch_reserve(
            &self->reference, BATCH_SAMPLES, (size_t)module->material_count,
            (size_t)(module->light_sets * instance->light_count * instance->light_vectors));
    if (leader == instance)
        execution_counts_reset(&leader->counts);
    int overrun = 0;
    struct sample_quads quads = {0};
    if (module->uses_neighbours) {
        sample_quads_make(&quads, self->location, frame->grid.region_width,
                          frame->grid.region_height, order, count);
        order = quads.order;
        count = quads.lane_count;
    }
    for (size_t at = 0; at < count; at += BATCH_SAMPLES) {
        const size_t some = count - at < BATCH_SAMPLES ? count - at : BATCH_SAMPLES;
        overrun |= shade_batch(self, frame, region, instance, &leader->counts, order + at,
                               quads.present ? quads.present + at : NULL, some, draft);
    }
    sample_quads_finish(&quads);
    if (overrun && !self->overruns_warned++) {
        char text[256];
        snprintf(text, sizeof text,
                 "shader %s: a loop was stopped after %d turns in frame %d, region %u (and perhaps "
                 "others)",
                 module->name, SHADER_LOOP_LIMIT, self->node.frame, self->node.region);
        node_send(outputs, (struct node_address){NODE_HOST, 0},
                  text_encode(WIRE_WARNING, text, 0, frame->index,
                              node_address_pack(self->node.address)));
    }
}

/* Sorts the covered samples by shader ID, keeping their order within each, and finds where each
 * lies. Returns the number of IDs present, at most `ids_max`, listed with their counts in `ids`. */
struct id_range {
    uint32_t id, first, count;
};

static size_t sort_samples(struct shading_node *self, const struct region_view *region,
                           struct id_range **ranges) {
    const uint32_t samples = region->head.sample_count;
    size_t count = 0, capacity = 0;
    *ranges = NULL;
    static const uint32_t none = UINT32_MAX;
    uint32_t *range_of =
        memory_get(65536, sizeof *range_of); /* calloc: pages of unused IDs cost nothing */
    for (uint32_t i = 0; i < samples; i++) {
        uint32_t *range = &range_of[region->shader[i]];
        if (!*range) {
            *ranges = memory_grow(*ranges, &capacity, count + 1, sizeof **ranges);
            (*ranges)[count] = (struct id_range){region->shader[i], none, 0};
            *range = (uint32_t)++count;
        }
        (*ranges)[*range - 1].count++;
    }
    uint32_t first = 0;
    for (size_t r = 0; r < count; r++) {
        (*ranges)[r].first = first;
        first += (*ranges)[r].count;
        (*ranges)[r].count = 0;
    }
    for (uint32_t i = 0; i < samples; i++) {
        struct id_range *range = &(*ranges)[range_of[region->shader[i]] - 1];
        self->order[range->first + range->count++] = i;
    }
    free(range_of);
    uint32_t at = 0;
    for (uint32_t r = 0; r < region->head.run_count; r++)
        for (uint32_t k = 0; k < region->runs[r].count; k++)
            self->location[at++] = region->runs[r].first + k;
    return count;
}

static void prepare_scratch(struct shading_node *self, const struct shading_frame *frame,
                            uint32_t region) {
    const struct region_grid *grid = &frame->grid;
    if (!self->order) {
        const size_t samples = (size_t)grid->region_width * grid->region_height;
        self->order = memory_get(samples, sizeof *self->order);
        self->location = memory_get(samples, sizeof *self->location);
        self->screen_x = memory_get(grid->region_width, sizeof *self->screen_x);
        self->screen_y = memory_get(grid->region_height, sizeof *self->screen_y);
    }
    uint32_t x, y;
    region_grid_origin(grid, region, &x, &y);
    for (uint32_t i = 0; i < grid->region_width; i++)
        self->screen_x[i] = region_grid_screen_x(grid, &frame->frame, x + i);
    for (uint32_t i = 0; i < grid->region_height; i++)
        self->screen_y[i] = region_grid_screen_y(grid, &frame->frame, y + i);
}

/* Marks the lights that shine on any of the instances, for a new region; returns how many. */
static uint32_t begin_lights(struct shading_frame *frame, struct prepared_shader **instances,
                             size_t count) {
    uint32_t lights = 0;
    for (size_t i = 0; i < count; i++)
        for (int l = 0; l < instances[i]->light_count; l++) {
            struct prepared_shader *light = &frame->lights[instances[i]->payload.lights[l]];
            if (!light->is_counted) {
                execution_counts_reset(&light->counts);
                light->is_counted = true;
                lights++;
            }
        }
    return lights;
}

/* The shared stream runs once for all instances that ask for it (PF section 6.1.5.3), as long as
 * the neediest needs it. */
static void collect_shared(struct prepared_shader **instances, const uint32_t *leaders,
                           size_t instance_count, struct shading_work *work) {
    uint64_t most[SIMD_OPERATION_COUNT] = {0}, one[SIMD_OPERATION_COUNT];
    for (size_t i = 0; i < instance_count; i++) {
        if (leaders[i] != i)
            continue;
        execution_counts_shared_operations(&instances[i]->counts, one);
        for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++)
            most[operation] = one[operation] > most[operation] ? one[operation] : most[operation];
    }
    for (int operation = 0; operation < SIMD_OPERATION_COUNT; operation++) {
        work->operations[operation] += most[operation];
        work->streams[SHADER_SHARED] += most[operation];
    }
}

/* What the array is charged for this region: position reconstruction once, each light once, each
 * instance. */
static void collect_work(struct shading_frame *frame, struct prepared_shader **instances,
                         const uint32_t *leaders, size_t instance_count,
                         struct shading_work *work) {
    work->instance = SHADING_WORK_SHARED;
    work->operations[SIMD_FLOAT_ADD] = 2; /* ours: X and Y from the pixel's address, */
    work->operations[SIMD_FLOAT_MULTIPLY] = frame->frame.is_perspective ? 4 : 2; /* times z */
    work->streams[SHADER_PRE_ILLUM] =
        work->operations[SIMD_FLOAT_ADD] + work->operations[SIMD_FLOAT_MULTIPLY];
    collect_shared(instances, leaders, instance_count, work);
    work++;
    for (size_t l = 0; l < frame->light_count; l++) {
        if (!frame->lights[l].is_counted)
            continue;
        frame->lights[l].is_counted = false;
        work->instance = SHADING_WORK_SHARED + 1 + (uint32_t)l;
        execution_counts_add_operations(&frame->lights[l].counts, work->operations, work->streams);
        work++;
    }
    for (size_t i = 0; i < instance_count; i++) {
        if (leaders[i] != i)
            continue;
        work->instance = instances[i]->payload.id;
        execution_counts_add_operations(&instances[i]->counts, work->operations, work->streams);
        work++;
    }
}

static bool find_instances(struct shading_node *self, struct shading_frame *frame,
                           const struct region_view *region, const struct id_range *ranges,
                           size_t count, struct prepared_shader **instances,
                           struct status *status) {
    for (size_t r = 0; r < count; r++) {
        if (!shading_frame_instance(frame, &self->shaders, ranges[r].id, &instances[r], status))
            return false;
        if ((uint32_t)instances[r]->module->material_count > region->head.slots)
            return status_fail(status, STATUS_INVALID,
                               "samples of instance %u carry too few parameters", ranges[r].id);
    }
    return true;
}

static bool shade_region(struct shading_node *self, const struct pending_region *pending,
                         struct node_outputs *outputs, struct status *status) {
    const struct message *message = pending->message;
    const struct wire_header *header = &pending->header;
    struct shading_frame *frame = frame_of(self, header->frame);
    struct region_view region;
    if (header->region >= frame->grid.count)
        return status_fail(status, STATUS_INVALID, "there is no such region");
    if (!region_open(message->bytes, message->length,
                     frame->grid.region_width * frame->grid.region_height, &region, status))
        return false;
    prepare_scratch(self, frame, header->region);
    struct id_range *ranges;
    const size_t count = sort_samples(self, &region, &ranges);
    struct prepared_shader **instances = memory_get(count, sizeof *instances);
    struct region_sums sums = {0};
    bool ok = find_instances(self, frame, &region, ranges, count, instances, status);
    for (size_t r = 0; ok && r < count; r++)
        sums.map_bytes +=
            (uint64_t)ranges[r].count * (uint64_t)instances[r]->module->material_bytes;
    ok = ok && shading_frame_sum_arrivals(frame, &self->shaders, &pending->arrivals,
                                          region.head.sample_count, &sums, status);
    if (ok) {
        const uint32_t lights = begin_lights(frame, instances, count);
        uint32_t *leaders = memory_get(count, sizeof *leaders), streams = 0;
        instance_merge(instances, count, leaders);
        for (size_t r = 0; r < count; r++)
            streams += leaders[r] == r;
        struct colour_draft draft = colour_draft_create(&region, &sums, 1 + lights + streams);
        for (size_t r = 0; r < count; r++)
            shade_instance(self, frame, &region, instances[r], instances[leaders[r]],
                           self->order + ranges[r].first, ranges[r].count, &draft, outputs);
        collect_work(frame, instances, leaders, count, draft.work);
        free(leaders);
        node_send(outputs, (struct node_address){NODE_FRAMEBUFFER, 0},
                  colour_seal(&draft, header->frame, header->region,
                              node_address_pack(self->node.address)));
    }
    free(instances);
    free(ranges);
    return ok;
}

static bool begin_frame(struct shading_node *self, const struct node_event *event,
                        struct status *status) {
    struct shading_frame *frame = frame_of(self, event->header.frame);
    struct shading_frame *retired = &self->retired[event->header.frame % SHADING_FRAMES];
    if (!self->is_configured)
        return status_fail(status, STATUS_INTERNAL, "frame %u begins before the configuration",
                           event->header.frame);
    shading_frame_finish(retired);
    *retired = *frame;
    *frame = (struct shading_frame){.is_begun = true, .index = event->header.frame};
    if (!frame_payload_decode(event->message, &frame->frame, status) ||
        !region_grid_check(&frame->frame, &self->configuration.machine,
                           self->configuration.shading_nodes, status))
        return false;
    frame->frame_message = message_hold(event->message);
    frame->grid = region_grid_make(&frame->frame, &self->configuration.machine);
    return true;
}

static bool end_frame(struct shading_node *self, const struct node_event *event,
                      struct status *status) {
    struct shading_frame *frame = frame_of(self, event->header.frame);
    struct shading_frame *retired = &self->retired[event->header.frame % SHADING_FRAMES];
    if (!frame->is_begun || frame->index != event->header.frame)
        return status_fail(status, STATUS_INTERNAL, "frame %u ends before it begins",
                           event->header.frame);
    const size_t kept = shading_frame_inherit(frame, retired);
    shading_frame_finish(retired);
    frame->is_complete = true;
    trace_line(self->node.trace, "frame %d received: %zu instances, %zu lights, %zu kept ready",
               frame->frame.number, frame->instance_count, frame->light_count, kept);
    return true;
}

static void pending_finish(struct pending_region *pending) {
    message_release(pending->message);
    region_arrivals_finish(&pending->arrivals);
}

static void queue_push(struct shading_node *self, const struct node_event *event,
                       struct region_arrivals arrivals) {
    if (self->queue_first) {
        memmove(self->queue, self->queue + self->queue_first,
                self->queue_count * sizeof *self->queue);
        self->queue_first = 0;
    }
    self->queue =
        memory_grow(self->queue, &self->queue_capacity, self->queue_count + 1, sizeof *self->queue);
    self->queue[self->queue_count++] =
        (struct pending_region){message_hold(event->message), event->header, arrivals};
}

/* From the chain a region comes whole and never empty; otherwise it is put together here. */
static bool accept_region(struct shading_node *self, const struct node_event *event,
                          struct node_outputs *outputs, struct status *status) {
    struct node_event whole = *event;
    struct region_arrivals arrivals = {0};
    if (!self->is_configured) {
        early_messages_add(&self->early, event);
        return true;
    }
    if (!self->configuration.strategy->plan) {
        queue_push(self, event, (struct region_arrivals){0});
        return true;
    }
    if (!region_gather_add(&self->gather, event, self->expected_parts,
                           (uint32_t)machine_region_samples(&self->configuration.machine),
                           node_address_pack(self->node.address), &whole.message, &arrivals,
                           status))
        return false;
    if (!whole.message)
        return true;
    if (region_sample_count(whole.message->bytes, whole.message->length)) {
        queue_push(self, &whole, arrivals);
        message_release(whole.message);
    } else { /* nothing to shade */
        node_send(outputs, (struct node_address){NODE_FRAMEBUFFER, 0}, whole.message);
    }
    return true;
}

static bool configure(struct shading_node *self, const struct node_event *event,
                      struct node_outputs *outputs, struct status *status) {
    struct configuration *configuration = &self->configuration;
    if (self->is_configured)
        return status_fail(status, STATUS_INVALID, "configured twice");
    if (!configuration_decode(event->message, configuration, status))
        return false;
    self->is_configured = true;
    if (configuration->strategy->plan) {
        struct schedule *schedule =
            schedule_create(configuration->strategy->plan, configuration->rendering_nodes,
                            (uint32_t)machine_region_samples(&configuration->machine));
        self->expected_parts = schedule->final_count;
        schedule_destroy(schedule);
    }
    bool ok = true;
    for (size_t i = 0; ok && i < self->early.count; i++)
        ok = accept_region(self, &self->early.events[i], outputs, status);
    early_messages_finish(&self->early);
    return ok;
}

static bool handle_message(struct shading_node *self, const struct node_event *event,
                           struct node_outputs *outputs, struct status *status) {
    switch (event->header.kind) {
    case WIRE_CONFIGURATION:
        return configure(self, event, outputs, status);
    case WIRE_SHADER:
        return shader_table_announce(&self->shaders, event->message, status);
    case WIRE_FRAME_BEGIN:
        return begin_frame(self, event, status);
    case WIRE_INSTANCE:
    case WIRE_LIGHT:
        return shading_frame_add(frame_of(self, event->header.frame), event->message,
                                 event->header.kind, status);
    case WIRE_FRAME_END:
        return end_frame(self, event, status);
    case WIRE_REGION:
        return accept_region(self, event, outputs, status);
    case WIRE_QUIT:
        self->node.is_finished = true;
        return true;
    default:
        return status_fail(status, STATUS_INVALID, "a shading node was sent a %s message",
                           wire_kind_name(event->header.kind));
    }
}

static bool advance(struct shading_node *self, struct node_outputs *outputs,
                    struct status *status) {
    struct pending_region pending = self->queue[self->queue_first++];
    if (!--self->queue_count)
        self->queue_first = 0;
    const int number = frame_of(self, pending.header.frame)->frame.number;
    node_works_on(&self->node, number, pending.header.region);
    bool ok = shade_region(self, &pending, outputs, status);
    if (!ok)
        status_prefix(status, "frame %d, region %u", number, pending.header.region);
    pending_finish(&pending);
    return ok;
}

static bool shading_node_step(struct node *node, const struct node_event *event,
                              struct node_outputs *outputs, struct status *status) {
    struct shading_node *self = (struct shading_node *)node;
    bool ok = true;
    if (event->kind == NODE_MESSAGE)
        ok = handle_message(self, event, outputs, status);
    else if (event->kind == NODE_WORK && node->has_work)
        ok = advance(self, outputs, status);
    node->has_work = false;
    if (ok && self->queue_count) {
        const uint32_t frame = self->queue[self->queue_first].header.frame;
        node->has_work =
            frame_of(self, frame)->is_complete && frame_of(self, frame)->index == frame;
    }
    return ok;
}

static void shading_node_describe(const struct node *node, char *text, size_t size) {
    const struct shading_node *self = (const struct shading_node *)node;
    if (!self->is_configured)
        snprintf(text, size, "waits for the host's configuration");
    else if (node->has_work)
        snprintf(text, size, "works on frame %d, region %u", node->frame, node->region);
    else if (self->queue_count)
        snprintf(text, size, "waits for the host to end the frame of the region it has");
    else
        snprintf(text, size,
                 "waits for regions from rendering node %u (last was frame %d, region %u)",
                 self->configuration.rendering_nodes - 1, node->frame, node->region);
}

static void shading_node_destroy(struct node *node) {
    struct shading_node *self = (struct shading_node *)node;
    for (int i = 0; i < SHADING_FRAMES; i++) {
        shading_frame_finish(&self->frames[i]);
        shading_frame_finish(&self->retired[i]);
    }
    shader_table_finish(&self->shaders);
    for (size_t i = 0; i < self->queue_count; i++)
        pending_finish(&self->queue[self->queue_first + i]);
    free(self->queue);
    region_gather_finish(&self->gather);
    early_messages_finish(&self->early);
    free(self->batch.memory);
    free(self->batch.material);
    free(self->batch.light_scratch);
    reference_batch_finish(&self->reference);
    free(self->order);
    free(self->location);
    free(self->screen_x);
    free(self->screen_y);
    free(self);
}

bool shading_node_create(uint32_t index, const struct node_services *services, struct trace *trace,
                         struct node **node, struct status *status) {
    static const struct node_type type = {shading_node_step, shading_node_describe,
                                          shading_node_destroy};
    struct shading_node *self = memory_get(1, sizeof *self);
    self->node = (struct node){.type = &type, .address = {NODE_SHADING, index}, .trace = trace};
    self->services = services;
    self->shaders.services = services;
    *node = &self->node;
    return true;
}
