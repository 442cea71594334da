/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/render_report.h"

#include <inttypes.h>

static int64_t longest(const int64_t *times, uint32_t count) {
    int64_t most = 0;
    for (uint32_t i = 0; i < count; i++)
        most = times[i] > most ? times[i] : most;
    return most;
}

static double mean(const int64_t *times, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += (double)times[i];
    return count ? sum / count : 0;
}

static double share(double part, double whole) {
    return whole > 0 ? 100 * part / whole : 0;
}

static void print_frames(FILE *stream, const struct host_report *report) {
    fprintf(stream, "\nSimulated time\n"
                    "  frame    time ms  frames/s  bound by     composition  geometry    raster   "
                    "shading  framebuffer\n");
    for (size_t i = 0; i < report->frame_count; i++) {
        const struct frame_record *f = &report->frames[i];
        const double time = (double)f->time_ps;
        fprintf(stream, "  %5d %10.3f %9.2f  %-12s %9.1f %% %7.1f %% %7.1f %% %7.1f %% %10.1f %%\n",
                f->number, time * 1e-9, time > 0 ? 1e12 / time : 0,
                timing_resource_name(f->bound_by), share((double)f->composition.busy_ps, time),
                share((double)f->geometry.busy_ps, time),
                share(mean(f->raster_busy_ps, f->rendering_nodes), time),
                share(mean(f->shading_busy_ps, f->shading_nodes), time),
                share((double)f->framebuffer.busy_ps, time));
    }
    fprintf(
        stream,
        "  (share of the frame time each is busy; raster and shading: mean over their nodes)\n");
}

static void print_busy(FILE *stream, const struct frame_record *f) {
    fprintf(stream, "\nBusy time of the last frame, ms\n");
    fprintf(stream, "  composition %10.3f   geometry %10.3f   framebuffer %10.3f\n",
            (double)f->composition.busy_ps * 1e-9, (double)f->geometry.busy_ps * 1e-9,
            (double)f->framebuffer.busy_ps * 1e-9);
    fprintf(stream, "  raster, longest of %u nodes %10.3f   shading, longest of %u nodes %10.3f\n",
            f->rendering_nodes, (double)longest(f->raster_busy_ps, f->rendering_nodes) * 1e-9,
            f->shading_nodes, (double)longest(f->shading_busy_ps, f->shading_nodes) * 1e-9);
}

static void print_bytes(FILE *stream, const struct frame_record *f) {
    const uint64_t composition = f->composition.total, geometry = f->geometry.total;
    fprintf(stream, "\nBytes of the last frame\n");
    fprintf(stream, "  composition %14" PRIu64 "   %u of %u regions, %" PRIu64 " samples covered\n",
            composition, f->regions_covered, f->regions, f->samples_covered);
    fprintf(stream, "    depth     %14" PRIu64 " %5.1f %%\n", f->composition.depth,
            share((double)f->composition.depth, (double)composition));
    fprintf(stream, "    shader ID %14" PRIu64 " %5.1f %%\n", f->composition.shader_id,
            share((double)f->composition.shader_id, (double)composition));
    fprintf(stream, "    parameters%14" PRIu64 " %5.1f %%\n", f->composition.parameters,
            share((double)f->composition.parameters, (double)composition));
    fprintf(stream, "    padding   %14" PRIu64 " %5.1f %%\n", f->composition.padding,
            share((double)f->composition.padding, (double)composition));
    fprintf(stream, "    sent      %14" PRIu64 "   by all rendering nodes together\n",
            f->composition.sent);
    static const char *const causes[CAUSE_COUNT] = {"primitives", "bound par.", "shaders",
                                                    "control"};
    fprintf(stream, "  geometry    %14" PRIu64 "\n", geometry);
    for (int cause = 0; cause < CAUSE_COUNT; cause++)
        fprintf(stream, "    %-10s%14" PRIu64 " %5.1f %%\n", causes[cause],
                f->geometry.bytes[cause],
                share((double)f->geometry.bytes[cause], (double)geometry));
    fprintf(stream, "  colours     %14" PRIu64 "\n", f->framebuffer.bytes);
}

static void print_instances(FILE *stream, const struct host_report *report) {
    enum { SHOWN_MAX = 24 };
    fprintf(
        stream,
        "\nShader instances              map bytes  bound bytes  parameters in the transfer map\n");
    for (size_t i = 0; i < report->instance_count && i < SHOWN_MAX; i++) {
        const struct instance_report *instance = &report->instances[i];
        fprintf(stream, "  %-28s %8u %12" PRIu64 " ", instance->name, instance->map_bytes,
                instance->bound_bytes);
        for (int p = 0; p < instance->parameter_count; p++)
            fprintf(stream, " %s:%u", instance->parameters[p].name, instance->parameters[p].bytes);
        fputc('\n', stream);
    }
    if (report->instance_count > SHOWN_MAX)
        fprintf(stream, "  ... and %zu more (all are in the JSON)\n",
                report->instance_count - SHOWN_MAX);
}

static void print_streams(FILE *stream, const struct host_report *report) {
    uint64_t generated = 0, reused = 0;
    for (size_t i = 0; i < report->frame_count; i++) {
        generated += report->frames[i].streams_generated;
        reused += report->frames[i].streams_reused;
    }
    fprintf(stream, "\nInstruction streams: %llu generated, %llu kept from the frame before\n",
            (unsigned long long)generated, (unsigned long long)reused);
}

static void print_pace(FILE *stream, const struct host_report *report,
                       const struct pace_report *pace) {
    fprintf(stream,
            "\nPaced at %g times the machine's speed\n"
            "  frame    wall s   times scale, ms   solved, ms   difference\n",
            pace->scale);
    for (size_t i = 0; i < report->frame_count; i++) {
        const double wall_s = (double)pace_frame_ns(pace, i) * 1e-9;
        const double solved_ms = (double)report->frames[i].time_ps * 1e-9;
        const double scaled_ms = 1000 * wall_s * pace->scale;
        fprintf(stream, "  %5d %9.3f %17.3f %12.3f %+10.2f %%\n", report->frames[i].number, wall_s,
                scaled_ms, solved_ms, share(scaled_ms - solved_ms, solved_ms));
    }
}

void render_summary_print(FILE *stream, const struct render_options *options,
                          const struct host_report *report, double wall_s,
                          const struct pace_report *pace) {
    const struct host_options *host = &options->host;
    fprintf(stream, "%s on %s: %u rendering + %u shading + 1 framebuffer node, %s\n", host->scene,
            host->machine.name, host->rendering_nodes, host->shading_nodes,
            options->driver == DRIVER_IN_PROCESS ? "all in one process" : "one process each");
    if (!report->frame_count)
        return;
    print_frames(stream, report);
    print_busy(stream, &report->frames[report->frame_count - 1]);
    print_bytes(stream, &report->frames[report->frame_count - 1]);
    print_streams(stream, report);
    print_instances(stream, report);
    for (size_t i = 0; i < report->frame_count; i++)
        if (report->frames[i].work.is_kept)
            render_work_print(stream, &report->frames[i]);
    if (pace->scale > 0)
        print_pace(stream, report, pace);
    for (size_t i = 0; i < report->frame_count; i++)
        if (report->frames[i].image_path[0])
            fprintf(stream, "%s%s", i ? " " : "\nPictures: ", report->frames[i].image_path);
    fprintf(stream, "\nWall time %.2f s for %zu frame%s\n", wall_s, report->frame_count,
            report->frame_count == 1 ? "" : "s");
}
