/* SPDX-License-Identifier: Apache-2.0 */
#ifndef CALL_SITES_JSON_H
#define CALL_SITES_JSON_H

#include "shaders/compiler/shader_calls.h"

#include <cjson/cJSON.h>

/* Adds "function", "file" (of an included one only), "line", "column", "instructions", "issued",
 * "math" ("exact" or "fast"). */
void call_site_add_json(cJSON *object, const struct shader_call_site *site);

#endif
