/* SPDX-License-Identifier: Apache-2.0 */
#ifndef LOWER_H
#define LOWER_H

#include "shaders/compiler/builtins.h"
#include "shaders/compiler/ir.h"

/* A value of the language as its scalars. */
struct ir_value {
    int count; /* 1 or 3; 0: nothing */
    struct ir_operand part[3];
    int array_length;           /* part[] are then array variables; of a matrix 16 times as long */
    struct ir_operand *strings; /* the elements of an array of strings, instead of part[] */
};

/* The flags that stand for break and continue of one loop. */
struct lower_loop {
    struct ir_variable *broken, *continued;
    bool is_illuminance;
    struct lower_loop *outer;
};

/* One inlined call. */
struct lower_call {
    struct ast_function *function;
    struct ir_value result;
    struct ir_variable *returned; /* NULL: no early return */
    struct lower_loop *loops;
    struct lower_call *caller;
};

/* Expressions recurse, a level for each operator. What one kind of expression needs stays out of
 * the frame that all kinds share: the stack of a level is then that of its own kind. */
#define LOWER_FRAME_OF_ITS_OWN __attribute__((noinline))

struct lowering {
    struct compilation *c;
    struct ir_program *ir;
    struct ir_list *list;  /* being appended to */
    struct ir_list *scope; /* where variables of the user are declared: never a guard */
    struct lower_call *call;
    int depth; /* of the recursion over the tree, through inlined functions: lower_deeper */
    const struct source_location *site; /* of the call into the prelude, NULL outside of it */
    bool in_default; /* evaluating a parameter's default: points are in shader space */
    struct ir_value light_direction, light_color; /* inside illuminance; count 0 outside */
    /* The lights at P where P may differ from the position of the sample: run once for the shader
     * (a condition), or each time anew. */
    struct ir_operand lights_at_p;
    int p_light_set, light_set; /* the sets of these, and of the last run of lights */
    bool position_changes;
    const struct checked_unit *units; /* all shaders of the program */
    int unit_count;
    struct ast_function *prelude;
    enum shader_kind kind; /* of the shader being lowered: several may make one program */
    const char *file;      /* that it is in */
    /* Of the predefined variables, by their number in `globals`: shared by all these shaders. */
    struct ir_value *global_values[GLOBALS_MAX];
    bool global_is_assigned[GLOBALS_MAX];
    struct ir_node *loads_end; /* the last node of what loads them, at the start of the program */
    struct ir_variable *random_calls; /* how often random() ran so far; NULL before the first */
};

/* lower_values.c */
/* Recursive functions add to l->depth what they weigh on the stack, and take it away again. */
void lower_deeper(struct lowering *l, const struct source_location *at, int depth);
const struct source_location *lower_at(struct lowering *l, const struct source_location *at);
struct ir_variable *lower_temporary(struct lowering *l, enum ir_type type);
struct ir_operand lower_operate(struct lowering *l, const struct source_location *at,
                                enum ir_operation operation, struct ir_operand a,
                                struct ir_operand b, struct ir_operand d);
struct ir_operand lower_unary(struct lowering *l, const struct source_location *at,
                              enum ir_operation op, struct ir_operand a);
struct ir_operand lower_binary(struct lowering *l, const struct source_location *at,
                               enum ir_operation op, struct ir_operand a, struct ir_operand b);
struct ir_operand lower_dot(struct lowering *l, const struct source_location *at,
                            const struct ir_value *a, const struct ir_value *b);
struct ir_value lower_cross(struct lowering *l, const struct source_location *at,
                            const struct ir_value *a, const struct ir_value *b);
struct ir_operand lower_length(struct lowering *l, const struct source_location *at,
                               const struct ir_value *a);
struct ir_value lower_each(struct lowering *l, const struct source_location *at,
                           enum ir_operation op, const struct ir_value *a,
                           const struct ir_value *b);
struct ir_value lower_normalize(struct lowering *l, const struct source_location *at,
                                const struct ir_value *a);
struct ir_value lower_constant(float number, int count);
void lower_move(struct lowering *l, const struct source_location *at, struct ir_variable *to,
                struct ir_operand from);
/* Copies scalars into variables, all read before the first is written. */
void lower_assign(struct lowering *l, const struct source_location *at, const struct ir_value *to,
                  const struct ir_value *from);
/* New variables for a value of this type, declared in l->scope. */
struct ir_value lower_variables(struct lowering *l, const struct source_location *at,
                                enum ast_type type, int array_length, const char *name,
                                enum ast_storage storage);
enum ir_type lower_type(enum ast_type type);
/* Opens a nested list: the node's control flow may be at most CONTROL_DEPTH_MAX deep. */
struct ir_node *lower_control(struct lowering *l, enum ir_node_kind kind,
                              const struct source_location *at);

/* lower_space.c */
struct ir_value lower_transform(struct lowering *l, const struct source_location *at,
                                enum ast_type type, const struct ir_operand *from,
                                const struct ir_operand *to, const struct ir_value *value);
/* The operand for a space written out; an error when there is no such space. */
struct ir_operand lower_space(struct lowering *l, const struct source_location *at,
                              const char *name);
struct ir_value lower_color_space(struct lowering *l, const struct ast_expression *e,
                                  const char *from, const char *to, const struct ir_value *value);

struct ir_value lower_ctransform(struct lowering *l, const struct ast_expression *e,
                                 const struct ir_value *arguments, int count);

/* Element `index` of the matrix from this space to camera space. */
struct ir_operand lower_space_element(struct lowering *l, const struct source_location *at,
                                      const struct ir_operand *space, int index);

/* lower_matrix.c: a matrix is one array variable of 16 floats */
void lower_matrix_copy(struct lowering *l, const struct source_location *at,
                       const struct ir_value *to, const struct ir_value *from);
/* A matrix without a name, for the list at hand. */
struct ir_value lower_matrix_temporary(struct lowering *l, const struct source_location *at);
struct ir_value lower_matrix_diagonal(struct lowering *l, const struct source_location *at,
                                      struct ir_operand number);
struct ir_value lower_matrix_tuple(struct lowering *l, struct ast_expression *e);
/* a b, or a times the inverse of b */
struct ir_value lower_matrix_binary(struct lowering *l, const struct source_location *at,
                                    bool divides, const struct ir_value *a,
                                    const struct ir_value *b);
struct ir_value lower_matrix_in_space(struct lowering *l, const struct source_location *at,
                                      const struct ir_operand *space, const struct ir_value *value);
struct ir_value lower_matrix_builtin(struct lowering *l, const struct ast_expression *e,
                                     const struct ir_value *arguments);

/* lower_fixed.c: operations on fixed-point numbers, with the format of their result */
struct ir_operand lower_fixed(struct lowering *l, const struct source_location *at,
                              enum ir_operation operation, struct fixed_format format,
                              struct ir_operand a, struct ir_operand b, struct ir_operand d);
struct ir_operand lower_fixed_number(float number);
/* a token b with token one of + - * / % */
struct ir_operand lower_fixed_binary(struct lowering *l, const struct source_location *at,
                                     int token, struct ir_operand a, struct ir_operand b);
struct ir_operand lower_fixed_negate(struct lowering *l, const struct source_location *at,
                                     struct ir_operand a);
/* To a fixed-point type from fixed-point, float or condition, or from fixed-point to float. */
struct ir_operand lower_fixed_convert(struct lowering *l, const struct source_location *at,
                                      struct ir_operand a, enum ast_type type);
/* A standard function whose arguments are fixed-point. */
struct ir_operand lower_fixed_call(struct lowering *l, const struct ast_expression *e,
                                   const struct ir_operand *a, int count);
static inline int lower_array_elements(enum ast_type type, const struct ir_value *array) {
    return array->array_length / (type == TYPE_MATRIX ? 16 : 1);
}
/* Copies an array of `length` elements, or a triple into an array of three, converting the
 * elements; complains when the array copied from has another length. */
void lower_array_convert(struct lowering *l, const struct source_location *at, enum ast_type type,
                         const struct ir_value *to, int length, enum ast_type from_type,
                         const struct ir_value *from);

/* lower_text.c */
/* A string written out. */
struct ir_operand lower_text(struct lowering *l, const char *text);
/* concat, format and match */
struct ir_value lower_text_builtin(struct lowering *l, const struct ast_expression *e);

/* lower_expression.c */
struct ir_value lower_expression(struct lowering *l, struct ast_expression *e);
/* The same for an operand or argument, with a copy of the variables it names when evaluating one of
 * the list `later` may assign to them: operands are evaluated from left to right. */
struct ir_value lower_operand(struct lowering *l, struct ast_expression *e,
                              const struct ast_expression *later);
/* lower_builtin.c */
struct ir_operand lower_mod(struct lowering *l, const struct source_location *at,
                            struct ir_operand a, struct ir_operand b);
struct ir_value lower_builtin(struct lowering *l, struct ast_expression *e);
/* lower_noise.c: the noises and random() */
struct ir_value lower_noise(struct lowering *l, struct ast_expression *e,
                            const struct ir_value *arguments, int count);
/* lower_spline.c */
struct ir_value lower_spline(struct lowering *l, struct ast_expression *e);
/* lower_call.c */
struct ir_value lower_user_call(struct lowering *l, struct ast_expression *e);
struct ir_value lower_prelude_call(struct lowering *l, const struct source_location *at,
                                   const char *name, const struct ir_value *argument);
/* lower_symbol.c: variables, parameters, predefined variables */
struct ir_value *lower_symbol(struct lowering *l, struct ast_symbol *symbol,
                              const struct source_location *at);
/* Makes the table of parameters of all shaders, and of all predefined variables that could be in a
 * transfer map; bind_parameters.c drops those that nothing reads. */
void lower_parameter_table(struct lowering *l, const struct checked_unit *units, int count);
enum { OPTIONS_MAX = 8 };
void lower_add_option(struct lowering *l, const char *name, int length);
/* Number `index` of an option, -1: whether it is known. */
struct ir_operand lower_load_option(struct lowering *l, const struct source_location *at,
                                    const char *name, int index);
/* Loads the parameters of one shader. */
void lower_parameters(struct lowering *l, struct ast_function *shader);
/* The predefined variable of this name. */
struct ir_value *lower_global(struct lowering *l, const struct ast_global *global,
                              const struct source_location *at);
/* lower_array.c: elements of arrays, matrices and strings included */
struct ir_value lower_array_load(struct lowering *l, const struct source_location *at,
                                 enum ast_type type, const struct ir_value *array,
                                 struct ir_operand index);
void lower_array_store(struct lowering *l, const struct source_location *at, enum ast_type type,
                       const struct ir_value *array, struct ir_operand index,
                       const struct ir_value *from);
void lower_array_copy(struct lowering *l, const struct source_location *at, enum ast_type type,
                      const struct ir_value *to, const struct ir_value *from, int length);
/* What can be assigned to: a variable, or an element of which the index is computed once. */
struct lower_target {
    const struct source_location *at;
    enum ast_type type;
    struct ir_value whole;
    struct ir_operand index;
    bool is_element;
};
struct lower_target lower_target_open(struct lowering *l, struct ast_expression *e);
struct ir_value lower_target_read(struct lowering *l, const struct lower_target *target);
void lower_target_write(struct lowering *l, const struct lower_target *target,
                        const struct ir_value *value);
/* lower_derivative.c */
struct ir_value lower_derivative(struct lowering *l, const struct ast_expression *e,
                                 const struct ir_value *arguments, int count);
/* |change to the right| + |change downwards| between samples */
struct ir_operand lower_sample_step(struct lowering *l, const struct source_location *at,
                                    struct ir_operand x);
/* lower_statement.c */
/* Whether neither break, continue (when `in_body`) nor return was reached by statements that leave
 * at most `exit_level` loops (ast_statement); a constant when there are none. */
struct ir_operand lower_still_running(struct lowering *l, const struct source_location *at,
                                      int exit_level, bool in_body);
void lower_statements(struct lowering *l, struct ast_statement *list);
/* lower_light.c */
void lower_illuminance(struct lowering *l, struct ast_statement *s);
void lower_illuminate(struct lowering *l, struct ast_statement *s);
/* Begins a surface shader: what came before it may have moved P, where the lights are wanted. */
void lower_lights_begin(struct lowering *l, const struct source_location *at,
                        bool changes_position);
/* lower_message.c: lightsource and the like */
struct ir_value lower_message(struct lowering *l, struct ast_expression *e);
/* lower_question.c: option, attribute, rendererinfo; depth */
struct ir_value lower_question(struct lowering *l, struct ast_expression *e);
struct ir_value lower_depth(struct lowering *l, struct ast_expression *e);
/* Adds to the table what the scene may be asked for. */
void lower_question_table(struct lowering *l);
/* What the light offers to those who ask. */
void lower_exports(struct lowering *l, const struct ast_function *shader);

#endif
