/* SPDX-License-Identifier: Apache-2.0 */
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool status_fail(struct status *status, enum status_code code, const char *format, ...) {
    if (status) {
        va_list arguments;
        va_start(arguments, format);
        status->code = code;
        vsnprintf(status->message, sizeof status->message, format, arguments);
        va_end(arguments);
    }
    return false;
}

bool status_prefix(struct status *status, const char *format, ...) {
    if (status) {
        char prefixed[sizeof status->message];
        va_list arguments;
        va_start(arguments, format);
        int length = vsnprintf(prefixed, sizeof prefixed, format, arguments);
        va_end(arguments);
        if (length >= 0 && (size_t)length < sizeof prefixed)
            snprintf(prefixed + length, sizeof prefixed - (size_t)length, ": %.*s",
                     (int)(sizeof prefixed - (size_t)length - 3), status->message);
        memcpy(status->message, prefixed, sizeof prefixed);
    }
    return false;
}

int status_exit_code(enum status_code code) {
    switch (code) {
    case STATUS_OK:
        return 0;
    case STATUS_INVALID:
    case STATUS_NOT_FOUND:
    case STATUS_LIMIT:
        return 1;
    case STATUS_LOST:
        return 3;
    case STATUS_IO:
    case STATUS_TIMEOUT:
    case STATUS_INTERNAL:
        return 2;
    }
    return 2;
}

void *memory_get(size_t count, size_t size) {
    void *memory = calloc(count ? count : 1, size ? size : 1);
    if (!memory) {
        fprintf(stderr, "sortlast: out of memory (%zu items of %zu bytes)\n", count, size);
        abort();
    }
    return memory;
}

void *memory_try(size_t count, size_t size, struct status *status) {
    void *memory = calloc(count ? count : 1, size ? size : 1);
    if (!memory)
        status_fail(status, STATUS_LIMIT, "out of memory: %zu items of %zu bytes", count, size);
    return memory;
}

void *memory_grow(void *items, size_t *capacity, size_t needed, size_t size) {
    if (needed <= *capacity)
        return items;
    size_t grown = *capacity ? *capacity * 2 : 16;
    while (grown < needed)
        grown *= 2;
    items = realloc(items, grown * size);
    if (!items) {
        fprintf(stderr, "sortlast: out of memory (%zu items of %zu bytes)\n", grown, size);
        abort();
    }
    *capacity = grown;
    return items;
}

char *memory_copy_string(const char *text) {
    size_t length = strlen(text) + 1;
    return memcpy(memory_get(length, 1), text, length);
}
