/* SPDX-License-Identifier: Apache-2.0 */
#include "images/replacement_file.h"
#include "nodes/programs/render_report.h"

#include <stdlib.h>

bool render_record_write(const char *path, const struct run_record *record, struct status *status) {
    struct replacement_file file;
    uint8_t *bytes;
    size_t length;
    if (!record_encode(record, &bytes, &length, status))
        return false;
    bool ok = replacement_file_open(&file, path, status);
    if (ok) {
        replacement_file_append(&file, bytes, length);
        ok = replacement_file_commit(&file, status);
    }
    free(bytes);
    return ok;
}
