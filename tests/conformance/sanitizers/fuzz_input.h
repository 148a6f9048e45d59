/* A fuzzer's bytes as choices, numbers, value references and steps; zeros when they have run out. */
#ifndef FUZZ_INPUT_H
#define FUZZ_INPUT_H

#include "unit.h"

#include <math.h>

enum { MAX_N = 6 }; /* references in one call */
#define MAX_WORK 1500.0 /* sub-steps or ticks of one input; a run of more would only be slow */
#define REFUSED_WORK 2e7 /* of one step: more than the unit accepts */

static const uint8_t *next_byte, *last_byte;
static double work; /* done by the present input */

static unsigned byte(void) { return next_byte < last_byte ? *next_byte++ : 0; }

static int one_in(unsigned n) { return byte() % n == n - 1; }

static double number(double typical) {
    static const double special[] = {NAN,      INFINITY, -INFINITY, 0.0,  -0.0, 5e-324, -5e-324, DBL_MIN,
                                     DBL_MAX,  -DBL_MAX, 1e300,     1e-9, 1.0,  -1.0,   1e9,     0x1p63};
    const unsigned kind = byte();
    if (kind < 128) return typical + (real_fabs(typical) + 0.1) * ((double)kind - 64) / 256;
    if (kind < 144) return special[kind - 128];
    if (kind < 152) return typical * (double)(kind - 143);
    if (kind < 160) {
        uint64_t bits = 0;
        double value;
        for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    return typical;
}

static fmi2ValueReference reference(size_t first, size_t n) {
    const unsigned r = byte();
    if (r >= 252) return r == 255 ? UINT32_MAX : MODEL_N_VARIABLES + r - 252;
    return (fmi2ValueReference)(r < 32 || !n ? r % MODEL_N_VARIABLES : first + r % n);
}

static size_t references(fmi2ValueReference vr[MAX_N], size_t first, size_t n) {
    const size_t count = byte() % (MAX_N + 1);
    for (size_t i = 0; i < count; ++i) vr[i] = reference(first, n);
    return count;
}

/* Of what the unit does by itself within a step. */
static double shortest_period(const Instance *instance) {
#ifdef MODEL_CONTAINER
    double period = CONTAINER(step_size);
    for (fmi2ValueReference r = 0; r < MODEL_FIRST_INPUT; ++r) {
        const char *name = strchr(model_variables[r].name, '.') + 1;
        const double value = SLOT(&instance->state, r);
        if ((!strcmp(name, "dt_max") || !strcmp(name, "sample_time")) && value < period) period = value;
    }
    return period;
#else
    return instance->state.values[MODEL_PERIOD];
#endif
}

/* A step whose work is bounded, or so large that the unit refuses it. */
static double bounded_step(const Instance *instance) {
    const double period = shortest_period(instance);
    double h = number(one_in(4) ? 20 * period : period), ratio = h / period;
    if (ratio > REFUSED_WORK || !(ratio > 0)) return h;
    if (ratio > 1000) h = 1000 * period, ratio = 1000;
    work += ratio + 1;
    return h;
}

#endif
