/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <stdio.h>
#include <string.h>

static const char *const space_names[SHADER_SPACE_COUNT] = {"current", "camera", "shader", "object",
                                                            "world"};

int32_t shader_string_identity(const char *text) {
    for (int i = 0; i < SHADER_SPACE_COUNT; i++)
        if (!strcmp(space_names[i], text))
            return i;
    uint32_t hash = 2166136261u; /* FNV-1a: the same on every machine */
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * 16777619u;
    return (int32_t)((hash & (SHADER_STRING_HASHED - 1)) | SHADER_STRING_HASHED);
}

struct ir_operand lower_space(struct lowering *l, const struct source_location *at,
                              const char *name) {
    const char *best = NULL;
    int distance = 0;
    int32_t identity = shader_string_identity(name);
    if (identity < SHADER_SPACE_COUNT)
        return ir_string(identity);
    for (int i = 0; i < SHADER_SPACE_COUNT; i++)
        suggestion_consider(name, space_names[i], &best, &distance);
    if (best)
        compile_error(l->c, lower_at(l, at), "unknown space \"%.64s\"; did you mean \"%s\"?", name,
                      best);
    else
        compile_error(
            l->c, lower_at(l, at),
            "unknown space \"%.64s\"; there are current, camera, shader, object and world", name);
    return ir_string(SHADER_SPACE_CURRENT);
}

static bool is_camera(const struct ir_operand *space) {
    return space->kind == OPERAND_STRING &&
           (space->identity == SHADER_SPACE_CURRENT || space->identity == SHADER_SPACE_CAMERA);
}

/* Element (row, column) of a matrix of this space: uniform, so free. */
static struct ir_operand element(struct lowering *l, const struct source_location *at,
                                 enum ir_operation op, const struct ir_operand *space, int row,
                                 int column) {
    struct ir_operand none = {0};
    struct ir_operand result = lower_operate(l, at, op, *space, none, none);
    l->list->last->index = row * 4 + column;
    return result;
}

/* p' = p M; a normal goes by the transpose of the inverse, which is the matrix the other way. */
static struct ir_value transform_once(struct lowering *l, const struct source_location *at,
                                      enum ast_type type, enum ir_operation op,
                                      const struct ir_operand *space,
                                      const struct ir_value *value) {
    struct ir_value result = {.count = 3};
    bool is_normal = type == TYPE_NORMAL;
    if (is_normal)
        op = op == IR_TO_CAMERA ? IR_FROM_CAMERA : IR_TO_CAMERA;
    for (int j = 0; j < 3; j++) {
        struct ir_operand sum = {0};
        for (int i = 0; i < 3; i++) {
            if (value->part[i].kind == OPERAND_FLOAT && value->part[i].number == 0)
                continue;
            struct ir_operand m = element(l, at, op, space, is_normal ? j : i, is_normal ? i : j);
            struct ir_operand term = lower_binary(l, at, IR_MULTIPLY, value->part[i], m);
            sum = sum.kind ? lower_binary(l, at, IR_ADD, sum, term) : term;
        }
        if (type == TYPE_POINT) {
            struct ir_operand m = element(l, at, op, space, 3, j);
            sum = sum.kind ? lower_binary(l, at, IR_ADD, sum, m) : m;
        }
        result.part[j] = sum.kind ? sum : ir_float(0);
    }
    return result;
}

static void need(struct lowering *l, const struct ir_operand *space) {
    if (space->kind == OPERAND_STRING)
        l->ir->spaces |= 1u << space->identity;
    else
        l->ir->spaces |= (1u << SHADER_SPACE_COUNT) - 1;
}

struct ir_operand lower_space_element(struct lowering *l, const struct source_location *at,
                                      const struct ir_operand *space, int index) {
    if (is_camera(space))
        return ir_float(index % 5 ? 0 : 1);
    need(l, space);
    return element(l, at, IR_TO_CAMERA, space, index / 4, index % 4);
}

struct ir_value lower_transform(struct lowering *l, const struct source_location *at,
                                enum ast_type type, const struct ir_operand *from,
                                const struct ir_operand *to, const struct ir_value *value) {
    struct ir_value result = *value;
    bool is_same = from->kind == OPERAND_STRING && to->kind == OPERAND_STRING &&
                   from->identity == to->identity;
    if (is_same)
        return result;
    if (!is_camera(from)) {
        need(l, from);
        result = transform_once(l, at, type, IR_TO_CAMERA, from, &result);
    }
    if (!is_camera(to)) {
        need(l, to);
        result = transform_once(l, at, type, IR_FROM_CAMERA, to, &result);
    }
    return result;
}

struct ir_value lower_color_space(struct lowering *l, const struct ast_expression *e,
                                  const char *from, const char *to, const struct ir_value *value) {
    char name[32];
    struct ir_value result = *value;
    if (!strcmp(from, to))
        return result;
    if (strcmp(from, "rgb")) {
        snprintf(name, sizeof name, "%.8s_to_rgb", from);
        result = lower_prelude_call(l, &e->at, name, &result);
    }
    if (strcmp(to, "rgb")) {
        snprintf(name, sizeof name, "rgb_to_%.8s", to);
        result = lower_prelude_call(l, &e->at, name, &result);
    }
    return result;
}
