/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/analysis_options.h"
#include "nodes/programs/host_run.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* Keeps the record of the run beyond the run, by way of a file's bytes. */
static bool keep_record(void *context, const struct host_report *report, struct status *status) {
    uint8_t *bytes;
    size_t length;
    if (!record_encode(report->record, &bytes, &length, status))
        return false;
    const bool ok = record_decode("record", bytes, length, context, status);
    free(bytes);
    return ok;
}

/* Of all values: chunks of so many triangles answer for each of them. */
static int64_t common_divisor(const struct analysis_axis *axis) {
    int64_t divisor = 0;
    for (size_t i = 0; i < axis->count; i++)
        for (int64_t value = axis->values[i]; value;) {
            const int64_t rest = divisor % value;
            divisor = value;
            value = rest;
        }
    return divisor;
}

static int record_scene(const struct analysis_options *options, struct run_record **record) {
    enum { OWN = 8 };
    char triangles[32];
    const char **arguments =
        memory_get((size_t)options->forwarded_count + OWN + 1, sizeof *arguments);
    int count = 0;
    arguments[count++] = "render";
    arguments[count++] = "--quiet";
    arguments[count++] = "--driver=in-process";
    for (size_t a = 0; a < options->axis_count; a++)
        if (options->axes[a].kind == ANALYSIS_MACHINE) {
            arguments[count++] = "--machine";
            arguments[count++] = options->axes[a].labels[0];
        } else if (options->axes[a].kind == ANALYSIS_CHUNK) {
            snprintf(triangles, sizeof triangles, "%" PRId64, common_divisor(&options->axes[a]));
            arguments[count++] = "--chunk-triangles";
            arguments[count++] = triangles;
        }
    for (int i = 0; i < options->forwarded_count; i++)
        arguments[count++] = options->forwarded[i];
    arguments[count++] = options->input;
    struct render_options render;
    int end = render_options_parse(count, (char **)arguments, false, &render);
    if (!end) {
        render.host.is_recorded = true;
        end = 1 + host_run_then(&render, keep_record, record);
    }
    render_options_finish(&render);
    free(arguments);
    return end - 1;
}

int analysis_record_obtain(const struct analysis_options *options, struct run_record **record) {
    struct status status = {0};
    *record = NULL;
    if (!record_is_file(options->input))
        return record_scene(options, record);
    if (options->forwarded_count)
        status_fail(&status, STATUS_INVALID,
                    "%s is for the run that records a scene, but %s is a record",
                    options->forwarded[0], options->input);
    else if (record_read_file(options->input, record, &status))
        return 0;
    fprintf(stderr, "sortlast: %s\n", status.message);
    return status_exit_code(status.code);
}

int analysis_main(const struct analysis_verb *verb, int argc, char **argv,
                  bool (*analyse)(const struct analysis_options *options,
                                  const struct run_record *record, struct status *status)) {
    struct analysis_options options;
    struct run_record *record;
    struct status status = {0};
    const int end = analysis_options_parse(verb, argc, argv, &options);
    int result = end ? end - 1 : analysis_record_obtain(&options, &record);
    if (!end && !result) {
        if (!analyse(&options, record, &status)) {
            fprintf(stderr, "sortlast: %s\n", status.message);
            result = status_exit_code(status.code);
        }
        record_destroy(record);
    }
    analysis_options_finish(&options);
    return result;
}
