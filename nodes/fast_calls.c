/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/fast_calls.h"

#include "base/arena.h"

#include <stdlib.h>
#include <string.h>

/* Cuts ":NUMBER" off the end of the item. */
static bool cut_number(char *item, int *number) {
    char *colon = strrchr(item, ':'), *digits = colon ? colon + 1 : item;
    const size_t length = strlen(digits);
    if (!length || length > 7 || strspn(digits, "0123456789") != length)
        return false;
    *number = atoi(digits);
    *(colon ? colon : item) = 0;
    return *number > 0;
}

static bool parse_item(char *item, const char *shader, struct fast_call *call) {
    *call = (struct fast_call){.shader = shader};
    if (!cut_number(item, &call->call.column) || !cut_number(item, &call->call.line))
        return false;
    if (!shader) {
        char *colon = strchr(item, ':');
        call->shader = item;
        item += strlen(item);
        if (colon) {
            *colon = 0;
            item = colon + 1;
            if (!*item)
                return false;
        }
        if (!call->shader[0])
            return false;
    }
    call->call.file = *item ? item : NULL;
    return true;
}

bool fast_calls_parse(const char *option, const char *text, const char *shader,
                      struct fast_calls *calls, struct status *status) {
    const size_t length = strlen(text);
    *calls = (struct fast_calls){.text = memory_copy_string(text)};
    calls->list = memory_get(length / 2 + 1, sizeof *calls->list);
    for (char *at = calls->text; at <= calls->text + length;) {
        const size_t size = strcspn(at, ",");
        const size_t place = (size_t)(at - calls->text);
        at[size] = 0;
        if (!parse_item(at, shader, &calls->list[calls->count])) {
            fast_calls_finish(calls);
            return status_fail(status, STATUS_INVALID,
                               "%s: \"%.*s\" is not %sLINE:COLUMN of a call (`sortlast shader` "
                               "lists them)",
                               option, (int)size, text + place, shader ? "" : "SHADER:");
        }
        calls->count++;
        at += size + 1;
    }
    return true;
}

void fast_calls_finish(struct fast_calls *calls) {
    free(calls->text);
    free(calls->list);
    *calls = (struct fast_calls){0};
}

struct shader_fast_calls fast_calls_of(const struct fast_calls *calls, const char *shader) {
    struct shader_fast_call *list = memory_get((size_t)calls->count, sizeof *list);
    int count = 0;
    for (int i = 0; shader && i < calls->count; i++)
        if (!strcmp(calls->list[i].shader, shader))
            list[count++] = calls->list[i].call;
    return (struct shader_fast_calls){.list = list, .count = count};
}
