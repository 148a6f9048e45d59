/* exp, expm1, tanh, sinh and cosh. */
#ifndef EXPONENTIAL_H
#define EXPONENTIAL_H

/* exp(x) = 2^exponent (power + power_low) (1 + rest + terms), where the power is one of 2^(i/32). */
typedef struct {
    double power, power_low, rest, terms;
    int exponent;
} Exponential;

/* The parts of exp(x) for |x| < 750. */
static inline Exponential exp_parts(double x) {
    const double steps = (x * EXP_PER_STEP + ROUND_TO_INTEGER) - ROUND_TO_INTEGER;
    const double first = x - steps * EXP_STEP_1, second = steps * EXP_STEP_2, *c = exp_terms;
    const int whole = (int)steps, i = (int)((unsigned)whole % EXP_ENTRIES);
    Exponential parts;
    double r, rr;
    parts.rest = r = first - second;
    rr = r * r;
    parts.terms = ((first - r) - second) + rr * ((c[0] + r * c[1]) + rr * ((c[2] + r * c[3]) + rr * c[4]));
    parts.power = exp_powers[i][0];
    parts.power_low = exp_powers[i][1];
    parts.exponent = (whole - i) / EXP_ENTRIES;
    return parts;
}

/* x 2^n for 1/2 < x <= 2; faster where nothing can overflow or underflow. */
static inline double exp_scaled(double x, int n) {
    return n >= -1020 && n <= 1020 ? x * real_power_of_2(n) : real_scaled(x, n);
}

static inline double real_exp(double x) {
    Exponential e;
    if (!(real_fabs(x) < 746)) return real_is_nan(x) ? real_nan() : x > 0 ? REAL_INFINITY : 0;
    e = exp_parts(x);
    return exp_scaled(e.power + (e.power * (e.rest + e.terms) + e.power_low), e.exponent);
}

/* exp(x) for |x| < 60, with bits behind a double's. */
static inline Pair exp_pair(double x) {
    const Exponential e = exp_parts(x);
    const double scale = real_power_of_2(e.exponent);
    return pair_of_ordered_sum(e.power * scale, (e.power * (e.rest + e.terms) + e.power_low) * scale);
}

static inline double real_expm1(double x) {
    Exponential e;
    Pair sum;
    double scale, power;
    if (real_fabs(x) < 0x1p-54) return x;
    if (x < -40) return -1;
    if (!(x < 58)) return real_exp(x);
    e = exp_parts(x);
    scale = real_power_of_2(e.exponent);
    power = e.power * scale;
    if (power > 0.7 && power < 1.42) { /* power - 1 is exact, and nothing large cancels */
        sum = pair_of_sum(power - 1, e.rest);
        return sum.high + (sum.low + ((power - 1) * e.rest + power * e.terms + e.power_low * scale));
    }
    sum = pair_of_sum(power, -1);
    return sum.high + (sum.low + (power * (e.rest + e.terms) + e.power_low * scale));
}

/* (tanh(x)/x - 1)/z for z = x^2. */
static inline double tanh_polynomial(double z) {
    const double *c = tanh_terms, zz = z * z, z4 = zz * zz;
    const double low = (c[0] + z * c[1]) + zz * (c[2] + z * c[3]);
    const double middle = (c[4] + z * c[5]) + zz * (c[6] + z * c[7]);
    const double high = (c[8] + z * c[9]) + zz * c[10];
    return low + z4 * (middle + z4 * high);
}

/* 1 - 2/(exp(2 x) + 1) from 0.55 on, where the quotient is below 1/2. */
static inline double real_tanh(double x) {
    const double size = real_fabs(x);
    Pair below, sum;
    double quotient;
    if (size < 0x1p-28) return x;
    if (size < 0.55) return x + x * (x * x * tanh_polynomial(x * x));
    if (!(size < 20)) return real_is_nan(x) ? real_nan() : real_copysign(1, x);
    below = exp_pair(2 * size);
    sum = pair_of_ordered_sum(below.high, 1);
    below = pair_of_ordered_sum(sum.high, sum.low + below.low);
    quotient = 2 / below.high;
    sum = pair_of_ordered_sum(1, -quotient);
    return real_copysign(sum.high + (sum.low + 0.5 * quotient * quotient * below.low), x);
}

/* exp(x)/2 from 40 on, where exp(-x) is nothing beside exp(x). */
static inline double half_exp(double x) {
    Exponential e;
    if (x > 711) return REAL_INFINITY;
    e = exp_parts(x);
    return exp_scaled(e.power + (e.power * (e.rest + e.terms) + e.power_low), e.exponent - 1);
}

static inline double real_sinh(double x) {
    const double size = real_fabs(x), *c = sinh_terms;
    const Pair one = {1, 0};
    Pair power, twice;
    if (real_is_nan(x)) return real_nan();
    if (size < 0x1p-28) return x;
    if (size < 0.35) {
        const double z = x * x;
        return x + x * (z * (c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))))));
    }
    if (!(size < 40)) return real_copysign(half_exp(size), x);
    power = exp_pair(size);
    twice = pair_sum(power, pair_negative(pair_quotient(one, power)));
    return real_copysign(0.5 * twice.high, x);
}

static inline double real_cosh(double x) {
    const double size = real_fabs(x);
    const Pair one = {1, 0};
    Pair power;
    if (real_is_nan(x)) return real_nan();
    if (!(size < 40)) return half_exp(size);
    power = exp_pair(size);
    return 0.5 * pair_sum(power, pair_quotient(one, power)).high;
}

#endif
