/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lexer.h"
#include "shaders/compiler/lower.h"

/* The same value in as many scalars as the type has. */
static struct ir_value widen(const struct ir_value *value, enum ast_type type) {
    struct ir_value wide = *value;
    wide.count = ast_type_width(type);
    for (int i = 0; i < wide.count; i++)
        wide.part[i] = value->part[value->count == 1 ? 0 : i];
    return wide;
}

static bool is_spaceless_geometry(const struct ast_expression *e, enum ast_type type) {
    return ast_type_is_geometric(type) && (e->kind == EXPRESSION_TUPLE || e->type == TYPE_FLOAT);
}

/* In the default value of a parameter (x, y, z) is in shader space, elsewhere in current space. */
static struct ir_value into_current(struct lowering *l, const struct source_location *at,
                                    enum ast_type type, const struct ir_value *value) {
    struct ir_operand from = lower_space(l, at, "shader"), to = ir_string(SHADER_SPACE_CURRENT);
    return lower_transform(l, at, type, &from, &to, value);
}

/* (a[0], a[1], a[2]), as floats */
static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_triple_of_array(struct lowering *l,
                                                                    const struct ast_expression *e,
                                                                    const struct ir_value *array) {
    struct ir_value value = {.count = 3};
    for (int i = 0; i < 3; i++) {
        value.part[i] =
            lower_array_load(l, &e->at, e->left->type, array, ir_float((float)i)).part[0];
        if (ast_type_is_fixed(e->left->type))
            value.part[i] = lower_fixed_convert(l, &e->at, value.part[i], TYPE_FLOAT);
    }
    return value;
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_convert(struct lowering *l,
                                                            struct ast_expression *e) {
    struct ir_value value = lower_expression(l, e->left);
    enum ast_type from = e->left->type;
    if (e->left->array_length)
        return lower_triple_of_array(l, e, &value);
    if (ast_type_is_fixed(from) && e->type == TYPE_BOOL) {
        value.part[0] =
            lower_binary(l, &e->at, IR_FIXED_NOT_EQUAL, value.part[0], lower_fixed_number(0));
        return value;
    }
    if (ast_type_is_fixed(from) || ast_type_is_fixed(e->type)) {
        value.part[0] = lower_fixed_convert(l, &e->at, value.part[0], e->type);
        return value;
    }
    if (from == TYPE_FLOAT && e->type == TYPE_BOOL)
        value.part[0] = lower_binary(l, &e->at, IR_NOT_EQUAL, value.part[0], ir_float(0));
    else if (from == TYPE_BOOL && e->type != TYPE_BOOL)
        value.part[0] =
            lower_operate(l, &e->at, IR_SELECT, value.part[0], ir_float(1), ir_float(0));
    if (e->type == TYPE_MATRIX)
        return lower_matrix_diagonal(l, &e->at, value.part[0]);
    value = widen(&value, e->type);
    if (l->in_default && from == TYPE_FLOAT && ast_type_is_geometric(e->type))
        return into_current(l, &e->at, e->type, &value);
    return value;
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_tuple(struct lowering *l,
                                                          struct ast_expression *e) {
    struct ir_value value = {.count = 3};
    int i = 0;
    if (e->type == TYPE_MATRIX)
        return lower_matrix_tuple(l, e);
    for (struct ast_expression *a = e->arguments; a && i < 3; a = a->next)
        value.part[i++] = lower_operand(l, a, a->next).part[0];
    if (l->in_default && ast_type_is_geometric(e->type))
        return into_current(l, &e->at, e->type, &value);
    return value;
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_cast(struct lowering *l,
                                                         struct ast_expression *e) {
    bool in_default = l->in_default;
    bool takes_space = is_spaceless_geometry(e->left, e->type);
    l->in_default =
        in_default && !takes_space; /* the cast says or implies the space of what it holds */
    struct ir_value value = lower_expression(l, e->left);
    l->in_default = in_default;
    if (ast_type_is_fixed(e->type)) {
        value.part[0] = lower_fixed_convert(l, &e->at, value.part[0], e->type);
        return value;
    }
    if (ast_type_is_fixed(e->left->type))
        value.part[0] = lower_fixed_convert(l, &e->at, value.part[0], TYPE_FLOAT);
    if (e->left->type == TYPE_BOOL)
        value.part[0] =
            lower_operate(l, &e->at, IR_SELECT, value.part[0], ir_float(1), ir_float(0));
    if (e->type == TYPE_MATRIX) {
        if (e->left->type != TYPE_MATRIX)
            value = lower_matrix_diagonal(l, &e->at, value.part[0]);
        struct ir_operand space = ir_string(SHADER_SPACE_CURRENT);
        if (e->name)
            space = lower_space(l, &e->at, e->name);
        return lower_matrix_in_space(l, &e->at, &space, &value);
    }
    value = widen(&value, e->type);
    if (e->name && e->type == TYPE_COLOR)
        return lower_color_space(l, e, e->name, "rgb", &value);
    if (e->name && ast_type_is_geometric(e->type)) {
        struct ir_operand from = lower_space(l, &e->at, e->name),
                          to = ir_string(SHADER_SPACE_CURRENT);
        return lower_transform(l, &e->at, e->type, &from, &to, &value);
    }
    if (in_default && takes_space)
        return into_current(l, &e->at, e->type, &value);
    return value;
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_unary_expression(struct lowering *l,
                                                                     struct ast_expression *e) {
    struct ir_value value = lower_expression(l, e->left);
    for (int i = 0; i < value.count; i++) {
        if (value.part[i].kind == OPERAND_FLOAT)
            value.part[i].number = -value.part[i].number;
        else if (ir_operand_type(&value.part[i]) == IR_FIXED)
            value.part[i] = lower_fixed_negate(l, &e->at, value.part[i]);
        else
            value.part[i] =
                lower_unary(l, &e->at, e->token == '!' ? IR_NOT : IR_NEGATE, value.part[i]);
    }
    return value;
}

static struct ir_value scalar(struct ir_operand operand) {
    return (struct ir_value){.count = 1, .part = {operand}};
}

static struct ir_value lower_equality(struct lowering *l, struct ast_expression *e,
                                      const struct ir_value *a, const struct ir_value *b) {
    bool is_equal = e->token == TOKEN_EQUAL;
    if (e->left->type == TYPE_STRING) {
        struct ir_operand same = lower_binary(l, &e->at, IR_STRING_EQUAL, a->part[0], b->part[0]);
        return scalar(is_equal ? same : lower_unary(l, &e->at, IR_NOT, same));
    }
    if (ast_type_is_fixed(e->left->type))
        return scalar(lower_binary(l, &e->at, is_equal ? IR_FIXED_EQUAL : IR_FIXED_NOT_EQUAL,
                                   a->part[0], b->part[0]));
    struct ir_value each = lower_each(l, &e->at, is_equal ? IR_EQUAL : IR_NOT_EQUAL, a, b);
    struct ir_operand all = each.part[0];
    for (int i = 1; i < each.count; i++)
        all = lower_binary(l, &e->at, is_equal ? IR_AND : IR_OR, all, each.part[i]);
    return scalar(all);
}

static enum ir_operation arithmetic(int token) {
    switch (token) {
    case '+':
        return IR_ADD;
    case '-':
        return IR_SUBTRACT;
    case '*':
        return IR_MULTIPLY;
    default:
        return IR_DIVIDE;
    }
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_operator(struct lowering *l,
                                                             struct ast_expression *e,
                                                             const struct ir_value *left,
                                                             const struct ir_value *right) {
    const struct ir_value a = *left, b = *right;
    if (e->type == TYPE_MATRIX)
        return lower_matrix_binary(l, &e->at, e->token == '/', &a, &b);
    const bool is_fixed = ast_type_is_fixed(e->left->type);
    if (is_fixed && ast_type_is_fixed(e->type))
        return scalar(lower_fixed_binary(l, &e->at, e->token, a.part[0], b.part[0]));
    const enum ir_operation less = is_fixed ? IR_FIXED_LESS : IR_LESS,
                            less_equal = is_fixed ? IR_FIXED_LESS_EQUAL : IR_LESS_EQUAL;
    switch (e->token) {
    case TOKEN_AND:
        return scalar(lower_binary(l, &e->at, IR_AND, a.part[0], b.part[0]));
    case TOKEN_OR:
        return scalar(lower_binary(l, &e->at, IR_OR, a.part[0], b.part[0]));
    case '<':
        return scalar(lower_binary(l, &e->at, less, a.part[0], b.part[0]));
    case '>':
        return scalar(lower_binary(l, &e->at, less, b.part[0], a.part[0]));
    case TOKEN_LESS_EQUAL:
        return scalar(lower_binary(l, &e->at, less_equal, a.part[0], b.part[0]));
    case TOKEN_GREATER_EQUAL:
        return scalar(lower_binary(l, &e->at, less_equal, b.part[0], a.part[0]));
    case '%':
        return scalar(lower_mod(l, &e->at, a.part[0], b.part[0]));
    case TOKEN_EQUAL:
    case TOKEN_NOT_EQUAL:
        return lower_equality(l, e, &a, &b);
    case '.':
        return scalar(lower_dot(l, &e->at, &a, &b));
    case '^':
        return lower_cross(l, &e->at, &a, &b);
    }
    return lower_each(l, &e->at, arithmetic(e->token), &a, &b);
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_binary_expression(struct lowering *l,
                                                                      struct ast_expression *e) {
    const struct ir_value a = lower_operand(l, e->left, e->right),
                          b = lower_expression(l, e->right);
    return lower_operator(l, e, &a, &b);
}

/* Whether evaluating costs little and changes nothing, so that both sides of ?: may run. */
static bool is_simple(const struct ast_expression *e) {
    switch (e->kind) {
    case EXPRESSION_NUMBER:
    case EXPRESSION_NAME:
        return true;
    case EXPRESSION_UNARY:
    case EXPRESSION_CONVERT:
        return is_simple(e->left);
    case EXPRESSION_CAST:
        return !e->name && is_simple(e->left);
    case EXPRESSION_BINARY:
        return is_simple(e->left) && is_simple(e->right);
    case EXPRESSION_TUPLE:
        for (const struct ast_expression *a = e->arguments; a; a = a->next)
            if (!is_simple(a))
                return false;
        return true;
    default:
        return false;
    }
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_conditional(struct lowering *l,
                                                                struct ast_expression *e) {
    struct ir_value condition = lower_expression(l, e->left);
    struct ir_value value = {.count = ast_type_width(e->type)};
    if (e->type == TYPE_MATRIX)
        value = lower_matrix_temporary(l, &e->at);
    else if (lower_type(e->type) == IR_FLOAT && is_simple(e->right) && is_simple(e->third)) {
        struct ir_value a = lower_expression(l, e->right), b = lower_expression(l, e->third);
        for (int i = 0; i < value.count; i++)
            value.part[i] =
                lower_operate(l, &e->at, IR_SELECT, condition.part[0], a.part[i], b.part[i]);
        return value;
    }
    for (int i = 0; i < value.count && !value.array_length; i++) {
        value.part[i] = ir_of(ir_variable_new(l->ir, l->list, lower_type(e->type), NULL));
        if (ast_type_is_fixed(e->type))
            value.part[i].variable->format = ast_type_format(e->type);
    }
    if (e->type == TYPE_STRING)
        value.part[0].variable->is_declared_uniform = true;
    struct ir_node *node = lower_control(l, NODE_IF, &e->at);
    struct ir_list *list = l->list, *scope = l->scope;
    node->condition = condition.part[0];
    node->otherwise = ir_list_new(l->ir, node);
    for (int side = 0; side < 2; side++) {
        l->list = l->scope = side ? node->otherwise : node->body;
        struct ir_value one = lower_expression(l, side ? e->third : e->right);
        lower_assign(l, &e->at, &value, &one);
    }
    l->list = list;
    l->scope = scope;
    return value;
}

/* The new value of a fixed-point target of += and its like: in fixed-point, or in floats when a
 * float comes in. */
static struct ir_value lower_fixed_change(struct lowering *l, const struct ast_expression *e,
                                          struct ir_operand left, struct ir_operand right) {
    struct ir_operand result;
    if (ir_operand_type(&right) == IR_FIXED) {
        result = lower_fixed_binary(l, &e->at, e->token, left, right);
    } else {
        left = lower_fixed_convert(l, &e->at, left, TYPE_FLOAT);
        result = e->token == '%' ? lower_mod(l, &e->at, left, right)
                                 : lower_binary(l, &e->at, arithmetic(e->token), left, right);
    }
    return scalar(lower_fixed_convert(l, &e->at, result, e->type));
}

static LOWER_FRAME_OF_ITS_OWN struct ir_value lower_assignment(struct lowering *l,
                                                               struct ast_expression *e) {
    if (e->left->array_length) {
        struct ir_value to = *lower_symbol(l, e->left->symbol, &e->left->at);
        struct ir_value from = lower_expression(l, e->right);
        lower_array_convert(l, &e->at, e->left->type, &to, lower_array_elements(e->left->type, &to),
                            e->right->type, &from);
        return (struct ir_value){0};
    }
    bool is_element = e->left->kind == EXPRESSION_INDEX;
    struct ir_value right = lower_operand(l, e->right, is_element ? e->left->right : NULL);
    struct lower_target target = lower_target_open(l, e->left);
    target.at = &e->at;
    if (e->token) {
        struct ir_value left = lower_target_read(l, &target);
        if (e->type == TYPE_MATRIX)
            right = lower_matrix_binary(l, &e->at, e->token == '/', &left, &right);
        else if (ast_type_is_fixed(e->type))
            right = lower_fixed_change(l, e, left.part[0], right.part[0]);
        else if (e->token == '%')
            right = scalar(lower_mod(l, &e->at, left.part[0], right.part[0]));
        else
            right = lower_each(l, &e->at, arithmetic(e->token), &left, &right);
    }
    if (!right.array_length)
        right = widen(&right, e->type);
    lower_target_write(l, &target, &right);
    /* components on the right may have been those of the target, as in c = color (1, xcomp(c), 0)
     */
    return target.is_element ? right : target.whole;
}

static struct ir_value lower_any(struct lowering *l, struct ast_expression *e) {
    switch (e->kind) {
    case EXPRESSION_NUMBER:
        return scalar(ast_type_is_fixed(e->type) ? lower_fixed_number(e->number)
                                                 : ir_float(e->number));
    case EXPRESSION_STRING:
        return scalar(lower_text(l, e->name));
    case EXPRESSION_NAME:
        return *lower_symbol(l, e->symbol, &e->at);
    case EXPRESSION_INDEX: {
        struct ir_value array = *lower_symbol(l, e->symbol, &e->at);
        return lower_array_load(l, &e->at, e->type, &array, lower_expression(l, e->right).part[0]);
    }
    case EXPRESSION_TUPLE:
        return lower_tuple(l, e);
    case EXPRESSION_UNARY:
        return lower_unary_expression(l, e);
    case EXPRESSION_BINARY:
        return lower_binary_expression(l, e);
    case EXPRESSION_CONDITIONAL:
        return lower_conditional(l, e);
    case EXPRESSION_ASSIGN:
        return lower_assignment(l, e);
    case EXPRESSION_CAST:
        return lower_cast(l, e);
    case EXPRESSION_CONVERT:
        return lower_convert(l, e);
    case EXPRESSION_CALL:
        return e->function ? lower_user_call(l, e) : lower_builtin(l, e);
    }
    return lower_constant(0, 1);
}

struct ir_value lower_operand(struct lowering *l, struct ast_expression *e,
                              const struct ast_expression *later) {
    struct ir_value value = lower_expression(l, e), copy = value;
    while (later && !later->has_effects)
        later = later->next;
    if (!later || e->array_length)
        return value;
    if (value.array_length) {
        copy = lower_matrix_temporary(l, &e->at);
        lower_assign(l, &e->at, &copy, &value);
        return copy;
    }
    for (int i = 0; i < value.count; i++) {
        if (value.part[i].kind != OPERAND_VARIABLE || value.part[i].variable->is_temporary)
            continue;
        struct ir_variable *kept = lower_temporary(l, value.part[i].variable->type);
        kept->is_declared_uniform = kept->type == IR_STRING;
        kept->format = value.part[i].variable->format;
        lower_move(l, &e->at, kept, value.part[i]);
        copy.part[i] = ir_of(kept);
    }
    return copy;
}

struct ir_value lower_expression(struct lowering *l, struct ast_expression *e) {
    int depth = e->kind != EXPRESSION_CALL ? 1 : 16; /* calls weigh more on the stack */
    lower_deeper(l, &e->at, depth);
    struct ir_value value = lower_any(l, e);
    l->depth -= depth;
    return value;
}
