/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/host_node.h"
#include "nodes/stream_cache.h"

#include "netsim/distribution.h"
#include "netsim/what_if.h"
#include "nodes/chunker.h"
#include "nodes/run_recorder.h"
#include "nodes/work_names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HOST_FRAMES_UNDER_WAY = 2 };

/* A message of a frame as it was sent, kept so that a still scene can be sent again. */
struct sent_message {
    struct message *message;
    struct node_address to;
    enum { TO_ONE, TO_SHADING_NODES } audience;
};

struct host_node {
    struct node node;
    struct host_options options;
    struct host_observer observer;
    bool (*build_shaders)(void *, const char *const *, const char *const *, size_t, size_t *,
                          struct status *);
    void *build_context;
    struct rib_reader *reader;
    struct shader_library *library;
    uint32_t shaders_sent;
    struct scene_frame *upcoming; /* read, not sent; NULL: the scene is over */
    bool is_sequence;             /* more than one picture */
    uint32_t next_frame, frames_done;
    uint32_t progress_of; /* index of the frame node.region is of */
    int last_number;      /* of the last frame sent, as FrameBegin or repetition counts */
    int numbers[HOST_FRAMES_UNDER_WAY]; /* of the frames under way */
    bool is_over;                       /* no more frames will be sent */
    struct sent_message *sent;          /* of the last frame of the scene */
    size_t sent_count, sent_capacity;
    struct frame_payload last_frame;
    uint64_t bytes[CAUSE_COUNT]; /* charged for the frame being sent */
    uint16_t *assigned;          /* shading nodes of its regions; NULL: in turn */
    uint32_t regions;            /* of a frame */
    struct work_names
        names[HOST_FRAMES_UNDER_WAY]; /* of the frames under way, when work is explained */
    struct stream_cache streams;
    struct stream_counts stream_counts[HOST_FRAMES_UNDER_WAY]; /* of the frames under way */
    struct run_recorder *recorder;                             /* NULL: the run is not recorded */
    struct host_report report;
    size_t frame_capacity, warning_capacity;
};

static void add_warning(struct host_node *self, const char *text) {
    struct host_report *report = &self->report;
    report->warnings = memory_grow(report->warnings, &self->warning_capacity,
                                   report->warning_count + 1, sizeof *report->warnings);
    report->warnings[report->warning_count++] = memory_copy_string(text);
    if (self->observer.warning)
        self->observer.warning(self->observer.context, text);
}

static void collect_warnings(struct host_node *self) {
    const char *text;
    while ((text = rib_reader_warning(self->reader)))
        add_warning(self, text);
    while ((text = shader_library_warning(self->library)))
        add_warning(self, text);
}

static void charge(struct host_node *self, const struct message *message) {
    struct wire_header header;
    if (!wire_open(message->bytes, message->length, &header, NULL))
        return;
    self->bytes[header.cause] += header.charged_bytes[0];
    self->bytes[CAUSE_CONTROL] += header.charged_bytes[1];
}

static void send_to_role(enum node_role role, uint32_t count, struct message *message,
                         struct node_outputs *outputs) {
    for (uint32_t i = 0; i < count; i++)
        node_send(outputs, (struct node_address){role, i}, message_hold(message));
}

static void broadcast(struct host_node *self, struct message *message,
                      struct node_outputs *outputs) {
    charge(self, message);
    send_to_role(NODE_RENDERING, self->options.rendering_nodes, message, outputs);
    send_to_role(NODE_SHADING, self->options.shading_nodes, message, outputs);
    send_to_role(NODE_FRAMEBUFFER, 1, message, outputs);
    message_release(message);
}

/* Sends a message of the frame's contents and remembers it. Takes over the hold. */
static void send_content(struct host_node *self, struct sent_message item,
                         struct node_outputs *outputs) {
    charge(self, item.message);
    if (item.audience == TO_ONE)
        node_send(outputs, item.to, message_hold(item.message));
    else
        send_to_role(NODE_SHADING, self->options.shading_nodes, item.message, outputs);
    if (self->options.frames <= 1) { /* nothing will be repeated */
        message_release(item.message);
        return;
    }
    self->sent =
        memory_grow(self->sent, &self->sent_capacity, self->sent_count + 1, sizeof *self->sent);
    self->sent[self->sent_count++] = item;
}

static void forget_sent(struct host_node *self) {
    for (size_t i = 0; i < self->sent_count; i++)
        message_release(self->sent[i].message);
    self->sent_count = 0;
}

/* The same message for another frame. */
static struct message *message_for_frame(const struct message *message, uint32_t frame) {
    struct message *copy = message_create(message->length);
    struct wire_header header;
    memcpy(copy->bytes, message->bytes, message->length);
    if (wire_open(message->bytes, message->length, &header, NULL)) {
        header.frame = frame;
        wire_seal(copy, header);
    }
    return copy;
}

static bool read_upcoming(struct host_node *self, struct status *status) {
    bool ok = rib_reader_next(self->reader, &self->upcoming, status);
    collect_warnings(self);
    return ok;
}

static bool compile_new_shaders(struct host_node *self, struct status *status) {
    const uint32_t first = self->shaders_sent, count = shader_library_count(self->library) - first;
    if (!count || !self->build_shaders)
        return true;
    const char **names = memory_get(count, sizeof *names),
               **sources = memory_get(count, sizeof *sources);
    for (uint32_t i = 0; i < count; i++) {
        const struct shader_program *program = shader_library_at(self->library, first + i)->program;
        names[i] = program->name;
        sources[i] = program->c_source;
    }
    size_t compiled = 0;
    bool ok = self->build_shaders(self->build_context, names, sources, count, &compiled, status);
    if (ok && self->observer.shaders_compiled)
        self->observer.shaders_compiled(self->observer.context, count, compiled);
    free(names);
    free(sources);
    return ok;
}

static void announce_shaders(struct host_node *self, struct node_outputs *outputs) {
    for (; self->shaders_sent < shader_library_count(self->library); self->shaders_sent++) {
        const struct shader_program *program =
            shader_library_at(self->library, self->shaders_sent)->program;
        const struct shader_payload payload = {self->shaders_sent, program->name,
                                               program->c_source};
        struct message *message = shader_payload_encode(&payload, self->next_frame);
        charge(self, message);
        send_to_role(NODE_SHADING, self->options.shading_nodes, message, outputs);
        message_release(message);
    }
}

static void report_instances(struct host_node *self, const struct frame_plan *plan) {
    struct host_report *report = &self->report;
    if (report->instances)
        return;
    report->instances = memory_get(plan->instance_count, sizeof *report->instances);
    report->instance_count = plan->instance_count;
    for (size_t i = 0; i < plan->instance_count; i++) {
        const struct shader_program *program = plan->instances[i].variant->program;
        struct instance_report *instance = &report->instances[i];
        memcpy(instance->name, plan->instances[i].name, sizeof instance->name);
        instance->shader = program->name;
        instance->map_bytes =
            (uint32_t)(self->options.machine.composition_shader_id_bytes + program->material_bytes);
        instance->bound_bytes = plan->instances[i].bound_bytes;
        instance->parameters =
            memory_get((size_t)program->parameter_count, sizeof *instance->parameters);
        for (int p = 0; p < program->parameter_count; p++)
            if (program->parameters[p].is_material)
                instance->parameters[instance->parameter_count++] = (struct planned_parameter){
                    program->parameters[p].name, (uint32_t)program->parameters[p].bytes};
    }
}

static struct frame_payload frame_payload_of(const struct host_node *self,
                                             const struct scene_camera *camera) {
    struct frame_payload payload = {
        .width = (uint32_t)camera->width,
        .height = (uint32_t)camera->height,
        .samples_x = (uint32_t)camera->samples_x,
        .samples_y = (uint32_t)camera->samples_y,
        .is_perspective = camera->is_perspective,
        .write_png = self->options.write_png,
        .compression = self->options.compression,
        .explain_work = self->options.explain_work,
        .near_plane = camera->near_plane,
        .far_plane = camera->far_plane,
    };
    memcpy(payload.screen_window, camera->screen_window, sizeof payload.screen_window);
    return payload;
}

/* By the costs of a record, when one is given: which shading node gets which region. */
static bool assign_regions(struct host_node *self, struct frame_payload *payload,
                           struct status *status) {
    const struct host_options *options = &self->options;
    if (!options->costs)
        return true;
    const uint32_t count = region_grid_make(payload, &options->machine).count;
    if (!what_if_can_assign(options->costs, self->next_frame, &options->machine, count, status))
        return status_prefix(status, "frame %d", payload->number);
    uint32_t *node = memory_get(count, sizeof *node);
    free(self->assigned);
    self->assigned = memory_get(count, sizeof *self->assigned);
    what_if_assign(options->costs, self->next_frame, &options->machine, options->shading_nodes,
                   node);
    for (uint32_t k = 0; k < count; k++)
        self->assigned[k] = (uint16_t)node[k];
    free(node);
    payload->assigned = self->assigned;
    payload->assigned_count = count;
    return true;
}

static bool begin_frame(struct host_node *self, struct frame_payload *payload,
                        struct node_outputs *outputs, struct status *status) {
    char name[4096] = "";
    payload->assigned_count = 0;
    if (!region_grid_check(payload, &self->options.machine, self->options.shading_nodes, status) ||
        !assign_regions(self, payload, status))
        return false;
    if (self->options.output && self->options.output[0] &&
        !host_image_name(self->options.output, self->is_sequence, payload->number, name,
                         sizeof name, status))
        return false;
    payload->image_path = name;
    broadcast(self, frame_payload_encode(payload, self->next_frame), outputs);
    payload->image_path = "";
    self->last_frame = *payload;
    self->last_number = payload->number;
    self->numbers[self->next_frame % HOST_FRAMES_UNDER_WAY] = payload->number;
    self->regions = region_grid_make(payload, &self->options.machine).count;
    if (self->recorder)
        run_recorder_begin_frame(self->recorder, payload->number, payload);
    return true;
}

static void end_frame(struct host_node *self, struct node_outputs *outputs) {
    /* the totals include the message that carries them */
    struct message *probe = frame_end_encode(self->bytes, self->next_frame);
    charge(self, probe);
    message_release(probe);
    uint64_t bytes[CAUSE_COUNT];
    memcpy(bytes, self->bytes, sizeof bytes);
    broadcast(self, frame_end_encode(bytes, self->next_frame), outputs);
    /* a record does not depend on who gets which region */
    bytes[CAUSE_CONTROL] -= WHAT_IF_ASSIGNMENT_BYTES * (uint64_t)self->last_frame.assigned_count;
    if (self->recorder)
        run_recorder_end_frame(self->recorder, bytes);
    memset(self->bytes, 0, sizeof self->bytes);
    self->next_frame++;
}

static bool send_chunks(struct host_node *self, const struct scene_frame *frame,
                        const struct frame_plan *plan, struct node_outputs *outputs,
                        struct status *status) {
    struct chunk_list list = {.is_recorded = self->recorder != NULL};
    const struct chunk_cutting cutting = {self->next_frame, self->options.chunk_triangles,
                                          self->options.precision.parameters};
    const bool ok = chunker_cut(frame, plan, &cutting, &list, status);
    uint32_t *node =
        distribution_assign(list.count, self->options.rendering_nodes, self->options.seed);
    if (ok && self->recorder)
        run_recorder_add_chunks(self->recorder, &list.recorded);
    for (size_t i = 0; i < list.count; i++) {
        if (ok)
            send_content(self,
                         (struct sent_message){list.messages[i], {NODE_RENDERING, node[i]}, TO_ONE},
                         outputs);
        else
            message_release(list.messages[i]);
    }
    free(node);
    chunk_list_finish(&list);
    return ok;
}

/* Pictures are named by the numbers of frames: two of one number would overwrite each other. */
static int frame_number(struct host_node *self, const struct scene_frame *frame) {
    char text[256];
    if (!self->next_frame || frame->number > self->last_number)
        return frame->number;
    snprintf(text, sizeof text, "%.100s: frame %d comes after frame %d; its picture is numbered %d",
             self->options.scene, frame->number, self->last_number, self->last_number + 1);
    if (self->options.output && self->options.output[0])
        add_warning(self, text);
    return self->last_number + 1;
}

static bool send_new_frame(struct host_node *self, struct scene_frame *frame,
                           struct node_outputs *outputs, struct status *status) {
    struct frame_plan plan;
    bool ok = frame_plan_make(frame, self->library, &plan, status);
    collect_warnings(self);
    if (!ok)
        return false;
    struct frame_payload payload = frame_payload_of(self, &frame->camera);
    payload.number = frame_number(self, frame);
    ok = compile_new_shaders(self, status) && begin_frame(self, &payload, outputs, status);
    if (ok) {
        report_instances(self, &plan);
        self->stream_counts[self->next_frame % HOST_FRAMES_UNDER_WAY] =
            stream_cache_next(&self->streams, &plan);
        if (self->options.explain_work)
            work_names_take(&self->names[self->next_frame % HOST_FRAMES_UNDER_WAY], &plan);
        if (self->recorder)
            run_recorder_add_plan(self->recorder, &plan);
        announce_shaders(self, outputs);
        forget_sent(self);
        for (size_t l = 0; l < plan.light_count; l++)
            send_content(
                self,
                (struct sent_message){message_for_frame(plan.lights[l].message, self->next_frame),
                                      {NODE_SHADING, 0},
                                      TO_SHADING_NODES},
                outputs);
        for (size_t i = 0; i < plan.instance_count; i++)
            send_content(self,
                         (struct sent_message){
                             message_for_frame(plan.instances[i].message, self->next_frame),
                             {NODE_SHADING, 0},
                             TO_SHADING_NODES},
                         outputs);
        ok = send_chunks(self, frame, &plan, outputs, status);
    }
    frame_plan_finish(&plan);
    if (ok)
        end_frame(self, outputs);
    return ok;
}

static bool repeat_frame(struct host_node *self, struct node_outputs *outputs,
                         struct status *status) {
    self->last_frame.number = self->last_number + 1;
    if (!begin_frame(self, &self->last_frame, outputs, status))
        return false;
    self->stream_counts[self->next_frame % HOST_FRAMES_UNDER_WAY] =
        stream_cache_repeat(&self->streams);
    work_names_copy(&self->names[self->next_frame % HOST_FRAMES_UNDER_WAY],
                    &self->names[(self->next_frame + 1) % HOST_FRAMES_UNDER_WAY]);
    if (self->recorder)
        run_recorder_repeat(self->recorder);
    struct sent_message *old = self->sent;
    const size_t count = self->sent_count;
    self->sent = NULL;
    self->sent_count = self->sent_capacity = 0;
    for (size_t i = 0; i < count; i++) {
        struct sent_message item = old[i];
        item.message = message_for_frame(old[i].message, self->next_frame);
        message_release(old[i].message);
        send_content(self, item, outputs);
    }
    free(old);
    end_frame(self, outputs);
    return true;
}

static bool wants_more(const struct host_node *self) {
    if (self->options.frames)
        return self->next_frame < (uint32_t)self->options.frames &&
               (self->upcoming || self->next_frame);
    return self->upcoming != NULL;
}

static bool send_frame(struct host_node *self, struct node_outputs *outputs,
                       struct status *status) {
    struct scene_frame *frame = self->upcoming;
    if (!frame)
        return repeat_frame(self, outputs, status);
    self->upcoming = NULL;
    bool ok = send_new_frame(self, frame, outputs, status);
    scene_frame_destroy(frame);
    return ok && read_upcoming(self, status);
}

static bool skip_frames(struct host_node *self, struct status *status) {
    for (int i = 0; self->upcoming && i < self->options.skipped_frames; i++) {
        scene_frame_destroy(self->upcoming);
        self->upcoming = NULL;
        if (!read_upcoming(self, status))
            return false;
        if (!self->upcoming)
            return status_fail(status, STATUS_INVALID,
                               "%s: --skip %d leaves no frame to render: the scene has %d",
                               self->options.scene, self->options.skipped_frames, i + 1);
    }
    return true;
}

static bool start(struct host_node *self, struct node_outputs *outputs, struct status *status) {
    const struct configuration configuration = {
        self->options.rendering_nodes, self->options.shading_nodes,
        self->options.strategy ? self->options.strategy : strategy_at(0), self->options.is_recorded,
        self->options.machine};
    struct scene_frame *first;
    if (!read_upcoming(self, status) || !skip_frames(self, status))
        return false;
    if (!self->upcoming)
        return status_fail(status, STATUS_INVALID,
                           "%s: error: the scene holds no world block (WorldBegin "
                           "... WorldEnd), so there is nothing to render",
                           self->options.scene);
    broadcast(self, configuration_encode(&configuration), outputs);
    first = self->upcoming;
    self->upcoming = NULL;
    /* look ahead: whether pictures need numbers depends on whether there is a second frame */
    self->is_sequence = self->options.frames > 1;
    if (!self->is_sequence && self->options.frames != 1) {
        if (!read_upcoming(self, status)) {
            scene_frame_destroy(first);
            return false;
        }
        self->is_sequence = self->upcoming != NULL;
    } else if (self->is_sequence && !read_upcoming(self, status)) {
        scene_frame_destroy(first);
        return false;
    }
    bool ok = send_new_frame(self, first, outputs, status);
    scene_frame_destroy(first);
    return ok;
}

/* Once all frames are sent: fast calls of shaders that none of them has. */
static void warn_of_unused_calls(struct host_node *self) {
    const struct fast_calls *calls = &self->options.precision.fast_calls;
    for (int i = 0; i < calls->count; i++) {
        char text[256];
        if (shader_library_has(self->library, calls->list[i].shader))
            continue;
        snprintf(text, sizeof text, "--fast-calls: the frames have no shader \"%.100s\"",
                 calls->list[i].shader);
        add_warning(self, text);
    }
}

/* The number of a frame under way, from its index. */
static int number_under_way(const struct host_node *self, uint32_t frame) {
    return self->numbers[frame % HOST_FRAMES_UNDER_WAY];
}

static bool finish_frame(struct host_node *self, const struct node_event *event,
                         struct status *status) {
    struct host_report *report = &self->report;
    struct frame_record record;
    if (!frame_record_decode(event->message, &record, status))
        return false;
    report->frames = memory_grow(report->frames, &self->frame_capacity, report->frame_count + 1,
                                 sizeof *report->frames);
    record.frame = event->header.frame;
    record.number = number_under_way(self, record.frame);
    record.streams_generated = self->stream_counts[record.frame % HOST_FRAMES_UNDER_WAY].generated;
    record.streams_reused = self->stream_counts[record.frame % HOST_FRAMES_UNDER_WAY].reused;
    work_names_apply(&self->names[record.frame % HOST_FRAMES_UNDER_WAY], &record.work);
    report->frames[report->frame_count++] = record;
    self->frames_done++;
    char text[256];
    if (record.nan_depths) {
        snprintf(text, sizeof text,
                 "frame %d: %llu samples with a depth that is not a number were refused",
                 record.number, (unsigned long long)record.nan_depths);
        add_warning(self, text);
    }
    if (record.nan_colours) {
        snprintf(text, sizeof text,
                 "frame %d: %llu colour components of samples are not finite numbers",
                 record.number, (unsigned long long)record.nan_colours);
        add_warning(self, text);
    }
    if (self->observer.frame_done)
        self->observer.frame_done(self->observer.context, &record);
    return true;
}

static bool fail_from_node(const struct node_event *event, struct status *status) {
    char name[NODE_NAME_BYTES];
    const char *text = text_decode(event->message, status);
    if (!text)
        return false;
    return status_fail(
        status, (enum status_code)(event->header.region ? event->header.region : STATUS_INTERNAL),
        "%s: %s", node_address_name(node_address_unpack(event->header.sender), name), text);
}

static bool handle_message(struct host_node *self, const struct node_event *event,
                           struct status *status) {
    const char *text;
    switch (event->header.kind) {
    case WIRE_PROGRESS:
        if (self->observer.progress)
            self->observer.progress(self->observer.context,
                                    number_under_way(self, event->header.frame),
                                    event->header.region, self->regions);
        node_works_on(&self->node, number_under_way(self, event->header.frame),
                      event->header.region);
        self->progress_of = event->header.frame;
        return true;
    case WIRE_FRAME_DONE:
        return finish_frame(self, event, status);
    case WIRE_WARNING:
        text = text_decode(event->message, status);
        if (text)
            add_warning(self, text);
        return text != NULL;
    case WIRE_FAILURE:
        return fail_from_node(event, status);
    case WIRE_CHUNK_WORK:
    case WIRE_REGION_COSTS:
        if (self->recorder)
            return run_recorder_accept(self->recorder, event->message, &event->header, status);
        return status_fail(status, STATUS_INVALID, "costs of a run that is not recorded");
    case WIRE_GOODBYE:
        self->node.is_finished = true;
        return true;
    default:
        return status_fail(status, STATUS_INVALID, "the host was sent a %s message",
                           wire_kind_name(event->header.kind));
    }
}

static bool host_node_step(struct node *node, const struct node_event *event,
                           struct node_outputs *outputs, struct status *status) {
    struct host_node *self = (struct host_node *)node;
    bool ok = true;
    if (event->kind == NODE_START)
        ok = start(self, outputs, status);
    else if (event->kind == NODE_MESSAGE)
        ok = handle_message(self, event, status);
    else if (node->has_work)
        ok = send_frame(self, outputs, status);
    node->has_work = ok && !self->is_over && wants_more(self) &&
                     self->next_frame - self->frames_done < HOST_FRAMES_UNDER_WAY;
    if (ok && !self->is_over && !wants_more(self) && self->frames_done == self->next_frame &&
        (!self->recorder || run_recorder_is_complete(self->recorder))) {
        self->is_over = node->is_closing = true;
        warn_of_unused_calls(self);
        broadcast(self, signal_encode(WIRE_QUIT, 0, 0, node_address_pack(node->address)), outputs);
    }
    return ok;
}

static void host_node_describe(const struct node *node, char *text, size_t size) {
    const struct host_node *self = (const struct host_node *)node;
    if (self->is_over)
        snprintf(text, size, "waits for the framebuffer node to finish writing pictures");
    else if (node->has_work)
        snprintf(text, size, "prepares frame %d",
                 self->upcoming ? self->upcoming->number : self->last_number + 1);
    else
        snprintf(text, size,
                 "waits for the framebuffer node to complete frame %d (%u of %u regions known to "
                 "be done)",
                 number_under_way(self, self->frames_done),
                 node->has_frame && self->progress_of == self->frames_done ? node->region : 0,
                 self->regions);
}

static void host_node_destroy(struct node *node) {
    struct host_node *self = (struct host_node *)node;
    struct host_report *report = &self->report;
    forget_sent(self);
    free(self->sent);
    free(self->assigned);
    for (int i = 0; i < HOST_FRAMES_UNDER_WAY; i++)
        work_names_finish(&self->names[i]);
    if (self->upcoming)
        scene_frame_destroy(self->upcoming);
    rib_reader_destroy(self->reader);
    run_recorder_destroy(self->recorder);
    stream_cache_finish(&self->streams);
    if (!self->options.library)
        shader_library_destroy(self->library);
    for (size_t i = 0; i < report->frame_count; i++)
        frame_record_finish(&report->frames[i]);
    for (size_t i = 0; i < report->instance_count; i++)
        free(report->instances[i].parameters);
    for (size_t i = 0; i < report->warning_count; i++)
        free(report->warnings[i]);
    free(report->frames);
    free(report->instances);
    free(report->warnings);
    free(self);
}

bool host_node_create(const struct host_options *options, const struct host_observer *observer,
                      bool (*build_shaders)(void *, const char *const *, const char *const *,
                                            size_t, size_t *, struct status *),
                      void *build_context, struct trace *trace, struct node **node,
                      struct status *status) {
    static const struct node_type type = {host_node_step, host_node_describe, host_node_destroy};
    struct rib_reader *reader;
    if (!rib_reader_open(options->scene, &options->reading, &reader, status))
        return false;
    struct host_node *self = memory_get(1, sizeof *self);
    self->node = (struct node){.type = &type, .address = {NODE_HOST, 0}, .trace = trace};
    self->options = *options;
    if (!self->options.chunk_triangles)
        self->options.chunk_triangles = CHUNK_TRIANGLES_DEFAULT;
    if (observer)
        self->observer = *observer;
    self->build_shaders = build_shaders;
    self->build_context = build_context;
    self->reader = reader;
    self->library = options->library
                        ? options->library
                        : shader_library_create(options->shader_folders,
                                                options->shader_folder_count, &options->precision);
    const struct shader_compile_options base = {.pixel_memory_bytes =
                                                    (int)options->machine.pixel_memory_bytes,
                                                .allows_external = options->allows_external};
    shader_library_set_base(self->library, &base);
    self->report.shaders = self->library;
    if (options->is_recorded) {
        self->recorder = run_recorder_create(
            options->scene, &options->machine, options->seed, self->options.chunk_triangles,
            options->precision.fast_math, options->rendering_nodes);
        self->report.record = run_recorder_record(self->recorder);
    }
    *node = &self->node;
    return true;
}

const struct host_report *host_node_report(const struct node *node) {
    return &((const struct host_node *)node)->report;
}
