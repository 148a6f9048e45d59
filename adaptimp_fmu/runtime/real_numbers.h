/* Doubles as bits: signs, rounding to integers, extremes, square root, remainders. All results are exact,
 * or correctly rounded. */
#ifndef REAL_NUMBERS_H
#define REAL_NUMBERS_H

#include <float.h>
#include <stdint.h>

#if defined(__GNUC__)
#define REAL_INFINITY __builtin_inf()
#else
#define REAL_INFINITY (DBL_MAX * 10)
#endif

#define REAL_SIGN 0x8000000000000000u
#define REAL_FRACTION 0x000fffffffffffffu
#define REAL_ONE 0x3ff0000000000000u

typedef union {
    double number;
    uint64_t bits;
} RealBits;

static inline uint64_t real_bits(double x) {
    RealBits both;
    both.number = x;
    return both.bits;
}

static inline double real_of_bits(uint64_t bits) {
    RealBits both;
    both.bits = bits;
    return both.number;
}

/* The upper 64 bits of a product, without 128-bit integers, so that any C11 compiler builds it. */
static inline uint64_t upper_product(uint64_t a, uint64_t b) {
    const uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    uint64_t middle = a1 * b0 + ((a0 * b0) >> 32);
#if defined(__wasm__) && defined(__clang__)
    /* Else clang sees a product of 128 bits here, which is a call of its library on WebAssembly. */
    __asm__("" : "+r"(middle));
#endif
    const uint64_t carry = a0 * b1 + (uint32_t)middle;
    return a1 * b1 + (middle >> 32) + (carry >> 32);
}

/* The NaN that functions return. */
static inline double real_nan(void) { return real_of_bits(0x7ff8000000000000u); }

static inline double real_fabs(double x) { return real_of_bits(real_bits(x) & ~REAL_SIGN); }

static inline int real_is_negative(double x) { return (real_bits(x) >> 63) != 0; }

static inline int real_is_nan(double x) { return x != x; }

static inline int real_is_finite(double x) { return real_fabs(x) <= DBL_MAX; }

static inline double real_copysign(double x, double sign) {
    return real_of_bits((real_bits(x) & ~REAL_SIGN) | (real_bits(sign) & REAL_SIGN));
}

/* The larger number; a number rather than NaN; +0 rather than -0. One comparison tells most cases. */
static inline double real_fmax(double x, double y) {
    if (x < y || x > y) return x > y ? x : y;
    if (x == y) return real_of_bits(real_bits(x) & real_bits(y));
    return real_is_nan(y) ? x : y;
}

/* The smaller number; a number rather than NaN; -0 rather than +0. */
static inline double real_fmin(double x, double y) {
    if (x < y || x > y) return x < y ? x : y;
    if (x == y) return real_of_bits(real_bits(x) | real_bits(y));
    return real_is_nan(y) ? x : y;
}

/* From 2^52 on each double is an integer. Zero keeps the sign of the argument. */
static inline double real_floor(double x) {
    double whole;
    if (real_is_nan(x)) return real_nan();
    if (!(real_fabs(x) < 0x1p52)) return x;
    whole = (double)(int64_t)x;
    return real_copysign(whole > x ? whole - 1 : whole, x);
}

static inline double real_ceil(double x) { return real_is_nan(x) ? real_nan() : -real_floor(-x); }

/* 2^n for -1022 <= n <= 1023. */
static inline double real_power_of_2(int n) { return real_of_bits((uint64_t)(n + 1023) << 52); }

/* x 2^n, rounded once, for |n| <= 2044 and x that is no subnormal. */
static inline double real_scaled(double x, int n) {
    const int half = n / 2;
    return x * real_power_of_2(half) * real_power_of_2(n - half);
}

/* The exponent of a positive finite number, whose significand in [1, 2) is stored. */
static inline int real_exponent(double x, double *significand) {
    uint64_t bits = real_bits(x);
    int shift = 1023;
    if (x < DBL_MIN) {
        bits = real_bits(x * 0x1p54);
        shift += 54;
    }
    *significand = real_of_bits((bits & REAL_FRACTION) | REAL_ONE);
    return (int)(bits >> 52) - shift;
}

/* The correctly rounded root of a positive finite number, two bits of the radicand at a time: for
 * processors without an instruction for it. A root is never half way between two doubles. */
static inline double real_sqrt_of_integers(double x) {
    double significand;
    const int exponent = real_exponent(x, &significand), odd = exponent & 1;
    const uint64_t radicand = ((real_bits(significand) & REAL_FRACTION) | (REAL_FRACTION + 1)) << odd;
    uint64_t root = 0, rest = 0;
    for (int pair = 26; pair >= -27; --pair) {
        const uint64_t next = pair >= 0 ? (radicand >> (2 * pair)) & 3u : 0;
        const uint64_t trial = (root << 2) | 1u;
        rest = (rest << 2) | next;
        root <<= 1;
        if (rest >= trial) {
            rest -= trial;
            root |= 1u;
        }
    }
    return (double)((root + 1) >> 1) * real_power_of_2((exponent - odd) / 2 - 52);
}

#if defined(__has_builtin)
#if __has_builtin(__builtin_elementwise_sqrt) && (defined(__x86_64__) || defined(__aarch64__) || defined(__wasm__))
#define REAL_SQRT(x) __builtin_elementwise_sqrt(x)
#endif
#endif
#if !defined(REAL_SQRT) && defined(__GNUC__) && defined(__x86_64__)
typedef double RealVector __attribute__((vector_size(16)));
static inline double real_sqrt_of_processor(double x) {
    double root;
    __asm__("sqrtsd %1, %0" : "=x"(root) : "x"(x));
    return root;
}
#define REAL_SQRT(x) real_sqrt_of_processor(x)
#endif
#if !defined(REAL_SQRT) && defined(__GNUC__) && defined(__aarch64__)
static inline double real_sqrt_of_processor(double x) {
    double root;
    __asm__("fsqrt %d0, %d1" : "=w"(root) : "w"(x));
    return root;
}
#define REAL_SQRT(x) real_sqrt_of_processor(x)
#endif
#if !defined(REAL_SQRT)
#define REAL_SQRT(x) real_sqrt_of_integers(x)
#endif

static inline double real_sqrt(double x) {
    if (x > 0 && x <= DBL_MAX) return REAL_SQRT(x);
    return x == 0 || x > 0 ? x : real_nan();
}

/* The significand of a positive finite number as an integer m, and the exponent e of x = m 2^e. */
static inline uint64_t real_integer(double x, int *exponent) {
    const uint64_t bits = real_bits(x);
    const int stored = (int)(bits >> 52);
    *exponent = (stored ? stored : 1) - 1075;
    return (bits & REAL_FRACTION) | (stored ? REAL_FRACTION + 1 : 0);
}

/* An integer of at most 53 bits times 2^exponent, which is a double. */
static inline double real_of_integer(uint64_t m, int exponent) {
    return exponent < -1022 ? (double)m * 0x1p-1022 * real_power_of_2(exponent + 1022)
                            : (double)m * real_power_of_2(exponent);
}

/* |x| modulo |y| for finite numbers, y not zero, and whether the quotient is odd. */
static inline double real_modulo(double x, double y, int *odd) {
    int x_exponent, y_exponent, left;
    uint64_t rest, divisor;
    *odd = 0;
    if (real_fabs(x) < real_fabs(y)) return real_fabs(x);
    rest = real_integer(real_fabs(x), &x_exponent);
    divisor = real_integer(real_fabs(y), &y_exponent);
    left = x_exponent - y_exponent;
    *odd = (int)(rest / divisor & 1u);
    rest %= divisor;
    while (left > 0) {
        const int shift = left < 11 ? left : 11;
        rest <<= shift;
        *odd = (int)(rest / divisor & 1u);
        rest %= divisor;
        left -= shift;
    }
    return real_of_integer(rest, y_exponent);
}

/* x - n y with n = x/y truncated; the sign is that of x. */
static inline double real_fmod(double x, double y) {
    int odd;
    if (!real_is_finite(x) || real_is_nan(y) || y == 0) return real_nan();
    if (!real_is_finite(y)) return x;
    return real_copysign(real_modulo(x, y, &odd), x);
}

/* x - n y with n = x/y rounded to the nearest integer, an even one between two. */
static inline double real_remainder(double x, double y) {
    int odd;
    double rest, other;
    if (!real_is_finite(x) || real_is_nan(y) || y == 0) return real_nan();
    if (!real_is_finite(y)) return x;
    rest = real_modulo(x, y, &odd);
    other = real_fabs(y) - rest;
    if (rest > other || (rest == other && odd)) rest = -other;
    return real_is_negative(x) ? -rest : rest;
}

#endif
