/* SPDX-License-Identifier: Apache-2.0 */
#ifndef BASE_HASH_H
#define BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

/* A 64-bit hash of bytes for checksums and content addresses: not cryptographic; four independent
 * lanes so that it runs at memory speed. The same on every machine of one byte order. */
uint64_t hash_bytes(const void *bytes, size_t length, uint64_t seed);
uint64_t hash_string(const char *text, uint64_t seed);

#endif
