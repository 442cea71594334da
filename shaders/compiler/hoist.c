/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/passes.h"

/* Divides the top level between prepare(), which runs once per instance, and the code that runs for
 * samples. A top-level node goes to prepare() when everything in it is uniform and moving it before
 * all that stays changes no value: it reads nothing that a node which stays has written, and writes
 * nothing that one has touched. What prepare() computes and samples need travels in the uniform
 * block. */

struct scan {
    bool is_uniform, reads_shade, writes_shade, has_loop;
};

static void scan_read(struct ir_variable *variable, void *context) {
    struct scan *scan = context;
    scan->is_uniform &= !variable->is_varying;
    scan->reads_shade |= variable->is_written_in_shade;
}

static void scan_write(struct ir_variable *variable, void *context) {
    struct scan *scan = context;
    scan->is_uniform &= !variable->is_varying;
    scan->writes_shade |= variable->in_shade;
}

static void scan_node(struct ir_node *node, void *context) {
    struct scan *scan = context;
    if (node->kind == NODE_ILLUMINANCE ||
        (node->kind == NODE_INSTRUCTION && ir_instruction_reads_varying(node)))
        scan->is_uniform = false;
    scan->has_loop |= node->kind == NODE_LOOP;
    ir_each_read(node, scan_read, scan);
    ir_each_write(node, scan_write, scan);
}

static void read_in_prepare(struct ir_variable *variable, void *context) {
    variable->in_prepare = true;
}

static void write_in_prepare(struct ir_variable *variable, void *context) {
    variable->in_prepare = variable->is_written_in_prepare = true;
}

static void read_in_shade(struct ir_variable *variable, void *context) {
    variable->in_shade = true;
}

static void write_in_shade(struct ir_variable *variable, void *context) {
    variable->in_shade = variable->is_written_in_shade = true;
}

static void place(struct ir_node *node, void *context) {
    bool is_prepared = *(bool *)context;
    node->is_prepared = is_prepared;
    ir_each_read(node, is_prepared ? read_in_prepare : read_in_shade, NULL);
    ir_each_write(node, is_prepared ? write_in_prepare : write_in_shade, NULL);
}

static void place_all(struct ir_node *node, bool is_prepared) {
    place(node, &is_prepared);
    if (node->kind == NODE_INSTRUCTION)
        return;
    ir_each_node(node->test, place, &is_prepared);
    ir_each_node(node->body, place, &is_prepared);
    ir_each_node(node->otherwise, place, &is_prepared);
}

static bool can_prepare(struct ir_program *ir, struct ir_node *node) {
    struct scan scan = {.is_uniform = true};
    scan_node(node, &scan);
    if (node->kind != NODE_INSTRUCTION) {
        ir_each_node(node->test, scan_node, &scan);
        ir_each_node(node->body, scan_node, &scan);
        ir_each_node(node->otherwise, scan_node, &scan);
    }
    if (!scan.is_uniform || scan.reads_shade || scan.writes_shade)
        return false;
    ir->has_prepare_loop |= scan.has_loop;
    return true;
}

void pass_hoist(struct ir_program *ir) {
    struct ir_variable *results[IR_RESULTS_MAX];
    int count = ir_results(ir, results);
    for (struct ir_node *node = ir->top->first; node; node = node->next)
        place_all(node, can_prepare(ir, node));
    for (int i = 0; i < count; i++)
        results[i]->in_shade = true;
    ir->uniform_count = ir->has_prepare_loop ? 1 : 0;
    for (struct ir_variable *v = ir->top->variables; v; v = v->next_in_home) {
        if (!v->is_written_in_prepare || !v->in_shade)
            continue;
        v->slot = ir->uniform_count;
        ir->uniform_count += (v->array_length ? v->array_length : 1) * ir_slot_floats(v);
    }
}
