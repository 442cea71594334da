/* SPDX-License-Identifier: Apache-2.0 */
#ifndef WIRE_H
#define WIRE_H

#include "base/status.h"
#include "netsim/message.h"

#include <stdbool.h>
#include <stdint.h>

/* The wire format. Every message is a fixed header of 64 bytes and a payload, little-endian. The
 * header says what the simulated network is charged for the message and why (contract C3): what a
 * real PixelFlow would have sent, which is not what our sockets carry. */

#define WIRE_MAGIC 0x314c5053u /* "SPL1" */
enum { WIRE_VERSION = 1, WIRE_HEADER_BYTES = 64 };

/* X(NAME, name in messages to people, from, to) */
#define WIRE_KINDS(X)                                                                              \
    X(HELLO, "hello", "any node", "host")                                                          \
    X(CONFIGURATION, "configuration", "host", "all")                                               \
    X(TOPOLOGY, "topology", "host", "all")                                                         \
    X(READY, "ready", "any node", "host")                                                          \
    X(SHADER, "shader", "host", "shading nodes")                                                   \
    X(FRAME_BEGIN, "frame begin", "host", "all")                                                   \
    X(INSTANCE, "shader instance", "host", "shading nodes")                                        \
    X(LIGHT, "light", "host", "shading nodes")                                                     \
    X(CHUNK, "primitive chunk", "host", "one rendering node")                                      \
    X(FRAME_END, "frame end", "host", "all")                                                       \
    X(REGION, "region", "rendering node", "next node of the chain")                                \
    X(EMPTY_REGIONS, "empty regions", "rendering node", "next node of the chain")                  \
    X(COLOUR, "shaded region", "shading node", "framebuffer node")                                 \
    X(PROGRESS, "progress", "framebuffer node", "host")                                            \
    X(FRAME_DONE, "frame done", "framebuffer node", "host")                                        \
    X(WARNING, "warning", "any node", "host")                                                      \
    X(FAILURE, "failure", "any node", "host")                                                      \
    X(QUIT, "quit", "host", "all")                                                                 \
    X(GOODBYE, "goodbye", "framebuffer node", "host")                                              \
    X(PROBE, "probe", "host", "all")                                                               \
    X(SHARED, "shared memory", "any node", "another on the same machine")                          \
    X(ARRIVAL, "arrival", "shading node", "rendering node")                                        \
    X(FILLER, "filler", "rendering node", "shading node")                                          \
    X(CREDIT, "credit", "any node", "whoever sent it a region")                                    \
    X(CHUNK_WORK, "chunk work", "rendering node", "host")                                          \
    X(REGION_COSTS, "region costs", "framebuffer node", "host")

enum wire_kind {
#define WIRE_KIND_ENUM(name, text, from, to) WIRE_##name,
    WIRE_KINDS(WIRE_KIND_ENUM)
#undef WIRE_KIND_ENUM
        WIRE_KIND_COUNT
};

/* What a geometry message is charged to. */
enum wire_cause {
    CAUSE_PRIMITIVES,
    CAUSE_BOUND_PARAMETERS,
    CAUSE_SHADERS,
    CAUSE_CONTROL,
    CAUSE_COUNT
};

struct wire_header {
    enum wire_kind kind;
    uint32_t frame;  /* index from 0 */
    uint32_t region; /* index, or 0 */
    uint32_t sender; /* node_address_pack */
    uint64_t payload_bytes;
    uint64_t charged_bytes[2]; /* [0] to `cause`, [1] to CAUSE_CONTROL */
    enum wire_cause cause;
};

const char *wire_kind_name(enum wire_kind kind);

/* Fills in header and checksum of a message whose payload (from byte WIRE_HEADER_BYTES) is
 * complete. */
void wire_seal(struct message *message, struct wire_header header);
/* Checks magic, version, kind, length and checksums. The payload of REGION and COLOUR is left to
 * whoever takes it apart (region_open, colour_open call wire_verify_payload): most nodes only pass
 * it on. */
bool wire_open(const uint8_t *bytes, size_t length, struct wire_header *header,
               struct status *status);
bool wire_verify_payload(const uint8_t *bytes, size_t length, struct status *status);
/* The checksum of the payload as the header has it: the same for the same payload, whatever the
 * rest of the header says. */
uint64_t wire_payload_hash(const uint8_t *bytes);

/* Appends to a payload that grows. */
struct wire_writer {
    uint8_t *bytes;
    size_t length, capacity;
};
void wire_put(struct wire_writer *writer, const void *bytes, size_t length);
void wire_put_u32(struct wire_writer *writer, uint32_t value);
void wire_put_u64(struct wire_writer *writer, uint64_t value);
void wire_put_f32(struct wire_writer *writer, float value);
void wire_put_f64(struct wire_writer *writer, double value);
void wire_put_string(struct wire_writer *writer, const char *text);
void wire_align(struct wire_writer *writer, size_t alignment);
/* Makes the sealed message and empties the writer. */
struct message *wire_finish(struct wire_writer *writer, struct wire_header header);

/* Reads a payload; reading past the end gives zeros and sets `failed`, checked once by
 * wire_reader_done. */
struct wire_reader {
    const uint8_t *bytes;
    size_t length, at;
    bool failed;
};
struct wire_reader wire_payload(const uint8_t *message_bytes, size_t message_length);
const void *wire_get(struct wire_reader *reader, size_t length); /* NULL past the end */
/* `count` items of `size` bytes, checked against overflow. */
const void *wire_get_array(struct wire_reader *reader, uint64_t count, size_t size);
uint32_t wire_get_u32(struct wire_reader *reader);
uint64_t wire_get_u64(struct wire_reader *reader);
float wire_get_f32(struct wire_reader *reader);
double wire_get_f64(struct wire_reader *reader);
/* A string inside the message, "" when damaged. */
const char *wire_get_string(struct wire_reader *reader);
void wire_skip_to(struct wire_reader *reader, size_t alignment);
/* True when all was there and nothing is left over. */
bool wire_reader_done(const struct wire_reader *reader, const char *what, struct status *status);

#endif
