/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FIXING_H
#define FIXING_H

#include "shaders/compiler/ir.h"

/* From floats to fixed-point: the program as source again, in which variables have the sizes that
 * shader_compile_options.fixings asks for and exponents that follow from their ranges. */

/* What values a variable can have. Of a fixed-point variable the exact range of what is assigned,
 * before it is rounded down. */
struct range {
    double low, high; /* -INFINITY, INFINITY: not known */
};
static const struct range range_unknown = {-__builtin_inf(), __builtin_inf()};

/* fixing_ranges.c: for each variable by its number, interval arithmetic from the start of the
 * program to its end, narrowed to twice the magnitude that was seen (fixings). */
struct range *fixing_ranges(struct ir_program *ir);
/* That of an instruction's result, given those of all variables. */
struct range fixing_result_range(const struct range *ranges, const struct ir_node *node);
struct range fixing_operand_range(const struct range *ranges, const struct ir_operand *operand);
struct range range_reciprocal(struct range a);
/* The format of `size` bits with the most fraction bits that holds the range; unsigned when nothing
 * in it is below zero. */
struct fixed_format fixing_format(struct range range, int size);

/* source_expression.c */
enum precedence {
    PRECEDENCE_QUESTION,
    PRECEDENCE_OR,
    PRECEDENCE_AND,
    PRECEDENCE_EQUAL,
    PRECEDENCE_LESS,
    PRECEDENCE_SUM,
    PRECEDENCE_PRODUCT,
    PRECEDENCE_SIGN,
    PRECEDENCE_PRIMARY
};

/* An expression as text. */
struct piece {
    const char *text;
    int precedence;
    bool is_fixed;
    struct fixed_format format;
};

/* What the writer knows of a variable. */
struct written {
    int definitions, uses;
    struct ir_node *definition; /* the last one met */
    struct ir_list *used_in;    /* the list in which the last use evaluates it */
    int weight;                 /* > 0: written where it is used, that many operations */
    const char *alias;          /* text that stands for it anywhere: a parameter, N, L; or NULL */
    const char *name;           /* once it is declared */
    bool is_fixed;              /* fixed-point, of this format */
    bool is_given;              /* whether a parameter was given */
    bool is_early;              /* declared before the list it lives in */
    struct fixed_format format;
};

struct source_writer {
    struct ir_program *ir;
    struct written *variables; /* by number */
    struct range *ranges;
    const char **names; /* all in use; what each is made from, and the number it has */
    const char **bases;
    int *numbers;
    size_t name_count, name_capacity;
    char *text;
    size_t length, capacity; /* in the arena of the compilation */
    int indent, line, temporaries;
};

const char *source_format(struct source_writer *w, const char *format, ...)
    __attribute__((format(printf, 2, 3), nonnull));
struct written *source_variable(struct source_writer *w, const struct ir_variable *variable);
/* What the instruction computes, in the type that its result has. */
struct piece source_expression(struct source_writer *w, const struct ir_node *node);
struct piece source_condition(struct source_writer *w, const struct ir_operand *operand);
/* The condition that an instruction computes. */
struct piece source_instruction_condition(struct source_writer *w, const struct ir_node *node);
/* An operand as float, whatever it is. */
struct piece source_float(struct source_writer *w, const struct ir_operand *operand);
/* Whether the instruction computes a component of L: the direction of a light, turned round. */
bool source_is_towards_light(struct source_writer *w, const struct ir_node *node);
/* Whether the definition of the variable is written where the variable is used. */
bool source_is_inlined(struct source_writer *w, const struct ir_variable *variable);
/* Component `index` of a parameter or predefined variable. */
const char *source_component(struct source_writer *w, const struct shader_parameter *parameter,
                             int index);
/* The program cannot be written: stops the compilation with a message at the node. */
_Noreturn void source_refuse(struct source_writer *w, const struct ir_node *node, const char *what);

#endif
