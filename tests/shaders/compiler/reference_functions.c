/* SPDX-License-Identifier: Apache-2.0 */
#define SHADER_WIDTH 4
#include "reference_internal.h"

#include "shaders/simd/vector_math.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct reference_value number(float x) {
    return (struct reference_value){.count = 1, .part = {x}};
}

float reference_dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

float reference_cosine(const struct reference *r, float angle) {
    return r->fast_math ? sf_cos_fast(angle) : sf_cos(angle);
}

int reference_index(float index, int length) {
    if (!(index > 0))
        return 0;
    return index >= (float)length ? length - 1 : (int)index;
}

static float operate(int token, float a, float b) {
    switch (token) {
    case '+':
        return a + b;
    case '-':
        return a - b;
    case '*':
        return a * b;
    case '/':
        return a / b;
    case '%':
        return a - b * sf_floor(a / b);
    case BUILTIN_MIN + 256:
        return sf_min(a, b);
    default:
        return sf_max(a, b);
    }
}

struct reference_value reference_each(int token, const struct reference_value *a,
                                      const struct reference_value *b) {
    struct reference_value value = {.count = a->count > b->count ? a->count : b->count};
    for (int i = 0; i < value.count; i++)
        value.part[i] =
            operate(token, a->part[a->count == 1 ? 0 : i], b->part[b->count == 1 ? 0 : i]);
    return value;
}

/* ---- spaces ---- */

static struct reference_value transform_by(const struct shader_matrices *matrices, bool to_camera,
                                           int32_t space, enum ast_type type,
                                           const struct reference_value *value) {
    struct reference_value result = {.count = 3};
    const float *v = value->part;
    if (space <= SHADER_SPACE_CAMERA || space >= SHADER_SPACE_COUNT)
        return *value;
    bool is_normal = type == TYPE_NORMAL; /* goes by the transpose of the inverse */
    const float *m =
        to_camera != is_normal ? matrices->to_camera[space] : matrices->from_camera[space];
    for (int j = 0; j < 3; j++) {
        const float *n = m + j * 4;
        result.part[j] = is_normal ? v[0] * n[0] + v[1] * n[1] + v[2] * n[2]
                                   : v[0] * m[j] + v[1] * m[4 + j] + v[2] * m[8 + j];
        if (type == TYPE_POINT)
            result.part[j] += m[12 + j];
    }
    return result;
}

struct reference_value reference_transform(struct reference *r, enum ast_type type, int32_t from,
                                           int32_t to, const struct reference_value *value) {
    if (from == to)
        return *value;
    struct reference_value here = transform_by(r->world->matrices, true, from, type, value);
    return transform_by(r->world->matrices, false, to, type, &here);
}

static struct reference_value call_named(struct reference *r, const char *name,
                                         const struct reference_value *argument) {
    const struct ast_function *function = r->prelude;
    while (function && strcmp(function->name, name))
        function = function->next;
    if (!function)
        abort();
    return reference_call(r, function, NULL, argument);
}

struct reference_value reference_color_space(struct reference *r, const char *from, const char *to,
                                             const struct reference_value *value) {
    char name[32];
    struct reference_value result = *value;
    if (!strcmp(from, to))
        return result;
    snprintf(name, sizeof name, "%.8s_to_rgb", from);
    if (strcmp(from, "rgb"))
        result = call_named(r, name, &result);
    snprintf(name, sizeof name, "rgb_to_%.8s", to);
    if (strcmp(to, "rgb"))
        result = call_named(r, name, &result);
    return result;
}

static struct reference_value between_spaces(struct reference *r, const struct ast_expression *e,
                                             const struct reference_value *a) {
    static const enum ast_type types[] = {TYPE_POINT, TYPE_VECTOR, TYPE_NORMAL};
    int last = e->argument_count - 1;
    int32_t from = last == 2 ? a[0].identity : SHADER_SPACE_CURRENT;
    if (e->builtin->id != BUILTIN_CTRANSFORM)
        return reference_transform(r, types[e->builtin->id - BUILTIN_TRANSFORM], from,
                                   a[last - 1].identity, &a[last]);
    const char *first = e->arguments->name;
    return reference_color_space(r, last == 2 ? first : "rgb",
                                 last == 2 ? e->arguments->next->name : first, &a[last]);
}

/* ---- noise ---- */

static void noise3(enum builtin_id id, int dimensions, const float *x, float out[3]) {
    const int all = dimensions == 4 ? 4 : 3;
    if (id == BUILTIN_CELLNOISE)
        sf_cellnoise_3(x[0], x[1], x[2], x[3], out);
    else if (id == BUILTIN_PNOISE && all == 4)
        sf_pnoise4_3(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], out);
    else if (id == BUILTIN_PNOISE)
        sf_pnoise3_3(x[0], x[1], x[2], x[4], x[5], x[6], out);
    else if (dimensions == 1)
        sf_noise1_3(x[0], out);
    else if (dimensions == 2)
        sf_noise2_3(x[0], x[1], out);
    else if (dimensions == 3)
        sf_noise3_3(x[0], x[1], x[2], out);
    else
        sf_noise4_3(x[0], x[1], x[2], x[3], out);
}

static float noise1(enum builtin_id id, int dimensions, const float *x) {
    if (id == BUILTIN_CELLNOISE)
        return sf_cellnoise(x[0], x[1], x[2], x[3]);
    if (id == BUILTIN_PNOISE)
        return dimensions == 4 ? sf_pnoise4(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7])
                               : sf_pnoise3(x[0], x[1], x[2], x[4], x[5], x[6]);
    return dimensions == 1   ? sf_noise1(x[0])
           : dimensions == 2 ? sf_noise2(x[0], x[1])
           : dimensions == 3 ? sf_noise3(x[0], x[1], x[2])
                             : sf_noise4(x[0], x[1], x[2], x[3]);
}

/* Coordinates in x[0..3], periods in x[4..7]. */
static struct reference_value noise(const struct ast_expression *e,
                                    const struct reference_value *a) {
    struct reference_value value = {.count = ast_type_width(e->type)};
    enum builtin_id id = e->builtin->id;
    float x[8] = {0};
    int coordinates = e->argument_count / (id == BUILTIN_PNOISE ? 2 : 1), dimensions = 0;
    for (int i = 0, at = 0; i < e->argument_count; i++) {
        if (i == coordinates)
            at = 4;
        for (int c = 0; c < a[i].count; c++)
            x[at++] = a[i].part[c];
        if (i < coordinates)
            dimensions = at;
    }
    if (value.count == 3)
        noise3(id, dimensions, x, value.part);
    else
        value.part[0] = noise1(id, dimensions, x);
    return value;
}

static struct reference_value random_number(struct reference *r, const struct ast_expression *e) {
    struct reference_value value = {.count = ast_type_width(e->type)};
    const float *p = r->world->position;
    for (int i = 0; i < value.count; i++)
        value.part[i] = sf_random(p[0], p[1], p[2], r->random_calls += 1);
    return value;
}

/* ---- splines ---- */

/* What value j of a segment counts at t, as the powers of t from the third down. */
static const struct basis {
    const char *name;
    int step;
    float power[4][4];
} bases[] = {
    {"catmull-rom",
     1,
     {{-0.5f, 1, -0.5f, 0}, {1.5f, -2.5f, 0, 1}, {-1.5f, 2, 0.5f, 0}, {0.5f, -0.5f, 0, 0}}},
    {"bezier", 3, {{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}}},
    {"bspline",
     1,
     {{-1 / 6.0f, 0.5f, -0.5f, 1 / 6.0f},
      {0.5f, -1, 0, 2 / 3.0f},
      {-0.5f, 0.5f, 0.5f, 1 / 6.0f},
      {1 / 6.0f, 0, 0, 0}}},
    {"hermite", 2, {{2, -3, 0, 1}, {1, -2, 1, 0}, {-2, 3, 0, 0}, {1, -1, 0, 0}}},
    {"linear", 1, {{0, 0, 0, 0}, {0, 0, -1, 1}, {0, 0, 1, 0}, {0, 0, 0, 0}}},
};

/* Horner's rule from the first coefficient that is not zero; a value without any does not count. */
static bool weight(const float power[4], float t, float *sum) {
    int first = 0;
    while (first < 4 && power[first] == 0)
        first++;
    if (first == 4)
        return false;
    *sum = power[first];
    for (int i = first + 1; i < 4; i++) {
        *sum *= t;
        if (power[i] != 0)
            *sum += power[i];
    }
    return true;
}

static struct reference_value spline(struct reference *r, const struct ast_expression *e) {
    const struct ast_expression *a = e->arguments;
    const struct basis *basis = bases;
    float knots[64 * 3], w;
    int width = ast_type_width(e->type), length = 0;
    if (a->kind == EXPRESSION_STRING) {
        while (strcmp(basis->name, a->name))
            basis++;
        a = a->next;
    }
    float x = reference_evaluate(r, a).part[0];
    a = a->next;
    if (a->array_length) {
        struct reference_slot *array = reference_slot(r, a->symbol);
        length = array->length;
        memcpy(knots, array->cells, (size_t)(length * width) * sizeof *knots);
    }
    for (; a && !a->array_length; a = a->next, length++)
        memcpy(knots + length * width, reference_evaluate(r, a).part,
               (size_t)width * sizeof *knots);
    int spans = (length - 4) / basis->step + 1;
    float t = sf_min(sf_max(x, 0), 1) * (float)spans;
    float segment = spans == 1 ? 0 : sf_min(sf_floor(t), (float)(spans - 1));
    struct reference_value result = {0};
    if (spans > 1)
        t -= segment;
    for (int j = 0; j < 4; j++) {
        if (!weight(basis->power[j], t, &w))
            continue;
        const float *knot = knots + ((int)segment * basis->step + j) * width;
        for (int c = 0; c < width; c++)
            result.part[c] = result.count ? result.part[c] + knot[c] * w : knot[c] * w;
        result.count = width;
    }
    return result;
}

/* ---- the rest ---- */

static float function1(const struct reference *r, enum builtin_id id, float x) {
    bool fast = r->fast_math;
    switch (id) {
    case BUILTIN_RADIANS:
        return x * (float)(M_PI / 180);
    case BUILTIN_DEGREES:
        return x * (float)(180 / M_PI);
    case BUILTIN_SIN:
        return fast ? sf_sin_fast(x) : sf_sin(x);
    case BUILTIN_COS:
        return reference_cosine(r, x);
    case BUILTIN_TAN:
        return fast ? sf_tan_fast(x) : sf_tan(x);
    case BUILTIN_ASIN:
        return fast ? sf_asin_fast(x) : sf_asin(x);
    case BUILTIN_ACOS:
        return fast ? sf_acos_fast(x) : sf_acos(x);
    case BUILTIN_ATAN:
        return fast ? sf_atan_fast(x) : sf_atan(x);
    case BUILTIN_EXP:
        return fast ? sf_exp_fast(x) : sf_exp(x);
    case BUILTIN_LOG:
        return fast ? sf_log_fast(x) : sf_log(x);
    case BUILTIN_SQRT:
        return sf_sqrt(x);
    case BUILTIN_INVERSESQRT:
        return 1 / sf_sqrt(x);
    case BUILTIN_ABS:
        return sf_abs(x);
    case BUILTIN_SIGN:
        return x < 0 ? -1 : x > 0 ? 1 : 0;
    case BUILTIN_FLOOR:
        return sf_floor(x);
    case BUILTIN_CEIL:
        return sf_ceil(x);
    case BUILTIN_ROUND:
        return sf_round(x);
    default:
        fprintf(stderr, "the reference evaluator does not know builtin %d\n", (int)id);
        abort();
    }
}

static float function2(const struct reference *r, enum builtin_id id, float x, float y) {
    switch (id) {
    case BUILTIN_ATAN:
        return r->fast_math ? sf_atan2_fast(x, y) : sf_atan2(x, y);
    case BUILTIN_POW:
        return r->fast_math ? sf_pow_fast(x, y) : sf_pow(x, y);
    case BUILTIN_LOG:
        return function1(r, id, x) / function1(r, id, y);
    case BUILTIN_MOD:
        return operate('%', x, y);
    case BUILTIN_STEP:
        return y < x ? 0 : 1;
    default:
        return function1(r, id, x);
    }
}

static struct reference_value set_component(const struct ast_expression *e, float *cells,
                                            const struct reference_value *a) {
    float value = a[e->argument_count - 1].part[0];
    int which = e->builtin->id == BUILTIN_SETCOMP ? reference_index(a[1].part[0], 3)
                                                  : (int)(e->builtin->id - BUILTIN_SETXCOMP);
    if (e->arguments->type == TYPE_MATRIX)
        which = reference_matrix_element(a[1].part[0], a[2].part[0]);
    cells[which] = value;
    return number(0);
}

static struct reference_value geometry(enum builtin_id id, int count,
                                       const struct reference_value *a) {
    struct reference_value value = a[0];
    float length = sf_sqrt(reference_dot(a[0].part, a[0].part));
    switch (id) {
    case BUILTIN_LENGTH:
        return number(length);
    case BUILTIN_NORMALIZE:
        for (int i = 0; i < 3; i++)
            value.part[i] /= length;
        return value;
    case BUILTIN_DISTANCE:
        value = reference_each('-', &a[0], &a[1]);
        return number(sf_sqrt(reference_dot(value.part, value.part)));
    default: /* faceforward */
        if (reference_dot(a[1].part, a[count == 3 ? 2 : 0].part) > 0)
            for (int i = 0; i < 3; i++)
                value.part[i] = -value.part[i];
        return value;
    }
}

/* a (1 - f) + b f */
static struct reference_value mix(const struct reference_value *a) {
    struct reference_value one = number(1), rest = reference_each('-', &one, &a[2]);
    struct reference_value x = reference_each('*', &a[0], &rest),
                           y = reference_each('*', &a[1], &a[2]);
    return reference_each('+', &x, &y);
}

static struct reference_value ambient(const struct reference *r) {
    struct reference_value sum = {.count = 3};
    for (int i = 0; i < r->world->light_count; i++)
        for (int c = 0; c < 3 && r->world->lights[i].is_ambient; c++)
            sum.part[c] += r->world->lights[i].color[c];
    return sum;
}

struct reference_value reference_builtin(struct reference *r, const struct ast_expression *e) {
    struct reference_value a[BUILTIN_ARGUMENTS_MAX], value;
    enum builtin_id id = e->builtin->id;
    const bool is_written = id >= BUILTIN_SETXCOMP && id <= BUILTIN_SETCOMP;
    float *cells = is_written ? reference_cells(r, e->arguments) : NULL;
    int count = 0;
    if (id == BUILTIN_SPLINE)
        return spline(r, e);
    for (const struct ast_expression *x = e->arguments; x; x = x->next)
        a[count++] = reference_evaluate(r, x);
    if (is_written)
        return set_component(e, cells, a);
    if (ast_type_is_fixed(e->type))
        return reference_fixed_builtin(id, a, count);
    if (count && a[0].count == 16)
        return reference_matrix_builtin(r, id, a);
    switch (id) {
    case BUILTIN_MIN:
    case BUILTIN_MAX:
        value = a[0];
        for (int i = 1; i < count; i++)
            value = reference_each((int)id + 256, &value, &a[i]);
        return value;
    case BUILTIN_CLAMP:
        value = reference_each(BUILTIN_MAX + 256, &a[0], &a[1]);
        return reference_each(BUILTIN_MIN + 256, &value, &a[2]);
    case BUILTIN_MIX:
        return mix(a);
    case BUILTIN_NOISE:
    case BUILTIN_CELLNOISE:
    case BUILTIN_PNOISE:
        return noise(e, a);
    case BUILTIN_RANDOM:
        return random_number(r, e);
    case BUILTIN_XCOMP:
    case BUILTIN_YCOMP:
    case BUILTIN_ZCOMP:
        return number(a[0].part[id - BUILTIN_XCOMP]);
    case BUILTIN_COMP:
        return number(a[0].part[reference_index(a[1].part[0], 3)]);
    case BUILTIN_LENGTH:
    case BUILTIN_NORMALIZE:
    case BUILTIN_DISTANCE:
    case BUILTIN_FACEFORWARD:
        return geometry(id, count, a);
    case BUILTIN_TRANSFORM:
    case BUILTIN_VTRANSFORM:
    case BUILTIN_NTRANSFORM:
    case BUILTIN_CTRANSFORM:
        return between_spaces(r, e, a);
    case BUILTIN_AMBIENT:
        return ambient(r);
    default:
        return number(count == 2 ? function2(r, id, a[0].part[0], a[1].part[0])
                                 : function1(r, id, a[0].part[0]));
    }
}
