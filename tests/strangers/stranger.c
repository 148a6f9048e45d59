/* A small FMU for co-simulation that does what its GUID says after the dash; see fmus.py for its variables. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define N 8
#define LENGTH 64
#define UNUSED(x) (void)(x)

typedef struct {
    double real[N];
    int integer[N], boolean[N];
    char text[N][LENGTH];
    double time, first_step, reached;
    int initialized;
    char kind[LENGTH];
    const fmi2CallbackFunctions *callbacks;
} Model;

static double shared[N]; /* what all instances in one memory have in common */

static int is(const Model *m, const char *kind) { return strcmp(m->kind, kind) == 0; }

static void say(const Model *m, fmi2Status status, const char *text, double value) {
    m->callbacks->logger(m->callbacks->componentEnvironment, "stranger", status, "log", "%s at t = %g s", text, value);
}

static void *speaking(void *m) {
    say(m, fmi2OK, "a thread", ((Model *)m)->time);
    return NULL;
}

/* Outputs from inputs, as far as they depend on them directly. */
static void compute(Model *m) {
    if (is(m, "feedthrough") && !m->initialized) m->real[1] = 10 * m->real[0];
    if (is(m, "nan") && !m->initialized) m->real[1] = m->time > 0.35 ? NAN : m->time;
    if (is(m, "forgets") && !m->initialized) m->real[1] = m->real[0];
    if (is(m, "text") || is(m, "text and choice")) {
        snprintf(m->text[1], LENGTH, "%.60s!", m->text[0]);
        m->real[1] = (double)strlen(m->text[0]);
    }
    if (is(m, "linear")) m->real[1] = 0.5 * m->real[0] + 1;
    if (is(m, "root")) m->real[1] = sqrt(2 + m->real[0]);
    if (is(m, "inverts")) m->integer[1] = 1 - m->integer[0];
    if (is(m, "speaks")) snprintf(m->text[1], LENGTH, "t = %g s", m->time);
    if (is(m, "choice") || is(m, "text and choice")) m->integer[1] = m->integer[0], m->integer[2] = 10 * m->integer[3];
}

FMI2_Export const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
FMI2_Export const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    UNUSED(name), UNUSED(type), UNUSED(location), UNUSED(visible), UNUSED(logging);
    Model *m = calloc(1, sizeof *m);
    const char *dash = strchr(guid, '-');
    snprintf(m->kind, LENGTH, "%.63s", dash ? dash + 1 : "");
    m->callbacks = callbacks;
    if (is(m, "toolless")) return say(m, fmi2Error, "the tool is not installed", 0), free(m), NULL;
    m->integer[0] = 1, m->integer[3] = 2;
    m->real[2] = 1, m->real[3] = 1, m->real[4] = 0.5;
    strcpy(m->text[0], "abc");
    if (is(m, "alone")) memset(shared, 0, sizeof shared), shared[2] = 1;
    return m;
}
FMI2_Export void fmi2FreeInstance(fmi2Component c) { free(c); }
FMI2_Export fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
    return UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(names), fmi2OK;
}
FMI2_Export fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean d, fmi2Real tolerance, fmi2Real start,
                                           fmi2Boolean s, fmi2Real stop) {
    Model *m = c;
    UNUSED(d), UNUSED(s);
    m->time = start;
    if (is(m, "experiment")) m->real[1] = d ? tolerance : -1, m->real[3] = s ? stop : -1;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Model *m = c;
    if (is(m, "forgets")) m->real[0] = 0; /* inputs that were set too early */
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Model *m = c;
    compute(m);
    m->initialized = 1;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2Terminate(fmi2Component c) { return UNUSED(c), fmi2OK; }
FMI2_Export fmi2Status fmi2Reset(fmi2Component c) { return UNUSED(c), fmi2OK; }

FMI2_Export fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    Model *m = c;
    compute(m);
    for (size_t k = 0; k < n; k++) value[k] = is(m, "alone") ? shared[vr[k]] : m->real[vr[k]];
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Model *m = c;
    for (size_t k = 0; k < n; k++) (is(m, "alone") ? shared : m->real)[vr[k]] = value[k];
    if (is(m, "overwrites")) *(fmi2Real *)value = 99;
    return fmi2OK;
}
#define ACCESS(type, array)                                                                                           \
    FMI2_Export fmi2Status fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##type v[]) {  \
        compute(c);                                                                                                   \
        for (size_t k = 0; k < n; k++) v[k] = ((Model *)c)->array[vr[k]];                                             \
        return fmi2OK;                                                                                                \
    }                                                                                                                 \
    FMI2_Export fmi2Status fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t n,                    \
                                         const fmi2##type v[]) {                                                      \
        for (size_t k = 0; k < n; k++) ((Model *)c)->array[vr[k]] = v[k];                                             \
        return fmi2OK;                                                                                                \
    }
ACCESS(Integer, integer)
ACCESS(Boolean, boolean)
FMI2_Export fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    compute(c);
    for (size_t k = 0; k < n; k++) {
        if (vr[k] >= N) return fmi2Error;
        value[k] = ((Model *)c)->text[vr[k]];
    }
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                     const fmi2String value[]) {
    for (size_t k = 0; k < n; k++) snprintf(((Model *)c)->text[vr[k]], LENGTH, "%s", value[k]);
    return fmi2OK;
}

#ifndef WITHOUT_STATE
FMI2_Export fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (*state == NULL) *state = malloc(sizeof(Model));
    memcpy(*state, c, sizeof(Model));
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    memcpy(c, state, sizeof(Model));
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    UNUSED(c), free(*state);
    *state = NULL;
    return fmi2OK;
}
FMI2_Export fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    return UNUSED(c), UNUSED(state), *size = sizeof(Model), fmi2OK;
}
FMI2_Export fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    return UNUSED(c), memcpy(bytes, state, size), fmi2OK;
}
FMI2_Export fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
    *state = malloc(sizeof(Model));
    return UNUSED(c), memcpy(*state, bytes, size), fmi2OK;
}
FMI2_Export fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference y[], size_t n,
                                                    const fmi2ValueReference u[], size_t k, const fmi2Real du[],
                                                    fmi2Real dy[]) {
    return UNUSED(c), UNUSED(y), UNUSED(n), UNUSED(u), UNUSED(k), UNUSED(du), UNUSED(dy), fmi2Error;
}
#endif
FMI2_Export fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
    return UNUSED(c), UNUSED(vr), UNUSED(n), UNUSED(order), UNUSED(value), fmi2Error;
}
FMI2_Export fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
    return UNUSED(c), UNUSED(vr), UNUSED(n), UNUSED(order), UNUSED(value), fmi2Error;
}

FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean keep) {
    Model *m = c;
    UNUSED(keep);
    const double end = t + h;
    m->reached = t;
    if (is(m, "feedthrough")) m->real[1] = 10 * m->real[0];
    if (is(m, "forgets")) m->real[1] = m->real[0];
    if (is(m, "alone")) shared[1] += shared[2] * h;
    if (is(m, "state")) m->real[3] += h * m->real[4];
    if (is(m, "clock") || is(m, "ends") || is(m, "stops") || is(m, "short") || is(m, "nan")) {
        if ((is(m, "ends") || is(m, "stops")) && end > 0.5 + 1e-9) {
            say(m, fmi2Warning, "the end is reached", m->time);
            return fmi2Discard;
        }
        if (is(m, "short") && h > 0.05) return m->reached = t + 0.05, fmi2Discard;
        m->real[1] = is(m, "nan") && end > 0.35 ? NAN : end;
    }
    if (is(m, "one step")) {
        if (m->first_step == 0) m->first_step = h;
        if (fabs(h - m->first_step) > 1e-12) return say(m, fmi2Error, "another step", t), fmi2Error;
        m->real[1] = end;
    }
    if (is(m, "talks")) {
        say(m, fmi2OK, "all is well", t);
        if (t > 0.2) {
            say(m, fmi2Warning, "the tank is nearly empty", t);
            say(m, fmi2Error, "the tank is empty", t);
            return fmi2Error;
        }
    }
    if (is(m, "warns")) say(m, fmi2Warning, "nearly empty", t);
    if (is(m, "integrates and talks")) say(m, fmi2OK, "a step", t);
    if (is(m, "integrates and talks") || is(m, "integrates")) m->real[1] += h * (1 + m->real[0]);
    if (is(m, "storm")) {
        for (int k = 0; k < (int)m->real[2]; k++) say(m, fmi2OK, k % 2 ? "odd" : "100 % even", k);
        if (t > 0.2) return fmi2Error;
    }
    if (is(m, "from threads") && t > 0.2) {
        pthread_t thread;
        for (int k = 0; k < 3; k++) {
            pthread_create(&thread, NULL, speaking, m);
            pthread_join(thread, NULL);
        }
        return fmi2Error;
    }
    m->time = end;
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2CancelStep(fmi2Component c) { return UNUSED(c), fmi2Error; }
FMI2_Export fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    return UNUSED(c), UNUSED(kind), UNUSED(value), fmi2Discard;
}
FMI2_Export fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    return *value = ((Model *)c)->reached, fmi2OK;
}
FMI2_Export fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    return UNUSED(c), UNUSED(kind), UNUSED(value), fmi2Discard;
}
FMI2_Export fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (kind != fmi2Terminated) return fmi2Discard;
    return *value = is(c, "ends"), fmi2OK;
}
FMI2_Export fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    return UNUSED(c), UNUSED(kind), UNUSED(value), fmi2Discard;
}
