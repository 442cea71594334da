/* SPDX-License-Identifier: Apache-2.0 */
#include "images/exr_error.h"

#include <stdio.h>
#include <string.h>

static _Thread_local char exr_error_kept[512];

void exr_error_keep(exr_const_context_t context, exr_result_t code, const char *message) {
    if (!exr_error_kept[0] && message)
        snprintf(exr_error_kept, sizeof exr_error_kept, "%s", message);
}

void exr_error_forget(void) {
    exr_error_kept[0] = 0;
}

const char *exr_error_text(exr_result_t code) {
    return exr_error_kept[0] ? exr_error_kept : exr_get_default_error_message(code);
}
