/* SPDX-License-Identifier: Apache-2.0 */
#include "base/hash.h"

#include <string.h>

static uint64_t hash_mix(uint64_t a, uint64_t b) {
    unsigned __int128 product = (unsigned __int128)a * b;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

static const uint64_t hash_keys[4] = {0x9e3779b97f4a7c15u, 0xd1b54a32d192ed03u, 0xaef17502108ef2d9u,
                                      0xf1357aea2e62a9c5u};

uint64_t hash_bytes(const void *bytes, size_t length, uint64_t seed) {
    const unsigned char *at = bytes;
    size_t left = length;
    uint64_t lane[4];
    for (int i = 0; i < 4; i++)
        lane[i] = seed ^ hash_keys[i];
    while (left >= 64) {
        uint64_t word[8];
        memcpy(word, at, 64);
        for (int i = 0; i < 4; i++)
            lane[i] = hash_mix(word[2 * i] ^ hash_keys[i], word[2 * i + 1] ^ lane[i]);
        at += 64;
        left -= 64;
    }
    uint64_t tail[8] = {0};
    if (left)
        memcpy(tail, at, left);
    for (int i = 0; i < 4; i++)
        lane[i] = hash_mix(tail[2 * i] ^ hash_keys[i], tail[2 * i + 1] ^ lane[i]);
    uint64_t low = hash_mix(lane[0] ^ hash_keys[2], lane[1] ^ hash_keys[3]);
    uint64_t high = hash_mix(lane[2] ^ hash_keys[0], lane[3] ^ hash_keys[1]);
    return hash_mix(low ^ length ^ hash_keys[0], high ^ hash_keys[1]);
}

uint64_t hash_string(const char *text, uint64_t seed) {
    return hash_bytes(text, strlen(text), seed);
}
