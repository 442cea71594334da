/* SPDX-License-Identifier: Apache-2.0 */
#include "nodes/shared_pool.h"

#include "netsim/wire.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    SHELF_BYTES =
        24 << 20, /* some fifty regions: all that is under way; pages are taken as they are used */
    SHARE_BYTES_MIN = 4096, /* smaller messages are cheaper copied */
    BLOCK_ALIGNMENT = 64,
    BLOCKS_MAX = SHELF_BYTES / SHARE_BYTES_MIN,
};

/* In front of each message in the pool. */
struct shared_block {
    _Alignas(BLOCK_ALIGNMENT) _Atomic uint32_t
        holders;       /* messages in any process, and references under way */
    uint32_t capacity; /* bytes of the message that there is room for */
};

/* A block that this node has filled. */
struct filled_block {
    uint32_t offset, size; /* on the shelf */
};

struct shared_pool {
    uint8_t *memory;
    size_t size;
    uint8_t *shelf;
    struct filled_block filled[BLOCKS_MAX]; /* by ascending offset */
    uint32_t filled_count;
};

/* A message whose bytes lie in the pool. */
struct shared_message {
    struct message message; /* first */
    struct shared_block *block;
};

int shared_pool_create(uint32_t shelves) {
    const int descriptor = memfd_create("sortlast-pool", 0);
    if (descriptor >= 0 && ftruncate(descriptor, (off_t)shelves * SHELF_BYTES)) {
        close(descriptor);
        return -1;
    }
    return descriptor;
}

struct shared_pool *shared_pool_open(int descriptor, uint32_t shelf) {
    struct stat info;
    if (fstat(descriptor, &info) || info.st_size < (off_t)(shelf + 1) * SHELF_BYTES)
        return NULL;
    void *memory =
        mmap(NULL, (size_t)info.st_size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (memory == MAP_FAILED)
        return NULL;
    struct shared_pool *pool = memory_get(1, sizeof *pool);
    pool->memory = memory;
    pool->size = (size_t)info.st_size;
    pool->shelf = pool->memory + (size_t)shelf * SHELF_BYTES;
    return pool;
}

void shared_pool_close(struct shared_pool *pool) {
    if (!pool)
        return;
    munmap(pool->memory, pool->size);
    free(pool);
}

static struct shared_block *block_at(const struct shared_pool *pool, uint32_t offset) {
    return (struct shared_block *)(pool->shelf + offset);
}

/* Forgets filled blocks that nobody holds. */
static void reclaim(struct shared_pool *pool) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pool->filled_count; i++)
        if (atomic_load_explicit(&block_at(pool, pool->filled[i].offset)->holders,
                                 memory_order_acquire))
            pool->filled[kept++] = pool->filled[i];
    pool->filled_count = kept;
}

/* Room for a block of `size` bytes, or NULL: the first gap, where caches are warm. */
static struct shared_block *allocate(struct shared_pool *pool, uint32_t size) {
    uint32_t begin = 0, i = 0;
    reclaim(pool);
    while (i < pool->filled_count && pool->filled[i].offset - begin < size) {
        begin = pool->filled[i].offset + pool->filled[i].size;
        i++;
    }
    if (pool->filled_count == BLOCKS_MAX || SHELF_BYTES - begin < size)
        return NULL;
    memmove(pool->filled + i + 1, pool->filled + i,
            (pool->filled_count++ - i) * sizeof *pool->filled);
    pool->filled[i] = (struct filled_block){begin, size};
    return block_at(pool, begin);
}

static void dispose_shared(struct message *message) {
    struct shared_message *shared = (struct shared_message *)message;
    atomic_fetch_sub_explicit(&shared->block->holders, 1, memory_order_release);
    free(shared);
}

static bool is_lent(const struct message *message) {
    const struct shared_block *block = ((const struct shared_message *)message)->block;
    return atomic_load_explicit(&block->holders, memory_order_acquire) != 1;
}

bool shared_pool_put(struct shared_pool *pool, struct message *message,
                     struct shared_reference *reference) {
    if (!pool || message->length < SHARE_BYTES_MIN || message->capacity > SHELF_BYTES / 2)
        return false;
    struct shared_block *block;
    if (message->dispose == dispose_shared) { /* passed on as it is */
        block = ((struct shared_message *)message)->block;
        atomic_fetch_add_explicit(&block->holders, 1, memory_order_relaxed);
    } else {
        const size_t size = (sizeof *block + message->capacity + BLOCK_ALIGNMENT - 1) /
                            BLOCK_ALIGNMENT * BLOCK_ALIGNMENT;
        block = allocate(pool, (uint32_t)size);
        if (!block)
            return false;
        memcpy(block + 1, message->bytes, message->length);
        block->capacity = (uint32_t)message->capacity;
        atomic_store_explicit(&block->holders, 1, memory_order_release);
    }
    *reference = (struct shared_reference){(uint64_t)((const uint8_t *)block - pool->memory),
                                           message->length};
    message_release(message);
    return true;
}

struct message *shared_references_encode(const struct shared_reference *references, size_t count) {
    struct wire_writer writer = {0};
    for (size_t i = 0; i < count; i++) {
        wire_put_u64(&writer, references[i].offset);
        wire_put_u64(&writer, references[i].length);
    }
    return wire_finish(&writer, (struct wire_header){.kind = WIRE_SHARED, .cause = CAUSE_CONTROL});
}

bool shared_references_decode(const struct message *message, struct shared_reference *references,
                              size_t *count, struct status *status) {
    struct wire_reader reader = wire_payload(message->bytes, message->length);
    *count = 0;
    while (*count < SHARED_REFERENCES_MAX && reader.at < reader.length) {
        references[*count].offset = wire_get_u64(&reader);
        references[(*count)++].length = wire_get_u64(&reader);
    }
    return wire_reader_done(&reader, "shared", status);
}

/* Whether the block is as large as the reference and its own capacity say. */
static bool has_room(const struct shared_pool *pool, struct shared_reference reference) {
    const struct shared_block *block =
        (const struct shared_block *)(pool->memory + reference.offset);
    return block->capacity >= reference.length &&
           block->capacity <= pool->size - reference.offset - sizeof *block;
}

bool shared_pool_get(struct shared_pool *pool, struct shared_reference reference,
                     struct message **message, struct status *status) {
    if (!pool || reference.offset % BLOCK_ALIGNMENT || reference.offset >= pool->size ||
        pool->size - reference.offset < sizeof(struct shared_block) ||
        reference.length > pool->size - reference.offset - sizeof(struct shared_block) ||
        !has_room(pool, reference))
        return status_fail(status, STATUS_INVALID,
                           "a message is said to lie in shared memory that is not there");
    struct shared_message *shared = memory_get(1, sizeof *shared);
    shared->block = (struct shared_block *)(pool->memory + reference.offset);
    atomic_init(&shared->message.holders, 1);
    shared->message.length = reference.length;
    shared->message.capacity = shared->block->capacity;
    shared->message.is_lent = is_lent;
    shared->message.bytes = (uint8_t *)(shared->block + 1);
    shared->message.dispose = dispose_shared;
    *message = &shared->message;
    return true;
}
