/* SPDX-License-Identifier: Apache-2.0 */
#include "base/trace.h"

#include <stdarg.h>

void trace_init(struct trace *trace, const char *name, FILE *live) {
    snprintf(trace->name, sizeof trace->name, "%s", name);
    trace->live = live;
    trace->count = 0;
}

void trace_line(struct trace *trace, const char *format, ...) {
    char *line = trace->lines[trace->count++ % TRACE_LINES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, TRACE_LINE_BYTES, format, arguments);
    va_end(arguments);
    if (trace->live)
        fprintf(trace->live, "%s: %s\n", trace->name, line);
}

void trace_dump(const struct trace *trace, FILE *stream, unsigned long count) {
    unsigned long kept = trace->count < TRACE_LINES ? trace->count : TRACE_LINES;
    if (count > kept)
        count = kept;
    for (unsigned long i = trace->count - count; i < trace->count; i++)
        fprintf(stream, "%s: %s\n", trace->name, trace->lines[i % TRACE_LINES]);
}
