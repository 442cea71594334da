/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/host_node.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* Finds "%d" or "%0Nd"; returns its length and sets the number of digits. */
static size_t number_part(const char *at, int *digits) {
    size_t length = 1;
    *digits = 1;
    if (at[0] != '%')
        return 0;
    if (at[length] == '0' && isdigit((unsigned char)at[length + 1])) {
        *digits = at[length + 1] - '0';
        length += 2;
    }
    return at[length] == 'd' ? length + 1 : 0;
}

bool host_image_name(const char *pattern, bool is_sequence, int number, char *name, size_t size,
                     struct status *status) {
    int written = -1, digits;
    for (const char *at = pattern; *at && written < 0; at++) {
        const size_t length = number_part(at, &digits);
        if (length)
            written = snprintf(name, size, "%.*s%0*d%s", (int)(at - pattern), pattern, digits,
                               number, at + length);
    }
    if (written < 0 && is_sequence) {
        const char *slash = strrchr(pattern, '/'), *dot = strrchr(slash ? slash : pattern, '.');
        if (!dot)
            dot = pattern + strlen(pattern);
        written = snprintf(name, size, "%.*s.%04d%s", (int)(dot - pattern), pattern, number, dot);
    }
    if (written < 0)
        written = snprintf(name, size, "%s", pattern);
    if (written < 0 || (size_t)written >= size)
        return status_fail(status, STATUS_INVALID, "the name of the picture is too long: %s",
                           pattern);
    return true;
}
