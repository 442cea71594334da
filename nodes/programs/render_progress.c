/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/render_report.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void render_progress_begin(struct render_progress *progress, const struct render_options *options) {
    *progress = (struct render_progress){
        .stream = stderr,
        .is_terminal = isatty(STDERR_FILENO),
        .is_quiet = options->verbosity<0, .is_verbose = options->verbosity> 0,
        .begin_s = now_s()};
}

double render_wall_s(const struct render_progress *progress) {
    return now_s() - progress->begin_s;
}

static void clear_line(struct render_progress *progress) {
    if (progress->has_line)
        fputs("\r\033[K", progress->stream);
    progress->has_line = false;
}

void render_progress_end(struct render_progress *progress) {
    clear_line(progress);
    fflush(progress->stream);
}

static void show_warning(void *context, const char *text) {
    struct render_progress *progress = context;
    clear_line(progress);
    if (!progress->is_quiet)
        fprintf(progress->stream, "%s\n", text);
}

static void show_compiled(void *context, size_t shaders, size_t compiled) {
    struct render_progress *progress = context;
    clear_line(progress);
    if (!progress->is_quiet && (compiled || progress->is_verbose))
        fprintf(progress->stream, "%zu shaders: %zu compiled, %zu from the cache (%.2f s)\n",
                shaders, compiled, shaders - compiled, render_wall_s(progress));
}

static void show_progress(void *context, int number, uint32_t done, uint32_t regions) {
    struct render_progress *progress = context;
    enum { BAR = 32 };
    if (progress->is_quiet || !progress->is_terminal || !regions)
        return;
    char bar[BAR + 1];
    const uint32_t filled = (uint32_t)((uint64_t)done * BAR / regions);
    memset(bar, '.', BAR);
    memset(bar, '#', filled < BAR ? filled : BAR);
    bar[BAR] = 0;
    fprintf(progress->stream, "\r\033[Kframe %d [%s] %u of %u regions, %.1f s", number, bar, done,
            regions, render_wall_s(progress));
    progress->has_line = true;
    fflush(progress->stream);
}

int64_t pace_frame_ns(const struct pace_report *pace, size_t index) {
    return pace->frame_done_ns[index] - (index ? pace->frame_done_ns[index - 1] : pace->begin_ns);
}

void render_progress_finish(struct render_progress *progress) {
    free(progress->frame_done_ns);
    progress->frame_done_ns = NULL;
}

static void note_frame(struct render_progress *progress) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    progress->frame_done_ns =
        memory_grow(progress->frame_done_ns, &progress->frame_capacity, progress->frame_count + 1,
                    sizeof *progress->frame_done_ns);
    progress->frame_done_ns[progress->frame_count++] =
        (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void show_frame(void *context, const struct frame_record *record) {
    struct render_progress *progress = context;
    note_frame(progress);
    clear_line(progress);
    if (progress->is_quiet)
        return;
    fprintf(progress->stream,
            "frame %d: %u of %u regions covered, simulated %.3f ms, bound by %s%s%s (%.2f s)\n",
            record->number, record->regions_covered, record->regions,
            (double)record->time_ps * 1e-9, timing_resource_name(record->bound_by),
            record->image_path[0] ? ", " : "", record->image_path, render_wall_s(progress));
    fflush(progress->stream);
}

struct host_observer render_progress_observer(struct render_progress *progress) {
    return (struct host_observer){progress, show_warning, show_compiled, show_progress, show_frame};
}
