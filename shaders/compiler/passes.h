/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PASSES_H
#define PASSES_H

#include "shaders/compiler/ir.h"

/* The passes over the IR, in order; one file each. A pass that may be left out changes what a
 * shader costs, never what it computes.
 *
 * X(name, function, may be left out, uniform and varying are known after it, what it does) */
#define IR_PASSES(X)                                                                               \
    X("arrays", pass_array_elements, true, false,                                                  \
      "variables for elements that are named outright")                                            \
    X("ssa", pass_ssa, true, false, "a variable for each web of assignments and uses")             \
    X("fold", pass_fold_constants, true, false, "instructions on constants, known branches")       \
    X("cse", pass_common_subexpressions, true, false, "what was computed already is not again")    \
    X("copies", pass_propagate_copies, true, false, "copies are replaced by what they copy")       \
    X("moves", pass_merge_moves, true, false, "results go straight where they are moved to")       \
    X("storage", pass_infer_storage, false, true, "uniform or varying")                            \
    X("dead", pass_dead_code, false, true, "what cannot reach the result goes, parameters too")    \
    X("sizes", pass_fixed_sizes, true, true, "fixed-point bits that nobody needs go")              \
    X("source", pass_source, false, true,                                                          \
      "the language again, with other types, when that is wanted")                                 \
    X("bind", pass_bind_parameters, false, true, "transfer map and bound values")                  \
    X("hoist", pass_hoist, false, true, "uniform code to the processor, once per instance")        \
    X("blocks", pass_blocks, false, true, "streams and counts of what the array is issued")        \
    X("memory", pass_memory, false, true, "lifetimes, pixel memory, spilling")                     \
    X("emit", pass_emit, false, true, "C")

enum ir_pass {
#define IR_PASS_ENUM(name, function, optional, storage, what) IR_PASS_##function,
    IR_PASSES(IR_PASS_ENUM)
#undef IR_PASS_ENUM
        IR_PASS_COUNT
};

/* Each reports what the user did wrong to ir->c and leaves valid IR. */
#define IR_PASS_DECLARE(name, function, optional, storage, what)                                   \
    void function(struct ir_program *ir);
IR_PASSES(IR_PASS_DECLARE)
#undef IR_PASS_DECLARE

/* The IR as text, in the program's arena. */
char *ir_dump(struct ir_program *ir);

#endif
