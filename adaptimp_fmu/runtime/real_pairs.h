/* Numbers of about 106 bits: sums of two doubles. What T. J. Dekker, "A floating-point technique for
 * extending the available precision", Numerische Mathematik 18 (1971), and D. E. Knuth, "The art of
 * computer programming", volume 2, 4.2.2, found about the errors of sums and products. */
#ifndef REAL_PAIRS_H
#define REAL_PAIRS_H

/* high + low, where high is the sum rounded to a double. */
typedef struct {
    double high, low;
} Pair;

/* x + y, exactly, for |x| >= |y| or x = 0. */
static inline Pair pair_of_ordered_sum(double x, double y) {
    Pair sum;
    sum.high = x + y;
    sum.low = y - (sum.high - x);
    return sum;
}

/* x + y, exactly. */
static inline Pair pair_of_sum(double x, double y) {
    Pair sum;
    double rounded;
    sum.high = x + y;
    rounded = sum.high - x;
    sum.low = (x - (sum.high - rounded)) + (y - rounded);
    return sum;
}

/* The upper 26 bits of a number below 2^996. */
static inline double upper_half(double x) {
    const double scaled = 134217729.0 * x;
    return scaled - (scaled - x);
}

/* x y, exactly, if nothing overflows or underflows. */
static inline Pair pair_of_product(double x, double y) {
    const double x_high = upper_half(x), x_low = x - x_high;
    const double y_high = upper_half(y), y_low = y - y_high;
    Pair product;
    product.high = x * y;
    product.low = ((x_high * y_high - product.high) + x_high * y_low + x_low * y_high) + x_low * y_low;
    return product;
}

static inline Pair pair_sum(Pair x, Pair y) {
    const Pair high = pair_of_sum(x.high, y.high);
    return pair_of_ordered_sum(high.high, high.low + (x.low + y.low));
}

static inline Pair pair_negative(Pair x) {
    x.high = -x.high;
    x.low = -x.low;
    return x;
}

static inline Pair pair_product(Pair x, Pair y) {
    const Pair high = pair_of_product(x.high, y.high);
    return pair_of_ordered_sum(high.high, high.low + (x.high * y.low + x.low * y.high));
}

static inline Pair pair_quotient(Pair x, Pair y) {
    const double quotient = x.high / y.high;
    const Pair product = pair_of_product(quotient, y.high);
    const double rest = ((x.high - product.high) - product.low) + (x.low - quotient * y.low);
    return pair_of_ordered_sum(quotient, rest / y.high);
}

/* The square root of a pair that is not negative. */
static inline Pair pair_root(Pair x) {
    const double root = real_sqrt(x.high);
    const Pair square = pair_of_product(root, root);
    if (!(root > 0)) return pair_of_ordered_sum(0, 0);
    return pair_of_ordered_sum(root, (((x.high - square.high) - square.low) + x.low) / (2 * root));
}

#endif
