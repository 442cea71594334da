/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <stdio.h>
#include <string.h>

static const char *const space_names[SHADER_SPACE_COUNT] = {"current",
                                                            "camera",
                                                            "shader",
                                                            "object",
                                                            "world",
                                                            "shader of the displacement",
                                                            "shader of the atmosphere",
                                                            "screen",
                                                            "NDC",
                                                            "raster"};

int32_t shader_string_identity(const char *text) {
    for (int i = 0; i < SHADER_SPACE_COUNT; i++)
        if (!strcmp(space_names[i], text))
            return i;
    uint32_t hash = 2166136261u; /* FNV-1a: the same on every machine */
    for (; *text; text++)
        hash = (hash ^ (unsigned char)*text) * 16777619u;
    return (int32_t)((hash & (SHADER_STRING_HASHED - 1)) | SHADER_STRING_HASHED);
}

/* "shader" is that of the shader being lowered. */
static int32_t own_space(const struct lowering *l, int32_t identity) {
    if (identity == SHADER_SPACE_SHADER && l->kind != l->ir->kind)
        return l->kind == SHADER_KIND_DISPLACEMENT ? SHADER_SPACE_DISPLACEMENT
                                                   : SHADER_SPACE_ATMOSPHERE;
    return identity;
}

struct ir_operand lower_space(struct lowering *l, const struct source_location *at,
                              const char *name) {
    const char *best = NULL;
    struct ir_program *ir = l->ir;
    int distance = 0;
    int32_t identity = shader_string_identity(name);
    if (identity < SHADER_SPACE_COUNT)
        return ir_string(own_space(l, identity));
    for (int i = 0; i < ir->named_space_count; i++)
        if (!strcmp(ir->named_spaces[i].name, name))
            return ir_string(identity);
    for (int i = 0; i < SHADER_SPACE_COUNT; i++)
        suggestion_consider(name, space_names[i], &best, &distance);
    if (best)
        compile_warning(l->c, lower_at(l, at),
                        "\"%.64s\" is a coordinate system of the scene; did you mean \"%s\"?", name,
                        best);
    if (ir->named_space_count == NAMED_SPACES_MAX)
        compile_limit(l->c, lower_at(l, at), "more than %d coordinate systems", NAMED_SPACES_MAX);
    ir->named_spaces[ir->named_space_count++].name = name;
    return ir_string(identity);
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

/* Whether points of this space divide by their distance. */
static bool is_projective(const struct ir_operand *space) {
    return space->kind == OPERAND_STRING && space->identity >= SHADER_SPACE_SCREEN &&
           space->identity < SHADER_SPACE_COUNT;
}

/* Component j of p M; `count` elements of a column. */
static struct ir_operand column_product(struct lowering *l, const struct source_location *at,
                                        enum ir_operation op, const struct ir_operand *space,
                                        const struct ir_value *value, int j, bool is_transposed,
                                        bool is_point) {
    struct ir_operand sum = {0};
    for (int i = 0; i < 3; i++) {
        if (value->part[i].kind == OPERAND_FLOAT && value->part[i].number == 0)
            continue;
        struct ir_operand m =
            element(l, at, op, space, is_transposed ? j : i, is_transposed ? i : j);
        struct ir_operand term = lower_binary(l, at, IR_MULTIPLY, value->part[i], m);
        sum = sum.kind ? lower_binary(l, at, IR_ADD, sum, term) : term;
    }
    if (is_point) {
        struct ir_operand m = element(l, at, op, space, 3, j);
        sum = sum.kind ? lower_binary(l, at, IR_ADD, sum, m) : m;
    }
    return sum.kind ? sum : ir_float(0);
}

/* p' = p M; a normal goes by the transpose of the inverse, which is the matrix the other way. */
static struct ir_value transform_once(struct lowering *l, const struct source_location *at,
                                      enum ast_type type, enum ir_operation op,
                                      const struct ir_operand *space,
                                      const struct ir_value *value) {
    struct ir_value result = {.count = 3};
    bool is_normal = type == TYPE_NORMAL, is_point = type == TYPE_POINT;
    if (is_normal)
        op = op == IR_TO_CAMERA ? IR_FROM_CAMERA : IR_TO_CAMERA;
    for (int j = 0; j < 3; j++)
        result.part[j] = column_product(l, at, op, space, value, j, is_normal, is_point);
    if (!is_point || !is_projective(space))
        return result;
    struct ir_value w = {.count = 1};
    w.part[0] = column_product(l, at, op, space, value, 3, false, true);
    return lower_each(l, at, IR_DIVIDE, &result, &w);
}

struct ir_operand lower_space_element(struct lowering *l, const struct source_location *at,
                                      const struct ir_operand *space, int index) {
    if (is_camera(space))
        return ir_float(index % 5 ? 0 : 1);
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
        result = transform_once(l, at, type, IR_TO_CAMERA, from, &result);
    }
    if (!is_camera(to)) {
        result = transform_once(l, at, type, IR_FROM_CAMERA, to, &result);
    }
    return result;
}

/* To or from rgb, with a space that is known at run time only; what is no color space is rgb. */
static struct ir_value lower_chosen_space(struct lowering *l, const struct ast_expression *e,
                                          struct ir_operand space, bool is_from,
                                          const struct ir_value *value) {
    static const char *const names[] = {"hsv", "hsl", "YIQ", "xyz"};
    struct ir_value result = lower_variables(l, &e->at, TYPE_COLOR, 0, NULL, STORAGE_UNSAID);
    lower_assign(l, &e->at, &result, value);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct ir_list *list = l->list, *scope = l->scope;
        struct ir_operand is_it =
            lower_binary(l, &e->at, IR_STRING_EQUAL, space, lower_text(l, names[i]));
        struct ir_node *node = lower_control(l, NODE_IF, &e->at);
        node->condition = is_it;
        l->list = l->scope = node->body;
        struct ir_value one = is_from ? lower_color_space(l, e, names[i], "rgb", value)
                                      : lower_color_space(l, e, "rgb", names[i], value);
        lower_assign(l, &e->at, &result, &one);
        l->list = list;
        l->scope = scope;
    }
    return result;
}

struct ir_value lower_ctransform(struct lowering *l, const struct ast_expression *e,
                                 const struct ir_value *arguments, int count) {
    const struct ast_expression *from = count == 3 ? e->arguments : NULL,
                                *to = from ? from->next : e->arguments;
    struct ir_value value = arguments[count - 1];
    if (from && from->kind == EXPRESSION_STRING)
        value = lower_color_space(l, e, from->name, "rgb", &value);
    else if (from)
        value = lower_chosen_space(l, e, arguments[0].part[0], true, &value);
    if (to->kind == EXPRESSION_STRING)
        return lower_color_space(l, e, "rgb", to->name, &value);
    return lower_chosen_space(l, e, arguments[count - 2].part[0], false, &value);
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
