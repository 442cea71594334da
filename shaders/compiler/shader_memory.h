/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SHADER_MEMORY_H
#define SHADER_MEMORY_H

#include <stdbool.h>

/* What a compiled shader takes of the 256 bytes of a pixel processor (PF section 6.3). All sizes
 * are bytes. */

/* One variable in pixel memory, from the instruction that first assigns it to the last that reads
 * it. Instructions are numbered in the order in which the array runs them: all of pre-illum, illum,
 * post-illum. */
struct shader_lifetime {
    const char *name; /* the user's, "" for a temporary */
    int line;         /* of the first assignment */
    int bytes;
    int first, last; /* instructions */
    int address;     /* in the shader's area; -1: in texture memory, brought in where it is used */
};

struct shader_memory {
    int total;   /* of all variables with a name, predefined ones in use and parameters included */
    int varying; /* of the varying ones among them */
    int allocated;  /* largest use at any time of the shader's own variables and temporaries, with
                       places shared by lifetime; parameters, position and lights not included */
    int retained;   /* allocated while the lights run: the high-water mark they must stay above */
    int parameters; /* the transfer map, shader ID included, and loaded bound parameters */
    int position;   /* rebuilt before shading; 0 when nobody asks */
    int communication; /* what the lights leave */
    int available;     /* of the pixel processor */
    int free;          /* available less parameters, position, communication and allocated */
    int spilled;       /* of variables that did not fit and are kept in texture memory */
    int instructions, illum_begin, illum_end; /* numbering of the lifetimes */
    const struct shader_lifetime *lifetimes;
    int lifetime_count;
};

#endif
