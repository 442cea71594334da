/* SPDX-License-Identifier: Apache-2.0 */
#include "peers.h"

#include <string.h>

extern const struct peer_set peers_4;
#ifdef __x86_64__
extern const struct peer_set peers_8, peers_16;
#endif

const char *const peer_headings[PEER_COUNT] = {
#define PEER_HEADING(name, heading) heading,
    PEER_LIBRARIES(PEER_HEADING)
#undef PEER_HEADING
};

const struct peer_set *peers_of_width(int width) {
    static const struct peer_set *const sets[] = {
        &peers_4,
#ifdef __x86_64__
        &peers_8,
        &peers_16,
#endif
    };
    for (size_t i = 0; i < sizeof sets / sizeof *sets; i++)
        if (sets[i]->width == width)
            return sets[i];
    return NULL;
}

const struct vector_function *peers_find(const struct peer_set *set, enum peer_library library,
                                         const char *name) {
    size_t length = strlen(name);
    if (length > 5 && strcmp(name + length - 5, "_fast") == 0)
        length -= 5;
    for (int i = 0; set && i < set->function_counts[library]; i++)
        if (strlen(set->functions[library][i].name) == length &&
            strncmp(set->functions[library][i].name, name, length) == 0)
            return &set->functions[library][i];
    return NULL;
}
