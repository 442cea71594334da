/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"
#include "shaders/compiler/splines.h"

#include <string.h>

static const struct spline_basis bases[] = {
    {"catmull-rom",
     1,
     {{-0.5f, 1.5f, -1.5f, 0.5f}, {1, -2.5f, 2, -0.5f}, {-0.5f, 0, 0.5f, 0}, {0, 1, 0, 0}}},
    {"bezier", 3, {{-1, 3, -3, 1}, {3, -6, 3, 0}, {-3, 3, 0, 0}, {1, 0, 0, 0}}},
    {"bspline",
     1,
     {{-0x1.555556p-3f, 0.5f, -0.5f, 0x1.555556p-3f},
      {0.5f, -1, 0.5f, 0},
      {-0.5f, 0, 0.5f, 0},
      {0x1.555556p-3f, 0x1.555556p-1f, 0x1.555556p-3f, 0}}},
    {"hermite", 2, {{2, 1, -2, 1}, {-3, -2, 3, -1}, {0, 1, 0, 0}, {1, 0, 0, 0}}},
    {"linear", 1, {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, -1, 1, 0}, {0, 1, 0, 0}}},
};

const struct spline_basis *spline_basis_find(const char *name) {
    for (size_t i = 0; i < sizeof bases / sizeof *bases; i++)
        if (!strcmp(bases[i].name, name))
            return &bases[i];
    return NULL;
}

struct spline {
    const struct spline_basis *basis;
    int spans, count;
    struct ir_operand segment, t;
    struct ir_operand
        reached[BUILTIN_ARGUMENTS_MAX]; /* of segment k: whether it or a later one is meant */
    struct ir_value values[BUILTIN_ARGUMENTS_MAX]; /* the list, or one array */
};

/* Where along the values: segment 0 ... spans - 1 and the rest 0 <= t <= 1 in it. */
static void find_segment(struct lowering *l, struct spline *s, const struct source_location *at,
                         struct ir_operand x) {
    x = lower_binary(l, at, IR_MAX, x, ir_float(0));
    x = lower_binary(l, at, IR_MIN, x, ir_float(1));
    s->t = lower_binary(l, at, IR_MULTIPLY, x, ir_float((float)s->spans));
    if (s->spans == 1) {
        s->segment = ir_float(0);
        return;
    }
    s->segment = lower_binary(l, at, IR_MIN, lower_unary(l, at, IR_FLOOR, s->t),
                              ir_float((float)(s->spans - 1)));
    s->t = lower_binary(l, at, IR_SUBTRACT, s->t, s->segment);
}

/* How much value j of a segment counts; no operand when not at all. */
static struct ir_operand weight(struct lowering *l, const struct spline *s,
                                const struct source_location *at, int j) {
    struct ir_operand sum = {0};
    for (int power = 0; power < 4; power++) {
        float c = s->basis->matrix[power][j];
        if (sum.kind)
            sum = lower_binary(l, at, IR_MULTIPLY, sum, s->t);
        if (c != 0)
            sum = sum.kind ? lower_binary(l, at, IR_ADD, sum, ir_float(c)) : ir_float(c);
    }
    return sum;
}

/* Value j of the segment that is meant: looked up in an array, chosen one by one from a list. */
static struct ir_value value_in_segment(struct lowering *l, struct spline *s,
                                        const struct source_location *at, int j) {
    struct ir_value value = s->values[0].array_length ? s->values[0] : s->values[j];
    int step = s->basis->step;
    if (s->values[0].array_length) {
        struct ir_operand index =
            lower_binary(l, at, IR_MULTIPLY, s->segment, ir_float((float)step));
        if (j)
            index = lower_binary(l, at, IR_ADD, index, ir_float((float)j));
        for (int i = 0; i < value.count; i++) {
            struct ir_variable *array = value.part[i].variable;
            value.part[i] = lower_unary(l, at, IR_ARRAY_LOAD, index);
            l->list->last->array = array;
        }
        value.array_length = 0;
        return value;
    }
    for (int k = 1; k < s->spans; k++) {
        if (!s->reached[k].kind)
            s->reached[k] = lower_binary(l, at, IR_LESS_EQUAL, ir_float((float)k), s->segment);
        for (int i = 0; i < value.count; i++)
            value.part[i] = lower_operate(l, at, IR_SELECT, s->reached[k],
                                          s->values[k * step + j].part[i], value.part[i]);
    }
    return value;
}

static struct ir_value lower_with_basis(struct lowering *l, struct ast_expression *e,
                                        struct spline *s, struct ir_operand where) {
    struct ir_value sum = {0};
    int length = s->values[0].array_length ? s->values[0].array_length : s->count;
    memset(s->reached, 0, sizeof s->reached);
    if (length < 4 || (length - 4) % s->basis->step) {
        compile_error(l->c, lower_at(l, &e->at),
                      "a %s spline has 4 values and %d more for each further segment, not %d",
                      s->basis->name, s->basis->step, length);
        return lower_constant(0, ast_type_width(e->type));
    }
    s->spans = (length - 4) / s->basis->step + 1;
    find_segment(l, s, &e->at, where);
    for (int j = 0; j < 4; j++) {
        struct ir_value factor = {.count = 1, .part = {weight(l, s, &e->at, j)}};
        if (!factor.part[0].kind)
            continue;
        struct ir_value value = value_in_segment(l, s, &e->at, j);
        value = lower_each(l, &e->at, IR_MULTIPLY, &value, &factor);
        sum = sum.count ? lower_each(l, &e->at, IR_ADD, &sum, &value) : value;
    }
    return sum;
}

/* The basis is known at run time only: every one that has a spline of so many values. */
static struct ir_value lower_any_basis(struct lowering *l, struct ast_expression *e,
                                       struct spline *s, struct ir_operand name,
                                       struct ir_operand where) {
    struct ir_value result = lower_variables(l, &e->at, e->type, 0, NULL, STORAGE_UNSAID);
    int length = s->values[0].array_length ? s->values[0].array_length : s->count;
    for (size_t b = 0; b < sizeof bases / sizeof *bases; b++) {
        struct ir_list *list = l->list, *scope = l->scope;
        s->basis = &bases[b];
        if (length < 4 || (length - 4) % s->basis->step)
            continue;
        struct ir_operand is_it =
            lower_binary(l, &e->at, IR_STRING_EQUAL, name, lower_text(l, s->basis->name));
        struct ir_node *node = lower_control(l, NODE_IF, &e->at);
        node->condition = is_it;
        l->list = l->scope = node->body;
        struct ir_value one = lower_with_basis(l, e, s, where);
        lower_assign(l, &e->at, &result, &one);
        l->list = list;
        l->scope = scope;
    }
    return result;
}

struct ir_value lower_spline(struct lowering *l, struct ast_expression *e) {
    struct spline *s = compilation_get(l->c, sizeof *s);
    struct ast_expression *x = e->arguments;
    struct ir_operand name = {0};
    s->basis = bases;
    if (x->type == TYPE_STRING) {
        if (x->kind == EXPRESSION_STRING)
            s->basis = spline_basis_find(x->name);
        else
            name = lower_operand(l, x, x->next).part[0];
        x = x->next;
    }
    struct ir_operand where = lower_operand(l, x, x->next).part[0];
    for (x = x->next; x; x = x->next)
        s->values[s->count++] = lower_operand(l, x, x->next);
    return name.kind ? lower_any_basis(l, e, s, name, where) : lower_with_basis(l, e, s, where);
}
