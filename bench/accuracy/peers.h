/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PEERS_H
#define PEERS_H

#include "shaders/simd/vector_kernels.h"

/* What the functions are measured beside, in the same run and through the same loops over arrays:
 * SLEEF to 1.0 and to 3.5 ulp (where it was there at build time), glibc's vector library, and the C
 * library's scalar functions. */

/* X(name, column heading) */
#define PEER_LIBRARIES(X)                                                                          \
    X(SLEEF_U10, "SLEEF u10")                                                                      \
    X(SLEEF_U35, "SLEEF u35")                                                                      \
    X(LIBMVEC, "libmvec")                                                                          \
    X(SCALAR, "glibc scalar")

enum peer_library {
#define PEER_ENUM(name, heading) PEER_##name,
    PEER_LIBRARIES(PEER_ENUM)
#undef PEER_ENUM
        PEER_COUNT
};

extern const char *const peer_headings[PEER_COUNT];

struct peer_set {
    int width; /* as that of the vector_kernels it stands beside */
    const struct vector_function *functions[PEER_COUNT];
    int function_counts[PEER_COUNT];
};

/* The peers with vectors of that many lanes, or NULL. */
const struct peer_set *peers_of_width(int width);
/* The library's function of that name ("_fast" is ignored), or NULL. */
const struct vector_function *peers_find(const struct peer_set *set, enum peer_library library,
                                         const char *name);

#endif
