/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <string.h>

/* The entry of a predefined variable. */
static struct shader_parameter *find_global(struct lowering *l, const char *name) {
    struct shader_program *program = l->c->program;
    for (int i = 0; i < program->parameter_count; i++)
        if (program->parameters[i].is_global && !strcmp(program->parameters[i].name, name))
            return &program->parameters[i];
    return NULL;
}

/* The entries of a shader's parameters lie side by side, in their order. */
static struct shader_parameter *first_parameter(struct lowering *l, enum shader_kind kind) {
    struct shader_parameter *parameter = l->c->program->parameters;
    while (parameter->shader != kind)
        parameter++;
    return parameter;
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

static struct ir_value lower_uv_step(struct lowering *l, const struct ast_global *global,
                                     const struct source_location *at) {
    const struct ast_global *of = global_find(global->name + 1);
    struct ir_value value = {.count = 1};
    value.part[0] = lower_sample_step(l, at, lower_global(l, of, at)->part[0]);
    return value;
}

static struct ir_value global_value(struct lowering *l, const struct ast_global *global,
                                    const struct source_location *at) {
    int count = ast_type_width(global->type);
    struct ir_value zero = lower_constant(0, 3), axis = zero;
    struct ir_operand from = lower_space(l, at, "shader"), to = ir_string(SHADER_SPACE_CURRENT);
    axis.part[2] = ir_float(1);
    switch (global_source_in(global, l->kind)) {
    case GLOBAL_MATERIAL:
        return load_all(l, at, IR_MATERIAL, find_global(l, global->name), count);
    case GLOBAL_BOUND:
        return bound_global(l, at, find_global(l, global->name));
    case GLOBAL_RESULT: /* an imager starts with the picture */
        if (l->kind == SHADER_KIND_IMAGER)
            return load_all(l, at, IR_MATERIAL, find_global(l, global->name), count);
        return lower_constant(0, count);
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
    case GLOBAL_STEP:
        return lower_uv_step(l, global, at);
    default:
        return lower_constant(0, count);
    }
}

/* Variables declared in `start` move to the top level. */
static void move_variables(struct ir_list *start, struct ir_list *top) {
    for (struct ir_variable *v = start->variables, *next; v; v = next) {
        next = v->next_in_home;
        v->home = top;
        v->next_in_home = top->variables;
        top->variables = v;
    }
    start->variables = NULL;
}

/* Loaded once at the very start, after those loaded before, whatever control flow asks for it
 * first. Only what a shader assigns to needs variables of its own. */
struct ir_value *lower_global(struct lowering *l, const struct ast_global *global,
                              const struct source_location *at) {
    struct ir_value **slot = &l->global_values[global - globals];
    if (*slot)
        return *slot;
    struct ir_list *list = l->list, *scope = l->scope, *top = l->ir->top;
    struct ir_list *start = ir_list_new(l->ir, NULL);
    l->list = l->scope = start;
    struct ir_value value = global_value(l, global, at);
    struct ir_value *result = compilation_get(l->c, sizeof *result);
    *result = value;
    if (l->global_is_assigned[global - globals]) {
        *result = lower_variables(l, at, global->type, 0, global->name, STORAGE_UNSAID);
        bool starts_at_zero =
            global_source_in(global, l->kind) == GLOBAL_RESULT && l->kind != SHADER_KIND_IMAGER;
        if (!starts_at_zero)
            lower_assign(l, at, result, &value);
    }
    move_variables(start, top);
    for (struct ir_node *node = start->first; node; node = node->next)
        node->list = top;
    if (start->first) {
        struct ir_node **link = l->loads_end ? &l->loads_end->next : &top->first;
        start->last->next = *link;
        if (!*link)
            top->last = start->last;
        *link = start->first;
        l->loads_end = start->last;
    }
    l->list = list;
    l->scope = scope;
    return *slot = result;
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
    if (global_source_in(symbol->global, l->kind) == GLOBAL_LIGHT) {
        struct ir_value *value = symbol->type == TYPE_COLOR ? &l->light_color : &l->light_direction;
        if (!value->count) {
            compile_error(l->c, lower_at(l, at), "%s has a value only inside illuminance",
                          symbol->name);
            *value = lower_constant(0, 3);
        }
        return value;
    }
    return lower_global(l, symbol->global, at);
}

static void store_component(struct lowering *l, const struct source_location *at,
                            const struct ir_value *value, int width, int i, struct ir_operand from,
                            bool is_free) {
    struct ir_node *store;
    if (value->strings || !value->array_length) {
        lower_move(l, at, (value->strings ? value->strings : value->part)[i].variable, from);
        return;
    }
    store = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, at);
    store->operation = IR_ARRAY_STORE;
    store->array = value->part[i % width].variable;
    store->operands[0] = ir_float((float)(i / width));
    store->operands[1] = from;
    store->is_free = is_free;
}

static void lower_default(struct lowering *l, struct ast_symbol *symbol,
                          const struct ir_value *value) {
    int element = 0,
        strings = symbol->type == TYPE_STRING ? symbol->array_length ? symbol->array_length : 1 : 0;
    l->in_default = true;
    for (int i = 0; i < strings; i++)
        store_component(l, &symbol->at, value, 1, i, ir_string(shader_string_identity("")), false);
    if (symbol->initial) {
        struct ir_value initial = lower_expression(l, symbol->initial);
        if (symbol->array_length)
            lower_array_convert(l, &symbol->initial->at, symbol->type, value, symbol->array_length,
                                symbol->initial->type, &initial);
        else
            lower_assign(l, &symbol->initial->at, value, &initial);
    }
    for (struct ast_expression *e = symbol->elements; e; e = e->next, element++) {
        struct ir_value initial = lower_expression(l, e);
        lower_array_store(l, &e->at, symbol->type, value, ir_float((float)element), &initial);
    }
    l->in_default = false;
}

/* A parameter that the shader changes, or that is declared varying, gets memory of its own. */
static void copy_parameter(struct lowering *l, struct ast_symbol *symbol,
                           enum ast_storage storage) {
    struct ir_value loaded = *symbol->value;
    *symbol->value =
        lower_variables(l, &symbol->at, symbol->type, symbol->array_length, symbol->name, storage);
    if (symbol->array_length)
        lower_array_copy(l, &symbol->at, symbol->type, symbol->value, &loaded,
                         symbol->array_length);
    else
        lower_assign(l, &symbol->at, symbol->value, &loaded);
}

/* What comes from outside as a float and is fixed-point inside: nothing is charged for a parameter
 * that lies in the transfer map in its own format. */
static struct ir_operand into_format(struct lowering *l, const struct source_location *at,
                                     enum ast_type type, struct ir_operand value) {
    if (!ast_type_is_fixed(type))
        return value;
    value = lower_fixed_convert(l, at, value, type);
    l->list->last->is_free = true;
    return value;
}

static struct ir_value read_triple(struct lowering *l, const struct ast_symbol *symbol,
                                   const struct ir_value *array) {
    struct ir_value value = {.count = 3};
    for (int i = 0; i < 3; i++) {
        value.part[i] =
            lower_array_load(l, &symbol->at, symbol->type, array, ir_float((float)i)).part[0];
        if (ast_type_is_fixed(symbol->type))
            value.part[i] = lower_fixed_convert(l, &symbol->at, value.part[i], TYPE_FLOAT);
    }
    return value;
}

/* A default value with a transformation attribute is in shader space (PF section 3.1). */
static void transform_default(struct lowering *l, const struct ast_symbol *symbol,
                              const struct ir_value *array) {
    static const enum ast_type types[] = {[TRANSFORM_POINT] = TYPE_POINT,
                                          [TRANSFORM_VECTOR] = TYPE_VECTOR,
                                          [TRANSFORM_NORMAL] = TYPE_NORMAL};
    if (symbol->transform == TRANSFORM_NONE || symbol->transform == TRANSFORM_TEXTURE)
        return;
    struct ir_operand from = ir_string(SHADER_SPACE_SHADER), to = ir_string(SHADER_SPACE_CURRENT);
    struct ir_value value = read_triple(l, symbol, array);
    value = lower_transform(l, &symbol->at, types[symbol->transform], &from, &to, &value);
    lower_array_convert(l, &symbol->at, symbol->type, array, 3, TYPE_VECTOR, &value);
}

static void make_unit(struct lowering *l, const struct ast_symbol *symbol,
                      const struct ir_value *array) {
    if (!symbol->is_unit)
        return;
    struct ir_value value = read_triple(l, symbol, array);
    value = lower_normalize(l, &symbol->at, &value);
    lower_array_convert(l, &symbol->at, symbol->type, array, 3, TYPE_VECTOR, &value);
}

/* if (given) p = bound else p = default. In an instance that binds it, a parameter declared varying
 * is loaded into pixel memory; others are uniform. */
static void lower_bound_parameter(struct lowering *l, struct ast_symbol *symbol,
                                  struct shader_parameter *parameter) {
    bool is_string = symbol->type == TYPE_STRING;
    int width = ast_type_width(symbol->type);
    struct ir_value value = lower_variables(l, &symbol->at, symbol->type, symbol->array_length,
                                            symbol->name, STORAGE_UNIFORM);
    struct ir_operand given = load(l, &symbol->at, IR_GIVEN, parameter, 0);
    struct ir_node *node = lower_control(l, NODE_IF, &symbol->at);
    struct ir_list *list = l->list, *scope = l->scope;
    node->condition = given;
    node->otherwise = ir_list_new(l->ir, node);
    l->list = l->scope = node->body;
    for (int i = 0; i < parameter->components; i++) {
        struct ir_operand bound =
            load(l, &symbol->at, is_string ? IR_BOUND_STRING : IR_BOUND, parameter, i);
        bound = into_format(l, &symbol->at, symbol->type, bound);
        store_component(l, &symbol->at, &value, width, i, bound, false);
    }
    l->list = l->scope = node->otherwise;
    lower_default(l, symbol, &value);
    transform_default(l, symbol, &value);
    l->list = list;
    l->scope = scope;
    make_unit(l, symbol, &value);
    *symbol->value = value;
    if (is_string && symbol->is_assigned) {
        copy_parameter(l, symbol, STORAGE_UNIFORM);
    } else if (!is_string && parameter->is_varying && !symbol->array_length) {
        for (int i = 0; i < value.count; i++)
            value.part[i].variable->is_loaded = !value.array_length;
        copy_parameter(l, symbol, STORAGE_VARYING);
    } else if (!is_string && symbol->is_assigned) {
        copy_parameter(l, symbol, symbol->storage);
    }
}

static void lower_material_parameter(struct lowering *l, struct ast_symbol *symbol,
                                     struct shader_parameter *parameter) {
    int width = ast_type_width(symbol->type);
    if (!symbol->array_length && symbol->type != TYPE_MATRIX) {
        *symbol->value = load_all(l, &symbol->at, IR_MATERIAL, parameter, width);
        for (int i = 0; i < width; i++)
            symbol->value->part[i] =
                into_format(l, &symbol->at, symbol->type, symbol->value->part[i]);
        if (symbol->is_assigned)
            copy_parameter(l, symbol, STORAGE_VARYING);
        return;
    }
    *symbol->value = lower_variables(l, &symbol->at, symbol->type, symbol->array_length,
                                     symbol->name, STORAGE_VARYING);
    for (int i = 0; i < parameter->components; i++) {
        struct ir_operand loaded = load(l, &symbol->at, IR_MATERIAL, parameter, i);
        loaded = into_format(l, &symbol->at, symbol->type, loaded);
        store_component(l, &symbol->at, symbol->value, width, i, loaded, true);
    }
    make_unit(l, symbol, symbol->value);
}

static struct shader_parameter *add_parameter(struct lowering *l, const char *name,
                                              enum ast_type type, int array_length,
                                              const struct source_location *at) {
    struct shader_program *program = l->c->program;
    struct shader_parameter *parameter = &program->parameters[program->parameter_count++];
    const int components =
        (ast_type_is_fixed(type) ? 1 : shader_type_components((enum shader_type)type)) *
        (array_length ? array_length : 1);
    *parameter = (struct shader_parameter){
        .name = arena_copy_string(&program->arena, name, strlen(name)),
        .type = ast_type_is_fixed(type) ? SHADER_FIXED : (enum shader_type)type,
        .format = ast_type_is_fixed(type) ? ast_type_format(type) : (struct fixed_format){0},
        .array_length = array_length,
        .components = components,
        .bytes = components * (ast_type_is_fixed(type) ? fixed_bytes(ast_type_format(type)) : 4),
        .map_offset = -1,
        .map_byte = -1,
        .bound_offset = -1,
        .line = at ? at->line : 0,
        .column = at ? at->column : 0,
    };
    if (!parameter->name)
        compile_limit(l->c, at, "the shader needs more memory than the compiler may use");
    return parameter;
}

static void add_parameters(struct lowering *l, const struct ast_unit *unit) {
    for (struct ast_symbol *symbol = unit->shader->formals; symbol; symbol = symbol->next) {
        struct shader_parameter *parameter =
            add_parameter(l, symbol->name, symbol->type, symbol->array_length, &symbol->at);
        parameter->shader = unit->kind;
        parameter->is_output = symbol->is_output;
        parameter->is_uniform_declared = symbol->storage == STORAGE_UNIFORM;
        parameter->transform = (enum shader_transform)symbol->transform;
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
}

void lower_parameter_table(struct lowering *l, const struct checked_unit *units, int count) {
    struct shader_program *program = l->c->program;
    size_t capacity = (size_t)global_count + OPTIONS_MAX;
    for (int i = 0; i < count; i++)
        capacity += (size_t)units[i].unit->shader->formal_count;
    program->parameters = arena_get(&program->arena, sizeof *program->parameters * capacity);
    if (!program->parameters)
        compile_limit(l->c, &units[0].unit->shader->at,
                      "the shader needs more memory than the compiler may use");
    for (int i = 0; i < count; i++)
        add_parameters(l, units[i].unit);
    for (int i = 0; i < global_count; i++) {
        enum global_source source = global_source_in(&globals[i], l->ir->kind);
        bool is_picture = l->ir->kind == SHADER_KIND_IMAGER && source == GLOBAL_RESULT;
        if (source != GLOBAL_MATERIAL && source != GLOBAL_BOUND && !is_picture)
            continue;
        struct shader_parameter *parameter =
            add_parameter(l, globals[i].name, globals[i].type, 0, NULL);
        parameter->shader = l->ir->kind;
        parameter->is_global = true;
        parameter->is_material = source != GLOBAL_BOUND || is_material(l, globals[i].name);
        parameter->is_varying = parameter->is_material;
    }
    lower_question_table(l);
}

void lower_parameters(struct lowering *l, struct ast_function *shader) {
    struct shader_parameter *parameter = shader->formals ? first_parameter(l, l->kind) : NULL;
    for (struct ast_symbol *symbol = shader->formals; symbol; symbol = symbol->next, parameter++) {
        symbol->value = compilation_get(l->c, sizeof *symbol->value);
        if (parameter->is_material)
            lower_material_parameter(l, symbol, parameter);
        else
            lower_bound_parameter(l, symbol, parameter);
    }
}

void lower_add_option(struct lowering *l, const char *name, int length) {
    struct shader_parameter *parameter = add_parameter(l, name, TYPE_FLOAT, length, NULL);
    parameter->shader = l->ir->kind;
    parameter->is_global = parameter->is_uniform_declared = true;
}

struct ir_operand lower_load_option(struct lowering *l, const struct source_location *at,
                                    const char *name, int index) {
    return load(l, at, index < 0 ? IR_GIVEN : IR_BOUND, find_global(l, name),
                index < 0 ? 0 : index);
}
