/* SPDX-License-Identifier: Apache-2.0 */
#ifndef LEXER_H
#define LEXER_H

#include "shaders/compiler/compilation.h"

/* Words with a meaning of their own. X(NAME, spelling) */
#define KEYWORDS(X)                                                                                \
    X(SURFACE, "surface")                                                                          \
    X(LIGHT, "light")                                                                              \
    X(DISPLACEMENT, "displacement")                                                                \
    X(VOLUME, "volume")                                                                            \
    X(IMAGER, "imager")                                                                            \
    X(TRANSFORMATION, "transformation")                                                            \
    X(FLOAT, "float")                                                                              \
    X(COLOR, "color")                                                                              \
    X(POINT, "point")                                                                              \
    X(VECTOR, "vector")                                                                            \
    X(NORMAL, "normal")                                                                            \
    X(MATRIX, "matrix")                                                                            \
    X(STRING_TYPE, "string")                                                                       \
    X(VOID, "void")                                                                                \
    X(UNIFORM, "uniform")                                                                          \
    X(VARYING, "varying")                                                                          \
    X(OUTPUT, "output")                                                                            \
    X(EXTERN, "extern")                                                                            \
    X(IF, "if")                                                                                    \
    X(ELSE, "else")                                                                                \
    X(FOR, "for")                                                                                  \
    X(WHILE, "while")                                                                              \
    X(BREAK, "break")                                                                              \
    X(CONTINUE, "continue")                                                                        \
    X(RETURN, "return")                                                                            \
    X(ILLUMINANCE, "illuminance")                                                                  \
    X(ILLUMINATE, "illuminate")                                                                    \
    X(SOLAR, "solar")

/* Punctuation of one character is its own kind; these come after. */
enum token_kind {
    TOKEN_END = 256,
    TOKEN_IDENTIFIER,
    TOKEN_NUMBER,
    TOKEN_STRING,
    TOKEN_LESS_EQUAL,
    TOKEN_GREATER_EQUAL,
    TOKEN_EQUAL,
    TOKEN_NOT_EQUAL,
    TOKEN_AND,
    TOKEN_OR,
    TOKEN_ADD_ASSIGN,
    TOKEN_SUBTRACT_ASSIGN,
    TOKEN_MULTIPLY_ASSIGN,
    TOKEN_DIVIDE_ASSIGN,
    TOKEN_SHIFT_LEFT, /* these two and the next in directives only */
    TOKEN_SHIFT_RIGHT,
    TOKEN_PASTE,     /* ## */
    TOKEN_DIRECTIVE, /* '#' at the start of a line; seen by preprocess.c only */
    TOKEN_NEWLINE,   /* the end of a directive, likewise */
#define KEYWORD_ENUM(name, spelling) TOKEN_##name,
    KEYWORDS(KEYWORD_ENUM)
#undef KEYWORD_ENUM
};

struct token {
    int kind;
    struct source_location at;
    const char *text; /* identifier, string contents or the spelling of a number, NUL-terminated, in
                         the arena */
    float number;
    bool is_expanded; /* names a macro inside its own expansion: stays */
    bool has_space;   /* white space or a comment before it */
};

struct lexer {
    struct compilation *c;
    const char *cursor, *end; /* *end is NUL */
    const char *line_text;
    const char *file;
    int line;
    bool in_directive; /* a line's end is a token */
};

/* `text` must be followed by a NUL and outlive the compilation's messages. */
void lexer_start(struct lexer *lexer, struct compilation *c, const char *file, const char *text,
                 size_t length);
/* The next token; at the end TOKEN_END for ever. Bad characters are reported and skipped. */
void lexer_next(struct lexer *lexer, struct token *token);
/* Passes over lines up to one that starts with '#', or to the end. */
void lexer_skip_to_directive(struct lexer *lexer);
/* Whether the byte after the last token is an opening parenthesis. */
bool lexer_at_parenthesis(const struct lexer *lexer);
/* How a token kind is called in messages: "'+='", "a number". */
const char *token_kind_name(int kind, char buffer[24]);

#endif
