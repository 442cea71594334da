/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_reader.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *rib_intern(struct rib_reader *reader, const char *text, size_t length) {
    return name_table_intern(&reader->interned, &reader->strings, text, length);
}

/* "FILE:LINE:COLUMN: KIND: TEXT" and, when the source is still there, the line with a caret. */
static void message_format(const struct rib_reader *reader, const struct rib_location *location,
                           const char *kind, const char *text, char *message, size_t capacity) {
    const struct rib_lexer *source = NULL;
    for (int i = 0; i < reader->source_count; i++)
        if (reader->sources[i].file == location->at.file)
            source = &reader->sources[i];
    char line[256];
    size_t caret;
    int length = snprintf(message, capacity, "%s:%d:%d: %s: %s", location->at.file,
                          location->at.line, location->at.column, kind, text);
    if (length < 0 || (size_t)length >= capacity)
        return;
    if (!rib_lexer_excerpt(source, location, line, sizeof line, &caret))
        return;
    snprintf(message + length, capacity - (size_t)length, "\n%s\n%*s^", line, (int)caret, "");
}

static bool fail_at(struct rib_reader *reader, const struct rib_location *location,
                    enum status_code code, const char *format, va_list arguments) {
    char text[1024], message[sizeof reader->status->message];
    vsnprintf(text, sizeof text, format, arguments);
    message_format(reader, location, "error", text, message, sizeof message);
    return status_fail(reader->status, code, "%s", message);
}

bool rib_error(struct rib_reader *reader, const struct rib_location *location, const char *format,
               ...) {
    va_list arguments;
    va_start(arguments, format);
    fail_at(reader, location, STATUS_INVALID, format, arguments);
    va_end(arguments);
    return false;
}

bool rib_error_code(struct rib_reader *reader, const struct rib_location *location,
                    enum status_code code, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fail_at(reader, location, code, format, arguments);
    va_end(arguments);
    return false;
}

/* Whether this warning is the first of its kind in its file. */
static bool warning_is_new(struct rib_reader *reader, const char *file, const char *key) {
    char both[512];
    snprintf(both, sizeof both, "%.300s\n%.200s", key, file);
    if (name_table_find(&reader->warned, both))
        return false;
    const char *name = rib_intern(reader, both, strlen(both));
    name_table_set(&reader->warned, name, (void *)name);
    return true;
}

void rib_warn(struct rib_reader *reader, const struct rib_location *location, const char *key,
              const char *format, ...) {
    if (reader->warning_total >= RIB_WARNINGS_MAX ||
        !warning_is_new(reader, location->at.file, key))
        return;
    char text[1024], message[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (++reader->warning_total == RIB_WARNINGS_MAX)
        snprintf(text, sizeof text, "%d warnings; no more will be shown", RIB_WARNINGS_MAX);
    message_format(reader, location, "warning", text, message, sizeof message);
    reader->warnings = memory_grow(reader->warnings, &reader->warning_capacity,
                                   reader->warning_count + 1, sizeof *reader->warnings);
    reader->warnings[reader->warning_count++] = memory_copy_string(message);
}

const char *rib_reader_warning(struct rib_reader *reader) {
    free(reader->warning_shown);
    reader->warning_shown = NULL;
    if (reader->warning_next < reader->warning_count)
        reader->warning_shown = reader->warnings[reader->warning_next++];
    if (reader->warning_next == reader->warning_count)
        reader->warning_next = reader->warning_count = 0;
    return reader->warning_shown;
}
