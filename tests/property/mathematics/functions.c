/* The functions of mathematics.h for arrays; with -DHASHES a program that prints a hash of each one's results. */
#include "mathematics.h"

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED
#endif

typedef double (*Function)(double, double);

/* Another name for a function, with a second argument that may be unused. */
#define ONE(name) static double of_##name(double x, double y) { (void)y; return real_##name(x); }
#define TWO(name) static double of_##name(double x, double y) { return real_##name(x, y); }

ONE(fabs) ONE(floor) ONE(ceil) ONE(sqrt) ONE(sqrt_of_integers) ONE(exp) ONE(expm1) ONE(log) ONE(log1p)
ONE(sin) ONE(cos) ONE(tan) ONE(asin) ONE(acos) ONE(atan)
ONE(sinh) ONE(cosh) ONE(tanh) ONE(asinh) ONE(acosh) ONE(atanh)
TWO(fmin) TWO(fmax) TWO(copysign) TWO(fmod) TWO(remainder) TWO(hypot) TWO(pow) TWO(atan2)

static double of_sincos_sin(double x, double y) { (void)y; return real_sincos(x).sin; }
static double of_sincos_cos(double x, double y) { (void)y; return real_sincos(x).cos; }

static const struct {
    const char *name;
    Function function;
} functions[] = {
    {"fabs", of_fabs}, {"floor", of_floor}, {"ceil", of_ceil}, {"fmin", of_fmin}, {"fmax", of_fmax},
    {"copysign", of_copysign}, {"fmod", of_fmod}, {"remainder", of_remainder}, {"sqrt", of_sqrt},
    {"sqrt_of_integers", of_sqrt_of_integers}, {"hypot", of_hypot}, {"exp", of_exp}, {"expm1", of_expm1},
    {"log", of_log}, {"log1p", of_log1p}, {"pow", of_pow}, {"sin", of_sin}, {"cos", of_cos}, {"tan", of_tan},
    {"sincos_sin", of_sincos_sin}, {"sincos_cos", of_sincos_cos}, {"asin", of_asin}, {"acos", of_acos},
    {"atan", of_atan}, {"atan2", of_atan2}, {"sinh", of_sinh}, {"cosh", of_cosh}, {"tanh", of_tanh},
    {"asinh", of_asinh}, {"acosh", of_acosh}, {"atanh", of_atanh},
};

enum { N_FUNCTIONS = sizeof functions / sizeof *functions };

EXPORTED const char *function_name(int i);
EXPORTED const char *function_name(int i) { return i < N_FUNCTIONS ? functions[i].name : 0; }

EXPORTED void evaluate(int i, const double *x, const double *y, double *result, int n);
EXPORTED void evaluate(int i, const double *x, const double *y, double *result, int n) {
    for (int k = 0; k < n; ++k) result[k] = functions[i].function(x[k], y[k]);
}

#ifdef HASHES
#include <stdio.h>

/* S. Vigna's SplitMix64. */
static uint64_t next(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Any double, infinities and NaN included, or one whose size is between 2^-32 and 2^32. */
static double argument(uint64_t *state) {
    const uint64_t bits = next(state), kind = next(state) & 3u;
    const uint64_t exponent = 1023 - 32 + (bits >> 52) % 64;
    return real_of_bits(kind == 0 ? bits : (bits & (REAL_SIGN | REAL_FRACTION)) | exponent << 52);
}

int main(void) {
    for (int i = 0; i < N_FUNCTIONS; ++i) {
        uint64_t state = 1, hash = 0xcbf29ce484222325u;
        for (int k = 0; k < HASHES; ++k) {
            const double x = argument(&state), y = argument(&state);
            if (functions[i].function != of_sqrt_of_integers || (x > 0 && x <= DBL_MAX))
                hash = (hash ^ real_bits(functions[i].function(x, y))) * 0x100000001b3u;
        }
        printf("%s %08lx%08lx\n", functions[i].name, (unsigned long)(hash >> 32), (unsigned long)(hash & 0xffffffffu));
    }
    return 0;
}
#endif
