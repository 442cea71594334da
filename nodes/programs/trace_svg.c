/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/trace_command.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* A Gantt chart: one row a resource, a bar an activity, the last frame's critical path as a line
 * above it all. Rows of many nodes are thinned to the first ones of each kind. */

enum {
    LEFT = 150,
    WIDTH = 1000, /* of the time axis */
    ROW = 16,
    TOP = 46,
    NODES_SHOWN_MAX = 24,
    TICKS_SHOWN = 10,
};

/* By kind of activity, hops last: distinguishable without colour vision (Okabe and Ito). */
static const char *const colours[TIMELINE_HOPS + 1] = {"#E69F00", "#56B4E9", "#0072B2",
                                                       "#009E73", "#CC79A7", "#999999"};

struct chart {
    const struct trace_view *view;
    FILE *out;
    ticks end;
};

static double x_of(const struct chart *chart, ticks time) {
    return LEFT + WIDTH * ((double)time / (double)chart->end);
}

/* The row of a resource, -1 when it is not shown. */
static int row_of(const struct trace_view *view, uint32_t resource) {
    const uint32_t r = view->question->rendering_nodes, s = view->question->shading_nodes;
    const uint32_t shown_r = r < NODES_SHOWN_MAX ? r : NODES_SHOWN_MAX,
                   shown_s = s < NODES_SHOWN_MAX ? s : NODES_SHOWN_MAX;
    if (resource == 0)
        return 1;
    if (resource <= r)
        return resource <= shown_r ? (int)(1 + resource) : -1;
    if (resource == 1 + r)
        return (int)(2 + shown_r);
    if (resource == 2 + r + s)
        return (int)(3 + shown_r + shown_s);
    return resource - 2 - r < shown_s ? (int)(3 + shown_r + resource - 2 - r) : -1;
}

static void put_bar(const struct chart *chart, int row, int kind, ticks begin, ticks end,
                    const char *title) {
    const double x = x_of(chart, begin), width = x_of(chart, end) - x;
    fprintf(chart->out,
            "<rect x=\"%.2f\" y=\"%d\" width=\"%.2f\" height=\"%d\" fill=\"%s\"><title>%s</title>"
            "</rect>\n",
            x, TOP + row * ROW + 2, width < 0.2 ? 0.2 : width, ROW - 4, colours[kind], title);
}

static void put_rows(const struct chart *chart) {
    char text[40];
    const uint32_t count = timeline_resource_count(chart->view->timeline);
    fprintf(chart->out, "<text x=\"%d\" y=\"%d\">critical path</text>\n", 4, TOP + ROW - 4);
    for (uint32_t resource = 0; resource < count; resource++) {
        const int row = row_of(chart->view, resource);
        if (row >= 0)
            fprintf(chart->out, "<text x=\"4\" y=\"%d\">%s</text>\n", TOP + (row + 1) * ROW - 4,
                    trace_resource_name(chart->view, resource, text));
    }
}

static void put_activities(const struct chart *chart) {
    size_t count;
    char title[160];
    const struct tick_rate rate = chart->view->question->machine.rate;
    const struct timeline_activity *all = timeline_activities(chart->view->timeline, &count);
    for (size_t a = 0; a < count; a++) {
        const int row =
            row_of(chart->view, timeline_resource_of(chart->view->timeline,
                                                     (enum timeline_kind)all[a].kind, all[a].node));
        if (row < 0)
            continue;
        snprintf(title, sizeof title,
                 "%s, frame %d, region %u: %.6f ms from %.6f ms, waited for %s",
                 timeline_kind_name(all[a].kind), chart->view->record->frames[all[a].frame].number,
                 all[a].region, 1e3 * ticks_to_s(rate, all[a].end - all[a].begin),
                 1e3 * ticks_to_s(rate, all[a].begin),
                 timeline_wait_name((enum timeline_wait)all[a].wait));
        put_bar(chart, row, all[a].kind, all[a].begin, all[a].end, title);
    }
}

static void put_paths(const struct chart *chart) {
    uint32_t frames;
    char title[96];
    timeline_frames(chart->view->timeline, &frames);
    for (uint32_t f = 0; f < frames; f++) {
        size_t count;
        struct timeline_step *steps = timeline_critical_path(chart->view->timeline, f, &count);
        for (size_t i = 0; i < count; i++) {
            if (steps[i].end <= steps[i].begin)
                continue;
            snprintf(title, sizeof title, "%s, node %u, region %u",
                     timeline_kind_name(steps[i].kind), steps[i].node, steps[i].region);
            put_bar(chart, 0, steps[i].kind, steps[i].begin, steps[i].end, title);
        }
        free(steps);
    }
}

static void put_axis(const struct chart *chart, int height) {
    const struct tick_rate rate = chart->view->question->machine.rate;
    for (int i = 0; i <= TICKS_SHOWN; i++) {
        const double x = LEFT + (double)WIDTH * i / TICKS_SHOWN;
        fprintf(chart->out,
                "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#ddd\"/>"
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.3g ms</text>\n",
                x, TOP, x, height - 20, x, TOP - 6,
                1e3 * ticks_to_s(rate, chart->end) * i / TICKS_SHOWN);
    }
    for (int kind = 0; kind <= TIMELINE_HOPS; kind++)
        fprintf(chart->out,
                "<rect x=\"%d\" y=\"%d\" width=\"10\" height=\"10\" fill=\"%s\"/>"
                "<text x=\"%d\" y=\"%d\">%s</text>\n",
                LEFT + kind * 110, height - 14, colours[kind], LEFT + kind * 110 + 14, height - 5,
                timeline_kind_name(kind));
}

/* A scene's name may hold anything. */
static void put_escaped(FILE *out, const char *text) {
    for (; *text; text++)
        switch (*text) {
        case '<':
            fputs("&lt;", out);
            break;
        case '&':
            fputs("&amp;", out);
            break;
        default:
            fputc((unsigned char)*text < 0x20 ? ' ' : *text, out);
        }
}

char *trace_svg(const struct trace_view *view) {
    char *text = NULL;
    size_t length;
    uint32_t frames;
    FILE *out = open_memstream(&text, &length);
    if (!out)
        return NULL;
    const struct timeline_frame *windows = timeline_frames(view->timeline, &frames);
    struct chart chart = {view, out, frames ? windows[frames - 1].end : 1};
    chart.end = chart.end ? chart.end : 1;
    const int rows = row_of(view, timeline_resource_count(view->timeline) - 1) + 1,
              height = TOP + rows * ROW + 24;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"10\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"white\"/>\n<text x=\"4\" y=\"16\" font-size=\"13\">",
            LEFT + WIDTH + 30, height);
    put_escaped(out, view->record->scene);
    fputs(" on ", out);
    put_escaped(out, view->question->machine.name);
    fprintf(out, ": %u rendering + %u shading nodes, %.3f ms a frame</text>\n",
            view->question->rendering_nodes, view->question->shading_nodes,
            (double)view->time_ps * 1e-9);
    put_axis(&chart, height);
    put_rows(&chart);
    put_activities(&chart);
    put_paths(&chart);
    fputs("</svg>\n", out);
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}
