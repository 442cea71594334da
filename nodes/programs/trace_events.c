/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/trace_command.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The Trace Event format: complete events ("X") on one thread for each resource, counters ("C") for
 * region buffers in use, metadata ("M") for names and order. Times are microseconds; printed from
 * picoseconds as decimals, so they stay exact. */

enum { PROCESS_NETWORKS = 1, PROCESS_RENDERING, PROCESS_SHADING };

static void put_time(FILE *out, const struct trace_view *view, const char *key, ticks time) {
    const int64_t ps = ticks_to_ps(view->question->machine.rate, time);
    fprintf(out, "\"%s\":%" PRId64 ".%06" PRId64, key, ps / 1000000, ps % 1000000);
}

static int process_of(const struct timeline_activity *activity) {
    return activity->kind == TIMELINE_RASTER    ? PROCESS_RENDERING
           : activity->kind == TIMELINE_SHADING ? PROCESS_SHADING
                                                : PROCESS_NETWORKS;
}

static uint32_t thread_of(const struct timeline_activity *activity) {
    return process_of(activity) == PROCESS_NETWORKS ? 1 + (uint32_t)activity->kind
                                                    : 1 + activity->node;
}

static void put_name(FILE *out, const char *what, int process, uint32_t thread, const char *name) {
    fprintf(out,
            ",\n{\"ph\":\"M\",\"name\":\"%s\",\"pid\":%d,\"tid\":%u,\"args\":{\"name\":\"%s\"}}",
            what, process, thread, name);
}

static void put_names(FILE *out, const struct trace_view *view) {
    char text[40];
    const uint32_t r = view->question->rendering_nodes, s = view->question->shading_nodes;
    put_name(out, "process_name", PROCESS_NETWORKS, 0, "networks and framebuffer");
    put_name(out, "process_name", PROCESS_RENDERING, 0, "rendering nodes");
    put_name(out, "process_name", PROCESS_SHADING, 0, "shading nodes");
    put_name(out, "thread_name", PROCESS_NETWORKS, 1 + TIMELINE_GEOMETRY, "geometry network");
    put_name(out, "thread_name", PROCESS_NETWORKS, 1 + TIMELINE_TRANSFER, "composition network");
    put_name(out, "thread_name", PROCESS_NETWORKS, 1 + TIMELINE_COLOURS, "framebuffer");
    for (uint32_t i = 0; i < r; i++)
        put_name(out, "thread_name", PROCESS_RENDERING, 1 + i,
                 trace_resource_name(view, 1 + i, text));
    for (uint32_t j = 0; j < s; j++)
        put_name(out, "thread_name", PROCESS_SHADING, 1 + j,
                 trace_resource_name(view, 2 + r + j, text));
}

static void put_activity(FILE *out, const struct trace_view *view,
                         const struct timeline_activity *activity) {
    const char *kind = timeline_kind_name(activity->kind);
    if (activity->kind == TIMELINE_GEOMETRY)
        fprintf(out, ",\n{\"ph\":\"X\",\"name\":\"frame %d\",\"cat\":\"%s\",",
                view->record->frames[activity->frame].number, kind);
    else
        fprintf(out, ",\n{\"ph\":\"X\",\"name\":\"region %u\",\"cat\":\"%s\",", activity->region,
                kind);
    put_time(out, view, "ts", activity->begin);
    fputc(',', out);
    put_time(out, view, "dur", activity->end - activity->begin);
    fprintf(out, ",\"pid\":%d,\"tid\":%u,\"args\":{\"frame\":%d,\"waited_for\":\"%s\"}}",
            process_of(activity), thread_of(activity), view->record->frames[activity->frame].number,
            timeline_wait_name((enum timeline_wait)activity->wait));
}

/* A region holds a buffer of a rendering node from the begin of its raster until its transfer has
 * passed there, and one of its shading node from when the transfer gets there until its colours
 * have left. */
struct buffer_step {
    ticks at;
    int process;
    uint32_t node;
    int change;
};

static int compare_steps(const void *a, const void *b) {
    const struct buffer_step *x = a, *y = b;
    if (x->at != y->at)
        return x->at < y->at ? -1 : 1;
    return x->change - y->change;
}

static void put_buffers(FILE *out, const struct trace_view *view,
                        const struct timeline_activity *all, size_t count) {
    const struct machine *machine = &view->question->machine;
    const uint32_t r = view->question->rendering_nodes, s = view->question->shading_nodes;
    struct buffer_step *steps = memory_get(2 * count, sizeof *steps);
    int *in_use[2] = {memory_get(r, sizeof(int)), memory_get(s, sizeof(int))};
    size_t step_count = 0, raster_from = 0;
    const struct timeline_activity *transfer = NULL;
    for (size_t a = 0; a < count; a++) {
        if (all[a].kind == TIMELINE_TRANSFER) {
            transfer = &all[a];
            /* the rasters of a region come just before its transfer */
            for (size_t b = raster_from; b < a; b++) {
                if (all[b].kind != TIMELINE_RASTER)
                    continue;
                steps[step_count++] =
                    (struct buffer_step){all[b].begin, PROCESS_RENDERING, all[b].node, 1};
                steps[step_count++] = (struct buffer_step){
                    ticks_add(transfer->end, ticks_multiply(machine->composition_hop, all[b].node)),
                    PROCESS_RENDERING, all[b].node, -1};
            }
            raster_from = a + 1;
        } else if (all[a].kind == TIMELINE_COLOURS && transfer) {
            const uint32_t j = all[a].node;
            const ticks hop = machine->composition_hop;
            steps[step_count++] = (struct buffer_step){
                ticks_add(transfer->begin, ticks_multiply(hop, (int64_t)r + j)), PROCESS_SHADING, j,
                1};
            steps[step_count++] = (struct buffer_step){
                all[a].end - ticks_multiply(hop, (int64_t)s - j), PROCESS_SHADING, j, -1};
            raster_from = a + 1;
        }
    }
    qsort(steps, step_count, sizeof *steps, compare_steps);
    for (size_t i = 0; i < step_count; i++) {
        int *use = &in_use[steps[i].process == PROCESS_SHADING][steps[i].node];
        *use += steps[i].change;
        fprintf(out, ",\n{\"ph\":\"C\",\"name\":\"%s %u buffers\",\"pid\":%d,",
                steps[i].process == PROCESS_SHADING ? "shading node" : "rendering node",
                steps[i].node, steps[i].process);
        put_time(out, view, "ts", steps[i].at);
        fprintf(out, ",\"args\":{\"regions\":%d}}", *use);
    }
    free(steps);
    free(in_use[0]);
    free(in_use[1]);
}

char *trace_events(const struct trace_view *view) {
    char *text = NULL;
    size_t length, count;
    FILE *out = open_memstream(&text, &length);
    if (!out)
        return NULL;
    const struct timeline_activity *all = timeline_activities(view->timeline, &count);
    fprintf(
        out,
        "{\"displayTimeUnit\":\"ns\",\"otherData\":{\"machine\":\"simulated\","
        "\"ticks_per_s\":\"%" PRIu64 "\"},\"traceEvents\":[\n"
        "{\"ph\":\"M\",\"name\":\"trace\",\"pid\":0,\"tid\":0,\"args\":{\"name\":\"sortlast\"}}",
        view->question->machine.rate.per_s);
    put_names(out, view);
    for (size_t a = 0; a < count; a++)
        put_activity(out, view, &all[a]);
    put_buffers(out, view, all, count);
    fputs("\n]}\n", out);
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}
