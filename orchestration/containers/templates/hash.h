/* SHA-256 (FIPS 180-4) of numbers, for a comparison of runs. */
#ifndef HASH_H
#define HASH_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct {
    uint32_t words[8];
    unsigned char block[64];
    uint64_t bytes;
} Hash;

static void hash_begin(Hash *hash) {
    static const uint32_t start[8] = {0x6a09e667u, 0xbb67ae85u, 0x3c6ef372u, 0xa54ff53au,
                                      0x510e527fu, 0x9b05688cu, 0x1f83d9abu, 0x5be0cd19u};
    (void)memcpy(hash->words, start, sizeof start);
    hash->bytes = 0;
}

static uint32_t rotated(uint32_t word, unsigned int bits) { return (word >> bits) | (word << (32u - bits)); }

static void hash_block(Hash *hash) {
    static const uint32_t constants[64] = {
        0x428a2f98u, 0x71374491u, 0xb5c0fbcfu, 0xe9b5dba5u, 0x3956c25bu, 0x59f111f1u, 0x923f82a4u, 0xab1c5ed5u,
        0xd807aa98u, 0x12835b01u, 0x243185beu, 0x550c7dc3u, 0x72be5d74u, 0x80deb1feu, 0x9bdc06a7u, 0xc19bf174u,
        0xe49b69c1u, 0xefbe4786u, 0x0fc19dc6u, 0x240ca1ccu, 0x2de92c6fu, 0x4a7484aau, 0x5cb0a9dcu, 0x76f988dau,
        0x983e5152u, 0xa831c66du, 0xb00327c8u, 0xbf597fc7u, 0xc6e00bf3u, 0xd5a79147u, 0x06ca6351u, 0x14292967u,
        0x27b70a85u, 0x2e1b2138u, 0x4d2c6dfcu, 0x53380d13u, 0x650a7354u, 0x766a0abbu, 0x81c2c92eu, 0x92722c85u,
        0xa2bfe8a1u, 0xa81a664bu, 0xc24b8b70u, 0xc76c51a3u, 0xd192e819u, 0xd6990624u, 0xf40e3585u, 0x106aa070u,
        0x19a4c116u, 0x1e376c08u, 0x2748774cu, 0x34b0bcb5u, 0x391c0cb3u, 0x4ed8aa4au, 0x5b9cca4fu, 0x682e6ff3u,
        0x748f82eeu, 0x78a5636fu, 0x84c87814u, 0x8cc70208u, 0x90befffau, 0xa4506cebu, 0xbef9a3f7u, 0xc67178f2u};
    uint32_t schedule[64], w[8];
    for (unsigned int i = 0; i < 16u; ++i) {
        const unsigned char *b = hash->block + 4u * i;
        schedule[i] = ((uint32_t)b[0] << 24) | ((uint32_t)b[1] << 16) | ((uint32_t)b[2] << 8) | b[3];
    }
    for (unsigned int i = 16; i < 64u; ++i) {
        const uint32_t a = schedule[i - 15u], b = schedule[i - 2u];
        schedule[i] = schedule[i - 16u] + (rotated(a, 7) ^ rotated(a, 18) ^ (a >> 3)) + schedule[i - 7u] +
                      (rotated(b, 17) ^ rotated(b, 19) ^ (b >> 10));
    }
    (void)memcpy(w, hash->words, sizeof w);
    for (unsigned int i = 0; i < 64u; ++i) {
        const uint32_t chosen = (w[4] & w[5]) ^ (~w[4] & w[6]), most = (w[0] & w[1]) ^ (w[0] & w[2]) ^ (w[1] & w[2]);
        const uint32_t first = w[7] + (rotated(w[4], 6) ^ rotated(w[4], 11) ^ rotated(w[4], 25)) + chosen +
                               constants[i] + schedule[i];
        const uint32_t second = (rotated(w[0], 2) ^ rotated(w[0], 13) ^ rotated(w[0], 22)) + most;
        (void)memmove(w + 1, w, 7u * sizeof *w);
        w[4] += first;
        w[0] = first + second;
    }
    for (unsigned int i = 0; i < 8u; ++i) hash->words[i] += w[i];
}

static void hash_byte(Hash *hash, unsigned char byte) {
    hash->block[hash->bytes++ % 64u] = byte;
    if (hash->bytes % 64u == 0) hash_block(hash);
}

/* A number is 8 bytes, the lowest first. */
static void hash_number(Hash *hash, double number) {
    uint64_t bits = 0;
    (void)memcpy(&bits, &number, sizeof bits);
    for (unsigned int i = 0; i < 8u; ++i) hash_byte(hash, (unsigned char)((bits >> (8u * i)) & 0xffu));
}

static void hash_print(Hash *hash) {
    const uint64_t bits = 8u * hash->bytes;
    hash_byte(hash, 0x80);
    while (hash->bytes % 64u != 56u) hash_byte(hash, 0);
    for (unsigned int i = 0; i < 8u; ++i) hash_byte(hash, (unsigned char)((bits >> (56u - 8u * i)) & 0xffu));
    for (unsigned int i = 0; i < 8u; ++i) (void)printf("%08lx", (unsigned long)hash->words[i]);
    (void)printf("\n");
}

#endif
