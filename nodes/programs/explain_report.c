/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/explain_report.h"

#include "nodes/programs/json_output.h"

#include <stdlib.h>

enum { STEPS_SHOWN_MAX = 40, NODES_SHOWN_MAX = 8 };

static double share(ticks part, ticks whole) {
    return whole ? 100 * (double)part / (double)whole : 0;
}

static double milliseconds(const struct explanation *explanation, ticks time) {
    return 1e3 * ticks_to_s(explanation->rate, time);
}

const char *explain_resource_name(const struct explanation *explanation, uint32_t resource,
                                  char text[40]) {
    const uint32_t r = explanation->rendering_nodes, s = explanation->shading_nodes;
    if (resource == 0)
        return "geometry network";
    if (resource == 1 + r)
        return "composition network";
    if (resource == 2 + r + s)
        return "framebuffer";
    if (resource <= r)
        snprintf(text, 40, "rendering node %u", resource - 1);
    else
        snprintf(text, 40, "shading node %u", resource - 2 - r);
    return text;
}

static void print_step(FILE *stream, const struct explanation *explanation,
                       const struct timeline_step *step, size_t repeats) {
    fprintf(stream, "    %12.6f ms  %-9s", milliseconds(explanation, step->end - step->begin),
            timeline_kind_name(step->kind));
    if (step->kind == TIMELINE_RASTER || step->kind == TIMELINE_SHADING)
        fprintf(stream, " node %u", step->node);
    if (repeats > 1)
        fprintf(stream, " %zu regions up to %u", repeats, step->region);
    else if (step->kind != TIMELINE_GEOMETRY)
        fprintf(stream, " region %u", step->region);
    fprintf(stream, step->kind == TIMELINE_HOPS ? " under way\n" : "\n");
}

/* Steps that follow one another on one resource are shown as one. */
static void print_path(FILE *stream, const struct explanation *explanation, uint32_t frame,
                       const struct timeline_frame *window) {
    size_t count, shown = 0;
    struct timeline_step *steps = timeline_critical_path(explanation->timeline, frame, &count);
    ticks total[TIMELINE_HOPS + 1] = {0};
    for (size_t i = 0; i < count; i++)
        total[steps[i].kind] += steps[i].end - steps[i].begin;
    fprintf(stream, "  critical path, share of the frame:");
    for (int kind = 0; kind <= TIMELINE_HOPS; kind++)
        if (total[kind])
            fprintf(stream, " %s %.1f %%", timeline_kind_name(kind),
                    share(total[kind], window->end - window->begin));
    fputc('\n', stream);
    for (size_t i = 0; i < count && shown < STEPS_SHOWN_MAX; shown++) {
        struct timeline_step step = steps[i];
        size_t repeats = 0;
        while (i < count && steps[i].kind == step.kind &&
               (step.kind == TIMELINE_TRANSFER || step.kind == TIMELINE_COLOURS ||
                steps[i].node == step.node)) {
            step.end = steps[i].end;
            step.region = steps[i].region;
            repeats++;
            i++;
        }
        print_step(stream, explanation, &step, repeats);
        if (shown == STEPS_SHOWN_MAX - 1 && i < count)
            fprintf(stream, "    ... and %zu more steps (all are in the JSON)\n", count - i);
    }
    free(steps);
}

static void print_use(FILE *stream, const char *name, const struct timeline_use *use,
                      const struct timeline_frame *window) {
    const ticks time = window->end - window->begin;
    fprintf(stream, "    %-20s %5.1f %%  ", name, share(use->busy, time));
    for (int wait = 0; wait < TIMELINE_WAIT_COUNT; wait++)
        if (use->idle[wait])
            fprintf(stream, " %s %.1f %%", timeline_wait_name((enum timeline_wait)wait),
                    share(use->idle[wait], time));
    fputc('\n', stream);
}

void explain_print(FILE *stream, const struct explanation *explanation) {
    uint32_t frames;
    char text[40];
    const struct timeline_frame *windows = timeline_frames(explanation->timeline, &frames);
    if (!frames)
        return;
    const struct timeline_frame *window = &windows[frames - 1];
    fprintf(stream, "\nWhere the last frame's %.3f ms went\n",
            milliseconds(explanation, window->end - window->begin));
    print_path(stream, explanation, frames - 1, window);
    struct timeline_use *uses = timeline_uses(explanation->timeline);
    const uint32_t resources = timeline_resource_count(explanation->timeline);
    const struct timeline_use *use = uses + (size_t)(frames - 1) * resources;
    fprintf(stream, "  busy, and idle waiting for:\n");
    uint32_t left_out = 0;
    for (uint32_t resource = 0; resource < resources; resource++) {
        const bool is_node =
            resource && resource != 1 + explanation->rendering_nodes && resource != resources - 1;
        const uint32_t number = resource <= explanation->rendering_nodes
                                    ? resource - 1
                                    : resource - 2 - explanation->rendering_nodes;
        if (is_node && number >= NODES_SHOWN_MAX)
            left_out++;
        else
            print_use(stream, explain_resource_name(explanation, resource, text), &use[resource],
                      window);
    }
    if (left_out)
        fprintf(stream, "    ... and %u more nodes (all are in the JSON)\n", left_out);
    free(uses);
}

static void add_path(cJSON *object, const struct explanation *explanation, uint32_t frame) {
    size_t count;
    struct timeline_step *steps = timeline_critical_path(explanation->timeline, frame, &count);
    cJSON *path = cJSON_AddArrayToObject(object, "critical_path");
    for (size_t i = 0; i < count; i++) {
        cJSON *step = cJSON_CreateObject();
        cJSON_AddStringToObject(step, "what", timeline_kind_name(steps[i].kind));
        json_add_whole(step, "node", steps[i].node);
        json_add_whole(step, "frame", steps[i].frame);
        json_add_whole(step, "region", steps[i].region);
        json_add_whole(step, "begin_ticks", steps[i].begin);
        json_add_whole(step, "duration_ticks", steps[i].end - steps[i].begin);
        json_add_whole(step, "begin_ps", ticks_to_ps(explanation->rate, steps[i].begin));
        cJSON_AddItemToArray(path, step);
    }
    free(steps);
}

void explain_add_json(cJSON *object, const struct explanation *explanation, uint32_t frame) {
    char text[40];
    add_path(object, explanation, frame);
    struct timeline_use *uses = timeline_uses(explanation->timeline);
    const uint32_t count = timeline_resource_count(explanation->timeline);
    cJSON *resources = cJSON_AddArrayToObject(object, "resources");
    for (uint32_t i = 0; i < count; i++) {
        const struct timeline_use *use = &uses[(size_t)frame * count + i];
        cJSON *resource = cJSON_CreateObject();
        cJSON_AddStringToObject(resource, "name", explain_resource_name(explanation, i, text));
        json_add_whole(resource, "busy_ticks", use->busy);
        cJSON *idle = cJSON_AddObjectToObject(resource, "idle_ticks");
        for (int wait = 0; wait < TIMELINE_WAIT_COUNT; wait++)
            if (use->idle[wait])
                json_add_whole(idle, timeline_wait_key((enum timeline_wait)wait), use->idle[wait]);
        cJSON_AddItemToArray(resources, resource);
    }
    free(uses);
}
