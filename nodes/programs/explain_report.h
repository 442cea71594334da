/* SPDX-License-Identifier: Apache-2.0 */
#ifndef EXPLAIN_REPORT_H
#define EXPLAIN_REPORT_H

#include "base/ticks.h"
#include "netsim/timeline.h"

#include <cjson/cJSON.h>
#include <stdio.h>

/* Where the time of frames went: the critical path and what every resource waited for. */
struct explanation {
    const struct timeline *timeline;
    struct tick_rate rate;
    uint32_t rendering_nodes, shading_nodes;
};

/* "rendering node 3", "composition network": the name of a resource of the timeline. */
const char *explain_resource_name(const struct explanation *explanation, uint32_t resource,
                                  char text[40]);
/* For people: the last frame. */
void explain_print(FILE *stream, const struct explanation *explanation);
/* Adds "critical_path" and "resources" to the JSON of a frame. */
void explain_add_json(cJSON *frame_object, const struct explanation *explanation, uint32_t frame);

#endif
