/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_COMPILE_H
#define SHADER_COMPILE_H

#include "base/arena.h"
#include "base/status.h"
#include "shaders/compiler/fixed_format.h"
#include "shaders/compiler/shader_calls.h"
#include "shaders/compiler/shader_memory.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The shading language compiler: RSL source in, C source and all that the rest of the cluster needs
 * to know about the shader out. Pure: no files, no processes. */

enum { SHADER_ID_BYTES = 2 }; /* of the shader ID, which every transfer map begins with */

enum shader_type {
    SHADER_FLOAT,
    SHADER_COLOR,
    SHADER_POINT,
    SHADER_VECTOR,
    SHADER_NORMAL,
    SHADER_STRING,
    SHADER_MATRIX,
    SHADER_FIXED = 32 /* with a format of its own */
};
/* How an array of three with a transformation attribute comes into camera space. */
enum shader_transform {
    SHADER_TRANSFORM_NONE,
    SHADER_TRANSFORM_POINT,
    SHADER_TRANSFORM_VECTOR,
    SHADER_TRANSFORM_NORMAL,
    SHADER_TRANSFORM_TEXTURE
};
/* In the order of the words of the language. */
enum shader_kind {
    SHADER_KIND_SURFACE,
    SHADER_KIND_LIGHT,
    SHADER_KIND_DISPLACEMENT,
    SHADER_KIND_VOLUME,
    SHADER_KIND_IMAGER,
    SHADER_KIND_COUNT
};
const char *shader_kind_name(enum shader_kind kind);

/* Floats of one value of a type; a string counts as one (its identity number). */
int shader_type_components(enum shader_type type);
const char *shader_type_name(enum shader_type type);

/* A parameter of the shader, or a predefined variable it reads (N, s, Cs ...). */
struct shader_parameter {
    const char *name;
    enum shader_type type;
    int array_length;           /* 0: not an array */
    struct fixed_format format; /* of fixed-point */
    enum shader_transform transform;
    int components; /* floats in all: fixed-point values come and are interpolated as floats */
    int bytes;      /* of pixel memory, and in the transfer map */
    enum shader_kind shader; /* whose parameter it is */
    bool is_output;
    bool is_global;  /* a predefined variable, or an option of the scene: "Format ()" */
    bool is_varying; /* declared varying, promoted by shader_compile_options.material, or a varying
                        global */
    bool is_uniform_declared; /* says `uniform` in so many words: cannot become material */
    bool is_live;             /* can reach the result */
    bool is_material; /* in the transfer map: live, varying and per sample in this variant */
    int map_offset;   /* first component among those of the transfer map, -1 when not in it */
    int map_byte; /* first byte in the transfer map, the shader ID included, -1 when not in it */
    int bound_offset; /* first float among the bound values, -1 when material or dead */
    int line, column;
};

/* How material parameters travel on the composition network, the most accurate first.
 * X(NAME, name in options, bits of a component, bits of one of a normal or colour) */
#define PARAMETER_PRECISIONS(X)                                                                    \
    X(FLOAT, "float", 32, 32)                                                                      \
    X(HALF, "half", 16, 16)                                                                        \
    X(FIXED, "fixed", 16, 16)                                                                      \
    X(BYTE, "byte", 16, 8)
enum parameter_precision {
#define PARAMETER_PRECISION_ENUM(name, text, bits, small_bits) PARAMETERS_##name,
    PARAMETER_PRECISIONS(PARAMETER_PRECISION_ENUM)
#undef PARAMETER_PRECISION_ENUM
};

struct shader_companion {
    const char *file, *text;
    size_t length;
    struct shader_fast_calls fast_calls; /* in its source */
};

/* What was seen of a variable while probes looked (shader_module.h), and what it is to become. */
struct shader_fixing {
    bool is_seen;          /* it had a finite value */
    float lowest, highest; /* the extremes of these */
    int size;              /* bits, at most 32, as a fixed-point number; 0: it stays a float */
};

/* A scalar variable of the program. Probes and fixings go by their numbers, which follow from the
 * source and all options but those two. */
struct shader_variable {
    const char *name;           /* in the source, "" when it is written where it is used */
    int line;                   /* of the original, that assigns to it */
    bool can_be_fixed;          /* a varying float */
    bool is_noise;              /* the result of noise, which fixed-point has in 16 bits */
    struct fixed_format format; /* that it got, or would have with size 0 */
};

struct shader_compile_options {
    /* Shaders that run on the same samples before and after a surface shader, compiled with it into
     * one: P, N and all other predefined variables go from one to the next. NULL: none. */
    const struct shader_companion *displacement, *atmosphere;
    /* Parameters that come with the primitives in this variant of the shader, by name; everything
     * else is bound to the instance. Cs and Os are named here when they vary; N, Ng, s, t, u, v,
     * dPdu, dPdv are always material; P, I, E are rebuilt from depth and never are. */
    const char *const *material;
    int material_count;
    /* For lights: parameters that surface shaders ask for (shader_program.queries). */
    const char *const *exports;
    int export_count;
    bool
        fast_math; /* the visually accurate functions of the paper, section 6.1.4, for every call */
    struct shader_fast_calls
        fast_calls;           /* ... for these calls; one that is not there is an error */
    int pixel_memory_bytes;   /* of the machine; 0: 256 */
    uint32_t passes_left_out; /* bit i: shader_pass_name(i) does not run, if it is optional */
    const char *dump;         /* the name of a pass whose IR is wanted in shader_program.dump */
    bool allows_external;     /* extern "C" functions: the user said so */
    enum parameter_precision parameters; /* of material parameters, on the composition network */
    bool has_probes;    /* the module notes extremes of its variables, and can round them */
    bool writes_source; /* shader_program.source and .variables are wanted */
    const struct shader_fixing *fixings; /* by number of the variable, for the source */
    int fixing_count;                    /* variables beyond stay floats */
    bool reference_math; /* C that computes in double precision (shaders/simd/vector_double.h) */
    /* The text of a file named by #include, or NULL when there is none; a name in an included file
     * is first asked for next to that file. The bytes stay the callee's and must not change until
     * the compilation ends. NULL: #include is an error. */
    const char *(*read_include)(void *context, const char *name, size_t *length);
    void *read_include_context;
};

/* What one line of the source makes the array do each time a block runs. Uniform code is free and
 * not listed. */
struct shader_line_cost {
    int line, block;
    int stream, operation; /* enum shader_stream, enum simd_operation */
    uint32_t count;
    int call_site; /* number of it when it is a function with a fast version, else -1 */
};

struct shader_program {
    struct arena arena; /* owns everything below */
    enum shader_kind kind;
    const char *name;
    bool is_ambient; /* a light without illuminate or solar */
    struct shader_parameter *parameters;
    int parameter_count;
    int material_count; /* components per sample in the transfer map besides the shader ID */
    int material_bytes; /* their size on the composition network */
    int bound_count;
    uint32_t spaces;           /* bit per enum shader_space whose matrices it needs */
    const char **named_spaces; /* coordinate systems of the scene that it names */
    int named_space_count;
    bool uses_any_space;  /* may ask for any of them */
    bool uses_texts;      /* needs the texts of bound strings, not only their identity numbers */
    const char **queries; /* names that it asks lights for */
    int query_count;
    const char *category; /* of a light: the default of its parameter __category, "" without */
    const char *c_source;
    size_t c_length;
    struct shader_memory memory;
    const struct shader_line_cost *line_costs;
    int line_cost_count;
    const struct shader_call_site *call_sites; /* by shader and place */
    int call_site_count;
    const char *dump; /* of the pass that options name; NULL when none */
    /* The shader in the language again, functions inlined and vectors taken apart, its variables as
     * the fixings want them; computes the same when all are floats. NULL unless asked for. */
    const char *source;
    const struct shader_variable *variables; /* likewise */
    int variable_count;
    /* warnings, each "file:line:column: warning: ..." with the source line and a caret */
    const char **warnings;
    int warning_count;
};

/* Compiles one shader from the `length` bytes at `text`; `file` is its name in messages. On success
 * *program is the caller's to destroy. On failure status->message holds up to eight errors, each
 * "FILE:LINE:COLUMN: error: TEXT", the source line and a caret. Any bytes are accepted as input;
 * work and memory are bounded (256 MiB, nesting 200, 1 MiB of source). */
bool shader_compile(const char *file, const char *text, size_t length,
                    const struct shader_compile_options *options, struct shader_program **program,
                    struct status *status);
void shader_program_destroy(struct shader_program *program);

/* The i-th pass of the compiler, NULL after the last; what it does, and whether it may be left out.
 */
const char *shader_pass_name(int i, const char **what, bool *is_optional);

/* The identity number of a string at run time (shader_module.h). */
int32_t shader_string_identity(const char *text);

#endif
