/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/parser.h"

#include <string.h>

static struct ast_expression *new_expression(struct parser *p, enum ast_expression_kind kind,
                                             const struct source_location *at) {
    struct ast_expression *e = compilation_get(p->c, sizeof *e);
    e->kind = kind;
    e->type = TYPE_ERROR;
    e->at = *at;
    e->depth = 1;
    return e;
}

static void set_child(struct parser *p, struct ast_expression *e, struct ast_expression **slot,
                      struct ast_expression *child) {
    *slot = child;
    if (child->depth >= e->depth)
        e->depth = child->depth + 1;
    if (e->depth > EXPRESSION_DEPTH_MAX)
        compile_limit(p->c, &e->at, "this expression has more than %d operators in a row",
                      EXPRESSION_DEPTH_MAX);
}

struct ast_expression *parse_arguments(struct parser *p, int *count) {
    struct ast_expression *first = NULL, **link = &first;
    *count = 0;
    parser_expect(p, '(');
    while (!p->is_panicking && p->token.kind != ')') {
        *link = parse_assignment(p);
        link = &(*link)->next;
        ++*count;
        if (!parser_accept(p, ','))
            break;
    }
    parser_expect(p, ')');
    return first;
}

/* '(' expression ')' | '(' expression ',' expression ',' expression ')' */
static struct ast_expression *parse_parenthesis(struct parser *p) {
    struct source_location at = p->token.at;
    int count;
    struct ast_expression *list = parse_arguments(p, &count);
    if (count == 1)
        return list;
    if (!p->is_panicking && count != 3 && count != 16)
        parser_complain(p, &at, "expected one value, three as (x, y, z), or a matrix of 16");
    struct ast_expression *e = new_expression(p, EXPRESSION_TUPLE, &at);
    e->arguments = list;
    e->argument_count = count;
    for (struct ast_expression *a = list; a; a = a->next)
        if (a->depth >= e->depth)
            e->depth = a->depth + 1;
    return e;
}

/* name | name '[' expression ']' | name arguments; the channel of texture(names[i][0], ...) is
 * dropped. */
static struct ast_expression *parse_name(struct parser *p) {
    struct ast_expression *e = new_expression(p, EXPRESSION_NAME, &p->token.at);
    e->name = p->token.text;
    parser_advance(p);
    if (p->token.kind == '(') {
        e->kind = EXPRESSION_CALL;
        e->arguments = parse_arguments(p, &e->argument_count);
        for (struct ast_expression *a = e->arguments; a; a = a->next)
            if (a->depth >= e->depth)
                e->depth = a->depth + 1;
    } else if (p->token.kind == '[') {
        struct ast_expression *index = new_expression(p, EXPRESSION_INDEX, &e->at);
        parser_advance(p);
        index->name = e->name;
        set_child(p, index, &index->left, e);
        set_child(p, index, &index->right, parse_expression(p));
        parser_expect(p, ']');
        if (parser_accept(p, '[')) {
            parse_expression(p);
            parser_expect(p, ']');
        }
        return index;
    }
    return e;
}

static struct ast_expression *parse_unary(struct parser *p);

/* type [string] unary */
static struct ast_expression *parse_cast(struct parser *p) {
    struct ast_expression *e = new_expression(p, EXPRESSION_CAST, &p->token.at);
    e->type = parser_take_type(p);
    if (p->token.kind == TOKEN_STRING) {
        e->name = p->token.text;
        parser_advance(p);
    }
    set_child(p, e, &e->left, parse_unary(p));
    return e;
}

/* Strings side by side are one. */
static const char *parse_string(struct parser *p) {
    const char *text = p->token.text;
    parser_advance(p);
    while (p->token.kind == TOKEN_STRING) {
        size_t length = strlen(text), more = strlen(p->token.text);
        char *joined = compilation_get(p->c, length + more + 1);
        memcpy(joined, text, length);
        memcpy(joined + length, p->token.text, more);
        text = joined;
        parser_advance(p);
    }
    return text;
}

/* number | string {string} ['[' expression ']'] | name ... | '(' ... ')' */
static struct ast_expression *parse_primary(struct parser *p) {
    struct ast_expression *e;
    switch (p->token.kind) {
    case TOKEN_NUMBER:
        e = new_expression(p, EXPRESSION_NUMBER, &p->token.at);
        e->number = p->token.number;
        parser_advance(p);
        return e;
    case TOKEN_STRING:
        e = new_expression(p, EXPRESSION_STRING, &p->token.at);
        e->name = parse_string(p);
        if (parser_accept(p, '[')) {
            parse_expression(p);
            parser_expect(p, ']');
        }
        return e;
    case '(':
        return parse_parenthesis(p);
    }
    if (parser_is_name(p->token.kind)) /* surface("Kd", k) asks a surface shader */
        return parse_name(p);
    char buffer[24];
    if (!p->is_panicking)
        compile_error(p->c, &p->token.at, "expected an expression, not %s",
                      token_kind_name(p->token.kind, buffer));
    p->is_panicking = true;
    return new_expression(p, EXPRESSION_NUMBER, &p->token.at);
}

/* ('-' | '+' | '!') unary | cast | primary */
static struct ast_expression *parse_unary(struct parser *p) {
    struct ast_expression *e;
    enum ast_type type;
    parser_enter(p);
    if (p->token.kind == '-' || p->token.kind == '!' || p->token.kind == '+') {
        e = new_expression(p, EXPRESSION_UNARY, &p->token.at);
        e->token = p->token.kind;
        parser_advance(p);
        set_child(p, e, &e->left, parse_unary(p));
    } else if (parser_at_type(p, &type)) {
        e = parse_cast(p);
    } else {
        e = parse_primary(p);
    }
    parser_leave(p);
    return e;
}

/* From the loosest to the tightest: || && == < + ^ * . (section 11 of the RenderMan Interface 3.2;
 * % is pfman's) */
static int precedence(int kind) {
    switch (kind) {
    case TOKEN_OR:
        return 1;
    case TOKEN_AND:
        return 2;
    case TOKEN_EQUAL:
    case TOKEN_NOT_EQUAL:
        return 3;
    case '<':
    case '>':
    case TOKEN_LESS_EQUAL:
    case TOKEN_GREATER_EQUAL:
        return 4;
    case '+':
    case '-':
        return 5;
    case '^':
        return 6;
    case '*':
    case '/':
    case '%':
        return 7;
    case '.':
        return 8;
    }
    return 0;
}

/* unary {operator binary-of-higher-precedence} */
static struct ast_expression *parse_binary(struct parser *p, int lowest) {
    struct ast_expression *left = parse_unary(p);
    int level;
    while ((level = precedence(p->token.kind)) >= lowest && level && !p->is_panicking) {
        struct ast_expression *e = new_expression(p, EXPRESSION_BINARY, &p->token.at);
        e->token = p->token.kind;
        parser_advance(p);
        set_child(p, e, &e->left, left);
        set_child(p, e, &e->right, parse_binary(p, level + 1));
        left = e;
    }
    return left;
}

/* binary ['?' expression ':' conditional] */
static struct ast_expression *parse_conditional(struct parser *p) {
    struct ast_expression *condition = parse_binary(p, 1);
    if (p->token.kind != '?')
        return condition;
    parser_enter(p);
    struct ast_expression *e = new_expression(p, EXPRESSION_CONDITIONAL, &p->token.at);
    parser_advance(p);
    set_child(p, e, &e->left, condition);
    set_child(p, e, &e->right, parse_assignment(p));
    parser_expect(p, ':');
    set_child(p, e, &e->third, parse_assignment(p));
    parser_leave(p);
    return e;
}

/* conditional [('=' | '+=' | '-=' | '*=' | '/=') assignment] */
struct ast_expression *parse_assignment(struct parser *p) {
    static const struct {
        int token, result;
    } operators[] = {{'=', 0},
                     {TOKEN_ADD_ASSIGN, '+'},
                     {TOKEN_SUBTRACT_ASSIGN, '-'},
                     {TOKEN_MULTIPLY_ASSIGN, '*'},
                     {TOKEN_DIVIDE_ASSIGN, '/'}};
    parser_enter(p);
    struct ast_expression *left = parse_conditional(p);
    for (size_t i = 0; i < sizeof operators / sizeof *operators; i++)
        if (p->token.kind == operators[i].token) {
            struct ast_expression *e = new_expression(p, EXPRESSION_ASSIGN, &p->token.at);
            e->token = operators[i].result;
            parser_advance(p);
            set_child(p, e, &e->left, left);
            set_child(p, e, &e->right, parse_assignment(p));
            left = e;
            break;
        }
    parser_leave(p);
    return left;
}

/* assignment */
struct ast_expression *parse_expression(struct parser *p) {
    return parse_assignment(p);
}
