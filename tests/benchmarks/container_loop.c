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

EXPORT int64_t container_state_size(void) { return (int64_t)sizeof loop; }

EXPORT void container_outputs(double *values) {
    const uint32_t first = OF(_N_PARAMETERS) + OF(_N_INPUTS);
    for (uint32_t i = 0; i < OF(_N_OUTPUTS); ++i) values[i] = OF(_get)(&loop, first + i);
}
