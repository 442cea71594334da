/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_ARENA_H
#define BASE_ARENA_H

#include <stdarg.h>
#include <stddef.h>

/* Memory that lives and dies together: syntax trees, IR, a parsed frame. */
struct arena {
    struct arena_block *blocks;
    size_t used_bytes;  /* handed out so far, for limits */
    size_t limit_bytes; /* 0: none; past it arena_get returns NULL */
};

void arena_init(struct arena *arena, size_t limit_bytes);
/* Zeroed, 16-byte aligned; NULL only past the limit. */
void *arena_get(struct arena *arena, size_t size_bytes);
char *arena_copy_string(struct arena *arena, const char *text, size_t length);
char *arena_format(struct arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void arena_finish(struct arena *arena);

#endif
