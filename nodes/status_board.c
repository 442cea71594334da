/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/status_board.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

int status_board_create(uint32_t entries, struct status_board_entry **board) {
    const size_t bytes = (size_t)entries * sizeof **board;
    int descriptor = memfd_create("sortlast-status", 0);
    if (descriptor < 0)
        return -1;
    void *mapped = ftruncate(descriptor, (off_t)bytes)
                       ? MAP_FAILED
                       : mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (mapped == MAP_FAILED) {
        close(descriptor);
        return -1;
    }
    *board = mapped;
    return descriptor;
}

struct status_board_entry *status_board_open(int descriptor, uint32_t entry) {
    struct stat info;
    if (fstat(descriptor, &info) ||
        info.st_size < (off_t)((entry + 1) * sizeof(struct status_board_entry)))
        return NULL;
    void *mapped =
        mmap(NULL, (size_t)info.st_size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    return mapped == MAP_FAILED ? NULL : (struct status_board_entry *)mapped + entry;
}
