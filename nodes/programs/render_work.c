/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/render_report.h"

#include <inttypes.h>
#include <stdlib.h>

enum { NAMES_SHOWN_MAX = 12 };

static double share(uint64_t part, uint64_t whole) {
    return whole ? 100.0 * (double)part / (double)whole : 0;
}

static bool is_light(const struct instance_work *work) {
    return work->instance > SHADING_WORK_SHARED;
}

static bool has_module(const struct instance_work *work) {
    return work->instance != SHADING_WORK_SHARED;
}

static uint32_t modules_largest(const struct work_record *work) {
    uint32_t most = 0;
    for (uint32_t i = 0; i < work->count; i++)
        if (has_module(&work->instances[i]) && work->instances[i].module > most)
            most = work->instances[i].module;
    return most;
}

/* Different modules among the entries that ran, or among all. */
static uint32_t count_modules(const struct work_record *work, bool only_run) {
    bool *seen = memory_get((size_t)modules_largest(work) + 1, sizeof *seen);
    uint32_t count = 0;
    for (uint32_t i = 0; i < work->count; i++) {
        const struct instance_work *entry = &work->instances[i];
        if (!has_module(entry) || (only_run && !entry->regions) || seen[entry->module])
            continue;
        seen[entry->module] = true;
        count++;
    }
    free(seen);
    return count;
}

uint32_t render_modules_loaded(const struct work_record *work) {
    return count_modules(work, true);
}

static void print_samples(FILE *stream, const struct frame_record *f) {
    const struct work_record *work = &f->work;
    uint64_t shaded = 0;
    for (uint32_t i = 0; i < work->count; i++)
        shaded += work->instances[i].samples;
    fprintf(stream, "\nWork of frame %d\n", f->number);
    fprintf(stream,
            "  samples  cast as rays %12" PRIu64 "   composed %12" PRIu64 "   shaded %12" PRIu64
            "\n",
            work->rays, work->composed, shaded);
}

static void print_entries(FILE *stream, const struct work_record *work) {
    uint64_t total[SHADER_STREAM_COUNT] = {0};
    fprintf(stream, "  %-28s %7s %10s %10s %10s %10s %10s %10s\n", "instructions issued for",
            "regions", "samples", "pre-illum", "illum", "post-illum", "light", "shared");
    for (uint32_t i = 0; i < work->count; i++) {
        const struct instance_work *entry = &work->instances[i];
        for (int s = 0; s < SHADER_STREAM_COUNT; s++)
            total[s] += entry->streams[s];
        if (entry->regions)
            fprintf(stream,
                    "    %-26s %7u %10" PRIu64 " %10" PRIu64 " %10" PRIu64 " %10" PRIu64
                    " %10" PRIu64 " %10" PRIu64 "\n",
                    has_module(entry) ? entry->name : "(positions)", entry->regions, entry->samples,
                    entry->streams[SHADER_PRE_ILLUM], entry->streams[SHADER_ILLUM],
                    entry->streams[SHADER_POST_ILLUM], entry->streams[SHADER_LIGHT],
                    entry->streams[SHADER_SHARED]);
    }
    fprintf(stream,
            "    %-26s %7s %10s %10" PRIu64 " %10" PRIu64 " %10" PRIu64 " %10" PRIu64 " %10" PRIu64
            "\n",
            "all", "", "", total[SHADER_PRE_ILLUM], total[SHADER_ILLUM], total[SHADER_POST_ILLUM],
            total[SHADER_LIGHT], total[SHADER_SHARED]);
}

/* What kinds of operations the frame needed: those that are not listed were not issued. */
static void print_operations(FILE *stream, const struct work_record *work) {
    static const char *const names[SIMD_OPERATION_COUNT] = {
#define OPERATION_NAME(name, key, what) key,
        SIMD_OPERATIONS(OPERATION_NAME)
#undef OPERATION_NAME
    };
    int shown = 0;
    fprintf(stream, "  operations ");
    for (int o = 0; o < SIMD_OPERATION_COUNT; o++) {
        uint64_t issued = 0;
        for (uint32_t i = 0; i < work->count; i++)
            issued += work->instances[i].operations[o];
        if (issued)
            fprintf(stream, "%s %s:%" PRIu64, shown++ % 6 || shown == 1 ? "" : "\n            ",
                    names[o], issued);
    }
    fprintf(stream, shown ? "\n" : " none\n");
}

static void print_idle(FILE *stream, const struct work_record *work, bool lights, const char *what,
                       const char *why) {
    uint32_t idle = 0, all = 0;
    for (uint32_t i = 0; i < work->count; i++) {
        const struct instance_work *entry = &work->instances[i];
        if (!has_module(entry) || is_light(entry) != lights)
            continue;
        all++;
        idle += !entry->regions;
    }
    if (!idle)
        return;
    fprintf(stream, "    %u of %u %s: %s:", idle, all, what, why);
    uint32_t shown = 0;
    for (uint32_t i = 0; i < work->count && shown < NAMES_SHOWN_MAX; i++)
        if (has_module(&work->instances[i]) && is_light(&work->instances[i]) == lights &&
            !work->instances[i].regions && ++shown)
            fprintf(stream, " %s", work->instances[i].name);
    fprintf(stream, idle > shown ? " ...\n" : "\n");
}

static void print_skipped(FILE *stream, const struct frame_record *f) {
    const struct work_record *work = &f->work;
    const uint32_t run = count_modules(work, true), all = count_modules(work, false);
    fprintf(stream, "  skipped\n");
    if (f->regions > work->regions_touched)
        fprintf(stream,
                "    %u of %u regions: no triangle touches them, so that they cost one word of the "
                "composition network\n",
                f->regions - work->regions_touched, f->regions);
    if (work->regions_touched > f->regions_covered)
        fprintf(stream, "    shading of %u more regions: no triangle covers a sample of them\n",
                work->regions_touched - f->regions_covered);
    print_idle(stream, work, false, "instances", "cover no sample, so they are never made ready");
    print_idle(stream, work, true, "lights", "shine on nothing that is seen and asks for light");
    if (all > run)
        fprintf(stream,
                "    %u of %u shaders: none of their instances runs, so they are never "
                "loaded\n",
                all - run, all);
    if (work->rays < f->samples_total)
        fprintf(stream,
                "    rays: no more than %.1f %% of the samples got one: only tiles of 4 x 4 "
                "samples that a triangle's rectangle touches do\n",
                share(work->rays, f->samples_total));
}

void render_work_print(FILE *stream, const struct frame_record *record) {
    print_samples(stream, record);
    print_entries(stream, &record->work);
    print_operations(stream, &record->work);
    fprintf(stream, "  shaders loaded %u\n", count_modules(&record->work, true));
    print_skipped(stream, record);
}
