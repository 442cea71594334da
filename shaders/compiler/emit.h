/* SPDX-License-Identifier: Apache-2.0 */
#ifndef EMIT_H
#define EMIT_H

#include "shaders/compiler/ir.h"

/* Writing C. Variables are v0, v1 ...; masks m, counters n and keys k carry the number of their
 * node's block or a running number. In prepare() everything is scalar; in shade and light uniform
 * variables are scalars and varying ones vectors. */
struct emitter {
    struct compilation *c;
    struct ir_program *ir;
    bool in_prepare, in_light;
    int mask;      /* number of the mask in force, -1: all samples */
    int loop_mask; /* of the innermost varying loop, -1: none */
    int steps;     /* number of the counter of uniform loop steps */
    int key;       /* number of the key of the control path */
    int in_varying_loop;
    int next_number;
    int external_count;
    int indent;
};

void emit_text(struct emitter *e, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A line of its own, indented. */
void emit_line(struct emitter *e, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A string as C writes it. */
void emit_quoted(struct emitter *e, const char *text);
/* An operand as a scalar, or as a vector when `as_vector`. */
void emit_operand(struct emitter *e, const struct ir_operand *operand, bool as_vector);
void emit_instruction(struct emitter *e, struct ir_node *node);
/* The value of a fixed-point instruction as an expression, emit_fixed.c. */
void emit_fixed(struct emitter *e, const struct ir_node *node, bool is_vector);
/* The constant of a fixed-point operand, or its variable. */
void emit_fixed_constant(struct emitter *e, int64_t raw);
/* The declarations of a list, then its nodes (of the top level: those of this function). */
void emit_list(struct emitter *e, struct ir_list *list);
/* Functions from outside, emit_external.c: numbers and declares those that are called; a call as an
 * expression; the table of their names. */
void emit_externals(struct emitter *e);
void emit_external_call(struct emitter *e, const struct ir_node *node, bool is_vector);
void emit_external_table(struct emitter *e);
/* Probes, emit_probe.c: nothing at all unless options ask for them. The helpers; the mask `valid`
 * of the lanes that count; what an instruction gave; fields of the module. */
void emit_probe_support(struct emitter *e);
void emit_probe_lanes(struct emitter *e);
void emit_probes(struct emitter *e, const struct ir_node *node);
void emit_probe_fields(struct emitter *e);
/* A text of any length as it is. */
void emit_support_text(struct emitter *e, const char *text);
/* LIGHTS_AT, emit.c */
void emit_lights_at(struct emitter *e, struct ir_node *node);
void emit_declaration(struct emitter *e, struct ir_variable *variable);

#endif
