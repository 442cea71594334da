/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CALL_SITES_H
#define CALL_SITES_H

#include "shaders/compiler/lower.h"

/* Which calls of mathematical functions take the fast version (shader_calls.h). */

struct call_site {
    struct shader_call_site about;
    int number;              /* among those of the program, in its order */
    struct call_site *below; /* in the bucket */
    struct call_site *next;
};

/* The site of a node being lowered, which is at its place already; NULL when its operation has no
 * fast version. */
struct call_site *call_site_of(struct lowering *l, const struct ir_node *node);
/* Once all is lowered: numbers the sites by their place, and reports those that the options ask for
 * and the shader does not have. */
void call_sites_finish(struct lowering *l);
/* Once the passes have run: counts instructions, and hands the list to the program. */
void call_sites_report(const struct ir_program *ir);

#endif
