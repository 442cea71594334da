/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/parser.h"

#include <math.h>
#include <string.h>

void parser_advance(struct parser *p) {
    p->token = p->ahead;
    p->ahead = p->second;
    preprocess_next(&p->source, &p->second);
}

bool parser_accept(struct parser *p, int kind) {
    if (p->token.kind != kind)
        return false;
    parser_advance(p);
    return true;
}

void parser_complain(struct parser *p, const struct source_location *at, const char *text) {
    if (!p->is_panicking)
        compile_error(p->c, at, "%s", text);
    p->is_panicking = true;
}

bool parser_expect(struct parser *p, int kind) {
    char wanted[24], found[24];
    if (p->is_panicking)
        return false;
    if (parser_accept(p, kind))
        return true;
    compile_error(p->c, &p->token.at, "expected %s before %s", token_kind_name(kind, wanted),
                  token_kind_name(p->token.kind, found));
    p->is_panicking = true;
    return false;
}

void parser_enter(struct parser *p) {
    if (++p->nesting > NESTING_MAX)
        compile_limit(p->c, &p->token.at, "nested more than %d deep", NESTING_MAX);
}

void parser_leave(struct parser *p) {
    p->nesting--;
}

bool parser_is_name(int kind) {
    return kind == TOKEN_IDENTIFIER || (kind >= TOKEN_SURFACE && kind <= TOKEN_TRANSFORMATION);
}

/* The name at hand; an error when there is none. */
static const char *parse_new_name(struct parser *p) {
    const char *name = parser_is_name(p->token.kind) ? p->token.text : "?";
    if (parser_is_name(p->token.kind))
        parser_advance(p);
    else
        parser_expect(p, TOKEN_IDENTIFIER);
    return name;
}

bool parser_type(const struct parser *p, int kind, enum ast_type *type) {
    switch (kind) {
    case TOKEN_FLOAT:
        *type = TYPE_FLOAT;
        return true;
    case TOKEN_COLOR:
        *type = TYPE_COLOR;
        return true;
    case TOKEN_POINT:
        *type = TYPE_POINT;
        return true;
    case TOKEN_VECTOR:
        *type = TYPE_VECTOR;
        return true;
    case TOKEN_NORMAL:
        *type = TYPE_NORMAL;
        return true;
    case TOKEN_STRING_TYPE:
        *type = TYPE_STRING;
        return true;
    case TOKEN_VOID:
        *type = TYPE_VOID;
        return true;
    case TOKEN_MATRIX:
        *type = TYPE_MATRIX;
        return true;
    }
    return false;
}

/* `fixed` and `unsigned` are names like any other, but where a format follows. */
static bool is_fixed_word(const struct token *token) {
    return token->kind == TOKEN_IDENTIFIER && !strcmp(token->text, "fixed");
}

bool parser_at_type(const struct parser *p, enum ast_type *type) {
    const bool is_unsigned =
        p->token.kind == TOKEN_IDENTIFIER && !strcmp(p->token.text, "unsigned");
    if ((is_unsigned && is_fixed_word(&p->ahead)) ||
        (is_fixed_word(&p->token) && p->ahead.kind == '<' && p->second.kind == TOKEN_NUMBER)) {
        *type = TYPE_ANY_FIXED;
        return true;
    }
    return parser_type(p, p->token.kind, type);
}

/* A whole number with an optional sign. */
static int parse_format_number(struct parser *p, int low, int high, const char *what) {
    const bool is_negative = parser_accept(p, '-');
    float number = p->token.number;
    if (p->token.kind != TOKEN_NUMBER) {
        parser_complain(p, &p->token.at, what);
        return low;
    }
    number = is_negative ? -number : number;
    if (number != floorf(number) || !(number >= (float)low && number <= (float)high)) {
        parser_complain(p, &p->token.at, what);
        number = (float)low;
    }
    parser_advance(p);
    return (int)number;
}

enum ast_type parser_take_type(struct parser *p) {
    enum ast_type type = TYPE_ERROR;
    struct fixed_format format = {0};
    if (!parser_at_type(p, &type)) {
        parser_complain(p, &p->token.at, "expected a type");
        return TYPE_ERROR;
    }
    format.is_unsigned = !is_fixed_word(&p->token);
    parser_advance(p);
    if (type != TYPE_ANY_FIXED)
        return type;
    if (format.is_unsigned)
        parser_advance(p);
    parser_expect(p, '<');
    format.size = (int16_t)parse_format_number(
        p, 1, FIXED_SIZE_MAX, "the size of a fixed-point type is a whole number from 1 to 64");
    parser_expect(p, ',');
    format.exponent = (int16_t)parse_format_number(
        p, FIXED_EXPONENT_MIN, FIXED_EXPONENT_MAX,
        "the exponent of a fixed-point type is a whole number from -512 to 512");
    parser_expect(p, '>');
    return ast_type_fixed(format);
}

/* After an error: up to and including the next ';', or up to a '}' or the end. */
void parser_recover(struct parser *p) {
    while (p->token.kind != TOKEN_END && p->token.kind != '}') {
        if (parser_accept(p, ';'))
            break;
        parser_advance(p);
    }
    p->is_panicking = false;
}

static struct ast_statement *new_statement(struct parser *p, enum ast_statement_kind kind) {
    struct ast_statement *s = compilation_get(p->c, sizeof *s);
    s->kind = kind;
    s->at = p->token.at;
    return s;
}

static bool is_qualifier(int kind) {
    return kind == TOKEN_EXTERN || kind == TOKEN_OUTPUT || kind == TOKEN_UNIFORM ||
           kind == TOKEN_VARYING;
}

static const struct {
    const char *name;
    enum ast_transform transform;
} attributes[] = {{"transform_as_point", TRANSFORM_POINT},
                  {"transform_as_vector", TRANSFORM_VECTOR},
                  {"transform_as_normal", TRANSFORM_NORMAL},
                  {"transform_as_texture", TRANSFORM_TEXTURE},
                  {"unit", TRANSFORM_NONE}};

/* Which transformation attribute the token at hand is, -1 when none: like `fixed`, their names are
 * free for other things where no type follows. */
static int find_attribute(const struct parser *p) {
    enum ast_type type;
    const bool precedes = p->ahead.kind == TOKEN_IDENTIFIER ||
                          parser_type(p, p->ahead.kind, &type) || is_qualifier(p->ahead.kind);
    if (p->token.kind == TOKEN_IDENTIFIER && precedes)
        for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++)
            if (!strcmp(attributes[i].name, p->token.text))
                return (int)i;
    return -1;
}

static bool at_attribute(const struct parser *p) {
    return find_attribute(p) >= 0;
}

/* {'extern' | 'output' | 'uniform' | 'varying' | attribute} */
static void parse_qualifiers(struct parser *p, struct declaration *d) {
    for (;; parser_advance(p)) {
        const int attribute = find_attribute(p);
        if (attribute >= 0 && attributes[attribute].transform != TRANSFORM_NONE)
            d->transform = attributes[attribute].transform;
        else if (attribute >= 0)
            d->is_unit = true;
        else if (p->token.kind == TOKEN_EXTERN)
            d->is_extern = true;
        else if (p->token.kind == TOKEN_OUTPUT)
            d->is_output = true;
        else if (p->token.kind == TOKEN_UNIFORM)
            d->storage = STORAGE_UNIFORM;
        else if (p->token.kind == TOKEN_VARYING)
            d->storage = STORAGE_VARYING;
        else
            return;
    }
}

/* qualifiers type qualifiers */
void parse_declaration_type(struct parser *p, struct declaration *d) {
    parse_qualifiers(p, d);
    d->type = parser_take_type(p);
    parse_qualifiers(p, d);
}

/* '[' [number] ']' ['=' ('{' expression {',' expression} '}' | expression)] */
static void parse_array(struct parser *p, struct ast_symbol *symbol) {
    parser_expect(p, '[');
    symbol->array_length = -1;
    if (p->token.kind == TOKEN_NUMBER) {
        float length = p->token.number;
        if (!(length >= 1 && length <= ARRAY_FLOATS_MAX) || length != floorf(length))
            parser_complain(p, &p->token.at, "an array length is a whole number from 1 to 65536");
        else
            symbol->array_length = (int)length;
        parser_advance(p);
    }
    parser_expect(p, ']');
    if (p->token.kind != '=' || p->is_panicking)
        return;
    parser_advance(p);
    if (p->token.kind != '{') { /* a copy of another array, or of a triple */
        symbol->initial = parse_assignment(p);
        return;
    }
    parser_advance(p);
    struct ast_expression **link = &symbol->elements;
    int count = 0;
    while (!p->is_panicking && p->token.kind != '}') {
        *link = parse_assignment(p);
        link = &(*link)->next;
        count++;
        if (!parser_accept(p, ','))
            break;
    }
    parser_expect(p, '}');
    if (symbol->array_length < 0 && count)
        symbol->array_length = count;
    if (count > symbol->array_length)
        parser_complain(p, &symbol->at, "more initial values than elements");
}

/* name [array | '=' expression] */
static struct ast_symbol *parse_declarator(struct parser *p, const struct declaration *d) {
    struct ast_symbol *symbol = compilation_get(p->c, sizeof *symbol);
    symbol->at = p->token.at;
    symbol->type = d->type;
    symbol->storage = d->storage;
    symbol->is_output = d->is_output;
    symbol->name = parse_new_name(p);
    symbol->transform = d->transform;
    symbol->is_unit = d->is_unit;
    if (p->token.kind == '[')
        parse_array(p, symbol);
    else if (parser_accept(p, '='))
        symbol->initial = parse_assignment(p);
    if (d->type == TYPE_VOID)
        parser_complain(p, &symbol->at, "a variable cannot be void");
    return symbol;
}

/* '(' [declaration-type declarator {',' declarator} {';' ...}] ')' */
static void parse_formals(struct parser *p, struct ast_function *function) {
    struct ast_symbol **link = &function->formals;
    parser_expect(p, '(');
    while (!p->is_panicking && p->token.kind != ')') {
        if (parser_accept(p, ';') || parser_accept(p, ','))
            continue;
        struct declaration d = {.type = TYPE_ERROR};
        parse_declaration_type(p, &d);
        do {
            enum ast_type type;
            if (parser_at_type(p, &type) || is_qualifier(p->token.kind) || at_attribute(p))
                break; /* f(float a, float b) as well as f(float a, b) */
            *link = parse_declarator(p, &d);
            if (function->is_shader)
                (*link)->is_parameter = true;
            else
                (*link)->is_formal = true;
            link = &(*link)->next;
            function->formal_count++;
        } while (!p->is_panicking && parser_accept(p, ','));
    }
    parser_expect(p, ')');
}

static struct ast_statement *parse_statement(struct parser *p);

/* '{' {statement} '}' */
static struct ast_statement *parse_body(struct parser *p) {
    struct ast_statement *first = NULL, **link = &first;
    if (!parser_expect(p, '{'))
        return NULL;
    while (p->token.kind != '}' && p->token.kind != TOKEN_END) {
        *link = parse_statement(p);
        if (p->is_panicking)
            parser_recover(p);
        link = &(*link)->next;
    }
    parser_expect(p, '}');
    return first;
}

/* name formals (body | ';'); the second only says that there will be such a function */
struct ast_function *parse_function(struct parser *p, enum ast_type type, bool is_shader) {
    struct ast_function *function = compilation_get(p->c, sizeof *function);
    function->type = type;
    function->is_shader = is_shader;
    function->at = p->token.at;
    function->name = parse_new_name(p);
    parse_formals(p, function);
    if (!is_shader && !p->is_panicking && parser_accept(p, ';')) {
        function->is_prototype = true;
        return function;
    }
    if (p->is_panicking) /* the body may still be worth reading */
        while (p->token.kind != '{' && p->token.kind != TOKEN_END)
            parser_advance(p);
    p->is_panicking = false;
    function->body = parse_body(p);
    return function;
}

/* declaration-type declarator {',' declarator} ';' | type function */
static struct ast_statement *parse_declaration(struct parser *p) {
    struct ast_statement *group = new_statement(p, STATEMENT_BLOCK), **link = &group->body;
    struct declaration d = {.type = TYPE_ERROR};
    parse_declaration_type(p, &d);
    if (!p->is_panicking && parser_is_name(p->token.kind) && p->ahead.kind == '(') {
        group->function = parse_function(p, d.type, false);
        group->kind = group->function->is_prototype ? STATEMENT_EMPTY : STATEMENT_FUNCTION;
        return group;
    }
    do {
        struct ast_statement *s = new_statement(p, STATEMENT_DECLARE);
        s->symbol = parse_declarator(p, &d);
        if (!d.is_extern) { /* enclosing variables are visible anyway */
            *link = s;
            link = &s->next;
        }
    } while (!p->is_panicking && parser_accept(p, ','));
    parser_expect(p, ';');
    return group;
}

/* 'if' '(' expression ')' statement ['else' statement] */
static struct ast_statement *parse_if(struct parser *p) {
    struct ast_statement *s = new_statement(p, STATEMENT_IF);
    parser_advance(p);
    parser_expect(p, '(');
    s->expression = parse_expression(p);
    parser_expect(p, ')');
    s->body = parse_statement(p);
    if (p->is_panicking && p->token.kind != TOKEN_ELSE)
        return s;
    if (parser_accept(p, TOKEN_ELSE))
        s->otherwise = parse_statement(p);
    return s;
}

/* expression {',' expression} */
static struct ast_expression *parse_list(struct parser *p) {
    struct ast_expression *first = parse_expression(p), **link = &first->next;
    while (!p->is_panicking && parser_accept(p, ',')) {
        *link = parse_expression(p);
        link = &(*link)->next;
    }
    return first;
}

/* Whether a declaration begins here, and not a cast. */
static bool at_declaration(const struct parser *p) {
    enum ast_type type;
    if (is_qualifier(p->token.kind) || at_attribute(p) ||
        (parser_at_type(p, &type) && type == TYPE_ANY_FIXED))
        return true;
    return parser_type(p, p->token.kind, &type) &&
           (parser_is_name(p->ahead.kind) || is_qualifier(p->ahead.kind));
}

/* 'for' '(' declaration ... : a block with the variables around the loop without them */
static struct ast_statement *parse_loop_scope(struct parser *p, struct ast_statement *loop) {
    struct ast_statement *scope = new_statement(p, STATEMENT_BLOCK);
    scope->is_scope = true;
    scope->body = parse_declaration(p);
    scope->body->next = loop;
    return scope;
}

/* 'while' '(' expression ')' statement
 * | 'for' '(' [list ';' | declaration | ';'] [expression] ';' [list] ')' statement */
static struct ast_statement *parse_loop(struct parser *p) {
    struct ast_statement *s = new_statement(p, STATEMENT_FOR), *whole = s;
    bool is_for = p->token.kind == TOKEN_FOR;
    parser_advance(p);
    parser_expect(p, '(');
    if (is_for && at_declaration(p)) {
        whole = parse_loop_scope(p, s);
    } else if (is_for) {
        if (p->token.kind != ';')
            s->initial = parse_list(p);
        parser_expect(p, ';');
    }
    if (!is_for || p->token.kind != ';')
        s->expression = parse_expression(p);
    if (is_for) {
        parser_expect(p, ';');
        if (p->token.kind != ')')
            s->step = parse_list(p);
    }
    parser_expect(p, ')');
    s->body = parse_statement(p);
    return whole;
}

/* ('break' | 'continue') [number] ';' */
static struct ast_statement *parse_jump(struct parser *p, enum ast_statement_kind kind) {
    struct ast_statement *s = new_statement(p, kind);
    s->level = 1;
    parser_advance(p);
    if (p->token.kind == TOKEN_NUMBER) {
        float level = p->token.number;
        if (!(level >= 1 && level <= NESTING_MAX) || level != floorf(level))
            parser_complain(p, &p->token.at, "expected a number of loops");
        else
            s->level = (int)level;
        parser_advance(p);
    }
    parser_expect(p, ';');
    return s;
}

/* 'return' [expression] ';' */
static struct ast_statement *parse_return(struct parser *p) {
    struct ast_statement *s = new_statement(p, STATEMENT_RETURN);
    parser_advance(p);
    if (p->token.kind != ';')
        s->expression = parse_expression(p);
    parser_expect(p, ';');
    return s;
}

/* ('illuminance' | 'illuminate' | 'solar') arguments statement */
static struct ast_statement *parse_lighting(struct parser *p, enum ast_statement_kind kind) {
    struct ast_statement *s = new_statement(p, kind);
    parser_advance(p);
    s->arguments = parse_arguments(p, &s->argument_count);
    s->body = parse_statement(p);
    return s;
}

/* expression ';' | 'gather' arguments statement ['else' statement], of which the call remains */
static struct ast_statement *parse_expression_statement(struct parser *p) {
    struct ast_statement *s = new_statement(p, STATEMENT_EXPRESSION);
    bool is_gather = p->token.kind == TOKEN_IDENTIFIER && !strcmp(p->token.text, "gather");
    s->expression = parse_expression(p);
    if (is_gather && !p->is_panicking && p->token.kind != ';') {
        parse_statement(p);
        if (parser_accept(p, TOKEN_ELSE))
            parse_statement(p);
        return s;
    }
    parser_expect(p, ';');
    return s;
}

static struct ast_statement *parse_block(struct parser *p) {
    struct ast_statement *s = new_statement(p, STATEMENT_BLOCK);
    s->is_scope = true;
    s->body = parse_body(p);
    return s;
}

static struct ast_statement *parse_statement_inner(struct parser *p) {
    switch (p->token.kind) {
    case ';': {
        struct ast_statement *s = new_statement(p, STATEMENT_EMPTY);
        parser_advance(p);
        return s;
    }
    case '{':
        return parse_block(p);
    case TOKEN_IF:
        return parse_if(p);
    case TOKEN_WHILE:
    case TOKEN_FOR:
        return parse_loop(p);
    case TOKEN_BREAK:
        return parse_jump(p, STATEMENT_BREAK);
    case TOKEN_CONTINUE:
        return parse_jump(p, STATEMENT_CONTINUE);
    case TOKEN_RETURN:
        return parse_return(p);
    case TOKEN_ILLUMINANCE:
        return parse_lighting(p, STATEMENT_ILLUMINANCE);
    case TOKEN_ILLUMINATE:
        return parse_lighting(p, STATEMENT_ILLUMINATE);
    case TOKEN_SOLAR:
        return parse_lighting(p, STATEMENT_SOLAR);
    }
    if (at_declaration(p))
        return parse_declaration(p);
    return parse_expression_statement(p);
}

/* Every statement; see parse_* for the forms. */
static struct ast_statement *parse_statement(struct parser *p) {
    parser_enter(p);
    struct ast_statement *s = parse_statement_inner(p);
    parser_leave(p);
    return s;
}
