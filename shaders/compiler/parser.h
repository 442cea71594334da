/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PARSER_H
#define PARSER_H

#include "shaders/compiler/ast.h"
#include "shaders/compiler/preprocess.h"

/* Recursive descent with three tokens of view. After an error the parser is in panic: it reports
 * nothing until parser_recover has found the end of a statement. */
struct parser {
    struct compilation *c;
    const char *file; /* that was opened first */
    struct preprocessor source;
    struct token token, ahead, second;
    int nesting;
    bool is_panicking;
};

void parser_advance(struct parser *p);
bool parser_accept(struct parser *p, int kind);
/* Reports "expected X before Y" unless the token is there. */
bool parser_expect(struct parser *p, int kind);
void parser_complain(struct parser *p, const struct source_location *at, const char *text);
/* Every recursive function calls these in pairs; enter stops the compilation at NESTING_MAX. */
void parser_enter(struct parser *p);
void parser_leave(struct parser *p);
/* Whether it may name something: an identifier, or a word that means something only at the start of
 * a shader. */
bool parser_is_name(int kind);
bool parser_type(const struct parser *p, int kind, enum ast_type *type);
/* The type that begins at the token at hand, which is left where it is; of a fixed-point type only
 * that it is one. */
bool parser_at_type(const struct parser *p, enum ast_type *type);
/* Takes the type, 'fixed' '<' size ',' ['-'] exponent '>' with all that belongs to it. */
enum ast_type parser_take_type(struct parser *p);

struct declaration {
    enum ast_type type;
    enum ast_storage storage;
    bool is_output, is_extern;
    enum ast_transform transform;
    bool is_unit;
};

/* After an error: up to and including the next ';', or up to a '}' or the end. */
void parser_recover(struct parser *p);
/* qualifiers type qualifiers */
void parse_declaration_type(struct parser *p, struct declaration *d);
/* name formals (body | ';') */
struct ast_function *parse_function(struct parser *p, enum ast_type type, bool is_shader);
struct ast_expression *parse_expression(struct parser *p);
struct ast_expression *parse_assignment(struct parser *p);
/* '(' [expression {',' expression}] ')' */
struct ast_expression *parse_arguments(struct parser *p, int *count);

#endif
