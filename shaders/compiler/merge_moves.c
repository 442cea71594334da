/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* `t = a + b; ...; x = t` becomes `x = a + b` when nothing else uses t and nothing in between looks
 * at x: lowering makes such pairs for every assignment, and each would cost a move of pixel memory.
 */

enum { LOOK_BACK_MAX = 64 };

static void count_read(struct ir_variable *variable, void *context) {
    variable->use_count++;
}

static void count_write(struct ir_variable *variable, void *context) {
    variable->definition_count++;
    variable->definition = context;
}

static void count_node(struct ir_node *node, void *context) {
    ir_each_read(node, count_read, NULL);
    ir_each_write(node, count_write, node);
}

struct search {
    struct ir_variable *variable;
    bool is_found;
};

static void compare(struct ir_variable *variable, void *context) {
    struct search *search = context;
    search->is_found |= variable == search->variable;
}

static bool touches(struct ir_node *node, struct ir_variable *variable) {
    struct search search = {variable, false};
    ir_each_read(node, compare, &search);
    ir_each_write(node, compare, &search);
    return search.is_found;
}

static bool try_merge(struct ir_node *move) {
    if (move->kind != NODE_INSTRUCTION || !ir_is_move(move) ||
        move->operands[0].kind != OPERAND_VARIABLE)
        return false;
    struct ir_variable *from = move->operands[0].variable, *to = move->results[0];
    if (from->use_count != 1 || from->definition_count != 1 || from->array_length ||
        from->is_declared_uniform || from->is_forced_varying)
        return false;
    struct ir_node *definition = from->definition;
    if (definition->list != move->list || from->home != move->list)
        return false;
    struct ir_variable **slot = NULL;
    for (int i = 0; i < 3; i++) {
        if (definition->results[i] == from)
            slot = &definition->results[i];
        else if (definition->results[i] == to)
            return false;
    }
    int steps = 0;
    for (struct ir_node *node = definition->next; node != move; node = node->next)
        if (!node || node->kind != NODE_INSTRUCTION || ++steps > LOOK_BACK_MAX || touches(node, to))
            return false;
    if (!slot)
        return false;
    *slot = to;
    to->definition = definition;
    from->use_count = from->definition_count = 0;
    return true;
}

static void merge_list(struct ir_list *list) {
    struct ir_node *previous = NULL;
    for (struct ir_node *node = list ? list->first : NULL; node; node = node->next) {
        if (try_merge(node)) {
            previous->next =
                node->next; /* the definition came before, so there is a previous node */
            if (list->last == node)
                list->last = previous;
            continue;
        }
        previous = node;
        if (node->kind != NODE_INSTRUCTION) {
            merge_list(node->test);
            merge_list(node->body);
            merge_list(node->otherwise);
        }
    }
}

void pass_merge_moves(struct ir_program *ir) {
    struct ir_variable *results[IR_RESULTS_MAX];
    int count = ir_results(ir, results);
    for (size_t i = 0; i < ir->variable_count; i++)
        ir->variables[i]->use_count = ir->variables[i]->definition_count = 0;
    for (int i = 0; i < count; i++)
        results[i]->use_count++;
    ir_each_node(ir->top, count_node, NULL);
    merge_list(ir->top);
}
