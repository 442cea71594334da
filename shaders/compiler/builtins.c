/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/builtins.h"

#include <string.h>

const struct builtin builtins[BUILTIN_COUNT] = {
#define BUILTIN_ENTRY(id, name, overloads) {BUILTIN_##id, name, overloads},
    BUILTINS(BUILTIN_ENTRY)
#undef BUILTIN_ENTRY
};

const struct ast_global globals[] = {
    {"N", TYPE_NORMAL, GLOBAL_MATERIAL, GLOBAL_AXIS, GLOBAL_ABSENT},
    {"Ng", TYPE_NORMAL, GLOBAL_MATERIAL, GLOBAL_AXIS, GLOBAL_ABSENT},
    {"s", TYPE_FLOAT, GLOBAL_MATERIAL, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"t", TYPE_FLOAT, GLOBAL_MATERIAL, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"u", TYPE_FLOAT, GLOBAL_MATERIAL, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"v", TYPE_FLOAT, GLOBAL_MATERIAL, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"dPdu", TYPE_VECTOR, GLOBAL_MATERIAL, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"dPdv", TYPE_VECTOR, GLOBAL_MATERIAL, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"Cs", TYPE_COLOR, GLOBAL_BOUND, GLOBAL_ABSENT, GLOBAL_ABSENT},
    {"Os", TYPE_COLOR, GLOBAL_BOUND, GLOBAL_ABSENT, GLOBAL_ABSENT},
    {"P", TYPE_POINT, GLOBAL_POSITION, GLOBAL_ORIGIN, GLOBAL_POSITION},
    {"Ps", TYPE_POINT, GLOBAL_POSITION, GLOBAL_POSITION, GLOBAL_ABSENT},
    {"I", TYPE_VECTOR, GLOBAL_INCIDENT, GLOBAL_ABSENT, GLOBAL_ABSENT},
    {"E", TYPE_POINT, GLOBAL_ZERO, GLOBAL_ZERO, GLOBAL_ZERO},
    {"L", TYPE_VECTOR, GLOBAL_LIGHT, GLOBAL_RESULT, GLOBAL_ABSENT},
    {"Cl", TYPE_COLOR, GLOBAL_LIGHT, GLOBAL_RESULT, GLOBAL_ABSENT},
    {"Ol", TYPE_COLOR, GLOBAL_ONE, GLOBAL_ONE, GLOBAL_ABSENT},
    {"Ci", TYPE_COLOR, GLOBAL_RESULT, GLOBAL_ABSENT, GLOBAL_RESULT},
    {"Oi", TYPE_COLOR, GLOBAL_RESULT, GLOBAL_ABSENT, GLOBAL_RESULT},
    {"alpha", TYPE_FLOAT, GLOBAL_ABSENT, GLOBAL_ABSENT, GLOBAL_RESULT},
    {"du", TYPE_FLOAT, GLOBAL_STEP, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"dv", TYPE_FLOAT, GLOBAL_STEP, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"time", TYPE_FLOAT, GLOBAL_ZERO, GLOBAL_ZERO, GLOBAL_ZERO},
    {"dtime", TYPE_FLOAT, GLOBAL_ZERO, GLOBAL_ZERO, GLOBAL_ZERO},
    {"dPdtime", TYPE_VECTOR, GLOBAL_ZERO, GLOBAL_ZERO, GLOBAL_ABSENT},
    {"PI", TYPE_FLOAT, GLOBAL_PI, GLOBAL_PI, GLOBAL_PI},
    {"ncomps", TYPE_FLOAT, GLOBAL_THREE, GLOBAL_THREE, GLOBAL_THREE},
};
const int global_count = sizeof globals / sizeof *globals;

enum global_source global_source_in(const struct ast_global *global, enum shader_kind kind) {
    enum global_source source = global->surface;
    if (kind == SHADER_KIND_LIGHT)
        return global->light;
    if (kind == SHADER_KIND_IMAGER)
        return global->imager;
    bool is_of_light = source == GLOBAL_RESULT || source == GLOBAL_LIGHT;
    return kind == SHADER_KIND_DISPLACEMENT && is_of_light ? GLOBAL_ABSENT : source;
}

const char *builtin_refusal(enum builtin_id id) {
    switch (id) {
    case BUILTIN_BAKE:
    case BUILTIN_BAKE3D:
    case BUILTIN_TEXTURE3D:
        return "shaders cannot write files, nor read what they wrote";
    default:
        return id >= BUILTIN_GATHER && id <= BUILTIN_RAYTRACE
                   ? "it needs ray tracing, and samples are shaded after all other geometry is gone"
                   : NULL;
    }
}

const char *builtin_neutral(enum builtin_id id, float *value) {
    *value = 0;
    switch (id) {
    case BUILTIN_PRINTF:
        return "is ignored";
    case BUILTIN_SHADERNAME:
        return "is always empty";
    case BUILTIN_TEXTURE:
        *value = 1;
        return "is always 1: there are no image textures";
    case BUILTIN_ENVIRONMENT:
        return "is always 0: there are no image textures";
    case BUILTIN_SHADOW:
        return "is always 0: there are no shadows";
    case BUILTIN_BUMP:
    case BUILTIN_TEXTUREINFO:
        return "is always 0: there are no image textures";
    case BUILTIN_TRACE:
        return "is always 0: there is no ray tracing";
    default:
        return NULL;
    }
}

const struct builtin *builtin_find(const char *name) {
    for (int i = 0; i < BUILTIN_COUNT; i++)
        if (!strcmp(builtins[i].name, name))
            return &builtins[i];
    return NULL;
}

const struct ast_global *global_find(const char *name) {
    for (int i = 0; i < global_count; i++)
        if (!strcmp(globals[i].name, name))
            return &globals[i];
    return NULL;
}

int ast_conversion_cost(enum ast_type from, enum ast_type to) {
    if (from == to || from == TYPE_ERROR || to == TYPE_ERROR)
        return 0;
    if (ast_type_is_fixed(from)) /* better fixed than float, and never silently a triple */
        return ast_type_is_fixed(to)                         ? (to == TYPE_ANY_FIXED ? 0 : 1)
               : to == TYPE_FLOAT                            ? 2
               : to == TYPE_BOOL                             ? 3
               : ast_type_is_triple(to) && to != TYPE_TRIPLE ? 5
                                                             : -1;
    if (ast_type_is_fixed(to))
        return to == TYPE_ANY_FIXED ? -1 : from == TYPE_FLOAT ? 2 : from == TYPE_BOOL ? 3 : -1;
    if (from == TYPE_TRIPLE && ast_type_is_triple(to))
        return 1;
    if (to == TYPE_TRIPLE)
        return ast_type_is_triple(from) ? 1 : -1;
    if (ast_type_is_geometric(from) && ast_type_is_geometric(to))
        return 1;
    if (from == TYPE_FLOAT && (ast_type_is_triple(to) || to == TYPE_MATRIX))
        return 3;
    if ((from == TYPE_FLOAT && to == TYPE_BOOL) || (from == TYPE_BOOL && to == TYPE_FLOAT))
        return 2;
    return -1;
}

static enum ast_type letter_type(char letter) {
    switch (letter) {
    case 'f':
        return TYPE_FLOAT;
    case 'c':
        return TYPE_COLOR;
    case 'p':
        return TYPE_POINT;
    case 'v':
        return TYPE_VECTOR;
    case 'n':
        return TYPE_NORMAL;
    case 'm':
        return TYPE_MATRIX;
    case 's':
        return TYPE_STRING;
    case 'b':
        return TYPE_BOOL;
    case 't':
        return TYPE_TRIPLE;
    case 'x':
        return TYPE_ANY_FIXED;
    case '0':
        return TYPE_VOID;
    }
    return TYPE_ERROR; /* '.': takes anything */
}

/* Cost of calling this one overload, or -1; *next is where the following overload starts. */
static int overload_cost(const char *text, const char **next, const enum ast_type *arguments,
                         int count, enum ast_type *result, enum ast_type *parameters,
                         uint32_t *written_mask) {
    int cost = 0, at = 0;
    *result = letter_type(text[0]);
    *written_mask = 0;
    text += 2;
    while (*text && *text != ' ') {
        bool is_written = *text == '&';
        text += is_written;
        enum ast_type type = letter_type(*text++);
        bool repeats = *text == '*';
        text += repeats;
        for (int uses = 0; uses == 0 || (repeats && at < count); uses++) {
            int one = at < count        ? ast_conversion_cost(arguments[at], type)
                      : repeats && uses ? 0
                                        : -1;
            if (repeats && uses == 0 && at >= count) {
                one = 0; /* `x*` may also be absent */
                break;
            }
            if (cost >= 0)
                cost = one < 0 ? -1 : cost + one;
            if (at < count) {
                parameters[at] = type;
                *written_mask |= is_written ? 1u << at : 0; /* such arguments come early */
            }
            at++;
        }
    }
    *next = *text ? text + 1 : text;
    return at == count ? cost : -1;
}

bool builtin_resolve(const struct builtin *builtin, const enum ast_type *arguments, int count,
                     enum ast_type wanted, enum ast_type *result, enum ast_type *parameters,
                     uint32_t *written_mask) {
    int best = -1;
    for (const char *text = builtin->overloads, *next; *text; text = next) {
        enum ast_type one_result, one_parameters[BUILTIN_ARGUMENTS_MAX];
        uint32_t one_mask;
        int cost =
            overload_cost(text, &next, arguments, count, &one_result, one_parameters, &one_mask);
        if (cost < 0)
            continue;
        cost *= 4; /* arguments first, then what the context would like */
        if (one_result == TYPE_ANY_FIXED && (wanted == TYPE_FLOAT || ast_type_is_fixed(wanted)))
            ; /* becomes what is wanted afterwards */
        else if (wanted != TYPE_ERROR && one_result != wanted)
            cost += ast_type_is_geometric(wanted) && ast_type_is_geometric(one_result) ? 1 : 2;
        if (best >= 0 && cost >= best)
            continue;
        best = cost;
        *result = one_result;
        *written_mask = one_mask;
        memcpy(parameters, one_parameters, (size_t)count * sizeof *parameters);
    }
    return best >= 0;
}

const char *ast_type_name(enum ast_type type) {
    static _Thread_local char names[4][32]; /* as many as a message mentions */
    static _Thread_local unsigned next;
    if (ast_type_is_fixed(type))
        return fixed_format_name(ast_type_format(type), names[next++ % 4]);
    switch (type) {
    case TYPE_TRIPLE:
        return "(x, y, z)";
    case TYPE_BOOL:
        return "condition";
    case TYPE_VOID:
        return "nothing";
    case TYPE_ERROR:
        return "unknown";
    default:
        return shader_type_name((enum shader_type)type);
    }
}
