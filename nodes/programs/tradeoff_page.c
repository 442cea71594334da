/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"
#include "nodes/programs/tradeoff.h"

#include <math.h>
#include <stdlib.h>

/* The page: a plot of all settings, and a table of those worth having. */

static void put_escaped(FILE *out, const char *text) {
    for (; *text; text++)
        *text == '<' ? fputs("&lt;", out) : *text == '&' ? fputs("&amp;", out) : fputc(*text, out);
}

/* Time against PSNR, both as they are; the frontier is joined. */
static void put_plot(FILE *out, const struct tradeoff_study *study) {
    enum { WIDTH = 760, HEIGHT = 380, EDGE = 50 };
    double longest = 1, low = 200, high = 0;
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        const double psnr = fmin(r->error.psnr_db, 200);
        longest = fmax(longest, (double)r->time_ps);
        low = fmin(low, psnr);
        high = fmax(high, psnr);
    }
    fprintf(out, "<svg width=\"%d\" height=\"%d\" font-size=\"12\">\n", WIDTH, HEIGHT);
    fprintf(out, "<text x=\"%d\" y=\"%d\">simulated time, 0 to %.3f ms</text>\n", WIDTH / 3,
            HEIGHT - 10, longest * 1e-9);
    fprintf(out, "<text x=\"5\" y=\"15\">PSNR, %.1f to %.1f dB</text>\n", low, high);
    fprintf(out,
            "<rect x=\"%d\" y=\"20\" width=\"%d\" height=\"%d\" fill=\"none\" "
            "stroke=\"#999\"/>\n",
            EDGE, WIDTH - EDGE - 10, HEIGHT - 70);
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        const double x = EDGE + (double)r->time_ps / longest * (WIDTH - EDGE - 20);
        const double y =
            30 + (high - fmin(r->error.psnr_db, 200)) / fmax(high - low, 1e-9) * (HEIGHT - 90);
        char text[512];
        tradeoff_describe(study, &r->setting, text, sizeof text);
        fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\"><title>", x, y,
                r->is_on_frontier ? 6 : 4,
                (int)i == study->chosen ? "#d40"
                : r->is_on_frontier     ? "#06c"
                                        : "#bbb");
        put_escaped(out, text);
        fprintf(out, "</title></circle>\n");
    }
    fprintf(out, "</svg>\n");
}

static void put_frames(FILE *out, const struct tradeoff_study *study) {
    char tuned[512], judged[512];
    if (!study->unseen.count)
        return;
    tradeoff_describe_frames(&study->tuned, tuned, sizeof tuned);
    tradeoff_describe_frames(&study->unseen, judged, sizeof judged);
    fprintf(out,
            "<p>Tuned on frame%s %s, judged on frame%s %s, which had no part in the search; of "
            "several the worst counts.</p>\n",
            study->tuned.count == 1 ? "" : "s", tuned, study->unseen.count == 1 ? "" : "s", judged);
}

bool tradeoff_write_page(const struct tradeoff_study *study, const char *path,
                         struct status *status) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    fprintf(out,
            "<!DOCTYPE html>\n<meta charset=\"utf-8\"><title>Speed for accuracy</title>\n<h1>");
    put_escaped(out, study->scene);
    fprintf(out, "</h1>\n<p>Blue: no other setting is both quicker and more accurate. Orange: "
                 "chosen. Errors are against the reference in double precision.</p>\n");
    put_frames(out, study);
    put_plot(out, study);
    fprintf(out,
            "<table cellpadding=\"4\">\n<tr><th>picture<th>setting<th>time, ms<th>shading, "
            "ms<th>bytes a sample<th>map, bytes<th>PSNR, dB<th>FLIP mean<th>largest "
            "error<th>wall, s%s\n",
            study->unseen.count ? "<th>judged: PSNR, dB<th>FLIP mean<th>largest error" : "");
    for (size_t i = 0; i < study->result_count; i++) {
        const struct tradeoff_result *r = &study->results[i];
        char setting[512];
        if (!r->is_on_frontier && (int)i != study->chosen)
            continue;
        tradeoff_describe(study, &r->setting, setting, sizeof setting);
        fprintf(out, "<tr%s><td><img src=\"%s\" width=\"160\" alt=\"\"><td>",
                (int)i == study->chosen ? " style=\"background:#fe8\"" : "", r->picture);
        put_escaped(out, setting);
        if (r->is_refused)
            fputs(" (within the limits on the frames tuned on only)", out);
        fprintf(out, "<td>%.3f<td>%.3f<td>%.2f<td>%lld<td>%.2f<td>%.5f<td>%.4f<td>%.2f\n",
                (double)r->time_ps * 1e-9, (double)r->shading_ps * 1e-9, r->bytes_per_sample,
                (long long)r->map_bytes, r->error.psnr_db, r->error.flip_mean, r->error.max_error,
                r->wall_s);
        if (r->is_judged)
            fprintf(out, "<td>%.2f<td>%.5f<td>%.4f\n", r->judged.psnr_db, r->judged.flip_mean,
                    r->judged.max_error);
    }
    fprintf(out, "</table>\n");
    const bool ok = !fclose(out) && text_write_file(path, text, "the page", status);
    free(text);
    return ok;
}
