/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <string.h>

/* illuminance in surfaces, illuminate and solar in lights. A cone test is ordinary code: a
 * direction d is in the cone about the unit axis a when d . a >= cos(angle) |d|, which needs no
 * division. */

struct cone {
    bool is_there;
    struct ir_value axis;
    struct ir_operand cosine;
};

static struct cone lower_cone(struct lowering *l, struct ast_expression *axis,
                              struct ast_expression *angle) {
    struct cone cone = {.is_there = true};
    struct ir_value direction = lower_expression(l, axis);
    cone.axis = lower_normalize(l, &axis->at, &direction);
    cone.cosine = lower_unary(l, &angle->at, IR_COS, lower_expression(l, angle).part[0]);
    return cone;
}

static struct ir_operand lower_in_cone(struct lowering *l, const struct source_location *at,
                                       const struct cone *cone, const struct ir_value *direction) {
    struct ir_operand along = lower_dot(l, at, direction, &cone->axis);
    struct ir_operand limit =
        lower_binary(l, at, IR_MULTIPLY, cone->cosine, lower_length(l, at, direction));
    return lower_binary(l, at, IR_LESS_EQUAL, limit, along);
}

/* if (condition) { ... the statement follows in the list this opens */
static void open_if(struct lowering *l, const struct source_location *at,
                    struct ir_operand condition) {
    struct ir_node *node = lower_control(l, NODE_IF, at);
    node->condition = condition;
    l->list = l->scope = node->body;
}

static void lower_statement_in(struct lowering *l, struct ast_statement *s) {
    if (s)
        lower_statements(l, s);
}

/* The direction and colour of the light at hand are loaded at the start of the body. */
static void load_light(struct lowering *l, const struct source_location *at) {
    struct ir_operand none = {0};
    l->light_direction.count = l->light_color.count = 3;
    for (int i = 0; i < 3; i++) {
        struct ir_operand direction = lower_operate(l, at, IR_LIGHT_DIRECTION, none, none, none);
        l->list->last->index = i;
        l->light_direction.part[i] = lower_unary(l, at, IR_NEGATE, direction);
        l->light_color.part[i] = lower_operate(l, at, IR_LIGHT_COLOR, none, none, none);
        l->list->last->index = i;
    }
}

/* Runs the lights at a place; what it gives is the condition of illuminances. */
static struct ir_operand run_lights(struct lowering *l, const struct source_location *at,
                                    const struct ir_value *position) {
    struct ir_operand done =
        lower_operate(l, at, IR_LIGHTS_AT, position->part[0], position->part[1], position->part[2]);
    l->list->last->index = l->light_set = l->ir->light_sets++;
    if (l->ir->light_sets > LIGHT_SETS_MAX)
        compile_limit(l->c, lower_at(l, at), "lights are wanted at more than %d places",
                      LIGHT_SETS_MAX);
    return done;
}

void lower_lights_begin(struct lowering *l, const struct source_location *at,
                        bool changes_position) {
    const struct ast_global *position = global_find("P");
    l->position_changes = changes_position;
    l->lights_at_p = (struct ir_operand){0};
    if (changes_position || !l->global_is_assigned[position - globals] ||
        (l->kind != SHADER_KIND_SURFACE && l->kind != SHADER_KIND_VOLUME))
        return;
    l->lights_at_p = run_lights(l, at, lower_global(l, position, at));
    l->p_light_set = l->light_set;
}

/* Where the illuminance wants the lights: none for the position of the sample. */
static struct ir_operand lights_of(struct lowering *l, struct ast_statement *s) {
    struct ast_expression *where = s->arguments;
    bool is_p = where->kind == EXPRESSION_NAME && where->symbol->global &&
                global_source_in(where->symbol->global, l->kind) == GLOBAL_POSITION;
    if (is_p && !l->position_changes) {
        l->light_set = l->p_light_set;
        return l->lights_at_p;
    }
    struct ir_value position = lower_expression(l, where);
    return run_lights(l, &s->at, &position);
}

static int category_of(struct lowering *l, struct ast_statement *s) {
    struct ir_program *ir = l->ir;
    if (!s->category || !*s->category)
        return -1;
    for (int i = 0; i < ir->category_count; i++)
        if (!strcmp(ir->categories[i], s->category))
            return i;
    if (ir->category_count == CATEGORIES_MAX)
        compile_limit(l->c, lower_at(l, &s->at), "more than %d categories of lights",
                      CATEGORIES_MAX);
    ir->categories[ir->category_count] = s->category;
    return ir->category_count++;
}

void lower_illuminance(struct lowering *l, struct ast_statement *s) {
    struct ast_expression *axis = s->argument_count == 3 ? s->arguments->next : NULL;
    struct cone cone = {0};
    struct lower_loop loop = {.is_illuminance = true, .outer = l->call->loops};
    bool can_ask = l->kind == SHADER_KIND_SURFACE || l->kind == SHADER_KIND_VOLUME;
    if (!can_ask || l->light_direction.count) {
        compile_error(l->c, lower_at(l, &s->at),
                      l->light_direction.count ? "illuminance inside illuminance"
                                               : "illuminance belongs into a surface shader");
        return;
    }
    if (!s->arguments)
        return; /* reported by check.c */
    struct ir_operand lights = lights_of(l, s);
    if (axis)
        cone = lower_cone(l, axis, axis->next);
    if (s->body && s->body->exit_level > 0) {
        loop.broken = ir_variable_new(l->ir, l->list, IR_BOOL, NULL);
        lower_move(l, &s->at, loop.broken, ir_bool(false));
    }
    struct ir_node *node = lower_control(l, NODE_ILLUMINANCE, &s->at);
    node->condition = lights;
    node->light_set = lights.kind == OPERAND_VARIABLE ? l->light_set : 0;
    node->category = category_of(l, s);
    struct ir_list *outer = l->list, *scope = l->scope;
    l->ir->uses_illuminance = true;
    l->list = l->scope = node->body;
    if (loop.broken) {
        loop.continued = ir_variable_new(l->ir, node->body, IR_BOOL, NULL);
        l->call->loops = &loop;
        open_if(l, &s->at, lower_still_running(l, &s->at, s->body->exit_level, false));
    }
    l->call->loops = &loop;
    load_light(l, &s->at);
    if (cone.is_there)
        open_if(l, &s->at, lower_in_cone(l, &s->at, &cone, &l->light_direction));
    lower_statement_in(l, s->body);
    l->call->loops = loop.outer;
    l->light_direction.count = l->light_color.count = 0;
    l->list = outer;
    l->scope = scope;
}

/* illuminate(from): L is from there to the sample; solar(axis, angle): L is the axis. The samples
 * in the cone are lit, and the statement runs for them. */
void lower_illuminate(struct lowering *l, struct ast_statement *s) {
    bool is_solar = s->kind == STATEMENT_SOLAR;
    struct ast_expression *first = s->arguments,
                          *axis = s->argument_count == 3 ? first->next : NULL;
    struct ir_operand none = {0};
    struct ir_value *direction = lower_global(l, global_find("L"), &s->at);
    struct cone cone = {0};
    if (!first) { /* solar () */
        struct ir_list *list = l->list, *scope = l->scope;
        l->scope = l->list;
        lower_statement_in(l, s->body);
        l->list = list;
        l->scope = scope;
        return;
    }
    l->ir->is_ambient = false;
    struct ir_value value = lower_expression(l, first);
    if (!is_solar) {
        struct ir_value here = {.count = 3};
        for (int i = 0; i < 3; i++) {
            here.part[i] = lower_operate(l, &s->at, IR_POSITION, none, none, none);
            l->list->last->index = i;
        }
        value = lower_each(l, &s->at, IR_SUBTRACT, &here, &value);
    }
    if (axis)
        cone = lower_cone(l, axis, axis->next);
    lower_assign(l, &s->at, direction, &value);
    struct ir_list *outer = l->list, *scope = l->scope;
    if (cone.is_there)
        open_if(l, &s->at, lower_in_cone(l, &s->at, &cone, direction));
    lower_move(l, &s->at, l->ir->lit, ir_bool(true));
    l->scope = l->list;
    lower_statement_in(l, s->body);
    l->list = outer;
    l->scope = scope;
}
