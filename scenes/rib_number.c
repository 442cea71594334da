/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/rib_number.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static const double exact_powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                      1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                      1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

struct decimal {
    uint64_t mantissa;
    int exponent;
    int digits; /* significant ones, without leading zeros */
    bool is_negative;
};

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

static void decimal_add_digit(struct decimal *decimal, char c) {
    if (decimal->digits || c != '0')
        decimal->digits++;
    if (decimal->digits <= 19)
        decimal->mantissa = decimal->mantissa * 10 + (uint64_t)(c - '0');
}

/* sign? digits* ('.' digits*)? ([eE] sign? digits+)? with at least one digit before the exponent.
 */
static bool decimal_scan(const char *at, const char *end, struct decimal *decimal) {
    *decimal = (struct decimal){0};
    if (at < end && (*at == '-' || *at == '+'))
        decimal->is_negative = *at++ == '-';
    const char *first = at;
    for (; at < end && is_digit(*at); at++)
        decimal_add_digit(decimal, *at);
    size_t digits = (size_t)(at - first);
    if (at < end && *at == '.') {
        first = ++at;
        for (; at < end && is_digit(*at); at++)
            decimal_add_digit(decimal, *at);
        digits += (size_t)(at - first);
        if (at - first < 1000)
            decimal->exponent = -(int)(at - first);
        else
            decimal->digits = 1000; /* never the short way */
    }
    if (digits == 0)
        return false;
    if (at < end && (*at == 'e' || *at == 'E')) {
        bool is_negative = false;
        if (++at < end && (*at == '-' || *at == '+'))
            is_negative = *at++ == '-';
        if (at == end)
            return false;
        int exponent = 0;
        for (; at < end && is_digit(*at); at++)
            if (exponent < 100000)
                exponent = exponent * 10 + (*at - '0');
        decimal->exponent += is_negative ? -exponent : exponent;
    }
    return at == end;
}

bool rib_number_parse(const char *text, size_t length, locale_t c_locale, double *value) {
    struct decimal decimal;
    if (!decimal_scan(text, text + length, &decimal))
        return false;
    /* Both operands are exact in double, so one rounding gives the correctly rounded result. */
    if (decimal.digits <= 19 && decimal.mantissa <= (UINT64_C(1) << 53) &&
        decimal.exponent >= -22 && decimal.exponent <= 22) {
        double number = (double)decimal.mantissa;
        number = decimal.exponent < 0 ? number / exact_powers[-decimal.exponent]
                                      : number * exact_powers[decimal.exponent];
        *value = decimal.is_negative ? -number : number;
        return true;
    }
    double number = strtod_l(text, NULL, c_locale);
    if (!isfinite(number))
        return false;
    *value = number;
    return true;
}
