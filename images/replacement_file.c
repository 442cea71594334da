/* SPDX-License-Identifier: Apache-2.0 */
#include "images/replacement_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A name in a folder has at most 255 bytes; the temporary name takes up to 24 of them. */
enum { NAME_KEPT_BYTES = 230, ATTEMPTS = 64 };

static char *replacement_name(const char *target, int attempt) {
    const char *slash = strrchr(target, '/'), *name = slash ? slash + 1 : target;
    size_t folder_bytes = (size_t)(name - target), size = folder_bytes + NAME_KEPT_BYTES + 64;
    char *temporary = memory_get(size, 1);
    memcpy(temporary, target, folder_bytes);
    int length = snprintf(temporary + folder_bytes, size - folder_bytes, ".%.*s.%ld",
                          NAME_KEPT_BYTES, name, (long)getpid());
    snprintf(temporary + folder_bytes + length, size - folder_bytes - (size_t)length,
             attempt ? "-%d.tmp" : ".tmp", attempt);
    return temporary;
}

/* The path after symbolic links, so that renaming replaces the file and not the link; NULL with
 * errno. */
static char *replacement_target(const char *path) {
    struct stat about;
    if (lstat(path, &about) == 0 && S_ISLNK(about.st_mode)) {
        char *resolved = realpath(path, NULL);
        if (resolved || errno != ENOENT)
            return resolved;
    }
    return memory_copy_string(path);
}

static void replacement_forget(struct replacement_file *file) {
    if (file->descriptor >= 0)
        close(file->descriptor);
    free(file->path);
    free(file->target);
    free(file->temporary);
    *file = (struct replacement_file){.descriptor = -1};
}

bool replacement_file_open(struct replacement_file *file, const char *path, struct status *status) {
    *file = (struct replacement_file){.descriptor = -1};
    if (!*path)
        return status_fail(status, STATUS_INVALID, "cannot write a file with an empty name");
    struct stat about;
    if (stat(path, &about) == 0 && !S_ISREG(about.st_mode))
        return status_fail(status, STATUS_INVALID, "cannot write '%s': it is %s", path,
                           S_ISDIR(about.st_mode) ? "a directory" : "not a regular file");
    file->path = memory_copy_string(path);
    file->target = replacement_target(path);
    for (int attempt = 0; file->target && attempt < ATTEMPTS; attempt++) {
        file->temporary = replacement_name(file->target, attempt);
        file->descriptor = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file->descriptor >= 0)
            return true;
        free(file->temporary);
        file->temporary = NULL;
        if (errno != EEXIST)
            break;
    }
    int error = errno;
    replacement_forget(file);
    return status_fail(status, STATUS_IO, "cannot write '%s': %s", path, strerror(error));
}

bool replacement_file_write(struct replacement_file *file, const void *bytes, uint64_t size_bytes,
                            uint64_t offset_bytes) {
    const char *at = bytes;
    while (size_bytes) {
        ssize_t written = pwrite(file->descriptor, at, size_bytes, (off_t)offset_bytes);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0) {
            int error = written < 0 ? errno : ENOSPC, none = 0;
            __atomic_compare_exchange_n(&file->error, &none, error, false, __ATOMIC_RELAXED,
                                        __ATOMIC_RELAXED);
            return false;
        }
        at += written;
        size_bytes -= (uint64_t)written;
        offset_bytes += (uint64_t)written;
    }
    return true;
}

bool replacement_file_append(struct replacement_file *file, const void *bytes,
                             uint64_t size_bytes) {
    if (!replacement_file_write(file, bytes, size_bytes, file->length_bytes))
        return false;
    file->length_bytes += size_bytes;
    return true;
}

bool replacement_file_commit(struct replacement_file *file, struct status *status) {
    int error = file->error;
    /* A network file system reports a full disk only here. */
    if (close(file->descriptor) != 0 && !error)
        error = errno;
    file->descriptor = -1;
    if (!error && rename(file->temporary, file->target) != 0)
        error = errno;
    if (error) {
        status_fail(status, STATUS_IO, "cannot write '%s': %s", file->path, strerror(error));
        replacement_file_abandon(file);
        return false;
    }
    replacement_forget(file);
    return true;
}

void replacement_file_abandon(struct replacement_file *file) {
    if (file->temporary)
        unlink(file->temporary);
    replacement_forget(file);
}
