/* SPDX-License-Identifier: Apache-2.0 */
#ifndef FAST_CALLS_H
#define FAST_CALLS_H

#include "base/status.h"
#include "shaders/compiler/shader_calls.h"

/* Which calls of which shaders take the fast version of a function, as users write it. */

struct fast_call {
    const char *shader; /* as the scene names it */
    struct shader_fast_call call;
};

struct fast_calls {
    char *text; /* owned; the entries point into it */
    struct fast_call *list;
    int count;
};

/* Reads "SHADER:LINE:COLUMN,SHADER:FILE:LINE:COLUMN,..."; FILE is an included one. With `shader`,
 * which must outlive the result, all are in that one and items begin with LINE or FILE. `option` is
 * its name in messages. On success *calls is the caller's to finish. */
bool fast_calls_parse(const char *option, const char *text, const char *shader,
                      struct fast_calls *calls, struct status *status);
void fast_calls_finish(struct fast_calls *calls);

/* Those of one shader (NULL: none), in memory that the caller frees: result.list. */
struct shader_fast_calls fast_calls_of(const struct fast_calls *calls, const char *shader);

#endif
