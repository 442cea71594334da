/* SPDX-License-Identifier: Apache-2.0 */
#include "netsim/wire.h"

#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the wire format is written for little-endian hosts"
#endif

/* Byte offsets of the header's fields. */
enum {
    AT_MAGIC = 0,
    AT_VERSION = 4,
    AT_KIND = 6,
    AT_FRAME = 8,
    AT_REGION = 12,
    AT_SENDER = 16,
    AT_CAUSE = 20,
    AT_LENGTH = 24,
    AT_CHARGED = 32,
    AT_CHARGED_CONTROL = 40,
    AT_HEADER_CHECKSUM = 48, /* of everything else in the header */
    AT_CHECKSUM = 56,        /* of the payload */
};

const char *wire_kind_name(enum wire_kind kind) {
    static const char *const names[] = {
#define WIRE_KIND_NAME(name, text, from, to) text,
        WIRE_KINDS(WIRE_KIND_NAME)
#undef WIRE_KIND_NAME
    };
    return (unsigned)kind < WIRE_KIND_COUNT ? names[kind] : "unknown";
}

static uint64_t payload_checksum(const uint8_t *bytes, size_t length) {
    return hash_bytes(bytes + WIRE_HEADER_BYTES, length - WIRE_HEADER_BYTES, WIRE_VERSION);
}

uint64_t wire_payload_hash(const uint8_t *bytes) {
    uint64_t checksum;
    memcpy(&checksum, bytes + AT_CHECKSUM, sizeof checksum);
    return checksum;
}

static uint64_t header_checksum(const uint8_t *bytes) {
    return hash_bytes(bytes, AT_HEADER_CHECKSUM, wire_payload_hash(bytes));
}

void wire_seal(struct message *message, struct wire_header header) {
    uint8_t *bytes = message->bytes;
    const uint32_t magic = WIRE_MAGIC, cause = header.cause;
    const uint16_t version = WIRE_VERSION, kind = (uint16_t)header.kind;
    const uint64_t length = message->length - WIRE_HEADER_BYTES;
    memset(bytes, 0, WIRE_HEADER_BYTES);
    memcpy(bytes + AT_MAGIC, &magic, 4);
    memcpy(bytes + AT_VERSION, &version, 2);
    memcpy(bytes + AT_KIND, &kind, 2);
    memcpy(bytes + AT_FRAME, &header.frame, 4);
    memcpy(bytes + AT_REGION, &header.region, 4);
    memcpy(bytes + AT_SENDER, &header.sender, 4);
    memcpy(bytes + AT_CAUSE, &cause, 4);
    memcpy(bytes + AT_LENGTH, &length, 8);
    memcpy(bytes + AT_CHARGED, header.charged_bytes, 16);
    uint64_t checksum = payload_checksum(bytes, message->length);
    memcpy(bytes + AT_CHECKSUM, &checksum, 8);
    checksum = header_checksum(bytes);
    memcpy(bytes + AT_HEADER_CHECKSUM, &checksum, 8);
}

/* Regions pass through nodes that have nothing to add without being looked at; who takes them apart
 * checks. */
static bool is_checked_by_consumer(enum wire_kind kind) {
    return kind == WIRE_REGION || kind == WIRE_COLOUR;
}

bool wire_open(const uint8_t *bytes, size_t length, struct wire_header *header,
               struct status *status) {
    uint32_t magic, cause;
    uint16_t version, kind;
    uint64_t checksum;
    if (length < WIRE_HEADER_BYTES)
        return status_fail(status, STATUS_INVALID,
                           "wire message of %zu bytes: shorter than a header", length);
    memcpy(&magic, bytes + AT_MAGIC, 4);
    memcpy(&version, bytes + AT_VERSION, 2);
    memcpy(&kind, bytes + AT_KIND, 2);
    if (magic != WIRE_MAGIC)
        return status_fail(status, STATUS_INVALID,
                           "wire message does not begin with our mark: another "
                           "program is talking to this address");
    if (version != WIRE_VERSION)
        return status_fail(
            status, STATUS_INVALID,
            "wire message of version %u, this program speaks %d: use node programs of "
            "one build",
            version, WIRE_VERSION);
    if (kind >= WIRE_KIND_COUNT)
        return status_fail(status, STATUS_INVALID, "wire message of unknown kind %u", kind);
    *header = (struct wire_header){.kind = (enum wire_kind)kind};
    memcpy(&header->frame, bytes + AT_FRAME, 4);
    memcpy(&header->region, bytes + AT_REGION, 4);
    memcpy(&header->sender, bytes + AT_SENDER, 4);
    memcpy(&cause, bytes + AT_CAUSE, 4);
    memcpy(&header->payload_bytes, bytes + AT_LENGTH, 8);
    memcpy(header->charged_bytes, bytes + AT_CHARGED, 16);
    memcpy(&checksum, bytes + AT_HEADER_CHECKSUM, 8);
    if (cause >= CAUSE_COUNT || header->payload_bytes != length - WIRE_HEADER_BYTES)
        return status_fail(status, STATUS_INVALID, "wire message (%s): header and length disagree",
                           wire_kind_name(header->kind));
    header->cause = (enum wire_cause)cause;
    if (checksum != header_checksum(bytes))
        return status_fail(status, STATUS_INVALID,
                           "wire message (%s): checksum of the header differs",
                           wire_kind_name(header->kind));
    return is_checked_by_consumer(header->kind) || wire_verify_payload(bytes, length, status);
}

bool wire_verify_payload(const uint8_t *bytes, size_t length, struct status *status) {
    if (wire_payload_hash(bytes) == payload_checksum(bytes, length))
        return true;
    return status_fail(status, STATUS_INVALID, "wire message: checksum of the payload differs");
}

void wire_put(struct wire_writer *writer, const void *bytes, size_t length) {
    writer->bytes = memory_grow(writer->bytes, &writer->capacity, writer->length + length, 1);
    if (length)
        memcpy(writer->bytes + writer->length, bytes, length);
    writer->length += length;
}

void wire_put_u32(struct wire_writer *writer, uint32_t value) {
    wire_put(writer, &value, sizeof value);
}
void wire_put_u64(struct wire_writer *writer, uint64_t value) {
    wire_put(writer, &value, sizeof value);
}
void wire_put_f32(struct wire_writer *writer, float value) {
    wire_put(writer, &value, sizeof value);
}
void wire_put_f64(struct wire_writer *writer, double value) {
    wire_put(writer, &value, sizeof value);
}

void wire_put_string(struct wire_writer *writer, const char *text) {
    size_t length = strlen(text);
    wire_put_u32(writer, (uint32_t)length);
    wire_put(writer, text, length + 1);
}

void wire_align(struct wire_writer *writer, size_t alignment) {
    static const uint8_t zeros[64];
    wire_put(writer, zeros, (alignment - writer->length % alignment) % alignment);
}

struct message *wire_finish(struct wire_writer *writer, struct wire_header header) {
    struct message *message = message_create(WIRE_HEADER_BYTES + writer->length);
    if (writer->length)
        memcpy(message->bytes + WIRE_HEADER_BYTES, writer->bytes, writer->length);
    wire_seal(message, header);
    free(writer->bytes);
    *writer = (struct wire_writer){0};
    return message;
}

struct wire_reader wire_payload(const uint8_t *message_bytes, size_t message_length) {
    return (struct wire_reader){message_bytes + WIRE_HEADER_BYTES,
                                message_length - WIRE_HEADER_BYTES, 0, false};
}

const void *wire_get(struct wire_reader *reader, size_t length) {
    if (reader->failed || length > reader->length - reader->at) {
        reader->failed = true;
        return NULL;
    }
    const void *bytes = reader->bytes + reader->at;
    reader->at += length;
    return bytes;
}

const void *wire_get_array(struct wire_reader *reader, uint64_t count, size_t size) {
    if (count > reader->length / size) {
        reader->failed = true;
        return NULL;
    }
    return wire_get(reader, (size_t)count * size);
}

#define WIRE_GET(name, type)                                                                       \
    type name(struct wire_reader *reader) {                                                        \
        type value = 0;                                                                            \
        const void *bytes = wire_get(reader, sizeof value);                                        \
        if (bytes)                                                                                 \
            memcpy(&value, bytes, sizeof value);                                                   \
        return value;                                                                              \
    }
WIRE_GET(wire_get_u32, uint32_t)
WIRE_GET(wire_get_u64, uint64_t)
WIRE_GET(wire_get_f32, float)
WIRE_GET(wire_get_f64, double)
#undef WIRE_GET

const char *wire_get_string(struct wire_reader *reader) {
    uint32_t length = wire_get_u32(reader);
    const char *text = wire_get(reader, (size_t)length + 1);
    if (text && (text[length] || memchr(text, 0, length))) {
        reader->failed = true;
        text = NULL;
    }
    return text ? text : "";
}

void wire_skip_to(struct wire_reader *reader, size_t alignment) {
    wire_get(reader, (alignment - reader->at % alignment) % alignment);
}

bool wire_reader_done(const struct wire_reader *reader, const char *what, struct status *status) {
    if (!reader->failed && reader->at == reader->length)
        return true;
    return status_fail(status, STATUS_INVALID, "damaged %s message: %s", what,
                       reader->failed ? "too short, or a count that cannot be" : "bytes left over");
}
