/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/call_sites_json.h"
#include "nodes/programs/json_output.h"
#include "nodes/programs/shader_command.h"

/* Calls of functions that have a fast version: what each costs either way. */

/* Times per region that the array is issued the function for this site. */
static int64_t issued_count(const struct shader_report *report, int site) {
    const struct shader_program *program = report->program;
    uint64_t count = 0;
    for (int i = 0; i < program->line_cost_count; i++)
        if (program->line_costs[i].call_site == site)
            count += report->counts.block_executions[program->line_costs[i].block] *
                     program->line_costs[i].count;
    return (int64_t)count;
}

static int64_t price_ps(const struct shader_report *report, int operation, int64_t count) {
    return ticks_to_ps(report->machine->rate,
                       ticks_multiply(report->machine->operation[operation], count));
}

void shader_report_print_calls(FILE *stream, const struct shader_report *report) {
    const struct shader_program *program = report->program;
    if (!program->call_site_count)
        return;
    fprintf(stream, "\nCalls with a fast version, us %20s %10s\n", "exact", "fast");
    for (int i = 0; i < program->call_site_count; i++) {
        const struct shader_call_site *site = &program->call_sites[i];
        const int64_t count = issued_count(report, i);
        char place[256];
        snprintf(place, sizeof place, "%s%s%d:%d", site->is_included ? site->file : "",
                 site->is_included ? ":" : "", site->line, site->column);
        fprintf(stream, "  %-8s %-25s %10.2f %10.2f  %s%s\n", shader_call_function(site), place,
                (double)price_ps(report, site->function, count) / 1e6,
                (double)price_ps(report, simd_operation_fast(site->function), count) / 1e6,
                site->is_fast ? "fast" : "",
                !site->instructions ? " (constant, computed before or not needed)"
                : !site->issued     ? " (uniform: on the processor)"
                                    : "");
    }
}

cJSON *shader_report_calls_json(const struct shader_report *report) {
    const struct shader_program *program = report->program;
    cJSON *calls = cJSON_CreateArray();
    for (int i = 0; i < program->call_site_count; i++) {
        const struct shader_call_site *site = &program->call_sites[i];
        cJSON *call = cJSON_CreateObject();
        call_site_add_json(call, site);
        if (report->is_measured) {
            const int64_t count = issued_count(report, i);
            cJSON *times = cJSON_AddObjectToObject(call, "time_ps");
            json_add_whole(times, "exact", price_ps(report, site->function, count));
            json_add_whole(times, "fast",
                           price_ps(report, simd_operation_fast(site->function), count));
        }
        cJSON_AddItemToArray(calls, call);
    }
    return calls;
}
