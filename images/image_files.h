/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMAGES_IMAGE_FILES_H
#define IMAGES_IMAGE_FILES_H

#include "images/image.h"

/* What the readers and writers of image files share; private to this folder. */

static inline size_t image_plane_bytes(const struct image *image) {
    return (size_t)image->width * (size_t)image->height * 4;
}

/* Opens a regular file; the caller closes the descriptor. */
bool image_open_file(const char *path, int *descriptor, uint64_t *size_bytes,
                     struct status *status);
/* The number of bytes read, fewer only at the end of the file; -1 with errno. */
int64_t image_read_bytes(int descriptor, void *bytes, uint64_t size_bytes, uint64_t offset_bytes);

#endif
