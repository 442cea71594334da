/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"

#include "images/replacement_file.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void json_add_whole(cJSON *object, const char *key, int64_t value) {
    char text[32];
    snprintf(text, sizeof text, "%" PRId64, value);
    cJSON_AddRawToObject(object, key, text);
}

void json_add_wholes(cJSON *object, const char *key, const int64_t *values, uint32_t count) {
    cJSON *array = cJSON_AddArrayToObject(object, key);
    for (uint32_t i = 0; i < count; i++) {
        char text[32];
        snprintf(text, sizeof text, "%" PRId64, values[i]);
        cJSON_AddItemToArray(array, cJSON_CreateRaw(text));
    }
}

bool text_write_file(const char *path, const char *text, const char *what, struct status *status) {
    struct replacement_file file;
    if (!strcmp(path, "-"))
        return (fputs(text, stdout) >= 0 && !fflush(stdout)) ||
               status_fail(status, STATUS_IO, "cannot write %s to standard output", what);
    if (!replacement_file_open(&file, path, status))
        return false;
    replacement_file_append(&file, text, strlen(text));
    return replacement_file_commit(&file, status); /* carries the cause of a failed write */
}

bool json_write_document(const char *path, const cJSON *document, struct status *status) {
    char *text = cJSON_Print(document);
    const size_t length = text ? strlen(text) : 0;
    char *line = text ? realloc(text, length + 2) : NULL;
    if (!line) {
        free(text);
        return status_fail(status, STATUS_LIMIT, "no memory for the JSON document");
    }
    memcpy(line + length, "\n", 2);
    const bool ok = text_write_file(path, line, "JSON", status);
    free(line);
    return ok;
}
