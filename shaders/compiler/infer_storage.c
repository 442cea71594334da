/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* Which variables vary from sample to sample: those assigned from something that varies, and those
 * assigned where samples go different ways, unless they live only there. A fixpoint that does not
 * look at the order of assignments. A variable declared uniform becomes varying only where samples
 * go different ways, with a warning (loops count with such variables and leave early for some
 * samples); to assign it what varies is the user's mistake. */

struct inference {
    struct ir_program *ir;
    struct ir_variable **stack; /* varying, but its readers do not know yet */
    size_t depth;
    struct ir_variable *source; /* whose readers are being told */
};

static void mark(struct inference *inference, struct ir_variable *variable) {
    if (variable->is_varying || variable->is_declared_uniform)
        return;
    variable->is_varying = true;
    inference->stack[inference->depth++] = variable;
}

/* What a variable declared uniform in vain is assigned to becomes the same. */
static void demote(struct ir_variable *variable) {
    if (variable->type == IR_STRING)
        return;
    variable->is_demoted = true;
    variable->is_declared_uniform = false;
}

static void mark_visited(struct ir_variable *variable, void *context) {
    struct inference *inference = context;
    if (inference->source && inference->source->is_demoted && !variable->is_varying)
        demote(variable);
    mark(inference, variable);
}

struct control {
    struct inference *inference;
    struct ir_node *node;
};

static bool is_inside(const struct ir_list *list, const struct ir_node *node) {
    for (; list->owner; list = list->owner->list)
        if (list->owner == node)
            return true;
    return false;
}

static void mark_outer(struct ir_variable *variable, void *context) {
    struct control *control = context;
    if (is_inside(variable->home, control->node))
        return;
    if (variable->is_declared_uniform)
        demote(variable);
    mark(control->inference, variable);
}

static void mark_assigned(struct ir_node *node, void *context) {
    ir_each_write(node, mark_outer, context);
}

static void become_varying(struct inference *inference, struct ir_node *node) {
    struct control control = {inference, node};
    if (node->is_varying)
        return;
    node->is_varying = true;
    ir_each_node(node->test, mark_assigned, &control);
    ir_each_node(node->body, mark_assigned, &control);
    ir_each_node(node->otherwise, mark_assigned, &control);
}

struct add_use {
    struct inference *inference;
    struct ir_node *node;
};

static void add_use(struct ir_variable *variable, void *context) {
    struct add_use *add = context;
    struct ir_use *use = compilation_get(add->inference->ir->c, sizeof *use);
    use->node = add->node;
    use->next = variable->uses;
    variable->uses = use;
}

static void start_node(struct ir_node *node, void *context) {
    struct inference *inference = context;
    struct add_use add = {inference, node};
    ir_each_read(node, add_use, &add);
    if (node->kind == NODE_ILLUMINANCE)
        become_varying(inference, node);
    else if (node->kind == NODE_INSTRUCTION && ir_instruction_reads_varying(node))
        ir_each_write(node, mark_visited, inference);
}

static const struct ir_node *varying_control(const struct ir_node *node,
                                             const struct ir_variable *variable) {
    for (const struct ir_list *list = node->list; list->owner; list = list->owner->list) {
        if (variable->home == list)
            return NULL;
        if (list->owner->is_varying)
            return list->owner;
    }
    return NULL;
}

struct report {
    struct compilation *c;
    const struct ir_node *node;
    const struct source_location *last;
    const char *warned; /* name of the last variable warned of */
};

static void report_write(struct ir_variable *variable, void *context) {
    struct report *report = context;
    const struct ir_node *node = report->node;
    if (variable->is_demoted && variable->name && variable->name != report->warned &&
        varying_control(node, variable)) {
        compile_warning(
            report->c, node->at,
            "uniform '%.64s' is assigned where samples go different ways, and so varies",
            variable->name);
        report->warned = variable->name;
    }
    if (!variable->is_declared_uniform || node->at == report->last)
        return;
    const char *name = variable->name ? variable->name : "string";
    if (ir_instruction_reads_varying(node))
        compile_error(report->c, node->at, "a value that varies is assigned to uniform '%.64s'",
                      name);
    else if (varying_control(node, variable))
        compile_error(report->c, node->at,
                      "uniform '%.64s' is assigned where samples go different ways", name);
    else
        return;
    report->last = node->at;
}

static void report_node(struct ir_node *node, void *context) {
    struct report *report = context;
    report->node = node;
    ir_each_write(node, report_write, report);
}

void pass_infer_storage(struct ir_program *ir) {
    struct inference inference = {.ir = ir};
    inference.stack = compilation_get(ir->c, (ir->variable_count + 1) * sizeof *inference.stack);
    for (size_t i = 0; i < ir->variable_count; i++)
        if (ir->variables[i]->is_forced_varying)
            mark(&inference, ir->variables[i]);
    ir_each_node(ir->top, start_node, &inference);
    while (inference.depth) {
        struct ir_variable *variable = inference.stack[--inference.depth];
        inference.source = variable;
        for (struct ir_use *use = variable->uses; use; use = use->next) {
            if (use->node->kind == NODE_INSTRUCTION)
                ir_each_write(use->node, mark_visited, &inference);
            else
                become_varying(&inference, use->node);
        }
    }
    struct report report = {.c = ir->c};
    ir_each_node(ir->top, report_node, &report);
}
