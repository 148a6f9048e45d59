/* log, log1p, asinh, acosh, atanh, pow and hypot. */
#ifndef LOGARITHM_H
#define LOGARITHM_H

/* log(x) = sum of whole, whole_low, rest and -rest^2/2 + terms. */
typedef struct {
    Pair rest;
    double whole, whole_low, terms;
} Logarithm;

/* The parts of log(x + low) for a positive finite x and a low that is small beside it. x = 2^k m, and m r is
 * near 1 for a number r of the table: log(x) = k log(2) - log(r) + log(m r). The product m r - 1 is exact. */
static inline Logarithm log_parts(double x, double low) {
    double m, upper, r;
    const int exponent = real_exponent(x, &m);
    const int i = (int)((real_bits(m) & REAL_FRACTION) >> 45), k = exponent + (i >= LOG_TURN);
    const double *row = log_rows[i], *c = log_terms;
    Logarithm parts;
    upper = real_of_bits(real_bits(m) & ~(uint64_t)0x7ffffff);
    parts.rest = pair_of_sum(upper * row[0] - 1, (m - upper) * row[0]);
    if (low != 0) parts.rest = pair_of_sum(parts.rest.high, parts.rest.low + low * real_power_of_2(-exponent) * row[0]);
    parts.whole = k * LOG_2_HIGH + row[1];
    parts.whole_low = k * LOG_2_LOW + row[2];
    r = parts.rest.high;
    parts.terms = r * r * r * ((c[0] + r * c[1]) + r * r * ((c[2] + r * c[3]) + r * r * (c[4] + r * c[5])));
    return parts;
}

/* log(x + low) with about 15 bits behind a double's. */
static inline Pair log_pair(double x, double low) {
    const Logarithm parts = log_parts(x, low);
    const Pair r = parts.rest, square = pair_of_product(r.high, r.high);
    const Pair sum = pair_of_sum(parts.whole, r.high), next = pair_of_sum(sum.high, -0.5 * square.high);
    const double behind = (r.low - r.high * r.low - 0.5 * square.low) + parts.terms + parts.whole_low;
    return pair_of_ordered_sum(next.high, sum.low + next.low + behind);
}

static inline double real_log(double x) {
    Logarithm parts;
    Pair sum;
    if (!(x > 0 && x <= DBL_MAX)) return x == 0 ? -REAL_INFINITY : x > 0 ? x : real_nan();
    parts = log_parts(x, 0);
    sum = pair_of_sum(parts.whole, parts.rest.high);
    sum.low += parts.rest.low + (parts.whole_low + (parts.terms - 0.5 * parts.rest.high * parts.rest.high));
    return sum.high + sum.low;
}

static inline double real_log1p(double x) {
    const Pair sum = pair_of_sum(1, x);
    if (real_fabs(x) < 0x1p-54) return x;
    if (x > 0x1p100) return real_log(x);
    return x > -1 ? log_pair(sum.high, sum.low).high : x == -1 ? -REAL_INFINITY : real_nan();
}

static inline double real_asinh(double x) {
    const double size = real_fabs(x), z = x * x;
    const Pair one = {1, 0};
    Pair root, sum;
    if (real_is_nan(x)) return real_nan();
    if (size < 0x1p-28 || size > DBL_MAX) return x;
    if (size < 0x1p-10) return x + x * (z * (-1.0 / 6 + z * (3.0 / 40 + z * (-15.0 / 336 + z * (105.0 / 3456)))));
    if (size > 0x1p30) {
        const Pair two = {LOG_2_HIGH, LOG_2_LOW};
        return real_copysign(pair_sum(log_pair(size, 0), two).high, x);
    }
    root = pair_root(pair_sum(pair_of_product(size, size), one));
    sum = pair_of_sum(root.high, size);
    sum = pair_of_ordered_sum(sum.high, sum.low + root.low);
    return real_copysign(log_pair(sum.high, sum.low).high, x);
}

static inline double real_acosh(double x) {
    Pair root, sum;
    if (!(x >= 1)) return real_nan();
    if (x > DBL_MAX) return x;
    if (x > 0x1p30) {
        const Pair two = {LOG_2_HIGH, LOG_2_LOW};
        return pair_sum(log_pair(x, 0), two).high;
    }
    sum.high = x - 1;
    sum.low = 0;
    root = pair_root(pair_product(sum, pair_of_sum(x, 1)));
    sum = pair_of_sum(x, root.high);
    sum = pair_of_ordered_sum(sum.high, sum.low + root.low);
    return log_pair(sum.high, sum.low).high;
}

static inline double real_atanh(double x) {
    const double size = real_fabs(x), z = x * x;
    Pair quotient;
    if (!(size <= 1)) return real_nan();
    if (size == 1) return real_copysign(REAL_INFINITY, x);
    if (size < 0x1p-28) return x;
    if (size < 0x1p-10) return x + x * (z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * (1.0 / 9)))));
    quotient = pair_quotient(pair_of_sum(1, size), pair_of_sum(1, -size));
    return real_copysign(0.5 * log_pair(quotient.high, quotient.low).high, x);
}

/* 0: no integer, 1: an odd one, 2: an even one. */
static inline int real_parity(double x) {
    const double size = real_fabs(x);
    if (!(size < 0x1p53)) return 2;
    if (size != (double)(int64_t)size) return 0;
    return (int64_t)size & 1 ? 1 : 2;
}

/* x^y for finite positive x and finite y. */
static inline double pow_of_positive(double x, double y) {
    Pair logarithm, power;
    Exponential e;
    if (x == 1) return 1;
    if (real_fabs(y) < 0x1p-65) return 1;
    if (real_fabs(y) > 0x1p65) return (x > 1) == (y > 0) ? REAL_INFINITY : 0;
    logarithm = log_pair(x, 0);
    power = pair_of_product(y, logarithm.high);
    power = pair_of_ordered_sum(power.high, power.low + y * logarithm.low);
    if (!(real_fabs(power.high) < 746)) return power.high > 0 ? REAL_INFINITY : 0;
    e = exp_parts(power.high);
    e.terms += power.low * (1 + e.rest);
    return exp_scaled(e.power + (e.power * (e.rest + e.terms) + e.power_low), e.exponent);
}

static inline double real_pow(double x, double y) {
    const double size = real_fabs(x);
    const int parity = real_parity(y);
    double power;
    if (y == 0 || x == 1) return 1;
    if (real_is_nan(x) || real_is_nan(y)) return real_nan();
    if (!real_is_finite(y)) {
        if (size == 1) return 1;
        return (size > 1) == (y > 0) ? REAL_INFINITY : 0;
    }
    if (size == 0 || size > DBL_MAX)
        power = (size == 0) == (y < 0) ? REAL_INFINITY : 0;
    else if (x < 0 && parity == 0)
        return real_nan();
    else
        power = pow_of_positive(size, y);
    return parity == 1 && real_is_negative(x) ? -power : power;
}

/* sqrt(x^2 + y^2), which overflows only if the result does. */
static inline double real_hypot(double x, double y) {
    const double x_size = real_fabs(x), y_size = real_fabs(y);
    const double larger = x_size > y_size ? x_size : y_size, smaller = x_size > y_size ? y_size : x_size;
    double larger_part, smaller_part;
    int exponent;
    Pair squares;
    if (x_size > DBL_MAX || y_size > DBL_MAX) return REAL_INFINITY;
    if (real_is_nan(x) || real_is_nan(y)) return real_nan();
    if (smaller <= larger * 0x1p-60) return larger;
    exponent = real_exponent(larger, &larger_part);
    smaller_part = real_scaled(smaller, -exponent);
    squares = pair_sum(pair_of_product(larger_part, larger_part), pair_of_product(smaller_part, smaller_part));
    return real_scaled(pair_root(squares).high, exponent);
}

#endif
