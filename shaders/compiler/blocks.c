/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/call_sites.h"
#include "shaders/compiler/passes.h"

#include <string.h>

/* What the SIMD array would be issued, block by block and stream by stream.
 *
 * An instruction with a varying result costs its operation; when all its operands are uniform the
 * processor of the node computes it, and the array pays for a move of the result into pixel memory.
 * Uniform instructions are free. Control flow costs LOGIC operations, one per change of the enable
 * flags: a varying if 2 (3 with else), a varying loop 2 on entry and exit and 1 per trip, an
 * illuminance body 2 per light. The condition of a loop is evaluated once more than its body runs:
 * it counts in the body's block, and once in the block around.
 *
 * Blocks of their own are the bodies of loops, the branches of uniform ifs and the bodies of
 * illuminances, as far as they hold anything for the array. An access to a varying array with a
 * varying index costs a compare and a move for each element: there is no indirect addressing.
 *
 * Streams: code before the first illuminance is pre-illum, bodies are illum, code after the last is
 * post-illum; in between, what depends on an illuminance is post-illum and the rest can run before
 * all lights. */

struct pricing {
    struct ir_program *ir;
    int illuminances, illuminances_left; /* in the whole shader; not yet passed */
    bool in_illuminance, is_tainted_control;
    const struct source_location *at; /* of the node at hand */
};

static int new_block(struct ir_program *ir, int parent) {
    if (ir->block_count == ir->block_capacity) {
        int capacity = ir->block_capacity ? ir->block_capacity * 2 : 16;
        struct shader_block *grown = compilation_get(ir->c, (size_t)capacity * sizeof *grown);
        if (ir->block_count)
            memcpy(grown, ir->blocks, (size_t)ir->block_count * sizeof *grown);
        ir->blocks = grown;
        ir->block_capacity = capacity;
    }
    ir->blocks[ir->block_count].parent = parent;
    return ir->block_count++;
}

static void count_operations(struct ir_program *ir, const struct source_location *at, int block,
                             enum shader_stream stream, int operation, int count) {
    ir->blocks[block].operations[stream][operation] += (uint32_t)count;
    if (ir->line_cost_count == ir->line_cost_capacity) {
        const size_t capacity = ir->line_cost_capacity ? ir->line_cost_capacity * 2 : 256;
        struct shader_line_cost *grown = compilation_get(ir->c, capacity * sizeof *grown);
        if (ir->line_cost_count)
            memcpy(grown, ir->line_costs, ir->line_cost_count * sizeof *grown);
        ir->line_costs = grown;
        ir->line_cost_capacity = capacity;
    }
    ir->line_costs[ir->line_cost_count++] = (struct shader_line_cost){
        at ? at->line : 0, block, (int)stream, operation, (uint32_t)count, -1};
}

void ir_count_operations(struct ir_program *ir, const struct ir_node *node, int operation,
                         int count) {
    count_operations(ir, node->at, node->block, node->stream, operation, count);
}

static void add(struct pricing *p, int block, enum shader_stream stream, int operation, int count) {
    if (count)
        count_operations(p->ir, p->at, block, stream, operation, count);
}

static void find_work(struct ir_node *node, void *context) {
    bool *has_work = context;
    if (node->kind == NODE_INSTRUCTION)
        *has_work |= ir_instruction_is_varying(node);
    else
        *has_work |= node->is_varying;
}

static bool has_work(struct ir_list *list) {
    bool result = false;
    ir_each_node(list, find_work, &result);
    return result;
}

static void read_taint(struct ir_variable *variable, void *context) {
    *(bool *)context |= variable->is_tainted;
}

static void write_taint(struct ir_variable *variable, void *context) {
    variable->is_tainted = true;
}

static enum shader_stream stream_of(struct pricing *p, struct ir_node *node) {
    bool is_tainted = p->is_tainted_control;
    if (p->ir->kind == SHADER_KIND_LIGHT)
        return SHADER_LIGHT;
    if (node->is_shared)
        return SHADER_SHARED;
    ir_each_read(node, read_taint, &is_tainted);
    ir_each_write(node, read_taint, &is_tainted); /* blends with what an illuminance left there */
    if (p->in_illuminance)
        return SHADER_ILLUM;
    if (p->illuminances_left == p->illuminances)
        return SHADER_PRE_ILLUM;
    if (!p->illuminances_left)
        return SHADER_POST_ILLUM;
    return is_tainted ? SHADER_POST_ILLUM : SHADER_PRE_ILLUM;
}

/* Loads or copies of 4 bytes each, or of a fixed-point value. Of three results some may be dead. */
static void add_move(struct pricing *p, const struct ir_node *node, int block,
                     enum shader_stream stream, int count) {
    const struct ir_variable *to = node->array;
    for (int i = 2; i >= 0; i--)
        to = node->results[i] ? node->results[i] : to;
    if (to->type != IR_FIXED) {
        add(p, block, stream, SIMD_FLOAT_MOVE, count);
        return;
    }
    add(p, block, stream, SIMD_FIXED_ADD_BASE, count);
    add(p, block, stream, SIMD_FIXED_ADD_BYTE, count * fixed_bytes(to->format));
}

static void price_instruction(struct pricing *p, struct ir_node *node, int block) {
    const struct ir_operation_info *info = &ir_operations[node->operation];
    enum shader_stream stream = stream_of(p, node);
    int results = 0;
    node->stream = stream;
    node->block = block;
    if (p->in_illuminance || stream == SHADER_POST_ILLUM || stream == SHADER_SHARED)
        ir_each_write(node, write_taint, NULL);
    if (!ir_instruction_is_varying(node) || node->is_free)
        return;
    for (int i = 0; i < 3; i++)
        results += node->results[i] && node->results[i]->is_varying;
    if (node->operation == IR_ARRAY_STORE)
        results = 1;
    bool is_array = node->operation == IR_ARRAY_LOAD || node->operation == IR_ARRAY_STORE;
    if (is_array && node->array->is_varying && ir_operand_is_varying(&node->operands[0])) {
        add(p, block, stream, SIMD_FLOAT_COMPARE, node->array->array_length);
        add_move(p, node, block, stream, node->array->array_length);
    } else if (is_array) {
        add_move(p, node, block, stream, results);
    } else if (!ir_instruction_reads_varying(node)) {
        add_move(p, node, block, stream, results);
    } else if (ir_operation_is_fixed(node->operation)) {
        uint32_t operations[SIMD_OPERATION_COUNT] = {0};
        price_fixed(node, operations);
        for (int i = 0; i < SIMD_OPERATION_COUNT; i++)
            add(p, block, stream, i, (int)operations[i]);
    } else if (node->call_site) {
        add(p, block, stream, node->is_fast ? simd_operation_fast(info->cost) : info->cost, 1);
        p->ir->line_costs[p->ir->line_cost_count - 1].call_site = node->call_site->number;
    } else if (info->cost != IR_FREE) {
        add(p, block, stream, info->cost, results);
    }
}

static void price_list(struct pricing *p, struct ir_list *list, int block);

static void price_if(struct pricing *p, struct ir_node *node, int block) {
    if (node->is_varying) {
        add(p, block, stream_of(p, node), SIMD_LOGIC, node->otherwise ? 3 : 2);
        price_list(p, node->body, block);
        price_list(p, node->otherwise, block);
        return;
    }
    if (has_work(node->body))
        node->block = new_block(p->ir, block);
    if (has_work(node->otherwise))
        node->block_otherwise = new_block(p->ir, block);
    price_list(p, node->body, node->block < 0 ? block : node->block);
    price_list(p, node->otherwise, node->block_otherwise < 0 ? block : node->block_otherwise);
}

static void price_loop(struct pricing *p, struct ir_node *node, int block) {
    enum shader_stream stream = stream_of(p, node);
    if (!node->is_varying && !has_work(node->test) && !has_work(node->body)) {
        price_list(p, node->test, block); /* for the streams only */
        price_list(p, node->body, block);
        return;
    }
    node->block = new_block(p->ir, block);
    if (node->is_varying) {
        add(p, block, stream, SIMD_LOGIC, 2);
        add(p, node->block, stream, SIMD_LOGIC, 1);
    }
    price_list(p, node->test, node->block);
    price_list(p, node->test, block);
    price_list(p, node->body, node->block);
}

static void price_illuminance(struct pricing *p, struct ir_node *node, int block) {
    bool outer = p->in_illuminance;
    p->in_illuminance = true;
    node->block = new_block(p->ir, block);
    add(p, node->block, node->is_shared ? SHADER_SHARED : SHADER_ILLUM, SIMD_LOGIC, 2);
    price_list(p, node->body, node->block);
    p->in_illuminance = outer;
    p->illuminances_left--;
}

static void price_list(struct pricing *p, struct ir_list *list, int block) {
    for (struct ir_node *node = list ? list->first : NULL; node; node = node->next) {
        bool outer = p->is_tainted_control;
        if (node->is_prepared)
            continue;
        p->at = node->at;
        if (node->kind == NODE_INSTRUCTION) {
            price_instruction(p, node, block);
            continue;
        }
        if (node->condition.kind == OPERAND_VARIABLE && node->condition.variable->is_tainted)
            p->is_tainted_control = true;
        if (node->kind == NODE_IF)
            price_if(p, node, block);
        else if (node->kind == NODE_LOOP)
            price_loop(p, node, block);
        else
            price_illuminance(p, node, block);
        p->is_tainted_control = outer;
    }
}

static void count_illuminance(struct ir_node *node, void *context) {
    *(int *)context += node->kind == NODE_ILLUMINANCE;
}

/* Marks every node with a counted block in it. */
static bool mark_blocks(struct ir_list *list) {
    bool any = false;
    for (struct ir_node *node = list ? list->first : NULL; node; node = node->next) {
        if (node->kind == NODE_INSTRUCTION)
            continue;
        bool inside = mark_blocks(node->test);
        inside |= mark_blocks(node->body);
        inside |= mark_blocks(node->otherwise);
        node->has_blocks = inside;
        any |= inside || node->block >= 0 || node->block_otherwise >= 0;
    }
    return any;
}

void pass_blocks(struct ir_program *ir) {
    struct pricing p = {.ir = ir};
    ir_each_node(ir->top, count_illuminance, &p.illuminances);
    p.illuminances_left = p.illuminances;
    new_block(ir, -1);
    price_list(&p, ir->top, 0);
    mark_blocks(ir->top);
}
