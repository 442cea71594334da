/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RECORD_H
#define RECORD_H

#include "netsim/machine.h"
#include "netsim/wire.h"

#include <stddef.h>

/* The record of a run: what its frames cost, by chunk of primitives and region and by shader and
 * region, whatever the numbers of nodes were. From it the timing model computes what any cluster
 * would have needed (what_if.h), to the tick what a live run says. */

/* How a parameter comes to the samples. */
enum record_use {
    RECORD_MATERIAL, /* with each: in the transfer map */
    RECORD_BOUND,    /* bound to the instance, but could be material */
    RECORD_UNIFORM,  /* declared uniform: always bound */
    RECORD_USE_COUNT
};

struct record_parameter {
    char *name;
    uint32_t floats; /* of a vertex, or of the instance */
    uint32_t bytes;  /* of a sample on the composition network: less for fixed-point */
    enum record_use use;
    bool is_geometric; /* a predefined variable of the surface, like N or s: cannot be bound */
};

struct record_instance {
    char *name, *shader;                 /* as reports call the instance; its shader */
    struct record_parameter *parameters; /* those that can reach the result */
    uint32_t parameter_count;
    uint64_t bound_bytes; /* on the geometry network */
};
/* Floats of its parameters of one use. */
uint32_t record_instance_floats(const struct record_instance *instance, enum record_use use);

/* A chunk of consecutive triangles of one mesh. Those of a run follow one another without a gap:
 * cut longer, they would be one chunk. */
struct record_chunk {
    uint32_t instance; /* shader ID, from 1 */
    uint32_t vertices, triangles;
    bool begins_run;
    uint32_t first_sharing, sharing_count; /* vertices it has in common with chunks of its run */
};

/* So many vertices of a chunk were last in the chunk `distance` before it. */
struct record_sharing {
    uint32_t distance, vertices;
};

/* What one chunk means for one region. */
struct record_entry {
    uint32_t chunk;
    uint32_t triangles; /* whose screen rectangle touches the region */
    bool covers;        /* some triangle covers a sample of the region */
};

struct record_operation {
    uint32_t operation; /* enum simd_operation */
    uint64_t count;     /* issued on the array */
};

/* What a shader issued in one region. */
struct record_work {
    uint32_t shader; /* ID of the instance; RECORD_SHARED: position reconstruction; past it light
                        shader - RECORD_SHARED - 1 */
    uint32_t first_operation, operation_count;
};
enum { RECORD_SHARED = 0x10000 };

struct record_region {
    uint32_t samples;                  /* covered; 0: a token */
    uint64_t map_bytes;                /* sum over the samples of their own maps */
    uint32_t first_entry, entry_count; /* by ascending chunk */
    uint32_t first_work, work_count;
};

struct record_frame {
    int32_t number;                /* as the scene counts */
    uint32_t width, height;        /* pixels */
    uint32_t samples_x, samples_y; /* per pixel */
    uint64_t geometry_bytes[CAUSE_COUNT];
    struct record_instance *instances;
    uint32_t instance_count;
    char **lights;
    uint32_t light_count;
    struct record_chunk *chunks;
    uint32_t chunk_count;
    struct record_sharing *sharing;
    uint32_t sharing_count;
    size_t chunk_capacity, sharing_capacity;
    struct record_region *regions; /* in order of transfer */
    uint32_t region_count;
    struct record_entry *entries;
    struct record_work *works;
    struct record_operation *operations;
    uint32_t entry_count, work_count, operation_count;
    size_t entry_capacity, work_capacity, operation_capacity;
};

struct run_record {
    char *scene;
    struct machine machine;
    uint64_t seed;            /* of the distribution of chunks */
    uint32_t chunk_triangles; /* at most, of a chunk */
    bool fast_math;
    struct record_frame *frames;
    uint32_t frame_count;
    size_t frame_capacity;
};

void record_destroy(struct run_record *record);
void record_frame_finish(struct record_frame *frame);
/* Appends an empty frame; it belongs to the record. */
struct record_frame *record_add_frame(struct run_record *record);
/* Fill a part of an empty frame from another. */
void record_copy_shaders(struct record_frame *frame, const struct record_frame *from);
void record_copy_chunks(struct record_frame *frame, const struct record_frame *from);
void record_copy_regions(struct record_frame *frame, const struct record_frame *from);
/* Appends a chunk with its sharing (of which its own counts are filled in). */
void record_add_chunk(struct record_frame *frame, struct record_chunk chunk,
                      const struct record_sharing *sharing, uint32_t sharing_count);
/* Append to the region at hand, the last with entries or works; regions are filled in order. */
void record_add_entry(struct record_frame *frame, struct record_region *region,
                      struct record_entry entry);
void record_add_work(struct record_frame *frame, struct record_region *region, uint32_t shader,
                     const uint64_t operations[SIMD_OPERATION_COUNT]);

/* Bytes of the primitives over the geometry network when instance i (from 0) has map_floats[i]
 * floats a vertex: 12 bytes a position, 4 a float, 6 a triangle (docs/timing.md). `vertices` of
 * each chunk; NULL: as recorded. */
uint64_t record_primitive_bytes(const struct record_frame *frame, const uint32_t *map_floats,
                                const uint32_t *vertices);

/* A file: magic, version, length, checksum, and the compressed payload. The same run gives the same
 * bytes for all node counts, drivers and transports. The buffer is the caller's. */
bool record_encode(const struct run_record *record, uint8_t **bytes, size_t *length,
                   struct status *status);
/* Any bytes are accepted as input; `file` is their name in messages. The record is the caller's. */
bool record_decode(const char *file, const uint8_t *bytes, size_t length,
                   struct run_record **record, struct status *status);
bool record_read_file(const char *path, struct run_record **record, struct status *status);
/* Does the file begin as a record does? */
bool record_is_file(const char *path);

#endif
