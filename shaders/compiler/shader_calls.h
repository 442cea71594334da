/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_CALLS_H
#define SHADER_CALLS_H

#include <stdbool.h>

/* Calls of mathematical functions that have a fast version (SIMD_FAST_FUNCTIONS of
 * base/simd_operations.h). A call counts where messages would place it: inside a function of the
 * shader at the call there, however often the function is inlined; inside a standard function
 * (specular() takes a power) at the shader's call of that. What a macro stands for is where the
 * macro is used. */

/* A place whose calls are to be fast. */
struct shader_fast_call {
    const char *file; /* included, as messages name it; NULL: that of the shader itself */
    int line, column;
};

/* Which calls of one shader are to be fast. */
struct shader_fast_calls {
    const struct shader_fast_call *list;
    int count;
    bool all;
};

/* A function called at a place. One place may have several: rotate() takes a sine and a cosine. */
struct shader_call_site {
    int kind;         /* enum shader_kind of the shader it is in, of several compiled into one */
    const char *file; /* as messages name it */
    bool is_included; /* the file is not that of the shader itself */
    int line, column;
    int function;     /* enum simd_operation, the exact one */
    int instructions; /* once functions are inlined and passes have run */
    int issued;       /* of those to the array; the others are uniform and cost it nothing */
    bool is_fast;
};

/* "sin": the name of the function. */
const char *shader_call_function(const struct shader_call_site *site);

#endif
