/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_reader.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

const struct rib_token *rib_peek(struct rib_reader *reader) {
    return rib_lexer_peek(&reader->sources[reader->source_count - 1]);
}

void rib_take(struct rib_reader *reader) {
    rib_lexer_take(&reader->sources[reader->source_count - 1]);
}

/* Says that `what` was expected where the next token is. */
static bool fail_expected(struct rib_reader *reader, const char *what) {
    const struct rib_token *token = rib_peek(reader);
    switch (token->kind) {
    case RIB_TOKEN_BAD:
        return rib_error(reader, &token->location, "%s", token->text);
    case RIB_TOKEN_END:
        return rib_error(reader, &token->location, "the file ends where %s should be: %s",
                         reader->request, what);
    case RIB_TOKEN_REQUEST:
        if (strcasecmp(token->text, "nan") == 0 || strncasecmp(token->text, "inf", 3) == 0)
            return rib_error(reader, &token->location,
                             "%s is not a finite decimal number: %s of %s", token->text, what,
                             reader->request);
        return rib_error(reader, &token->location, "%s: %s expected before '%.100s'",
                         reader->request, what, token->text);
    default:
        return rib_error(reader, &token->location, "%s: %s expected", reader->request, what);
    }
}

bool rib_read_number(struct rib_reader *reader, const char *what, double *number) {
    return rib_read_numbers(reader, what, number, 1);
}

static bool read_bare_number(struct rib_reader *reader, const char *what, double *number) {
    const struct rib_token *token = rib_peek(reader);
    if (token->kind != RIB_TOKEN_NUMBER)
        return fail_expected(reader, what);
    *number = token->number;
    rib_take(reader);
    return true;
}

bool rib_read_numbers(struct rib_reader *reader, const char *what, double *numbers, size_t count) {
    bool is_bracketed = rib_peek(reader)->kind == RIB_TOKEN_OPEN;
    if (is_bracketed)
        rib_take(reader);
    for (size_t i = 0; i < count; i++)
        if (!read_bare_number(reader, what, &numbers[i]))
            return false;
    if (!is_bracketed)
        return true;
    if (rib_peek(reader)->kind != RIB_TOKEN_CLOSE)
        return rib_peek(reader)->kind == RIB_TOKEN_NUMBER
                   ? rib_error(reader, &rib_peek(reader)->location, "%s: %s: only %zu expected",
                               reader->request, what, count)
                   : fail_expected(reader, "]");
    rib_take(reader);
    return true;
}

static bool number_to_integer(struct rib_reader *reader, const struct rib_location *location,
                              const char *what, double number, int minimum, int maximum,
                              int *integer) {
    if (number != floor(number))
        return rib_error(reader, location, "%s: %s must be whole, not %g", reader->request, what,
                         number);
    if (number < minimum || number > maximum)
        return rib_error(reader, location, "%s: %s must be %d to %d, not %.15g", reader->request,
                         what, minimum, maximum, number);
    *integer = (int)number;
    return true;
}

bool rib_read_integer(struct rib_reader *reader, const char *what, int minimum, int maximum,
                      int *integer) {
    struct rib_location location = rib_peek(reader)->location;
    double number;
    return rib_read_number(reader, what, &number) &&
           number_to_integer(reader, &location, what, number, minimum, maximum, integer);
}

bool rib_read_array(struct rib_reader *reader, const char *what, double **numbers, size_t *count) {
    size_t capacity = 0;
    *numbers = NULL;
    *count = 0;
    if (rib_peek(reader)->kind != RIB_TOKEN_OPEN) {
        *numbers = memory_grow(*numbers, &capacity, 1, sizeof **numbers);
        *count = 1;
        return read_bare_number(reader, what, *numbers);
    }
    rib_take(reader);
    while (rib_peek(reader)->kind == RIB_TOKEN_NUMBER) {
        *numbers = memory_grow(*numbers, &capacity, *count + 1, sizeof **numbers);
        (*numbers)[(*count)++] = rib_peek(reader)->number;
        rib_take(reader);
    }
    if (rib_peek(reader)->kind != RIB_TOKEN_CLOSE)
        return fail_expected(reader, what);
    rib_take(reader);
    return true;
}

bool rib_read_integer_array(struct rib_reader *reader, const char *what, int minimum,
                            int **integers, size_t *count) {
    size_t capacity = 0;
    *integers = NULL;
    *count = 0;
    bool is_bracketed = rib_peek(reader)->kind == RIB_TOKEN_OPEN;
    if (is_bracketed)
        rib_take(reader);
    else if (rib_peek(reader)->kind != RIB_TOKEN_NUMBER)
        return fail_expected(reader, what);
    while (rib_peek(reader)->kind == RIB_TOKEN_NUMBER) {
        const struct rib_token *token = rib_peek(reader);
        *integers = memory_grow(*integers, &capacity, *count + 1, sizeof **integers);
        if (!number_to_integer(reader, &token->location, what, token->number, minimum, 2147483646,
                               *integers + *count))
            return false;
        ++*count;
        rib_take(reader);
        if (!is_bracketed)
            return true;
    }
    if (rib_peek(reader)->kind != RIB_TOKEN_CLOSE)
        return fail_expected(reader, what);
    rib_take(reader);
    return true;
}

bool rib_read_string(struct rib_reader *reader, const char *what, const char **string) {
    bool is_bracketed = rib_peek(reader)->kind == RIB_TOKEN_OPEN;
    if (is_bracketed)
        rib_take(reader);
    const struct rib_token *token = rib_peek(reader);
    if (token->kind != RIB_TOKEN_STRING)
        return fail_expected(reader, what);
    *string = rib_intern(reader, token->text, token->length);
    rib_take(reader);
    if (!is_bracketed)
        return true;
    if (rib_peek(reader)->kind != RIB_TOKEN_CLOSE)
        return fail_expected(reader, "]");
    rib_take(reader);
    return true;
}

bool rib_read_handle(struct rib_reader *reader, const char *what, const char **key) {
    char text[64];
    if (rib_peek(reader)->kind == RIB_TOKEN_STRING)
        return rib_read_string(reader, what, key);
    int number;
    if (!rib_read_integer(reader, what, -2147483647, 2147483646, &number))
        return false;
    /* A newline keeps numbers apart from strings of digits. */
    snprintf(text, sizeof text, "%d\n", number);
    *key = rib_intern(reader, text, strlen(text));
    return true;
}

bool rib_skip_arguments(struct rib_reader *reader) {
    for (bool is_open = false;;) {
        const struct rib_token *token = rib_peek(reader);
        switch (token->kind) {
        case RIB_TOKEN_BAD:
            return rib_error(reader, &token->location, "%s", token->text);
        case RIB_TOKEN_END:
        case RIB_TOKEN_REQUEST:
            return is_open ? fail_expected(reader, "]") : true;
        case RIB_TOKEN_OPEN:
        case RIB_TOKEN_CLOSE:
            if (is_open == (token->kind == RIB_TOKEN_OPEN))
                return rib_error(reader, &token->location, "unexpected '%s'", token->text);
            is_open = !is_open;
            break;
        case RIB_TOKEN_NUMBER:
        case RIB_TOKEN_STRING:
            break;
        }
        rib_take(reader);
    }
}
