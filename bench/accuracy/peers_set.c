/* SPDX-License-Identifier: Apache-2.0 */
/* Other libraries' functions over arrays, for one vector width: compiled once per width with
 * PEER_WIDTH (4, 8 or 16) and the flags of its instruction set. HAVE_SLEEF and HAVE_LIBMVEC say
 * what is there. */

#include "peers.h"

#include <math.h>
#include <string.h>

#ifdef HAVE_SLEEF
#include <sleef.h>
#endif

#define JOIN_(a, b, c, d) a##b##c##d
#define JOIN(a, b, c, d) JOIN_(a, b, c, d)

typedef float lanes __attribute__((vector_size(4 * PEER_WIDTH)));

/* Arrays whose length is not a multiple of the width end with zeros. */
static lanes load_lanes(const float *from, size_t left) {
    lanes x = {0};
    memcpy(&x, from, left < PEER_WIDTH ? left * sizeof *from : sizeof x);
    return x;
}

static void store_lanes(float *to, lanes x, size_t left) {
    memcpy(to, &x, left < PEER_WIDTH ? left * sizeof *to : sizeof x);
}

#define APPLY_VECTOR_1(prefix, name, call)                                                         \
    static void prefix##_##name(const float *const *in, float *const *out, size_t count) {         \
        for (size_t i = 0; i < count; i += PEER_WIDTH)                                             \
            store_lanes(out[0] + i, call(load_lanes(in[0] + i, count - i)), count - i);            \
    }
#define APPLY_VECTOR_2(prefix, name, call)                                                         \
    static void prefix##_##name(const float *const *in, float *const *out, size_t count) {         \
        for (size_t i = 0; i < count; i += PEER_WIDTH)                                             \
            store_lanes(out[0] + i,                                                                \
                        call(load_lanes(in[0] + i, count - i), load_lanes(in[1] + i, count - i)),  \
                        count - i);                                                                \
    }
#define ENTRY_1(prefix, name) {#name, 1, 1, prefix##_##name},
#define ENTRY_2(prefix, name) {#name, 2, 1, prefix##_##name},

/* ---- SLEEF ---- */

#ifdef HAVE_SLEEF
#if PEER_WIDTH == 4
#define SLEEF_NAME(name, ulp) JOIN(Sleef_, name, f4_##ulp, sse2)
#elif PEER_WIDTH == 8
#define SLEEF_NAME(name, ulp) JOIN(Sleef_, name, f8_##ulp, avx2)
#else
#define SLEEF_NAME(name, ulp) JOIN(Sleef_, name, f16_##ulp, avx512f)
#endif
#define SLEEF_U10_1(F) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(exp) F(exp2) F(log) F(log2)
#define SLEEF_U10_2(F) F(atan2) F(pow)
#define SLEEF_U35_1(F) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(exp2) F(log) F(log2)
#define SLEEF_U35_2(F) F(atan2)
#define U10_1(name) APPLY_VECTOR_1(u10, name, SLEEF_NAME(name, u10))
#define U10_2(name) APPLY_VECTOR_2(u10, name, SLEEF_NAME(name, u10))
#define U35_1(name) APPLY_VECTOR_1(u35, name, SLEEF_NAME(name, u35))
#define U35_2(name) APPLY_VECTOR_2(u35, name, SLEEF_NAME(name, u35))
SLEEF_U10_1(U10_1)
SLEEF_U10_2(U10_2)
SLEEF_U35_1(U35_1)
SLEEF_U35_2(U35_2)
#define U10_ENTRY_1(name) ENTRY_1(u10, name)
#define U10_ENTRY_2(name) ENTRY_2(u10, name)
#define U35_ENTRY_1(name) ENTRY_1(u35, name)
#define U35_ENTRY_2(name) ENTRY_2(u35, name)
static const struct vector_function sleef_u10[] = {SLEEF_U10_1(U10_ENTRY_1)
                                                       SLEEF_U10_2(U10_ENTRY_2)};
static const struct vector_function sleef_u35[] = {SLEEF_U35_1(U35_ENTRY_1)
                                                       SLEEF_U35_2(U35_ENTRY_2)};
#endif

/* ---- glibc's vector library: names of the x86-64 vector ABI ---- */

#ifdef HAVE_LIBMVEC
#if PEER_WIDTH == 4
#define LIBMVEC_NAME(kind, name) JOIN(_ZGVbN4, kind, _, name##f)
#elif PEER_WIDTH == 8
#define LIBMVEC_NAME(kind, name) JOIN(_ZGVdN8, kind, _, name##f)
#else
#define LIBMVEC_NAME(kind, name) JOIN(_ZGVeN16, kind, _, name##f)
#endif
#define LIBMVEC_1(F) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(exp) F(exp2) F(log) F(log2)
#define LIBMVEC_2(F) F(atan2) F(pow)
#define MVEC_1(name)                                                                               \
    lanes LIBMVEC_NAME(v, name)(lanes);                                                            \
    APPLY_VECTOR_1(mvec, name, LIBMVEC_NAME(v, name))
#define MVEC_2(name)                                                                               \
    lanes LIBMVEC_NAME(vv, name)(lanes, lanes);                                                    \
    APPLY_VECTOR_2(mvec, name, LIBMVEC_NAME(vv, name))
LIBMVEC_1(MVEC_1)
LIBMVEC_2(MVEC_2)
#define MVEC_ENTRY_1(name) ENTRY_1(mvec, name)
#define MVEC_ENTRY_2(name) ENTRY_2(mvec, name)
static const struct vector_function libmvec[] = {LIBMVEC_1(MVEC_ENTRY_1) LIBMVEC_2(MVEC_ENTRY_2)};
#endif

/* ---- scalar functions, called through a pointer so that nothing is inlined ---- */

#define SCALAR_1(F) F(sin) F(cos) F(tan) F(asin) F(acos) F(atan) F(exp) F(exp2) F(log) F(log2)
#define SCALAR_2(F) F(atan2) F(pow)
#define APPLY_SCALAR_1(name)                                                                       \
    static void scalar_##name(const float *const *in, float *const *out, size_t count) {           \
        float (*volatile pointer)(float) = name##f;                                                \
        float (*const call)(float) = pointer;                                                      \
        for (size_t i = 0; i < count; i++)                                                         \
            out[0][i] = call(in[0][i]);                                                            \
    }
#define APPLY_SCALAR_2(name)                                                                       \
    static void scalar_##name(const float *const *in, float *const *out, size_t count) {           \
        float (*volatile pointer)(float, float) = name##f;                                         \
        float (*const call)(float, float) = pointer;                                               \
        for (size_t i = 0; i < count; i++)                                                         \
            out[0][i] = call(in[0][i], in[1][i]);                                                  \
    }
SCALAR_1(APPLY_SCALAR_1)
SCALAR_2(APPLY_SCALAR_2)
#define SCALAR_ENTRY_1(name) ENTRY_1(scalar, name)
#define SCALAR_ENTRY_2(name) ENTRY_2(scalar, name)
static const struct vector_function scalar[] = {SCALAR_1(SCALAR_ENTRY_1) SCALAR_2(SCALAR_ENTRY_2)};

#define COUNT_OF(table) (int)(sizeof(table) / sizeof *(table))
#define PEERS JOIN(peers, _, PEER_WIDTH, )
extern const struct peer_set PEERS;
const struct peer_set PEERS = {
    .width = PEER_WIDTH,
    .functions =
        {
            [PEER_SCALAR] = scalar,
#ifdef HAVE_SLEEF
            [PEER_SLEEF_U10] = sleef_u10,
            [PEER_SLEEF_U35] = sleef_u35,
#endif
#ifdef HAVE_LIBMVEC
            [PEER_LIBMVEC] = libmvec,
#endif
        },
    .function_counts =
        {
            [PEER_SCALAR] = COUNT_OF(scalar),
#ifdef HAVE_SLEEF
            [PEER_SLEEF_U10] = COUNT_OF(sleef_u10),
            [PEER_SLEEF_U35] = COUNT_OF(sleef_u35),
#endif
#ifdef HAVE_LIBMVEC
            [PEER_LIBMVEC] = COUNT_OF(libmvec),
#endif
        },
};
