/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <string.h>

/* What shaders ask about others. Displacement, surface and volume shaders of one surface are one
 * program, so that asking among them reads the other's variable. Lights are other programs: the
 * question becomes a query, which the node answers from what the light exports. */

static struct ir_value scalar(struct ir_operand operand) {
    return (struct ir_value){.count = 1, .part = {operand}};
}

static struct ir_value nothing_there(struct lowering *l, const struct ast_expression *e,
                                     const char *why) {
    compile_warning(l->c, lower_at(l, &e->at), "%s(\"%.64s\") is 0: %s", e->name,
                    e->arguments->name, why);
    return lower_constant(0, 1);
}

/* The shader of this kind in the program; NULL: none. */
static const struct ast_function *find_shader(const struct lowering *l, enum shader_kind kind) {
    for (int i = 0; i < l->unit_count; i++)
        if (l->units[i].unit->kind == kind)
            return l->units[i].unit->shader;
    return NULL;
}

static struct ir_value lower_ask(struct lowering *l, struct ast_expression *e,
                                 enum shader_kind kind) {
    const struct ast_function *shader = find_shader(l, kind);
    const struct ast_symbol *found = NULL;
    struct ast_expression *target = e->arguments->next;
    if (!shader || l->kind == kind)
        return nothing_there(l, e, "there is no such shader here");
    for (const struct ast_symbol *s = shader->formals; s; s = s->next)
        if (!strcmp(s->name, e->arguments->name))
            found = s;
    if (!found || !found->value)
        return nothing_there(l, e,
                             found ? "that shader runs later"
                                   : "that shader has no such "
                                     "parameter");
    if (found->type != target->type || found->array_length != target->array_length)
        return nothing_there(l, e, "the variable has another type");
    if (found->array_length) {
        struct ir_value to = *lower_symbol(l, target->symbol, &target->at);
        lower_array_copy(l, &e->at, found->type, &to, found->value, found->array_length);
    } else {
        struct lower_target to = lower_target_open(l, target);
        lower_target_write(l, &to, found->value);
    }
    return lower_constant(1, 1);
}

static int query_of(struct lowering *l, const struct ast_expression *e, int components) {
    struct ir_program *ir = l->ir;
    const char *name = e->arguments->name;
    for (int i = 0; i < ir->query_count; i++)
        if (!strcmp(ir->queries[i].name, name) && ir->queries[i].components == components)
            return i;
    if (ir->query_count == QUERIES_MAX)
        compile_limit(l->c, lower_at(l, &e->at), "more than %d questions to lights", QUERIES_MAX);
    ir->queries[ir->query_count] = (struct ir_message){.name = name, .components = components};
    return ir->query_count++;
}

static struct ir_value lower_ask_light(struct lowering *l, struct ast_expression *e) {
    struct ast_expression *target = e->arguments->next;
    struct ir_operand none = {0};
    if (!l->light_direction.count)
        return nothing_there(l, e, "lights are asked inside illuminance");
    if (target->array_length || (target->type != TYPE_FLOAT && !ast_type_is_triple(target->type)))
        return nothing_there(l, e, "lights are asked for floats, colors, points and vectors");
    struct lower_target to = lower_target_open(l, target);
    struct ir_value old = lower_target_read(l, &to), value = old;
    int query = query_of(l, e, old.count);
    struct ir_operand knows = lower_operate(l, &e->at, IR_LIGHT_KNOWS, none, none, none);
    l->list->last->index = 3 * query;
    for (int i = 0; i < value.count; i++) {
        struct ir_operand answer = lower_operate(l, &e->at, IR_LIGHT_VALUE, none, none, none);
        l->list->last->index = 3 * query + i;
        value.part[i] = lower_operate(l, &e->at, IR_SELECT, knows, answer, old.part[i]);
    }
    lower_target_write(l, &to, &value);
    return scalar(lower_operate(l, &e->at, IR_SELECT, knows, ir_float(1), ir_float(0)));
}

struct ir_value lower_message(struct lowering *l, struct ast_expression *e) {
    switch (e->builtin->id) {
    case BUILTIN_LIGHTSOURCE:
        return lower_ask_light(l, e);
    case BUILTIN_SURFACE:
        return lower_ask(l, e, SHADER_KIND_SURFACE);
    case BUILTIN_DISPLACEMENT:
        return lower_ask(l, e, SHADER_KIND_DISPLACEMENT);
    case BUILTIN_ATMOSPHERE:
        return lower_ask(l, e, SHADER_KIND_VOLUME);
    default:
        return nothing_there(l, e, "no ray passes through a volume");
    }
}

void lower_exports(struct lowering *l, const struct ast_function *shader) {
    const struct shader_compile_options *options = l->c->options;
    for (int i = 0; options && i < options->export_count; i++)
        for (const struct ast_symbol *s = shader->formals; s; s = s->next) {
            bool fits = s->type == TYPE_FLOAT || ast_type_is_triple(s->type);
            if (strcmp(s->name, options->exports[i]) || s->array_length || !fits ||
                l->ir->export_count == EXPORTS_MAX)
                continue;
            struct ir_message *offer = &l->ir->exports[l->ir->export_count++];
            offer->name = s->name;
            offer->components = ast_type_width(s->type);
            struct ir_value value =
                lower_variables(l, &s->at, s->type, 0, s->name, STORAGE_VARYING);
            for (int c = 0; c < offer->components; c++)
                offer->value[c] = value.part[c].variable;
            lower_assign(l, &s->at, &value, s->value);
        }
}
