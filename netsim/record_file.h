/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RECORD_FILE_H
#define RECORD_FILE_H

#include <stdint.h>

/* The layout of a record file, for record_encode.c and record_decode.c.
 *
 * Head: magic, version, length of the payload before compression, checksum of the compressed
 * payload, checksum of the head; then the payload as a zlib stream. The payload consists of whole
 * numbers (seven bits a byte, least first, high bit: more follow), signed ones folded (0, -1, 1, -2
 * ...), and strings (length, bytes, zero):
 *
 *   scene, seed, triangles of a chunk, fast math
 *   machine: name, count, (parameter, value)...; operations: count, names
 *   frames: count, each
 *     number, width, height, samples across and down, geometry bytes by cause
 *     three sections, each 0: as in the frame before, or 1 and its contents
 *       shaders: instances (name, shader, bound bytes, parameters (name, floats, use,
 *         geometric)), lights
 *       chunks: (instance, vertices, 2 triangles + begins a run, sharing (distance, vertices))
 *       regions: samples, map floats, entries (chunk - one before, 2 triangles + covers),
 *         works (shader, operations (number, count)) */
#define RECORD_MAGIC 0x524c5453u /* "STLR" */
enum {
    RECORD_VERSION = 3,
    RECORD_AT_MAGIC = 0,
    RECORD_AT_VERSION = 4,
    RECORD_AT_LENGTH = 8,
    RECORD_AT_CHECKSUM = 16,
    RECORD_AT_HEAD_CHECKSUM = 24, /* of everything before */
    RECORD_HEAD_BYTES = 32,
    RECORD_LENGTH_MAX = 1 << 28, /* of the payload */
};

enum record_section {
    RECORD_SECTION_SHADERS,
    RECORD_SECTION_CHUNKS,
    RECORD_SECTION_REGIONS,
    RECORD_SECTION_COUNT
};

#endif
