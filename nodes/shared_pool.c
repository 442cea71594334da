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
    RING_BYTES =
        8 << 20, /* some sixteen regions: what is under way, and no more than caches like */
    SHARE_BYTES_MIN = 4096, /* smaller messages are cheaper copied */
    BLOCK_ALIGNMENT = 64,
    BLOCKS_MAX = RING_BYTES / SHARE_BYTES_MIN,
};

/* In front of each message in the pool. */
struct shared_block {
    _Alignas(BLOCK_ALIGNMENT) _Atomic uint32_t
        holders; /* messages in any process, and references under way */
};

/* A block this node has filled, oldest first. */
struct filled_block {
    uint32_t offset, size; /* in the ring */
};

struct shared_pool {
    uint8_t *memory;
    size_t size;
    uint8_t *ring;
    uint32_t head; /* where the next block may begin */
    struct filled_block filled[BLOCKS_MAX];
    uint32_t filled_first, filled_count;
};

/* A message whose bytes lie in the pool. */
struct shared_message {
    struct message message; /* first */
    struct shared_block *block;
};

int shared_pool_create(uint32_t rings) {
    const int descriptor = memfd_create("sortlast-pool", 0);
    if (descriptor >= 0 && ftruncate(descriptor, (off_t)rings * RING_BYTES)) {
        close(descriptor);
        return -1;
    }
    return descriptor;
}

struct shared_pool *shared_pool_open(int descriptor, uint32_t ring) {
    struct stat info;
    if (fstat(descriptor, &info) || info.st_size < (off_t)(ring + 1) * RING_BYTES)
        return NULL;
    void *memory =
        mmap(NULL, (size_t)info.st_size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (memory == MAP_FAILED)
        return NULL;
    struct shared_pool *pool = memory_get(1, sizeof *pool);
    pool->memory = memory;
    pool->size = (size_t)info.st_size;
    pool->ring = pool->memory + (size_t)ring * RING_BYTES;
    return pool;
}

void shared_pool_close(struct shared_pool *pool) {
    if (!pool)
        return;
    munmap(pool->memory, pool->size);
    free(pool);
}

static struct shared_block *block_at(const struct shared_pool *pool, uint32_t offset) {
    return (struct shared_block *)(pool->ring + offset);
}

/* Forgets filled blocks that nobody holds, oldest first. */
static void reclaim(struct shared_pool *pool) {
    while (pool->filled_count) {
        const struct filled_block *oldest = &pool->filled[pool->filled_first];
        if (atomic_load_explicit(&block_at(pool, oldest->offset)->holders, memory_order_acquire))
            break;
        pool->filled_first = (pool->filled_first + 1) % BLOCKS_MAX;
        pool->filled_count--;
    }
    if (!pool->filled_count)
        pool->head = 0; /* begin again where the cache is warm */
}

/* Room for a block of `size` bytes, or NULL. The filled part of the ring runs from the oldest block
 * to the head. */
static struct shared_block *allocate(struct shared_pool *pool, uint32_t size) {
    reclaim(pool);
    if (pool->filled_count == BLOCKS_MAX)
        return NULL;
    uint32_t end = RING_BYTES;
    if (pool->filled_count) {
        const uint32_t tail = pool->filled[pool->filled_first].offset;
        if (pool->head <= tail)
            end = tail;
        else if (RING_BYTES - pool->head < size) { /* wrap, leaving the rest of the ring empty */
            if (tail < size)
                return NULL;
            pool->head = 0;
            end = tail;
        }
    }
    if (end - pool->head < size)
        return NULL;
    const uint32_t last = (pool->filled_first + pool->filled_count++) % BLOCKS_MAX;
    pool->filled[last] = (struct filled_block){pool->head, size};
    pool->head += size;
    return block_at(pool, pool->filled[last].offset);
}

static void dispose_shared(struct message *message) {
    struct shared_message *shared = (struct shared_message *)message;
    atomic_fetch_sub_explicit(&shared->block->holders, 1, memory_order_release);
    free(shared);
}

static struct message *make_reference(const struct shared_pool *pool,
                                      const struct shared_block *block, size_t length) {
    struct wire_writer writer = {0};
    wire_put_u64(&writer, (uint64_t)((const uint8_t *)block - pool->memory));
    wire_put_u64(&writer, length);
    return wire_finish(&writer, (struct wire_header){.kind = WIRE_SHARED, .cause = CAUSE_CONTROL});
}

struct message *shared_pool_share(struct shared_pool *pool, struct message *message) {
    if (!pool || message->length < SHARE_BYTES_MIN || message->length > RING_BYTES / 2)
        return message;
    struct shared_block *block;
    if (message->dispose == dispose_shared) { /* passed on as it is */
        block = ((struct shared_message *)message)->block;
        atomic_fetch_add_explicit(&block->holders, 1, memory_order_relaxed);
    } else {
        const size_t size = (sizeof *block + message->length + BLOCK_ALIGNMENT - 1) /
                            BLOCK_ALIGNMENT * BLOCK_ALIGNMENT;
        block = allocate(pool, (uint32_t)size);
        if (!block)
            return message;
        memcpy(block + 1, message->bytes, message->length);
        atomic_store_explicit(&block->holders, 1, memory_order_release);
    }
    struct message *reference = make_reference(pool, block, message->length);
    message_release(message);
    return reference;
}

bool shared_pool_receive(struct shared_pool *pool, const struct message *reference,
                         struct message **message, struct status *status) {
    struct wire_reader reader = wire_payload(reference->bytes, reference->length);
    const uint64_t offset = wire_get_u64(&reader), length = wire_get_u64(&reader);
    if (!wire_reader_done(&reader, "shared", status))
        return false;
    if (!pool || offset % BLOCK_ALIGNMENT || offset >= pool->size ||
        length > pool->size - offset - sizeof(struct shared_block) ||
        pool->size - offset < sizeof(struct shared_block))
        return status_fail(status, STATUS_INVALID,
                           "a message is said to lie in shared memory that is not there");
    struct shared_message *shared = memory_get(1, sizeof *shared);
    shared->block = (struct shared_block *)(pool->memory + offset);
    atomic_init(&shared->message.holders, 1);
    shared->message.length = length;
    shared->message.bytes = (uint8_t *)(shared->block + 1);
    shared->message.dispose = dispose_shared;
    *message = &shared->message;
    return true;
}
