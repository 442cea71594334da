/* SPDX-License-Identifier: Apache-2.0 */
#ifndef REFERENCE_INTERNAL_H
#define REFERENCE_INTERNAL_H

#include "reference_evaluator.h"

#include "shaders/compiler/builtins.h"

/* A value while an expression is evaluated: numbers, or a condition, or a string, or one number in
 * fixed-point. */
struct reference_value {
    int count; /* 1, 3 or 16 */
    float part[16];
    bool truth;
    int32_t identity;
    int64_t raw;
    struct fixed_format format;
};

/* Where a variable keeps its value. No symbol is alive twice, since there is no recursion. */
struct reference_slot {
    const struct ast_symbol *symbol;
    float *cells; /* element by element; those of an array argument are the caller's; of
                     fixed-point the raw bits, in two cells */
    float *own_cells;
    int length; /* elements, 0: not an array */
    int32_t identity;
    uint64_t generation; /* predefined variables: in which run it was set */
};

enum { REFERENCE_SLOTS = 1024 }; /* a power of two, more than symbols are */

struct reference {
    struct compilation *c;
    struct shader_compile_options options;
    struct ast_unit *unit;
    const struct ast_function *prelude;
    const struct ast_symbol *color, *direction; /* Ci or Cl, and L */
    bool fast_math;
    struct reference_slot slots[REFERENCE_SLOTS];
    /* of the run */
    const struct reference_world *world;
    uint64_t generation;
    bool in_default; /* in a parameter's default value: (x, y, z) is in shader space */
    const struct reference_light *light; /* inside illuminance */
    bool is_lit;
    float random_calls;
    uint64_t steps;
    bool has_overrun;
    struct reference_value result; /* of the function being run */
};

static inline int reference_width(enum ast_type type) {
    return type == TYPE_MATRIX ? 16 : ast_type_width(type);
}
static inline int reference_cell_count(enum ast_type type) {
    return ast_type_is_fixed(type) ? 2 : reference_width(type);
}

/* reference_evaluator.c */
struct reference_slot *reference_slot(struct reference *r, const struct ast_symbol *symbol);
/* The same, with the value that a predefined variable begins with. */
struct reference_slot *reference_variable(struct reference *r, const struct ast_symbol *symbol);
/* Component of a parameter or predefined variable, as the world gives it. */
float reference_input(struct reference *r, const char *name, int component, float otherwise);
struct reference_value reference_read(enum ast_type type, const float *cells);
void reference_write(enum ast_type type, float *cells, const struct reference_value *value);
/* Copies a whole array, or a triple, into an array. */
void reference_copy_whole(struct reference *r, const struct ast_expression *from,
                          struct reference_slot *to);
struct reference_value reference_evaluate(struct reference *r, const struct ast_expression *e);
/* Where the variable or element lies that an expression names. */
float *reference_cells(struct reference *r, const struct ast_expression *e);

/* reference_statements.c */
struct reference_value reference_call(struct reference *r, const struct ast_function *function,
                                      const struct ast_expression *arguments,
                                      const struct reference_value *given);

/* reference_functions.c */
struct reference_value reference_builtin(struct reference *r, const struct ast_expression *e);
/* By component; a single number stands for all. */
struct reference_value reference_each(int token, const struct reference_value *a,
                                      const struct reference_value *b);
float reference_cosine(const struct reference *r, float angle);
float reference_dot(const float a[3], const float b[3]);
/* The element that an index means: rounded down, the nearest there is; NaN is the first. */
int reference_index(float index, int length);
/* A point, vector or normal between spaces given by identity number. */
struct reference_value reference_transform(struct reference *r, enum ast_type type, int32_t from,
                                           int32_t to, const struct reference_value *value);
struct reference_value reference_color_space(struct reference *r, const char *from, const char *to,
                                             const struct reference_value *value);

/* reference_fixed.c. What these return has the format that the operation gives it. */
struct reference_value reference_fixed_number(float number, enum ast_type type);
float reference_fixed_float(const struct reference_value *value);
/* To a fixed-point type; `from` is float, condition or any fixed-point type. */
struct reference_value reference_fixed_convert(const struct reference_value *value,
                                               enum ast_type from, enum ast_type to);
/* + - * / and % */
struct reference_value reference_fixed_binary(int token, const struct reference_value *a,
                                              const struct reference_value *b);
struct reference_value reference_fixed_negate(const struct reference_value *a);
/* Negative, zero, positive: as a is less than, equal to, more than b. */
int reference_fixed_order(const struct reference_value *a, const struct reference_value *b);
struct reference_value reference_fixed_builtin(enum builtin_id id, const struct reference_value *a,
                                               int count);

/* reference_matrix.c */
struct reference_value reference_matrix_diagonal(float number);
struct reference_value reference_matrix_product(bool divides, const struct reference_value *a,
                                                const struct reference_value *b);
/* A matrix said in a space, in camera space. */
struct reference_value reference_matrix_in_space(struct reference *r, int32_t space,
                                                 const struct reference_value *matrix);
/* The functions of which the first argument is a matrix, but for setcomp. */
struct reference_value reference_matrix_builtin(struct reference *r, enum builtin_id id,
                                                const struct reference_value *arguments);
/* Which of 16: the nearest row and column there are. */
int reference_matrix_element(float row, float column);

#endif
