/* SPDX-License-Identifier: Apache-2.0 */
#ifndef COMPILATION_H
#define COMPILATION_H

#include "base/arena.h"
#include "shaders/compiler/shader_compile.h"

#include <setjmp.h>

/* What all passes of one compilation share: memory, messages and the way out.
 *
 * Everything a pass allocates comes from `arena` and lives until the compilation ends. A pass that
 * cannot go on (memory or another limit reached, eight errors reported) calls compilation_stop,
 * which unwinds to shader_compile; no pass holds anything but arena memory, so nothing leaks. */

enum {
    SOURCE_BYTES_MAX = 1 << 20,
    NESTING_MAX = 200,           /* statements and parentheses inside each other */
    EXPRESSION_DEPTH_MAX = 1000, /* operators in a row that build one tree */
    CONTROL_DEPTH_MAX =
        120, /* control flow inside each other after inlining; C compilers stop at 256 */
    INLINE_DEPTH_MAX = 4000, /* operators (1 each), statements (2) and calls (16) inside each other
                                after inlining */
    INSTRUCTION_COUNT_MAX = 200000,
    ARRAY_FLOATS_MAX = 65536, /* of one array, and of all arrays of a shader after inlining */
    LIGHT_SETS_MAX = 16,      /* places of which the lights are wanted */
    ERROR_COUNT_MAX = 8,
    WARNING_COUNT_MAX = 64,
    INCLUDE_DEPTH_MAX = 32,
    MACRO_DEPTH_MAX = 100,      /* macros in arguments of macros */
    MACRO_TOKENS_MAX = 1 << 18, /* that all expansions give in all */
    MACRO_ARGUMENTS_MAX = 64,
};

/* A place in the source. `line_text` is the start of the physical line, ended by a newline or NUL.
 */
struct source_location {
    const char *file;
    const char *line_text;
    int line, column;
};

struct compilation {
    struct arena arena;
    const struct shader_compile_options *options;
    struct shader_program *program;          /* being filled; owns only its arena */
    const struct source_location *shader_at; /* the name of the main shader; NULL before checks */
    jmp_buf stop;
    enum status_code code; /* STATUS_OK until the first error */
    int error_count;
    char message[sizeof((struct status *)0)->message];
    size_t message_length;
    const char *warnings[WARNING_COUNT_MAX];
    int warning_count;
    char *output; /* C text under construction; malloc, released by the driver */
    size_t output_length, output_capacity;
};

/* Zeroed work memory; stops the compilation at the limit, so never NULL. */
void *compilation_get(struct compilation *c, size_t size_bytes);
char *compilation_copy(struct compilation *c, const char *text, size_t length);
_Noreturn void compilation_stop(struct compilation *c);

/* Report at a place; the eighth error stops the compilation. */
void compile_error(struct compilation *c, const struct source_location *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void compile_warning(struct compilation *c, const struct source_location *at, const char *format,
                     ...) __attribute__((format(printf, 3, 4)));
/* A stated limit was reached: an error after which nothing else is worth saying. */
_Noreturn void compile_limit(struct compilation *c, const struct source_location *at,
                             const char *format, ...) __attribute__((format(printf, 3, 4)));

/* The candidate most like `name`, or NULL when none is near enough to be a likely typing mistake.
 * Call with *best NULL and *best_distance 0 first, then once per candidate. */
void suggestion_consider(const char *name, const char *candidate, const char **best,
                         int *best_distance);

#endif
