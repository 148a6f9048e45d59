/* A plain run of an instance: random inputs near their start, steps of random length. */
#ifndef DRIVE_H
#define DRIVE_H

#include "unit.h"

#define OK(call) CHECK((call) == fmi2OK)

/* In [0, 1): Knuth's MMIX linear congruential generator, upper 53 bits. */
static double random_number(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

static void read_values(fmi2Component c, double values[MODEL_N_VARIABLES]) {
    for (fmi2ValueReference r = 0; r < MODEL_N_VARIABLES; ++r) values[r] = SLOT(&((Instance *)c)->state, r);
}

/* Real inputs 1 % and 0.01 off the values in `start`; Booleans, and Reals that stand for them, by a coin. */
static void set_inputs(fmi2Component c, const double *start, uint64_t *seed) {
    for (fmi2ValueReference r = MODEL_FIRST_INPUT; r < MODEL_FIRST_OUTPUT; ++r) {
        const double offset = 2 * random_number(seed) - 1;
        set_number(c, r, model_variables[r].type == TYPE_REAL && !is_whole_real(r) ? start[r] * (1 + 0.01 * offset) + 0.01 * offset
                                                              : offset > 0);
    }
}

static void step(fmi2Component c, uint64_t *seed) {
    static const double parts[] = PARTS; /* of 0.1 ms, a tick of every unit */
    double t = real_nan();
    OK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &t));
    OK(fmi2DoStep(c, t, 1e-4 * parts[(int)(random_number(seed) * 6)], fmi2True));
}

/* Save, serialize, deserialize into another instance and back. */
static void through_bytes(fmi2Component c) {
    fmi2Component other = create(&without_logger);
    fmi2FMUstate state = NULL, copy = NULL;
    size_t size = 0;
    OK(fmi2GetFMUstate(c, &state));
    OK(fmi2SerializedFMUstateSize(c, state, &size));
    char *bytes = malloc(size);
    CHECK(bytes);
    OK(fmi2SerializeFMUstate(c, state, bytes, size));
    OK(fmi2DeSerializeFMUstate(other, bytes, size, &copy));
    OK(fmi2SetFMUstate(other, copy));
    OK(fmi2GetFMUstate(other, &state));
    OK(fmi2SetFMUstate(c, state));
    bytes[size / 2] ^= 1;
    fmi2FMUstate none = NULL;
    CHECK(fmi2DeSerializeFMUstate(other, bytes, size, &none) == fmi2Error && !none);
    OK(fmi2FreeFMUstate(c, &state));
    OK(fmi2FreeFMUstate(c, &copy));
    free(bytes);
    fmi2FreeInstance(other);
}

#endif
