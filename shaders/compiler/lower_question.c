/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <string.h>

/* What shaders ask about the scene and the renderer. Options of the scene are bound to the instance
 * like parameters, under names that no parameter can have; what asks for none of them carries none.
 */

static const struct {
    const char *name, *parameter;
    int length;
} options[] = {
    {"Format", "Format ()", 3},
    {"DeviceResolution", "Format ()", 3},
    {"FrameAspectRatio", "FrameAspectRatio ()", 1},
    {"Clipping", "Clipping ()", 2},
};

void lower_question_table(struct lowering *l) {
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (strcmp(options[i].name, "DeviceResolution"))
            lower_add_option(l, options[i].parameter, options[i].length);
}

static struct ir_value scalar(struct ir_operand operand) {
    return (struct ir_value){.count = 1, .part = {operand}};
}

static struct ir_value not_known(struct lowering *l, const struct ast_expression *e) {
    compile_warning(l->c, lower_at(l, &e->at), "%s(\"%.64s\") is 0: it is not known here", e->name,
                    e->arguments->kind == EXPRESSION_STRING ? e->arguments->name : "");
    return lower_constant(0, 1);
}

/* Number i of an answer goes to element, component or variable i of the target. */
static void put_number(struct lowering *l, const struct ast_expression *target, int i,
                       struct ir_operand number) {
    struct ir_value to = *lower_symbol(l, target->symbol, &target->at), one = scalar(number);
    if (target->array_length)
        lower_array_store(l, &target->at, target->type, &to, ir_float((float)i), &one);
    else
        lower_move(l, &target->at, to.part[i].variable, number);
}

static int room(const struct ast_expression *target) {
    if (target->kind != EXPRESSION_NAME)
        return 0;
    if (target->array_length)
        return target->type == TYPE_FLOAT ? target->array_length : 0;
    return target->type == TYPE_FLOAT || ast_type_is_triple(target->type)
               ? ast_type_width(target->type)
               : 0;
}

static struct ir_value lower_option(struct lowering *l, struct ast_expression *e) {
    const struct ast_expression *target = e->arguments->next;
    size_t i = 0;
    while (i < sizeof options / sizeof *options && strcmp(options[i].name, e->arguments->name))
        i++;
    if (i == sizeof options / sizeof *options || room(target) < options[i].length)
        return not_known(l, e);
    struct ir_operand given = lower_load_option(l, &e->at, options[i].parameter, -1);
    for (int n = 0; n < options[i].length; n++) {
        struct ir_value to = *lower_symbol(l, target->symbol, &target->at);
        struct ir_operand old =
            target->array_length
                ? lower_array_load(l, &e->at, target->type, &to, ir_float((float)n)).part[0]
                : to.part[n];
        struct ir_operand number = lower_load_option(l, &e->at, options[i].parameter, n);
        put_number(l, target, n, lower_operate(l, &e->at, IR_SELECT, given, number, old));
    }
    return scalar(lower_operate(l, &e->at, IR_SELECT, given, ir_float(1), ir_float(0)));
}

static struct ir_value lower_rendererinfo(struct lowering *l, struct ast_expression *e) {
    struct ast_expression *target = e->arguments->next;
    const char *name = e->arguments->name;
    bool is_name = !strcmp(name, "renderer"), is_version = !strcmp(name, "version"),
         is_text = is_name || !strcmp(name, "versionstring");
    if (is_text && target->type == TYPE_STRING && !target->array_length) {
        struct lower_target to = lower_target_open(l, target);
        struct ir_value text = scalar(lower_text(l, is_name ? "sortlast" : "1.0.0.0"));
        lower_target_write(l, &to, &text);
        return lower_constant(1, 1);
    }
    if (!is_version || room(target) < 4)
        return not_known(l, e);
    for (int i = 0; i < 4; i++)
        put_number(l, target, i, ir_float(i ? 0 : 1));
    return lower_constant(1, 1);
}

struct ir_value lower_question(struct lowering *l, struct ast_expression *e) {
    switch (e->builtin->id) {
    case BUILTIN_OPTION:
        return l->kind == SHADER_KIND_LIGHT || l->kind == SHADER_KIND_IMAGER ? not_known(l, e)
                                                                             : lower_option(l, e);
    case BUILTIN_RENDERERINFO:
        return lower_rendererinfo(l, e);
    default:
        return not_known(l, e);
    }
}

/* depth(p) = (z - near) / (far - near) of the view */
struct ir_value lower_depth(struct lowering *l, struct ast_expression *e) {
    struct ir_value p = lower_expression(l, e->arguments);
    if (l->kind == SHADER_KIND_LIGHT || l->kind == SHADER_KIND_IMAGER)
        return not_known(l, e);
    struct ir_operand near = lower_load_option(l, &e->at, "Clipping ()", 0),
                      far = lower_load_option(l, &e->at, "Clipping ()", 1);
    return scalar(lower_binary(l, &e->at, IR_DIVIDE,
                               lower_binary(l, &e->at, IR_SUBTRACT, p.part[2], near),
                               lower_binary(l, &e->at, IR_SUBTRACT, far, near)));
}
