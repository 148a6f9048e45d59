/* Philox4x64-10, the counter-based generator of Salmon, Moraes, Dror and Shaw, "Parallel random
 * numbers: as easy as 1, 2, 3", SC'11; the same bits as numpy.random.Philox.
 * Written without 128-bit integers, so that any C11 compiler builds it. */
#ifndef PHILOX_H
#define PHILOX_H

#include <stdint.h>

#include "real_numbers.h"

/* The block of counter (counter, 0, 0, 0) under key (key, 0). */
static void philox4x64(uint64_t counter, uint64_t key, uint64_t block[4]) {
    const uint64_t m0 = 0xD2E7470EE14C6C93u, m1 = 0xCA5A826395121157u;
    uint64_t x0 = counter, x1 = 0, x2 = 0, x3 = 0, k0 = key, k1 = 0;
    for (int round = 0; round < 10; ++round) {
        const uint64_t high0 = upper_product(m0, x0), low0 = m0 * x0;
        const uint64_t high1 = upper_product(m1, x2), low1 = m1 * x2;
        x0 = high1 ^ x1 ^ k0;
        x1 = low1;
        x2 = high0 ^ x3 ^ k1;
        x3 = low0;
        k0 += 0x9E3779B97F4A7C15u;
        k1 += 0xBB67AE8584CAA73Bu;
    }
    block[0] = x0, block[1] = x1, block[2] = x2, block[3] = x3;
}

/* A number in (0, 1), never an end of it, from the upper 53 bits of a word. */
static double uniform(uint64_t word) { return ((double)(word >> 11) + 0.5) * 0x1p-53; }

#endif
