/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RIB_LEXER_H
#define RIB_LEXER_H

#include "base/status.h"
#include "scenes/scene.h"

#include <locale.h>
#include <stdint.h>
#include <sys/types.h>

/* Tokens of ASCII RIB from a file or from memory. A file is read through a window, so that a long
 * animation is never in memory as a whole. */

enum rib_token_kind {
    RIB_TOKEN_END, /* of this source */
    RIB_TOKEN_REQUEST,
    RIB_TOKEN_NUMBER,
    RIB_TOKEN_STRING,
    RIB_TOKEN_OPEN,  /* [ */
    RIB_TOKEN_CLOSE, /* ] */
    RIB_TOKEN_BAD,   /* text says what is wrong */
};

struct rib_location {
    struct scene_location at;
    uint64_t offset; /* bytes from the start of the source */
};

struct rib_token {
    enum rib_token_kind kind;
    struct rib_location location;
    double number;
    const char *
        text; /* request name, string without quotes, problem; valid until the next token is read */
    size_t length;
};

struct rib_lexer {
    const char *file; /* for locations; not owned */
    int descriptor;   /* -1: all of the source is in the window */
    dev_t device;     /* which file it is, to find cycles */
    ino_t inode;      /* 0 for memory */
    const char *cursor, *end;
    char *window; /* owned; NULL for memory of the caller */
    const char *window_start;
    uint64_t window_offset; /* of window_start in the source */
    uint64_t line_offset;   /* of the first byte of the current line */
    int line;
    char *text; /* of the token */
    size_t text_length, text_capacity;
    locale_t c_locale;
    int read_error; /* errno of a failed read */
    bool has_peeked;
    struct rib_token peeked;
};

/* `file` names the source in locations and must outlive it. */
bool rib_lexer_open(struct rib_lexer *lexer, const char *file, struct status *status);
/* `text` is not copied and must outlive the lexer. */
bool rib_lexer_open_memory(struct rib_lexer *lexer, const char *file, const char *text,
                           size_t length, struct status *status);
void rib_lexer_close(struct rib_lexer *lexer);

/* The next token without taking it; the pointer is valid until rib_lexer_take and a further peek.
 */
const struct rib_token *rib_lexer_peek(struct rib_lexer *lexer);
/* Drops the token that peek shows; its text stays valid until the next peek. */
void rib_lexer_take(struct rib_lexer *lexer);

/* The line around a location for messages: printable, cut to what fits, with *caret the index of
 * the location in it. Returns false when the source cannot be read again. `lexer` may be NULL: the
 * file is opened again. */
bool rib_lexer_excerpt(const struct rib_lexer *lexer, const struct rib_location *location,
                       char *line, size_t capacity, size_t *caret);

#endif
