/* SPDX-License-Identifier: Apache-2.0 */
#include "images/image.h"

#include "images/image_files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool image_create(int width, int height, struct image **image, struct status *status) {
    *image = NULL;
    if (width < 1 || height < 1)
        return status_fail(status, STATUS_INVALID, "an image of %d x %d pixels has no pixels",
                           width, height);
    if ((uint64_t)width * (uint64_t)height > IMAGE_PIXELS_MAX)
        return status_fail(status, STATUS_LIMIT,
                           "an image of %d x %d pixels is over the limit of %llu pixels", width,
                           height, (unsigned long long)IMAGE_PIXELS_MAX);
    struct image *made = memory_get(1, sizeof *made);
    made->width = width;
    made->height = height;
    *image = made;
    return true;
}

struct image_channel *image_add_channel(struct image *image, const char *name,
                                        enum image_channel_type type) {
    size_t length = strlen(name), plane_bytes = image_plane_bytes(image);
    struct image_channel channel = {.type = type};
    if (!length || length >= sizeof channel.name || image_find_channel(image, name))
        return NULL;
    if (((uint64_t)image->channel_count + 1) * plane_bytes > IMAGE_BYTES_MAX)
        return NULL;
    memcpy(channel.name, name, length);
    channel.values = calloc(1, plane_bytes);
    if (!channel.values)
        return NULL;
    struct image_channel *channels =
        realloc(image->channels, ((size_t)image->channel_count + 1) * sizeof *channels);
    if (!channels) {
        free(channel.values);
        return NULL;
    }
    image->channels = channels;
    channels[image->channel_count] = channel;
    return &channels[image->channel_count++];
}

const struct image_channel *image_find_channel(const struct image *image, const char *name) {
    for (int i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0)
            return &image->channels[i];
    return NULL;
}

void image_destroy(struct image *image) {
    if (!image)
        return;
    for (int i = 0; i < image->channel_count; i++)
        free(image->channels[i].values);
    free(image->channels);
    free(image);
}

bool image_open_file(const char *path, int *descriptor, uint64_t *size_bytes,
                     struct status *status) {
    /* Not blocking: opening a pipe that nobody writes to would wait for ever. */
    *descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (*descriptor < 0)
        return status_fail(status, errno == ENOENT ? STATUS_NOT_FOUND : STATUS_IO,
                           "cannot read '%s': %s", path, strerror(errno));
    struct stat about;
    if (fstat(*descriptor, &about) != 0 || !S_ISREG(about.st_mode)) {
        status_fail(status, STATUS_INVALID, "cannot read '%s': it is %s", path,
                    S_ISDIR(about.st_mode) ? "a directory" : "not a regular file");
        close(*descriptor);
        *descriptor = -1;
        return false;
    }
    *size_bytes = (uint64_t)about.st_size;
    return true;
}

int64_t image_read_bytes(int descriptor, void *bytes, uint64_t size_bytes, uint64_t offset_bytes) {
    uint64_t done = 0;
    while (done < size_bytes) {
        ssize_t got = pread(descriptor, (char *)bytes + done, size_bytes - done,
                            (off_t)(offset_bytes + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        done += (uint64_t)got;
    }
    return (int64_t)done;
}

bool image_read(const char *path, struct image **image, struct status *status) {
    static const unsigned char exr_magic[4] = {0x76, 0x2f, 0x31, 0x01};
    static const unsigned char png_magic[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    *image = NULL;
    int descriptor;
    uint64_t size_bytes;
    if (!image_open_file(path, &descriptor, &size_bytes, status))
        return false;
    unsigned char first[8] = {0};
    int64_t got = image_read_bytes(descriptor, first, sizeof first, 0);
    int error = errno;
    close(descriptor);
    if (got < 0)
        return status_fail(status, STATUS_IO, "cannot read '%s': %s", path, strerror(error));
    if (memcmp(first, exr_magic, sizeof exr_magic) == 0)
        return image_read_exr(path, image, status);
    if (memcmp(first, png_magic, sizeof png_magic) == 0)
        return image_read_png(path, image, status);
    return status_fail(status, STATUS_INVALID, "cannot read '%s': %s", path,
                       got ? "it is neither an OpenEXR nor a PNG file" : "the file is empty");
}
