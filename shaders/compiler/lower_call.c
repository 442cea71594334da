/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <stdio.h>
#include <string.h>

static _Noreturn void complain_cycle(struct lowering *l, const struct source_location *at,
                                     const struct ast_function *function) {
    char text[256];
    size_t length = (size_t)snprintf(text, sizeof text, "%.40s", function->name);
    const struct lower_call *calls[64];
    int count = 0;
    for (const struct lower_call *call = l->call; call && count < 64; call = call->caller) {
        calls[count++] = call;
        if (call->function == function)
            break;
    }
    for (int i = count - 2; i >= 0 && length < 180; i--)
        length += (size_t)snprintf(text + length, sizeof text - length, " calls %.40s",
                                   calls[i]->function->name);
    compile_error(l->c, lower_at(l, at),
                  "recursion: %s calls %.40s; functions are inlined and cannot call "
                  "themselves",
                  text, function->name);
    compilation_stop(l->c);
}

/* A formal that is only read stands for the argument itself. Others get variables of their own;
 * those of output formals are copied back after the call. */
static bool is_alias(const struct ast_function *function, const struct ast_symbol *formal,
                     const struct ir_value *argument) {
    if (formal->array_length)
        return true;
    if (formal->type == TYPE_MATRIX)
        return false;
    if (formal->is_assigned || formal->storage != STORAGE_UNSAID)
        return false;
    if (!function->has_outputs)
        return true;
    for (int i = 0; i < argument->count; i++)
        if (argument->part[i].kind == OPERAND_VARIABLE && !argument->part[i].variable->is_temporary)
            return false;
    return true;
}

static void bind_formal(struct lowering *l, struct ast_expression *e, struct ast_symbol *formal,
                        const struct ir_value *argument, const struct source_location *at) {
    formal->value = compilation_get(l->c, sizeof *formal->value);
    if (is_alias(e ? e->function : l->call->function, formal, argument)) {
        *formal->value = *argument;
        return;
    }
    *formal->value = lower_variables(l, at, formal->type, 0, formal->name, formal->storage);
    lower_assign(l, at, formal->value, argument);
}

/* Lowers the body with the formals bound; the result is in variables of the list at hand. */
static struct ir_value lower_body(struct lowering *l, struct ast_function *function,
                                  const struct source_location *at) {
    struct lower_call call = {.function = function, .caller = l->call};
    struct ir_list *scope = l->scope;
    l->scope = l->list;
    call.result = lower_variables(l, at, function->type, 0, NULL, STORAGE_UNSAID);
    if (function->returns_early)
        call.returned = ir_variable_new(l->ir, l->scope, IR_BOOL, NULL);
    l->call = &call;
    function->is_being_lowered = true;
    lower_statements(l, function->body);
    function->is_being_lowered = false;
    l->call = call.caller;
    l->scope = scope;
    return call.result;
}

/* A function without a body: an instruction that calls it. */
static struct ir_value lower_external_call(struct lowering *l, struct ast_expression *e) {
    struct ir_operand operands[IR_OPERANDS_MAX] = {{0}};
    int count = 0;
    for (struct ast_expression *a = e->arguments; a; a = a->next)
        operands[count++] = lower_operand(l, a, a->next).part[0];
    struct ir_node *node = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, lower_at(l, &e->at));
    node->operation = (enum ir_operation)(IR_EXTERNAL0 + count);
    node->external = e->function;
    node->results[0] = lower_temporary(l, IR_FLOAT);
    memcpy(node->operands, operands, sizeof operands);
    return (struct ir_value){.count = 1, .part = {ir_of(node->results[0])}};
}

struct ir_value lower_user_call(struct lowering *l, struct ast_expression *e) {
    struct ast_function *function = e->function;
    struct ast_symbol *formal = function->formals;
    struct ir_list *scope = l->scope;
    int count = 0, i = 0;
    if (function->is_external)
        return lower_external_call(l, e);
    if (function->is_being_lowered)
        complain_cycle(l, &e->at, function);
    if (function->formal_count > 64)
        compile_limit(l->c, lower_at(l, &e->at), "a function with more than 64 parameters");
    if (++l->ir->instruction_count >
        INSTRUCTION_COUNT_MAX) /* a call that adds nothing is work, too */
        compile_limit(l->c, lower_at(l, &e->at),
                      "the shader has more than %d instructions once functions are inlined",
                      INSTRUCTION_COUNT_MAX);
    const struct source_location *site = l->site;
    bool in_default = l->in_default;
    /* not on the stack, which calls inside each other share */
    const size_t places = (size_t)e->argument_count + 1;
    struct ir_value *arguments = compilation_get(l->c, places * sizeof *arguments);
    struct lower_target *targets = compilation_get(l->c, places * sizeof *targets);
    for (struct ast_expression *a = e->arguments; a; a = a->next) {
        bool is_target = a->kind == EXPRESSION_INDEX && !a->array_length;
        if (is_target)
            targets[count] = lower_target_open(l, a);
        arguments[count] =
            is_target ? lower_target_read(l, &targets[count]) : lower_operand(l, a, a->next);
        count++;
    }
    if (function->is_prelude && !l->site)
        l->site = &e->at;
    l->scope = l->list;
    l->in_default = false;
    for (struct ast_expression *a = e->arguments; a; a = a->next, formal = formal->next)
        bind_formal(l, e, formal, &arguments[i++], &a->at);
    const bool is_shared = l->ir->is_making_shared;
    l->ir->is_making_shared |= function->is_prelude && !strcmp(function->name, "shared_phong");
    struct ir_value result = lower_body(l, function, &e->at);
    l->ir->is_making_shared = is_shared;
    i = 0;
    formal = function->formals;
    for (struct ast_expression *a = e->arguments; a; a = a->next, formal = formal->next, i++) {
        if (!formal->is_output || formal->array_length)
            continue;
        if (a->kind == EXPRESSION_NAME)
            lower_assign(l, &a->at, lower_symbol(l, a->symbol, &a->at), formal->value);
        else
            lower_target_write(l, &targets[i], formal->value);
    }
    l->site = site;
    l->scope = scope;
    l->in_default = in_default;
    return result;
}

struct ir_value lower_prelude_call(struct lowering *l, const struct source_location *at,
                                   const char *name, const struct ir_value *argument) {
    struct ast_function *function = l->prelude;
    while (function && strcmp(function->name, name))
        function = function->next;
    if (!function)
        compile_limit(l->c, at, "internal: the prelude lacks %s", name);
    const struct source_location *site = l->site;
    bool in_default = l->in_default;
    l->site = lower_at(l, at);
    l->in_default = false;
    function->formals->value = compilation_get(l->c, sizeof *function->formals->value);
    *function->formals->value = *argument;
    struct ir_value result = lower_body(l, function, at);
    l->site = site;
    l->in_default = in_default;
    return result;
}
