/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

/* Elements of arrays. An array of floats or triples is one array variable for each component; an
 * array of matrices is one of 16 floats a matrix; an array of strings is a variable for each
 * element, chosen by comparing the index, for strings are few and uniform. */

static struct ir_operand load(struct lowering *l, const struct source_location *at,
                              struct ir_variable *array, struct ir_operand index) {
    struct ir_operand none = {0};
    struct ir_operand result = lower_operate(l, at, IR_ARRAY_LOAD, index, none, none);
    l->list->last->array = array;
    result.variable->type = array->type;
    result.variable->format = array->format;
    return result;
}

static void store(struct lowering *l, const struct source_location *at, struct ir_variable *array,
                  struct ir_operand index, struct ir_operand value) {
    struct ir_node *node = ir_node_new(l->ir, l->list, NODE_INSTRUCTION, lower_at(l, at));
    node->operation = IR_ARRAY_STORE;
    node->array = array;
    node->operands[0] = index;
    node->operands[1] = value;
}

/* Where the matrix begins: 16 times the nearest whole index. */
static struct ir_operand matrix_start(struct lowering *l, const struct source_location *at,
                                      const struct ir_value *array, struct ir_operand index) {
    float last = (float)(array->array_length / 16 - 1);
    if (index.kind == OPERAND_FLOAT) {
        float at_most = index.number < last ? index.number : last;
        return ir_float(16 * (float)(int)(at_most > 0 ? at_most : 0));
    }
    index = lower_binary(l, at, IR_MIN, lower_binary(l, at, IR_MAX, index, ir_float(0)),
                         ir_float(last));
    return lower_binary(l, at, IR_MULTIPLY, lower_unary(l, at, IR_FLOOR, index), ir_float(16));
}

static struct ir_operand matrix_element(struct lowering *l, const struct source_location *at,
                                        struct ir_operand start, int i) {
    if (start.kind == OPERAND_FLOAT)
        return ir_float(start.number + (float)i);
    return lower_binary(l, at, IR_ADD, start, ir_float((float)i));
}

/* if (index < 1) the first else if (index < 2) ... else the last: runs `visit` for the element that
 * is meant, in its branch. */
typedef void on_string(struct lowering *l, const struct source_location *at,
                       struct ir_operand string, void *context);

static void choose_string(struct lowering *l, const struct source_location *at,
                          const struct ir_value *array, struct ir_operand index, on_string *visit,
                          void *context) {
    struct ir_list *list = l->list, *scope = l->scope;
    int last = array->array_length - 1;
    if (index.kind == OPERAND_FLOAT) {
        float nearest = index.number < (float)last ? index.number : (float)last;
        visit(l, at, array->strings[nearest > 0 ? (int)nearest : 0], context);
        return;
    }
    for (int i = 0; i < last; i++) {
        struct ir_operand is_it = lower_binary(l, at, IR_LESS, index, ir_float((float)(i + 1)));
        struct ir_node *node = lower_control(l, NODE_IF, at);
        node->condition = is_it;
        node->otherwise = ir_list_new(l->ir, node);
        l->list = l->scope = node->body;
        visit(l, at, array->strings[i], context);
        l->list = l->scope = node->otherwise;
    }
    visit(l, at, array->strings[last], context);
    l->list = list;
    l->scope = scope;
}

static void take_string(struct lowering *l, const struct source_location *at,
                        struct ir_operand string, void *context) {
    lower_move(l, at, context, string);
}

static void put_string(struct lowering *l, const struct source_location *at,
                       struct ir_operand string, void *context) {
    lower_move(l, at, string.variable, *(struct ir_operand *)context);
}

struct ir_value lower_array_load(struct lowering *l, const struct source_location *at,
                                 enum ast_type type, const struct ir_value *array,
                                 struct ir_operand index) {
    struct ir_value value = {.count = ast_type_width(type)};
    if (type == TYPE_STRING) {
        struct ir_variable *string = ir_variable_new(l->ir, l->list, IR_STRING, NULL);
        string->is_declared_uniform = true;
        choose_string(l, at, array, index, take_string, string);
        value.part[0] = ir_of(string);
        return value;
    }
    if (type == TYPE_MATRIX) {
        value = lower_variables(l, at, TYPE_MATRIX, 0, NULL, STORAGE_UNSAID);
        struct ir_operand start = matrix_start(l, at, array, index);
        for (int i = 0; i < 16; i++)
            store(l, at, value.part[0].variable, ir_float((float)i),
                  load(l, at, array->part[0].variable, matrix_element(l, at, start, i)));
        return value;
    }
    for (int i = 0; i < value.count; i++)
        value.part[i] = load(l, at, array->part[i].variable, index);
    return value;
}

void lower_array_store(struct lowering *l, const struct source_location *at, enum ast_type type,
                       const struct ir_value *array, struct ir_operand index,
                       const struct ir_value *from) {
    if (type == TYPE_STRING) {
        struct ir_operand string = from->part[0];
        choose_string(l, at, array, index, put_string, &string);
        return;
    }
    if (type == TYPE_MATRIX) {
        struct ir_operand start = matrix_start(l, at, array, index);
        for (int i = 0; i < 16; i++)
            store(l, at, array->part[0].variable, matrix_element(l, at, start, i),
                  load(l, at, from->part[0].variable, ir_float((float)i)));
        return;
    }
    for (int i = 0; i < array->count; i++)
        store(l, at, array->part[i].variable, index, from->part[from->count == 1 ? 0 : i]);
}

void lower_array_copy(struct lowering *l, const struct source_location *at, enum ast_type type,
                      const struct ir_value *to, const struct ir_value *from, int length) {
    for (int i = 0; i < length; i++) {
        struct ir_value one = lower_array_load(l, at, type, from, ir_float((float)i));
        lower_array_store(l, at, type, to, ir_float((float)i), &one);
    }
}

struct lower_target lower_target_open(struct lowering *l, struct ast_expression *e) {
    struct lower_target target = {.at = &e->at, .type = e->type};
    target.whole = *lower_symbol(l, e->symbol, &e->at);
    target.is_element = e->kind == EXPRESSION_INDEX;
    if (!target.is_element)
        return target;
    target.index = lower_expression(l, e->right).part[0];
    if (target.index.kind == OPERAND_VARIABLE && !target.index.variable->is_temporary) {
        struct ir_variable *copy =
            lower_temporary(l, IR_FLOAT); /* the variable may change before */
        lower_move(l, &e->at, copy, target.index);
        target.index = ir_of(copy);
    }
    return target;
}

struct ir_value lower_target_read(struct lowering *l, const struct lower_target *target) {
    if (!target->is_element)
        return target->whole;
    return lower_array_load(l, target->at, target->type, &target->whole, target->index);
}

void lower_target_write(struct lowering *l, const struct lower_target *target,
                        const struct ir_value *value) {
    if (target->is_element)
        lower_array_store(l, target->at, target->type, &target->whole, target->index, value);
    else
        lower_assign(l, target->at, &target->whole, value);
}
