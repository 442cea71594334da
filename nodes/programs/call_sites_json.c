/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/call_sites_json.h"

#include "nodes/programs/json_output.h"

void call_site_add_json(cJSON *object, const struct shader_call_site *site) {
    cJSON_AddStringToObject(object, "function", shader_call_function(site));
    if (site->is_included)
        cJSON_AddStringToObject(object, "file", site->file);
    json_add_whole(object, "line", site->line);
    json_add_whole(object, "column", site->column);
    json_add_whole(object, "instructions", site->instructions);
    json_add_whole(object, "issued", site->issued);
    cJSON_AddStringToObject(object, "math", site->is_fast ? "fast" : "exact");
}
