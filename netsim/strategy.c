/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/strategy.h"

#include <string.h>

const struct strategy *strategy_at(int index) {
    static const struct strategy *const list[] = {
#define STRATEGY_ENTRY(name) &strategy_##name,
        STRATEGIES(STRATEGY_ENTRY)
#undef STRATEGY_ENTRY
    };
    return index >= 0 && (size_t)index < sizeof list / sizeof *list ? list[index] : NULL;
}

const struct strategy *strategy_find(const char *name) {
    const struct strategy *strategy;
    for (int i = 0; (strategy = strategy_at(i)); i++)
        if (!strcmp(strategy->name, name))
            return strategy;
    return NULL;
}
