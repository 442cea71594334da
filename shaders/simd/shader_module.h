/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_MODULE_H
#define SHADER_MODULE_H

/* What a compiled shader looks like to the node that runs it. Generated C includes this file, and
 * so do the nodes; SHADER_MODULE_ABI changes whenever anything here does.
 *
 * Samples are processed in vectors of SHADER_WIDTH lanes. Lanes see each other at most within a
 * quad of four, so results do not depend on the width (contract C1). All points, vectors and
 * normals are in camera space
 * ("current"). */

#include <stddef.h>
#include <stdint.h>

#define SHADER_MODULE_ABI 3
#define SHADER_MODULE_SYMBOL "sortlast_shader_module"

/* A varying loop that runs longer than this at any sample stops there; the call's overrun flag is
 * set and the node warns, naming shader and region. */
#define SHADER_LOOP_LIMIT 1048576

/* Coordinate systems a shader may name, and the identity numbers that strings with these values
 * have at run time; any other string has SHADER_STRING_HASHED set. */
enum shader_space {
    SHADER_SPACE_CURRENT, /* = camera */
    SHADER_SPACE_CAMERA,
    SHADER_SPACE_SHADER,
    SHADER_SPACE_OBJECT,
    SHADER_SPACE_WORLD,
    SHADER_SPACE_COUNT
};
#define SHADER_STRING_HASHED 0x40000000

/* Row-vector matrices (p' = p M), row-major: camera space to the named one, and back. Identity for
 * current and camera; those that module->spaces does not list are not set. */
struct shader_matrices {
    float from_camera[SHADER_SPACE_COUNT][16];
    float to_camera[SHADER_SPACE_COUNT][16];
};

/* What one light does to one vector of samples. Direction L points from the light to the surface.
 */
struct shader_light_sample {
    float *direction[3]; /* SHADER_WIDTH floats each; untouched by an ambient light */
    float *color[3];     /* Cl */
    int32_t *lit;        /* -1 where the light's cone reaches the sample, else 0 */
};

struct shader_call;

/* One light of the frame as surface shaders meet it. */
struct shader_light {
    const struct shader_module *module;
    const float *uniform; /* filled by module->prepare */
    const struct shader_matrices *matrices;
    struct shader_counters *counters;
};

/* Dynamic execution counts of one shader over one region, as the SIMD array would issue them: a
 * block is issued once however many samples are enabled. See `blocks` below. */
struct shader_counters {
    uint64_t *block_executions; /* module->block_count entries */
    /* Reports that a loop or uniform branch `block`, entered in the control path `key`, ran its
     * body `trips` times for the vector at hand. The array runs it as often as the neediest vector:
     * the receiver keeps the maximum per (block, key) and the sum of these maxima in
     * block_executions[block]. */
    void (*report_trips)(struct shader_counters *counters, uint32_t block, uint64_t key,
                         uint64_t trips);
};

/* One batch of samples of one shader instance. Planes hold ceil(count / width) * width floats, the
 * lanes past `count` repeat a valid sample. All planes are 64-byte aligned. */
struct shader_call {
    size_t count;
    const float *const *material; /* one plane per component of the transfer map, in its order */
    const float *position[3];     /* P, rebuilt from depth */
    const float *incident[3];     /* I: from the eye to P (perspective) or the viewing direction */
    /* For modules that use neighbours: -1 where a lane is a sample, 0 where it repeats another
     * sample of its quad to fill it up. Lanes 4q to 4q + 3 are then the samples of a quad, (0, 0),
     * (1, 0), (0, 1) and (1, 1) from an even column and row of the picture. Others need not set it.
     */
    const int32_t *present;
    const float *uniform; /* filled by module->prepare */
    const struct shader_matrices *matrices;
    const struct shader_light *lights;
    int light_count;
    float *light_scratch; /* light_count * 7 vectors, for results of lights shared by all
                             illuminance loops */
    struct shader_counters *counters;
    float *color[3];   /* Ci out */
    float *opacity[3]; /* Oi out */
    int overrun;       /* set when a loop reached SHADER_LOOP_LIMIT */
};

/* Where a block's operations run, for reports. */
enum shader_stream {
    SHADER_PRE_ILLUM,
    SHADER_ILLUM,
    SHADER_POST_ILLUM,
    SHADER_LIGHT,
    SHADER_STREAM_COUNT
};

/* A stretch of SIMD instructions that is issued as a whole. Block 0 is the top level (executed once
 * per region); the others are bodies of loops and branches of uniform ifs. Both sides of a varying
 * if belong to the block around it: the array issues both. */
struct shader_block {
    int parent; /* -1 for block 0 */
    /* operations per execution, by stream and simd_operation (base/simd_operations.h) */
    uint32_t operations[SHADER_STREAM_COUNT][64];
};

struct shader_module {
    uint32_t abi;
    uint32_t width; /* SHADER_WIDTH it was compiled for */
    const char *name;
    int is_light, is_ambient;
    int material_count; /* components of the transfer map, a float of the planes each */
    int material_bytes; /* of a sample on the composition network, the shader ID aside */
    int bound_count;    /* floats of bound parameters, strings as one identity number each */
    int uniform_count;  /* floats of the uniform block */
    uint32_t spaces;    /* bit i: needs matrices of enum shader_space i */
    int block_count;
    const struct shader_block *blocks;
    int uses_lights;
    int uses_neighbours; /* samples come in quads */
    /* Uniform code, run once per instance and whenever a bound value changes: evaluates defaults of
     * parameters not given, then all that depends on uniform values alone. given[i] tells whether
     * bound[i] is set; bound[i] of a string holds its identity number as int32_t bits. */
    void (*prepare)(const float *bound, const uint8_t *given,
                    const struct shader_matrices *matrices, float *uniform);
    /* A surface: shades call->count samples. NULL for a light. */
    void (*shade)(struct shader_call *call);
    /* A light: lights one vector of samples at `position` (SHADER_WIDTH floats each). NULL for a
     * surface. `key` is the control path it is called on (see report_trips). */
    void (*light)(const struct shader_light *self, const float *const position[3], uint64_t key,
                  struct shader_light_sample *sample, int *overrun);
};

#endif
