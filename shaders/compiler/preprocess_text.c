/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/preprocess.h"

#include <stdio.h>
#include <string.h>

/* Words back into text, for # and ## of macros. */

enum { TEXT_BYTES_MAX = 4096 };

struct text {
    char bytes[TEXT_BYTES_MAX];
    size_t length;
    bool is_full;
};

static void put(struct text *text, const char *bytes, size_t length) {
    if (text->length + length >= sizeof text->bytes) {
        text->is_full = true;
        return;
    }
    memcpy(text->bytes + text->length, bytes, length);
    text->length += length;
    text->bytes[text->length] = '\0';
}

static void put_token(struct text *text, const struct token *token) {
    char buffer[24];
    if (token->kind == TOKEN_STRING) {
        put(text, "\"", 1);
        for (const char *at = token->text; *at; at++) {
            char escaped[2] = {'\\', *at == '\n' ? 'n' : *at == '\t' ? 't' : *at};
            bool is_special = *at == '"' || *at == '\\' || escaped[1] != *at;
            put(text, is_special ? escaped : at, is_special ? 2 : 1);
        }
        put(text, "\"", 1);
    } else if (token->text[0]) {
        put(text, token->text, strlen(token->text));
    } else { /* punctuation is named in quotes */
        const char *name = token_kind_name(token->kind, buffer);
        put(text, name + 1, strlen(name) - 2);
    }
}

struct token token_text_of(struct compilation *c, const struct token_list *list) {
    struct text *text = compilation_get(c, sizeof *text);
    for (int i = 0; i < list->count; i++) {
        if (i && list->tokens[i].has_space)
            put(text, " ", 1);
        put_token(text, &list->tokens[i]);
    }
    if (text->is_full)
        compile_limit(c, &list->tokens[0].at, "# makes a string of more than %d bytes",
                      TEXT_BYTES_MAX);
    return (struct token){.kind = TOKEN_STRING,
                          .text = compilation_copy(c, text->bytes, text->length)};
}

struct token token_paste(struct compilation *c, const struct token *left, const struct token *right,
                         const struct source_location *at) {
    struct text *text = compilation_get(c, sizeof *text);
    struct lexer lexer;
    struct token one, end;
    put_token(text, left);
    put_token(text, right);
    if (text->is_full)
        compile_limit(c, at, "## makes a word of more than %d bytes", TEXT_BYTES_MAX);
    lexer_start(&lexer, c, at->file, compilation_copy(c, text->bytes, text->length), text->length);
    lexer.in_directive = true;
    lexer_next(&lexer, &one);
    lexer_next(&lexer, &end);
    if (end.kind != TOKEN_END)
        compile_error(c, at, "## does not make one word of \"%.64s\"", text->bytes);
    one.at = *at;
    one.has_space = left->has_space;
    return one;
}
