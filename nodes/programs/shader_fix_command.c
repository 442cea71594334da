/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/programs/shader_command.h"

#include "nodes/programs/json_output.h"
#include "nodes/programs/program_process.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* sortlast shader --fix: the shader in fixed-point, as a file, a table and JSON. */

/* --- Progress. --- */

struct fix_progress {
    bool is_terminal, has_line;
};

static void show(void *context, enum shader_fix_stage stage, size_t done, size_t of) {
    static const char *const names[] = {[SHADER_FIX_LOOKING] = "looks at the scene",
                                        [SHADER_FIX_ROUNDING] = "rounds variables",
                                        [SHADER_FIX_CHOOSING] = "prices floats",
                                        [SHADER_FIX_CHECKING] = "renders the shader it wrote"};
    struct fix_progress *progress = context;
    if (!progress->is_terminal)
        return;
    fprintf(stderr, "\r\033[K%s: %zu of %zu", names[stage], done, of);
    fflush(stderr);
    progress->has_line = true;
}

/* --- What the file says. --- */

/* "wall_fixed" of "out/wall_fixed.sl", as a name of the language; NULL when it is none. */
static char *shader_name_of(const char *path) {
    const char *slash = strrchr(path, '/'), *begin = slash ? slash + 1 : path;
    const size_t length = strcspn(begin, ".");
    bool is_name = length > 0 && !isdigit((unsigned char)begin[0]);
    for (size_t i = 0; i < length; i++)
        is_name = is_name && (isalnum((unsigned char)begin[i]) || begin[i] == '_');
    if (!is_name)
        return NULL;
    char *name = memory_get(length + 1, 1);
    memcpy(name, begin, length);
    return name;
}

/* The shader under the name of its file, with a word about where it comes from. */
static char *file_text(const struct shader_fix_request *request,
                       const struct shader_fix_result *result, bool is_renamed) {
    char *text;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    char *name =
        is_renamed && strcmp(request->output, "-") ? shader_name_of(request->output) : NULL;
    const char *rest = strchr(result->source, '(');
    const char *path = request->fix.path, *slash = strrchr(path, '/');
    fprintf(stream,
            "/* %s with fixed-point variables, written by sortlast shader --fix: as small as was "
            "found to keep\n * the pictures of a scene within %.6g of those in double precision: "
            "their error is %.6g, that of\n * the original %.6g, %.3g %% of the pixels aside. "
            "Lines in comments are those of the original. */\n",
            slash ? slash + 1 : path, request->fix.max_error, result->error_after.bulk,
            result->error_before.bulk, 100 * request->fix.outliers);
    if (name && rest)
        fprintf(stream, "surface %s%s", name, rest);
    else
        fputs(result->source, stream);
    free(name);
    fclose(stream);
    return text;
}

static bool compiles(const char *text) {
    struct shader_program *program;
    struct status status = {0};
    const bool ok = shader_compile("(fixed-point)", text, strlen(text), NULL, &program, &status);
    if (ok)
        shader_program_destroy(program);
    return ok;
}

/* --- Table. --- */

static double microseconds(const struct machine *machine, ticks time) {
    return (double)ticks_to_ps(machine->rate, time) / 1e6;
}

static size_t count_fixed(const struct shader_fix_result *result) {
    size_t count = 0;
    for (size_t i = 0; i < result->variable_count; i++)
        count += result->variables[i].format.size > 0;
    return count;
}

static void print_costs(const struct shader_fix_request *request,
                        const struct shader_fix_result *result) {
    const struct machine *machine = &request->rendering.machine;
    const struct shader_fix_cost *before = &result->before, *after = &result->after;
    printf("%s: %zu of %zu varying variables in fixed-point, after %d renderings\n\n",
           request->fix.path, count_fixed(result), result->variable_count, result->renderings);
    printf("%-40s %12s %12s\n", "", "before", "after");
    printf("%-40s %12.2f %12.2f  %.2fx\n", "time per region, its own streams, us",
           microseconds(machine, before->time), microseconds(machine, after->time),
           (double)before->time / (double)(after->time ? after->time : 1));
    printf("%-40s %12d %12d\n", "pixel memory allocated, bytes", before->allocated_bytes,
           after->allocated_bytes);
    if (before->spilled_bytes || after->spilled_bytes)
        printf("%-40s %12d %12d\n", "spilled to texture memory, bytes", before->spilled_bytes,
               after->spilled_bytes);
    const struct shader_fix_error *first = &result->error_before, *last = &result->error_after;
    printf("%-40s %12.2g %12.2g  at most %.2g\n", "error against double precision", first->bulk,
           last->bulk, request->fix.max_error);
    printf("%-40s %12" PRIu64 " %12" PRIu64 "  of %" PRIu64 ", at most %.3g %%\n\n",
           "pixels beyond that (decided otherwise)", first->pixels_beyond, last->pixels_beyond,
           last->pixels, 100 * request->fix.outliers);
}

static void print_variables(const struct shader_fix_result *result) {
    char name[32];
    printf("%5s  %-18s %11s %11s  %s\n", "line", "variable", "lowest", "highest", "type");
    for (size_t i = 0; i < result->variable_count; i++) {
        const struct shader_fix_variable *v = &result->variables[i];
        if (!v->name[0])
            continue;
        printf("%5d  %-18.18s %11.4g %11.4g  %s\n", v->line, v->name, (double)v->lowest,
               (double)v->highest, v->format.size ? fixed_format_name(v->format, name) : "float");
    }
    puts("");
}

/* --- JSON. --- */

static cJSON *cost_json(const struct machine *machine, const struct shader_fix_cost *cost,
                        const struct shader_fix_error *error) {
    cJSON *json = cJSON_CreateObject();
    json_add_whole(json, "time_per_region_ps", ticks_to_ps(machine->rate, cost->time));
    json_add_whole(json, "allocated_bytes", cost->allocated_bytes);
    json_add_whole(json, "spilled_bytes", cost->spilled_bytes);
    cJSON_AddNumberToObject(json, "error", error->bulk);
    cJSON_AddNumberToObject(json, "max_error", error->largest);
    json_add_whole(json, "pixels_beyond", (int64_t)error->pixels_beyond);
    return json;
}

static bool write_json(const struct shader_fix_request *request,
                       const struct shader_fix_result *result, struct status *status) {
    const struct machine *machine = &request->rendering.machine;
    char name[32];
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "shader", request->fix.path);
    cJSON_AddStringToObject(json, "scene", request->rendering.scene);
    cJSON_AddNumberToObject(json, "max_error", request->fix.max_error);
    cJSON_AddNumberToObject(json, "outliers", request->fix.outliers);
    json_add_whole(json, "renderings", result->renderings);
    cJSON_AddItemToObject(json, "before",
                          cost_json(machine, &result->before, &result->error_before));
    cJSON_AddItemToObject(json, "after", cost_json(machine, &result->after, &result->error_after));
    cJSON *variables = cJSON_AddArrayToObject(json, "variables");
    for (size_t i = 0; i < result->variable_count; i++) {
        const struct shader_fix_variable *v = &result->variables[i];
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", v->name);
        cJSON_AddNumberToObject(item, "line", v->line);
        cJSON_AddNumberToObject(item, "lowest", (double)v->lowest);
        cJSON_AddNumberToObject(item, "highest", (double)v->highest);
        cJSON_AddStringToObject(item, "type",
                                v->format.size ? fixed_format_name(v->format, name) : "float");
        cJSON_AddItemToArray(variables, item);
    }
    const bool ok = json_write_document(request->json, json, status);
    cJSON_Delete(json);
    return ok;
}

bool shader_fix_command(struct shader_fix_request *request, struct status *status) {
    struct fix_progress progress = {.is_terminal = isatty(STDERR_FILENO)};
    struct shader_fix_result result;
    request->fix.rendering = &request->rendering;
    request->fix.stop = &program_stop;
    request->fix.progress = show;
    request->fix.progress_context = &progress;
    program_signals_install();
    bool ok = shader_fix(&request->fix, &result, status);
    if (progress.has_line)
        fputs("\r\033[K", stderr);
    if (!ok)
        return false;
    const bool is_quiet =
        !strcmp(request->output, "-") || (request->json && !strcmp(request->json, "-"));
    char *text = file_text(request, &result, true);
    if (!compiles(text)) { /* the file is called like a word of the language */
        free(text);
        text = file_text(request, &result, false);
    }
    ok = text_write_file(request->output, text, "the shader", status);
    free(text);
    if (ok && !is_quiet) {
        print_costs(request, &result);
        print_variables(&result);
        printf("wrote %s\n", request->output);
    }
    if (ok && request->json)
        ok = write_json(request, &result, status);
    shader_fix_result_finish(&result);
    return ok;
}
