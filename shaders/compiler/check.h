/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CHECK_H
#define CHECK_H

#include "shaders/compiler/builtins.h"

/* Names in scope: a hash table of which leaving a scope undoes what entering it added. */
enum { SCOPE_BUCKETS = 1024 };

struct scope_entry {
    const char *name;
    struct ast_symbol *symbol; /* one of the two */
    struct ast_function *function;
    int level;
    struct scope_entry *below;    /* same bucket */
    struct scope_entry *previous; /* order of entry */
};

struct checker {
    struct compilation *c;
    struct ast_function *prelude;
    enum shader_kind kind;
    struct scope_entry *buckets[SCOPE_BUCKETS];
    struct scope_entry *newest;
    int level;
    struct ast_function *function; /* being checked */
    int loop_level;                /* loops around the statement, inside the function */
    int illuminance_level;
    bool in_default; /* a parameter's default value */
    struct ast_symbol *global_symbols[GLOBALS_MAX];
};

void scope_enter(struct checker *k);
void scope_leave(struct checker *k);
void scope_add_symbol(struct checker *k, struct ast_symbol *symbol);
void scope_add_function(struct checker *k, struct ast_function *function);
/* The innermost variable or predefined variable of this name, else NULL. */
struct ast_symbol *scope_find_symbol(struct checker *k, const char *name);
/* The entry of the innermost function of this name; with `after`, the next of the same scope, which
 * takes other arguments. NULL: none. */
struct scope_entry *scope_find_function(struct checker *k, const char *name,
                                        struct scope_entry *after);

/* Gives the expression and all in it types and symbols. `wanted`: the type the context would like,
 * TYPE_ERROR for none. Returns what takes the expression's place. */
struct ast_expression *check_expression(struct checker *k, struct ast_expression *e,
                                        enum ast_type wanted);
/* The same, then converted to `type`; an error when that cannot be. */
struct ast_expression *check_as(struct checker *k, struct ast_expression *e, enum ast_type type);
/* Puts a conversion over a checked expression. */
struct ast_expression *check_convert(struct checker *k, struct ast_expression *e,
                                     enum ast_type type);
bool color_space_is_known(const char *name);
#define COLOR_SPACES "rgb, hsv, hsl, YIQ and xyz"
/* Fixed-point, check_fixed.c. A number written out becomes fixed-point; nothing else changes. */
void check_fixed_number(struct ast_expression *e);
/* Brings two operands together when one is fixed-point. */
void check_fixed_pair(struct checker *k, struct ast_expression **a, struct ast_expression **b);
enum ast_type fixed_arithmetic_type(int token, enum ast_type a, enum ast_type b);
enum ast_type fixed_common_type(enum ast_type a, enum ast_type b);
enum ast_type fixed_negated_type(enum ast_type a);
/* The result of a standard function on fixed-point arguments. */
enum ast_type fixed_call_type(enum builtin_id id, const enum ast_type *types, int count);
/* Whether the value can be copied into the array as a whole. */
bool check_array_fits(const struct ast_expression *from, const struct ast_symbol *to);
/* Function calls, check_call.c. */
struct ast_expression *check_call(struct checker *k, struct ast_expression *e,
                                  enum ast_type wanted);
/* Something is written to; complains unless it can be. */
void check_written(struct checker *k, struct ast_expression *target);
void check_function(struct checker *k, struct ast_function *function);

#endif
