/* SPDX-License-Identifier: Apache-2.0 */
#ifndef TRACE_COMMAND_H
#define TRACE_COMMAND_H

#include "netsim/what_if.h"

/* `sortlast trace`: the timeline of a run, as a Trace Event file for Perfetto and chrome://tracing
 * or as a Gantt chart in SVG. Returns the exit status. */
int trace_main(int argc, char **argv);

struct trace_view {
    const struct run_record *record;
    const struct what_if *question;
    const struct timeline *timeline;
    int64_t time_ps; /* of a frame, on average */
};
/* The whole files as text; the caller's. NULL without memory. */
char *trace_events(const struct trace_view *view);
char *trace_svg(const struct trace_view *view);

/* "rendering node 3", "composition network": the name of a resource of the timeline. */
const char *trace_resource_name(const struct trace_view *view, uint32_t resource, char text[40]);

#endif
