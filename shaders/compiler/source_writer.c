/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/builtins.h"
#include "shaders/compiler/fixing.h"
#include "shaders/compiler/passes.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The IR as a shader in the language again: one that computes the same, with variables of the types
 * that are asked for (shader_compile_options.fixings). Functions are inlined and vectors taken
 * apart by then. What is used once is written where it is used, and each statement stands under the
 * line of the original that it comes from. */

enum { INLINED_WEIGHT_MAX = 6, LINE_SHOWN_MAX = 100 };

void source_refuse(struct source_writer *w, const struct ir_node *node, const char *what) {
    compile_error(w->ir->c, node->at, "this cannot be written as source with other types: %s",
                  what);
    compilation_stop(w->ir->c);
}

struct written *source_variable(struct source_writer *w, const struct ir_variable *variable) {
    return &w->variables[variable->id];
}

bool source_is_inlined(struct source_writer *w, const struct ir_variable *variable) {
    return w->variables[variable->id].weight > 0;
}

static void put(struct source_writer *w, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void put(struct source_writer *w, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const size_t length = (size_t)vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (w->length + length + 1 > w->capacity) {
        w->capacity = 2 * (w->length + length + 4096);
        char *grown = compilation_get(w->ir->c, w->capacity);
        if (w->length)
            memcpy(grown, w->text, w->length);
        w->text = grown;
    }
    vsnprintf(w->text + w->length, length + 1, format, again);
    va_end(again);
    w->length += length;
}

static void begin_line(struct source_writer *w) {
    put(w, "%*s", 4 * w->indent, "");
}

/* --- What is known of variables before anything is written. --- */

static void count_use(struct source_writer *w, const struct ir_operand *operand,
                      struct ir_list *list) {
    if (operand->kind != OPERAND_VARIABLE)
        return;
    struct written *known = source_variable(w, operand->variable);
    known->uses++;
    known->used_in = list;
}

static void count_node(struct ir_node *node, void *context) {
    struct source_writer *w = context;
    if (node->is_shared)
        source_refuse(w, node, "code that shaders share (shared_phong)");
    if (node->kind != NODE_INSTRUCTION) {
        count_use(w, &node->condition, node->kind == NODE_LOOP ? node->test : node->list);
        return;
    }
    if (ir_operation_is_fixed(node->operation))
        source_refuse(w, node, "it has fixed-point numbers already");
    for (int i = 0; i < ir_operand_count(node->operation); i++)
        count_use(w, &node->operands[i], node->list);
    for (int r = 0; r < 3; r++)
        if (node->results[r]) {
            source_variable(w, node->results[r])->definitions++;
            source_variable(w, node->results[r])->definition = node;
        }
}

static bool is_given(struct source_writer *w, const struct ir_operand *operand) {
    return operand->kind == OPERAND_VARIABLE && source_variable(w, operand->variable)->is_given;
}

static int count_definitions(const struct ir_list *list, const struct ir_variable *v) {
    int count = 0;
    for (const struct ir_node *node = list ? list->first : NULL; node; node = node->next)
        count += node->kind == NODE_INSTRUCTION && node->results[0] == v;
    return count;
}

/* Values of parameters, by whichever name the IR has for them: if (given) x = BOUND ... */
static void note_parameters(struct source_writer *w, const struct ir_node *branch) {
    for (const struct ir_node *node = branch->body->first; node; node = node->next) {
        const struct ir_variable *v = node->kind == NODE_INSTRUCTION ? node->results[0] : NULL;
        if (v && source_variable(w, v)->definitions !=
                     count_definitions(branch->body, v) + count_definitions(branch->otherwise, v))
            source_refuse(w, node, "a parameter that is assigned to");
    }
    for (const struct ir_node *node = branch->body->first; node; node = node->next) {
        if (node->kind == NODE_INSTRUCTION && node->operation == IR_ARRAY_STORE)
            source_refuse(w, node, "a parameter that is an array indexed at run time");
        if (node->kind == NODE_INSTRUCTION && node->operation == IR_BOUND && node->results[0])
            source_variable(w, node->results[0])->alias =
                source_component(w, node->parameter, node->index);
        if (node->kind == NODE_INSTRUCTION && node->operation == IR_BOUND_STRING)
            source_variable(w, node->results[0])->alias = node->parameter->name;
        if (node->kind == NODE_INSTRUCTION && ir_is_move(node) &&
            node->operands[0].kind == OPERAND_VARIABLE)
            source_variable(w, node->results[0])->alias =
                source_variable(w, node->operands[0].variable)->alias;
    }
}

static bool can_be_fixed(struct source_writer *w, const struct ir_variable *v) {
    const struct ir_node *definition = source_variable(w, v)->definition;
    return v->type == IR_FLOAT && v->is_varying && !v->array_length && definition &&
           definition->operation != IR_LIGHT_DIRECTION;
}

static bool is_fixed_wanted(struct source_writer *w, const struct ir_variable *v) {
    const struct shader_compile_options *options = w->ir->c->options;
    return can_be_fixed(w, v) && v->id < options->fixing_count && options->fixings[v->id].is_seen &&
           options->fixings[v->id].size > 0;
}

static bool is_predefined(const struct ir_node *node) {
    return node->operation == IR_MATERIAL || node->operation == IR_BOUND ||
           node->operation == IR_POSITION || node->operation == IR_INCIDENT ||
           node->operation == IR_LIGHT_COLOR;
}

/* What needs no variable: predefined ones and L, as long as they stay floats. */
static void note_alias(struct source_writer *w, const struct ir_node *node) {
    struct written *known = source_variable(w, node->results[0]);
    const struct ir_operand *a = &node->operands[0];
    if (known->is_fixed || known->definitions != 1 || !ir_variable_is_settled(node->results[0]))
        return;
    if (is_predefined(node))
        known->alias = source_expression(w, node).text;
    if (node->operation == IR_SELECT && is_given(w, a) &&
        node->operands[1].kind == OPERAND_VARIABLE)
        known->alias = source_variable(w, node->operands[1].variable)->alias;
    if (source_is_towards_light(w, node))
        known->alias = source_expression(w, node).text;
}

/* Whether the operands mean the same wherever the list of `node` sees them. */
static bool is_settled(struct source_writer *w, const struct ir_node *node) {
    for (int i = 0; i < ir_operand_count(node->operation); i++) {
        const struct ir_operand *operand = &node->operands[i];
        if (operand->kind == OPERAND_VARIABLE && !source_variable(w, operand->variable)->alias &&
            !ir_variable_is_settled(operand->variable))
            return false;
    }
    return true;
}

static bool has_condition_operand(const struct ir_node *node) {
    for (int i = 0; i < ir_operand_count(node->operation); i++)
        if (ir_operand_type(&node->operands[i]) == IR_BOOL)
            return true;
    return false;
}

/* The variable of the user that this one is, or that is a copy of it; NULL for a temporary. */
static const struct ir_variable *users_variable(const struct ir_variable *v) {
    return v->name ? v : v->called && v->called->name ? v->called : NULL;
}

/* How many operations the variable stands for where it is written in place, 0 when it is a variable
 * of its own. Conditions have no type in the language: those that are only compared are written
 * again and again, and computed once all the same (common_subexpressions.c). */
static void weigh(struct source_writer *w, const struct ir_node *node) {
    struct ir_variable *v = node->results[0];
    struct written *known = v ? source_variable(w, v) : NULL;
    if (!v || users_variable(v) || known->alias || known->definitions != 1 ||
        !ir_variable_is_settled(v) || !ir_operation_is_pure(node->operation) ||
        ir_operations[node->operation].types[0] == '3' || !is_settled(w, node))
        return;
    if (v->type == IR_BOOL ? known->uses > 1 && has_condition_operand(node)
                           : known->uses > 1 || known->used_in != node->list)
        return;
    int weight = 1;
    for (int i = 0; i < ir_operand_count(node->operation); i++)
        if (node->operands[i].kind == OPERAND_VARIABLE)
            weight += source_variable(w, node->operands[i].variable)->weight;
    known->weight = weight <= INLINED_WEIGHT_MAX || v->type == IR_BOOL ? weight : 0;
}

static void note_node(struct ir_node *node, void *context) {
    struct source_writer *w = context;
    if (node->kind == NODE_IF && is_given(w, &node->condition))
        note_parameters(w, node);
    if (node->kind != NODE_INSTRUCTION)
        return;
    for (int r = 0; r < 3; r++)
        if (node->results[r] && is_fixed_wanted(w, node->results[r])) {
            struct written *known = source_variable(w, node->results[r]);
            known->is_fixed = true;
            known->format = fixing_format(w->ranges[node->results[r]->id],
                                          w->ir->c->options->fixings[node->results[r]->id].size);
        }
    if (node->operation == IR_GIVEN)
        source_variable(w, node->results[0])->is_given = true;
    if (!node->results[0])
        return;
    note_alias(w, node);
    weigh(w, node);
}

/* --- Names. --- */

static bool is_taken(const struct source_writer *w, const char *name) {
    const struct shader_program *program = w->ir->c->program;
    for (int i = 0; i < program->parameter_count; i++)
        if (!strcmp(program->parameters[i].name, name))
            return true;
    for (size_t i = 0; i < w->name_count; i++)
        if (!strcmp(w->names[i], name))
            return true;
    return global_find(name) != NULL;
}

static const char *new_name(struct source_writer *w, const char *base) {
    const char *name = base;
    int number = 1;
    for (size_t i = w->name_count; i-- > 0 && number == 1;) /* from the last of this name on */
        if (w->bases[i] == base || !strcmp(w->bases[i], base))
            number = w->numbers[i];
    while (is_taken(w, name))
        name = source_format(w, "%s_%d", base, ++number);
    if (w->name_count == w->name_capacity) {
        w->name_capacity = w->name_capacity ? 2 * w->name_capacity : 64;
        const size_t bytes = w->name_capacity * sizeof(char *);
        const char **names = compilation_get(w->ir->c, bytes),
                   **bases = compilation_get(w->ir->c, bytes);
        int *numbers = compilation_get(w->ir->c, w->name_capacity * sizeof *numbers);
        if (w->name_count) {
            memcpy(names, w->names, w->name_count * sizeof *names);
            memcpy(bases, w->bases, w->name_count * sizeof *bases);
            memcpy(numbers, w->numbers, w->name_count * sizeof *numbers);
        }
        w->names = names;
        w->bases = bases;
        w->numbers = numbers;
    }
    w->bases[w->name_count] = base;
    w->numbers[w->name_count] = number;
    return w->names[w->name_count++] = name;
}

/* "N_x" of "xcomp(N)": what an input is called once it is a variable. */
static const char *input_name(struct source_writer *w, const struct ir_node *node) {
    const char *axis = source_format(w, "%c", "xyz"[node->index % 3]);
    switch (node->operation) {
    case IR_MATERIAL:
        return node->parameter->components == 1
                   ? source_format(w, "fixed_%s", node->parameter->name)
                   : source_format(w, "%s_%s", node->parameter->name, axis);
    case IR_POSITION:
        return source_format(w, "P_%s", axis);
    case IR_INCIDENT:
        return source_format(w, "I_%s", axis);
    case IR_LIGHT_DIRECTION:
        return source_format(w, "from_light_%s", axis);
    case IR_LIGHT_COLOR:
        return source_format(w, "light_%c", "rgb"[node->index % 3]);
    case IR_AMBIENT:
        return source_format(w, "ambient_%c", "rgb"[node->index % 3]);
    default:
        return NULL;
    }
}

/* Components of one variable of the user have numbers in a row. */
static const char *component_name(struct source_writer *w, const struct ir_variable *v) {
    const struct ir_program *ir = w->ir;
    int first = v->id, last = v->id;
    while (first > 0 && ir->variables[first - 1]->name == v->name)
        first--;
    while (last + 1 < (int)ir->variable_count && ir->variables[last + 1]->name == v->name)
        last++;
    if (last - first != 2)
        return v->name;
    return source_format(w, "%s_%c", v->name, "xyz"[v->id - first]);
}

static const char *name_of(struct source_writer *w, const struct ir_variable *v) {
    struct written *known = source_variable(w, v);
    if (known->name)
        return known->name;
    const char *base = users_variable(v) ? component_name(w, users_variable(v))
                       : known->definitions == 1 && known->definition
                           ? input_name(w, known->definition)
                           : NULL;
    if (!base)
        base = source_format(w, "t%d", ++w->temporaries);
    return known->name = new_name(w, base);
}

static const char *type_of(struct source_writer *w, const struct ir_variable *v) {
    char name[32];
    const struct written *known = source_variable(w, v);
    if (v->type == IR_BOOL)
        return "unsigned fixed<1,0>";
    if (v->type != IR_FLOAT)
        source_refuse(w, known->definition, "a string that is computed");
    if (known->is_fixed)
        return source_format(w, "%s", fixed_format_name(known->format, name));
    return v->is_varying || v->is_demoted ? "float" : "uniform float";
}

/* --- Statements. --- */

/* The line of the original that a statement comes from, as a comment. */
static void show_line(struct source_writer *w, const struct ir_node *node) {
    const struct source_location *at = node->at, *shader = w->ir->c->shader_at;
    if (!at || at->file != shader->file || at->line == w->line || !at->line_text)
        return;
    w->line = at->line;
    const char *text = at->line_text + strspn(at->line_text, " \t");
    int length = (int)strcspn(text, "\r\n");
    if (length > LINE_SHOWN_MAX)
        length = LINE_SHOWN_MAX;
    const char *line = source_format(w, "%.*s", length, text);
    begin_line(w);
    if (!length || strstr(line, "*/") || strstr(line, "/*"))
        put(w, "/* %d */\n", at->line);
    else
        put(w, "/* %d: %s */\n", at->line, line);
}

static bool is_declared_there(struct source_writer *w, const struct ir_variable *v) {
    const struct written *known = source_variable(w, v);
    return known->definitions == 1 && known->definition->list == v->home &&
           ir_variable_is_settled(v) && !known->is_early;
}

static void write_assignment(struct source_writer *w, const struct ir_node *node,
                             const struct ir_variable *v, const char *text) {
    show_line(w, node);
    begin_line(w);
    if (!source_variable(w, v)->name)
        put(w, "%s ", type_of(w, v));
    put(w, "%s = %s;\n", name_of(w, v), text);
}

/* Three results: a color, of which each is a component. */
static void write_triple(struct source_writer *w, const struct ir_node *node) {
    const struct piece value = source_expression(w, node);
    const char *name = new_name(w, source_format(w, "t%d", ++w->temporaries));
    show_line(w, node);
    begin_line(w);
    put(w, "color %s = %s;\n", name, value.text);
    for (int i = 0; i < 3; i++)
        if (node->results[i])
            write_assignment(w, node, node->results[i], source_format(w, "comp(%s, %d)", name, i));
}

static void write_instruction(struct source_writer *w, const struct ir_node *node) {
    const struct ir_variable *v = node->results[0];
    if (node->operation == IR_ARRAY_STORE) {
        const struct piece index = source_float(w, &node->operands[0]),
                           value = source_float(w, &node->operands[1]);
        show_line(w, node);
        begin_line(w);
        put(w, "%s[%s] = %s;\n", name_of(w, node->array), index.text, value.text);
        return;
    }
    if (ir_operations[node->operation].types[0] == '3') {
        write_triple(w, node);
        return;
    }
    if (!v)
        source_refuse(w, node, "an instruction without a result");
    const struct written *known = source_variable(w, v);
    if (known->alias || known->is_given || source_is_inlined(w, v))
        return;
    if (v->type == IR_BOOL) {
        write_assignment(w, node, v, source_instruction_condition(w, node).text);
        return;
    }
    write_assignment(w, node, v, source_expression(w, node).text);
}

static void write_list(struct source_writer *w, const struct ir_list *list);

/* Variables of a list that are assigned more than once, or not where they live. */
static void declare(struct source_writer *w, const struct ir_list *list) {
    for (const struct ir_variable *v = list->variables; v; v = v->next_in_home) {
        const struct written *known = source_variable(w, v);
        if (known->alias || known->is_given || known->name || source_is_inlined(w, v))
            continue;
        if (v->array_length) {
            if (v->type != IR_FLOAT)
                compile_limit(w->ir->c, w->ir->c->shader_at,
                              "arrays of anything but floats cannot be written as source");
            begin_line(w);
            put(w, "float %s[%d];\n", name_of(w, v), v->array_length);
        } else if (known->definitions && !is_declared_there(w, v)) {
            begin_line(w);
            put(w, "%s", type_of(w, v));
            put(w, " %s;\n", name_of(w, v));
        }
    }
}

static void write_block(struct source_writer *w, const struct ir_list *list) {
    put(w, "{\n");
    w->indent++;
    write_list(w, list);
    w->indent--;
    begin_line(w);
    put(w, "}");
}

/* while (condition): what has to be computed for the condition is written before the loop and again
 * at its end. */
static void write_loop(struct source_writer *w, const struct ir_node *node) {
    for (const struct ir_node *inner = node->test->first; inner; inner = inner->next) {
        const struct ir_variable *v = inner->kind == NODE_INSTRUCTION ? inner->results[0] : NULL;
        const bool is_condition =
            v && node->condition.kind == OPERAND_VARIABLE && node->condition.variable == v;
        if (!v || source_variable(w, v)->definitions != 1 || v->home != node->test ||
            (v->is_read_early && !is_condition))
            source_refuse(w, inner, "the condition of a loop that takes more than expressions");
    }
    for (const struct ir_variable *v = node->test->variables; v; v = v->next_in_home)
        source_variable(w, v)->is_early = true;
    declare(w, node->test);
    write_list(w, node->test);
    begin_line(w);
    put(w, "while (%s) {\n", source_condition(w, &node->condition).text);
    w->indent++;
    write_list(w, node->body);
    write_list(w, node->test);
    w->indent--;
    begin_line(w);
    put(w, "}\n");
}

static void write_control(struct source_writer *w, const struct ir_node *node) {
    if (node->kind == NODE_IF && is_given(w, &node->condition))
        return;
    if (node->kind == NODE_LOOP) {
        write_loop(w, node);
        return;
    }
    show_line(w, node);
    if (node->kind == NODE_ILLUMINANCE) {
        if (node->condition.kind != OPERAND_NONE)
            source_refuse(w, node, "lights at another place than P");
        begin_line(w);
        if (node->category >= 0)
            put(w, "illuminance (\"%s\", P) ", w->ir->categories[node->category]);
        else
            put(w, "illuminance (P) ");
        write_block(w, node->body);
        put(w, "\n");
        return;
    }
    const struct piece condition = source_condition(w, &node->condition);
    begin_line(w);
    put(w, "if (%s) ", condition.text);
    write_block(w, node->body);
    if (node->otherwise && node->otherwise->first) {
        put(w, " else ");
        write_block(w, node->otherwise);
    }
    put(w, "\n");
}

static void write_list(struct source_writer *w, const struct ir_list *list) {
    declare(w, list);
    for (const struct ir_node *node = list->first; node; node = node->next)
        if (node->kind == NODE_INSTRUCTION)
            write_instruction(w, node);
        else
            write_control(w, node);
}

/* Past a comment or a string that begins here; the same place when none does. */
static const char *skip_quiet(const char *at) {
    if (at[0] == '/' && at[1] == '*') {
        const char *end = strstr(at + 2, "*/");
        return end ? end + 2 : at + strlen(at);
    }
    if (at[0] == '/' && at[1] == '/')
        return at + strcspn(at, "\n");
    if (*at != '"')
        return at;
    for (at++; *at && *at != '"'; at++)
        at += at[0] == '\\' && at[1];
    return at + (*at == '"');
}

/* From the parenthesis after the shader's name to the one that ends its parameters. */
static const char *parameter_list(struct source_writer *w) {
    const struct source_location *at = w->ir->c->shader_at;
    const char *begin = NULL;
    int depth = 0;
    for (const char *end = at->line_text + at->column - 1; *end && *end != '#' && *end != '{';) {
        const char *next = skip_quiet(end);
        if (next == end) {
            if (*end == '(' && !depth++)
                begin = end;
            if (*end == ')' && !--depth)
                return source_format(w, "%.*s", (int)(end + 1 - begin), begin);
            next++;
        }
        end = next;
    }
    compile_error(w->ir->c, at, "its parameters are not written out here: they cannot be copied");
    compilation_stop(w->ir->c);
}

/* What has the name of something predefined would be taken for it where inlined code means that. */
static void refuse_hidden(struct source_writer *w) {
    const struct shader_program *program = w->ir->c->program;
    for (int i = 0; i < program->parameter_count; i++) {
        const struct shader_parameter *p = &program->parameters[i];
        const struct source_location *shader = w->ir->c->shader_at;
        const struct source_location at = {shader->file, NULL, p->line, p->column};
        if (p->is_global || !global_find(p->name))
            continue;
        compile_error(w->ir->c, &at,
                      "this cannot be written as source with other types: parameter %.64s hides a "
                      "predefined variable",
                      p->name);
        compilation_stop(w->ir->c);
    }
}

static void describe_variables(struct source_writer *w) {
    struct ir_program *ir = w->ir;
    struct shader_program *program = ir->c->program;
    struct shader_variable *all =
        arena_get(&program->arena, (ir->variable_count + 1) * sizeof *all);
    for (size_t i = 0; all && i < ir->variable_count; i++) {
        const char *name = w->variables[i].name ? w->variables[i].name : "";
        all[i].name = arena_copy_string(&program->arena, name, strlen(name));
        all[i].can_be_fixed = ir->variables[i]->is_live && can_be_fixed(w, ir->variables[i]);
        if (!all[i].name)
            all = NULL;
    }
    if (!all)
        compile_limit(ir->c, NULL, "the shader needs more memory than the compiler may use");
    program->variables = all;
    program->variable_count = (int)ir->variable_count;
}

static void describe_node(struct ir_node *node, void *context) {
    struct source_writer *w = context;
    struct shader_variable *all = (struct shader_variable *)w->ir->c->program->variables;
    for (int r = 0; node->kind == NODE_INSTRUCTION && r < 3; r++) {
        if (!node->results[r])
            continue;
        struct shader_variable *v = &all[node->results[r]->id];
        v->line = node->at ? node->at->line : 0;
        v->is_noise = node->operation >= IR_NOISE1 && node->operation <= IR_NOISE3;
        v->format = source_variable(w, node->results[r])->is_fixed
                        ? source_variable(w, node->results[r])->format
                        : fixing_format(w->ranges[node->results[r]->id], 0);
    }
}

void pass_source(struct ir_program *ir) {
    const struct shader_compile_options *options = ir->c->options;
    if (!options || !options->writes_source)
        return;
    if (ir->kind != SHADER_KIND_SURFACE || options->displacement || options->atmosphere)
        compile_error(ir->c, ir->c->shader_at, "only a surface shader by itself can be written");
    if (ir->c->error_count)
        return;
    struct source_writer writer = {.ir = ir, .indent = 1}, *w = &writer;
    refuse_hidden(w);
    w->variables = compilation_get(ir->c, (ir->variable_count + 1) * sizeof *w->variables);
    ir_prepare_propagation(ir);
    w->ranges = fixing_ranges(ir);
    ir_each_node(ir->top, count_node, w);
    ir_each_node(ir->top, note_node, w);
    put(w, "surface %s%s {\n", ir->c->program->name, parameter_list(w));
    write_list(w, ir->top);
    put(w, "    Ci = color (");
    for (int i = 0; i < 3; i++) {
        const struct ir_operand color = ir_of(ir->color[i]);
        put(w, "%s%s", i ? ", " : "", source_float(w, &color).text);
    }
    put(w, ");\n    Oi = 1;\n}\n");
    describe_variables(w);
    ir_each_node(ir->top, describe_node, w);
    ir->c->program->source = arena_copy_string(&ir->c->program->arena, w->text, w->length);
    if (!ir->c->program->source)
        compile_limit(ir->c, NULL, "the shader needs more memory than the compiler may use");
}
