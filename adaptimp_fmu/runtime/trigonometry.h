/* sin, cos and tan. The argument is reduced to [-pi/4, pi/4] by a multiple of pi/2. */
#ifndef TRIGONOMETRY_H
#define TRIGONOMETRY_H

/* An angle is quadrant * pi/2 + rest. */
typedef struct {
    Pair rest;
    unsigned quadrant; /* modulo 4 */
} Angle;

typedef struct {
    double sin, cos;
} SinCos;

#define LARGE_ANGLE 0x1.921fb5p20 /* 2^20 pi/2 */
#define ROUND_TO_INTEGER 0x1.8p52 /* added and subtracted, it rounds numbers below 2^51 */

/* 64 bits of 2/pi from the bit on that stands for 2^-(first + 1); those before the point are zero. */
static inline uint64_t bits_of_two_over_pi(int first) {
    const int word = first >= 0 ? first / 64 : -1, shift = first >= 0 ? first % 64 : 64 + first;
    const uint64_t here = word < 0 ? 0 : two_over_pi_bits[word], next = two_over_pi_bits[word + 1];
    return shift == 0 ? here : (here << shift) | (next >> (64 - shift));
}

/* Reduces finite angles from LARGE_ANGLE on with integers (M. Payne and R. Hanek, "Radian reduction for trigonometric
 * functions", SIGNUM Newsletter 18, 1983). x = m 2^e; the bits of 2/pi that make multiples of 4 in
 * m 2^e 2/pi are left out, and 192 bits from there on leave more than 70 behind the closest that a
 * double comes to a multiple of pi/2. */
static inline Angle reduce_large_angle(double x) {
    int exponent;
    const uint64_t m = real_integer(real_fabs(x), &exponent);
    const int first = exponent - 2;
    const uint64_t upper = bits_of_two_over_pi(first), middle = bits_of_two_over_pi(first + 64);
    const uint64_t lower = bits_of_two_over_pi(first + 128);
    uint64_t words[3], sign;
    int zeros = 0;
    double scale;
    Pair fraction, half_pi = {PI_HALF_HIGH, PI_HALF_LOW};
    Angle angle;
    words[2] = m * lower;
    words[1] = m * middle + upper_product(m, lower);
    words[0] = m * upper + upper_product(m, middle) + (words[1] < m * middle);
    /* words / 2^192 is the fraction of x 2/pi / 4; its nearest quarter is the quadrant. */
    angle.quadrant = (unsigned)((words[0] + ((uint64_t)1 << 61)) >> 62) & 3u;
    words[0] -= (uint64_t)angle.quadrant << 62;
    sign = words[0] >> 63;
    if (sign) {
        words[0] = ~words[0];
        words[1] = ~words[1];
        words[2] = ~words[2]; /* one unit of 2^-190 too small */
    }
    while (zeros < 127 && !(words[0] >> 63)) {
        words[0] = (words[0] << 1) | (words[1] >> 63);
        words[1] = (words[1] << 1) | (words[2] >> 63);
        words[2] <<= 1;
        ++zeros;
    }
    /* 53 and 53 bits */
    scale = real_power_of_2(-zeros - 51);
    fraction.high = (double)(words[0] >> 11) * scale;
    fraction.low = (double)(((words[0] & 0x7ffu) << 42) | (words[1] >> 22)) * (scale * 0x1p-53);
    angle.rest = pair_product(pair_of_ordered_sum(fraction.high, fraction.low), half_pi);
    if ((sign != 0) != real_is_negative(x)) angle.rest = pair_negative(angle.rest);
    if (real_is_negative(x)) angle.quadrant = (4 - angle.quadrant) & 3u;
    return angle;
}

/* Reduces angles below LARGE_ANGLE (W. J. Cody and W. Waite, "Software manual for the elementary
 * functions", 1980): products of a multiple below 2^20 and of parts of pi/2 with 33 bits are exact. */
static inline Angle reduce_angle(double x) {
    const double multiple = (x * TWO_OVER_PI + ROUND_TO_INTEGER) - ROUND_TO_INTEGER;
    Pair rest = pair_of_sum(x - multiple * PI_HALF_1, -(multiple * PI_HALF_2));
    Angle angle;
    if (real_fabs(rest.high) > 0x1p-20 && real_fabs(multiple) < 256) { /* the third part is small beside the low one */
        rest.low -= multiple * (PI_HALF_3 + PI_HALF_4);
    } else {
        const Pair closer = pair_of_sum(rest.high, -(multiple * PI_HALF_3));
        rest = pair_of_ordered_sum(closer.high, closer.low + (rest.low - multiple * PI_HALF_4));
    }
    angle.rest = rest;
    angle.quadrant = (unsigned)(int32_t)multiple & 3u;
    return angle;
}

static inline Angle reduced_angle(double x) {
    const double size = real_fabs(x);
    if (size <= 0x1.921fb54442d18p-1) {
        Angle angle;
        angle.rest.high = x;
        angle.rest.low = 0;
        angle.quadrant = 0;
        return angle;
    }
    return size < LARGE_ANGLE ? reduce_angle(x) : reduce_large_angle(x);
}

/* (sin(x)/x - 1)/x^2 and (cos(x) - 1 + x^2/2)/x^4 for z = x^2. */
static inline double sin_polynomial(double z) {
    const double *c = sin_terms, zz = z * z;
    return (c[0] + z * c[1]) + zz * ((c[2] + z * c[3]) + zz * (c[4] + z * c[5]));
}

static inline double cos_polynomial(double z) {
    const double *c = cos_terms, zz = z * z;
    return (c[0] + z * c[1]) + zz * ((c[2] + z * c[3]) + zz * (c[4] + z * c[5]));
}

static inline double sin_of_rest(Pair x, double z) {
    return x.high + (x.low * (1 - 0.5 * z) + (x.high * z) * sin_polynomial(z));
}

static inline double cos_of_rest(Pair x, double z) {
    const double half = 0.5 * z, most = 1 - half;
    return most + (((1 - most) - half) + (z * z * cos_polynomial(z) - x.high * x.low));
}

/* Sine and cosine of one angle, from one reduction. */
static inline SinCos real_sincos(double x) {
    SinCos both;
    Angle angle;
    double z, sine, cosine;
    if (!real_is_finite(x)) {
        both.sin = both.cos = real_nan();
        return both;
    }
    if (real_fabs(x) < 0x1p-27) {
        both.sin = x;
        both.cos = 1;
        return both;
    }
    angle = reduced_angle(x);
    z = angle.rest.high * angle.rest.high;
    sine = sin_of_rest(angle.rest, z);
    cosine = cos_of_rest(angle.rest, z);
    switch (angle.quadrant) {
    case 0: both.sin = sine, both.cos = cosine; break;
    case 1: both.sin = cosine, both.cos = -sine; break;
    case 2: both.sin = -sine, both.cos = -cosine; break;
    default: both.sin = -cosine, both.cos = sine;
    }
    return both;
}

static inline double real_sin(double x) { return real_sincos(x).sin; }

static inline double real_cos(double x) { return real_sincos(x).cos; }

/* The quotient of sine and cosine, each with the bits behind a double's. */
static inline double real_tan(double x) {
    Angle angle;
    Pair square, sine, cosine;
    double z, half, most;
    if (!real_is_finite(x)) return real_nan();
    if (real_fabs(x) < 0x1p-27) return x;
    angle = reduced_angle(x);
    square = pair_of_product(angle.rest.high, angle.rest.high);
    square.low += 2 * angle.rest.high * angle.rest.low;
    z = square.high;
    half = 0.5 * z;
    most = 1 - half;
    cosine = pair_of_ordered_sum(most, ((1 - most) - half) - 0.5 * square.low + z * z * cos_polynomial(z));
    sine = pair_of_ordered_sum(angle.rest.high, angle.rest.high * (z * sin_polynomial(z) - square.low / 6) +
                                                    angle.rest.low * (1 - z / 6));
    if (angle.quadrant & 1u) sine = pair_negative(sine);
    return angle.quadrant & 1u ? pair_quotient(cosine, sine).high : pair_quotient(sine, cosine).high;
}

#endif
