/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

/* Statements become nested lists of nodes. break, continue and return set flags; what follows a
 * statement that may have set one runs under a guard, and loops ask the flags in their condition.
 */

static void lower_statement(struct lowering *l, struct ast_statement *s);

static struct ir_operand negate(struct lowering *l, const struct source_location *at,
                                struct ir_variable *flag) {
    return lower_unary(l, at, IR_NOT, ir_of(flag));
}

/* The condition under which the rest of the list still runs, after statements that may have left
 * it, by at most `exit_level`. Only where one may return it is asked whether one did: a return
 * further down must not make what comes before it depend on its samples. */
struct ir_operand lower_still_running(struct lowering *l, const struct source_location *at,
                                      int exit_level, bool in_body) {
    struct ir_operand running = ir_bool(true);
    struct lower_loop *loop = l->call->loops;
    if (loop && loop->broken)
        running = lower_binary(l, at, IR_AND, running, negate(l, at, loop->broken));
    if (loop && loop->continued && in_body)
        running = lower_binary(l, at, IR_AND, running, negate(l, at, loop->continued));
    if (l->call->returned && exit_level == EXIT_FUNCTION)
        running = lower_binary(l, at, IR_AND, running, negate(l, at, l->call->returned));
    return running;
}

void lower_statements(struct lowering *l, struct ast_statement *list) {
    struct ir_list *outer = l->list;
    int exit_level = 0; /* of all statements so far */
    for (struct ast_statement *s = list; s; s = s->next) {
        lower_statement(l, s);
        if (s->exit_level > exit_level)
            exit_level = s->exit_level;
        if (!s->exit_level || !s->next)
            continue;
        /* The guards lie side by side, not inside each other. */
        l->list = outer;
        struct ir_operand running = lower_still_running(l, &s->at, exit_level, true);
        if (running.kind == OPERAND_BOOL)
            continue;
        struct ir_node *guard = lower_control(l, NODE_IF, &s->at);
        guard->condition = running;
        l->list = guard->body;
    }
    l->list = outer;
}

static void set_flag(struct lowering *l, const struct source_location *at,
                     struct ir_variable *flag) {
    if (flag)
        lower_move(l, at, flag, ir_bool(true));
}

static void lower_jump(struct lowering *l, struct ast_statement *s) {
    struct lower_loop *loop = l->call->loops;
    for (int level = 1; loop && level < s->level; level++, loop = loop->outer)
        set_flag(l, &s->at, loop->broken);
    if (loop)
        set_flag(l, &s->at, s->kind == STATEMENT_BREAK ? loop->broken : loop->continued);
}

static void lower_return(struct lowering *l, struct ast_statement *s) {
    if (s->expression) {
        struct ir_value value = lower_expression(l, s->expression);
        lower_assign(l, &s->at, &l->call->result, &value);
    }
    set_flag(l, &s->at, l->call->returned);
}

static void lower_declaration(struct lowering *l, struct ast_symbol *symbol) {
    struct ir_value *value = compilation_get(l->c, sizeof *value);
    struct ir_value initial = {0};
    if (symbol->initial && !symbol->array_length)
        initial =
            lower_expression(l, symbol->initial); /* may read an outer variable of the same name */
    *value = lower_variables(l, &symbol->at, symbol->type, symbol->array_length, symbol->name,
                             symbol->storage);
    symbol->value = value;
    if (symbol->initial && symbol->array_length) {
        initial = lower_expression(l, symbol->initial);
        lower_array_convert(l, &symbol->initial->at, symbol->type, value, symbol->array_length,
                            symbol->initial->type, &initial);
    } else if (initial.count) {
        lower_assign(l, &symbol->initial->at, value, &initial);
    }
    int element = 0;
    for (struct ast_expression *e = symbol->elements; e; e = e->next, element++) {
        struct ir_value one = lower_expression(l, e);
        lower_array_store(l, &e->at, symbol->type, value, ir_float((float)element), &one);
    }
}

/* Runs the statement in `list`, which is a scope of its own. */
static void lower_into(struct lowering *l, struct ir_list *list, struct ast_statement *s) {
    struct ir_list *outer = l->list, *scope = l->scope;
    l->list = l->scope = list;
    if (s)
        lower_statement(l, s);
    l->list = outer;
    l->scope = scope;
}

static void lower_if(struct lowering *l, struct ast_statement *s) {
    struct ir_value condition = lower_expression(l, s->expression);
    struct ir_node *node = lower_control(l, NODE_IF, &s->at);
    node->condition = condition.part[0];
    lower_into(l, node->body, s->body);
    if (s->otherwise) {
        node->otherwise = ir_list_new(l->ir, node);
        lower_into(l, node->otherwise, s->otherwise);
    }
}

static void lower_step(struct lowering *l, struct ast_statement *s, struct ir_list *body) {
    struct ir_list *outer = l->list, *scope = l->scope;
    l->list = l->scope = body;
    if (s->body && s->body->exit_level) {
        struct ir_operand running = lower_still_running(l, &s->at, s->body->exit_level, false);
        if (running.kind != OPERAND_BOOL) {
            struct ir_node *guard = lower_control(l, NODE_IF, &s->at);
            guard->condition = running;
            l->list = l->scope = guard->body;
        }
    }
    for (struct ast_expression *e = s->step; e; e = e->next)
        lower_expression(l, e);
    l->list = outer;
    l->scope = scope;
}

/* `continued` lives in the body, so it starts false each time; `broken` lives outside the loop. */
static void lower_for(struct lowering *l, struct ast_statement *s) {
    struct lower_loop loop = {0};
    for (struct ast_expression *e = s->initial; e; e = e->next)
        lower_expression(l, e);
    struct ir_list *outer = l->list, *scope = l->scope;
    if (s->body && s->body->exit_level > 0) {
        loop.broken = ir_variable_new(l->ir, l->list, IR_BOOL, NULL);
        lower_move(l, &s->at, loop.broken, ir_bool(false));
    }
    struct ir_node *node = lower_control(l, NODE_LOOP, &s->at);
    node->test = ir_list_new(l->ir, node);
    if (loop.broken)
        loop.continued = ir_variable_new(l->ir, node->body, IR_BOOL, NULL);
    loop.outer = l->call->loops;
    l->call->loops = &loop;
    l->list = l->scope = node->test;
    struct ir_operand running =
        lower_still_running(l, &s->at, s->body ? s->body->exit_level : 0, false);
    struct ir_operand condition = ir_bool(true);
    if (s->expression)
        condition = lower_expression(l, s->expression).part[0];
    node->condition = lower_binary(l, &s->at, IR_AND, running, condition);
    l->list = outer;
    l->scope = scope;
    lower_into(l, node->body, s->body);
    if (s->step)
        lower_step(l, s, node->body);
    l->call->loops = loop.outer;
}

static void lower_statement(struct lowering *l, struct ast_statement *s) {
    struct ir_list *scope = l->scope;
    lower_deeper(l, &s->at, 2);
    switch (s->kind) {
    case STATEMENT_EMPTY:
    case STATEMENT_FUNCTION:
        break;
    case STATEMENT_EXPRESSION:
        lower_expression(l, s->expression);
        break;
    case STATEMENT_DECLARE:
        lower_declaration(l, s->symbol);
        break;
    case STATEMENT_BLOCK:
        if (s->is_scope)
            l->scope = l->list;
        lower_statements(l, s->body);
        l->scope = scope;
        break;
    case STATEMENT_IF:
        lower_if(l, s);
        break;
    case STATEMENT_FOR:
        lower_for(l, s);
        break;
    case STATEMENT_BREAK:
    case STATEMENT_CONTINUE:
        lower_jump(l, s);
        break;
    case STATEMENT_RETURN:
        lower_return(l, s);
        break;
    case STATEMENT_ILLUMINANCE:
        lower_illuminance(l, s);
        break;
    case STATEMENT_ILLUMINATE:
    case STATEMENT_SOLAR:
        lower_illuminate(l, s);
        break;
    }
    l->depth -= 2;
}
