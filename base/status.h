/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_STATUS_H
#define BASE_STATUS_H

#include <stdbool.h>
#include <stddef.h>

/* The one way a function of this project says that it failed, and why.
 *
 * A function that can fail returns bool and takes a `struct status *` as its last argument. On
 * failure it returns false with code and message set; on success it returns true and leaves the
 * status alone. Library code neither prints nor exits: whoever owns the terminal shows `message`.
 */

enum status_code {
    STATUS_OK = 0,
    STATUS_INVALID,   /* input that breaks a rule: scene, shader, machine, option, wire message */
    STATUS_NOT_FOUND, /* a file, shader or node that should be there is not */
    STATUS_IO,        /* the operating system refused: disk full, permission, socket */
    STATUS_LIMIT,     /* a stated limit of ours was reached: memory, counts, time range */
    STATUS_TIMEOUT,   /* a deadline passed */
    STATUS_LOST,      /* another node of the cluster went away */
    STATUS_INTERNAL,  /* our own mistake, found before it did harm */
};

struct status {
    enum status_code code;
    char message[2048]; /* one or more lines, no final newline; may hold a source line with a caret
                         */
};

/* Sets code and a printf-style message; returns false so that a caller can `return
 * status_fail(...)`. A NULL status is accepted (the caller does not want the message). */
bool status_fail(struct status *status, enum status_code code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Puts "PREFIX: " before the message that is there; returns false. */
bool status_prefix(struct status *status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The exit status of a program that ends with this code: 0 for OK, 1 for bad input, 2 for
 * everything that went wrong around it, 3 when the cause is another node (so that a supervisor
 * looks there first). */
int status_exit_code(enum status_code code);

/* Out of memory is a failed status for sizes that input controls (`memory_try`), and an abort with
 * a message for small fixed sizes (`memory_get`): there is nothing sensible left to do. Both give
 * zeroed memory, released by free(). */
void *memory_get(size_t count, size_t size);
void *memory_try(size_t count, size_t size, struct status *status);
/* Grows an array to hold at least `needed` items of `size` bytes, doubling; the new part is not
 * cleared. */
void *memory_grow(void *items, size_t *capacity, size_t needed, size_t size);
char *memory_copy_string(const char *text);

#endif
