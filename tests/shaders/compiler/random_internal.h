/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RANDOM_INTERNAL_H
#define RANDOM_INTERNAL_H

#include "base/rng.h"
#include "random_program.h"
#include "shaders/compiler/ast.h"

#include <stddef.h>

enum {
    RANDOM_VARIABLES = 128,
    RANDOM_FUNCTIONS = 16,
    RANDOM_FORMALS = 5,
    RANDOM_FORMATS = 4,
};

struct random_variable {
    char name[8];
    enum ast_type type;
    int length; /* 0: not an array */
    bool is_uniform, is_readonly;
    bool is_open; /* an array parameter: takes any length from `length` up */
};

struct random_function {
    char name[8];
    enum ast_type type;
    int formal_count;
    struct random_variable formals[RANDOM_FORMALS];
    bool is_output[RANDOM_FORMALS];
    bool has_illuminance, is_nested;
    int cost;
};

struct random_generator {
    struct rng rng;
    struct random_program *program;
    size_t length, capacity;
    struct random_variable variables[RANDOM_VARIABLES];
    int variable_count, first_visible, scope_start;
    struct random_function functions[RANDOM_FUNCTIONS];
    int function_count, next_number;
    int indent, nesting, loops, open_loops; /* open_loops: how many loops out a jump may go */
    int cost, cost_max;                     /* operators and calls after inlining, about */
    bool may_return, in_illuminance, in_illuminate, uses_illuminance, in_function, has_jumped;
    bool no_effects; /* inside a subscript */
    struct fixed_format
        formats[RANDOM_FORMATS]; /* of fixed-point variables; few, so that they meet */
    int format_count;            /* 0: floats only */
    enum ast_type result;
};

static inline int random_below(struct random_generator *g, int bound) {
    return (int)rng_below(&g->rng, (uint64_t)bound);
}
/* True once in `times`. */
static inline bool random_once_in(struct random_generator *g, int times) {
    return random_below(g, times) == 0;
}

void random_put(struct random_generator *g, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
enum ast_type random_triple(struct random_generator *g);
/* One of the program's fixed-point types; float when it has none. */
enum ast_type random_fixed(struct random_generator *g);
const char *random_type_word(enum ast_type type);

void random_start_line(struct random_generator *g);

/* random_declaration.c */
enum ast_type random_any_type(struct random_generator *g);
void random_choose_formats(struct random_generator *g);
struct random_variable *random_add_variable(struct random_generator *g, const char *name,
                                            enum ast_type type);
bool random_has_room(const struct random_generator *g);
/* " = " and a whole array of a type and length, or a triple; false when nothing was written. */
bool random_whole_array(struct random_generator *g, enum ast_type type, int length,
                        bool is_uniform);
void random_declare(struct random_generator *g);
void random_declare_string(struct random_generator *g);

/* random_expression.c; `is_uniform`: of literals and variables declared uniform only */
void random_expression(struct random_generator *g, enum ast_type type, int depth, bool is_uniform);
void random_condition(struct random_generator *g, int depth, bool is_uniform);
void random_index(struct random_generator *g, bool is_uniform);
/* A variable of this type that may be written to, not an array; NULL when there is none. */
const struct random_variable *random_target(struct random_generator *g, enum ast_type type);
/* An array of this type (TYPE_ERROR: any) that may be written to when `is_written`. */
const struct random_variable *random_array(struct random_generator *g, enum ast_type type,
                                           bool is_written, bool is_uniform);
/* A call; false when that cannot be here. */
bool random_call_of(struct random_generator *g, const struct random_function *f, int depth);
/* A call of a function that returns this type; false when there is none. */
bool random_call(struct random_generator *g, enum ast_type type, int depth);

#endif
