/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/compiler/compilation.h"

#include <stdio.h>
#include <string.h>

enum { EXCERPT_MAX = 120, TEXT_MAX = 400 };

void *compilation_get(struct compilation *c, size_t size_bytes) {
    void *memory = arena_get(&c->arena, size_bytes);
    if (!memory)
        compile_limit(c, NULL, "the shader needs more memory than the compiler may use");
    return memory;
}

char *compilation_copy(struct compilation *c, const char *text, size_t length) {
    char *copy = compilation_get(c, length + 1);
    memcpy(copy, text, length);
    return copy;
}

_Noreturn void compilation_stop(struct compilation *c) {
    longjmp(c->stop, 1);
}

/* Writes the source line of `at` and, below it, a caret. Tabs stay tabs in both, so that the caret
 * lines up; other bytes that a terminal might not show in one column become '?'. */
static int format_excerpt(const struct source_location *at, char *out, size_t size) {
    const char *line = at->line_text;
    int length = 0;
    while (line[length] && line[length] != '\n' && line[length] != '\r')
        length++;
    int caret = at->column > 0 ? at->column - 1 : 0;
    if (caret > length)
        caret = length;
    int first = caret > EXCERPT_MAX - 20 ? caret - (EXCERPT_MAX - 20) : 0;
    int count = length - first < EXCERPT_MAX ? length - first : EXCERPT_MAX;
    char text[EXCERPT_MAX + 1], below[EXCERPT_MAX + 1];
    for (int i = 0; i < count; i++) {
        unsigned char byte = (unsigned char)line[first + i];
        text[i] = byte == '\t' || (byte >= ' ' && byte < 127) ? (char)byte : '?';
        below[i] = byte == '\t' ? '\t' : ' ';
    }
    text[count] = '\0';
    below[caret - first] = '\0';
    return snprintf(out, size, "\n%s\n%s^", text, below);
}

static size_t format_message(const struct source_location *at, const char *what, const char *format,
                             va_list arguments, char *out, size_t size) {
    char text[TEXT_MAX], excerpt[2 * EXCERPT_MAX + 8] = "";
    vsnprintf(text, sizeof text, format, arguments);
    if (at && at->line_text)
        format_excerpt(at, excerpt, sizeof excerpt);
    int length;
    if (at)
        length = snprintf(out, size, "%.200s:%d:%d: %s: %s%s", at->file, at->line, at->column, what,
                          text, excerpt);
    else
        length = snprintf(out, size, "%s: %s", what, text);
    return length < 0 ? 0 : (size_t)length;
}

static void append_error(struct compilation *c, const struct source_location *at,
                         enum status_code code, const char *format, va_list arguments) {
    char one[TEXT_MAX + 512];
    size_t length = format_message(at, "error", format, arguments, one, sizeof one);
    if (length >= sizeof one)
        length = sizeof one - 1;
    size_t newline = c->message_length ? 1 : 0;
    if (c->code == STATUS_OK)
        c->code = code;
    c->error_count++;
    if (c->message_length + newline + length >= sizeof c->message)
        compilation_stop(c);
    if (newline)
        c->message[c->message_length++] = '\n';
    memcpy(c->message + c->message_length, one, length);
    c->message_length += length;
    c->message[c->message_length] = '\0';
}

void compile_error(struct compilation *c, const struct source_location *at, const char *format,
                   ...) {
    va_list arguments;
    va_start(arguments, format);
    append_error(c, at, STATUS_INVALID, format, arguments);
    va_end(arguments);
    if (c->error_count >= ERROR_COUNT_MAX)
        compilation_stop(c);
}

_Noreturn void compile_limit(struct compilation *c, const struct source_location *at,
                             const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    append_error(c, at, STATUS_LIMIT, format, arguments);
    va_end(arguments);
    compilation_stop(c);
}

void compile_warning(struct compilation *c, const struct source_location *at, const char *format,
                     ...) {
    if (c->warning_count >= WARNING_COUNT_MAX)
        return;
    char one[TEXT_MAX + 512];
    va_list arguments;
    va_start(arguments, format);
    size_t length = format_message(at, "warning", format, arguments, one, sizeof one);
    va_end(arguments);
    if (length >= sizeof one)
        length = sizeof one - 1;
    for (int i = 0; i < c->warning_count; i++)
        if (!strcmp(c->warnings[i], one))
            return; /* inlining a function twice need not say it twice */
    char *copy = arena_copy_string(&c->program->arena, one, length);
    if (copy)
        c->warnings[c->warning_count++] = copy;
}

/* Levenshtein distance, names longer than 32 bytes are never suggested. */
static int name_distance(const char *a, const char *b) {
    size_t a_length = strlen(a), b_length = strlen(b);
    if (a_length > 32 || b_length > 32)
        return 99;
    int row[33];
    for (size_t j = 0; j <= b_length; j++)
        row[j] = (int)j;
    for (size_t i = 1; i <= a_length; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= b_length; j++) {
            int best = diagonal + (a[i - 1] != b[j - 1]);
            if (row[j] + 1 < best)
                best = row[j] + 1;
            if (row[j - 1] + 1 < best)
                best = row[j - 1] + 1;
            diagonal = row[j];
            row[j] = best;
        }
    }
    return row[b_length];
}

void suggestion_consider(const char *name, const char *candidate, const char **best,
                         int *best_distance) {
    int distance = name_distance(name, candidate);
    int allowed = strlen(name) < 3 ? 0 : strlen(name) < 6 ? 1 : 2;
    if (distance > allowed &&
        !(strlen(name) < 3 && distance == 1 && strlen(candidate) == strlen(name) &&
          (name[0] | 32) == (candidate[0] | 32)))
        return;
    if (*best && distance >= *best_distance)
        return;
    *best = candidate;
    *best_distance = distance;
}
