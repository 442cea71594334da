/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/preprocess.h"

#include <string.h>

/* #if and its family. What is not taken is skipped unread. */

struct reader {
    struct preprocessor *p;
    const struct token_list *list;
    int at, depth;
    struct source_location where; /* of the directive */
    bool is_wrong;
};

static int peek(const struct reader *r) {
    return r->at < r->list->count ? r->list->tokens[r->at].kind : TOKEN_END;
}

static void complain(struct reader *r, const char *text) {
    if (!r->is_wrong)
        compile_error(r->p->c, r->at < r->list->count ? &r->list->tokens[r->at].at : &r->where,
                      "%s", text);
    r->is_wrong = true;
}

static double read_binary(struct reader *r, int lowest);

/* ('!' | '-' | '+') unary | number | name | '(' binary ')' */
static double read_unary(struct reader *r) {
    double value = 0;
    int kind = peek(r);
    if (++r->depth > NESTING_MAX)
        compile_limit(r->p->c, &r->where, "nested more than %d deep", NESTING_MAX);
    r->at++;
    if (kind == '!') {
        value = read_unary(r) == 0;
    } else if (kind == '-') {
        value = -read_unary(r);
    } else if (kind == '+') {
        value = read_unary(r);
    } else if (kind == TOKEN_NUMBER) {
        value = (double)r->list->tokens[r->at - 1].number;
    } else if (kind == '(') {
        value = read_binary(r, 1);
        if (peek(r) != ')')
            complain(r, "expected ')' in the condition");
        r->at++;
    } else if (kind != TOKEN_IDENTIFIER && kind <= TOKEN_NEWLINE) { /* other names are 0 */
        r->at--;
        complain(r, "expected a condition of numbers and names");
        r->at = r->list->count;
    }
    r->depth--;
    return value;
}

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
    case '*':
    case '/':
        return 6;
    }
    return 0;
}

static double apply(struct reader *r, int kind, double a, double b) {
    switch (kind) {
    case TOKEN_OR:
        return a != 0 || b != 0;
    case TOKEN_AND:
        return a != 0 && b != 0;
    case TOKEN_EQUAL:
        return a == b;
    case TOKEN_NOT_EQUAL:
        return a != b;
    case '<':
        return a < b;
    case '>':
        return a > b;
    case TOKEN_LESS_EQUAL:
        return a <= b;
    case TOKEN_GREATER_EQUAL:
        return a >= b;
    case '+':
        return a + b;
    case '-':
        return a - b;
    case '*':
        return a * b;
    default:
        if (b == 0)
            complain(r, "division by zero in a condition");
        return b == 0 ? 0 : a / b;
    }
}

static double read_binary(struct reader *r, int lowest) {
    double left = read_unary(r);
    int level, kind;
    while ((level = precedence(kind = peek(r))) >= lowest && level) {
        r->at++;
        left = apply(r, kind, left, read_binary(r, level + 1));
    }
    return left;
}

static bool says(const struct token *token, const char *text) {
    return token->kind >= TOKEN_IDENTIFIER && token->text && !strcmp(token->text, text);
}

/* Replaces `defined NAME` and `defined (NAME)` by 1 or 0. */
static void resolve_defined(struct preprocessor *p, const struct token_list *line,
                            struct token_list *resolved) {
    for (int i = 0; i < line->count; i++) {
        struct token one = line->tokens[i];
        bool has_parenthesis = i + 3 < line->count && line->tokens[i + 1].kind == '(';
        int name = i + 1 + has_parenthesis;
        if (says(&one, "defined") && name < line->count &&
            (line->tokens[name].kind == TOKEN_IDENTIFIER ||
             line->tokens[name].kind > TOKEN_NEWLINE)) {
            one.kind = TOKEN_NUMBER;
            one.number = macro_find(p, line->tokens[name].text) ? 1 : 0;
            i = name + (has_parenthesis && line->tokens[name + 1].kind == ')');
        }
        token_list_add(p->c, resolved, &one);
    }
}

static bool read_condition(struct preprocessor *p, const struct source_location *at) {
    struct token_list line = {0}, resolved = {0}, expanded = {0};
    preprocess_line(p, &line);
    resolve_defined(p, &line, &resolved);
    macro_expand_list(p, &resolved, &expanded);
    struct reader r = {.p = p, .list = &expanded, .where = *at};
    double value = read_binary(&r, 1);
    if (r.at < expanded.count)
        complain(&r, "expected an operator in the condition");
    return value != 0;
}

static bool read_is_defined(struct preprocessor *p, const struct source_location *at) {
    struct token_list line = {0};
    preprocess_line(p, &line);
    if (line.count != 1 ||
        (line.tokens[0].kind != TOKEN_IDENTIFIER && line.tokens[0].kind <= TOKEN_NEWLINE)) {
        compile_error(p->c, at, "expected the name of a macro");
        return false;
    }
    return macro_find(p, line.tokens[0].text) != NULL;
}

static void drop_line(struct preprocessor *p) {
    struct token_list line = {0};
    preprocess_line(p, &line);
}

static bool is_opening(const struct token *name) {
    return says(name, "if") || says(name, "ifdef") || says(name, "ifndef");
}

/* After a group that is not taken: up to the #elif or #else that is, or the #endif. */
static void skip_group(struct preprocessor *p) {
    struct lexer *lexer = &p->file->lexer;
    struct condition *condition = p->file->conditions;
    int depth = 0;
    for (;;) {
        struct token hash, name;
        lexer_skip_to_directive(lexer);
        lexer_next(lexer, &hash);
        if (hash.kind == TOKEN_END)
            return; /* condition_end complains */
        lexer->in_directive = true;
        lexer_next(lexer, &name);
        lexer->in_directive = false;
        if (is_opening(&name)) {
            depth++;
        } else if (says(&name, "endif")) {
            if (!depth--) {
                drop_line(p);
                p->file->conditions = condition->below;
                return;
            }
        } else if (!depth && (says(&name, "else") || says(&name, "elif"))) {
            bool is_else = says(&name, "else");
            if (condition->has_else)
                compile_error(p->c, &name.at, "#%s after #else", name.text);
            condition->has_else |= is_else;
            if (!condition->was_taken && (is_else || read_condition(p, &name.at))) {
                condition->was_taken = true;
                if (is_else)
                    drop_line(p);
                return;
            }
        }
    }
}

bool condition_directive(struct preprocessor *p, const struct token *name) {
    bool is_else = says(name, "else"), is_elif = says(name, "elif"), is_end = says(name, "endif");
    if (is_opening(name)) {
        struct condition *condition = compilation_get(p->c, sizeof *condition);
        condition->at = name->at;
        condition->below = p->file->conditions;
        p->file->conditions = condition;
        condition->was_taken = says(name, "if")
                                   ? read_condition(p, &name->at)
                                   : read_is_defined(p, &name->at) == says(name, "ifdef");
        if (!condition->was_taken)
            skip_group(p);
        return true;
    }
    if (!is_else && !is_elif && !is_end)
        return false;
    struct condition *condition = p->file->conditions;
    if (!condition) {
        compile_error(p->c, &name->at, "#%s without #if", name->text);
        drop_line(p);
    } else if (is_end) {
        drop_line(p);
        p->file->conditions = condition->below;
    } else {
        if (condition->has_else)
            compile_error(p->c, &name->at, "#%s after #else", name->text);
        condition->has_else |= is_else;
        skip_group(p);
    }
    return true;
}

void condition_end(struct preprocessor *p) {
    for (; p->file->conditions; p->file->conditions = p->file->conditions->below)
        compile_error(p->c, &p->file->conditions->at, "this #if is never closed");
}
