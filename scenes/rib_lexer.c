/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_lexer.h"

#include "scenes/rib_number.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    WINDOW_BYTES = 256 * 1024,
    TOKEN_BYTES_MAX = 1 << 20,
    HELD_BYTES_MAX = 1 << 28,
    EXCERPT_BEFORE = 90,
    EXCERPT_AFTER = 60,
};

static bool lexer_start(struct rib_lexer *lexer, const char *file, struct status *status) {
    *lexer = (struct rib_lexer){.file = file, .descriptor = -1, .line = 1};
    lexer->c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!lexer->c_locale)
        return status_fail(status, STATUS_INTERNAL, "%s: the C locale is not there", file);
    return true;
}

/* What cannot be read twice (a pipe) is held whole, so that messages can still show its lines. */
static bool lexer_hold_all(struct rib_lexer *lexer, struct status *status) {
    size_t capacity = 0, length = 0;
    for (;;) {
        lexer->window = memory_grow(lexer->window, &capacity, length + WINDOW_BYTES, 1);
        ssize_t count = read(lexer->descriptor, lexer->window + length, WINDOW_BYTES);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return status_fail(status, STATUS_IO, "%s: %s", lexer->file, strerror(errno));
        if (count == 0)
            break;
        length += (size_t)count;
        if (length > HELD_BYTES_MAX)
            return status_fail(status, STATUS_LIMIT,
                               "%s: more than %d bytes from what is not a regular file",
                               lexer->file, HELD_BYTES_MAX);
    }
    close(lexer->descriptor);
    lexer->descriptor = -1;
    lexer->cursor = lexer->window_start = lexer->window;
    lexer->end = lexer->window + length;
    return true;
}

bool rib_lexer_open(struct rib_lexer *lexer, const char *file, struct status *status) {
    if (!lexer_start(lexer, file, status))
        return false;
    struct stat about;
    lexer->descriptor = open(file, O_RDONLY | O_CLOEXEC);
    if (lexer->descriptor < 0 || fstat(lexer->descriptor, &about) != 0) {
        int cause = errno;
        rib_lexer_close(lexer);
        return status_fail(status, cause == ENOENT ? STATUS_NOT_FOUND : STATUS_IO, "%s: %s", file,
                           strerror(cause));
    }
    lexer->device = about.st_dev;
    lexer->inode = about.st_ino;
    if (S_ISDIR(about.st_mode)) {
        rib_lexer_close(lexer);
        return status_fail(status, STATUS_INVALID, "%s: is a directory", file);
    }
    if (!S_ISREG(about.st_mode)) {
        if (lexer_hold_all(lexer, status))
            return true;
        rib_lexer_close(lexer);
        return false;
    }
    lexer->window = memory_get(1, WINDOW_BYTES);
    lexer->cursor = lexer->end = lexer->window_start = lexer->window;
    return true;
}

bool rib_lexer_open_memory(struct rib_lexer *lexer, const char *file, const char *text,
                           size_t length, struct status *status) {
    if (!lexer_start(lexer, file, status))
        return false;
    lexer->cursor = lexer->window_start = length ? text : "";
    lexer->end = lexer->cursor + length;
    return true;
}

void rib_lexer_close(struct rib_lexer *lexer) {
    if (lexer->descriptor >= 0)
        close(lexer->descriptor);
    if (lexer->c_locale)
        freelocale(lexer->c_locale);
    free(lexer->window);
    free(lexer->text);
    *lexer = (struct rib_lexer){.descriptor = -1};
}

/* The next byte or -1 at the end, when the window is used up. */
static int lexer_refill(struct rib_lexer *lexer) {
    if (lexer->descriptor < 0 || lexer->read_error)
        return -1;
    lexer->window_offset += (uint64_t)(lexer->end - lexer->window_start);
    ssize_t count;
    do
        count = read(lexer->descriptor, lexer->window, WINDOW_BYTES);
    while (count < 0 && errno == EINTR);
    if (count < 0)
        lexer->read_error = errno;
    lexer->cursor = lexer->window;
    lexer->end = lexer->window + (count > 0 ? count : 0);
    return count > 0 ? (unsigned char)*lexer->cursor : -1;
}

static inline int lexer_byte(struct rib_lexer *lexer) {
    return lexer->cursor < lexer->end ? (unsigned char)*lexer->cursor : lexer_refill(lexer);
}

static inline uint64_t lexer_offset(const struct rib_lexer *lexer) {
    return lexer->window_offset + (uint64_t)(lexer->cursor - lexer->window_start);
}

/* Steps over the byte that lexer_byte has shown to be a newline. */
static void lexer_newline(struct rib_lexer *lexer) {
    lexer->cursor++;
    lexer->line_offset = lexer_offset(lexer);
    if (lexer->line < INT_MAX)
        lexer->line++;
}

static bool lexer_keep(struct rib_lexer *lexer, char c) {
    if (lexer->text_length + 2 > lexer->text_capacity) {
        if (lexer->text_length + 2 > TOKEN_BYTES_MAX)
            return false;
        lexer->text = memory_grow(lexer->text, &lexer->text_capacity, lexer->text_length + 2, 1);
    }
    lexer->text[lexer->text_length++] = c;
    return true;
}

static void token_is(struct rib_lexer *lexer, struct rib_token *token, enum rib_token_kind kind) {
    lexer_keep(lexer, '\0');
    lexer->text_length--;
    token->kind = kind;
    token->text = lexer->text;
    token->length = lexer->text_length;
}

static void token_is_bad(struct rib_token *token, const char *problem) {
    token->kind = RIB_TOKEN_BAD;
    token->text = problem;
    token->length = strlen(problem);
}

static bool is_letter(int c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_number_part(int c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
}

/* Keeps bytes while they can belong to a word or number. */
static bool lexer_keep_word(struct rib_lexer *lexer, bool is_number) {
    int c = lexer_byte(lexer);
    while (is_number ? is_number_part(c) : is_letter(c) || (c >= '0' && c <= '9') || c == ':') {
        if (!lexer_keep(lexer, (char)c))
            return false;
        lexer->cursor++;
        c = lexer_byte(lexer);
    }
    return true;
}

static void lex_number(struct rib_lexer *lexer, struct rib_token *token) {
    if (!lexer_keep_word(lexer, true)) {
        token_is_bad(token, "a number is too long");
        return;
    }
    token_is(lexer, token, RIB_TOKEN_NUMBER);
    if (!rib_number_parse(token->text, token->length, lexer->c_locale, &token->number))
        token_is_bad(token, "not a finite decimal number");
}

/* After the backslash: \n \r \t \b \f, up to three octal digits, a continued line, or the byte
 * itself. */
static const char *lex_escape(struct rib_lexer *lexer) {
    static const char letters[] = "nrtbf", bytes[] = "\n\r\t\b\f";
    int c = lexer_byte(lexer);
    if (c < 0)
        return "a string is not closed";
    if (c == '\n') {
        lexer_newline(lexer);
        return NULL;
    }
    if (c >= '0' && c <= '7') {
        int value = 0;
        for (int i = 0; i < 3 && c >= '0' && c <= '7'; i++) {
            value = value * 8 + (c - '0');
            lexer->cursor++;
            c = lexer_byte(lexer);
        }
        if (value == 0 || value > 255)
            return "an octal escape must be 001 to 377";
        return lexer_keep(lexer, (char)value) ? NULL : "a string is too long";
    }
    const char *letter = strchr(letters, c);
    lexer->cursor++;
    if (c == 0)
        return "a string holds a NUL byte";
    return lexer_keep(lexer, letter ? bytes[letter - letters] : (char)c) ? NULL
                                                                         : "a string is too long";
}

static void lex_string(struct rib_lexer *lexer, struct rib_token *token) {
    lexer->cursor++;
    const char *problem = NULL;
    while (!problem) {
        int c = lexer_byte(lexer);
        if (c < 0) {
            problem = "a string is not closed";
        } else if (c == '"') {
            lexer->cursor++;
            token_is(lexer, token, RIB_TOKEN_STRING);
            return;
        } else if (c == '\\') {
            lexer->cursor++;
            problem = lex_escape(lexer);
        } else if (c == 0) {
            problem = "a string holds a NUL byte";
        } else if (!lexer_keep(lexer, (char)c)) {
            problem = "a string is too long";
        } else if (c == '\n') {
            lexer_newline(lexer);
        } else {
            lexer->cursor++;
        }
    }
    token_is_bad(token, problem);
}

/* Blanks and comments; structure comments (##RenderMan ...) are comments. Returns the byte after
 * them. */
static int lexer_skip_blanks(struct rib_lexer *lexer) {
    for (;;) {
        int c = lexer_byte(lexer);
        if (c == '\n') {
            lexer_newline(lexer);
        } else if (c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v') {
            lexer->cursor++;
        } else if (c == '#') {
            while (c >= 0 && c != '\n') {
                lexer->cursor++;
                c = lexer_byte(lexer);
            }
        } else {
            return c;
        }
    }
}

static void lex(struct rib_lexer *lexer, struct rib_token *token) {
    int c = lexer_skip_blanks(lexer);
    uint64_t offset = lexer_offset(lexer), column = offset - lexer->line_offset + 1;
    token->location.at =
        (struct scene_location){lexer->file, lexer->line, column < INT_MAX ? (int)column : INT_MAX};
    token->location.offset = offset;
    token->number = 0;
    lexer->text_length = 0;
    if (c < 0) {
        if (lexer->read_error)
            token_is_bad(token, strerror(lexer->read_error));
        else
            token_is(lexer, token, RIB_TOKEN_END);
    } else if (is_letter(c)) {
        if (lexer_keep_word(lexer, false))
            token_is(lexer, token, RIB_TOKEN_REQUEST);
        else
            token_is_bad(token, "a name is too long");
    } else if (is_number_part(c)) {
        lex_number(lexer, token);
    } else if (c == '"') {
        lex_string(lexer, token);
    } else if (c == '[' || c == ']') {
        lexer_keep(lexer, (char)c);
        lexer->cursor++;
        token_is(lexer, token, c == '[' ? RIB_TOKEN_OPEN : RIB_TOKEN_CLOSE);
    } else if (c == ',') {
        token_is_bad(token,
                     "unexpected ','; numbers are separated by blanks and written with a point");
    } else if (c >= 0x80 || c == 0x1f) {
        token_is_bad(token, "not ASCII RIB (binary and compressed RIB are not read)");
    } else {
        token_is_bad(token, "unexpected character");
    }
}

const struct rib_token *rib_lexer_peek(struct rib_lexer *lexer) {
    if (!lexer->has_peeked) {
        lex(lexer, &lexer->peeked);
        lexer->has_peeked = true;
    }
    return &lexer->peeked;
}

void rib_lexer_take(struct rib_lexer *lexer) {
    /* The end and a problem stay: whoever reads on meets them again. */
    if (lexer->peeked.kind != RIB_TOKEN_END && lexer->peeked.kind != RIB_TOKEN_BAD)
        lexer->has_peeked = false;
}

/* Up to `capacity` bytes of the source from `offset` on. */
static size_t excerpt_read(const struct rib_lexer *lexer, const char *file, uint64_t offset,
                           char *bytes, size_t capacity) {
    if (lexer && lexer->descriptor < 0) {
        size_t length = (size_t)(lexer->end - lexer->window_start);
        if (offset > length)
            return 0;
        size_t count = length - offset < capacity ? length - offset : capacity;
        memcpy(bytes, lexer->window_start + offset, count);
        return count;
    }
    int descriptor = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return 0;
    ssize_t count = pread(descriptor, bytes, capacity, (off_t)offset);
    close(descriptor);
    return count > 0 ? (size_t)count : 0;
}

bool rib_lexer_excerpt(const struct rib_lexer *lexer, const struct rib_location *location,
                       char *line, size_t capacity, size_t *caret) {
    char bytes[EXCERPT_BEFORE + EXCERPT_AFTER];
    uint64_t before = (uint64_t)(location->at.column - 1);
    bool is_cut = before > EXCERPT_BEFORE;
    if (is_cut)
        before = EXCERPT_BEFORE;
    size_t count =
        excerpt_read(lexer, location->at.file, location->offset - before, bytes, sizeof bytes);
    if (count < before || capacity < sizeof bytes + 8)
        return false;
    size_t length = 0;
    if (is_cut) {
        memcpy(line, "...", 3);
        length = 3;
    }
    *caret = length + before;
    for (size_t i = 0; i < count; i++) {
        unsigned char c = (unsigned char)bytes[i];
        if (c == '\n' || c == '\r')
            break;
        line[length++] = c == '\t' ? ' ' : c < 0x20 || c >= 0x7f ? '?' : (char)c;
    }
    line[length] = '\0';
    return length >= *caret;
}
