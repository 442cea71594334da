/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_LIBRARY_H
#define SHADER_LIBRARY_H

#include "base/status.h"
#include "nodes/fast_calls.h"
#include "scenes/scene.h"
#include "shaders/compiler/shader_compile.h"

/* Shader sources found by name and compiled to C once per variant. A variant is a shader with a
 * choice of which parameters come with the primitives: "a parameter may be bound in one instance
 * and material in another" (PF section 6.2.2). */
struct shader_library;

struct shader_variant {
    uint32_t number;     /* counts variants from 0 */
    const char *name;    /* of its main shader, as the scene has it */
    bool has_companions; /* displacement or volume shaders run with it */
    const struct shader_program *program;
};

/* The name, as the scene has it, of the shader that a call site of the variant is in: of the
 * surface, or of the displacement or volume shader that goes with it. */
const char *shader_variant_site_shader(const struct shader_variant *variant,
                                       const struct shader_call_site *site);

/* How accurately shaders compute, and how their parameters travel. */
struct shader_precision {
    bool fast_math, reference_math;
    const char *fast_shaders;     /* names with commas: these use fast functions; NULL: none */
    struct fast_calls fast_calls; /* ... and these calls; stays the caller's */
    enum parameter_precision parameters;
    /* "NAME=FILE.sl": where to find a shader, whatever the folders have; stay the caller's */
    const char *const *files;
    int file_count;
    const char *probed_shader; /* its module notes and rounds its variables; NULL: none */
};

/* `folders`: where NAME.sl is looked for, in order; copied. */
struct shader_library *shader_library_create(const char *const *folders, int folder_count,
                                             const struct shader_precision *precision);
/* What all compilations from now on share besides: memory of a pixel, passes left out, dump,
 * whether functions from outside are allowed. The rest of `base` is not looked at. */
void shader_library_set_base(struct shader_library *library,
                             const struct shader_compile_options *base);
void shader_library_destroy(struct shader_library *library);

/* A shader, with the displacement and volume shaders that go with a surface (NULL: none).
 * `material` lists names of primitive variables, of a light what surfaces ask it for; unknown ones
 * do not matter. */
struct shader_wanted {
    const char *name, *displacement, *atmosphere;
    enum shader_kind kind;
    const char *const *material;
    int material_count;
};

/* Finds or compiles. Errors name the place in the scene that asked, or the shader's own line. */
bool shader_library_variant(struct shader_library *library, const struct shader_wanted *wanted,
                            const struct scene_location *asked_at,
                            const struct shader_variant **variant, struct status *status);
/* Compiles a shader once more, with what `extra` says of probes, source and fixings; the program is
 * the caller's and no variant. */
bool shader_library_compile(struct shader_library *library, const struct shader_wanted *wanted,
                            const struct shader_compile_options *extra,
                            struct shader_program **program, struct status *status);
/* Whether a shader of this name was compiled, as a companion of another too. */
bool shader_library_has(const struct shader_library *library, const char *name);
uint32_t shader_library_count(const struct shader_library *library);
const struct shader_variant *shader_library_at(const struct shader_library *library,
                                               uint32_t number);
/* Warnings of compilations since the last call; NULL when there is none left. */
const char *shader_library_warning(struct shader_library *library);

#endif
