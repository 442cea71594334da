/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/preprocess.h"

#include <stdio.h>
#include <string.h>

void token_list_add(struct compilation *c, struct token_list *list, const struct token *token) {
    if (list->count == list->capacity) {
        int capacity = list->capacity ? list->capacity * 2 : 8;
        struct token *grown = compilation_get(c, (size_t)capacity * sizeof *grown);
        if (list->count)
            memcpy(grown, list->tokens, (size_t)list->count * sizeof *grown);
        list->tokens = grown;
        list->capacity = capacity;
    }
    list->tokens[list->count++] = *token;
}

static void open_file(struct preprocessor *p, const char *name, const char *text, size_t length) {
    struct include *file = compilation_get(p->c, sizeof *file);
    lexer_start(&file->lexer, p->c, name, text, length);
    file->below = p->file;
    p->file = file;
}

void preprocess_start(struct preprocessor *p, struct compilation *c, const char *file,
                      const char *text, size_t length) {
    *p = (struct preprocessor){.c = c};
    open_file(p, file, text, length);
}

void preprocess_line(struct preprocessor *p, struct token_list *list) {
    struct lexer *lexer = &p->file->lexer;
    struct token token;
    lexer->in_directive = true;
    for (;;) {
        lexer_next(lexer, &token);
        if (token.kind == TOKEN_NEWLINE || token.kind == TOKEN_END)
            break;
        token_list_add(p->c, list, &token);
    }
    lexer->in_directive = false;
}

/* `# 12 "file"` or `#line 12 "file"`: where the next line came from. */
static void set_line(struct preprocessor *p, const struct token *number,
                     const struct token_list *rest) {
    if (!(number->number >= 0 && number->number < 1e7f)) {
        compile_error(p->c, &number->at, "this is not a line number");
        return;
    }
    p->file->lexer.line = (int)number->number;
    if (rest->count && rest->tokens[0].kind == TOKEN_STRING)
        p->file->lexer.file = rest->tokens[0].text;
}

/* "folder/name" when the including file was itself included from a folder, else NULL. */
static const char *beside(struct preprocessor *p, const char *name) {
    const char *from = p->file->lexer.file, *slash = strrchr(from, '/');
    if (!p->file->below || !slash || name[0] == '/')
        return NULL;
    size_t folder = (size_t)(slash - from) + 1, length = strlen(name);
    char *path = compilation_get(p->c, folder + length + 1);
    memcpy(path, from, folder);
    memcpy(path + folder, name, length);
    return path;
}

/* The name after #include: "file", <file>, or a macro that stands for "file". NULL: an error was
 * reported. Moves *at to the name. */
static const char *include_name(struct preprocessor *p, struct source_location *at) {
    struct lexer *lexer = &p->file->lexer;
    struct token_list line = {0}, expanded = {0};
    const char *start = lexer->cursor, *name = NULL;
    while (start < lexer->end && (*start == ' ' || *start == '\t'))
        start++;
    if (start < lexer->end && *start == '<') {
        const char *end = start;
        while (end < lexer->end && *end != '>' && *end != '\n')
            end++;
        if (end < lexer->end && *end == '>') {
            name = compilation_copy(p->c, start + 1, (size_t)(end - start) - 1);
            at->column += (int)(start - at->line_text) + 1 - at->column;
            lexer->cursor = end + 1;
        }
    }
    preprocess_line(p, &line);
    macro_expand_list(p, &line, &expanded);
    if (!name && expanded.count == 1 && expanded.tokens[0].kind == TOKEN_STRING) {
        *at = expanded.tokens[0].at;
        return expanded.tokens[0].text;
    }
    if (!name || line.count)
        compile_error(p->c, at, "expected #include \"file\" or <file>");
    return line.count ? NULL : name;
}

static void include_file(struct preprocessor *p, const struct source_location *where) {
    const struct shader_compile_options *options = p->c->options;
    struct source_location place = *where, *at = &place;
    const char *text = NULL, *name = include_name(p, at), *near;
    size_t length = 0;
    if (!name)
        return;
    if (!options || !options->read_include) {
        compile_error(p->c, at, "#include is not possible here: there are no files to read from");
        return;
    }
    near = beside(p, name);
    if (near && (text = options->read_include(options->read_include_context, near, &length)))
        name = near;
    else
        text = options->read_include(options->read_include_context, name, &length);
    if (!text) {
        compile_error(p->c, at, "cannot find \"%.200s\" to include", name);
        return;
    }
    if (p->include_depth >= INCLUDE_DEPTH_MAX)
        compile_limit(p->c, at, "files include each other more than %d deep", INCLUDE_DEPTH_MAX);
    if (length > SOURCE_BYTES_MAX || p->included_bytes + length > SOURCE_BYTES_MAX)
        compile_limit(p->c, at, "more than %d bytes are included", SOURCE_BYTES_MAX);
    p->include_depth++;
    p->included_bytes += length;
    open_file(p, name, compilation_copy(p->c, text, length), length);
}

static bool says(const struct token *token, const char *text) {
    return token->kind >= TOKEN_IDENTIFIER && token->text && !strcmp(token->text, text);
}

/* What follows the '#'. */
static void obey_directive(struct preprocessor *p, const struct source_location *at) {
    struct lexer *lexer = &p->file->lexer;
    struct token name;
    struct token_list line = {0};
    lexer->in_directive = true;
    lexer_next(lexer, &name);
    lexer->in_directive = false;
    if (name.kind == TOKEN_NEWLINE || name.kind == TOKEN_END)
        return;
    if (says(&name, "define")) {
        macro_define(p);
        return;
    }
    if (says(&name, "undef")) {
        macro_undefine(p, &name.at);
        return;
    }
    if (condition_directive(p, &name))
        return;
    if (says(&name, "pragma")) {
        while (lexer->cursor < lexer->end && *lexer->cursor != '\n') /* may hold anything */
            lexer->cursor++;
        return;
    }
    if (says(&name, "error")) {
        const char *text = lexer->cursor, *end = memchr(text, '\n', (size_t)(lexer->end - text));
        int length = (int)((end ? end : lexer->end) - text);
        compile_error(p->c, at, "#error%.*s", length > 200 ? 200 : length, text);
        compilation_stop(p->c);
    }
    if (says(&name, "include")) {
        include_file(p, at);
        return;
    }
    preprocess_line(p, &line);
    if (name.kind == TOKEN_NUMBER) {
        set_line(p, &name, &line);
    } else if (says(&name, "line") && line.count && line.tokens[0].kind == TOKEN_NUMBER) {
        struct token_list rest = {line.tokens + 1, line.count - 1, 0};
        set_line(p, &line.tokens[0], &rest);
    } else if (!says(&name, "ident") && !says(&name, "sccs")) { /* these two say who wrote it */
        compile_error(p->c, at, "there is no directive #%.64s",
                      name.kind >= TOKEN_IDENTIFIER && name.text ? name.text : "");
    }
}

/* From the files; an included file goes on where it was included. */
static void read_file(struct preprocessor *p, struct token *token) {
    for (;;) {
        lexer_next(&p->file->lexer, token);
        if (token->kind == TOKEN_DIRECTIVE) {
            obey_directive(p, &token->at);
            continue;
        }
        if (token->kind != TOKEN_END)
            return;
        condition_end(p);
        if (!p->file->below)
            return;
        p->file = p->file->below;
        p->include_depth--;
    }
}

void preprocess_raw(struct preprocessor *p, struct token *token) {
    if (p->is_held) {
        *token = p->held;
        p->is_held = false;
        return;
    }
    while (p->expansion) {
        struct expansion *e = p->expansion;
        if (e->at < e->list->count) {
            *token = e->list->tokens[e->at++];
            return;
        }
        if (e->is_barrier) {
            *token = (struct token){.kind = TOKEN_END, .text = ""};
            return;
        }
        if (e->macro)
            e->macro->is_busy = false;
        p->expansion = e->below;
    }
    read_file(p, token);
}

/* __FILE__ and __LINE__ */
static void name_place(struct preprocessor *p, struct token *token) {
    bool is_line = says(token, "__LINE__");
    if (token->kind != TOKEN_IDENTIFIER)
        return;
    token->kind = is_line ? TOKEN_NUMBER : TOKEN_STRING;
    token->number = (float)token->at.line;
    char digits[16];
    snprintf(digits, sizeof digits, "%d", token->at.line);
    token->text = is_line ? compilation_copy(p->c, digits, strlen(digits)) : token->at.file;
}

void preprocess_next(struct preprocessor *p, struct token *token) {
    for (;;) {
        preprocess_raw(p, token);
        if (says(token, "__LINE__") || says(token, "__FILE__"))
            name_place(p, token);
        bool is_word = token->kind == TOKEN_IDENTIFIER || token->kind > TOKEN_NEWLINE;
        struct macro *macro = is_word && !token->is_expanded ? macro_find(p, token->text) : NULL;
        if (!macro)
            return;
        if (macro->is_busy) {
            token->is_expanded = true;
            return;
        }
        if (!macro_expand(p, macro, token))
            return;
    }
}
