/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/protocol.h"

#include "netsim/what_if.h"
#include "shaders/simd/shader_module.h"

#include <math.h>
#include <string.h>

static struct wire_reader reader_of(const struct message *message) {
    return wire_payload(message->bytes, message->length);
}

static struct wire_header control_header(enum wire_kind kind, uint32_t frame, uint64_t charged) {
    return (struct wire_header){
        .kind = kind, .frame = frame, .cause = CAUSE_CONTROL, .charged_bytes = {0, charged}};
}

struct message *configuration_encode(const struct configuration *configuration) {
    struct wire_writer writer = {0};
    int64_t values[MACHINE_VALUE_COUNT];
    machine_to_values(&configuration->machine, values);
    wire_put_u32(&writer, configuration->rendering_nodes);
    wire_put_u32(&writer, configuration->shading_nodes);
    wire_put_string(&writer, configuration->strategy->name);
    wire_put_u32(&writer, configuration->is_recorded);
    wire_put_string(&writer, configuration->machine.name);
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++)
        wire_put_u64(&writer, (uint64_t)values[i]);
    return wire_finish(&writer, control_header(WIRE_CONFIGURATION, 0, 0));
}

bool configuration_decode(const struct message *message, struct configuration *configuration,
                          struct status *status) {
    struct wire_reader reader = reader_of(message);
    int64_t values[MACHINE_VALUE_COUNT];
    configuration->rendering_nodes = wire_get_u32(&reader);
    configuration->shading_nodes = wire_get_u32(&reader);
    configuration->strategy = strategy_find(wire_get_string(&reader));
    configuration->is_recorded = wire_get_u32(&reader);
    const char *name = wire_get_string(&reader);
    for (int i = 0; i < MACHINE_VALUE_COUNT; i++)
        values[i] = (int64_t)wire_get_u64(&reader);
    if (!wire_reader_done(&reader, "configuration", status))
        return false;
    if (!configuration->rendering_nodes || !configuration->shading_nodes ||
        configuration->rendering_nodes > 65536 || configuration->shading_nodes > 65536)
        return status_fail(status, STATUS_INVALID, "damaged configuration message: node counts");
    if (!configuration->strategy)
        return status_fail(status, STATUS_INVALID, "damaged configuration message: composition");
    return machine_from_values(name, values, &configuration->machine, status);
}

struct message *shader_payload_encode(const struct shader_payload *shader, uint32_t frame) {
    struct wire_writer writer = {0};
    wire_put_u32(&writer, shader->number);
    wire_put_string(&writer, shader->name);
    wire_put_string(&writer, shader->c_source);
    return wire_finish(&writer,
                       (struct wire_header){.kind = WIRE_SHADER,
                                            .frame = frame,
                                            .cause = CAUSE_SHADERS,
                                            .charged_bytes = {4 + strlen(shader->name), 0}});
}

bool shader_payload_decode(const struct message *message, struct shader_payload *shader,
                           struct status *status) {
    struct wire_reader reader = reader_of(message);
    shader->number = wire_get_u32(&reader);
    shader->name = wire_get_string(&reader);
    shader->c_source = wire_get_string(&reader);
    return wire_reader_done(&reader, "shader", status);
}

struct message *frame_payload_encode(const struct frame_payload *frame, uint32_t index) {
    struct wire_writer writer = {0};
    wire_put_u32(&writer, frame->width);
    wire_put_u32(&writer, frame->height);
    wire_put_u32(&writer, frame->samples_x);
    wire_put_u32(&writer, frame->samples_y);
    wire_put_u32(&writer, frame->is_perspective);
    for (int i = 0; i < 4; i++)
        wire_put_f64(&writer, frame->screen_window[i]);
    wire_put_f64(&writer, frame->near_plane);
    wire_put_f64(&writer, frame->far_plane);
    const uint64_t camera_bytes =
        writer.length; /* file names are the simulator's, not the machine's */
    wire_put_u32(&writer, frame->write_png);
    wire_put_u32(&writer, frame->compression);
    wire_put_u32(&writer, frame->explain_work);
    wire_put_u32(&writer, (uint32_t)frame->number);
    wire_put_u32(&writer, frame->assigned_count);
    wire_put(&writer, frame->assigned, frame->assigned_count * sizeof *frame->assigned);
    wire_put_string(&writer, frame->image_path);
    return wire_finish(&writer, control_header(WIRE_FRAME_BEGIN, index,
                                               camera_bytes + WHAT_IF_ASSIGNMENT_BYTES *
                                                                  (uint64_t)frame->assigned_count));
}

bool frame_payload_decode(const struct message *message, struct frame_payload *frame,
                          struct status *status) {
    struct wire_reader reader = reader_of(message);
    frame->width = wire_get_u32(&reader);
    frame->height = wire_get_u32(&reader);
    frame->samples_x = wire_get_u32(&reader);
    frame->samples_y = wire_get_u32(&reader);
    frame->is_perspective = wire_get_u32(&reader);
    for (int i = 0; i < 4; i++)
        frame->screen_window[i] = wire_get_f64(&reader);
    frame->near_plane = wire_get_f64(&reader);
    frame->far_plane = wire_get_f64(&reader);
    frame->write_png = wire_get_u32(&reader);
    frame->compression = wire_get_u32(&reader);
    frame->explain_work = wire_get_u32(&reader);
    frame->number = (int32_t)wire_get_u32(&reader);
    frame->assigned_count = wire_get_u32(&reader);
    frame->assigned = wire_get_array(&reader, frame->assigned_count, sizeof *frame->assigned);
    frame->image_path = wire_get_string(&reader);
    if (!wire_reader_done(&reader, "frame begin", status))
        return false;
    if (!frame->width || !frame->height || frame->width > 65536 || frame->height > 65536 ||
        !frame->samples_x || !frame->samples_y || frame->samples_x > 64 || frame->samples_y > 64)
        return status_fail(status, STATUS_INVALID,
                           "damaged frame begin message: size of the picture");
    return true;
}

bool region_grid_check(const struct frame_payload *frame, const struct machine *machine,
                       uint32_t shading_nodes, struct status *status) {
    const uint64_t wide = (uint64_t)frame->width * frame->samples_x,
                   high = (uint64_t)frame->height * frame->samples_y,
                   columns = (wide + (uint64_t)machine->region_width - 1) /
                             (uint64_t)machine->region_width,
                   rows = (high + (uint64_t)machine->region_height - 1) /
                          (uint64_t)machine->region_height;
    bool is_assigned = !frame->assigned_count || frame->assigned_count == columns * rows;
    for (uint32_t k = 0; is_assigned && k < frame->assigned_count; k++)
        is_assigned = frame->assigned[k] < shading_nodes;
    if (!is_assigned)
        return status_fail(status, STATUS_INVALID,
                           "damaged frame begin message: regions and shading nodes");
    if (columns * rows <= REGIONS_MAX)
        return true;
    return status_fail(status, STATUS_LIMIT,
                       "a picture of %u x %u pixels with %u x %u samples each has %llu regions of "
                       "%lld x %lld samples, "
                       "more than %d: take fewer samples, or a machine of larger regions",
                       frame->width, frame->height, frame->samples_x, frame->samples_y,
                       (unsigned long long)(columns * rows), (long long)machine->region_width,
                       (long long)machine->region_height, REGIONS_MAX);
}

struct region_grid region_grid_make(const struct frame_payload *frame,
                                    const struct machine *machine) {
    struct region_grid grid = {
        .samples_wide = frame->width * frame->samples_x,
        .samples_high = frame->height * frame->samples_y,
        .region_width = (uint32_t)machine->region_width,
        .region_height = (uint32_t)machine->region_height,
    };
    grid.columns = (grid.samples_wide + grid.region_width - 1) / grid.region_width;
    grid.rows = (grid.samples_high + grid.region_height - 1) / grid.region_height;
    grid.count = grid.columns * grid.rows;
    return grid;
}

void region_grid_origin(const struct region_grid *grid, uint32_t region, uint32_t *x, uint32_t *y) {
    *x = region % grid->columns * grid->region_width;
    *y = region / grid->columns * grid->region_height;
}

float region_grid_screen_x(const struct region_grid *grid, const struct frame_payload *frame,
                           uint32_t x) {
    const double *w = frame->screen_window;
    return (float)(w[0] + (w[1] - w[0]) * ((x + 0.5) / grid->samples_wide));
}

float region_grid_screen_y(const struct region_grid *grid, const struct frame_payload *frame,
                           uint32_t y) {
    const double *w = frame->screen_window;
    return (float)(w[3] + (w[2] - w[3]) * ((y + 0.5) / grid->samples_high));
}

uint64_t instance_payload_bound_bytes(const struct instance_payload *instance) {
    uint64_t bytes = 64 * ((uint64_t)__builtin_popcount(instance->spaces) + instance->named_count);
    for (uint32_t i = 0; i < instance->bound_count; i++)
        bytes += instance->given[i] ? 4 : 0;
    return bytes + instance->text_bytes + strlen(instance->category);
}

struct message *instance_payload_encode(const struct instance_payload *instance,
                                        enum wire_kind kind, uint32_t frame) {
    struct wire_writer writer = {0};
    wire_put_u32(&writer, instance->id);
    wire_put_u32(&writer, instance->shader);
    wire_put_u32(&writer, instance->bound_count);
    wire_put_u32(&writer, instance->spaces);
    wire_put_u32(&writer, instance->named_count);
    wire_put_u32(&writer, instance->light_count);
    wire_put_u32(&writer, instance->text_bytes);
    wire_put_u32(&writer, (uint32_t)strlen(instance->category) + 1);
    wire_put(&writer, instance->bound, instance->bound_count * sizeof(float));
    wire_put(&writer, instance->matrices,
             (size_t)__builtin_popcount(instance->spaces) * 32 * sizeof(float));
    wire_put(&writer, instance->names, instance->named_count * sizeof(int32_t));
    wire_put(&writer, instance->named_matrices, (size_t)instance->named_count * 32 * sizeof(float));
    wire_put(&writer, instance->lights, instance->light_count * sizeof(uint32_t));
    wire_put(&writer, instance->given, instance->bound_count);
    wire_put(&writer, instance->texts, instance->text_bytes);
    wire_put(&writer, instance->category, strlen(instance->category) + 1);
    return wire_finish(
        &writer, (struct wire_header){.kind = kind,
                                      .frame = frame,
                                      .cause = CAUSE_BOUND_PARAMETERS,
                                      .charged_bytes = {instance_payload_bound_bytes(instance),
                                                        8 + 4 * (uint64_t)instance->light_count}});
}

bool instance_payload_decode(const struct message *message, struct instance_payload *instance,
                             struct status *status) {
    struct wire_reader reader = reader_of(message);
    instance->id = wire_get_u32(&reader);
    instance->shader = wire_get_u32(&reader);
    instance->bound_count = wire_get_u32(&reader);
    instance->spaces = wire_get_u32(&reader);
    instance->named_count = wire_get_u32(&reader);
    instance->light_count = wire_get_u32(&reader);
    instance->text_bytes = wire_get_u32(&reader);
    const uint32_t category_bytes = wire_get_u32(&reader);
    if (instance->spaces >> SHADER_SPACE_COUNT)
        return status_fail(status, STATUS_INVALID, "damaged instance message: coordinate systems");
    instance->bound = wire_get_array(&reader, instance->bound_count, sizeof(float));
    instance->matrices =
        wire_get_array(&reader, (uint64_t)__builtin_popcount(instance->spaces) * 32, sizeof(float));
    instance->names = wire_get_array(&reader, instance->named_count, sizeof(int32_t));
    instance->named_matrices =
        wire_get_array(&reader, (uint64_t)instance->named_count * 32, sizeof(float));
    instance->lights = wire_get_array(&reader, instance->light_count, sizeof(uint32_t));
    instance->given = wire_get(&reader, instance->bound_count);
    instance->texts = wire_get(&reader, instance->text_bytes);
    instance->category = wire_get(&reader, category_bytes);
    if (!wire_reader_done(&reader, "instance", status))
        return false;
    if ((instance->text_bytes && instance->texts[instance->text_bytes - 1]) || !category_bytes ||
        instance->category[category_bytes - 1])
        return status_fail(status, STATUS_INVALID, "damaged instance message: strings do not end");
    return true;
}

struct message *chunk_payload_encode(const struct chunk_payload *chunk, uint32_t frame) {
    struct wire_writer writer = {0};
    const uint64_t v = chunk->vertex_count, t = chunk->triangle_count, m = chunk->material_count;
    wire_put_u32(&writer, chunk->number);
    wire_put_u32(&writer, chunk->first_primitive);
    wire_put_u32(&writer, chunk->shader_id);
    wire_put_u32(&writer, chunk->vertex_count);
    wire_put_u32(&writer, chunk->triangle_count);
    wire_put_u32(&writer, chunk->material_count);
    wire_put_u32(&writer, chunk->map_bytes);
    wire_put(&writer, chunk->formats, m * sizeof *chunk->formats);
    wire_put(&writer, chunk->positions, v * 3 * sizeof(float));
    wire_put(&writer, chunk->material, v * m * sizeof(float));
    wire_put(&writer, chunk->triangles, t * 3 * sizeof(uint16_t));
    return wire_finish(&writer,
                       (struct wire_header){.kind = WIRE_CHUNK,
                                            .frame = frame,
                                            .cause = CAUSE_PRIMITIVES,
                                            .charged_bytes = {v * (12 + 4 * m) + 6 * t, 0}});
}

bool chunk_payload_decode(const struct message *message, struct chunk_payload *chunk,
                          struct status *status) {
    struct wire_reader reader = reader_of(message);
    chunk->number = wire_get_u32(&reader);
    chunk->first_primitive = wire_get_u32(&reader);
    chunk->shader_id = wire_get_u32(&reader);
    chunk->vertex_count = wire_get_u32(&reader);
    chunk->triangle_count = wire_get_u32(&reader);
    chunk->material_count = wire_get_u32(&reader);
    chunk->map_bytes = wire_get_u32(&reader);
    if (chunk->vertex_count > CHUNK_VERTICES_MAX || chunk->triangle_count > CHUNK_TRIANGLES_MAX ||
        chunk->shader_id == 0 || chunk->shader_id > UINT16_MAX ||
        chunk->map_bytes < chunk->material_count)
        return status_fail(status, STATUS_INVALID, "damaged chunk message: impossible counts");
    chunk->formats = wire_get_array(&reader, chunk->material_count, sizeof *chunk->formats);
    chunk->positions = wire_get_array(&reader, chunk->vertex_count, 3 * sizeof(float));
    chunk->material = wire_get_array(&reader, (uint64_t)chunk->vertex_count * chunk->material_count,
                                     sizeof(float));
    chunk->triangles = wire_get_array(&reader, chunk->triangle_count, 3 * sizeof(uint16_t));
    if (!wire_reader_done(&reader, "chunk", status))
        return false;
    for (uint32_t m = 0; m < chunk->material_count; m++)
        if (chunk->formats[m].rounding > SLOT_FIXED || chunk->formats[m].bits > SLOT_BITS_MAX)
            return status_fail(status, STATUS_INVALID, "damaged chunk message: format");
    for (uint32_t i = 0; i < chunk->triangle_count * 3; i++)
        if (chunk->triangles[i] >= chunk->vertex_count)
            return status_fail(status, STATUS_INVALID, "damaged chunk message: vertex index");
    return true;
}

struct message *frame_end_encode(const uint64_t bytes[CAUSE_COUNT], uint32_t frame) {
    struct wire_writer writer = {0};
    for (int cause = 0; cause < CAUSE_COUNT; cause++)
        wire_put_u64(&writer, bytes[cause]);
    return wire_finish(&writer, control_header(WIRE_FRAME_END, frame, 4));
}

bool frame_end_decode(const struct message *message, uint64_t bytes[CAUSE_COUNT],
                      struct status *status) {
    struct wire_reader reader = reader_of(message);
    for (int cause = 0; cause < CAUSE_COUNT; cause++)
        bytes[cause] = wire_get_u64(&reader);
    return wire_reader_done(&reader, "frame end", status);
}

struct message *empty_regions_encode(uint32_t frame, uint32_t first, uint32_t count,
                                     uint32_t sender) {
    struct wire_writer writer = {0};
    wire_put_u32(&writer, count);
    return wire_finish(&writer, (struct wire_header){.kind = WIRE_EMPTY_REGIONS,
                                                     .frame = frame,
                                                     .region = first,
                                                     .sender = sender,
                                                     .cause = CAUSE_CONTROL});
}

bool empty_regions_decode(const struct message *message, uint32_t *count, struct status *status) {
    struct wire_reader reader = reader_of(message);
    *count = wire_get_u32(&reader);
    return wire_reader_done(&reader, "empty regions", status);
}

struct message *text_encode(enum wire_kind kind, const char *text, uint32_t code, uint32_t frame,
                            uint32_t sender) {
    struct wire_writer writer = {0};
    wire_put_string(&writer, text);
    struct wire_header header = control_header(kind, frame, 0);
    header.region = code;
    header.sender = sender;
    return wire_finish(&writer, header);
}

const char *text_decode(const struct message *message, struct status *status) {
    struct wire_reader reader = reader_of(message);
    const char *text = wire_get_string(&reader);
    return wire_reader_done(&reader, "text", status) ? text : NULL;
}

struct message *signal_encode(enum wire_kind kind, uint32_t frame, uint32_t region,
                              uint32_t sender) {
    struct message *message = message_create(WIRE_HEADER_BYTES);
    struct wire_header header = control_header(kind, frame, 0);
    header.region = region;
    header.sender = sender;
    wire_seal(message, header);
    return message;
}
