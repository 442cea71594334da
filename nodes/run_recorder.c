/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/run_recorder.h"

#include <stdlib.h>
#include <string.h>

/* A frame of which not everything has arrived. */
struct pending_frame {
    uint32_t nodes_to_come; /* rendering nodes */
    bool has_costs;
    struct chunk_work *work; /* of all nodes so far */
    size_t work_count, work_capacity;
    struct region_costs *costs;
    size_t cost_count;
    struct message *costs_message; /* what they point into */
};

struct run_recorder {
    struct run_record *record;
    uint32_t rendering_nodes;
    struct pending_frame *pending; /* by frame */
    size_t pending_capacity;
    uint32_t complete_count;
};

struct run_recorder *run_recorder_create(const char *scene, const struct machine *machine,
                                         uint64_t seed, uint32_t chunk_triangles, bool fast_math,
                                         uint32_t rendering_nodes) {
    struct run_recorder *recorder = memory_get(1, sizeof *recorder);
    const char *slash = strrchr(scene, '/');
    recorder->rendering_nodes = rendering_nodes;
    recorder->record = memory_get(1, sizeof *recorder->record);
    recorder->record->scene = memory_copy_string(slash ? slash + 1 : scene);
    recorder->record->machine = *machine;
    recorder->record->seed = seed;
    recorder->record->chunk_triangles = chunk_triangles;
    recorder->record->fast_math = fast_math;
    return recorder;
}

static void pending_finish(struct pending_frame *pending) {
    free(pending->work);
    free(pending->costs);
    message_release(pending->costs_message);
    *pending = (struct pending_frame){0};
}

void run_recorder_destroy(struct run_recorder *recorder) {
    if (!recorder)
        return;
    for (uint32_t f = 0; f < recorder->record->frame_count; f++)
        pending_finish(&recorder->pending[f]);
    free(recorder->pending);
    record_destroy(recorder->record);
    free(recorder);
}

static struct record_frame *last_frame(struct run_recorder *recorder) {
    return &recorder->record->frames[recorder->record->frame_count - 1];
}

void run_recorder_begin_frame(struct run_recorder *recorder, int number,
                              const struct frame_payload *payload) {
    struct record_frame *frame = record_add_frame(recorder->record);
    frame->number = number;
    frame->width = payload->width;
    frame->height = payload->height;
    frame->samples_x = payload->samples_x;
    frame->samples_y = payload->samples_y;
    frame->region_count = region_grid_make(payload, &recorder->record->machine).count;
    frame->regions = memory_get(frame->region_count, sizeof *frame->regions);
    const uint32_t count = recorder->record->frame_count;
    recorder->pending = memory_grow(recorder->pending, &recorder->pending_capacity, count,
                                    sizeof *recorder->pending);
    recorder->pending[count - 1] =
        (struct pending_frame){.nodes_to_come = recorder->rendering_nodes};
}

static void add_instance(struct record_instance *instance, const struct planned_instance *planned) {
    const struct shader_program *program = planned->variant->program;
    instance->name = memory_copy_string(planned->name);
    instance->shader = memory_copy_string(program->name);
    instance->bound_bytes = planned->bound_bytes;
    instance->parameters =
        memory_get((size_t)program->parameter_count, sizeof *instance->parameters);
    for (int p = 0; p < program->parameter_count; p++) {
        const struct shader_parameter *parameter = &program->parameters[p];
        if (!parameter->is_material && parameter->bound_offset < 0)
            continue;
        instance->parameters[instance->parameter_count++] = (struct record_parameter){
            memory_copy_string(parameter->name), (uint32_t)parameter->components,
            (uint32_t)parameter->bytes,
            parameter->is_material                                               ? RECORD_MATERIAL
            : parameter->is_uniform_declared || parameter->type == SHADER_STRING ? RECORD_UNIFORM
                                                                                 : RECORD_BOUND,
            parameter->is_global && strcmp(parameter->name, "Cs") && strcmp(parameter->name, "Os")};
    }
}

void run_recorder_add_plan(struct run_recorder *recorder, const struct frame_plan *plan) {
    struct record_frame *frame = last_frame(recorder);
    frame->instances = memory_get(plan->instance_count, sizeof *frame->instances);
    frame->instance_count = (uint32_t)plan->instance_count;
    for (size_t i = 0; i < plan->instance_count; i++)
        add_instance(&frame->instances[i], &plan->instances[i]);
    frame->lights = memory_get(plan->light_count, sizeof *frame->lights);
    frame->light_count = (uint32_t)plan->light_count;
    for (size_t l = 0; l < plan->light_count; l++)
        frame->lights[l] = memory_copy_string(plan->lights[l].name);
}

void run_recorder_add_chunks(struct run_recorder *recorder, const struct record_frame *chunks) {
    record_copy_chunks(last_frame(recorder), chunks);
}

void run_recorder_repeat(struct run_recorder *recorder) {
    struct record_frame *frame = last_frame(recorder);
    const struct record_frame *before = frame - 1;
    record_copy_shaders(frame, before);
    record_copy_chunks(frame, before);
}

void run_recorder_end_frame(struct run_recorder *recorder, const uint64_t bytes[CAUSE_COUNT]) {
    memcpy(last_frame(recorder)->geometry_bytes, bytes, CAUSE_COUNT * sizeof *bytes);
}

static int compare_work(const void *a, const void *b) {
    const struct chunk_work *x = a, *y = b;
    if (x->region != y->region)
        return x->region < y->region ? -1 : 1;
    return x->chunk < y->chunk ? -1 : x->chunk > y->chunk;
}

/* Everything of the frame is here: enters it into the record. */
static bool complete_frame(struct record_frame *frame, struct pending_frame *pending,
                           struct status *status) {
    if (pending->work_count)
        qsort(pending->work, pending->work_count, sizeof *pending->work, compare_work);
    for (size_t w = 0; w < pending->work_count; w++) {
        const struct chunk_work *work = &pending->work[w];
        if (work->region >= frame->region_count || work->chunk >= frame->chunk_count ||
            (w && !compare_work(work - 1, work)))
            return status_fail(status, STATUS_INVALID,
                               "damaged chunk work message: region %u, chunk %u", work->region,
                               work->chunk);
        record_add_entry(frame, &frame->regions[work->region],
                         (struct record_entry){work->chunk, work->triangles, work->covers != 0});
    }
    for (size_t c = 0; c < pending->cost_count; c++) {
        const struct region_costs *costs = &pending->costs[c];
        if (costs->region >= frame->region_count)
            return status_fail(status, STATUS_INVALID, "damaged region costs message: region %u",
                               costs->region);
        struct record_region *region = &frame->regions[costs->region];
        region->samples = costs->samples;
        region->map_bytes = costs->map_bytes;
        for (uint32_t w = 0; w < costs->work_count; w++)
            record_add_work(frame, region, costs->work[w].instance, costs->work[w].operations);
    }
    pending_finish(pending);
    return true;
}

static bool accept_chunk_work(struct pending_frame *pending, const struct message *message,
                              struct status *status) {
    const struct chunk_work *work;
    size_t count;
    if (!pending->nodes_to_come || !chunk_work_decode(message, &work, &count, status))
        return pending->nodes_to_come
                   ? false
                   : status_fail(status, STATUS_INVALID, "chunk work arrived twice");
    pending->work = memory_grow(pending->work, &pending->work_capacity, pending->work_count + count,
                                sizeof *pending->work);
    if (count)
        memcpy(pending->work + pending->work_count, work, count * sizeof *work);
    pending->work_count += count;
    pending->nodes_to_come--;
    return true;
}

bool run_recorder_accept(struct run_recorder *recorder, const struct message *message,
                         const struct wire_header *header, struct status *status) {
    if (header->frame >= recorder->record->frame_count)
        return status_fail(status, STATUS_INVALID, "costs of frame %u, which is not begun",
                           header->frame);
    struct pending_frame *pending = &recorder->pending[header->frame];
    if (header->kind == WIRE_CHUNK_WORK) {
        if (!accept_chunk_work(pending, message, status))
            return status_prefix(status, "frame %u", header->frame);
    } else {
        if (pending->has_costs)
            return status_fail(status, STATUS_INVALID, "costs of frame %u arrived twice",
                               header->frame);
        if (!region_costs_decode(message, &pending->costs, &pending->cost_count, status))
            return status_prefix(status, "frame %u", header->frame);
        pending->has_costs = true;
        pending->costs_message = message_hold((struct message *)message);
    }
    if (pending->nodes_to_come || !pending->has_costs)
        return true;
    recorder->complete_count++;
    return complete_frame(&recorder->record->frames[header->frame], pending, status) ||
           status_prefix(status, "frame %u", header->frame);
}

bool run_recorder_is_complete(const struct run_recorder *recorder) {
    return recorder->complete_count == recorder->record->frame_count;
}

const struct run_record *run_recorder_record(const struct run_recorder *recorder) {
    return recorder->record;
}
