/* A sampled unit y = u + tick count that misbehaves in the way its GUID says after the dash. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fmi2Functions.h"

#define GUID "{misbehaving}-"
#define UNUSED(x) (void)(x)

typedef struct {
    const char *fault;
    const fmi2CallbackFunctions *callbacks;
    double u, hidden, t;
    int k;
    fmi2Boolean initialized;
} Unit;

#ifdef PYTHON
extern void Py_Initialize(void);
extern void *PyList_New(long);
void *list_of_the_host(void) { return Py_Initialize(), PyList_New(0); }
#endif

static char fault_of_last[64]; /* outlives the instance, as the GUID's memory need not */
static double leaked; /* shared by all instances */
static int lives, damaged;

static int is(const Unit *unit, const char *fault) { return strcmp(unit->fault, fault) == 0; }

static fmi2Status said(Unit *unit, const char *format, int number, const char *text) {
    const fmi2CallbackFunctions *f = unit->callbacks;
    f->logger(f->componentEnvironment, "unit", fmi2Error, "logStatusError", format, number, text);
    return fmi2Error;
}

#ifdef HOSTILE
#include "hostile.h"
#else
#define harm(fault) UNUSED(fault)
#define harm_inputs(fault, vr, value) UNUSED(fault)
#endif

static void wait_for_ever(void) {
    volatile int forever = 1;
    while (forever) {
    }
}

static void wait_a_while(void) {
    const clock_t end = clock() + CLOCKS_PER_SEC / 5;
    while (clock() < end) {
    }
}

FMI2_Export const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
FMI2_Export const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    UNUSED(type), UNUSED(location), UNUSED(visible), UNUSED(logging);
    int ours = strncmp(guid, GUID, strlen(GUID)) == 0;
#ifdef ANY_GUID
    if (0) {
#else
    if (!ours) {
#endif
        callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "Wrong GUID.");
        return NULL;
    }
    Unit *unit = calloc(1, sizeof *unit);
    if (ours) snprintf(fault_of_last, sizeof fault_of_last, "%s", guid + strlen(GUID));
    unit->fault = fault_of_last;
    unit->callbacks = callbacks;
    if (is(unit, "refuse")) return NULL;
    if (is(unit, "once") && ++lives > 1) {
        callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "There is one already.");
        return NULL;
    }
    if (is(unit, "lives") && ++lives > 40) abort();
    if (damaged && ++damaged > 20) abort(); /* long after what damaged it */
    if (is(unit, "stdout")) puts("hello from the FMU"), fflush(stdout);
    if (is(unit, "exit")) exit(7);
    return unit;
}

FMI2_Export void fmi2FreeInstance(fmi2Component c) {
    if (is(c, "crash in free")) *(volatile int *)8 = 1;
    free(c);
}

FMI2_Export fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
    return UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(names), fmi2OK;
}

FMI2_Export fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean d, fmi2Real tol, fmi2Real t0, fmi2Boolean s,
                                           fmi2Real stop) {
    UNUSED(d), UNUSED(tol), UNUSED(s), UNUSED(stop);
    ((Unit *)c)->t = t0;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return is(c, "initialization") ? said(c, "%d of %s", 3, "four") : fmi2OK;
}
FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    ((Unit *)c)->initialized = fmi2True;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2Terminate(fmi2Component c) {
    if (is(c, "crash in terminate")) *(volatile int *)8 = 1;
    return is(c, "terminate") ? fmi2Error : fmi2OK;
}

FMI2_Export fmi2Status fmi2Reset(fmi2Component c) {
    Unit *unit = c;
    int k = is(unit, "reset") ? unit->k : 0;
    *unit = (Unit){.fault = unit->fault, .callbacks = unit->callbacks, .k = k};
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    Unit *unit = c;
    for (size_t i = 0; i < n; i++) {
        if (vr[i] > 2) {
            if (is(unit, "reference")) return value[i] = 0, fmi2OK;
            if (is(unit, "crash on reference")) abort();
            if (is(unit, "damage")) damaged = 1;
            return fmi2Error;
        }
        double count = is(unit, "shared") ? leaked : unit->k;
        double y = unit->u + count + unit->hidden;
        if (is(unit, "nan") && unit->k > 3) y = NAN;
        if (is(unit, "random")) y += rand();
        if (is(unit, "nan at start")) y = INFINITY;
        value[i] = vr[i] == 0 ? unit->u : vr[i] == 1 ? y : 1.5;
    }
    if (is(unit, "exceeds")) value[n] = 1.5;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Unit *unit = c;
    harm_inputs(unit->fault, vr, value);
    for (size_t i = 0; i < n; i++) {
        if (vr[i] == 0) {
            if (is(unit, "crash on NaN") && isnan(value[i])) abort();
            if (is(unit, "picky") && value[i] != 0.0) return fmi2Error;
            unit->u = value[i];
        } else if (!is(unit, "settable")) {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

#define NONE(type)                                                                                                  \
    FMI2_Export fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##type v[]) { \
        return UNUSED(c), UNUSED(vr), UNUSED(v), n ? fmi2Error : fmi2OK;                                            \
    }                                                                                                               \
    FMI2_Export fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t n,                   \
                                         const fmi2##type v[]) {                                                    \
        return UNUSED(c), UNUSED(vr), UNUSED(v), n ? fmi2Error : fmi2OK;                                            \
    }
NONE(Integer)
NONE(Boolean)
NONE(String)

FMI2_Export fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (is(c, "no state")) return fmi2Error;
    if (*state == NULL) *state = malloc(sizeof(Unit));
    memcpy(*state, c, sizeof(Unit));
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    Unit *unit = c;
    double hidden = unit->hidden;
    *unit = *(Unit *)state;
    if (is(unit, "state")) unit->hidden = hidden;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    UNUSED(c), free(*state);
    *state = NULL;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    UNUSED(state);
    *size = is(c, "huge state") ? (size_t)-1 / 2 : sizeof(Unit);
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    memcpy(bytes, state, size);
    if (is(c, "serialization")) ((Unit *)bytes)->k = 0;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
    if (size != sizeof(Unit) && !is(c, "torn")) return fmi2Error;
    if (is(c, "early") && !((Unit *)c)->initialized) return fmi2Error;
    *state = calloc(1, sizeof(Unit));
    memcpy(*state, bytes, size);
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference y[], size_t n,
                                                    const fmi2ValueReference u[], size_t m, const fmi2Real du[],
                                                    fmi2Real dy[]) {
    UNUSED(y), UNUSED(u), UNUSED(m);
    for (size_t i = 0; i < n; i++) dy[i] = is(c, "derivative") ? -du[0] : du[0];
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
    return UNUSED(c), UNUSED(vr), UNUSED(n), UNUSED(order), UNUSED(value), fmi2Error;
}
#ifndef INCOMPLETE
FMI2_Export fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
    return UNUSED(c), UNUSED(vr), UNUSED(n), UNUSED(order), UNUSED(value), fmi2Error;
}
#endif

FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean keep) {
    Unit *unit = c;
    UNUSED(keep), UNUSED(t);
    if (!(h > 0)) {
        if (is(unit, "hang on negative step")) wait_for_ever();
        return is(unit, "any step") ? fmi2OK : fmi2Error;
    }
    if (is(unit, "crash") && unit->k == 2) *(volatile int *)8 = 1;
    if (is(unit, "hang")) wait_for_ever();
    if (is(unit, "own step") && fabs(h - 0.1) > 1e-9) return fmi2Error;
    if (is(unit, "no step at all")) return fmi2Error;
    if (is(unit, "slow")) wait_a_while();
    if (is(unit, "step")) return fmi2Error;
    harm(unit->fault);
    if (is(unit, "chatter")) for (int i = 0; i < 1000; i++) puts("step");
    if (is(unit, "split") || isnan(unit->u)) unit->k++;
    else unit->k = (int)floor((unit->t + h) / 0.5 + 1e-9);
    unit->t += h;
    unit->hidden += is(unit, "state") ? 0.5 : 0;
    leaked += 1;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2CancelStep(fmi2Component c) { return UNUSED(c), fmi2Error; }
#define STATUS(name, type)                                                                              \
    FMI2_Export fmi2Status fmi2Get##name(fmi2Component c, const fmi2StatusKind kind, type *value) {     \
        return UNUSED(c), UNUSED(kind), UNUSED(value), fmi2Discard;                                     \
    }
STATUS(Status, fmi2Status)
STATUS(RealStatus, fmi2Real)
STATUS(IntegerStatus, fmi2Integer)
STATUS(BooleanStatus, fmi2Boolean)
STATUS(StringStatus, fmi2String)
