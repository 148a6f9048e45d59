/* atan, atan2, asin and acos. */
#ifndef INVERSE_TRIGONOMETRY_H
#define INVERSE_TRIGONOMETRY_H

static const Pair pair_half_pi = {PI_HALF_HIGH, PI_HALF_LOW};
static const Pair pair_pi = {2 * PI_HALF_HIGH, 2 * PI_HALF_LOW};

/* atan(q) for 0 <= q <= 1: atan(c) + atan((q - c)/(1 + q c)) for the nearest sixteenth c. */
static inline Pair atan_of_ratio(Pair q) {
    const int i = (int)(q.high * 16 + 0.5);
    const double centre = i / 16.0, *c = atan_terms;
    Pair rest = q, angle;
    double z, terms;
    if (i > 0) {
        const Pair product = pair_of_product(q.high, centre);
        Pair below = pair_of_sum(1, product.high);
        below.low += product.low + q.low * centre;
        rest = pair_quotient(pair_of_sum(q.high - centre, q.low), below);
    }
    z = rest.high * rest.high;
    terms = rest.high * (z * (c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * c[4])))));
    angle = pair_of_sum(atan_values[i][0], rest.high);
    return pair_of_ordered_sum(angle.high, angle.low + (terms + (rest.low + atan_values[i][1])));
}

/* atan(y/x) for positive numbers of similar size. */
static inline Pair atan_of_quotient(double y, double x) {
    const Pair first = {y, 0}, second = {x, 0};
    if (y <= x) return atan_of_ratio(pair_quotient(first, second));
    return pair_sum(pair_half_pi, pair_negative(atan_of_ratio(pair_quotient(second, first))));
}

static inline double real_atan(double x) {
    const double size = real_fabs(x);
    if (real_is_nan(x)) return real_nan();
    if (size < 0x1p-27) return x;
    return real_copysign(size > 0x1p60 ? PI_HALF_HIGH : atan_of_quotient(size, 1).high, x);
}

/* The angle of (x, y) for y > 0 and x not zero, both finite. */
static inline double atan2_of_finite(double y, double x) {
    double y_part, x_part;
    const int exponent = real_exponent(y, &y_part) - real_exponent(real_fabs(x), &x_part);
    if (exponent > 60) return PI_HALF_HIGH;
    if (exponent < -60 && x < 0) return pair_pi.high;
    if (exponent < -60) return exponent < -1080 ? 0 : real_scaled(y_part / x_part, exponent);
    y_part = real_scaled(y_part, exponent);
    if (x > 0) return atan_of_quotient(y_part, x_part).high;
    return pair_sum(pair_pi, pair_negative(atan_of_quotient(y_part, x_part))).high;
}

static inline double real_atan2(double y, double x) {
    const double height = real_fabs(y), width = real_fabs(x);
    double angle;
    if (real_is_nan(x) || real_is_nan(y)) return real_nan();
    if (y == 0 || (width > DBL_MAX && height <= DBL_MAX))
        angle = real_is_negative(x) ? pair_pi.high : 0;
    else if (height > DBL_MAX && width > DBL_MAX)
        angle = real_is_negative(x) ? 0x1.2d97c7f3321d2p+1 : 0.5 * PI_HALF_HIGH; /* 3 pi/4 */
    else if (x == 0 || height > DBL_MAX)
        angle = PI_HALF_HIGH;
    else
        angle = atan2_of_finite(height, x);
    return real_copysign(angle, y);
}

/* asin(x)/x - 1 for z = x^2 <= 1/4. */
static inline double asin_polynomial(double z) {
    double sum = 0;
    for (int i = (int)(sizeof asin_terms / sizeof *asin_terms) - 1; i >= 0; --i) sum = asin_terms[i] + z * sum;
    return z * sum;
}

/* asin(sqrt((1 - x)/2)), which is acos(x)/2, for 1/2 <= x <= 1. */
static inline Pair half_acos(double x) {
    const Pair square = {0.5 * (1 - x), 0}, root = pair_root(square);
    return pair_of_ordered_sum(root.high, root.low + root.high * asin_polynomial(square.high));
}

static inline double real_asin(double x) {
    const double size = real_fabs(x);
    Pair twice;
    if (!(size <= 1)) return real_nan();
    if (size < 0x1p-27) return x;
    if (size <= 0.5) return x + x * asin_polynomial(x * x);
    twice = half_acos(size);
    twice.high *= -2;
    twice.low *= -2;
    return real_copysign(pair_sum(pair_half_pi, twice).high, x);
}

static inline double real_acos(double x) {
    const double size = real_fabs(x);
    Pair part;
    if (!(size <= 1)) return real_nan();
    if (size <= 0.5) {
        part = pair_of_ordered_sum(-x, -x * asin_polynomial(x * x));
        return pair_sum(pair_half_pi, part).high;
    }
    part = half_acos(size);
    part.high *= 2;
    part.low *= 2;
    return x > 0 ? part.high : pair_sum(pair_pi, pair_negative(part)).high;
}

#endif
