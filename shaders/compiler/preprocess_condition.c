/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/preprocess.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* #if and its family. What is not taken is skipped unread. */

struct reader {
    struct preprocessor *p;
    const struct token_list *list;
    int at, depth;
    int skipping;                 /* inside what && || ?: do not evaluate */
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

static void enter(struct reader *r) {
    if (++r->depth > NESTING_MAX)
        compile_limit(r->p->c, &r->where, "nested more than %d deep", NESTING_MAX);
}

static double read_conditional(struct reader *r);

/* Conditions are whole numbers as in C; 3.5 is a number, too, for shaders that ask for versions. */
static double number_of(const struct token *token) {
    bool is_whole = !strpbrk(token->text, ".") &&
                    (!strpbrk(token->text, "eE") || !strncasecmp(token->text, "0x", 2));
    return is_whole ? (double)strtoll(token->text, NULL, 0) : strtod(token->text, NULL);
}

/* Far inside what fits, so that every conversion is defined. */
static int64_t whole(double number) {
    return number >= 9e18 ? (int64_t)9e18 : number > -9e18 ? (int64_t)number : (int64_t)-9e18;
}

/* ('!' | '~' | '-' | '+') unary | number | name | '(' conditional ')' */
static double read_unary(struct reader *r) {
    double value = 0;
    int kind = peek(r);
    enter(r);
    r->at++;
    if (kind == '!') {
        value = read_unary(r) == 0;
    } else if (kind == '-') {
        value = -read_unary(r);
    } else if (kind == '+') {
        value = read_unary(r);
    } else if (kind == '~') {
        value = (double)~whole(read_unary(r));
    } else if (kind == TOKEN_NUMBER) {
        value = number_of(&r->list->tokens[r->at - 1]);
    } else if (kind == '(') {
        value = read_conditional(r);
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
    case '|':
        return 3;
    case '^':
        return 4;
    case '&':
        return 5;
    case TOKEN_EQUAL:
    case TOKEN_NOT_EQUAL:
        return 6;
    case '<':
    case '>':
    case TOKEN_LESS_EQUAL:
    case TOKEN_GREATER_EQUAL:
        return 7;
    case TOKEN_SHIFT_LEFT:
    case TOKEN_SHIFT_RIGHT:
        return 8;
    case '+':
    case '-':
        return 9;
    case '*':
    case '/':
    case '%':
        return 10;
    }
    return 0;
}

static double divide(struct reader *r, int kind, double a, double b) {
    bool is_whole = a == (double)whole(a) && b == (double)whole(b);
    if (b == 0) {
        if (!r->skipping)
            complain(r, "division by zero in a condition");
        return 0;
    }
    if (kind == '%')
        return whole(b) ? (double)(whole(a) % whole(b)) : 0;
    return is_whole ? (double)(whole(a) / whole(b)) : a / b;
}

static double shift(double a, double b) {
    int64_t count = whole(b);
    if (count < 0 || count > 62)
        return 0;
    double power = (double)((int64_t)1 << count);
    return power == 1 ? a : a * power;
}

static double apply(struct reader *r, int kind, double a, double b) {
    switch (kind) {
    case TOKEN_OR:
        return a != 0 || b != 0;
    case TOKEN_AND:
        return a != 0 && b != 0;
    case '|':
        return (double)(whole(a) | whole(b));
    case '^':
        return (double)(whole(a) ^ whole(b));
    case '&':
        return (double)(whole(a) & whole(b));
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
    case TOKEN_SHIFT_LEFT:
        return shift(a, b);
    case TOKEN_SHIFT_RIGHT:
        return b >= 0 && b <= 62 ? (double)(whole(a) >> whole(b)) : 0;
    case '+':
        return a + b;
    case '-':
        return a - b;
    case '*':
        return a * b;
    default:
        return divide(r, kind, a, b);
    }
}

static double read_binary(struct reader *r, int lowest) {
    double left = read_unary(r);
    int level, kind;
    while ((level = precedence(kind = peek(r))) >= lowest && level) {
        bool is_decided = (kind == TOKEN_OR && left != 0) || (kind == TOKEN_AND && left == 0);
        r->at++;
        r->skipping += is_decided;
        left = apply(r, kind, left, read_binary(r, level + 1));
        r->skipping -= is_decided;
    }
    return left;
}

/* binary ['?' conditional ':' conditional] */
static double read_conditional(struct reader *r) {
    double condition = read_binary(r, 1);
    if (peek(r) != '?')
        return condition;
    enter(r);
    r->at++;
    r->skipping += condition == 0;
    double yes = read_conditional(r);
    r->skipping -= condition == 0;
    if (peek(r) != ':')
        complain(r, "expected ':' in the condition");
    r->at++;
    r->skipping += condition != 0;
    double no = read_conditional(r);
    r->skipping -= condition != 0;
    r->depth--;
    return condition != 0 ? yes : no;
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
            one.text = macro_find(p, line->tokens[name].text) ? "1" : "0";
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
    double value = read_conditional(&r);
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
