/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/json_output.h"
#include "nodes/programs/scale.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static struct scale_point *point_at(const struct scale_study *study, size_t rendering,
                                    size_t shading) {
    return &study->points[rendering * study->shading_count + shading];
}

/* Regions done in a second; for one scene in proportion to 1 / time. */
static double rate_of(const struct scale_point *point) {
    return point->time ? (double)point->regions * (double)point->ticks_per_s / (double)point->time
                       : 0;
}

void scale_compare(struct scale_study *study) {
    const double first = rate_of(&study->points[0]);
    for (size_t r = 0; r < study->rendering_count; r++) {
        const struct scale_point *fewest = point_at(study, r, 0);
        for (size_t s = 0; s < study->shading_count; s++) {
            struct scale_point *point = point_at(study, r, s);
            const double rate = rate_of(point);
            point->speed_up = first > 0 ? rate / first : 0;
            point->efficiency = rate_of(fewest) > 0 ? rate * fewest->shading_nodes /
                                                          (rate_of(fewest) * point->shading_nodes)
                                                    : 0;
        }
    }
}

uint32_t scale_crossover(const struct scale_study *study, size_t rendering) {
    for (size_t s = 0; s < study->shading_count; s++)
        if (point_at(study, rendering, s)->bound_by != TIMING_SHADING)
            return point_at(study, rendering, s)->shading_nodes;
    return 0;
}

static double frame_ms(const struct scale_study *study, const struct scale_point *point,
                       ticks time) {
    return 1e3 * (double)time / (double)point->ticks_per_s / study->frame_count;
}

void scale_print(FILE *stream, const struct scale_study *study) {
    fprintf(stream, "%s on %s, %s, %s scaling: times are of one frame, the mean of %u\n\n",
            study->scene, study->machine, study->strategy,
            study->is_weak ? "weak (the picture grows with the shading nodes)" : "strong",
            study->frame_count);
    fprintf(stream, "%9s %8s %14s %9s %11s  %-12s %11s %8s %8s  %14s %s\n", "rendering", "shading",
            "predicted ms", "speed-up", "efficiency", "bound by", "composition", "raster",
            "shading", "live ms", "wall s");
    for (size_t i = 0; i < study->rendering_count * study->shading_count; i++) {
        const struct scale_point *p = &study->points[i];
        fprintf(stream, "%9u %8u %14.6f %9.2f %9.1f %%  %-12s %9.1f %% %6.1f %% %6.1f %%",
                p->rendering_nodes, p->shading_nodes, frame_ms(study, p, p->time), p->speed_up,
                100 * p->efficiency, timing_resource_name(p->bound_by),
                100 * p->busy[TIMING_COMPOSITION], 100 * p->busy[TIMING_RASTER],
                100 * p->busy[TIMING_SHADING]);
        if (p->has_live)
            fprintf(stream, "  %14.6f %.2f%s", frame_ms(study, p, p->live_time), p->live_wall_s,
                    p->live_time == p->time ? "" : "  DIFFERS");
        fputc('\n', stream);
    }
    fputc('\n', stream);
    for (size_t r = 0; r < study->rendering_count; r++) {
        const uint32_t crossover = scale_crossover(study, r);
        const uint32_t nodes = point_at(study, r, 0)->rendering_nodes;
        if (crossover)
            fprintf(stream, "%u rendering nodes: shading does not bound from %u shading nodes on\n",
                    nodes, crossover);
        else
            fprintf(stream, "%u rendering nodes: shading bounds throughout\n", nodes);
    }
}

bool scale_write_csv(const char *path, const struct scale_study *study, struct status *status) {
    char *text;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    fprintf(stream, "scaling,strategy,rendering_nodes,shading_nodes,regions,time_ticks,ticks_per_s,"
                    "speed_up,efficiency,bound_by");
    for (int resource = 0; resource < TIMING_RESOURCE_COUNT; resource++)
        fprintf(stream, ",%s_share", timing_resource_name((enum timing_resource)resource));
    fprintf(stream, ",live_time_ticks,live_wall_s\n");
    for (size_t i = 0; i < study->rendering_count * study->shading_count; i++) {
        const struct scale_point *p = &study->points[i];
        fprintf(stream, "%s,%s,%u,%u,%" PRIu64 ",%" PRId64 ",%" PRIu64 ",%.6f,%.6f,%s",
                study->is_weak ? "weak" : "strong", study->strategy, p->rendering_nodes,
                p->shading_nodes, p->regions, p->time, p->ticks_per_s, p->speed_up, p->efficiency,
                timing_resource_name(p->bound_by));
        for (int resource = 0; resource < TIMING_RESOURCE_COUNT; resource++)
            fprintf(stream, ",%.6f", p->busy[resource]);
        if (p->has_live)
            fprintf(stream, ",%" PRId64 ",%.6f\n", p->live_time, p->live_wall_s);
        else
            fprintf(stream, ",,\n");
    }
    fclose(stream);
    const bool ok = text_write_file(path, text, "the CSV table", status);
    free(text);
    return ok;
}

bool scale_write_json(const char *path, const struct scale_study *study, struct status *status) {
    cJSON *document = cJSON_CreateObject();
    cJSON_AddStringToObject(document, "scene", study->scene);
    cJSON_AddStringToObject(document, "machine", study->machine);
    cJSON_AddStringToObject(document, "composition_strategy", study->strategy);
    cJSON_AddStringToObject(document, "scaling", study->is_weak ? "weak" : "strong");
    json_add_whole(document, "frames", study->frame_count);
    cJSON *points = cJSON_AddArrayToObject(document, "points");
    for (size_t i = 0; i < study->rendering_count * study->shading_count; i++) {
        const struct scale_point *p = &study->points[i];
        cJSON *point = cJSON_CreateObject();
        json_add_whole(point, "rendering_nodes", p->rendering_nodes);
        json_add_whole(point, "shading_nodes", p->shading_nodes);
        json_add_whole(point, "regions", (int64_t)p->regions);
        json_add_whole(point, "time_ps", ticks_to_ps((struct tick_rate){p->ticks_per_s}, p->time));
        json_add_whole(point, "time_ticks", p->time);
        json_add_whole(point, "ticks_per_s", (int64_t)p->ticks_per_s);
        cJSON_AddNumberToObject(point, "speed_up", p->speed_up);
        cJSON_AddNumberToObject(point, "efficiency", p->efficiency);
        cJSON_AddStringToObject(point, "bound_by", timing_resource_name(p->bound_by));
        cJSON *busy = cJSON_AddObjectToObject(point, "busy_share");
        for (int resource = 0; resource < TIMING_RESOURCE_COUNT; resource++)
            cJSON_AddNumberToObject(busy, timing_resource_name((enum timing_resource)resource),
                                    p->busy[resource]);
        if (p->has_live) {
            json_add_whole(point, "live_time_ticks", p->live_time);
            cJSON_AddNumberToObject(point, "live_wall_s", p->live_wall_s);
        }
        cJSON_AddItemToArray(points, point);
    }
    cJSON *crossovers = cJSON_AddArrayToObject(document, "crossovers");
    for (size_t r = 0; r < study->rendering_count; r++) {
        cJSON *crossover = cJSON_CreateObject();
        json_add_whole(crossover, "rendering_nodes", point_at(study, r, 0)->rendering_nodes);
        if (scale_crossover(study, r))
            json_add_whole(crossover, "shading_nodes", scale_crossover(study, r));
        else
            cJSON_AddNullToObject(crossover, "shading_nodes");
        cJSON_AddItemToArray(crossovers, crossover);
    }
    const bool ok = json_write_document(path, document, status);
    cJSON_Delete(document);
    return ok;
}

/* One block of the data file for each number of rendering nodes. */
static void print_data(FILE *stream, const struct scale_study *study) {
    fprintf(stream, "# shading nodes, speed-up, frame time in ms, live frame time in ms\n");
    for (size_t r = 0; r < study->rendering_count; r++) {
        fprintf(stream, "\"%u rendering\"\n", point_at(study, r, 0)->rendering_nodes);
        for (size_t s = 0; s < study->shading_count; s++) {
            const struct scale_point *p = point_at(study, r, s);
            fprintf(stream, "%u %.6f %.6f ", p->shading_nodes, p->speed_up,
                    frame_ms(study, p, p->time));
            if (p->has_live)
                fprintf(stream, "%.6f\n", frame_ms(study, p, p->live_time));
            else
                fprintf(stream, "?\n");
        }
        fprintf(stream, "\n\n");
    }
}

static bool has_live(const struct scale_study *study) {
    for (size_t i = 0; i < study->rendering_count * study->shading_count; i++)
        if (study->points[i].has_live)
            return true;
    return false;
}

static void print_script(FILE *stream, const char *prefix, const struct scale_study *study) {
    fprintf(stream,
            "set terminal svg size 900,420 font \"sans,12\" background \"white\"\n"
            "set output \"%s.svg\"\n"
            "set datafile missing \"?\"\n"
            "set multiplot layout 1,2\n"
            "set logscale xy 2\nset grid\nset key left top\nset xlabel \"shading nodes\"\n"
            "set ylabel \"speed-up (%s scaling)\"\n"
            "plot for [i=0:%zu] \"%s.dat\" index i using 1:2 with linespoints pointtype 7 "
            "pointsize 0.4 title columnheader(1)\n"
            "set key right top\nset ylabel \"frame time, ms\"\n"
            "plot for [i=0:%zu] \"%s.dat\" index i using 1:3 with lines linetype i+1 title "
            "columnheader(1)",
            prefix, study->is_weak ? "weak" : "strong", study->rendering_count - 1, prefix,
            study->rendering_count - 1, prefix);
    if (has_live(study))
        fprintf(stream,
                ", \\\n     for [i=0:%zu] \"%s.dat\" index i using 1:4 with points linetype i+1 "
                "pointtype 6 title i==0 ? \"run live\" : \"\"",
                study->rendering_count - 1, prefix);
    fprintf(stream, "\nunset multiplot\n");
}

static bool write_part(const char *prefix, const char *suffix, const struct scale_study *study,
                       struct status *status) {
    char path[4096], *text;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    if (!strcmp(suffix, "dat"))
        print_data(stream, study);
    else
        print_script(stream, prefix, study);
    fclose(stream);
    snprintf(path, sizeof path, "%s.%s", prefix, suffix);
    const bool ok = text_write_file(path, text, "the plot", status);
    free(text);
    return ok;
}

bool scale_plot(const char *prefix, const struct scale_study *study, bool *is_drawn,
                struct status *status) {
    char script[4096];
    *is_drawn = false;
    if (strpbrk(prefix, "\"\\\n") || strlen(prefix) > 4000)
        return status_fail(status, STATUS_INVALID, "the name of the plot cannot be quoted");
    if (!write_part(prefix, "dat", study, status) || !write_part(prefix, "gp", study, status))
        return false;
    snprintf(script, sizeof script, "%s.gp", prefix);
    fflush(NULL);
    const pid_t child = fork();
    if (!child) {
        execlp("gnuplot", "gnuplot", script, (char *)NULL);
        _exit(127);
    }
    int result = -1;
    *is_drawn = child > 0 && waitpid(child, &result, 0) == child && WIFEXITED(result) &&
                WEXITSTATUS(result) == 0;
    if (!*is_drawn && WIFEXITED(result) && WEXITSTATUS(result) != 127)
        return status_fail(status, STATUS_IO, "gnuplot could not draw %s", script);
    return true;
}
