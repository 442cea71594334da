/* SPDX-License-Identifier: Apache-2.0 */
#ifndef MEMORY_H
#define MEMORY_H

#include "shaders/compiler/ir.h"

/* What the passes over pixel memory share: memory.c finds lifetimes and places, memory_spill.c what
 * must leave. Arena memory of the compilation. */

struct memory_range {
    struct ir_variable *variable;
    bool is_used, is_spilled;
    int bytes, line;
    int first, last; /* instructions, see shader_memory.h */
    int touches;     /* reads and writes */
    int address;
};

struct memory_loop {
    const struct ir_node *node; /* NULL: the illuminance bodies together, once per light */
    int begin, end;             /* instructions */
    struct memory_loop *next;
};

struct memory_plan {
    struct ir_program *ir;
    struct shader_memory *memory;
    struct memory_range *ranges; /* by variable id */
    struct memory_range **order; /* those that want a place, by first assignment */
    size_t count;
    struct memory_loop *loops;
    int position;
    enum shader_stream stream;
    bool is_found, has_shared;
};

int memory_variable_bytes(const struct ir_variable *variable);
struct memory_range *memory_range_of(struct memory_plan *plan, const struct ir_variable *variable);
void memory_add_loop(struct memory_plan *plan, struct ir_node *node, int begin, int end);
/* Gives every variable that is not spilled a place, and says how much that takes. */
void memory_allocate(struct memory_plan *plan);
/* Spills until what is left fits into `room` bytes, or nothing is left to spill; charges the
 * transfers to the blocks of the program. */
void memory_spill(struct memory_plan *plan, int room);

#endif
