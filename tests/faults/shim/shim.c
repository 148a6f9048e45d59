/* Wraps each function of an exported FMU: it does what is asked for, or the fault that the FMU's parameters name.
 * The generated faults.h has the numbers of the faults and functions, and the value references of the parameters. */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#include "faults.h"
#include "inner_names.h"
#include "model.c"
#include "outer_names.h"

#define BEYOND 2 /* values that are written beyond the end of what was asked for */
#define LEAKED (1 << 16) /* bytes for each call */

static int calls; /* of the function that misbehaves, since its instance was made */

static int parameter(const Instance *m, int reference) { return (int)m->state.values[reference]; }

/* The fault that is due in this call of a function; NO_FAULT if none is. */
static int due(fmi2Component c, int function) {
    const Instance *m = c;
    if (m == NULL || parameter(m, REFERENCE_FAULT) == NO_FAULT) return NO_FAULT;
    if (parameter(m, REFERENCE_FUNCTION) != function || calls++ < parameter(m, REFERENCE_AFTER)) return NO_FAULT;
    return parameter(m, REFERENCE_FAULT);
}

static void *talk(void *c) {
    const Instance *m = c;
    for (int i = 0; i < 5; i++)
        m->callbacks.logger(m->callbacks.componentEnvironment, m->name, fmi2OK, "logAll", "from a thread: %d", i);
    return NULL;
}

static void talk_in_threads(fmi2Component c) {
    pthread_t threads[4];
    for (int i = 0; i < 4; i++) pthread_create(&threads[i], NULL, talk, c);
    for (int i = 0; i < 4; i++) pthread_join(threads[i], NULL);
}

static void log_text(fmi2Component c, const char *text) {
    const Instance *m = c;
    m->callbacks.logger(m->callbacks.componentEnvironment, m->name, fmi2Warning, "logStatusWarning", text);
}

static void hang(void) {
    volatile int forever = 1;
    while (forever) {
    }
}

/* Does a fault that may never return, and then returns the status of the call: that of the fault, or -1 for what the
 * function would have done. */
static int misbehave(fmi2Component c, int fault) {
    switch (fault) {
        case FAULT_SEGMENTATION: raise(SIGSEGV); break;
        case FAULT_ARITHMETIC: raise(SIGFPE); break;
        case FAULT_ABORT: abort();
        case FAULT_EXIT: exit(0);
        case FAULT_HANG: hang(); break;
        case FAULT_LEAK: memset(malloc(LEAKED), 1, LEAKED); break;
        case FAULT_THREADS: talk_in_threads(c); break;
        case FAULT_PERCENT_N: log_text(c, "%n"); break;
        case FAULT_PERCENT_S: log_text(c, "%s%s%s%s%s%s%s%s"); break;
        case FAULT_IDLE: return fmi2OK;
        case FAULT_WARNING: return -1;
        default: return fault < FIRST_FAULT_BESIDE_STATUS ? fault : -1;
    }
    return -1;
}

/* A call that returns fmi2Warning has done what it should. */
static fmi2Status warned(fmi2Status status, int fault) {
    return status == fmi2OK && fault == FAULT_WARNING ? fmi2Warning : status;
}

#define WRAPPED(name, parameters, arguments)                              \
    FMI2_Export fmi2Status fmi2##name parameters {                        \
        const int fault = due(c, FUNCTION_##name);                        \
        const int early = fault == NO_FAULT ? -1 : misbehave(c, fault);   \
        return early >= 0 ? (fmi2Status)early : warned(inner_##name arguments, fault); \
    }

/* The same for a function that fills an array: it may write too much, or what is not a number. */
#define FILLING(name, type, strange, parameters, arguments, n, values)                     \
    FMI2_Export fmi2Status fmi2##name parameters {                                         \
        const int fault = due(c, FUNCTION_##name);                                         \
        const int early = fault == NO_FAULT ? -1 : misbehave(c, fault);                    \
        if (early >= 0) return (fmi2Status)early;                                          \
        const fmi2Status status = warned(inner_##name arguments, fault);                   \
        const size_t end = fault == FAULT_BEYOND ? n + BEYOND : n;                         \
        if (fault == FAULT_BEYOND || fault == FAULT_NAN)                                   \
            for (size_t k = fault == FAULT_NAN ? 0 : n; k < end; k++) values[k] = (type)(strange); \
        return status;                                                                     \
    }

FMI2_Export const char *fmi2GetTypesPlatform(void) { return inner_GetTypesPlatform(); }
FMI2_Export const char *fmi2GetVersion(void) { return inner_GetVersion(); }

/* An instance has no parameters yet, so its name says what it does: "born_101" for the fault 101. */
FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    int fault = NO_FAULT;
    calls = 0;
    if (name != NULL && sscanf(name, "born_%d", &fault) == 1) {
        if (fault < FIRST_FAULT_BESIDE_STATUS) return NULL;
        misbehave(NULL, fault);
    }
    return inner_Instantiate(name, type, guid, location, callbacks, visible, logging);
}

FMI2_Export void fmi2FreeInstance(fmi2Component c) {
    const int fault = due(c, FUNCTION_FreeInstance);
    if (fault != NO_FAULT) misbehave(c, fault);
    inner_FreeInstance(c);
}

WRAPPED(SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]), (c, on, n, names))
WRAPPED(SetupExperiment,
        (fmi2Component c, fmi2Boolean d, fmi2Real tolerance, fmi2Real t0, fmi2Boolean s, fmi2Real stop),
        (c, d, tolerance, t0, s, stop))
WRAPPED(EnterInitializationMode, (fmi2Component c), (c))
WRAPPED(ExitInitializationMode, (fmi2Component c), (c))
WRAPPED(Terminate, (fmi2Component c), (c))
WRAPPED(Reset, (fmi2Component c), (c))
FILLING(GetReal, fmi2Real, NAN, (fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real v[]),
        (c, vr, n, v), n, v)
FILLING(GetInteger, fmi2Integer, -7, (fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer v[]),
        (c, vr, n, v), n, v)
FILLING(GetBoolean, fmi2Boolean, 7, (fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean v[]),
        (c, vr, n, v), n, v)
WRAPPED(GetString, (fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String v[]), (c, vr, n, v))
WRAPPED(SetReal, (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real v[]), (c, vr, n, v))
WRAPPED(SetInteger, (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer v[]), (c, vr, n, v))
WRAPPED(SetBoolean, (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean v[]), (c, vr, n, v))
WRAPPED(SetString, (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2String v[]), (c, vr, n, v))
WRAPPED(GetFMUstate, (fmi2Component c, fmi2FMUstate *state), (c, state))
WRAPPED(SetFMUstate, (fmi2Component c, fmi2FMUstate state), (c, state))
WRAPPED(FreeFMUstate, (fmi2Component c, fmi2FMUstate *state), (c, state))
WRAPPED(SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size), (c, state, size))
WRAPPED(SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
        (c, state, bytes, size))
WRAPPED(DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
        (c, bytes, size, state))
FILLING(GetDirectionalDerivative, fmi2Real, NAN,
        (fmi2Component c, const fmi2ValueReference y[], size_t n, const fmi2ValueReference u[], size_t m,
         const fmi2Real du[], fmi2Real dy[]),
        (c, y, n, u, m, du, dy), n, dy)
WRAPPED(SetRealInputDerivatives,
        (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], const fmi2Real v[]),
        (c, vr, n, order, v))
FILLING(GetRealOutputDerivatives, fmi2Real, NAN,
        (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real v[]),
        (c, vr, n, order, v), n, v)
WRAPPED(DoStep, (fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean keep), (c, t, h, keep))
WRAPPED(CancelStep, (fmi2Component c), (c))
WRAPPED(GetStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Status *value), (c, kind, value))
WRAPPED(GetRealStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Real *value), (c, kind, value))
WRAPPED(GetIntegerStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value), (c, kind, value))
WRAPPED(GetBooleanStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value), (c, kind, value))
WRAPPED(GetStringStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2String *value), (c, kind, value))
