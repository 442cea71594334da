/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/lexer.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *spelling;
    int kind;
} keywords[] = {
#define KEYWORD_ENTRY(name, spelling) {spelling, TOKEN_##name},
    KEYWORDS(KEYWORD_ENTRY)
#undef KEYWORD_ENTRY
};

static const struct {
    char text[3];
    int kind;
} pairs[] = {
    {"<=", TOKEN_LESS_EQUAL},
    {">=", TOKEN_GREATER_EQUAL},
    {"==", TOKEN_EQUAL},
    {"!=", TOKEN_NOT_EQUAL},
    {"&&", TOKEN_AND},
    {"||", TOKEN_OR},
    {"+=", TOKEN_ADD_ASSIGN},
    {"-=", TOKEN_SUBTRACT_ASSIGN},
    {"*=", TOKEN_MULTIPLY_ASSIGN},
    {"/=", TOKEN_DIVIDE_ASSIGN},
    {"<<", TOKEN_SHIFT_LEFT},
    {">>", TOKEN_SHIFT_RIGHT},
    {"##", TOKEN_PASTE},
};

void lexer_start(struct lexer *lexer, struct compilation *c, const char *file, const char *text,
                 size_t length) {
    *lexer = (struct lexer){
        .c = c, .cursor = text, .end = text + length, .line_text = text, .file = file, .line = 1};
}

static struct source_location here(const struct lexer *lexer) {
    return (struct source_location){.file = lexer->file,
                                    .line_text = lexer->line_text,
                                    .line = lexer->line,
                                    .column = (int)(lexer->cursor - lexer->line_text) + 1};
}

static char peek(const struct lexer *lexer, int ahead) {
    return lexer->end - lexer->cursor > ahead ? lexer->cursor[ahead] : '\0';
}

static void new_line(struct lexer *lexer) {
    lexer->cursor++;
    lexer->line++;
    lexer->line_text = lexer->cursor;
}

static void skip_comment(struct lexer *lexer) {
    struct source_location at = here(lexer);
    lexer->cursor += 2;
    while (lexer->cursor < lexer->end) {
        if (peek(lexer, 0) == '*' && peek(lexer, 1) == '/') {
            lexer->cursor += 2;
            return;
        }
        if (*lexer->cursor == '\n')
            new_line(lexer);
        else
            lexer->cursor++;
    }
    compile_error(lexer->c, &at, "this comment is never closed");
}

static bool at_line_start(const struct lexer *lexer) {
    for (const char *text = lexer->line_text; text < lexer->cursor; text++)
        if (*text != ' ' && *text != '\t')
            return false;
    return true;
}

static void skip_space(struct lexer *lexer) {
    while (lexer->cursor < lexer->end) {
        char byte = *lexer->cursor;
        if (byte == '\n' && lexer->in_directive)
            return;
        else if (byte == '\n')
            new_line(lexer);
        else if (byte == '\\' && peek(lexer, 1) == '\n')
            lexer->cursor++, new_line(lexer);
        else if (byte == '\\' && peek(lexer, 1) == '\r' && peek(lexer, 2) == '\n')
            lexer->cursor += 2, new_line(lexer);
        else if (byte == ' ' || byte == '\t' || byte == '\r' || byte == '\f' || byte == '\v')
            lexer->cursor++;
        else if (byte == '/' && peek(lexer, 1) == '/')
            while (lexer->cursor < lexer->end && *lexer->cursor != '\n')
                lexer->cursor++;
        else if (byte == '/' && peek(lexer, 1) == '*')
            skip_comment(lexer);
        else
            return;
    }
}

static void read_number(struct lexer *lexer, struct token *token) {
    char digits[64];
    size_t length = 0;
    const char *text = lexer->cursor;
    while (text < lexer->end && isdigit((unsigned char)*text))
        text++;
    if (text < lexer->end && *text == '.')
        text++;
    while (text < lexer->end && isdigit((unsigned char)*text))
        text++;
    if (text < lexer->end && (*text == 'e' || *text == 'E')) {
        const char *exponent = text + 1;
        if (exponent < lexer->end && (*exponent == '+' || *exponent == '-'))
            exponent++;
        if (exponent < lexer->end && isdigit((unsigned char)*exponent)) {
            text = exponent;
            while (text < lexer->end && isdigit((unsigned char)*text))
                text++;
        }
    }
    length = (size_t)(text - lexer->cursor);
    token->kind = TOKEN_NUMBER;
    while (lexer->in_directive && text < lexer->end &&
           (isalnum((unsigned char)*text) || *text == '_'))
        text++; /* 0x1F and 10L of conditions, what ## makes of others */
    token->text = compilation_copy(lexer->c, lexer->cursor, (size_t)(text - lexer->cursor));
    if (length >= sizeof digits) {
        compile_error(lexer->c, &token->at, "this number has too many digits");
    } else {
        memcpy(digits, lexer->cursor, length);
        digits[length] = '\0';
        token->number = strtof(digits, NULL);
        if (isinf(token->number)) {
            compile_error(lexer->c, &token->at, "this number is too large for a float");
            token->number = 0;
        }
    }
    lexer->cursor = text;
}

static void read_string(struct lexer *lexer, struct token *token) {
    const char *text = ++lexer->cursor;
    while (text < lexer->end && *text != '"' && *text != '\n')
        text += *text == '\\' && text + 1 < lexer->end && text[1] != '\n' ? 2 : 1;
    char *copy = compilation_get(lexer->c, (size_t)(text - lexer->cursor) + 1);
    size_t length = 0;
    while (lexer->cursor < text) {
        char byte = *lexer->cursor++;
        if (byte == '\\' && lexer->cursor < text) {
            byte = *lexer->cursor++;
            byte = byte == 'n' ? '\n' : byte == 't' ? '\t' : byte == 'r' ? '\r' : byte;
        }
        copy[length++] = byte;
    }
    token->kind = TOKEN_STRING;
    token->text = copy;
    if (lexer->cursor < lexer->end && *lexer->cursor == '"')
        lexer->cursor++;
    else
        compile_error(lexer->c, &token->at, "this string is never closed");
}

static void read_word(struct lexer *lexer, struct token *token) {
    const char *text = lexer->cursor;
    while (lexer->cursor < lexer->end &&
           (isalnum((unsigned char)*lexer->cursor) || *lexer->cursor == '_'))
        lexer->cursor++;
    size_t length = (size_t)(lexer->cursor - text);
    token->kind = TOKEN_IDENTIFIER;
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
        if (strlen(keywords[i].spelling) == length && !memcmp(keywords[i].spelling, text, length))
            token->kind = keywords[i].kind;
    token->text = compilation_copy(lexer->c, text, length);
}

void lexer_next(struct lexer *lexer, struct token *token) {
    for (;;) {
        const char *before = lexer->cursor;
        skip_space(lexer);
        *token = (struct token){
            .kind = TOKEN_END, .at = here(lexer), .text = "", .has_space = lexer->cursor != before};
        if (lexer->cursor >= lexer->end)
            return;
        unsigned char byte = (unsigned char)*lexer->cursor;
        if (byte == '\n') { /* skip_space stops there in a directive only */
            new_line(lexer);
            token->kind = TOKEN_NEWLINE;
            return;
        }
        if (byte == '#' && !lexer->in_directive && at_line_start(lexer)) {
            lexer->cursor++;
            token->kind = TOKEN_DIRECTIVE;
            return;
        }
        if (isdigit(byte) || (byte == '.' && isdigit((unsigned char)peek(lexer, 1)))) {
            read_number(lexer, token);
            return;
        }
        if (isalpha(byte) || byte == '_') {
            read_word(lexer, token);
            return;
        }
        if (byte == '"') {
            read_string(lexer, token);
            return;
        }
        for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
            if (peek(lexer, 0) == pairs[i].text[0] && peek(lexer, 1) == pairs[i].text[1] &&
                (lexer->in_directive || pairs[i].kind < TOKEN_SHIFT_LEFT)) {
                token->kind = pairs[i].kind;
                lexer->cursor += 2;
                return;
            }
        lexer->cursor++;
        if (byte && strchr(lexer->in_directive ? "+-*/.^!<>=?:;,(){}[]#%&|~\\'@`$"
                                               : "+-*/%.^!<>=?:;,(){}[]",
                           byte)) {
            token->kind = byte;
            return;
        }
        compile_error(lexer->c, &token->at,
                      byte > ' ' && byte < 127 ? "unexpected character '%c'" : "unexpected byte %d",
                      byte);
    }
}

void lexer_skip_to_directive(struct lexer *lexer) {
    while (lexer->cursor < lexer->end) {
        char byte = *lexer->cursor;
        if (byte == '\n')
            new_line(lexer);
        else if (byte == '/' && peek(lexer, 1) == '*')
            skip_comment(lexer);
        else if (byte == '/' && peek(lexer, 1) == '/')
            while (lexer->cursor < lexer->end && *lexer->cursor != '\n')
                lexer->cursor++;
        else if (byte == '#' && at_line_start(lexer))
            return;
        else
            lexer->cursor++;
    }
}

bool lexer_at_parenthesis(const struct lexer *lexer) {
    return peek(lexer, 0) == '(';
}

const char *token_kind_name(int kind, char buffer[24]) {
    switch (kind) {
    case TOKEN_END:
        return "the end of the file";
    case TOKEN_IDENTIFIER:
        return "a name";
    case TOKEN_NUMBER:
        return "a number";
    case TOKEN_STRING:
        return "a string";
    case TOKEN_NEWLINE:
        return "the end of the line";
    }
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        if (pairs[i].kind == kind) {
            snprintf(buffer, 24, "'%s'", pairs[i].text);
            return buffer;
        }
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++)
        if (keywords[i].kind == kind) {
            snprintf(buffer, 24, "'%s'", keywords[i].spelling);
            return buffer;
        }
    snprintf(buffer, 24, "'%c'", kind < 256 ? kind : '?');
    return buffer;
}
