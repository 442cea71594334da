/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PROTOCOL_H
#define PROTOCOL_H

#include "base/simd_operations.h"
#include "netsim/machine.h"
#include "netsim/region.h"
#include "netsim/timing.h"
#include "nodes/node.h"
#include "nodes/work_record.h"

#include <stdint.h>

/* The payloads of the cluster's messages (netsim/wire.h lists the kinds): one encoder and one
 * decoder each. Decoders check everything their consumers rely on; pointers in decoded structures
 * point into the message. */

/* CONFIGURATION: what every node must know before the first frame. */
struct configuration {
    uint32_t rendering_nodes, shading_nodes;
    const struct strategy *strategy; /* of composition */
    uint32_t is_recorded;            /* nodes tell the host what each chunk and region cost */
    struct machine machine;
};
struct message *configuration_encode(const struct configuration *configuration);
bool configuration_decode(const struct message *message, struct configuration *configuration,
                          struct status *status);

/* SHADER: number, name and C source of a shader. Charged: name and number, as PixelFlow links
 * shaders before it starts (PF section 4.1). */
struct shader_payload {
    uint32_t number;
    const char *name, *c_source;
};
struct message *shader_payload_encode(const struct shader_payload *shader, uint32_t frame);
bool shader_payload_decode(const struct message *message, struct shader_payload *shader,
                           struct status *status);

/* FRAME_BEGIN: camera and picture of the frame. Charged: the camera, and 2 bytes for each region
 * that is assigned. */
struct frame_payload {
    uint32_t width, height;        /* pixels */
    uint32_t samples_x, samples_y; /* per pixel */
    uint32_t is_perspective;
    uint32_t write_png, compression; /* of the picture file: enum image_compression */
    uint32_t explain_work;           /* keep a work_record */
    double screen_window[4];         /* left, right, bottom, top */
    double near_plane, far_plane;
    int32_t number;          /* as the scene counts (FrameBegin), for people */
    uint32_t assigned_count; /* regions of the frame, or 0: region k goes to shading node k mod s */
    const uint16_t *assigned; /* the shading node of each region */
    const char *image_path;   /* "" when no image is wanted */
};
struct message *frame_payload_encode(const struct frame_payload *frame, uint32_t index);
bool frame_payload_decode(const struct message *message, struct frame_payload *frame,
                          struct status *status);
static inline uint32_t frame_payload_shading_node(const struct frame_payload *frame,
                                                  uint32_t region, uint32_t shading_nodes) {
    return frame->assigned_count ? frame->assigned[region] : region % shading_nodes;
}

/* The grid of regions over the samples of a picture. */
struct region_grid {
    uint32_t samples_wide, samples_high; /* of the whole picture */
    uint32_t region_width, region_height;
    uint32_t columns, rows, count; /* regions */
};
enum { REGIONS_MAX = 1 << 24 };
/* Fails with STATUS_LIMIT when the picture has more than REGIONS_MAX regions, and when regions are
 * assigned that are not there, or to nodes that are not. */
bool region_grid_check(const struct frame_payload *frame, const struct machine *machine,
                       uint32_t shading_nodes, struct status *status);
/* For a frame that was checked. */
struct region_grid region_grid_make(const struct frame_payload *frame,
                                    const struct machine *machine);
/* Sample position of region `k`: column and row of its first sample. */
void region_grid_origin(const struct region_grid *grid, uint32_t region, uint32_t *x, uint32_t *y);
/* Where the centre of sample column x (row y) lies on the screen plane. */
float region_grid_screen_x(const struct region_grid *grid, const struct frame_payload *frame,
                           uint32_t x);
float region_grid_screen_y(const struct region_grid *grid, const struct frame_payload *frame,
                           uint32_t y);

/* INSTANCE and LIGHT: a shader with its bound parameters (PF section 4.3). Charged: bound
 * parameters that were given, the texts of bound strings where the shader makes strings of them,
 * the category of a light, and one matrix for each coordinate system it uses; identity, shader and
 * lights are control. */
struct instance_payload {
    uint32_t id;     /* instances: the shader ID, from 1; lights: index, from 0 */
    uint32_t shader; /* number of its SHADER message */
    uint32_t bound_count;
    const float *bound;
    const uint8_t *given;
    uint32_t spaces; /* bit i: matrices of shader_space i follow, to_camera then from_camera */
    const float *matrices;       /* 32 floats for each set bit, ascending */
    uint32_t named_count;        /* coordinate systems of the scene */
    const int32_t *names;        /* identity numbers of their names */
    const float *named_matrices; /* 32 floats each, likewise */
    uint32_t light_count;
    const uint32_t *lights; /* indices, for instances */
    uint32_t text_bytes;
    const char *texts;    /* bound strings, each ended by a NUL */
    const char *category; /* of a light; "" without */
};
struct message *instance_payload_encode(const struct instance_payload *instance,
                                        enum wire_kind kind, uint32_t frame);
bool instance_payload_decode(const struct message *message, struct instance_payload *instance,
                             struct status *status);
/* What a network is charged for the bound parameters of an instance or light. */
uint64_t instance_payload_bound_bytes(const struct instance_payload *instance);

/* CHUNK: consecutive triangles of one instance, in camera space. Charged: 12 bytes a position, 4 a
 * material float, 6 a triangle; formats go with the shader and are not. */
enum {
    CHUNK_TRIANGLES_DEFAULT = 256,
    CHUNK_TRIANGLES_MAX = 21845, /* vertex numbers have 16 bits */
    CHUNK_VERTICES_MAX = CHUNK_TRIANGLES_MAX * 3
};
enum slot_rounding { SLOT_FLOAT, SLOT_HALF, SLOT_FIXED };
enum { SLOT_BITS_MAX = 16 };
/* How a component of the transfer map is rounded after interpolation (nodes/slot_formats.h). */
struct slot_format {
    uint8_t rounding;    /* enum slot_rounding */
    uint8_t bits;        /* of fixed-point: 8 or 16 */
    uint8_t is_unsigned; /* likewise */
    int8_t exponent;     /* likewise: raw * 2^-exponent */
};
struct chunk_payload {
    uint32_t number;
    uint32_t first_primitive; /* triangles count through the whole frame in scene order */
    uint32_t shader_id;
    uint32_t vertex_count, triangle_count, material_count;
    uint32_t map_bytes; /* of a sample on the composition network, the shader ID aside */
    const struct slot_format *formats; /* material_count */
    const float *positions;            /* vertex_count * 3 */
    const float *material;             /* vertex_count * material_count */
    const uint16_t *triangles;         /* triangle_count * 3 */
};
struct message *chunk_payload_encode(const struct chunk_payload *chunk, uint32_t frame);
bool chunk_payload_decode(const struct message *message, struct chunk_payload *chunk,
                          struct status *status);

/* FRAME_END: all of the frame is sent; what the geometry network was charged, by cause, this
 * message included. */
struct message *frame_end_encode(const uint64_t bytes[CAUSE_COUNT], uint32_t frame);
bool frame_end_decode(const struct message *message, uint64_t bytes[CAUSE_COUNT],
                      struct status *status);

/* EMPTY_REGIONS: `count` regions from header.region on in which no node so far has anything. */
struct message *empty_regions_encode(uint32_t frame, uint32_t first, uint32_t count,
                                     uint32_t sender);
bool empty_regions_decode(const struct message *message, uint32_t *count, struct status *status);

/* COLOUR: a shaded region, with what it cost. Planes are per covered sample in the order of the
 * runs. */
struct shading_work {
    uint32_t instance; /* shader ID, or one of the marks below */
    uint32_t reserved;
    uint64_t operations[SIMD_OPERATION_COUNT]; /* issued on the array for this region */
    uint64_t streams[SHADER_STREAM_COUNT];     /* the same, summed by stream */
};
enum { SHADING_WORK_SHARED = 0x10000 }; /* position reconstruction; plus 1 + l for light l */
/* What a region of these entries takes on the machine's array; TICKS_MAX past 63 bits. */
ticks shading_work_price(const struct machine *machine, const struct shading_work *work,
                         uint32_t count);
/* Sums over the samples of a region, as composed and as they came to the shading node: more of them
 * where parts overlap that are composed only there. */
struct region_sums {
    uint64_t map_bytes; /* of the samples' own maps, shader IDs aside */
    uint64_t arrived_samples, arrived_map_bytes;
};
struct colour_view {
    struct region_head head; /* of the composed region: slots is 0, longest_map as composed */
    uint32_t shading_work_count;
    struct region_sums sums;
    const struct region_work *work;
    const struct shading_work *shading_work;
    const struct region_run *runs;
    const float *depth;
    const float *color[3];
    const uint16_t *shader;
};
struct colour_draft {
    struct message *message;
    struct shading_work *work; /* zeroed, for the caller to fill */
    float *color[3];
};
struct colour_draft colour_draft_create(const struct region_view *region,
                                        const struct region_sums *sums, uint32_t work_count);
struct message *colour_seal(struct colour_draft *draft, uint32_t frame, uint32_t region,
                            uint32_t sender);
bool colour_open(const struct message *message, uint32_t region_samples, uint32_t rendering_nodes,
                 struct colour_view *view, struct status *status);

/* FRAME_DONE: what the framebuffer node found out about a frame. */
struct frame_record {
    uint32_t frame; /* index from 0 */
    int number;     /* as the scene counts (FrameBegin); known to the host, not sent */
    uint32_t streams_generated, streams_reused; /* instruction streams, likewise */
    uint32_t regions, regions_covered;
    uint64_t samples_covered, samples_total;
    int64_t start_ps, end_ps, time_ps;
    ticks start, end, time;
    uint64_t tick_rate;
    enum timing_resource bound_by;
    struct {
        uint64_t depth, shader_id, parameters, padding, total; /* bytes into shading nodes */
        uint64_t sent; /* bytes, by all rendering nodes to each other and to shading nodes */
        int64_t busy_ps;
    } composition;
    struct {
        uint64_t bytes[CAUSE_COUNT];
        uint64_t total;
        int64_t busy_ps;
    } geometry;
    struct {
        uint64_t bytes; /* of colours */
        int64_t busy_ps;
    } framebuffer;
    uint64_t nan_depths, nan_colours;
    uint32_t rendering_nodes, shading_nodes;
    int64_t *raster_busy_ps, *shading_busy_ps; /* owned; one a node */
    char image_path[4096];                     /* "" when none */
    struct work_record work;
};
struct message *frame_record_encode(const struct frame_record *record, uint32_t sender);
bool frame_record_decode(const struct message *message, struct frame_record *record,
                         struct status *status);
void frame_record_finish(struct frame_record *record);

/* CHUNK_WORK and REGION_COSTS, when the run is recorded: what a frame cost by chunk of primitives
 * and region, from each rendering node, and by region and shader, from the framebuffer node. */
struct chunk_work {
    uint32_t chunk, region;
    uint32_t triangles; /* whose screen rectangle touches the region */
    uint32_t covers;    /* 1: some triangle of the chunk covers a sample of it */
};
struct message *chunk_work_encode(const struct chunk_work *work, size_t count, uint32_t frame,
                                  uint32_t sender);
bool chunk_work_decode(const struct message *message, const struct chunk_work **work, size_t *count,
                       struct status *status);

struct region_costs {
    uint32_t region, samples; /* covered */
    uint64_t map_bytes;       /* bytes, sum over the samples of their own maps */
    const struct shading_work *work;
    uint32_t work_count, reserved;
};
/* `regions` in ascending order; each is followed by its work, which decoded ones point to. */
struct message *region_costs_encode(const struct region_costs *regions, size_t count,
                                    uint32_t frame, uint32_t sender);
/* The array is the caller's. */
bool region_costs_decode(const struct message *message, struct region_costs **regions,
                         size_t *count, struct status *status);

/* HELLO (endpoint to reach the node's composition input, "" in process) and the text messages
 * WARNING and FAILURE (code in header.region). */
struct message *text_encode(enum wire_kind kind, const char *text, uint32_t code, uint32_t frame,
                            uint32_t sender);
const char *text_decode(const struct message *message,
                        struct status *status); /* NULL when damaged */
/* PROGRESS, QUIT, READY: header only. */
struct message *signal_encode(enum wire_kind kind, uint32_t frame, uint32_t region,
                              uint32_t sender);

#endif
