/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/scene.h"

#include <stdio.h>
#include <stdlib.h>

/* Reads any bytes as RIB and touches all that comes out. With -DFUZZ_REPLAY it has a main that
 * replays the files named on its command line, so that the corpus runs without a fuzzer. */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static double mesh_sum(const struct scene_mesh *mesh) {
    double sum = 0;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        if (mesh->triangles[i] >= mesh->vertex_count)
            abort();
        sum += mesh->positions[3 * mesh->triangles[i]];
    }
    if (!(sum - sum == 0))
        abort(); /* not finite */
    for (int k = 0; k < mesh->variable_count; k++)
        for (size_t i = 0; i < mesh->vertex_count * (size_t)mesh->variables[k].components; i++)
            if (!(mesh->variables[k].values[i] - mesh->variables[k].values[i] == 0))
                abort();
    return sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct scene_options options = {.triangles_max = 20000, .chord_pixels = 1};
    struct rib_reader *reader;
    struct status status;
    struct scene_frame *frame;
    if (!rib_reader_open_memory("fuzz.rib", (const char *)data, size, &options, &reader, &status))
        return 0;
    while (rib_reader_next(reader, &frame, &status) && frame) {
        for (size_t i = 0; i < frame->mesh_count; i++)
            mesh_sum(&frame->meshes[i]);
        scene_frame_destroy(frame);
        while (rib_reader_warning(reader))
            continue;
    }
    rib_reader_destroy(reader);
    return 0;
}

#ifdef FUZZ_REPLAY
int main(int count, char **paths) {
    for (int i = 1; i < count; i++) {
        FILE *file = fopen(paths[i], "rb");
        if (!file) {
            fprintf(stderr, "%s: cannot be opened\n", paths[i]);
            return 1;
        }
        size_t capacity = 1 << 22;
        uint8_t *bytes = malloc(capacity);
        size_t length = fread(bytes, 1, capacity, file);
        fclose(file);
        LLVMFuzzerTestOneInput(bytes, length);
        free(bytes);
    }
    return 0;
}
#endif
