/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PREPROCESS_H
#define PREPROCESS_H

#include "shaders/compiler/lexer.h"

/* The preprocessor works on tokens between lexer and parser, so that messages keep the place in the
 * source: what a macro expands to is where the macro was used. */

struct token_list {
    struct token *tokens;
    int count, capacity;
};

struct macro {
    const char *name;
    bool is_function, is_busy; /* busy: being expanded, so its name stands for itself */
    struct token_list parameters, body;
    struct macro *next;
};

/* Tokens to be read before the rest of the source. */
struct expansion {
    const struct token_list *list;
    int at;
    struct macro *macro; /* busy until the list has been read */
    bool is_barrier;     /* reads as the end when empty: an argument by itself */
    struct expansion *below;
};

struct condition {
    struct source_location at;
    bool was_taken, has_else;
    struct condition *below;
};

/* A file being read. */
struct include {
    struct lexer lexer;
    struct condition *conditions; /* open in this file */
    struct include *below;
};

enum { MACRO_BUCKETS = 256 };

struct preprocessor {
    struct compilation *c;
    struct include *file;
    int include_depth;
    size_t included_bytes;
    struct expansion *expansion;
    struct token held; /* read too far */
    bool is_held;
    int macro_depth, expanded_tokens;
    struct macro *macros[MACRO_BUCKETS];
};

/* As lexer_start; an #include asks the compilation's options. */
void preprocess_start(struct preprocessor *p, struct compilation *c, const char *file,
                      const char *text, size_t length);
/* The next token with directives obeyed and macros expanded; at the end TOKEN_END for ever. */
void preprocess_next(struct preprocessor *p, struct token *token);

/* Within the preprocessor. */
void token_list_add(struct compilation *c, struct token_list *list, const struct token *token);
/* The next token, directives obeyed, macros not expanded. */
void preprocess_raw(struct preprocessor *p, struct token *token);
/* The rest of a directive, without the end of its line. */
void preprocess_line(struct preprocessor *p, struct token_list *list);

/* preprocess_macro.c */
struct macro *macro_find(struct preprocessor *p, const char *name);
void macro_define(struct preprocessor *p);
void macro_undefine(struct preprocessor *p, const struct source_location *at);
/* Begins to read the expansion of `token`; false when it stays as it is. */
bool macro_expand(struct preprocessor *p, struct macro *macro, const struct token *token);
/* All of `list` with macros expanded. */
void macro_expand_list(struct preprocessor *p, const struct token_list *list,
                       struct token_list *expanded);

/* preprocess_text.c: how words are written */
/* The words as one string, as # makes of an argument. */
struct token token_text_of(struct compilation *c, const struct token_list *list);
/* One word of two, as ## makes; an error when they do not make one. */
struct token token_paste(struct compilation *c, const struct token *left, const struct token *right,
                         const struct source_location *at);

/* preprocess_condition.c: obeys the directive of this name and returns true if it is one of #if's
 * family */
bool condition_directive(struct preprocessor *p, const struct token *name);
/* Complains about what is still open where a file ends. */
void condition_end(struct preprocessor *p);

#endif
