/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IR_H
#define IR_H

#include "base/simd_operations.h"
#include "shaders/compiler/ast.h"
#include "shaders/compiler/ir_operations.h"
#include "shaders/simd/shader_module.h"

/* Structured three-address code over scalar variables. Vectors and colours have been taken apart
 * and functions inlined, so that liveness, transfer map and costs are per component. Control flow
 * is nested lists of nodes: break, continue and return have become conditions. Instructions have no
 * side effects but on what they assign; a variable is zero when the list that declares it is
 * entered. Arena memory throughout. */

enum ir_operation {
#define IR_ENUM(name, types, cost, scalar, vector) IR_##name,
    IR_OPERATIONS(IR_ENUM)
#undef IR_ENUM
        IR_OPERATION_COUNT
};

struct ir_operation_info {
    const char *name, *types;
    int cost; /* enum simd_operation, or IR_FREE */
    const char *scalar, *vector;
};
enum { IR_FREE = -1 };
extern const struct ir_operation_info ir_operations[IR_OPERATION_COUNT];

enum ir_type { IR_FLOAT, IR_BOOL, IR_STRING, IR_FIXED };

struct ir_list;
struct ir_node;
struct call_site; /* call_sites.h */

struct ir_variable {
    int id;
    enum ir_type type;
    struct fixed_format format; /* of IR_FIXED */
    int array_length;           /* 0: one scalar */
    struct ir_list *home;
    const char *name;           /* the user's, NULL for a temporary */
    struct ir_variable *called; /* that is only a copy of it, and was replaced by it; or NULL */
    bool is_temporary;          /* assigned once */
    bool is_declared_uniform;
    bool is_forced_varying; /* declared so, or a result of the shader */
    bool is_demoted;        /* declared uniform, and varies all the same: infer_storage.c */
    bool is_varying;        /* infer_storage.c */
    bool is_live;           /* dead_code.c */
    bool is_tainted;        /* depends on an illuminance, blocks.c */
    bool in_prepare, in_shade, is_written_in_prepare, is_written_in_shade; /* hoist.c */
    int slot;                        /* first float in the uniform block, -1 when not there */
    int demanded_bits;               /* scratch of fixed_sizes.c */
    bool is_renamed;                 /* scratch of ssa.c */
    bool is_shared;                  /* of the stream that shaders run together */
    bool is_loaded;                  /* a bound value that is loaded into pixels by shader ID */
    struct ir_variable *declared;    /* that it is a web or an element of; NULL: its own */
    struct ir_variable **elements;   /* scratch of array_elements.c */
    bool is_indexed;                 /* likewise: by something not known here */
    int use_count, definition_count; /* scratch of merge_moves.c */
    bool is_read_early;              /* before any assignment, as the 0 it starts with */
    struct ir_node *definition;
    struct ir_use *uses; /* scratch of infer_storage.c and dead_code.c */
    struct ir_variable *next_in_home;
};

enum ir_operand_kind {
    OPERAND_NONE,
    OPERAND_VARIABLE,
    OPERAND_FLOAT,
    OPERAND_BOOL,
    OPERAND_STRING,
    OPERAND_FIXED
};

struct ir_operand {
    enum ir_operand_kind kind;
    union {
        struct ir_variable *variable;
        float number;
        int truth;
        int32_t identity;
        int64_t raw;
    };
    struct fixed_format format; /* of OPERAND_FIXED */
};

enum { IR_OPERANDS_MAX = 8 };

enum ir_node_kind { NODE_INSTRUCTION, NODE_IF, NODE_LOOP, NODE_ILLUMINANCE };

struct ir_list {
    struct ir_node *first, *last;
    struct ir_node *owner; /* NULL: the top level */
    struct ir_variable *variables;
};

struct ir_node {
    enum ir_node_kind kind;
    struct ir_node *next;
    struct ir_list *list; /* that it is in */
    const struct source_location *at;
    /* instruction */
    enum ir_operation operation;
    struct ir_variable *results[3];
    struct ir_variable *array;
    struct ir_operand operands[IR_OPERANDS_MAX];
    int index;
    struct shader_parameter *parameter;
    struct ast_function *external; /* that EXTERNAL0 ... call */
    int order;                     /* in the text, scratch of propagate_copies.c */
    bool is_free;                  /* loads what is in pixel memory already */
    bool is_shared;                /* of the stream that shaders run together */
    struct call_site *call_site;   /* of a mathematical function with a fast version, else NULL */
    bool is_fast;                  /* takes that version */
    /* if (condition) body else otherwise
     * loop: test; leave unless condition; body
     * illuminance: body once per light, for the samples it lights; the condition is of LIGHTS_AT,
     * or none for lights at the position of the sample */
    struct ir_operand condition;
    struct ir_list *test, *body, *otherwise;
    bool is_varying; /* the samples may go different ways */
    bool is_live, is_prepared;
    int light_set;              /* of an illuminance whose condition is of LIGHTS_AT: its index */
    int category;               /* of an illuminance: number in ir->categories, -1: all lights */
    int block, block_otherwise; /* -1: none of its own */
    bool has_blocks;            /* a counted block inside */
    enum shader_stream stream;
};

/* A string written out that run-time code may need the text of. */
struct ir_text {
    int32_t identity;
    const char *text;
    struct ir_text *next;
};

enum { CALL_SITE_BUCKETS = 1024 };
enum { NAMED_SPACES_MAX = 64, CATEGORIES_MAX = 64, QUERIES_MAX = 64, EXPORTS_MAX = 32 };

/* What lightsource("name", x) asks of lights, and what a light offers. */
struct ir_message {
    const char *name;
    int components;
    struct ir_variable *value[3]; /* of an offer */
};

struct ir_program {
    struct compilation *c;
    enum shader_kind kind;
    struct ir_list *top;
    struct ir_variable **variables;
    size_t variable_count, variable_capacity;
    int instruction_count;
    int control_depth;
    int array_floats;
    struct ir_variable *color[3];     /* Ci; Cl of a light; P of a displacement by itself */
    struct ir_variable *direction[3]; /* L of a light; N of a displacement by itself */
    struct ir_variable *lit;          /* of a light */
    bool is_ambient;                  /* a light without illuminate and solar */
    bool uses_illuminance, uses_ambient;
    bool uses_shared_lights; /* at the position of the sample */
    bool uses_texts;         /* strings are made at run time */
    struct ir_text *texts;
    int text_count;
    const char *categories[CATEGORIES_MAX];
    int category_count;
    struct ir_message queries[QUERIES_MAX], exports[EXPORTS_MAX];
    int query_count, export_count;
    /* Coordinate systems of the scene that are written out; any: one is chosen at run time. */
    struct {
        const char *name;
        bool is_used;
    } named_spaces[NAMED_SPACES_MAX];
    int named_space_count;
    bool uses_any_space;
    int light_sets;        /* sets of results of lights, the shared one included */
    bool is_making_shared; /* new nodes belong to the shared stream */
    bool uses_neighbours;  /* differences between samples */
    uint32_t spaces;
    int uniform_count;     /* floats of the uniform block */
    bool has_prepare_loop; /* slot 0 holds the overrun flag of prepare */
    struct shader_block *blocks;
    int block_count, block_capacity;
    struct shader_line_cost *line_costs;
    size_t line_cost_count, line_cost_capacity;
    struct call_site *call_sites, *call_site_buckets[CALL_SITE_BUCKETS];
    int call_site_count;
};

/* Floats that one value takes in the uniform block. */
static inline int ir_slot_floats(const struct ir_variable *variable) {
    return variable->type == IR_FIXED ? 2 : 1;
}

/* The results of the program: Ci; or L, Cl and lit; or P and N. */
enum { IR_RESULTS_MAX = 7 + 3 * EXPORTS_MAX };
int ir_results(const struct ir_program *ir, struct ir_variable *results[IR_RESULTS_MAX]);
/* Puts others in their place, in the same order. */
void ir_set_results(struct ir_program *ir, struct ir_variable *const *results);

struct ir_use {
    struct ir_node *node;
    struct ir_use *next;
};

/* ir.c: building */
struct ir_list *ir_list_new(struct ir_program *ir, struct ir_node *owner);
struct ir_variable *ir_variable_new(struct ir_program *ir, struct ir_list *home, enum ir_type type,
                                    const char *name);
struct ir_node *ir_node_new(struct ir_program *ir, struct ir_list *list, enum ir_node_kind kind,
                            const struct source_location *at);
static inline struct ir_operand ir_of(struct ir_variable *variable) {
    return (struct ir_operand){.kind = OPERAND_VARIABLE, .variable = variable};
}
static inline struct ir_operand ir_float(float number) {
    return (struct ir_operand){.kind = OPERAND_FLOAT, .number = number};
}
static inline struct ir_operand ir_bool(bool truth) {
    return (struct ir_operand){.kind = OPERAND_BOOL, .truth = truth};
}
static inline struct ir_operand ir_string(int32_t identity) {
    return (struct ir_operand){.kind = OPERAND_STRING, .identity = identity};
}
static inline struct ir_operand ir_fixed(int64_t raw, struct fixed_format format) {
    return (struct ir_operand){.kind = OPERAND_FIXED, .raw = raw, .format = format};
}
enum ir_type ir_operand_type(const struct ir_operand *operand);
/* Of a fixed-point operand. */
struct fixed_format ir_operand_format(const struct ir_operand *operand);
/* The type that a letter of ir_operations.h stands for; `array` is that of an ARRAY_ instruction.
 */
enum ir_type ir_letter_type(char letter, const struct ir_variable *array);
/* Whether an operation works on fixed-point numbers: its C is in emit_fixed.c, its price in
 * price_fixed.c. */
static inline bool ir_operation_is_fixed(enum ir_operation operation) {
    return operation >= IR_MOVE_FIXED && operation <= IR_FIXED_NOT_EQUAL;
}
static inline bool ir_operand_is_varying(const struct ir_operand *operand) {
    return operand->kind == OPERAND_VARIABLE && operand->variable->is_varying;
}
/* Whether the node copies a value unchanged, in the same format. */
static inline bool ir_is_move(const struct ir_node *node) {
    return node->kind == NODE_INSTRUCTION &&
           (node->operation == IR_MOVE || node->operation == IR_MOVE_BOOL ||
            node->operation == IR_MOVE_FIXED);
}
/* Whether an operation calls a function from outside: node->external. */
static inline bool ir_operation_is_external(enum ir_operation operation) {
    return operation >= IR_EXTERNAL0 && operation <= IR_EXTERNAL8;
}
/* How many operands the operation takes. */
static inline int ir_operand_count(enum ir_operation operation) {
    int count = 0;
    for (const char *type = ir_operations[operation].types + 1; *type; type++)
        count++;
    return count;
}
/* Whether `list` is `outer` or inside it. */
bool ir_list_is_inside(const struct ir_list *list, const struct ir_list *outer);
/* Whether an operand or the array read by the instruction varies. */
bool ir_instruction_reads_varying(const struct ir_node *node);
bool ir_instruction_is_varying(const struct ir_node *node);

/* Calls visit for every node, the nodes inside a node after it. */
typedef void ir_visit(struct ir_node *node, void *context);
void ir_each_node(struct ir_list *list, ir_visit *visit, void *context);
/* The same for every variable read by this node itself (operands, array loaded from, condition). */
typedef void ir_visit_variable(struct ir_variable *variable, void *context);
void ir_each_read(struct ir_node *node, ir_visit_variable *visit, void *context);
/* ... and written by it (an array stored to included). */
void ir_each_write(struct ir_node *node, ir_visit_variable *visit, void *context);

/* propagate_copies.c: what is known of single assignments. Counts definitions and numbers nodes;
 * every pass that asks the following calls this first. */
void ir_prepare_propagation(struct ir_program *ir);
/* Whether the variable has one value from its definition to the end of the list that declares it,
 * and nothing asks for it before. */
bool ir_variable_is_settled(const struct ir_variable *variable);
/* Replaces what the node reads by what it is only a copy of. */
void ir_propagate_into(struct ir_node *node);
/* Whether the results follow from operands, index and parameter alone, wherever the instruction
 * stands. */
static inline bool ir_operation_is_pure(enum ir_operation operation) {
    switch (operation) {
    case IR_ARRAY_LOAD:
    case IR_ARRAY_STORE:
    case IR_LIGHTS_AT: /* runs the lights */
    case IR_LIGHT_KNOWS:
    case IR_LIGHT_VALUE:
        return false;
    default:
        return ir_operations[operation].types[0] != '0';
    }
}

/* lower.c: the syntax trees as IR, on which the passes of passes.h work. Shaders run one after the
 * other on the same samples. `symbols` are the predefined variables in use, by their number in
 * `globals`. */
struct checked_unit {
    struct ast_unit *unit, *prelude;
    struct ast_symbol **symbols;
};
/* The kind of the program is that of `units[main]`. */
struct ir_program *lower_units(struct compilation *c, const struct checked_unit *units, int count,
                               int main);
/* Counts operations that the array is issued for a node: in its block and stream, on its line. The
 * node must have been through pass_blocks. */
void ir_count_operations(struct ir_program *ir, const struct ir_node *node, int operation,
                         int count);
/* Adds what a varying fixed-point operation costs to counts by simd_operation (price_fixed.c). */
void price_fixed(const struct ir_node *node, uint32_t *operations);
/* Stops the compilation with STATUS_INTERNAL when the IR breaks a rule of this file; `after` names
 * the pass. */
void ir_validate(struct ir_program *ir, const char *after, bool is_storage_known);

#endif
