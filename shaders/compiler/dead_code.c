/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* Keeps what can reach a result of the shader: a node is live when it assigns to a live variable, a
 * variable when a live node reads it, control flow when something in it is live. Does not look at
 * the order of assignments, so an overwritten value keeps its inputs. */

struct liveness {
    struct ir_program *ir;
    struct ir_variable **stack;
    size_t depth;
};

static void mark(struct ir_variable *variable, void *context) {
    struct liveness *liveness = context;
    if (variable->is_live)
        return;
    variable->is_live = true;
    liveness->stack[liveness->depth++] = variable;
}

static void mark_node(struct liveness *liveness, struct ir_node *node) {
    for (; node && !node->is_live; node = node->list->owner) {
        node->is_live = true;
        ir_each_read(node, mark, liveness);
    }
}

struct add_definition {
    struct liveness *liveness;
    struct ir_node *node;
};

static void add_definition(struct ir_variable *variable, void *context) {
    struct add_definition *add = context;
    struct ir_use *use = compilation_get(add->liveness->ir->c, sizeof *use);
    use->node = add->node;
    use->next = variable->uses;
    variable->uses = use;
}

static void collect(struct ir_node *node, void *context) {
    struct add_definition add = {context, node};
    ir_each_write(node, add_definition, &add);
}

static void sweep(struct ir_list *list) {
    if (!list)
        return;
    struct ir_node **link = &list->first;
    struct ir_variable **variable = &list->variables;
    list->last = NULL;
    while (*link) {
        struct ir_node *node = *link;
        if (!node->is_live) {
            *link = node->next;
            continue;
        }
        for (int i = 0; i < 3; i++)
            if (node->results[i] && !node->results[i]->is_live)
                node->results[i] = NULL;
        sweep(node->test);
        sweep(node->body);
        sweep(node->otherwise);
        list->last = node;
        link = &node->next;
    }
    while (*variable) {
        if ((*variable)->is_live)
            variable = &(*variable)->next_in_home;
        else
            *variable = (*variable)->next_in_home;
    }
}

void pass_dead_code(struct ir_program *ir) {
    struct liveness liveness = {.ir = ir};
    struct ir_variable *results[IR_RESULTS_MAX];
    int count = ir_results(ir, results);
    liveness.stack = compilation_get(ir->c, (ir->variable_count + 1) * sizeof *liveness.stack);
    for (size_t i = 0; i < ir->variable_count; i++)
        ir->variables[i]->uses = NULL;
    ir_each_node(ir->top, collect, &liveness);
    for (int i = 0; i < count; i++)
        mark(results[i], &liveness);
    while (liveness.depth) {
        struct ir_variable *variable = liveness.stack[--liveness.depth];
        for (struct ir_use *use = variable->uses; use; use = use->next)
            mark_node(&liveness, use->node);
    }
    sweep(ir->top);
}
