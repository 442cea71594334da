/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a message: first as they are, then as the payload of each kind of message under a
 * good header, so that the decoders themselves are reached. Nothing may crash, and what a decoder
 * accepts must be safe to use. */
#include "nodes/protocol.h"
#include "nodes/slot_formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { REGION_SAMPLES = 8192 };

static volatile uint64_t sink;

static void touch(const void *bytes, size_t length) {
    const uint8_t *at = bytes;
    for (size_t i = 0; i < length; i++)
        sink += at[i];
}

static void use_region(const struct message *message) {
    struct region_view view;
    if (!region_open(message->bytes, message->length, REGION_SAMPLES, &view, NULL))
        return;
    touch(view.slots, (size_t)view.head.slots * view.head.sample_count * sizeof(float));
    struct message *both = region_compose(&view, &view, 0, 0, 0);
    struct region_view composed;
    if (!region_open(both->bytes, both->length, REGION_SAMPLES, &composed, NULL) ||
        composed.head.sample_count != view.head.sample_count)
        abort(); /* a region composed with itself covers the same samples */
    message_release(both);
    struct message *same = message_create_with_room(message->length, message->length);
    memcpy(same->bytes, message->bytes, message->length);
    if (!region_open(same->bytes, same->length, REGION_SAMPLES, &composed, NULL) ||
        !region_compose_in_place(same, &composed, &view, 0, 0, 0) ||
        !region_open(same->bytes, same->length, REGION_SAMPLES, &composed, NULL) ||
        composed.head.sample_count != view.head.sample_count)
        abort(); /* there is room, and nobody else holds it */
    message_release(same);
}

static void use_colour(const struct message *message) {
    struct colour_view view;
    if (!colour_open(message, REGION_SAMPLES, 16, &view, NULL))
        return;
    touch(view.shading_work, view.shading_work_count * sizeof *view.shading_work);
    for (int c = 0; c < 3; c++)
        touch(view.color[c], view.head.sample_count * sizeof(float));
}

static void use_instance(const struct message *message) {
    struct instance_payload payload;
    if (!instance_payload_decode(message, &payload, NULL))
        return;
    touch(payload.bound, payload.bound_count * sizeof(float));
    touch(payload.lights, payload.light_count * sizeof(uint32_t));
    sink += instance_payload_bound_bytes(&payload);
}

static void use_frame(const struct frame_payload *frame) {
    const struct machine machine = {.region_width = 128, .region_height = 64};
    enum { SHADING_NODES = 3 };
    sink += strlen(frame->image_path);
    if (!region_grid_check(frame, &machine, SHADING_NODES, NULL))
        return;
    for (uint32_t k = 0; k < frame->assigned_count; k++)
        if (frame_payload_shading_node(frame, k, SHADING_NODES) >= SHADING_NODES)
            abort(); /* whoever indexes nodes by it relies on that */
}

static void use(enum wire_kind kind, const struct message *message) {
    struct configuration configuration;
    struct shader_payload shader;
    struct frame_payload frame;
    struct chunk_payload chunk;
    struct frame_record record;
    uint64_t bytes[CAUSE_COUNT];
    uint32_t count;
    const struct chunk_work *work;
    struct region_costs *costs;
    size_t work_count;
    const char *text;
    switch (kind) {
    case WIRE_CONFIGURATION:
        configuration_decode(message, &configuration, NULL);
        break;
    case WIRE_SHADER:
        if (shader_payload_decode(message, &shader, NULL))
            sink += strlen(shader.c_source) + strlen(shader.name);
        break;
    case WIRE_FRAME_BEGIN:
        if (frame_payload_decode(message, &frame, NULL))
            use_frame(&frame);
        break;
    case WIRE_INSTANCE:
    case WIRE_LIGHT:
        use_instance(message);
        break;
    case WIRE_CHUNK:
        if (!chunk_payload_decode(message, &chunk, NULL))
            break;
        for (uint32_t i = 0; i < chunk.material_count; i++) {
            float value = 1e9f;
            slot_format_round(chunk.formats[i], &value, 1);
            if (chunk.formats[i].rounding == SLOT_FIXED && value != value)
                abort();
        }
        if (chunk.triangle_count)
            touch(chunk.positions + 3 * (size_t)chunk.triangles[0], 3 * sizeof(float));
        break;
    case WIRE_FRAME_END:
        frame_end_decode(message, bytes, NULL);
        break;
    case WIRE_REGION:
        use_region(message);
        break;
    case WIRE_EMPTY_REGIONS:
        empty_regions_decode(message, &count, NULL);
        break;
    case WIRE_COLOUR:
        use_colour(message);
        break;
    case WIRE_FRAME_DONE:
        if (frame_record_decode(message, &record, NULL))
            frame_record_finish(&record);
        break;
    case WIRE_CHUNK_WORK:
        if (chunk_work_decode(message, &work, &work_count, NULL))
            touch(work, work_count * sizeof *work);
        break;
    case WIRE_REGION_COSTS:
        if (!region_costs_decode(message, &costs, &work_count, NULL))
            break;
        for (size_t i = 0; i < work_count; i++)
            touch(costs[i].work, costs[i].work_count * sizeof *costs[i].work);
        free(costs);
        break;
    default:
        text = text_decode(message, NULL);
        sink += text ? strlen(text) : 0;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct wire_header header;
    struct message *message = message_create(size);
    if (size)
        memcpy(message->bytes, data, size);
    if (wire_open(message->bytes, message->length, &header, NULL))
        use(header.kind, message);
    message_release(message);
    if (!size)
        return 0;
    header = (struct wire_header){.kind = (enum wire_kind)(data[0] % WIRE_KIND_COUNT)};
    message = message_create(WIRE_HEADER_BYTES + size - 1);
    memcpy(message->bytes + WIRE_HEADER_BYTES, data + 1, size - 1);
    wire_seal(message, header);
    use(header.kind, message);
    message_release(message);
    return 0;
}

#ifdef FUZZ_WITH_MAIN
int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        FILE *file = fopen(argv[i], "rb");
        if (!file) {
            fprintf(stderr, "cannot open %s\n", argv[i]);
            return 1;
        }
        uint8_t *bytes = malloc(1 << 20);
        const size_t length = fread(bytes, 1, 1 << 20, file);
        fclose(file);
        LLVMFuzzerTestOneInput(bytes, length);
        free(bytes);
    }
    printf("%d files replayed\n", argc - 1);
    return argc > 1 ? 0 : 1;
}
#endif
