/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/analysis_values.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES_MAX = 1000000 };

struct value_list {
    const char *what;
    int64_t minimum, maximum;
    int64_t *values;
    size_t count, capacity;
};

static bool add_value(struct value_list *list, int64_t value, struct status *status) {
    if (value < list->minimum || value > list->maximum)
        return status_fail(status, STATUS_INVALID,
                           "%s must lie in %" PRId64 " .. %" PRId64 ", not %" PRId64, list->what,
                           list->minimum, list->maximum, value);
    if (list->count == VALUES_MAX)
        return status_fail(status, STATUS_LIMIT, "%s: more than %d values", list->what, VALUES_MAX);
    list->values =
        memory_grow(list->values, &list->capacity, list->count + 1, sizeof *list->values);
    list->values[list->count++] = value;
    return true;
}

/* A number at *text, which moves behind it; false when there is none or it is not whole. */
static bool parse_number(const char **text, int64_t *value) {
    static const char suffixes[] = "kMGT";
    const char *at = *text;
    int64_t whole = 0, scale = 1;
    int decimals = -1, digits = 0;
    for (; (*at >= '0' && *at <= '9') || (*at == '.' && at[1] != '.' && decimals < 0); at++) {
        if (*at == '.') {
            decimals = 0;
            continue;
        }
        if (__builtin_mul_overflow(whole, 10, &whole) ||
            __builtin_add_overflow(whole, *at - '0', &whole))
            return false;
        digits++;
        decimals += decimals >= 0;
    }
    const char *suffix = *at ? strchr(suffixes, *at) : NULL;
    for (long i = suffix ? suffix - suffixes + 1 : 0; i; i--)
        scale *= 1000;
    at += suffix != NULL;
    while (decimals > 0 && scale % 10 == 0)
        scale /= 10, decimals--;
    while (decimals > 0 && whole % 10 == 0)
        whole /= 10, decimals--;
    *text = at;
    return digits && decimals <= 0 && !__builtin_mul_overflow(whole, scale, value);
}

static bool parse_item(struct value_list *list, const char **text, struct status *status) {
    int64_t first, last, step = 1;
    const char *begin = *text;
    bool ok = parse_number(text, &first), is_factor = false;
    last = first;
    if (ok && !strncmp(*text, "..", 2)) {
        *text += 2;
        ok = parse_number(text, &last);
        if (ok && (**text == '+' || **text == '*')) {
            is_factor = *(*text)++ == '*';
            ok = parse_number(text, &step) && step > is_factor;
        }
    }
    if (!ok || (**text && **text != ',') || last < first || (is_factor && !first))
        return status_fail(status, STATUS_INVALID,
                           "%s must be whole numbers like 4, 6.4G, 1..16, 0..100+25 or 1..64*2, "
                           "separated by commas, not \"%s\"",
                           list->what, begin);
    for (int64_t value = first;;) {
        if (!add_value(list, value, status))
            return false;
        if ((is_factor ? __builtin_mul_overflow(value, step, &value)
                       : __builtin_add_overflow(value, step, &value)) ||
            value > last)
            return true;
    }
}

bool values_parse(const char *what, const char *text, int64_t minimum, int64_t maximum,
                  int64_t **values, size_t *count, struct status *status) {
    struct value_list list = {.what = what, .minimum = minimum, .maximum = maximum};
    bool ok;
    while ((ok = parse_item(&list, &text, status)) && *text == ',')
        text++;
    if (!ok) {
        free(list.values);
        return false;
    }
    *values = list.values;
    *count = list.count;
    return true;
}
