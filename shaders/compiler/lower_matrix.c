/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

/* Matrices, for row vectors and by rows as in the RenderMan Interface: p' = p M. A matrix is an
 * array variable of 16 floats; what is computed from one reads its elements. */

struct elements {
    struct ir_operand part[16];
};

static struct elements read_elements(struct lowering *l, const struct source_location *at,
                                     const struct ir_value *matrix) {
    struct elements m;
    for (int i = 0; i < 16; i++) {
        m.part[i] = lower_unary(l, at, IR_ARRAY_LOAD, ir_float((float)i));
        l->list->last->array = matrix->part[0].variable;
    }
    return m;
}

static void write_element(struct lowering *l, const struct source_location *at,
                          const struct ir_value *matrix, struct ir_operand index,
                          struct ir_operand number) {
    struct ir_node *store = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, lower_at(l, at));
    store->operation = IR_ARRAY_STORE;
    store->array = matrix->part[0].variable;
    store->operands[0] = index;
    store->operands[1] = number;
}

static void write_elements(struct lowering *l, const struct source_location *at,
                           const struct ir_value *matrix, const struct elements *m) {
    for (int i = 0; i < 16; i++)
        write_element(l, at, matrix, ir_float((float)i), m->part[i]);
}

struct ir_value lower_matrix_temporary(struct lowering *l, const struct source_location *at) {
    struct ir_list *scope = l->scope;
    l->scope = l->list; /* even in a guard: nothing outside of it reads the value */
    struct ir_value matrix = lower_variables(l, at, TYPE_MATRIX, 0, NULL, STORAGE_UNSAID);
    l->scope = scope;
    return matrix;
}

static struct ir_value new_matrix(struct lowering *l, const struct source_location *at,
                                  const struct elements *m) {
    struct ir_value matrix = lower_matrix_temporary(l, at);
    write_elements(l, at, &matrix, m);
    return matrix;
}

void lower_matrix_copy(struct lowering *l, const struct source_location *at,
                       const struct ir_value *to, const struct ir_value *from) {
    struct elements m = read_elements(l, at, from);
    write_elements(l, at, to, &m);
}

static struct elements diagonal(struct ir_operand number) {
    struct elements m;
    for (int i = 0; i < 16; i++)
        m.part[i] = i % 5 ? ir_float(0) : number;
    return m;
}

struct ir_value lower_matrix_diagonal(struct lowering *l, const struct source_location *at,
                                      struct ir_operand number) {
    struct elements m = diagonal(number);
    return new_matrix(l, at, &m);
}

struct ir_value lower_matrix_tuple(struct lowering *l, struct ast_expression *e) {
    struct elements m = diagonal(ir_float(0));
    int i = 0;
    for (struct ast_expression *a = e->arguments; a && i < 16; a = a->next)
        m.part[i++] = lower_operand(l, a, a->next).part[0];
    return new_matrix(l, &e->at, &m);
}

static struct ir_operand multiply(struct lowering *l, const struct source_location *at,
                                  struct ir_operand a, struct ir_operand b) {
    bool is_zero =
        (a.kind == OPERAND_FLOAT && a.number == 0) || (b.kind == OPERAND_FLOAT && b.number == 0);
    return is_zero ? ir_float(0) : lower_binary(l, at, IR_MULTIPLY, a, b);
}

static struct ir_operand add(struct lowering *l, const struct source_location *at,
                             struct ir_operand a, struct ir_operand b) {
    if (a.kind == OPERAND_FLOAT && a.number == 0)
        return b;
    if (b.kind == OPERAND_FLOAT && b.number == 0)
        return a;
    return lower_binary(l, at, IR_ADD, a, b);
}

static struct ir_operand cross(struct lowering *l, const struct source_location *at,
                               struct ir_operand a, struct ir_operand b, struct ir_operand c,
                               struct ir_operand d) {
    return lower_binary(l, at, IR_SUBTRACT, multiply(l, at, a, b), multiply(l, at, c, d));
}

static struct elements product(struct lowering *l, const struct source_location *at,
                               const struct elements *a, const struct elements *b) {
    struct elements m;
    for (int i = 0; i < 16; i++) {
        m.part[i] = ir_float(0);
        for (int k = 0; k < 4; k++)
            m.part[i] = add(l, at, m.part[i],
                            multiply(l, at, a->part[i / 4 * 4 + k], b->part[k * 4 + i % 4]));
    }
    return m;
}

/* The 2 x 2 determinants of the upper two rows (s) and of the lower two (c), Laplace's expansion.
 */
static struct ir_operand minors(struct lowering *l, const struct source_location *at,
                                const struct elements *m, struct ir_operand s[6],
                                struct ir_operand c[6]) {
    static const int pairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    const struct ir_operand *p = m->part;
    struct ir_operand sum = ir_float(0);
    for (int i = 0; i < 6; i++) {
        int a = pairs[i][0], b = pairs[i][1];
        s[i] = cross(l, at, p[a], p[4 + b], p[4 + a], p[b]);
        c[i] = cross(l, at, p[8 + a], p[12 + b], p[12 + a], p[8 + b]);
    }
    for (int i = 0; i < 6; i++) {
        struct ir_operand term = multiply(l, at, s[i], c[5 - i]);
        bool is_negative = i == 1 || i == 4;
        sum = add(l, at, sum, is_negative ? lower_unary(l, at, IR_NEGATE, term) : term);
    }
    return sum;
}

static struct elements inverse(struct lowering *l, const struct source_location *at,
                               const struct elements *m) {
    /* row and column of the element, then for each of three terms: element of m, minor */
    static const int element[16][3] = {{5, 6, 7}, {1, 2, 3}, {13, 14, 15}, {9, 10, 11},
                                       {4, 6, 7}, {0, 2, 3}, {12, 14, 15}, {8, 10, 11},
                                       {4, 5, 7}, {0, 1, 3}, {12, 13, 15}, {8, 9, 11},
                                       {4, 5, 6}, {0, 1, 2}, {12, 13, 14}, {8, 9, 10}};
    static const int minor[4][3] = {{5, 4, 3}, {5, 2, 1}, {4, 2, 0}, {3, 1, 0}};
    struct ir_operand s[6], c[6], determinant = minors(l, at, m, s, c);
    struct elements result;
    for (int i = 0; i < 16; i++) {
        const struct ir_operand *of = i % 4 < 2 ? c : s;
        struct ir_operand t[3];
        for (int k = 0; k < 3; k++)
            t[k] = multiply(l, at, m->part[element[i][k]], of[minor[i / 4][k]]);
        struct ir_operand sum = add(l, at, lower_binary(l, at, IR_SUBTRACT, t[0], t[1]), t[2]);
        if ((i / 4 + i) % 2)
            sum = lower_unary(l, at, IR_NEGATE, sum);
        result.part[i] = lower_binary(l, at, IR_DIVIDE, sum, determinant);
    }
    return result;
}

struct ir_value lower_matrix_binary(struct lowering *l, const struct source_location *at,
                                    bool divides, const struct ir_value *a,
                                    const struct ir_value *b) {
    struct elements x = read_elements(l, at, a), y = read_elements(l, at, b);
    if (divides)
        y = inverse(l, at, &y);
    x = product(l, at, &x, &y);
    return new_matrix(l, at, &x);
}

struct ir_value lower_matrix_in_space(struct lowering *l, const struct source_location *at,
                                      const struct ir_operand *space,
                                      const struct ir_value *value) {
    struct elements m = read_elements(l, at, value), to;
    for (int i = 0; i < 16; i++)
        to.part[i] = lower_space_element(l, at, space, i);
    m = product(l, at, &m, &to);
    return new_matrix(l, at, &m);
}

/* p M, v M and, for normals, n (M^-1)^T */
static struct ir_value transform(struct lowering *l, const struct source_location *at,
                                 enum ast_type type, const struct ir_value *matrix,
                                 const struct ir_value *value) {
    struct elements m = read_elements(l, at, matrix);
    struct ir_value result = {.count = 3};
    if (type == TYPE_NORMAL)
        m = inverse(l, at, &m);
    for (int j = 0; j < 3; j++) {
        struct ir_operand sum = ir_float(0);
        for (int i = 0; i < 3; i++)
            sum = add(l, at, sum,
                      multiply(l, at, value->part[i],
                               m.part[type == TYPE_NORMAL ? j * 4 + i : i * 4 + j]));
        result.part[j] = type == TYPE_POINT ? add(l, at, sum, m.part[12 + j]) : sum;
    }
    return result;
}

/* The rotation about an axis, for row vectors. */
static struct elements rotation(struct lowering *l, const struct source_location *at,
                                struct ir_operand angle, const struct ir_value *direction) {
    struct ir_value axis = lower_normalize(l, at, direction);
    struct ir_operand c = lower_unary(l, at, IR_COS, angle), s = lower_unary(l, at, IR_SIN, angle);
    struct ir_operand rest = lower_binary(l, at, IR_SUBTRACT, ir_float(1), c);
    struct elements m = diagonal(ir_float(1));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            struct ir_operand both =
                multiply(l, at, rest, multiply(l, at, axis.part[i], axis.part[j]));
            struct ir_operand turn = i == j ? c : multiply(l, at, s, axis.part[3 - i - j]);
            bool is_plus = i == j || (i + 1) % 3 == j;
            m.part[i * 4 + j] = lower_binary(l, at, is_plus ? IR_ADD : IR_SUBTRACT, both, turn);
        }
    return m;
}

/* translate, rotate and scale apply theirs before m, as the requests of the same names do. */
static struct ir_value append(struct lowering *l, const struct ast_expression *e,
                              const struct ir_value *arguments) {
    struct elements m = read_elements(l, &e->at, &arguments[0]), first = diagonal(ir_float(1));
    if (e->builtin->id == BUILTIN_ROTATE)
        first = rotation(l, &e->at, arguments[1].part[0], &arguments[2]);
    for (int i = 0; i < 3 && e->builtin->id != BUILTIN_ROTATE; i++)
        first.part[e->builtin->id == BUILTIN_SCALE ? i * 5 : 12 + i] = arguments[1].part[i];
    m = product(l, &e->at, &first, &m);
    return new_matrix(l, &e->at, &m);
}

static struct ir_operand element_index(struct lowering *l, const struct ast_expression *e,
                                       const struct ir_value *arguments) {
    struct ir_operand part[2];
    for (int i = 0; i < 2; i++) { /* each the nearest row or column */
        part[i] = lower_unary(l, &e->at, IR_FLOOR, arguments[i + 1].part[0]);
        part[i] = lower_binary(l, &e->at, IR_MIN,
                               lower_binary(l, &e->at, IR_MAX, part[i], ir_float(0)), ir_float(3));
    }
    return lower_binary(l, &e->at, IR_ADD,
                        lower_binary(l, &e->at, IR_MULTIPLY, part[0], ir_float(4)), part[1]);
}

struct ir_value lower_matrix_builtin(struct lowering *l, const struct ast_expression *e,
                                     const struct ir_value *arguments) {
    struct ir_value result = {.count = 1};
    struct ir_operand s[6], c[6];
    struct elements m;
    switch (e->builtin->id) {
    case BUILTIN_TRANSFORM:
        return transform(l, &e->at, TYPE_POINT, &arguments[0], &arguments[1]);
    case BUILTIN_VTRANSFORM:
        return transform(l, &e->at, TYPE_VECTOR, &arguments[0], &arguments[1]);
    case BUILTIN_NTRANSFORM:
        return transform(l, &e->at, TYPE_NORMAL, &arguments[0], &arguments[1]);
    case BUILTIN_DETERMINANT:
        m = read_elements(l, &e->at, &arguments[0]);
        result.part[0] = minors(l, &e->at, &m, s, c);
        return result;
    case BUILTIN_COMP:
        result.part[0] = lower_unary(l, &e->at, IR_ARRAY_LOAD, element_index(l, e, arguments));
        l->list->last->array = arguments[0].part[0].variable;
        return result;
    case BUILTIN_SETCOMP:
        write_element(l, &e->at, &arguments[0], element_index(l, e, arguments),
                      arguments[3].part[0]);
        return lower_constant(0, 1);
    default:
        return append(l, e, arguments);
    }
}
