/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <string.h>

struct shader_parameter *lower_find_parameter(struct lowering *l, const char *name) {
    struct shader_program *program = l->c->program;
    for (int i = 0; i < program->parameter_count; i++)
        if (!strcmp(program->parameters[i].name, name))
            return &program->parameters[i];
    return NULL;
}

static struct ir_operand load(struct lowering *l, const struct source_location *at,
                              enum ir_operation op, struct shader_parameter *parameter, int index) {
    struct ir_operand none = {0};
    struct ir_operand result = lower_operate(l, at, op, none, none, none);
    l->list->last->parameter = parameter;
    l->list->last->index = index;
    if (parameter && parameter->is_global && !parameter->line) {
        parameter->line = at->line;
        parameter->column = at->column;
    }
    return result;
}

static bool is_material(const struct lowering *l, const char *name) {
    const struct shader_compile_options *options = l->c->options;
    for (int i = 0; options && i < options->material_count; i++)
        if (!strcmp(options->material[i], name))
            return true;
    return false;
}

static struct ir_value load_all(struct lowering *l, const struct source_location *at,
                                enum ir_operation op, struct shader_parameter *parameter,
                                int count) {
    struct ir_value value = {.count = count};
    for (int i = 0; i < count; i++)
        value.part[i] = load(l, at, op, parameter, i);
    return value;
}

/* Cs and Os: white unless given; varying when the primitives bring them. */
static struct ir_value bound_global(struct lowering *l, const struct source_location *at,
                                    struct shader_parameter *parameter) {
    if (parameter->is_material)
        return load_all(l, at, IR_MATERIAL, parameter, 3);
    struct ir_value value = load_all(l, at, IR_BOUND, parameter, 3);
    struct ir_operand given = load(l, at, IR_GIVEN, parameter, 0);
    for (int i = 0; i < 3; i++)
        value.part[i] = lower_operate(l, at, IR_SELECT, given, value.part[i], ir_float(1));
    return value;
}

static struct ir_value global_value(struct lowering *l, const struct ast_global *global,
                                    const struct source_location *at) {
    enum global_source source =
        l->ir->kind == SHADER_KIND_SURFACE ? global->surface : global->light;
    int count = ast_type_width(global->type);
    struct ir_value zero = lower_constant(0, 3), axis = zero;
    struct ir_operand from = ir_string(SHADER_SPACE_SHADER), to = ir_string(SHADER_SPACE_CURRENT);
    axis.part[2] = ir_float(1);
    switch (source) {
    case GLOBAL_MATERIAL:
        return load_all(l, at, IR_MATERIAL, lower_find_parameter(l, global->name), count);
    case GLOBAL_BOUND:
        return bound_global(l, at, lower_find_parameter(l, global->name));
    case GLOBAL_POSITION:
        return load_all(l, at, IR_POSITION, NULL, 3);
    case GLOBAL_INCIDENT:
        return load_all(l, at, IR_INCIDENT, NULL, 3);
    case GLOBAL_ONE:
        return lower_constant(1, count);
    case GLOBAL_THREE:
        return lower_constant(3, count);
    case GLOBAL_PI:
        return lower_constant(0x1.921fb6p+1f, count);
    case GLOBAL_ORIGIN:
        return lower_transform(l, at, TYPE_POINT, &from, &to, &zero);
    case GLOBAL_AXIS:
        return lower_transform(l, at, TYPE_VECTOR, &from, &to, &axis);
    default:
        return lower_constant(0, count);
    }
}

/* A predefined variable: loaded once at the very start, whatever control flow asks for it first.
 * Only what the shader assigns to needs variables of its own. */
static struct ir_value *lower_global(struct lowering *l, struct ast_symbol *symbol,
                                     const struct source_location *at) {
    struct ir_list *list = l->list, *scope = l->scope;
    struct ir_list *start = ir_list_new(l->ir, NULL);
    l->list = l->scope = start;
    struct ir_value value = global_value(l, symbol->global, at);
    symbol->value = compilation_get(l->c, sizeof *symbol->value);
    struct ir_list *top = l->ir->top;
    for (struct ir_variable *v = start->variables, *next; v; v = next) {
        next = v->next_in_home;
        v->home = top;
        v->next_in_home = top->variables;
        top->variables = v;
    }
    l->scope = top;
    if (symbol->is_assigned) {
        *symbol->value = lower_variables(l, at, symbol->type, 0, symbol->name, STORAGE_UNSAID);
        enum global_source source =
            l->ir->kind == SHADER_KIND_SURFACE ? symbol->global->surface : symbol->global->light;
        if (source != GLOBAL_RESULT)
            lower_assign(l, at, symbol->value, &value);
        for (struct ir_variable *v = start->variables, *next; v;
             v = next) { /* copies made just now */
            next = v->next_in_home;
            if (v->home == start) {
                v->home = top;
                v->next_in_home = top->variables;
                top->variables = v;
            }
        }
    } else {
        *symbol->value = value;
    }
    for (struct ir_node *node = start->first; node; node = node->next)
        node->list = top;
    if (start->first) {
        start->last->next = top->first;
        if (!top->first)
            top->last = start->last;
        top->first = start->first;
    }
    l->list = list;
    l->scope = scope;
    return symbol->value;
}

struct ir_value *lower_symbol(struct lowering *l, struct ast_symbol *symbol,
                              const struct source_location *at) {
    if (!symbol->global) {
        if (!symbol->value) { /* a nested function's view of something not yet declared */
            symbol->value = compilation_get(l->c, sizeof *symbol->value);
            *symbol->value = lower_variables(l, at, symbol->type,
                                             symbol->array_length < 0 ? 1 : symbol->array_length,
                                             symbol->name, symbol->storage);
        }
        return symbol->value;
    }
    if (l->ir->kind == SHADER_KIND_SURFACE && symbol->global->surface == GLOBAL_LIGHT) {
        struct ir_value *value = symbol->type == TYPE_COLOR ? &l->light_color : &l->light_direction;
        if (!value->count) {
            compile_error(l->c, lower_at(l, at), "%s has a value only inside illuminance",
                          symbol->name);
            *value = lower_constant(0, 3);
        }
        return value;
    }
    return symbol->value ? symbol->value : lower_global(l, symbol, at);
}

/* if (given) p = bound else p = default. In an instance that binds it, a parameter declared varying
 * is loaded into pixel memory; others are uniform. */
static void lower_bound_parameter(struct lowering *l, struct ast_symbol *symbol,
                                  struct shader_parameter *parameter) {
    int width = ast_type_width(symbol->type), length = symbol->array_length;
    bool is_string = symbol->type == TYPE_STRING;
    struct ir_value value =
        lower_variables(l, &symbol->at, symbol->type, length, symbol->name, STORAGE_UNIFORM);
    struct ir_operand given = load(l, &symbol->at, IR_GIVEN, parameter, 0);
    struct ir_node *node = lower_control(l, NODE_IF, &symbol->at);
    struct ir_list *list = l->list, *scope = l->scope;
    node->condition = given;
    node->otherwise = ir_list_new(l->ir, node);
    l->list = l->scope = node->body;
    for (int i = 0; i < (length ? length : 1) * width; i++) {
        struct ir_operand bound =
            load(l, &symbol->at, is_string ? IR_BOUND_STRING : IR_BOUND, parameter, i);
        struct ir_variable *to = value.part[i % width].variable;
        if (!length) {
            lower_move(l, &symbol->at, to, bound);
            continue;
        }
        struct ir_node *store = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, &symbol->at);
        store->operation = IR_ARRAY_STORE;
        store->array = to;
        store->operands[0] = ir_float((float)(i / width));
        store->operands[1] = bound;
    }
    l->list = l->scope = node->otherwise;
    l->in_default = true;
    if (symbol->initial) {
        struct ir_value initial = lower_expression(l, symbol->initial);
        lower_assign(l, &symbol->initial->at, &value, &initial);
    } else if (is_string && !length) {
        lower_move(l, &symbol->at, value.part[0].variable, ir_string(shader_string_identity("")));
    }
    int element = 0;
    for (struct ast_expression *e = symbol->elements; e; e = e->next, element++) {
        struct ir_value initial = lower_expression(l, e);
        for (int i = 0; i < width; i++) {
            struct ir_node *store = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, &e->at);
            store->operation = IR_ARRAY_STORE;
            store->array = value.part[i].variable;
            store->operands[0] = ir_float((float)element);
            store->operands[1] = initial.part[initial.count == 1 ? 0 : i];
        }
    }
    l->in_default = false;
    l->list = list;
    l->scope = scope;
    *symbol->value = value;
    if (!parameter->is_varying || length || is_string)
        return;
    *symbol->value =
        lower_variables(l, &symbol->at, symbol->type, 0, symbol->name, STORAGE_VARYING);
    lower_assign(l, &symbol->at, symbol->value, &value);
}

static void lower_material_parameter(struct lowering *l, struct ast_symbol *symbol,
                                     struct shader_parameter *parameter) {
    int width = ast_type_width(symbol->type), length = symbol->array_length;
    if (!length) {
        *symbol->value = load_all(l, &symbol->at, IR_MATERIAL, parameter, width);
        if (symbol->is_assigned) {
            struct ir_value loaded = *symbol->value;
            *symbol->value =
                lower_variables(l, &symbol->at, symbol->type, 0, symbol->name, STORAGE_VARYING);
            lower_assign(l, &symbol->at, symbol->value, &loaded);
        }
        return;
    }
    *symbol->value =
        lower_variables(l, &symbol->at, symbol->type, length, symbol->name, STORAGE_VARYING);
    for (int i = 0; i < length * width; i++) {
        struct ir_operand loaded = load(l, &symbol->at, IR_MATERIAL, parameter, i);
        struct ir_node *store = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, &symbol->at);
        store->operation = IR_ARRAY_STORE;
        store->array = symbol->value->part[i % width].variable;
        store->operands[0] = ir_float((float)(i / width));
        store->operands[1] = loaded;
        store->is_free = true;
    }
}

static struct shader_parameter *add_parameter(struct lowering *l, const char *name,
                                              enum ast_type type, int array_length,
                                              const struct source_location *at) {
    struct shader_program *program = l->c->program;
    struct shader_parameter *parameter = &program->parameters[program->parameter_count++];
    *parameter = (struct shader_parameter){
        .name = arena_copy_string(&program->arena, name, strlen(name)),
        .type = (enum shader_type)type,
        .array_length = array_length,
        .components = ast_type_width(type) * (array_length ? array_length : 1),
        .map_offset = -1,
        .bound_offset = -1,
        .line = at ? at->line : 0,
        .column = at ? at->column : 0,
    };
    if (!parameter->name)
        compile_limit(l->c, at, "the shader needs more memory than the compiler may use");
    return parameter;
}

/* Makes the table of parameters and of all predefined variables that could be in a transfer map;
 * bind_parameters.c drops those the shader does not read. */
void lower_parameters(struct lowering *l, struct ast_function *shader) {
    struct shader_program *program = l->c->program;
    program->parameters =
        arena_get(&program->arena,
                  sizeof *program->parameters * (size_t)(shader->formal_count + global_count));
    if (!program->parameters)
        compile_limit(l->c, &shader->at, "the shader needs more memory than the compiler may use");
    for (struct ast_symbol *symbol = shader->formals; symbol; symbol = symbol->next) {
        struct shader_parameter *parameter =
            add_parameter(l, symbol->name, symbol->type, symbol->array_length, &symbol->at);
        parameter->is_uniform_declared = symbol->storage == STORAGE_UNIFORM;
        parameter->is_material = is_material(l, symbol->name);
        parameter->is_varying = parameter->is_material || symbol->storage == STORAGE_VARYING;
        if (parameter->is_material &&
            (parameter->is_uniform_declared || symbol->type == TYPE_STRING)) {
            compile_error(l->c, &symbol->at, "'%.64s' comes with the primitives, but is %s",
                          symbol->name,
                          symbol->type == TYPE_STRING ? "a string" : "declared uniform");
            parameter->is_material = parameter->is_varying = false;
        }
    }
    for (int i = 0; i < global_count && l->ir->kind == SHADER_KIND_SURFACE; i++) {
        if (globals[i].surface != GLOBAL_MATERIAL && globals[i].surface != GLOBAL_BOUND)
            continue;
        bool is_hidden = lower_find_parameter(l, globals[i].name) != NULL;
        if (is_hidden)
            continue;
        struct shader_parameter *parameter =
            add_parameter(l, globals[i].name, globals[i].type, 0, NULL);
        parameter->is_global = true;
        parameter->is_material =
            globals[i].surface == GLOBAL_MATERIAL || is_material(l, globals[i].name);
        parameter->is_varying = parameter->is_material;
    }
    struct shader_parameter *parameter = program->parameters;
    for (struct ast_symbol *symbol = shader->formals; symbol; symbol = symbol->next, parameter++) {
        symbol->value = compilation_get(l->c, sizeof *symbol->value);
        if (parameter->is_material)
            lower_material_parameter(l, symbol, parameter);
        else
            lower_bound_parameter(l, symbol, parameter);
    }
}
