/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

/* Derivatives, from differences between neighbouring samples: every 2 x 2 samples of the picture
 * are a quad, and a sample knows how a value changes to the right and downwards inside its quad
 * (shader_module.h). What is asked for along u and v follows by the chain rule, so that Du and Dv
 * need u and v; what is asked for as a size needs neither. */

static struct ir_operand op1(struct lowering *l, const struct source_location *at,
                             enum ir_operation op, struct ir_operand a) {
    return lower_unary(l, at, op, a);
}

static struct ir_operand op2(struct lowering *l, const struct source_location *at,
                             enum ir_operation op, struct ir_operand a, struct ir_operand b) {
    return lower_binary(l, at, op, a, b);
}

static struct ir_operand choose(struct lowering *l, const struct source_location *at,
                                struct ir_operand condition, struct ir_operand yes,
                                struct ir_operand no) {
    return lower_operate(l, at, IR_SELECT, condition, yes, no);
}

/* The change to the right (way 0) or downwards (way 1); none where there is no neighbour. */
static struct ir_operand difference(struct lowering *l, const struct source_location *at, int way,
                                    struct ir_operand x) {
    if (x.kind != OPERAND_VARIABLE || l->kind == SHADER_KIND_LIGHT || l->kind == SHADER_KIND_IMAGER)
        return ir_float(0);
    l->ir->uses_neighbours = true;
    return op1(l, at, way ? IR_DIFFERENCE_Y : IR_DIFFERENCE_X, x);
}

static struct ir_value differences(struct lowering *l, const struct source_location *at, int way,
                                   const struct ir_value *x) {
    struct ir_value value = {.count = x->count};
    for (int i = 0; i < x->count; i++)
        value.part[i] = difference(l, at, way, x->part[i]);
    return value;
}

struct ir_operand lower_sample_step(struct lowering *l, const struct source_location *at,
                                    struct ir_operand x) {
    struct ir_operand right = difference(l, at, 0, x), down = difference(l, at, 1, x);
    return op2(l, at, IR_ADD, op1(l, at, IR_ABS, right), op1(l, at, IR_ABS, down));
}

/* a / b, or 0 where b is 0 */
static struct ir_operand quotient(struct lowering *l, const struct source_location *at,
                                  struct ir_operand a, struct ir_operand b) {
    struct ir_operand is_zero = op2(l, at, IR_EQUAL, b, ir_float(0));
    struct ir_operand safe = choose(l, at, is_zero, ir_float(1), b);
    return choose(l, at, is_zero, ir_float(0), op2(l, at, IR_DIVIDE, a, safe));
}

/* How u and v change between samples, and the determinant of the four. */
struct grid {
    struct ir_operand u[2], v[2], determinant;
};

static struct grid read_grid(struct lowering *l, const struct source_location *at) {
    struct ir_operand u = lower_global(l, global_find("u"), at)->part[0];
    struct ir_operand v = lower_global(l, global_find("v"), at)->part[0];
    struct grid g;
    for (int way = 0; way < 2; way++) {
        g.u[way] = difference(l, at, way, u);
        g.v[way] = difference(l, at, way, v);
    }
    g.determinant = op2(l, at, IR_SUBTRACT, op2(l, at, IR_MULTIPLY, g.u[0], g.v[1]),
                        op2(l, at, IR_MULTIPLY, g.u[1], g.v[0]));
    return g;
}

/* dx/du = (dx/di dv/dj - dx/dj dv/di) / determinant, dx/dv likewise with u; 0 where u and v stand
 * still. */
static struct ir_operand along(struct lowering *l, const struct source_location *at,
                               const struct grid *g, bool is_v, struct ir_operand x) {
    const struct ir_operand *other = is_v ? g->u : g->v;
    struct ir_operand a = op2(l, at, IR_MULTIPLY, difference(l, at, 0, x), other[1]);
    struct ir_operand b = op2(l, at, IR_MULTIPLY, difference(l, at, 1, x), other[0]);
    struct ir_operand top = is_v ? op2(l, at, IR_SUBTRACT, b, a) : op2(l, at, IR_SUBTRACT, a, b);
    return quotient(l, at, top, g->determinant);
}

static struct ir_value all_along(struct lowering *l, const struct source_location *at,
                                 const struct grid *g, bool is_v, const struct ir_value *x) {
    struct ir_value value = {.count = x->count};
    for (int i = 0; i < x->count; i++)
        value.part[i] = along(l, at, g, is_v, x->part[i]);
    return value;
}

/* Deriv(x, y) = Du(x) / Du(y) + Dv(x) / Dv(y), of which a term with y at rest counts nothing */
static struct ir_value total(struct lowering *l, const struct source_location *at,
                             const struct ir_value *x, struct ir_operand y) {
    struct grid g = read_grid(l, at);
    struct ir_operand yu = along(l, at, &g, false, y), yv = along(l, at, &g, true, y);
    struct ir_value value = {.count = x->count};
    for (int i = 0; i < x->count; i++)
        value.part[i] = op2(l, at, IR_ADD, quotient(l, at, along(l, at, &g, false, x->part[i]), yu),
                            quotient(l, at, along(l, at, &g, true, x->part[i]), yv));
    return value;
}

/* The parallelogram between samples. */
static struct ir_value spanned(struct lowering *l, const struct source_location *at,
                               const struct ir_value *p) {
    struct ir_value right = differences(l, at, 0, p), down = differences(l, at, 1, p);
    return lower_cross(l, at, &right, &down);
}

/* Square to what P spans, on the side of N; N itself where a sample has no neighbours. */
static struct ir_value normal_of(struct lowering *l, const struct source_location *at,
                                 const struct ir_value *p) {
    struct ir_value n = spanned(l, at, p), old = *lower_global(l, global_find("N"), at);
    struct ir_operand is_none = op2(l, at, IR_EQUAL, lower_dot(l, at, &n, &n), ir_float(0));
    struct ir_operand turns = op2(l, at, IR_LESS, lower_dot(l, at, &n, &old), ir_float(0));
    for (int i = 0; i < 3; i++) {
        n.part[i] = choose(l, at, turns, op1(l, at, IR_NEGATE, n.part[i]), n.part[i]);
        n.part[i] = choose(l, at, is_none, old.part[i], n.part[i]);
    }
    return n;
}

static struct ir_operand area_of(struct lowering *l, const struct source_location *at,
                                 const struct ir_value *p) {
    struct ir_value n = spanned(l, at, p);
    return lower_length(l, at, &n);
}

static struct ir_operand at_least(struct lowering *l, const struct source_location *at,
                                  struct ir_operand x) {
    return op2(l, at, IR_MAX, x, ir_float(1e-6f));
}

/* filterstep(edge, x) over the width of a sample, filterstep(edge, x0, x1) over that stretch;
 * "width" scales it. Whatever "filter" names is a box. */
static struct ir_operand filtered_step(struct lowering *l, const struct ast_expression *e,
                                       const struct ir_value *a, int count) {
    const struct source_location *at = &e->at;
    const struct ast_expression *name = e->arguments->next->next;
    struct ir_operand edge = a[0].part[0], from = a[1].part[0], width;
    int first = count >= 3 && name->type == TYPE_FLOAT ? 3 : 2;
    if (first == 3) {
        struct ir_operand to = a[2].part[0];
        width = op1(l, at, IR_ABS, op2(l, at, IR_SUBTRACT, to, from));
        from = op2(l, at, IR_MULTIPLY, op2(l, at, IR_ADD, from, to), ir_float(0.5f));
        name = name->next;
    } else {
        width = lower_sample_step(l, at, from);
    }
    for (int i = first; name && name->next; name = name->next->next, i += 2)
        if (name->kind == EXPRESSION_STRING && name->name[0] == 'w' && a[i + 1].count)
            width = op2(l, at, IR_MULTIPLY, width, a[i + 1].part[0]);
    width = at_least(l, at, width);
    struct ir_operand over = op2(l, at, IR_SUBTRACT, from, edge);
    struct ir_operand part = op2(l, at, IR_ADD, op2(l, at, IR_DIVIDE, over, width), ir_float(0.5f));
    return op2(l, at, IR_MIN, op2(l, at, IR_MAX, part, ir_float(0)), ir_float(1));
}

static struct ir_value scalar(struct ir_operand operand) {
    return (struct ir_value){.count = 1, .part = {operand}};
}

struct ir_value lower_derivative(struct lowering *l, const struct ast_expression *e,
                                 const struct ir_value *a, int count) {
    const struct source_location *at = &e->at;
    struct grid g;
    if (l->kind == SHADER_KIND_LIGHT || l->kind == SHADER_KIND_IMAGER)
        compile_warning(l->c, lower_at(l, at), "%s() finds no change between samples in %s shaders",
                        e->name, shader_kind_name(l->kind));
    switch (e->builtin->id) {
    case BUILTIN_DU:
    case BUILTIN_DV:
        g = read_grid(l, at);
        return all_along(l, at, &g, e->builtin->id == BUILTIN_DV, &a[0]);
    case BUILTIN_DERIV:
        return total(l, at, &a[0], a[1].part[0]);
    case BUILTIN_AREA:
        return scalar(area_of(l, at, &a[0]));
    case BUILTIN_CALCULATENORMAL:
        return normal_of(l, at, &a[0]);
    case BUILTIN_FILTERWIDTH:
        return scalar(at_least(l, at, lower_sample_step(l, at, a[0].part[0])));
    case BUILTIN_FILTERWIDTHP:
        return scalar(at_least(l, at, op1(l, at, IR_SQRT, area_of(l, at, &a[0]))));
    default:
        return scalar(filtered_step(l, e, a, count));
    }
}
