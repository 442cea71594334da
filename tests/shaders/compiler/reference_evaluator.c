/* SPDX-License-Identifier: Apache-2.0 */
#include "reference_internal.h"

#include "shaders/compiler/lexer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct reference_slot *reference_slot(struct reference *r, const struct ast_symbol *symbol) {
    size_t at = ((uintptr_t)symbol >> 4) * 0x9e3779b1u % REFERENCE_SLOTS;
    for (int tried = 0; tried < REFERENCE_SLOTS; tried++, at = (at + 1) % REFERENCE_SLOTS) {
        struct reference_slot *slot = &r->slots[at];
        if (slot->symbol == symbol)
            return slot;
        if (slot->symbol)
            continue;
        slot->symbol = symbol;
        slot->length = symbol->array_length > 0 ? symbol->array_length : 0;
        int cells = (slot->length ? slot->length : 1) * reference_cell_count(symbol->type);
        slot->own_cells = slot->cells = calloc((size_t)cells, sizeof *slot->cells);
        if (!slot->cells)
            abort();
        return slot;
    }
    abort(); /* more variables than any test program has */
}

struct reference_value reference_read(enum ast_type type, const float *cells) {
    struct reference_value value = {.count = reference_width(type)};
    if (ast_type_is_fixed(type)) {
        value.format = ast_type_format(type);
        memcpy(&value.raw, cells, sizeof value.raw);
    } else {
        memcpy(value.part, cells, (size_t)value.count * sizeof *cells);
    }
    return value;
}

void reference_write(enum ast_type type, float *cells, const struct reference_value *value) {
    if (ast_type_is_fixed(type)) {
        memcpy(cells, &value->raw, sizeof value->raw);
        return;
    }
    for (int i = 0; i < reference_width(type); i++)
        cells[i] = value->part[value->count == 1 ? 0 : i];
}

/* ---- predefined variables ---- */

float reference_input(struct reference *r, const char *name, int component, float otherwise) {
    float value;
    return r->world->input(r->world->context, name, component, &value) ? value : otherwise;
}

static void set_global(struct reference *r, struct reference_slot *slot) {
    const struct ast_global *global = slot->symbol->global;
    bool is_surface = r->unit->kind == SHADER_KIND_SURFACE;
    enum global_source source = is_surface ? global->surface : global->light;
    for (int i = 0; i < ast_type_width(global->type); i++) {
        float *to = &slot->cells[i];
        const float *shader = r->world->matrices->to_camera[SHADER_SPACE_SHADER];
        switch (source) {
        case GLOBAL_MATERIAL:
        case GLOBAL_BOUND:
            *to = reference_input(r, global->name, i, 1);
            break;
        case GLOBAL_POSITION:
            *to = r->world->position[i];
            break;
        case GLOBAL_INCIDENT:
            *to = r->world->incident[i];
            break;
        case GLOBAL_ONE:
            *to = 1;
            break;
        case GLOBAL_THREE:
            *to = 3;
            break;
        case GLOBAL_PI:
            *to = (float)M_PI;
            break;
        case GLOBAL_ORIGIN:
            *to = shader[12 + i];
            break;
        case GLOBAL_AXIS:
            *to = shader[8 + i];
            break;
        default:
            *to = 0;
        }
    }
}

struct reference_slot *reference_variable(struct reference *r, const struct ast_symbol *symbol) {
    struct reference_slot *slot = reference_slot(r, symbol);
    if (symbol->global && slot->generation != r->generation) {
        slot->generation = r->generation;
        set_global(r, slot);
    }
    return slot;
}

static struct reference_value read_name(struct reference *r, const struct ast_expression *e) {
    const struct ast_symbol *symbol = e->symbol;
    struct reference_value value = {.count = 3};
    bool is_of_light = symbol->global && r->unit->kind == SHADER_KIND_SURFACE &&
                       symbol->global->surface == GLOBAL_LIGHT;
    if (is_of_light) {
        for (int i = 0; i < 3; i++)
            value.part[i] =
                symbol->type == TYPE_COLOR ? r->light->color[i] : -r->light->direction[i];
        return value;
    }
    struct reference_slot *slot = reference_variable(r, symbol);
    value = reference_read(symbol->type, slot->cells);
    value.identity = slot->identity;
    return value;
}

/* ---- expressions ---- */

float *reference_cells(struct reference *r, const struct ast_expression *e) {
    struct reference_slot *slot = reference_variable(r, e->symbol);
    if (e->kind != EXPRESSION_INDEX)
        return slot->cells;
    float index = reference_evaluate(r, e->right).part[0];
    return slot->cells + reference_index(index, slot->length) * reference_cell_count(e->type);
}

static struct reference_value number(float x) {
    return (struct reference_value){.count = 1, .part = {x}};
}

static struct reference_value condition(bool truth) {
    return (struct reference_value){.count = 1, .truth = truth};
}

static struct reference_value widen(const struct reference_value *value, enum ast_type type) {
    struct reference_value wide = *value;
    wide.count = reference_width(type);
    for (int i = 0; i < wide.count; i++)
        wide.part[i] = value->part[value->count == 1 ? 0 : i];
    return wide;
}

static struct reference_value into_current(struct reference *r, enum ast_type type,
                                           const struct reference_value *value) {
    return reference_transform(r, type, SHADER_SPACE_SHADER, SHADER_SPACE_CURRENT, value);
}

static struct reference_value evaluate_tuple(struct reference *r, const struct ast_expression *e) {
    struct reference_value value = {.count = reference_width(e->type)};
    int i = 0;
    for (const struct ast_expression *a = e->arguments; a; a = a->next)
        value.part[i++] = reference_evaluate(r, a).part[0];
    if (r->in_default && ast_type_is_geometric(e->type))
        return into_current(r, e->type, &value);
    return value;
}

/* A value as another type, where one of the two is fixed-point; and what needs no conversion. */
static struct reference_value as_number(const struct reference_value *value, enum ast_type from,
                                        enum ast_type to) {
    if (ast_type_is_fixed(to))
        return reference_fixed_convert(value, from, to);
    return ast_type_is_fixed(from) ? number(reference_fixed_float(value)) : *value;
}

/* Element `i` of a whole array, or component `i` of a triple, as an element of another array. */
static struct reference_value part_of(struct reference *r, const struct ast_expression *from,
                                      const struct reference_value *triple, int i,
                                      enum ast_type to) {
    struct reference_value value = number(triple->part[i % 3]);
    enum ast_type type = TYPE_FLOAT;
    if (from->array_length) {
        type = from->type;
        value = reference_read(type, reference_variable(r, from->symbol)->cells +
                                         i * reference_cell_count(type));
    }
    return as_number(&value, type, to);
}

/* Copies a whole array, or a triple, into an array. */
void reference_copy_whole(struct reference *r, const struct ast_expression *from,
                          struct reference_slot *to) {
    struct reference_value triple = {.count = 3}, one;
    const enum ast_type type = to->symbol->type;
    if (!from->array_length)
        triple = reference_evaluate(r, from);
    for (int i = 0; i < to->length; i++) {
        one = part_of(r, from, &triple, i, type);
        reference_write(type, to->cells + i * reference_cell_count(type), &one);
    }
}

static struct reference_value evaluate_convert(struct reference *r,
                                               const struct ast_expression *e) {
    struct reference_value value = {.count = 3};
    if (e->left->array_length) {
        for (int i = 0; i < 3; i++)
            value.part[i] = part_of(r, e->left, &value, i, TYPE_FLOAT).part[0];
        return value;
    }
    value = reference_evaluate(r, e->left);
    if (ast_type_is_fixed(e->left->type) && e->type == TYPE_BOOL)
        return condition(value.raw != 0);
    if (ast_type_is_fixed(e->left->type) || ast_type_is_fixed(e->type))
        return as_number(&value, e->left->type, e->type);
    if (e->type == TYPE_BOOL)
        return e->left->type == TYPE_BOOL ? value : condition(value.part[0] != 0);
    if (e->left->type == TYPE_BOOL)
        value = number(value.truth ? 1 : 0);
    if (e->type == TYPE_MATRIX)
        return reference_matrix_diagonal(value.part[0]);
    value = widen(&value, e->type);
    if (r->in_default && e->left->type == TYPE_FLOAT && ast_type_is_geometric(e->type))
        return into_current(r, e->type, &value);
    return value;
}

static struct reference_value evaluate_cast(struct reference *r, const struct ast_expression *e) {
    bool in_default = r->in_default;
    bool takes_space = ast_type_is_geometric(e->type) &&
                       (e->left->kind == EXPRESSION_TUPLE || e->left->type == TYPE_FLOAT);
    int32_t space = e->name ? shader_string_identity(e->name) : SHADER_SPACE_CURRENT;
    r->in_default = in_default && !takes_space;
    struct reference_value value = reference_evaluate(r, e->left);
    r->in_default = in_default;
    if (ast_type_is_fixed(e->type))
        return as_number(&value, e->left->type, e->type);
    if (ast_type_is_fixed(e->left->type))
        value = as_number(&value, e->left->type, TYPE_FLOAT);
    if (e->left->type == TYPE_BOOL)
        value = number(value.truth ? 1 : 0);
    if (e->type == TYPE_MATRIX) {
        if (e->left->type != TYPE_MATRIX)
            value = reference_matrix_diagonal(value.part[0]);
        return reference_matrix_in_space(r, space, &value);
    }
    int32_t identity = value.identity;
    value = widen(&value, e->type);
    value.identity = identity;
    if (e->name && e->type == TYPE_COLOR)
        return reference_color_space(r, e->name, "rgb", &value);
    if (e->name && ast_type_is_geometric(e->type))
        return reference_transform(r, e->type, space, SHADER_SPACE_CURRENT, &value);
    if (in_default && takes_space)
        return into_current(r, e->type, &value);
    return value;
}

static bool is_equal(const struct ast_expression *e, const struct reference_value *a,
                     const struct reference_value *b) {
    if (e->left->type == TYPE_STRING)
        return a->identity == b->identity;
    if (ast_type_is_fixed(e->left->type))
        return reference_fixed_order(a, b) == 0;
    int count = a->count > b->count ? a->count : b->count;
    for (int i = 0; i < count; i++)
        if (!(a->part[a->count == 1 ? 0 : i] == b->part[b->count == 1 ? 0 : i]))
            return false;
    return true;
}

static struct reference_value evaluate_binary(struct reference *r, const struct ast_expression *e) {
    struct reference_value a = reference_evaluate(r, e->left), b = reference_evaluate(r, e->right),
                           value = {.count = 3};
    const float *x = a.part, *y = b.part;
    float order[2];
    if (ast_type_is_fixed(e->type))
        return reference_fixed_binary(e->token, &a, &b);
    if (ast_type_is_fixed(e->left->type)) { /* a comparison: exact, whatever the formats */
        order[0] = (float)reference_fixed_order(&a, &b);
        order[1] = 0;
        x = &order[0];
        y = &order[1];
    }
    switch (e->token) {
    case TOKEN_AND:
        return condition(a.truth && b.truth);
    case TOKEN_OR:
        return condition(a.truth || b.truth);
    case '<':
        return condition(x[0] < y[0]);
    case '>':
        return condition(x[0] > y[0]);
    case TOKEN_LESS_EQUAL:
        return condition(x[0] <= y[0]);
    case TOKEN_GREATER_EQUAL:
        return condition(x[0] >= y[0]);
    case TOKEN_EQUAL:
        return condition(is_equal(e, &a, &b));
    case TOKEN_NOT_EQUAL:
        return condition(!is_equal(e, &a, &b));
    case '.':
        return number(reference_dot(x, y));
    case '^':
        for (int i = 0; i < 3; i++)
            value.part[i] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
        return value;
    }
    if (e->type == TYPE_MATRIX)
        return reference_matrix_product(e->token == '/', &a, &b);
    return reference_each(e->token, &a, &b);
}

static struct reference_value evaluate_unary(struct reference *r, const struct ast_expression *e) {
    struct reference_value value = reference_evaluate(r, e->left);
    if (ast_type_is_fixed(e->type))
        return reference_fixed_negate(&value);
    value.truth = !value.truth;
    for (int i = 0; i < value.count; i++)
        value.part[i] = -value.part[i];
    return value;
}

/* What += and its like make of the two. A fixed-point target of float arithmetic is a float
 * meanwhile. */
static struct reference_value change(const struct ast_expression *e,
                                     const struct reference_value *old,
                                     const struct reference_value *right) {
    struct reference_value left = *old, value;
    if (e->type == TYPE_MATRIX)
        return reference_matrix_product(e->token == '/', &left, right);
    if (!ast_type_is_fixed(e->type))
        return reference_each(e->token, &left, right);
    if (ast_type_is_fixed(e->right->type)) {
        value = reference_fixed_binary(e->token, &left, right);
        return reference_fixed_convert(&value, TYPE_ANY_FIXED, e->type);
    }
    left = as_number(&left, e->type, TYPE_FLOAT);
    value = reference_each(e->token, &left, right);
    return as_number(&value, TYPE_FLOAT, e->type);
}

static struct reference_value evaluate_assignment(struct reference *r,
                                                  const struct ast_expression *e) {
    if (e->left->array_length) {
        reference_copy_whole(r, e->right, reference_variable(r, e->left->symbol));
        return (struct reference_value){0};
    }
    struct reference_value right = reference_evaluate(r, e->right);
    float *cells = reference_cells(r, e->left);
    if (e->token) {
        struct reference_value left = reference_read(e->type, cells);
        right = change(e, &left, &right);
    }
    reference_write(e->type, cells, &right);
    int32_t identity = right.identity;
    reference_variable(r, e->left->symbol)->identity = identity;
    if (ast_type_is_fixed(e->type))
        return right;
    right = widen(&right, e->type);
    right.identity = identity;
    return right;
}

struct reference_value reference_evaluate(struct reference *r, const struct ast_expression *e) {
    switch (e->kind) {
    case EXPRESSION_NUMBER:
        return ast_type_is_fixed(e->type) ? reference_fixed_number(e->number, e->type)
                                          : number(e->number);
    case EXPRESSION_STRING:
        return (struct reference_value){.count = 1, .identity = shader_string_identity(e->name)};
    case EXPRESSION_NAME:
        return read_name(r, e);
    case EXPRESSION_INDEX:
        return reference_read(e->type, reference_cells(r, e));
    case EXPRESSION_TUPLE:
        return evaluate_tuple(r, e);
    case EXPRESSION_UNARY:
        return evaluate_unary(r, e);
    case EXPRESSION_BINARY:
        return evaluate_binary(r, e);
    case EXPRESSION_CONDITIONAL:
        return reference_evaluate(r, reference_evaluate(r, e->left).truth ? e->right : e->third);
    case EXPRESSION_ASSIGN:
        return evaluate_assignment(r, e);
    case EXPRESSION_CAST:
        return evaluate_cast(r, e);
    case EXPRESSION_CONVERT:
        return evaluate_convert(r, e);
    case EXPRESSION_CALL:
        return e->function ? reference_call(r, e->function, e->arguments, NULL)
                           : reference_builtin(r, e);
    }
    abort();
}
