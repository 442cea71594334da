/* SPDX-License-Identifier: Apache-2.0 */
#include "program_bundle.h"

#include "compiled_object.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Generated C is a preamble, then functions and tables of its own, whose names get a number each.
 * The preamble of a shader that asks for more begins with that of one that asks for less. */
static const char *const own_names[] = {"shader_prepare",    "shade_vector",  "shader_shade",
                                        "shader_light_run",  "shader_blocks", "shader_loaded",
                                        SHADER_MODULE_SYMBOL};

static size_t preamble_length(const char *text) {
    const char *first = strstr(text, "static void shader_prepare(");
    return first ? (size_t)(first - text) : 0;
}

static bool write_source(FILE *file, struct shader_program *const *programs, int count,
                         struct status *status) {
    const char *longest = programs[0]->c_source;
    for (int i = 1; i < count; i++)
        if (preamble_length(programs[i]->c_source) > preamble_length(longest))
            longest = programs[i]->c_source;
    fwrite(longest, 1, preamble_length(longest), file);
    for (int i = 0; i < count; i++) {
        const char *text = programs[i]->c_source;
        const size_t preamble = preamble_length(text);
        if (!preamble || memcmp(text, longest, preamble))
            return status_fail(status, STATUS_INTERNAL, "generated C starts in different ways");
        for (size_t n = 0; n < sizeof own_names / sizeof *own_names; n++)
            fprintf(file, "#undef %s\n#define %s %s_%d\n", own_names[n], own_names[n], own_names[n],
                    i);
        fwrite(text + preamble, 1, programs[i]->c_length - preamble, file);
    }
    fprintf(file,
            "#undef %s\nextern const struct shader_module *const bundled_modules[];\n"
            "const struct shader_module *const bundled_modules[] = {\n",
            SHADER_MODULE_SYMBOL);
    for (int i = 0; i < count; i++)
        fprintf(file, "    &%s_%d,\n", SHADER_MODULE_SYMBOL, i);
    fprintf(file, "};\n");
    return true;
}

static const char *flags_for(int width) {
    if (width == 8 && __builtin_cpu_supports("avx2"))
        return "-mavx2";
    bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    return width == 16 && has_avx512 ? "-mavx512f -mavx512dq -mavx512bw -mavx512vl" : "";
}

static const char *compiler_for(const char *wanted) {
    char command[64];
    snprintf(command, sizeof command, "command -v %s >/dev/null", wanted);
    return system(command) ? "cc" : wanted;
}

bool program_bundle_open(struct program_bundle *bundle, struct shader_program *const *programs,
                         int count, const struct bundle_settings *settings, struct status *status) {
    const char *optimisation = settings->optimisation;
    char *text = NULL, compiler[512];
    size_t length;
    *bundle = (struct program_bundle){0};
    FILE *file = open_memstream(&text, &length);
    bool ok = write_source(file, programs, count, status);
    fclose(file);
    snprintf(compiler, sizeof compiler,
             "%s -std=gnu11 %s%s -w -Wno-psabi -ffp-contract=off -fno-math-errno "
             "-fno-trapping-math %s -DSHADER_WIDTH=%d",
             compiler_for(settings->compiler), optimisation,
             /* without optimisation, calls are much quicker to compile than copies of the callee */
             strcmp(optimisation, "-O0") ? "" : " -Dalways_inline=noinline",
             flags_for(settings->width), settings->width);
    bundle->library = ok ? compiled_object_load(text, length, compiler, status) : NULL;
    bundle->modules = bundle->library ? dlsym(bundle->library, "bundled_modules") : NULL;
    free(text);
    if (bundle->library && !bundle->modules)
        status_fail(status, STATUS_INTERNAL, "%s", dlerror());
    return bundle->modules;
}

void program_bundle_close(struct program_bundle *bundle) {
    if (bundle->library)
        dlclose(bundle->library);
    *bundle = (struct program_bundle){0};
}
