/* A system that was exported as C, behind three functions that a benchmark calls; SYSTEM is the prefix of its names. */
#include <stdint.h>

#include "step.h"

#define JOINED(prefix, name) prefix##name
#define WITH_PREFIX(prefix, name) JOINED(prefix, name)
#define OF(name) WITH_PREFIX(SYSTEM, name)
#define EXPORT __attribute__((visibility("default")))

static OF(_System) loop;
static Failure failure;

/* Each returns 1, or 0 if a component fails. */
EXPORT int32_t container_start(void) {
    OF(_reset)(&loop);
    return OF(_initialize)(&loop, 0.0, &failure);
}

EXPORT int32_t container_run(int64_t steps) { return OF(_step)(&loop, (uint64_t)steps, &failure); }

/* Makes steps one by one; behind each, all outputs are copied to a row. Booleans are 0 or 1 in a system, too. */
EXPORT int32_t container_rows(int64_t steps, double *row) {
    const OF(_Variable) *const outputs = OF(_variables) + OF(_N_PARAMETERS) + OF(_N_INPUTS);
    const double *const values = (const double *)(const void *)&loop;
    for (int64_t k = 0; k < steps; ++k) {
        if (!OF(_step)(&loop, 1, &failure)) return 0;
        for (int i = 0; i < OF(_N_OUTPUTS); ++i) *row++ = values[outputs[i].place];
    }
    return 1;
}
