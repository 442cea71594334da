/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include "shaders/compiler/call_sites.h"

#include <string.h>

/* The variables that the program is for exist from the start, whether a shader assigns to them or
 * not. */
static void declare_results(struct lowering *l, const struct source_location *at) {
    static const char *const names[SHADER_KIND_COUNT][2] = {
        [SHADER_KIND_SURFACE] = {"Ci", NULL},    [SHADER_KIND_LIGHT] = {"Cl", "L"},
        [SHADER_KIND_DISPLACEMENT] = {"P", "N"}, [SHADER_KIND_VOLUME] = {"Ci", NULL},
        [SHADER_KIND_IMAGER] = {"Ci", NULL},
    };
    for (int n = 0; n < 2 && names[l->ir->kind][n]; n++) {
        const struct ast_global *global = global_find(names[l->ir->kind][n]);
        l->global_is_assigned[global - globals] = true;
        struct ir_value *value = lower_global(l, global, at);
        for (int i = 0; i < 3; i++) {
            struct ir_variable *variable = value->part[i].variable;
            variable->is_forced_varying = true;
            (n ? l->ir->direction : l->ir->color)[i] = variable;
        }
    }
    if (l->ir->kind != SHADER_KIND_LIGHT)
        return;
    l->ir->lit = ir_variable_new(l->ir, l->ir->top, IR_BOOL, NULL);
    l->ir->lit->is_forced_varying = true;
}

static void lower_one(struct lowering *l, const struct checked_unit *checked) {
    struct ast_function *shader = checked->unit->shader;
    struct lower_call call = {.function = shader};
    l->kind = checked->unit->kind;
    l->file = shader->at.file;
    l->prelude = checked->prelude->functions;
    l->call = &call;
    bool changes_position = false;
    for (int g = 0; g < global_count; g++)
        if (checked->symbols[g] && !strcmp(globals[g].name, "P"))
            changes_position = checked->symbols[g]->is_assigned;
    lower_lights_begin(l, &shader->at, changes_position);
    lower_parameters(l, shader);
    if (shader->returns_early)
        call.returned = ir_variable_new(l->ir, l->ir->top, IR_BOOL, NULL);
    lower_statements(l, shader->body);
    if (l->kind == SHADER_KIND_LIGHT)
        lower_exports(l, shader);
    l->call = NULL;
}

struct ir_program *lower_units(struct compilation *c, const struct checked_unit *units, int count,
                               int main) {
    struct ir_program *ir = compilation_get(c, sizeof *ir);
    struct lowering *l = compilation_get(c, sizeof *l);
    l->c = c;
    l->ir = ir;
    l->units = units;
    l->unit_count = count;
    ir->light_sets = 1;
    l->kind = ir->kind = units[main].unit->kind;
    l->file = units[main].unit->shader->at.file;
    ir->c = c;
    ir->is_ambient = ir->kind == SHADER_KIND_LIGHT;
    ir->top = ir_list_new(ir, NULL);
    l->list = l->scope = ir->top;
    for (int i = 0; i < count; i++)
        for (int g = 0; g < global_count; g++)
            l->global_is_assigned[g] |= units[i].symbols[g] && units[i].symbols[g]->is_assigned;
    lower_parameter_table(l, units, count);
    declare_results(l, &units[main].unit->shader->at);
    for (int i = 0; i < count; i++)
        lower_one(l, &units[i]);
    if (ir->is_ambient)
        lower_move(l, &units[main].unit->shader->at, ir->lit, ir_bool(true));
    call_sites_finish(l);
    return ir;
}
