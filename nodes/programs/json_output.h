/* SPDX-License-Identifier: Apache-2.0 */
#ifndef JSON_OUTPUT_H
#define JSON_OUTPUT_H

#include "base/status.h"

#include <cjson/cJSON.h>
#include <stdint.h>

/* Whole numbers go in as text: doubles would round those beyond 2^53. */
void json_add_whole(cJSON *object, const char *key, int64_t value);
void json_add_wholes(cJSON *object, const char *key, const int64_t *values, uint32_t count);
/* Writes text to a file that appears whole, or to standard output for "-". `what` names it in
 * messages. */
bool text_write_file(const char *path, const char *text, const char *what, struct status *status);
bool json_write_document(const char *path, const cJSON *document, struct status *status);

#endif
