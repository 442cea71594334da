/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_REPLACEMENT_FILE_H
#define IMAGES_REPLACEMENT_FILE_H

#include "base/status.h"

#include <stdint.h>

/* A file that appears under its name only when it is complete: it grows under a temporary name in
 * the same folder (".NAME.PID.tmp") and is renamed at the end, so that a reader finds the old file,
 * the new one or none. It is not forced to the disk: a power cut may lose it, a failed program may
 * not. */
struct replacement_file {
    char *path;      /* what the caller asked for, for messages */
    char *target;    /* the same after symbolic links */
    char *temporary; /* NULL when there is nothing to remove */
    int descriptor;
    uint64_t length_bytes; /* written by replacement_file_append */
    int error;             /* the first errno of a failed write, 0 for none */
};

/* On failure there is nothing to abandon. A path that exists and is not a regular file is refused.
 */
bool replacement_file_open(struct replacement_file *file, const char *path, struct status *status);
/* All of it or false with file->error set; threads may write disjoint ranges at once. */
bool replacement_file_write(struct replacement_file *file, const void *bytes, uint64_t size_bytes,
                            uint64_t offset_bytes);
bool replacement_file_append(struct replacement_file *file, const void *bytes, uint64_t size_bytes);
/* Closes and renames; on failure (an earlier failed write included) the temporary file is gone.
 * Either way the file is finished. */
bool replacement_file_commit(struct replacement_file *file, struct status *status);
/* Removes the temporary file; harmless after a commit. */
void replacement_file_abandon(struct replacement_file *file);

#endif
