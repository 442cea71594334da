/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a record: first as they are, then as the contents under a good head, so that the
 * decoder itself is reached. Nothing may crash or hang, and what it accepts must be safe to solve
 * and come out the same when written again. */
#include "base/hash.h"
#include "netsim/record_file.h"
#include "netsim/what_if.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t fuzz_accepted; /* inputs that were records */

static void use(struct run_record *record) {
    enum { FRAMES_MAX = 100 };
    struct what_if question = what_if_default(record);
    struct what_if_result result;
    uint8_t *bytes;
    size_t length;
    struct run_record *again;
    fuzz_accepted++;
    if (!record_encode(record, &bytes, &length, NULL) ||
        !record_decode("again", bytes, length, &again, NULL))
        abort();
    free(bytes);
    record_destroy(again);
    if (record->frame_count > FRAMES_MAX)
        return;
    question.rendering_nodes = 3;
    question.shading_nodes = 2;
    question.maps = WHAT_IF_MAPS_UNION | WHAT_IF_MAPS_UNBOUND;
    question.assignment = WHAT_IF_BY_COST;
    if (record->chunk_triangles <= UINT32_MAX / 2)
        question.chunk_triangles = 2 * record->chunk_triangles;
    struct timeline *timeline = timeline_create(&question.machine, 3, 2);
    struct what_if_solver *solver = what_if_solver_create(record);
    if (what_if_solve(solver, &question, timeline, &result, NULL))
        free(timeline_uses(timeline));
    what_if_solver_destroy(solver);
    timeline_destroy(timeline);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct run_record *record;
    if (record_decode("input", data, size, &record, NULL)) {
        use(record);
        record_destroy(record);
    }
    uLongf packed = compressBound(size);
    uint8_t *bytes = memory_get(RECORD_HEAD_BYTES + packed, 1);
    if (compress2(bytes + RECORD_HEAD_BYTES, &packed, data, size, 1) != Z_OK)
        abort();
    const uint32_t magic = RECORD_MAGIC, version = RECORD_VERSION;
    const uint64_t length = size,
                   checksum = hash_bytes(bytes + RECORD_HEAD_BYTES, packed, RECORD_VERSION);
    memcpy(bytes + RECORD_AT_MAGIC, &magic, 4);
    memcpy(bytes + RECORD_AT_VERSION, &version, 4);
    memcpy(bytes + RECORD_AT_LENGTH, &length, 8);
    memcpy(bytes + RECORD_AT_CHECKSUM, &checksum, 8);
    const uint64_t head = hash_bytes(bytes, RECORD_AT_HEAD_CHECKSUM, RECORD_VERSION);
    memcpy(bytes + RECORD_AT_HEAD_CHECKSUM, &head, 8);
    if (record_decode("input", bytes, RECORD_HEAD_BYTES + packed, &record, NULL)) {
        use(record);
        record_destroy(record);
    }
    free(bytes);
    return 0;
}

#ifdef FUZZ_WITH_MAIN
int main(int argc, char **argv) {
    enum { INPUT_MAX = 1 << 20 };
    for (int i = 1; i < argc; i++) {
        FILE *file = fopen(argv[i], "rb");
        if (!file) {
            fprintf(stderr, "cannot open %s\n", argv[i]);
            return 1;
        }
        uint8_t *bytes = memory_get(INPUT_MAX, 1);
        const size_t length = fread(bytes, 1, INPUT_MAX, file);
        fclose(file);
        LLVMFuzzerTestOneInput(bytes, length);
        free(bytes);
    }
    printf("%d files replayed, %llu of them records\n", argc - 1,
           (unsigned long long)fuzz_accepted);
    return fuzz_accepted ? 0 : 1; /* a corpus of which nothing is read any more proves nothing */
}
#endif
