/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/memory.h"

/* Spilling to texture memory, which the authors of PixelFlow proposed for shaders that do not fit
 * (PF section 7). A spilled variable has no place of its own: each instruction that reads it brings
 * its bytes in, each that writes it takes them out, through a scratch place that lives for that
 * instruction only. The price of a byte is the machine's (spill_byte). */

/* The scratch of an instruction holds all its spilled operands at once. */
static void count_scratch(struct ir_variable *variable, void *context) {
    struct memory_plan *plan = context;
    const struct memory_range *range = memory_range_of(plan, variable);
    if (range->is_spilled)
        plan->position += range->bytes;
}

struct scratch {
    struct memory_plan *plan;
    int most;
};

static void measure_scratch(struct ir_node *node, void *context) {
    struct scratch *scratch = context;
    scratch->plan->position = 0;
    ir_each_read(node, count_scratch, scratch->plan);
    ir_each_write(node, count_scratch, scratch->plan);
    if (!node->is_prepared && scratch->plan->position > scratch->most)
        scratch->most = scratch->plan->position;
}

/* Where more is in use than fits, the variable that is idle longest for its uses leaves. */
static struct memory_range *choose(const struct memory_plan *plan, int room) {
    struct memory_range *best = NULL;
    double best_score = 0;
    for (size_t i = 0; i < plan->count; i++) {
        struct memory_range *range = plan->order[i];
        const bool is_idle = range->last - range->first > range->touches;
        const bool is_high = range->address + range->bytes > room;
        if (range->is_spilled || range->variable->array_length || !is_idle)
            continue;
        const double score =
            (double)(range->last - range->first) / range->touches * (is_high ? 2 : 1);
        if (!best || score > best_score) {
            best = range;
            best_score = score;
        }
    }
    return best;
}

struct charge {
    struct memory_plan *plan;
    struct ir_node *node;
};

static void charge_access(struct ir_variable *variable, void *context) {
    struct charge *charge = context;
    const struct memory_range *range = memory_range_of(charge->plan, variable);
    if (range->is_spilled)
        ir_count_operations(charge->plan->ir, charge->node, SIMD_SPILL_BYTE, range->bytes);
}

static void charge_node(struct ir_node *node, void *context) {
    struct charge charge = {context, node};
    if (node->is_prepared || node->kind != NODE_INSTRUCTION)
        return;
    ir_each_read(node, charge_access, &charge);
    ir_each_write(node, charge_access, &charge);
}

void memory_spill(struct memory_plan *plan, int room) {
    struct shader_memory *memory = plan->memory;
    while (memory->allocated > room) {
        struct memory_range *range = choose(plan, room);
        if (!range)
            break;
        range->is_spilled = true;
        memory->spilled += range->bytes;
        memory_allocate(plan);
        struct scratch scratch = {plan, 0};
        ir_each_node(plan->ir->top, measure_scratch, &scratch);
        memory->allocated += scratch.most;
    }
    if (memory->spilled)
        ir_each_node(plan->ir->top, charge_node, plan);
}
