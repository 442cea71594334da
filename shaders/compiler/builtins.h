/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BUILTINS_H
#define BUILTINS_H

#include "shaders/compiler/ast.h"

/* The functions that lowering knows by itself; the rest of the standard ones are RSL in prelude.c.
 *
 * X(ID, name, overloads). An overload is RESULT:ARGUMENTS, with f float, c color, m matrix, p
 * point, v vector, n normal, s string, b boolean, x fixed-point, 0 nothing, t any triple, `.` any
 * value; & before an argument that is written to; * after one that may repeat. The first overload
 * that fits best is taken. */
#define BUILTINS(X)                                                                                \
    X(RADIANS, "radians", "f:f")                                                                   \
    X(DEGREES, "degrees", "f:f")                                                                   \
    X(SIN, "sin", "f:f")                                                                           \
    X(COS, "cos", "f:f")                                                                           \
    X(TAN, "tan", "f:f")                                                                           \
    X(ASIN, "asin", "f:f")                                                                         \
    X(ACOS, "acos", "f:f")                                                                         \
    X(ATAN, "atan", "f:f f:ff")                                                                    \
    X(POW, "pow", "f:ff")                                                                          \
    X(EXP, "exp", "f:f")                                                                           \
    X(SQRT, "sqrt", "f:f x:x")                                                                     \
    X(INVERSESQRT, "inversesqrt", "f:f")                                                           \
    X(LOG, "log", "f:f f:ff")                                                                      \
    X(MOD, "mod", "f:ff x:xx")                                                                     \
    X(ABS, "abs", "f:f x:x")                                                                       \
    X(SIGN, "sign", "f:f x:x")                                                                     \
    X(MIN, "min", "f:ff* c:cc* p:pp* v:vv* n:nn* x:xx*")                                           \
    X(MAX, "max", "f:ff* c:cc* p:pp* v:vv* n:nn* x:xx*")                                           \
    X(CLAMP, "clamp", "f:fff c:ccc p:ppp v:vvv n:nnn x:xxx")                                       \
    X(MIX, "mix", "f:fff c:ccf p:ppf v:vvf n:nnf c:ccc x:xxx")                                     \
    X(FLOOR, "floor", "f:f x:x")                                                                   \
    X(CEIL, "ceil", "f:f x:x")                                                                     \
    X(ROUND, "round", "f:f x:x")                                                                   \
    X(STEP, "step", "f:ff x:xx")                                                                   \
    X(NOISE, "noise",                                                                              \
      "x:x x:xx x:xxx f:f f:ff f:p f:pf c:f c:ff c:p c:pf p:f p:ff p:p p:pf v:f v:ff v:p v:pf")    \
    X(CELLNOISE, "cellnoise",                                                                      \
      "f:f f:ff f:p f:pf c:f c:ff c:p c:pf p:f p:ff p:p p:pf v:f v:ff v:p v:pf")                   \
    X(PNOISE, "pnoise",                                                                            \
      "f:ff f:ffff f:pp f:pfpf c:ff c:ffff c:pp c:pfpf p:ff p:ffff p:pp p:pfpf v:ff v:ffff v:pp "  \
      "v:pfpf")                                                                                    \
    X(RANDOM, "random", "f: c: p:")                                                                \
    X(XCOMP, "xcomp", "f:t")                                                                       \
    X(YCOMP, "ycomp", "f:t")                                                                       \
    X(ZCOMP, "zcomp", "f:t")                                                                       \
    X(COMP, "comp", "f:tf f:mff")                                                                  \
    X(SETXCOMP, "setxcomp", "0:&tf")                                                               \
    X(SETYCOMP, "setycomp", "0:&tf")                                                               \
    X(SETZCOMP, "setzcomp", "0:&tf")                                                               \
    X(SETCOMP, "setcomp", "0:&tff 0:&mfff")                                                        \
    X(LENGTH, "length", "f:v")                                                                     \
    X(NORMALIZE, "normalize", "v:v n:n")                                                           \
    X(DISTANCE, "distance", "f:pp")                                                                \
    X(FACEFORWARD, "faceforward", "n:nv n:nvn v:vv v:vvv")                                         \
    X(TRANSFORM, "transform", "p:sp p:ssp p:mp")                                                   \
    X(VTRANSFORM, "vtransform", "v:sv v:ssv v:mv")                                                 \
    X(NTRANSFORM, "ntransform", "n:sn n:ssn n:mn")                                                 \
    X(CTRANSFORM, "ctransform", "c:sc c:ssc")                                                      \
    X(AMBIENT, "ambient", "c:")                                                                    \
    X(DU, "Du", "f:f c:c v:p v:v v:n")                                                             \
    X(DV, "Dv", "f:f c:c v:p v:v v:n")                                                             \
    X(DERIV, "Deriv", "f:ff c:cf v:pf v:vf v:nf")                                                  \
    X(AREA, "area", "f:p f:ps")                                                                    \
    X(CALCULATENORMAL, "calculatenormal", "n:p")                                                   \
    X(FILTERWIDTH, "filterwidth", "f:f")                                                           \
    X(FILTERWIDTHP, "filterwidthp", "f:p")                                                         \
    X(FILTERSTEP, "filterstep", "f:ff f:fff f:ffs.* f:fffs.*")                                     \
    X(DEPTH, "depth", "f:p")                                                                       \
    X(DETERMINANT, "determinant", "f:m")                                                           \
    X(TRANSLATE, "translate", "m:mv")                                                              \
    X(ROTATE, "rotate", "m:mfv") /* the other rotate is in the prelude */                          \
    X(SCALE, "scale", "m:mv")                                                                      \
    X(SPLINE, "spline", "") /* check_call.c */                                                     \
    X(PRINTF, "printf", "0:s.*")                                                                   \
    X(FORMAT, "format", "s:s.*")                                                                   \
    X(CONCAT, "concat", "s:ss*")                                                                   \
    X(MATCH, "match", "f:ss")                                                                      \
    X(SHADERNAME, "shadername", "s: s:s")                                                          \
    X(TEXTURE, "texture", "f:s.* c:s.*")                                                           \
    X(ENVIRONMENT, "environment", "f:s.* c:s.*")                                                   \
    X(SHADOW, "shadow", "f:s.* c:s.*")                                                             \
    X(BUMP, "bump", "p:s.*")                                                                       \
    X(TEXTUREINFO, "textureinfo", "f:ss&.")                                                        \
    X(TRACE, "trace", "c:pv.* f:pv.*")                                                             \
    X(GATHER, "gather", "0:.*")                                                                    \
    X(OCCLUSION, "occlusion", "f:.*")                                                              \
    X(INDIRECTDIFFUSE, "indirectdiffuse", "c:.*")                                                  \
    X(INDIRECT, "indirect", "c:.*")                                                                \
    X(TRANSMISSION, "transmission", "c:.* f:.*")                                                   \
    X(VISIBILITY, "visibility", "c:.* f:.*")                                                       \
    X(SUBSURFACE, "subsurface", "c:.*")                                                            \
    X(PHOTONMAP, "photonmap", "c:.*")                                                              \
    X(CAUSTIC, "caustic", "c:.*")                                                                  \
    X(RAYINFO, "rayinfo", "f:.*")                                                                  \
    X(RAYDEPTH, "raydepth", "f:.*")                                                                \
    X(RAYLEVEL, "raylevel", "f:.*")                                                                \
    X(RAYLABEL, "raylabel", "s:.*")                                                                \
    X(ISSHADOWRAY, "isshadowray", "f:.*")                                                          \
    X(ISINDIRECTRAY, "isindirectray", "f:.*")                                                      \
    X(RAYTRACE, "raytrace", "f:.*")                                                                \
    X(BAKE, "bake", "0:.* f:.*")                                                                   \
    X(BAKE3D, "bake3d", "f:.*")                                                                    \
    X(TEXTURE3D, "texture3d", "f:.*")                                                              \
    X(LIGHTSOURCE, "lightsource", "f:s&.")                                                         \
    X(SURFACE, "surface", "f:s&.")                                                                 \
    X(DISPLACEMENT, "displacement", "f:s&.")                                                       \
    X(ATMOSPHERE, "atmosphere", "f:s&.")                                                           \
    X(INCIDENT, "incident", "f:s&.")                                                               \
    X(OPPOSITE, "opposite", "f:s&.")                                                               \
    X(ATTRIBUTE, "attribute", "f:s&.")                                                             \
    X(OPTION, "option", "f:s&.")                                                                   \
    X(RENDERERINFO, "rendererinfo", "f:s&.")

enum builtin_id {
#define BUILTIN_ENUM(id, name, overloads) BUILTIN_##id,
    BUILTINS(BUILTIN_ENUM)
#undef BUILTIN_ENUM
        BUILTIN_COUNT
};

enum { BUILTIN_ARGUMENTS_MAX = 64 };

struct builtin {
    enum builtin_id id;
    const char *name, *overloads;
};
extern const struct builtin builtins[BUILTIN_COUNT];

/* A function that is accepted but has nothing to work on: what to say and the value it has instead
 * (of a string: the empty one); NULL when it works. What it would write to stays as it is, and its
 * arguments are not evaluated. */
const char *builtin_neutral(enum builtin_id id, float *value);

const struct builtin *builtin_find(const char *name);
/* lightsource() and the like, that ask another shader. */
static inline bool builtin_is_message(enum builtin_id id) {
    return id >= BUILTIN_LIGHTSOURCE && id <= BUILTIN_RENDERERINFO;
}
/* A function of the language that this machine cannot carry out: the reason to give where code that
 * runs calls it, else NULL. */
const char *builtin_refusal(enum builtin_id id);
/* Chooses an overload for arguments of these types; `wanted` is the result type the context would
 * like (TYPE_ERROR: none). Returns false when none fits. parameters[i] is the type argument i is to
 * be converted to, TYPE_TRIPLE: leave it; *written_mask has a bit per argument that is written to.
 */
bool builtin_resolve(const struct builtin *builtin, const enum ast_type *arguments, int count,
                     enum ast_type wanted, enum ast_type *result, enum ast_type *parameters,
                     uint32_t *written_mask);

/* How badly a value of type `from` fits where `to` is wanted: 0 is the same type, negative not at
 * all. */
int ast_conversion_cost(enum ast_type from, enum ast_type to);

/* Where the value of a predefined variable comes from. */
enum global_source {
    GLOBAL_ABSENT,   /* not in this kind of shader */
    GLOBAL_MATERIAL, /* interpolated over the primitive: in the transfer map */
    GLOBAL_BOUND, /* bound to the instance unless options say that it comes with the primitives */
    GLOBAL_POSITION, /* rebuilt from depth */
    GLOBAL_INCIDENT,
    GLOBAL_ZERO,
    GLOBAL_ONE,
    GLOBAL_THREE,
    GLOBAL_PI,
    GLOBAL_ORIGIN, /* the origin of shader space */
    GLOBAL_AXIS,   /* the z axis of shader space */
    GLOBAL_RESULT, /* starts at zero, what the shader is for */
    GLOBAL_LIGHT,  /* set inside illuminance */
    GLOBAL_STEP,   /* how far u or v goes between neighbouring samples */
};

struct ast_global {
    const char *name;
    enum ast_type type;
    enum global_source surface, light, imager;
};
/* Displacement and volume shaders have what surface shaders have, displacement shaders without
 * results and lights. */
enum global_source global_source_in(const struct ast_global *global, enum shader_kind kind);

/* In the order in which they follow the parameters in the transfer map. */
extern const struct ast_global globals[];
extern const int global_count;
enum { GLOBALS_MAX = 64 };
const struct ast_global *global_find(const char *name);

#endif
