/* An FMU for co-simulation with as many Real variables as its GUID says after the dash, and next to no equations.
 *
 * Value references 0 to n - 1 are inputs u, n to 2 n - 1 are outputs y, larger ones are parameters. A step gives
 * y[i] = 0.5 u[i] + i / n. Outputs depend on inputs at the same instant only if the GUID begins with "direct". */
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define UNUSED(x) (void)(x)

typedef struct {
    int direct;
    size_t width, size;
    double value[];
} Model;

static void compute(Model *m) {
    for (size_t i = 0; i < m->width; i++)
        m->value[m->width + i] = 0.5 * m->value[i] + (double)i / (double)m->width;
}

FMI2_Export const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
FMI2_Export const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    UNUSED(name), UNUSED(type), UNUSED(location), UNUSED(callbacks), UNUSED(visible), UNUSED(logging);
    char *end;
    const size_t width = strtoul(strchr(guid, '-') + 1, &end, 10), size = 2 * width + strtoul(end + 1, NULL, 10);
    Model *m = calloc(1, sizeof *m + size * sizeof(double));
    m->width = width, m->size = size, m->direct = strncmp(guid, "direct", 6) == 0;
    return m;
}
FMI2_Export void fmi2FreeInstance(fmi2Component c) { free(c); }
FMI2_Export fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
    return UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(names), fmi2OK;
}
FMI2_Export fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean d, fmi2Real tolerance, fmi2Real start,
                                           fmi2Boolean s, fmi2Real stop) {
    return UNUSED(c), UNUSED(d), UNUSED(tolerance), UNUSED(start), UNUSED(s), UNUSED(stop), fmi2OK;
}
FMI2_Export fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return UNUSED(c), fmi2OK; }
FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return UNUSED(c), fmi2OK; }
FMI2_Export fmi2Status fmi2Terminate(fmi2Component c) { return UNUSED(c), fmi2OK; }
FMI2_Export fmi2Status fmi2Reset(fmi2Component c) { return UNUSED(c), fmi2OK; }

FMI2_Export fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    if (((Model *)c)->direct) compute(c);
    for (size_t k = 0; k < n; k++) value[k] = ((Model *)c)->value[vr[k]];
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    for (size_t k = 0; k < n; k++) ((Model *)c)->value[vr[k]] = value[k];
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean keep) {
    return UNUSED(t), UNUSED(h), UNUSED(keep), compute(c), fmi2OK;
}

FMI2_Export fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    const Model *m = c;
    const size_t bytes = sizeof *m + m->size * sizeof(double);
    if (*state == NULL) *state = malloc(bytes);
    return memcpy(*state, m, bytes), fmi2OK;
}
FMI2_Export fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    const Model *m = state;
    return memcpy(c, m, sizeof *m + m->size * sizeof(double)), fmi2OK;
}
FMI2_Export fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    UNUSED(c), free(*state);
    return *state = NULL, fmi2OK;
}

#define REFUSED(name, ...)                                                                                            \
    FMI2_Export fmi2Status name(__VA_ARGS__) { return fmi2Error; }
#pragma GCC diagnostic ignored "-Wunused-parameter"
#define ACCESS(type)                                                                                                  \
    REFUSED(fmi2Get##type, fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##type v[])                  \
    REFUSED(fmi2Set##type, fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2##type v[])
ACCESS(Integer)
ACCESS(Boolean)
ACCESS(String)
REFUSED(fmi2SerializedFMUstateSize, fmi2Component c, fmi2FMUstate state, size_t *size)
REFUSED(fmi2SerializeFMUstate, fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
REFUSED(fmi2DeSerializeFMUstate, fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
REFUSED(fmi2GetDirectionalDerivative, fmi2Component c, const fmi2ValueReference y[], size_t n,
        const fmi2ValueReference u[], size_t k, const fmi2Real du[], fmi2Real dy[])
REFUSED(fmi2SetRealInputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n,
        const fmi2Integer order[], const fmi2Real value[])
REFUSED(fmi2GetRealOutputDerivatives, fmi2Component c, const fmi2ValueReference vr[], size_t n,
        const fmi2Integer order[], fmi2Real value[])
REFUSED(fmi2CancelStep, fmi2Component c)
REFUSED(fmi2GetStatus, fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
REFUSED(fmi2GetRealStatus, fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
REFUSED(fmi2GetIntegerStatus, fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
REFUSED(fmi2GetBooleanStatus, fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
REFUSED(fmi2GetStringStatus, fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
