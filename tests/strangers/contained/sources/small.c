/* A small FMU for co-simulation with every type of number, a state, and faults on demand; see fmus.py. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include HEADER
#include "parts/helper.h"

#define UNUSED(x) (void)(x)
#ifndef MEMORY
#define MEMORY(m) ((m)->x)
#endif

enum { U, Y, K, B, X, N_REALS };
enum { M, COUNT, MODE, FAULT, N_INTEGERS };
enum { ON, ODD, N_BOOLEANS };

typedef struct {
    double real[N_REALS], x;
    int integer[N_INTEGERS], boolean[N_BOOLEANS];
    const fmi2CallbackFunctions *callbacks;
    char text[16];
} Model;

double memory; /* what all instances share, if MEMORY says so; a name that others have, too */

static void show(Model *m) {
    m->real[X] = MEMORY(m);
    m->real[Y] = MEMORY(m) + m->boolean[ON] + 0.125 * (double)strlen(m->text);
    m->boolean[ODD] = m->integer[COUNT] & 1;
}

FMI2_Export const char *NAMED(fmi2GetVersion)(void) { return "2.0"; }

FMI2_Export fmi2Component NAMED(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                                 const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                                 fmi2Boolean logging) {
    UNUSED(name), UNUSED(type), UNUSED(resources), UNUSED(visible), UNUSED(logging);
    if (strcmp(guid, "small") != 0) {
        callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "log", "%s is not the GUID", guid);
        return NULL;
    }
    Model *m = callbacks->allocateMemory(1, sizeof *m);
    if (m == NULL) return NULL;
    m->callbacks = callbacks;
    m->real[K] = 2, m->real[B] = 0.5, m->integer[M] = 1, m->integer[MODE] = 2;
    MEMORY(m) = 1;
    strcpy(m->text, "ab");
    return m;
}
FMI2_Export void NAMED(fmi2FreeInstance)(fmi2Component c) {
    if (c) ((Model *)c)->callbacks->freeMemory(c);
}
FMI2_Export fmi2Status NAMED(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean d, fmi2Real tolerance, fmi2Real start,
                                                  fmi2Boolean s, fmi2Real stop) {
    return UNUSED(c), UNUSED(d), UNUSED(tolerance), UNUSED(start), UNUSED(s), UNUSED(stop), fmi2OK;
}
FMI2_Export fmi2Status NAMED(fmi2EnterInitializationMode)(fmi2Component c) { return UNUSED(c), fmi2OK; }
FMI2_Export fmi2Status NAMED(fmi2ExitInitializationMode)(fmi2Component c) { return UNUSED(c), fmi2OK; }
FMI2_Export fmi2Status NAMED(fmi2Terminate)(fmi2Component c) { return UNUSED(c), fmi2OK; }

FMI2_Export fmi2Status NAMED(fmi2DoStep)(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean final) {
    Model *m = c;
    UNUSED(final);
    const int fault = t > 0.2 ? m->integer[FAULT] : 0;
    if (fault) {
        const char *what = "tank";
        m->callbacks->logger(m->callbacks->componentEnvironment, "small", fmi2Error, "log", "the %s is %d %% full", what,
                             m->integer[FAULT]);
    }
    m->real[B] += 0; /* tunable */
    MEMORY(m) += h * (m->real[K] * helper(m->real[U]) + m->real[B] * m->integer[M] * m->integer[MODE]);
    ++m->integer[COUNT];
    if (fault == 5) MEMORY(m) = NAN;
    return fault <= fmi2Fatal ? (fmi2Status)fault : fmi2OK;
}

FMI2_Export fmi2Status NAMED(fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real v[]) {
    show(c);
    for (size_t i = 0; i < n; i++) v[i] = ((Model *)c)->real[vr[i]];
    return fmi2OK;
}
FMI2_Export fmi2Status NAMED(fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                          const fmi2Real v[]) {
    for (size_t i = 0; i < n; i++) {
        ((Model *)c)->real[vr[i]] = v[i];
        if (vr[i] == X) MEMORY((Model *)c) = v[i];
    }
    return fmi2OK;
}
#define ACCESS(type, array)                                                                                           \
    FMI2_Export fmi2Status NAMED(fmi2Get##type)(fmi2Component c, const fmi2ValueReference vr[], size_t n,             \
                                                fmi2##type v[]) {                                                     \
        show(c);                                                                                                      \
        for (size_t i = 0; i < n; i++) v[i] = ((Model *)c)->array[vr[i]];                                             \
        return fmi2OK;                                                                                                \
    }                                                                                                                 \
    FMI2_Export fmi2Status NAMED(fmi2Set##type)(fmi2Component c, const fmi2ValueReference vr[], size_t n,             \
                                                const fmi2##type v[]) {                                               \
        for (size_t i = 0; i < n; i++) ((Model *)c)->array[vr[i]] = v[i];                                             \
        return fmi2OK;                                                                                                \
    }
ACCESS(Integer, integer)
ACCESS(Boolean, boolean)
FMI2_Export fmi2Status NAMED(fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String v[]) {
    for (size_t i = 0; i < n; i++) v[i] = ((Model *)c)->text;
    return UNUSED(vr), fmi2OK;
}
FMI2_Export fmi2Status NAMED(fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                            const fmi2String v[]) {
    for (size_t i = 0; i < n; i++) strncpy(((Model *)c)->text, v[i], sizeof ((Model *)c)->text - 1);
    return UNUSED(vr), fmi2OK;
}

FMI2_Export fmi2Status NAMED(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    if (*state == NULL) *state = ((Model *)c)->callbacks->allocateMemory(1, sizeof(Model));
    return memcpy(*state, c, sizeof(Model)), fmi2OK;
}
FMI2_Export fmi2Status NAMED(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    return memcpy(c, state, sizeof(Model)), fmi2OK;
}
FMI2_Export fmi2Status NAMED(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    ((Model *)c)->callbacks->freeMemory(*state);
    *state = NULL;
    return fmi2OK;
}
