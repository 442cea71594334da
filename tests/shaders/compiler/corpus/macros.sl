/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PATTERNS
#define PATTERNS 2
#endif
#define snoise(x) (2 * (float noise(x)) - 1)
#define blend(a, b, x) ((a) * (1 - (x)) + (b) * (x))
#define STEPS 3 // a comment
#if PATTERNS > 1 && defined(snoise)
#define pattern(p) blend(snoise(p), \
    snoise(2 * (p)), 0.5)
#elif PATTERNS == 1
#define pattern(p) snoise(p)
#else
#error no pattern
#endif
#undef STEPS
#define STEPS 4

surface macros(float k = STEPS;) {
    float sum = 0, i;
    for (i = 0; i < STEPS; i += 1)
        sum += pattern(P * i * pattern(k));
    Ci = sum;
}
