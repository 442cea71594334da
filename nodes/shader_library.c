/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shader_library.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SOURCE_BYTES_MAX = 1 << 20, PATH_BYTES = 4096 };

struct library_entry {
    struct shader_variant variant; /* first: what callers see */
    char *key;                     /* variant_key */
    char *names[3];                /* of the shader, its displacement and its atmosphere, or NULL */
};

struct shader_library {
    char **folders;
    int folder_count;
    struct shader_precision precision;
    struct shader_compile_options base; /* shader_library_set_base */
    struct library_entry **entries;     /* pointers: variants must not move */
    size_t count, capacity;
    size_t warned_entry;
    int warned;
};

struct shader_library *shader_library_create(const char *const *folders, int folder_count,
                                             const struct shader_precision *precision) {
    struct shader_library *library = memory_get(1, sizeof *library);
    library->folders = memory_get((size_t)folder_count, sizeof *library->folders);
    for (int i = 0; i < folder_count; i++)
        library->folders[i] = memory_copy_string(folders[i]);
    library->folder_count = folder_count;
    library->precision = *precision;
    return library;
}

void shader_library_set_base(struct shader_library *library,
                             const struct shader_compile_options *base) {
    library->base = *base;
}

void shader_library_destroy(struct shader_library *library) {
    if (!library)
        return;
    for (int i = 0; i < library->folder_count; i++)
        free(library->folders[i]);
    for (size_t i = 0; i < library->count; i++) {
        shader_program_destroy((struct shader_program *)library->entries[i]->variant.program);
        free(library->entries[i]->key);
        for (int n = 0; n < 3; n++)
            free(library->entries[i]->names[n]);
        free(library->entries[i]);
    }
    free(library->folders);
    free(library->entries);
    free(library);
}

static FILE *open_named(const struct shader_library *library, const char *name,
                        char path[PATH_BYTES]) {
    const size_t length = strlen(name);
    const char *suffix = length > 3 && !strcmp(name + length - 3, ".sl") ? "" : ".sl";
    if (name[0] == '/') {
        snprintf(path, PATH_BYTES, "%s%s", name, suffix);
        return fopen(path, "rb");
    }
    for (int i = 0; i < library->folder_count; i++) {
        snprintf(path, PATH_BYTES, "%s/%s%s", library->folders[i], name, suffix);
        FILE *file = fopen(path, "rb");
        if (file)
            return file;
    }
    return NULL;
}

/* The file that the user names for this shader, the last when there are several; NULL: none. */
static const char *file_of(const struct shader_library *library, const char *name) {
    const size_t length = strlen(name);
    for (int i = library->precision.file_count - 1; i >= 0; i--) {
        const char *item = library->precision.files[i];
        if (!strncmp(item, name, length) && item[length] == '=')
            return item + length + 1;
    }
    return NULL;
}

/* The standard's names of its light shaders ("distantlight") also find ours ("distant"). */
static FILE *open_source(const struct shader_library *library, const char *name,
                         char path[PATH_BYTES]) {
    static const char suffix[] = "light";
    const char *given = file_of(library, name);
    if (given) {
        snprintf(path, PATH_BYTES, "%s", given);
        return fopen(path, "rb");
    }
    FILE *file = open_named(library, name, path);
    const size_t length = strlen(name), cut = sizeof suffix - 1;
    if (file || length <= cut || length >= PATH_BYTES - 8 || strcmp(name + length - cut, suffix))
        return file;
    char stem[PATH_BYTES - 8];
    snprintf(stem, sizeof stem, "%.*s", (int)(length - cut), name);
    return open_named(library, stem, path);
}

static bool not_found(const struct shader_library *library, const char *name,
                      const struct scene_location *at, struct status *status) {
    char folders[1024] = "";
    if (file_of(library, name))
        return status_fail(status, STATUS_NOT_FOUND,
                           "%s:%d:%d: error: cannot open %s, which shader \"%s\" is to be: %s",
                           at->file ? at->file : "scene", at->line, at->column,
                           file_of(library, name), name, strerror(errno));
    for (int i = 0; i < library->folder_count; i++) {
        size_t used = strlen(folders);
        snprintf(folders + used, sizeof folders - used, "%s%s", i ? ", " : "", library->folders[i]);
    }
    return status_fail(status, STATUS_NOT_FOUND,
                       "%s:%d:%d: error: there is no shader \"%s\" (looked for %s.sl in %s)",
                       at->file ? at->file : "scene", at->line, at->column, name, name, folders);
}

/* Files that the shader being compiled includes: looked for next to the shader, then in the
 * library's folders. */
struct included {
    const struct shader_library *library;
    const char *shader_path;
    char **texts; /* all read so far */
    size_t count, capacity;
};

static FILE *open_included(const struct included *included, const char *name) {
    char path[PATH_BYTES];
    const char *slash = strrchr(included->shader_path, '/');
    if (name[0] == '/')
        return fopen(name, "rb");
    snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash - included->shader_path) + 1 : 0,
             included->shader_path, name);
    FILE *file = fopen(path, "rb");
    for (int i = 0; i < included->library->folder_count && !file; i++) {
        snprintf(path, sizeof path, "%s/%s", included->library->folders[i], name);
        file = fopen(path, "rb");
    }
    return file;
}

/* shader_compile_options.read_include; one byte more than the limit is read so that the compiler
 * sees it exceeded. */
static const char *read_included(void *context, const char *name, size_t *length) {
    struct included *included = context;
    FILE *file = open_included(included, name);
    if (!file)
        return NULL;
    char *text = memory_get(SOURCE_BYTES_MAX + 2, 1);
    *length = fread(text, 1, SOURCE_BYTES_MAX + 1, file);
    const bool is_read = !ferror(file);
    fclose(file);
    included->texts = memory_grow(included->texts, &included->capacity, included->count + 1,
                                  sizeof *included->texts);
    included->texts[included->count++] = text;
    return is_read ? text : NULL;
}

/* A source as the compiler takes it. */
struct source_file {
    char path[PATH_BYTES];
    char *text; /* owned */
    size_t length;
};

static bool read_source(const struct shader_library *library, const char *name,
                        const struct scene_location *at, struct source_file *source,
                        struct status *status) {
    FILE *file = open_source(library, name, source->path);
    if (!file)
        return not_found(library, name, at, status);
    source->text = memory_get(SOURCE_BYTES_MAX + 2, 1);
    source->length = fread(source->text, 1, SOURCE_BYTES_MAX + 1, file);
    const bool is_read = !ferror(file);
    fclose(file);
    return is_read ||
           status_fail(status, STATUS_IO, "cannot read %s: %s", source->path, strerror(errno));
}

static bool is_fast_shader(const struct shader_library *library, const char *name) {
    const size_t length = strlen(name);
    for (const char *at = library->precision.fast_shaders; at && *at;) {
        const size_t item = strcspn(at, ",");
        if (item == length && !strncmp(at, name, length))
            return true;
        at += item + (at[item] == ',');
    }
    return false;
}

static struct shader_fast_calls fast_calls(const struct shader_library *library, const char *name) {
    struct shader_fast_calls calls = fast_calls_of(&library->precision.fast_calls, name);
    calls.all = name && is_fast_shader(library, name);
    return calls;
}

static bool compile_sources(struct shader_library *library, const struct shader_wanted *wanted,
                            const struct shader_compile_options *extra, const char *const *material,
                            struct source_file sources[3], struct shader_program **program,
                            struct status *status) {
    struct included included = {.library = library, .shader_path = sources[0].path};
    const bool is_light = wanted->kind == SHADER_KIND_LIGHT;
    const bool is_probed =
        library->precision.probed_shader && !strcmp(library->precision.probed_shader, wanted->name);
    const struct shader_companion before = {sources[1].path, sources[1].text, sources[1].length,
                                            fast_calls(library, wanted->displacement)},
                                  after = {sources[2].path, sources[2].text, sources[2].length,
                                           fast_calls(library, wanted->atmosphere)};
    const struct shader_compile_options options = {
        .displacement = wanted->displacement ? &before : NULL,
        .atmosphere = wanted->atmosphere ? &after : NULL,
        .material = material,
        .material_count = is_light ? 0 : wanted->material_count,
        .exports = material,
        .export_count = is_light ? wanted->material_count : 0,
        .fast_math = library->precision.fast_math,
        .fast_calls = fast_calls(library, wanted->name),
        .parameters = library->precision.parameters,
        .reference_math = library->precision.reference_math,
        .pixel_memory_bytes = library->base.pixel_memory_bytes,
        .allows_external = library->base.allows_external,
        .passes_left_out = library->base.passes_left_out,
        .dump = library->base.dump,
        .has_probes = extra ? extra->has_probes : is_probed,
        .writes_source = extra ? extra->writes_source
                               : library->base.writes_source && wanted->kind == SHADER_KIND_SURFACE,
        .fixings = extra ? extra->fixings : NULL,
        .fixing_count = extra ? extra->fixing_count : 0,
        .read_include = read_included,
        .read_include_context = &included};
    const bool ok = shader_compile(sources[0].path, sources[0].text, sources[0].length, &options,
                                   program, status);
    for (size_t i = 0; i < included.count; i++)
        free(included.texts[i]);
    free(included.texts);
    free((void *)options.fast_calls.list);
    free((void *)before.fast_calls.list);
    free((void *)after.fast_calls.list);
    return ok;
}

static bool compile(struct shader_library *library, const struct shader_wanted *wanted,
                    const struct shader_compile_options *extra, const char *const *material,
                    const struct scene_location *at, struct shader_program **program,
                    struct status *status) {
    const char *const names[3] = {wanted->name, wanted->displacement, wanted->atmosphere};
    struct source_file *sources = memory_get(3, sizeof *sources);
    bool ok = true;
    for (int i = 0; ok && i < 3; i++)
        ok = !names[i] || read_source(library, names[i], at, &sources[i], status);
    ok = ok && compile_sources(library, wanted, extra, material, sources, program, status);
    for (int i = 0; i < 3; i++)
        free(sources[i].text);
    free(sources);
    return ok;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The key of a variant: names of its shaders and sorted names of what is material. */
static char *variant_key(const struct shader_wanted *wanted, const char **material) {
    const char *const shaders[3] = {wanted->name, wanted->displacement ? wanted->displacement : "",
                                    wanted->atmosphere ? wanted->atmosphere : ""};
    const int count = wanted->material_count;
    size_t length = 1;
    qsort(material, (size_t)count, sizeof *material, compare_names);
    for (int i = 0; i < 3 + count; i++)
        length += strlen(i < 3 ? shaders[i] : material[i - 3]) + 1;
    char *key = memory_get(length, 1), *at = key;
    for (int i = 0; i < 3 + count; i++) {
        at = stpcpy(at, i < 3 ? shaders[i] : material[i - 3]);
        *at++ = '\n';
    }
    return key;
}

static bool check_kind(const struct shader_program *program, const char *name,
                       enum shader_kind kind, const struct scene_location *at,
                       struct status *status) {
    if (program->kind == kind)
        return true;
    return status_fail(status, STATUS_INVALID,
                       "%s:%d:%d: error: \"%s\" is a %s shader, a %s shader is needed here",
                       at->file ? at->file : "scene", at->line, at->column, name,
                       shader_kind_name(program->kind), shader_kind_name(kind));
}

bool shader_library_variant(struct shader_library *library, const struct shader_wanted *wanted,
                            const struct scene_location *asked_at,
                            const struct shader_variant **variant, struct status *status) {
    const char **sorted = memory_get((size_t)wanted->material_count, sizeof *sorted);
    if (wanted->material_count)
        memcpy(sorted, wanted->material, (size_t)wanted->material_count * sizeof *sorted);
    char *key = variant_key(wanted, sorted);
    struct library_entry *found = NULL;
    for (size_t i = 0; i < library->count && !found; i++)
        if (!strcmp(library->entries[i]->key, key))
            found = library->entries[i];
    bool ok = true;
    struct shader_program *program;
    if (!found && (ok = compile(library, wanted, NULL, sorted, asked_at, &program, status))) {
        found = memory_get(1, sizeof *found);
        const char *const names[3] = {wanted->name, wanted->displacement, wanted->atmosphere};
        for (int n = 0; n < 3; n++)
            found->names[n] = names[n] ? memory_copy_string(names[n]) : NULL;
        found->variant = (struct shader_variant){(uint32_t)library->count, found->names[0],
                                                 names[1] || names[2], program};
        found->key = key;
        key = NULL;
        library->entries = memory_grow(library->entries, &library->capacity, library->count + 1,
                                       sizeof *library->entries);
        library->entries[library->count++] = found;
    }
    free(key);
    free(sorted);
    if (!ok || !check_kind(found->variant.program, wanted->name, wanted->kind, asked_at, status))
        return false;
    *variant = &found->variant;
    return true;
}

bool shader_library_compile(struct shader_library *library, const struct shader_wanted *wanted,
                            const struct shader_compile_options *extra,
                            struct shader_program **program, struct status *status) {
    const struct scene_location nowhere = {.file = wanted->name, .line = 1, .column = 1};
    return compile(library, wanted, extra, wanted->material, &nowhere, program, status);
}

bool shader_library_has(const struct shader_library *library, const char *name) {
    for (size_t i = 0; i < library->count; i++)
        for (int n = 0; n < 3; n++)
            if (library->entries[i]->names[n] && !strcmp(library->entries[i]->names[n], name))
                return true;
    return false;
}

uint32_t shader_library_count(const struct shader_library *library) {
    return (uint32_t)library->count;
}

const struct shader_variant *shader_library_at(const struct shader_library *library,
                                               uint32_t number) {
    return &library->entries[number]->variant;
}

const char *shader_variant_site_shader(const struct shader_variant *variant,
                                       const struct shader_call_site *site) {
    const struct library_entry *entry = (const struct library_entry *)variant;
    if (site->kind == (int)variant->program->kind)
        return entry->names[0];
    return entry->names[site->kind == SHADER_KIND_DISPLACEMENT ? 1 : 2];
}

const char *shader_library_warning(struct shader_library *library) {
    for (; library->warned_entry < library->count; library->warned_entry++, library->warned = 0) {
        const struct shader_program *program =
            library->entries[library->warned_entry]->variant.program;
        if (library->warned < program->warning_count)
            return program->warnings[library->warned++];
    }
    return NULL;
}
