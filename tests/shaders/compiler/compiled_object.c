/* SPDX-License-Identifier: Apache-2.0 */
#include "compiled_object.h"

#include "base/hash.h"
#include "shaders/simd/runtime_text.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_BYTES = 1024 };

/* What an object depends on: its C, the headers it includes, the compiler and its flags. */
static uint64_t object_key(const char *text, size_t length, const char *compiler) {
    uint64_t key = hash_string(__VERSION__, hash_string(compiler, 0));
    for (int i = 0; i < runtime_file_count; i++)
        key = hash_bytes(runtime_files[i].text, runtime_files[i].length, key);
    return hash_bytes(text, length, key);
}

static bool compile(const char *text, size_t length, const char *compiler, const char *object,
                    struct status *status) {
    char source[PATH_BYTES + 4], command[3 * PATH_BYTES];
    snprintf(source, sizeof source, "%s.c", object);
    FILE *file = fopen(source, "w");
    bool ok = file && fwrite(text, 1, length, file) == length;
    ok = file && !fclose(file) && ok;
    if (!ok)
        return status_fail(status, STATUS_IO, "cannot write %s: %s", source, strerror(errno));
    snprintf(command, sizeof command, "%s -shared -fPIC -I'%s' -o '%s' '%s'", compiler,
             SIMD_INCLUDE, object, source);
    if (system(command))
        ok = status_fail(status, STATUS_INTERNAL, "the C compiler refuses what was generated");
    unlink(source);
    return ok;
}

void *compiled_object_load(const char *text, size_t length, const char *compiler,
                           struct status *status) {
    const char *cache = getenv("SORTLAST_CACHE");
    char folder[] = "/tmp/sortlast-object-XXXXXX", kept[PATH_BYTES - 64], object[PATH_BYTES];
    const bool is_kept = cache && *cache;
    if (is_kept) {
        mkdir(cache, 0700);
        snprintf(kept, sizeof kept, "%.900s/tested-%016llx.so", cache,
                 (unsigned long long)object_key(text, length, compiler));
        snprintf(object, sizeof object, "%s.%d", kept, (int)getpid());
    } else {
        if (!mkdtemp(folder)) {
            status_fail(status, STATUS_IO, "cannot make a folder in /tmp");
            return NULL;
        }
        snprintf(object, sizeof object, "%s/object.so", folder);
    }
    const bool is_there = is_kept && !access(kept, R_OK);
    const bool ok = is_there || (compile(text, length, compiler, object, status) &&
                                 (!is_kept || !rename(object, kept)));
    void *library = ok ? dlopen(is_kept ? kept : object, RTLD_NOW | RTLD_LOCAL) : NULL;
    if (ok && !library)
        status_fail(status, STATUS_INTERNAL, "%s", dlerror());
    if (!is_there)
        unlink(object);
    if (!is_kept)
        rmdir(folder);
    return library;
}
