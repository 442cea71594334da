/* SPDX-License-Identifier: Apache-2.0 */
#ifndef AST_H
#define AST_H

#include "shaders/compiler/compilation.h"
#include "shaders/compiler/fixed_format.h"

/* The syntax tree. The parser fills in structure, check.c the types, symbols and implicit
 * conversions. Everything lives in the compilation's arena. */

/* The first seven are those of shader_compile.h. A triple is `(x, y, z)` before its context says
 * whether it is a colour or a point; TYPE_ERROR is the type of what was already complained about.
 */
enum ast_type {
    TYPE_FLOAT = SHADER_FLOAT,
    TYPE_COLOR = SHADER_COLOR,
    TYPE_POINT = SHADER_POINT,
    TYPE_VECTOR = SHADER_VECTOR,
    TYPE_NORMAL = SHADER_NORMAL,
    TYPE_STRING = SHADER_STRING,
    TYPE_MATRIX = SHADER_MATRIX,
    TYPE_TRIPLE,
    TYPE_BOOL,
    TYPE_VOID,
    TYPE_ERROR,
    /* Fixed-point types carry their format in the number: ast_type_fixed() makes them. */
    TYPE_FIXED_FLAG = 1 << 24,
    TYPE_ANY_FIXED = TYPE_FIXED_FLAG, /* of an argument: whatever its format */
};

const char *ast_type_name(enum ast_type type);
static inline enum ast_type ast_type_fixed(struct fixed_format format) {
    return (enum ast_type)(TYPE_FIXED_FLAG | format.is_unsigned << 20 |
                           (format.exponent - FIXED_EXPONENT_MIN) << 8 | format.size);
}
static inline bool ast_type_is_fixed(enum ast_type type) {
    return (type & TYPE_FIXED_FLAG) != 0;
}
static inline struct fixed_format ast_type_format(enum ast_type type) {
    return (struct fixed_format){(int16_t)(type & 0xff),
                                 (int16_t)((type >> 8 & 0xfff) + FIXED_EXPONENT_MIN),
                                 (type >> 20 & 1) != 0};
}
static inline bool ast_type_is_triple(enum ast_type type) {
    return (type >= TYPE_COLOR && type <= TYPE_NORMAL) || type == TYPE_TRIPLE;
}
static inline bool ast_type_is_geometric(enum ast_type type) {
    return type >= TYPE_POINT && type <= TYPE_NORMAL;
}
/* Scalars of one value. */
static inline int ast_type_width(enum ast_type type) {
    return ast_type_is_triple(type) ? 3 : 1;
}

/* How the values of an array come into the shader's space (PF section 3.1). */
enum ast_transform {
    TRANSFORM_NONE = SHADER_TRANSFORM_NONE,
    TRANSFORM_POINT = SHADER_TRANSFORM_POINT,
    TRANSFORM_VECTOR = SHADER_TRANSFORM_VECTOR,
    TRANSFORM_NORMAL = SHADER_TRANSFORM_NORMAL,
    TRANSFORM_TEXTURE = SHADER_TRANSFORM_TEXTURE,
};

enum ast_storage { STORAGE_UNSAID, STORAGE_UNIFORM, STORAGE_VARYING };

struct ast_function;
struct ast_global;
struct builtin;
struct ir_value;

/* A variable, formal parameter, shader parameter or predefined variable. */
struct ast_symbol {
    const char *name;
    enum ast_type type;
    int array_length; /* 0: not an array; -1: formal array of any length */
    enum ast_storage storage;
    enum ast_transform transform; /* of an array of three: pfman's transformation attributes */
    bool is_unit;                 /* normalised before the shader sees it */
    bool is_output;
    bool is_formal;    /* of a function (not of the shader) */
    bool is_parameter; /* of the shader */
    bool is_assigned;
    const struct ast_function
        *owner; /* the function or shader it is declared in; NULL: predefined */
    const struct ast_global *global; /* predefined variable, or NULL */
    struct source_location at;
    struct ast_expression *initial;  /* NULL: none */
    struct ast_expression *elements; /* list of array initialisers */
    struct ast_symbol *next;         /* parameter list */
    struct ir_value *value;          /* where lowering keeps it at the moment */
};

enum ast_expression_kind {
    EXPRESSION_NUMBER,      /* number */
    EXPRESSION_STRING,      /* name */
    EXPRESSION_NAME,        /* name, symbol */
    EXPRESSION_INDEX,       /* left[right]; left is a name */
    EXPRESSION_TUPLE,       /* (arguments) */
    EXPRESSION_UNARY,       /* operator left */
    EXPRESSION_BINARY,      /* left operator right */
    EXPRESSION_CONDITIONAL, /* left ? right : third */
    EXPRESSION_ASSIGN,      /* left = right; or operator: left += right */
    EXPRESSION_CAST,        /* type [name] left, as written */
    EXPRESSION_CONVERT,     /* left converted to type, put in by check.c */
    EXPRESSION_CALL,        /* name(arguments); function or builtin */
};

struct ast_expression {
    enum ast_expression_kind kind;
    enum ast_type type;
    int array_length; /* of a whole array named as an argument */
    int token;        /* of the operator; 0 for plain = */
    int depth;        /* of the tree, so that recursion over it is bounded */
    bool has_effects; /* evaluating it may assign to a variable */
    float number;
    const char *name;
    struct source_location at;
    struct ast_expression *left, *right, *third;
    struct ast_expression *arguments; /* list through next */
    int argument_count;
    struct ast_expression *next;
    struct ast_symbol *symbol;
    struct ast_function *function;
    const struct builtin *builtin;
    int overload; /* of the builtin */
};

enum ast_statement_kind {
    STATEMENT_EMPTY,
    STATEMENT_EXPRESSION, /* expression */
    STATEMENT_DECLARE,    /* symbol with its initial value */
    STATEMENT_FUNCTION,   /* a nested function: nothing to run */
    STATEMENT_BLOCK,      /* body: list; is_scope false for `float a, b;` */
    STATEMENT_IF,         /* expression, body, otherwise */
    STATEMENT_FOR,      /* initial; expression; step: body. initial and step are lists through next;
                           `while` has neither. */
    STATEMENT_BREAK,    /* level */
    STATEMENT_CONTINUE, /* level */
    STATEMENT_RETURN,   /* expression or NULL */
    STATEMENT_ILLUMINANCE,
    STATEMENT_ILLUMINATE,
    STATEMENT_SOLAR, /* arguments, body */
};

/* What an extern "C" function takes at most. */
enum { EXTERNAL_PARAMETERS_MAX = 8 };

/* Leaves a function, not only loops. */
enum { EXIT_FUNCTION = 1 << 20 };

struct ast_statement {
    enum ast_statement_kind kind;
    struct source_location at;
    struct ast_expression *expression, *initial, *step;
    struct ast_expression *arguments;
    int argument_count;
    const char *category; /* of an illuminance, NULL: any light */
    struct ast_statement *body, *otherwise;
    struct ast_symbol *symbol;
    struct ast_function *function;
    int level;
    bool is_scope;
    int exit_level; /* loops that break, continue or return inside may leave; EXIT_FUNCTION for
                       return */
    struct ast_statement *next;
};

/* A user function, one of the prelude, or the shader itself. */
struct ast_function {
    const char *name;
    enum ast_type type; /* of the result */
    struct source_location at;
    struct ast_symbol *formals;
    int formal_count;
    struct ast_statement *body; /* list */
    bool is_shader, is_prelude;
    bool is_prototype;  /* announced only; in no list */
    bool is_external;   /* extern "C": no body, comes with the object of the command line */
    bool returns_early; /* has a return other than as its last statement */
    bool has_outputs;   /* writes to output parameters or to variables outside of it */
    bool is_checked;
    bool is_being_lowered;
    int external_number; /* in the generated C, from 1; 0: not called */
    struct ast_function *next;
};

struct ast_unit {
    struct ast_function *functions; /* before the shader, in order */
    struct ast_function *shader;    /* NULL: none found (an error was reported) */
    enum shader_kind kind;
};

/* Parses the whole text; errors are reported to the compilation and skipped over. `is_prelude`:
 * functions only. */
struct ast_unit *parse_unit(struct compilation *c, const char *file, const char *text,
                            size_t length, bool is_prelude);

/* Resolves names and types in place. The functions of `prelude` are visible to `unit`. Returns the
 * predefined variables in use, by their number in `globals` (builtins.h). */
struct ast_symbol **check_unit(struct compilation *c, struct ast_unit *unit,
                               struct ast_unit *prelude);

/* The source of the standard lighting functions. */
extern const char prelude_text[];

#endif
