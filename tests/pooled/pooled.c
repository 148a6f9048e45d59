/* A small FMU with y' = p + u / 10 that does a deed in the first step that ends after a time, and whose fmi2Reset is as
   its GUID says after the dash. Reals: 0 input u, 1 output y, 2 parameter p, 3 parameter: time of the deed, s.
   Integer 0: the deed. */
#include <unistd.h>

#include "fmi2Functions.h"
#undef fmi2DoStep
#undef fmi2Reset
#undef fmi2Instantiate
#undef fmi2ExitInitializationMode
#undef fmi2GetBooleanStatus
#define fmi2DoStep calm_step
#define fmi2Reset calm_reset
#define fmi2Instantiate calm_instantiate
#define fmi2ExitInitializationMode calm_exit
#define fmi2GetBooleanStatus calm_boolean_status
#include "../strangers/stranger.c"
#undef fmi2DoStep
#undef fmi2Reset
#undef fmi2Instantiate
#undef fmi2ExitInitializationMode
#undef fmi2GetBooleanStatus

enum { NOTHING, CRASH, HANG, END, DIVERGE, REFUSE, DISCARD, TERMINATE, FATAL, NOT_A_NUMBER };

static int starts, resets; /* of all instances of this library */

static void begin(Model *m) {
    m->time = m->real[1] = 0, m->real[0] = 3, m->real[2] = 1, m->real[3] = 0.5;
    m->integer[0] = NOTHING, m->initialized = 0;
}

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    Model *m = calm_instantiate(name, type, guid, location, callbacks, visible, logging);
    begin(m);
    return m;
}
#ifndef WITHOUT_RESET
FMI2_Export fmi2Status fmi2Reset(fmi2Component c) {
    Model *m = c;
    const double kept = is(m, "keeps") ? m->real[1] : 0;
    if (is(m, "refuses")) return say(m, fmi2Error, "there is no way back", m->time), fmi2Error;
    if (is(m, "keeps after failures") && m->integer[1]) return m->initialized = 0, fmi2OK;
    begin(m);
    m->real[1] = kept;
    resets++;
    return fmi2OK;
}
#endif
FMI2_Export fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Model *m = c;
    if (is(m, "counts")) m->real[1] = starts++;
    m->integer[1] = 0;
    return calm_exit(c);
}
FMI2_Export fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (kind != fmi2Terminated) return fmi2Discard;
    return *value = ((Model *)c)->integer[0] == TERMINATE, fmi2OK;
}

static fmi2Status done(Model *m, double t) {
    volatile int *nowhere = NULL;
    m->integer[1] = 1; /* it has failed */
    switch (m->integer[0]) {
    case CRASH: *nowhere = 1; break;
    case HANG:
        for (;;) usleep(100000);
        break;
    case END: _exit(3);
    case DIVERGE: m->real[1] *= 1e100; break;
    case REFUSE: return say(m, fmi2Error, "this cannot be done", t), fmi2Error;
    case DISCARD: return say(m, fmi2Warning, "this step is too long", t), fmi2Discard;
    case TERMINATE: return fmi2Discard;
    case FATAL: return say(m, fmi2Fatal, "all is lost", t), fmi2Fatal;
    case NOT_A_NUMBER: m->real[1] = NAN; break;
    default: m->integer[1] = 0;
    }
    return fmi2OK;
}

FMI2_Export fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean keep) {
    Model *m = c;
    UNUSED(keep);
    m->real[1] += h * (m->real[2] + m->real[0] / 10);
    m->time = t + h;
    if (is(m, "wears out") && resets > 3) return say(m, fmi2Error, "too many files are open", t), fmi2Error;
    return t + h > m->real[3] + 1e-9 ? done(m, t) : fmi2OK;
}
