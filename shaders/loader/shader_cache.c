/* SPDX-License-Identifier: Apache-2.0 */
#include "shaders/loader/shader_cache.h"

#include "base/hash.h"
#include "shaders/simd/runtime_text.h"

#include <ctype.h>
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum { PATH_BYTES = 4096, COMPILER_FLAGS_MAX = 32, COMPILE_DEADLINE_S = 120 };

/* How wide vectors are compiled, best first. Results are the same bits with each. */
static const struct vector_width {
    int lanes;
    const char *name;
    const char *flags[7];
} vector_widths[] = {
    {16,
     "16 lanes (AVX-512, byte permutes)",
     {"-mavx512f", "-mavx512dq", "-mavx512bw", "-mavx512vl", "-mavx512vbmi",
      "-mprefer-vector-width=512", NULL}},
    {16,
     "16 lanes (AVX-512)",
     {"-mavx512f", "-mavx512dq", "-mavx512bw", "-mavx512vl", "-mprefer-vector-width=512", NULL}},
    {8, "8 lanes (AVX2)", {"-mavx2", NULL}},
    {4, "4 lanes (SSE2)", {NULL}},
};
enum { WIDTH_AVX512_VBMI, WIDTH_AVX512, WIDTH_AVX2, WIDTH_SSE2, WIDTH_COUNT };

struct loaded_module {
    uint64_t key;
    const struct shader_module *module;
};

struct shader_cache {
    char directory[PATH_BYTES];
    char include[PATH_BYTES];
    const char *compiler;
    const struct vector_width *width;
    uint64_t salt; /* hash of runtime, compiler and flags */
    const volatile sig_atomic_t *stop;
    const char *link; /* file with extern "C" functions, NULL: none */
    void *linked;     /* the same, loaded; NULL: not yet */
    struct loaded_module *modules;
    size_t module_count, module_capacity;
};

static bool processor_has(int width) {
    __builtin_cpu_init();
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    switch (width) {
    case WIDTH_AVX512_VBMI:
        return avx512 && __builtin_cpu_supports("avx512vbmi");
    case WIDTH_AVX512:
        return avx512;
    case WIDTH_AVX2:
        return __builtin_cpu_supports("avx2");
    default:
        return true;
    }
}

/* The best the processor has, or the best of the number of lanes asked for. */
static const struct vector_width *choose_width(void) {
    const char *wanted = getenv("SORTLAST_VECTOR_WIDTH");
    for (int pass = wanted ? 0 : 1; pass < 2; pass++)
        for (int i = 0; i < WIDTH_COUNT; i++)
            if (processor_has(i) && (pass || atoi(wanted) == vector_widths[i].lanes))
                return &vector_widths[i];
    return &vector_widths[WIDTH_SSE2];
}

static bool make_folder(const char *path, struct status *status) {
    char partial[PATH_BYTES];
    for (const char *at = path + 1;; at++) {
        if (*at && *at != '/')
            continue;
        snprintf(partial, sizeof partial, "%.*s", (int)(at - path), path);
        if (mkdir(partial, 0700) && errno != EEXIST)
            return status_fail(
                status, STATUS_IO,
                "cannot make the shader cache %s: %s (set SORTLAST_CACHE to a folder that "
                "can be written)",
                partial, strerror(errno));
        if (!*at)
            return true;
    }
}

static bool find_directory(struct shader_cache *cache, struct status *status) {
    const char *own = getenv("SORTLAST_CACHE"), *xdg = getenv("XDG_CACHE_HOME"),
               *home = getenv("HOME");
    int length = own && *own   ? snprintf(cache->directory, PATH_BYTES, "%s", own)
                 : xdg && *xdg ? snprintf(cache->directory, PATH_BYTES, "%s/sortlast", xdg)
                 : home && *home
                     ? snprintf(cache->directory, PATH_BYTES, "%s/.cache/sortlast", home)
                     : snprintf(cache->directory, PATH_BYTES, "/tmp/sortlast-%u", getuid());
    if (length >= PATH_BYTES - 128)
        return status_fail(status, STATUS_INVALID, "the path of the shader cache is too long");
    if (!make_folder(cache->directory, status))
        return false;
    struct stat info;
    if (stat(cache->directory, &info) || !S_ISDIR(info.st_mode))
        return status_fail(status, STATUS_IO, "the shader cache %s is not a folder",
                           cache->directory);
    if (info.st_uid != getuid() || info.st_mode & 022)
        return status_fail(
            status, STATUS_IO,
            "the shader cache %s can be written by others, and code is loaded from it: "
            "make it yours alone (chmod 700) or set SORTLAST_CACHE",
            cache->directory);
    return true;
}

/* Writes a file under a temporary name and renames it. */
static bool write_whole(const char *path, const char *text, size_t length, struct status *status) {
    char temporary[PATH_BYTES + 32];
    snprintf(temporary, sizeof temporary, "%s.%d.tmp", path, (int)getpid());
    FILE *file = fopen(temporary, "wb");
    bool ok = file && fwrite(text, 1, length, file) == length;
    int cause = errno;
    if (file && fclose(file)) {
        ok = false;
        cause = errno;
    }
    if (ok && rename(temporary, path)) {
        ok = false;
        cause = errno;
    }
    if (!ok) {
        unlink(temporary);
        status_fail(status, STATUS_IO, "cannot write %s: %s", path, strerror(cause));
    }
    return ok;
}

static bool write_runtime(struct shader_cache *cache, struct status *status) {
    uint64_t content = SHADER_MODULE_ABI;
    for (int i = 0; i < runtime_file_count; i++)
        content = hash_bytes(runtime_files[i].text, runtime_files[i].length, content);
    snprintf(cache->include, PATH_BYTES, "%.*s/runtime-%016llx", PATH_BYTES - 64, cache->directory,
             (unsigned long long)content);
    cache->salt = content;
    if (mkdir(cache->include, 0700) && errno != EEXIST)
        return status_fail(status, STATUS_IO, "cannot make %s: %s", cache->include,
                           strerror(errno));
    for (int i = 0; i < runtime_file_count; i++) {
        char path[PATH_BYTES + 128];
        struct stat info;
        snprintf(path, sizeof path, "%s/%s", cache->include, runtime_files[i].name);
        if (stat(path, &info) == 0 && (size_t)info.st_size == runtime_files[i].length)
            continue;
        if (!write_whole(path, runtime_files[i].text, runtime_files[i].length, status))
            return false;
    }
    return true;
}

bool shader_cache_open(struct shader_cache **out, struct status *status) {
    struct shader_cache *cache = memory_get(1, sizeof *cache);
    const char *compiler = getenv("SORTLAST_CC");
    cache->compiler = compiler && *compiler ? compiler : "cc";
    cache->width = choose_width();
    if (!find_directory(cache, status) || !write_runtime(cache, status)) {
        shader_cache_close(cache);
        return false;
    }
    cache->salt =
        hash_string(cache->compiler, cache->salt + (uint64_t)(cache->width - vector_widths));
    *out = cache;
    return true;
}

void shader_cache_set_stop(struct shader_cache *cache, const volatile sig_atomic_t *stop) {
    cache->stop = stop;
}

void shader_cache_set_link(struct shader_cache *cache, const char *object) {
    cache->link = object;
}

void shader_cache_close(struct shader_cache *cache) {
    if (!cache)
        return;
    free(cache->modules);
    free(cache);
}

const char *shader_cache_vectors(const struct shader_cache *cache) {
    return cache->width->name;
}

/* One compilation: where its files are and who runs it. All but the object are in a folder of its
 * own, those of the compiler too, so that none is left however it ends. */
struct job {
    const struct shader_cache_source *source;
    char object[PATH_BYTES + 256], folder[PATH_BYTES + 320];
    char temporary[PATH_BYTES + 340], text[PATH_BYTES + 340], words[PATH_BYTES + 340];
    pid_t pid;
};

static uint64_t source_key(const struct shader_cache *cache,
                           const struct shader_cache_source *source) {
    return hash_string(source->text, cache->salt);
}

static void object_path(const struct shader_cache *cache, const struct shader_cache_source *source,
                        char *path, size_t size) {
    char name[48];
    size_t length = 0;
    for (const char *at = source->name; *at && length < sizeof name - 1; at++)
        name[length++] = isalnum((unsigned char)*at) ? *at : '_';
    name[length] = 0;
    snprintf(path, size, "%s/%s-%016llx.so", cache->directory, name,
             (unsigned long long)source_key(cache, source));
}

static void job_remove_files(const struct job *job) {
    DIR *folder = opendir(job->folder);
    for (const struct dirent *entry; folder && (entry = readdir(folder));)
        if (entry->d_name[0] != '.')
            unlinkat(dirfd(folder), entry->d_name, 0);
    if (folder)
        closedir(folder);
    rmdir(job->folder);
}

static bool job_make_files(struct job *job, struct status *status) {
    snprintf(job->folder, sizeof job->folder, "%s.%d.tmp", job->object, (int)getpid());
    snprintf(job->temporary, sizeof job->temporary, "%s/shader.so", job->folder);
    snprintf(job->text, sizeof job->text, "%s/shader.c", job->folder);
    snprintf(job->words, sizeof job->words, "%s/words.txt", job->folder);
    if (mkdir(job->folder, 0700) && errno != EEXIST)
        return status_fail(status, STATUS_IO, "cannot make the folder %s: %s", job->folder,
                           strerror(errno));
    if (write_whole(job->text, job->source->text, strlen(job->source->text), status))
        return true;
    job_remove_files(job);
    return false;
}

/* The environment, with the job's folder for temporary files; the caller frees [0] and the list. */
static char **job_environment(const struct job *job) {
    size_t count = 0, kept = 1;
    while (environ[count])
        count++;
    char **result = memory_get(count + 2, sizeof *result);
    result[0] = memory_get(strlen(job->folder) + 8, 1);
    sprintf(result[0], "TMPDIR=%s", job->folder);
    for (size_t i = 0; i < count; i++)
        if (strncmp(environ[i], "TMPDIR=", 7))
            result[kept++] = environ[i];
    return result;
}

static bool job_start(const struct shader_cache *cache, struct job *job, struct status *status) {
    const char *arguments[COMPILER_FLAGS_MAX];
    char include[PATH_BYTES + 8], width[32];
    int count = 0;
    if (!job_make_files(job, status))
        return false;
    snprintf(include, sizeof include, "-I%s", cache->include);
    snprintf(width, sizeof width, "-DSHADER_WIDTH=%d", cache->width->lanes);
    const char *const fixed[] = {cache->compiler,
                                 "-std=gnu11",
                                 "-O2",
                                 "-fno-math-errno",
                                 "-fno-trapping-math",
                                 "-ffp-contract=off",
                                 "-fPIC",
                                 "-shared",
                                 "-w",
                                 include,
                                 width};
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++)
        arguments[count++] = fixed[i];
    for (int i = 0; cache->width->flags[i]; i++)
        arguments[count++] = cache->width->flags[i];
    arguments[count++] = "-o";
    arguments[count++] = job->temporary;
    arguments[count++] = job->text;
    arguments[count] = NULL;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, job->words, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    /* a group of its own: signals to this process are not for the compiler, and it and what it
     * runs end together */
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    char **environment = job_environment(job);
    int error = posix_spawnp(&job->pid, cache->compiler, &actions, &attributes,
                             (char *const *)arguments, environment);
    free(environment[0]);
    free(environment);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (!error)
        return true;
    job->pid = 0;
    job_remove_files(job);
    return status_fail(status, STATUS_NOT_FOUND,
                       "cannot run the C compiler %s: %s (install gcc, or set SORTLAST_CC)",
                       cache->compiler, strerror(error));
}

/* Waits for one compilation, not forever; keeps the object when it is good. */
static bool job_finish(const struct shader_cache *cache, struct job *job, struct status *status) {
    int result = 0;
    enum { PAUSE_MS = 2, COMPILER_PATIENCE_MS = 1000 };
    const struct timespec pause = {0, PAUSE_MS * 1000000};
    struct timespec begin, now;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    pid_t ended;
    int asked_ms = -1; /* since it was asked to end */
    while ((ended = waitpid(job->pid, &result, WNOHANG)) == 0) {
        clock_gettime(CLOCK_MONOTONIC, &now);
        if (asked_ms < 0 &&
            (now.tv_sec - begin.tv_sec > COMPILE_DEADLINE_S || (cache->stop && *cache->stop))) {
            kill(-job->pid, SIGTERM);
            asked_ms = 0;
        }
        if (asked_ms >= 0 && (asked_ms += PAUSE_MS) == COMPILER_PATIENCE_MS)
            kill(-job->pid, SIGKILL);
        nanosleep(&pause, NULL);
    }
    job->pid = 0;
    bool ok = ended > 0 && WIFEXITED(result) && WEXITSTATUS(result) == 0;
    const bool is_stopped = cache->stop && *cache->stop; /* that is no failure to speak of */
    if (!ok && !is_stopped) {
        char words[1024] = "";
        FILE *file = fopen(job->words, "rb");
        size_t length = file ? fread(words, 1, sizeof words - 1, file) : 0;
        words[length] = 0;
        if (file)
            fclose(file);
        status_fail(status, STATUS_INTERNAL, "the C compiler %s failed on shader %s:\n%s",
                    cache->compiler, job->source->name,
                    length ? words
                           : "it was stopped, or could not write its result (is the disk full?)");
    } else if (ok && rename(job->temporary, job->object)) {
        ok = status_fail(status, STATUS_IO, "cannot write %s: %s", job->object, strerror(errno));
    }
    job_remove_files(job);
    return ok;
}

bool shader_cache_build(struct shader_cache *cache, const struct shader_cache_source *sources,
                        size_t count, size_t *compiled, struct status *status) {
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const size_t most = processors > 1 ? (size_t)processors : 1;
    struct job *jobs = memory_get(count, sizeof *jobs);
    size_t started = 0, finished = 0, made = 0;
    bool ok = true;
    while (finished < count) {
        while (ok && started < count && started - finished < most) {
            struct job *job = &jobs[started++];
            job->source = &sources[job - jobs];
            object_path(cache, job->source, job->object, sizeof job->object);
            bool is_under_way = false; /* two variants of a shader may come to the same C */
            for (const struct job *other = jobs; other < job && !is_under_way; other++)
                is_under_way = !strcmp(other->object, job->object);
            if (!is_under_way && access(job->object, R_OK))
                ok = job_start(cache, job, status);
        }
        if (finished == started)
            break;
        struct job *job = &jobs[finished++];
        if (!job->pid)
            continue;
        made++;
        struct status other = {0};
        if (!job_finish(cache, job, ok ? status : &other))
            ok = false;
    }
    free(jobs);
    if (compiled)
        *compiled = made;
    return ok;
}

static bool open_link(struct shader_cache *cache, const char *shader, struct status *status) {
    char path[PATH_MAX];
    if (cache->linked)
        return true;
    if (!cache->link)
        return status_fail(status, STATUS_INVALID,
                           "shader %s calls functions of an object of yours (extern \"C\"), which "
                           "the command line of this node must allow: --link FILE.so",
                           shader);
    if (!realpath(cache->link, path)) /* also so that it is not looked for among libraries */
        return status_fail(status, STATUS_NOT_FOUND, "cannot link %s: %s", cache->link,
                           strerror(errno));
    cache->linked = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    return cache->linked ||
           status_fail(status, STATUS_INVALID, "cannot link %s: %s", cache->link, dlerror());
}

/* Fills in the addresses of functions from outside. */
static bool link_module(struct shader_cache *cache, const char *shader,
                        const struct shader_module *module, struct status *status) {
    for (int i = 0; i < module->external_count; i++) {
        const struct shader_external *external = &module->externals[i];
        if (!open_link(cache, shader, status))
            return false;
        *external->address = dlsym(cache->linked, external->name);
        if (!*external->address)
            return status_fail(status, STATUS_NOT_FOUND,
                               "shader %s calls extern \"C\" %s(), which %s does not have", shader,
                               external->name, cache->link);
    }
    return true;
}

bool shader_cache_load(struct shader_cache *cache, struct shader_cache_source source,
                       const struct shader_module **module, struct status *status) {
    const uint64_t key = source_key(cache, &source);
    for (size_t i = 0; i < cache->module_count; i++)
        if (cache->modules[i].key == key) {
            *module = cache->modules[i].module;
            return true;
        }
    if (!shader_cache_build(cache, &source, 1, NULL, status))
        return false;
    char path[PATH_BYTES + 256];
    object_path(cache, &source, path, sizeof path);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) { /* damaged, perhaps by a full disk: make it anew, once */
        unlink(path);
        if (!shader_cache_build(cache, &source, 1, NULL, status))
            return false;
        library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    }
    const struct shader_module *found = library ? dlsym(library, SHADER_MODULE_SYMBOL) : NULL;
    if (!found)
        return status_fail(status, STATUS_IO, "cannot load shader %s: %s", source.name, dlerror());
    if (found->abi != SHADER_MODULE_ABI || found->width != (uint32_t)cache->width->lanes)
        return status_fail(status, STATUS_INTERNAL, "shader object %s is of another build", path);
    if (!link_module(cache, source.name, found, status))
        return false;
    cache->modules = memory_grow(cache->modules, &cache->module_capacity, cache->module_count + 1,
                                 sizeof *cache->modules);
    cache->modules[cache->module_count++] = (struct loaded_module){key, found};
    *module = found;
    return true;
}
