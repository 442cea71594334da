/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_TRACE_H
#define BASE_TRACE_H

#include <stdbool.h>
#include <stdio.h>

/* What a node did lately: a ring of short lines, cheap to write, shown when a person asks (-v
 * prints as they come; SIGUSR1 or a failure prints the last ones). Nothing that a result depends on
 * reads it. */
enum { TRACE_LINES = 64, TRACE_LINE_BYTES = 160 };

struct trace {
    char name[32]; /* of the node, begins each printed line */
    FILE *live;    /* where lines go as they come; NULL: only the ring */
    unsigned long count;
    char lines[TRACE_LINES][TRACE_LINE_BYTES];
};

void trace_init(struct trace *trace, const char *name, FILE *live);
void trace_line(struct trace *trace, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Prints the last `count` lines, oldest first. */
void trace_dump(const struct trace *trace, FILE *stream, unsigned long count);

#endif
