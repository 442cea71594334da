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

/* What uniform and varying values are computed in and cross this interface as. Nodes take a
 * module's real_bytes to know which; where that is 8, every shader_real they pass is a double.
 * Bound parameters and matrices are floats in either case, as the scene gives them. */
#ifdef SHADER_REFERENCE
typedef double shader_real;
#else
typedef float shader_real;
#endif
typedef float shader_bound;

#define SHADER_MODULE_ABI 8
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
    SHADER_SPACE_DISPLACEMENT, /* "shader" of a displacement or volume shader that goes with a */
    SHADER_SPACE_ATMOSPHERE,   /* surface: where it was said in the scene */
    SHADER_SPACE_SCREEN,       /* these three divide by the distance under a perspective view */
    SHADER_SPACE_NDC,
    SHADER_SPACE_RASTER,
    SHADER_SPACE_COUNT
};
/* What a space that is chosen at run time may be, besides coordinate systems of the scene. */
#define SHADER_SPACES_BY_STRING 0x1f
#define SHADER_STRING_HASHED 0x40000000

/* Row-vector matrices (p' = p M), row-major: camera space to the named one, and back. Identity for
 * current and camera; those that module->spaces does not list are not set. */
struct shader_matrices {
    float from_camera[SHADER_SPACE_COUNT][16];
    float to_camera[SHADER_SPACE_COUNT][16];
    int named_count; /* coordinate systems of the scene, as far as the module may ask for them */
    const struct shader_named_space {
        int32_t name; /* the identity number of a string */
        float from_camera[16], to_camera[16];
    } * named;
};

/* What one light does to one vector of samples. Direction L points from the light to the surface.
 */
struct shader_light_sample {
    shader_real *direction[3]; /* SHADER_WIDTH floats each; untouched by an ambient light */
    shader_real *color[3];     /* Cl */
    int32_t *lit;              /* -1 where the light's cone reaches the sample, else 0 */
    shader_real *exports; /* a vector for each component that the module exports; NULL: unwanted */
};

/* Strings at run time are identity numbers; this is what knows their texts, for shaders that make
 * strings. All three run on the node's processor. */
struct shader_texts {
    int32_t (*join)(struct shader_texts *texts, int32_t a, int32_t b);
    /* a and a number as the conversion (%f, %d ...) with the identity `how` says */
    int32_t (*append_number)(struct shader_texts *texts, int32_t a, float number, int32_t how);
    float (*match)(struct shader_texts *texts, int32_t pattern, int32_t text); /* 1 or 0 */
};

/* What lightsource() asks for, or a light answers: a value of 1 or 3 components. */
struct shader_message {
    const char *name;
    int components;
};

/* A function of the user's object (extern "C") that the module calls: the loader stores its address
 * before anything of the module runs. It takes and gives plain floats. */
struct shader_external {
    const char *name;
    void **address;
};

struct shader_call;

/* One light of the frame as surface shaders meet it. */
struct shader_light {
    const struct shader_module *module;
    const shader_real *uniform; /* filled by module->prepare */
    const struct shader_matrices *matrices;
    struct shader_counters *counters;
    struct shader_texts *texts; /* of the light; NULL unless its module uses texts */
    uint64_t categories;        /* bit i: the light is in module->categories[i] of the surface */
    /* For each of the surface's queries: which vector of the light's results holds its first
     * component, -1 when the light does not know. NULL without queries. */
    const int *query_offsets;
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
    const shader_real *const
        *material;                  /* one plane per component of the transfer map, in its order */
    const shader_real *position[3]; /* P, rebuilt from depth */
    const shader_real
        *incident[3]; /* I: from the eye to P (perspective) or the viewing direction */
    /* For modules that use neighbours: -1 where a lane is a sample, 0 where it repeats another
     * sample of its quad to fill it up. Lanes 4q to 4q + 3 are then the samples of a quad, (0, 0),
     * (1, 0), (0, 1) and (1, 1) from an even column and row of the picture. Others need not set it.
     */
    const int32_t *present;
    const shader_real *uniform; /* filled by module->prepare */
    const struct shader_matrices *matrices;
    uint32_t instance; /* tells instances that use the same lights apart */
    const struct shader_light *lights;
    int light_count;
    int light_vectors;          /* 7 and the most that one of the lights exports */
    shader_real *light_scratch; /* module->light_sets * light_count * light_vectors vectors, for
                             results of lights shared by illuminance loops */
    struct shader_texts *texts; /* NULL unless the module uses texts */
    struct shader_counters *counters;
    shader_real *color[3];   /* Ci out */
    shader_real *opacity[3]; /* Oi out */
    int overrun;             /* set when a loop reached SHADER_LOOP_LIMIT */
};

/* Where a block's operations run, for reports. */
enum shader_stream {
    SHADER_PRE_ILLUM,
    SHADER_ILLUM,
    SHADER_POST_ILLUM,
    SHADER_LIGHT,
    SHADER_SHARED, /* code that all shaders with the flag run together, once (PF section 6.1.5.3) */
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

/* What a module that was compiled for it notes of a variable of the program, and how it rounds the
 * variable, as a fixed-point number would be. Whoever looks clears it. */
struct shader_probe {
    uint64_t count, unusable; /* values that are finite, and others */
    float lowest, highest;    /* of the finite ones */
    float scale;              /* round down to multiples of 1 / scale; 0: leave it as it is */
};

struct shader_module {
    uint32_t abi;
    uint32_t width;      /* SHADER_WIDTH it was compiled for */
    uint32_t real_bytes; /* sizeof(shader_real) in the module: 4, or 8 in the reference */
    const char *name;
    int is_light, is_ambient;
    int material_count; /* components of the transfer map, a float of the planes each */
    int material_bytes; /* of a sample on the composition network, the shader ID aside */
    int bound_count;    /* floats of bound parameters, strings as one identity number each */
    int uniform_count;  /* floats of the uniform block */
    /* Where in the uniform block lie values of bound parameters that are varying: loaded into
     * pixels by shader ID, they may differ between instances that run together. Floats, two for a
     * fixed-point value. */
    int loaded_count;
    const int *loaded;
    uint32_t spaces; /* bit i: needs matrices of enum shader_space i */
    int block_count;
    const struct shader_block *blocks;
    int uses_lights;
    int uses_neighbours; /* samples come in quads */
    int light_sets;      /* places that lights are wanted at: the samples and others */
    int uses_texts;      /* needs shader_texts that know the strings below and the bound ones */
    int text_count;
    const char *const *texts;
    int category_count; /* at most 64 */
    const char *const *categories;
    int query_count, export_count;
    const struct shader_message *queries, *exports;
    int external_count;
    const struct shader_external *externals;
    int probe_count; /* 0 unless compiled with probes; by number of the variable */
    struct shader_probe *probes;
    /* Uniform code, run once per instance and whenever a bound value changes: evaluates defaults of
     * parameters not given, then all that depends on uniform values alone. given[i] tells whether
     * bound[i] is set; bound[i] of a string holds its identity number as int32_t bits. */
    void (*prepare)(const shader_bound *bound, const uint8_t *given,
                    const struct shader_matrices *matrices, struct shader_texts *texts,
                    shader_real *uniform);
    /* A surface: shades call->count samples. NULL for a light. */
    void (*shade)(struct shader_call *call);
    /* A light: lights one vector of samples at `position` (SHADER_WIDTH floats each). NULL for a
     * surface. `key` is the control path it is called on (see report_trips). */
    void (*light)(const struct shader_light *self, const shader_real *const position[3],
                  uint64_t key, struct shader_light_sample *sample, int *overrun);
};

#endif
