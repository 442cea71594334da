/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

static struct ast_symbol *result_symbol(struct lowering *l, const char *name) {
    struct ast_symbol *symbol = compilation_get(l->c, sizeof *symbol);
    symbol->global = global_find(name);
    symbol->name = name;
    symbol->type = symbol->global->type;
    symbol->is_assigned = true;
    return symbol;
}

/* The variables that the shader is for exist from the start, whether it assigns to them or not. */
static void declare_results(struct lowering *l, struct ast_symbol **symbols) {
    bool is_surface = l->ir->kind == SHADER_KIND_SURFACE;
    const char *names[2] = {is_surface ? "Ci" : "Cl", "L"};
    for (int n = 0; n < (is_surface ? 1 : 2); n++) {
        const struct ast_global *global = global_find(names[n]);
        struct ast_symbol *symbol = symbols[global - globals];
        if (!symbol)
            symbol = result_symbol(l, names[n]);
        symbol->is_assigned = true;
        symbol->value = NULL;
        struct ir_value *value = lower_symbol(l, symbol, &symbol->at);
        for (int i = 0; i < 3; i++) {
            struct ir_variable *variable = value->part[i].variable;
            variable->is_forced_varying = true;
            if (n == 0)
                l->ir->color[i] = variable;
            else
                l->ir->direction[i] = variable;
        }
        if (n == 1)
            l->direction = symbol;
    }
    if (is_surface)
        return;
    l->ir->lit = ir_variable_new(l->ir, l->ir->top, IR_BOOL, NULL);
    l->ir->lit->is_forced_varying = true;
}

struct ir_program *lower_unit(struct compilation *c, struct ast_unit *unit,
                              struct ast_unit *prelude, struct ast_symbol **symbols) {
    struct ir_program *ir = compilation_get(c, sizeof *ir);
    struct lowering lowering = {.c = c, .ir = ir, .prelude = prelude->functions}, *l = &lowering;
    struct lower_call call = {.function = unit->shader};
    ir->c = c;
    ir->kind = unit->kind;
    ir->is_ambient = unit->kind == SHADER_KIND_LIGHT;
    ir->top = ir_list_new(ir, NULL);
    l->list = l->scope = ir->top;
    l->call = &call;
    declare_results(l, symbols);
    lower_parameters(l, unit->shader);
    if (unit->shader->returns_early)
        call.returned = ir_variable_new(ir, ir->top, IR_BOOL, NULL);
    lower_statements(l, unit->shader->body);
    if (ir->is_ambient)
        lower_move(l, &unit->shader->at, ir->lit, ir_bool(true));
    return ir;
}
