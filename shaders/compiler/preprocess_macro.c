/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/preprocess.h"

#include "base/hash.h"

#include <string.h>

/* Macros, as in C. */

static struct macro **bucket_of(struct preprocessor *p, const char *name) {
    return &p->macros[hash_string(name, 0) % MACRO_BUCKETS];
}

struct macro *macro_find(struct preprocessor *p, const char *name) {
    for (struct macro *m = *bucket_of(p, name); m; m = m->next)
        if (!strcmp(m->name, name))
            return m;
    return NULL;
}

static bool is_word(const struct token *token) {
    return token->kind == TOKEN_IDENTIFIER || token->kind > TOKEN_NEWLINE;
}

static bool is_same(const struct macro *a, const struct macro *b) {
    if (a->is_function != b->is_function || a->body.count != b->body.count ||
        a->parameters.count != b->parameters.count)
        return false;
    for (int i = 0; i < a->parameters.count; i++)
        if (strcmp(a->parameters.tokens[i].text, b->parameters.tokens[i].text))
            return false;
    for (int i = 0; i < a->body.count; i++) {
        const struct token *x = &a->body.tokens[i], *y = &b->body.tokens[i];
        if (x->kind != y->kind || x->number != y->number || strcmp(x->text, y->text))
            return false;
    }
    return true;
}

/* The parameters at the start of `line`; returns where the body starts. */
static int read_parameters(struct preprocessor *p, struct macro *macro,
                           const struct token_list *line) {
    int at = 1;
    while (at < line->count && is_word(&line->tokens[at])) {
        token_list_add(p->c, &macro->parameters, &line->tokens[at++]);
        if (at < line->count && line->tokens[at].kind == ',')
            at++;
        else
            break;
    }
    if (at >= line->count || line->tokens[at].kind != ')')
        compile_error(p->c, &line->tokens[at < line->count ? at : 0].at,
                      "expected the names of a macro's parameters, then ')'");
    if (macro->parameters.count > MACRO_ARGUMENTS_MAX)
        compile_limit(p->c, &line->tokens[0].at, "a macro with more than %d parameters",
                      MACRO_ARGUMENTS_MAX);
    return at + 1;
}

void macro_define(struct preprocessor *p) {
    struct lexer *lexer = &p->file->lexer;
    struct macro *macro = compilation_get(p->c, sizeof *macro), *old;
    struct token name;
    struct token_list line = {0};
    lexer->in_directive = true;
    lexer_next(lexer, &name);
    macro->is_function = lexer_at_parenthesis(lexer);
    lexer->in_directive = name.kind != TOKEN_NEWLINE;
    if (lexer->in_directive)
        preprocess_line(p, &line);
    if (!is_word(&name)) {
        compile_error(p->c, &name.at, "expected the name of a macro");
        return;
    }
    macro->name = name.text;
    for (int i = macro->is_function ? read_parameters(p, macro, &line) : 0; i < line.count; i++) {
        token_list_add(p->c, &macro->body, &line.tokens[i]);
    }
    if (macro->body.count && (macro->body.tokens[0].kind == TOKEN_PASTE ||
                              macro->body.tokens[macro->body.count - 1].kind == TOKEN_PASTE)) {
        compile_error(p->c, &name.at, "## stands between two words");
        return;
    }
    old = macro_find(p, macro->name);
    if (!old) {
        macro->next = *bucket_of(p, macro->name);
        *bucket_of(p, macro->name) = macro;
    } else if (!is_same(old, macro)) {
        compile_warning(p->c, &name.at, "macro '%.64s' is defined anew, and not the same",
                        macro->name);
        old->is_function = macro->is_function;
        old->parameters = macro->parameters;
        old->body = macro->body;
    }
}

void macro_undefine(struct preprocessor *p, const struct source_location *at) {
    struct token_list line = {0};
    preprocess_line(p, &line);
    if (!line.count || !is_word(&line.tokens[0])) {
        compile_error(p->c, at, "expected the name of a macro");
        return;
    }
    for (struct macro **m = bucket_of(p, line.tokens[0].text); *m; m = &(*m)->next)
        if (!strcmp((*m)->name, line.tokens[0].text)) {
            *m = (*m)->next;
            return;
        }
}

static void push(struct preprocessor *p, const struct token_list *list, struct macro *macro,
                 bool is_barrier) {
    struct expansion *e = compilation_get(p->c, sizeof *e);
    *e = (struct expansion){list, 0, macro, is_barrier, p->expansion};
    p->expansion = e;
    if (macro)
        macro->is_busy = true;
}

void macro_expand_list(struct preprocessor *p, const struct token_list *list,
                       struct token_list *expanded) {
    struct token token;
    if (++p->macro_depth > MACRO_DEPTH_MAX)
        compile_limit(p->c, list->count ? &list->tokens[0].at : NULL,
                      "macros inside the arguments of macros more than %d deep", MACRO_DEPTH_MAX);
    push(p, list, NULL, true);
    for (preprocess_next(p, &token); token.kind != TOKEN_END; preprocess_next(p, &token))
        token_list_add(p->c, expanded, &token);
    p->expansion = p->expansion->below;
    p->macro_depth--;
}

/* The arguments up to the closing parenthesis; false (and a message) when they do not fit. */
static bool read_arguments(struct preprocessor *p, struct macro *macro,
                           const struct source_location *at,
                           struct token_list arguments[MACRO_ARGUMENTS_MAX]) {
    int count = 0, depth = 0;
    struct token token;
    for (;;) {
        preprocess_raw(p, &token);
        if (token.kind == TOKEN_END) {
            compile_error(p->c, at, "the arguments of macro '%.64s' never end", macro->name);
            p->held = token;
            p->is_held = true;
            return false;
        }
        if (token.kind == ')' && !depth)
            break;
        depth += token.kind == '(' ? 1 : token.kind == ')' ? -1 : 0;
        if (token.kind == ',' && !depth) {
            count++;
            continue;
        }
        if (count < macro->parameters.count)
            token_list_add(p->c, &arguments[count], &token);
        else if (!count)
            count = 1; /* something where there are no parameters */
    }
    count += macro->parameters.count != 0;
    if (count == macro->parameters.count)
        return true;
    compile_error(p->c, at, "macro '%.64s' takes %d argument%s, not %d", macro->name,
                  macro->parameters.count, macro->parameters.count == 1 ? "" : "s", count);
    return false;
}

static void add_expanded(struct preprocessor *p, struct token_list *list,
                         const struct token *token) {
    if (++p->expanded_tokens > MACRO_TOKENS_MAX)
        compile_limit(p->c, &token->at, "macros expand to more than %d words", MACRO_TOKENS_MAX);
    token_list_add(p->c, list, token);
}

static int parameter_number(const struct macro *macro, const struct token *token) {
    if (is_word(token))
        for (int i = 0; i < macro->parameters.count; i++)
            if (!strcmp(macro->parameters.tokens[i].text, token->text))
                return i;
    return -1;
}

/* What the i-th word of the body stands for: itself, an argument with its macros expanded, an
 * argument as it was written (next to ##), or the text of one (after #). */
static struct token_list operand(struct preprocessor *p, const struct macro *macro, int *i,
                                 const struct source_location *at,
                                 const struct token_list *arguments) {
    const struct token_list *body = &macro->body;
    struct token one = body->tokens[*i];
    struct token_list list = {0};
    bool is_pasted = (*i > 0 && body->tokens[*i - 1].kind == TOKEN_PASTE) ||
                     (*i + 1 < body->count && body->tokens[*i + 1].kind == TOKEN_PASTE);
    bool is_text = one.kind == '#' && macro->is_function && *i + 1 < body->count;
    int number = parameter_number(macro, is_text ? &body->tokens[*i + 1] : &one);
    if (is_text && number >= 0) {
        one = token_text_of(p->c, &arguments[number]);
        ++*i;
    } else if (number >= 0 && is_pasted) {
        return arguments[number];
    } else if (number >= 0) {
        macro_expand_list(p, &arguments[number], &list);
        return list;
    }
    one.at = *at;
    token_list_add(p->c, &list, &one);
    return list;
}

bool macro_expand(struct preprocessor *p, struct macro *macro, const struct token *token) {
    struct token_list arguments[MACRO_ARGUMENTS_MAX], *result;
    struct source_location at = token->at;
    if (macro->is_function) {
        struct token next;
        preprocess_raw(p, &next);
        if (next.kind != '(') {
            p->held = next;
            p->is_held = true;
            return false;
        }
        memset(arguments, 0, sizeof arguments);
        if (!read_arguments(p, macro, &at, arguments))
            return true; /* nothing in its place */
    }
    result = compilation_get(p->c, sizeof *result);
    bool pastes = false; /* ## was just passed, and there is something before it */
    for (int i = 0; i < macro->body.count; i++) {
        int before = result->count, first = 0;
        if (macro->body.tokens[i].kind == TOKEN_PASTE)
            continue;
        struct token_list one = operand(p, macro, &i, &at, arguments);
        if (pastes && one.count) {
            struct token *left = &result->tokens[result->count - 1];
            *left = token_paste(p->c, left, &one.tokens[first++], &at);
        }
        for (; first < one.count; first++)
            add_expanded(p, result, &one.tokens[first]);
        pastes = i + 1 < macro->body.count && macro->body.tokens[i + 1].kind == TOKEN_PASTE &&
                 (result->count > before || (pastes && result->count));
    }
    push(p, result, macro, false);
    return true;
}
