/* SPDX-License-Identifier: Apache-2.0 */
#ifndef ANALYSIS_VALUES_H
#define ANALYSIS_VALUES_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

/* Lists of whole numbers as options give them: items separated by commas, each a number or a range
 * "1..16", "0..100+25" (every 25th) or "1..64*2" (doubling). Numbers may have a fraction and one of
 * k, M, G, T behind them as long as they come out whole: 6.4G. The array is the caller's; an item
 * outside minimum .. maximum fails. */
bool values_parse(const char *what, const char *text, int64_t minimum, int64_t maximum,
                  int64_t **values, size_t *count, struct status *status);

#endif
