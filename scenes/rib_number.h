/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RIB_NUMBER_H
#define RIB_NUMBER_H

#include <locale.h>
#include <stdbool.h>
#include <stddef.h>

/* Reads the whole of `text` (terminated by NUL, `length` bytes) as a decimal number, correctly
 * rounded and independent of the process's locale; `c_locale` is one made by newlocale for "C".
 * Hexadecimal, NaN, Inf and values beyond the range of double are refused; values too small to hold
 * become zero or denormal. */
bool rib_number_parse(const char *text, size_t length, locale_t c_locale, double *value);

#endif
