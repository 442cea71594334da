/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lower.h"

#include <stdio.h>
#include <string.h>

/* Strings made at run time, on the node's processor: concat, format and match. A format that is
 * written out is taken apart here, so that each instruction appends one piece. */

struct ir_operand lower_text(struct lowering *l, const char *text) {
    int32_t identity = shader_string_identity(text);
    for (const struct ir_text *t = l->ir->texts; t; t = t->next)
        if (t->identity == identity)
            return ir_string(identity);
    struct ir_text *t = compilation_get(l->c, sizeof *t);
    *t = (struct ir_text){identity, text, l->ir->texts};
    l->ir->texts = t;
    l->ir->text_count++;
    return ir_string(identity);
}

static struct ir_operand join(struct lowering *l, const struct source_location *at,
                              struct ir_operand a, struct ir_operand b) {
    struct ir_operand none = {0};
    if (a.kind == OPERAND_STRING && a.identity == shader_string_identity(""))
        return b;
    return lower_operate(l, at, IR_TEXT_JOIN, a, b, none);
}

static struct ir_operand join_literal(struct lowering *l, const struct source_location *at,
                                      struct ir_operand a, const char *text, size_t length) {
    if (!length)
        return a;
    return join(l, at, a, lower_text(l, compilation_copy(l->c, text, length)));
}

/* One number after another, with spaces between. */
static struct ir_operand append_numbers(struct lowering *l, const struct source_location *at,
                                        struct ir_operand text, const struct ir_value *value,
                                        const char *conversion) {
    int count = value->array_length ? value->array_length : value->count;
    struct ir_operand how = lower_text(l, conversion);
    for (int i = 0; i < count; i++) {
        struct ir_operand number = value->part[value->array_length ? 0 : i];
        if (value->array_length) {
            number = lower_unary(l, at, IR_ARRAY_LOAD, ir_float((float)i));
            l->list->last->array = value->part[0].variable;
        }
        if (i)
            text = join_literal(l, at, text, " ", 1);
        text = lower_operate(l, at, IR_TEXT_NUMBER, text, number, how);
    }
    return text;
}

/* %[flags][width][.precision]letter: its length, 0 when it is none */
static size_t conversion_length(const char *text) {
    size_t length = 1;
    length += strspn(text + length, "-+ 0#");
    length += strspn(text + length, "0123456789");
    if (text[length] == '.')
        length += 1 + strspn(text + length + 1, "0123456789");
    return text[length] && strchr("fdgeicpvnmhs", text[length]) && length < 16 ? length + 1 : 0;
}

static struct ir_operand lower_conversion(struct lowering *l, const struct ast_expression *argument,
                                          struct ir_operand text, const char *conversion,
                                          size_t length) {
    struct ir_value value = lower_expression(l, (struct ast_expression *)argument);
    char letter = conversion[length - 1], how[24];
    if (argument->type == TYPE_STRING)
        return join(l, &argument->at, text, value.part[0]);
    if (argument->type == TYPE_BOOL || value.strings)
        return text;
    snprintf(how, sizeof how, "%.*s%c", (int)length - 1, conversion,
             letter == 'd' || letter == 'i'                    ? 'd'
             : letter == 'g' || letter == 'e' || letter == 'f' ? letter
                                                               : 'f');
    return append_numbers(l, &argument->at, text, &value, compilation_copy(l->c, how, strlen(how)));
}

static struct ir_operand lower_format(struct lowering *l, const struct ast_expression *e) {
    const char *format = e->arguments->name, *start = format;
    const struct ast_expression *argument = e->arguments->next;
    struct ir_operand text = lower_text(l, "");
    for (const char *at = format; *at;) {
        size_t length = *at == '%' ? conversion_length(at) : 0;
        bool is_percent = at[0] == '%' && at[1] == '%';
        if (!is_percent && (!length || !argument)) {
            at++;
            continue;
        }
        text = join_literal(l, &e->at, text, start, (size_t)(at - start) + is_percent);
        if (!is_percent) {
            text = lower_conversion(l, argument, text, at, length);
            argument = argument->next;
        }
        start = at += is_percent ? 2 : length;
    }
    return join_literal(l, &e->at, text, start, strlen(start));
}

struct ir_value lower_text_builtin(struct lowering *l, const struct ast_expression *e) {
    struct ir_value result = {.count = 1};
    struct ir_operand none = {0}, text;
    if (e->builtin->id == BUILTIN_FORMAT) {
        result.part[0] = lower_format(l, e);
        return result;
    }
    text = lower_expression(l, e->arguments).part[0];
    for (struct ast_expression *a = e->arguments->next; a; a = a->next) {
        struct ir_operand other = lower_expression(l, a).part[0];
        if (e->builtin->id == BUILTIN_MATCH)
            text = lower_operate(l, &e->at, IR_TEXT_MATCH, text, other, none);
        else
            text = join(l, &e->at, text, other);
    }
    result.part[0] = text;
    return result;
}
