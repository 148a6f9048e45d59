/* The FMI functions for the state of a container with FMUs of other tools, whose states are not plain data.
 *
 * Such a state belongs to its instance and cannot be serialized. If one of the FMUs cannot save its state
 * (CONTAINER_SAVES is 0), the container cannot either. */
#include <stdlib.h>
#include <string.h>

#include "instance.h"

#if CONTAINER_SAVES
#define SNAPSHOT_MARK 0x5354524150494D46u   /* "FMIPARTS" */

typedef struct {
    uint64_t mark;
    const Instance *owner;
    State state;                                   /* of the system, what is plain data */
    void *saved[CONTAINER(N_SAVED)];
} Snapshot;

/* 1 if a state is there and of this instance. */
static int is_own(const Instance *instance, const Snapshot *snapshot, const char *function) {
    const char *fault = !snapshot                          ? "there is none"
                        : snapshot->mark != SNAPSHOT_MARK ? "it is not a state of an FMU of this runtime"
                        : snapshot->owner != instance      ? "it is of another instance, in which it means nothing"
                                                           : NULL;
    if (fault) fail(instance, "%s: the state is refused: %s.", function, fault);
    return !fault;
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2GetFMUstate");
    if (!instance) return fmi2Error;
    if (!FMUstate) return fail(instance, "fmi2GetFMUstate: no place for the state.");
    if (*FMUstate && !is_own(instance, *FMUstate, "fmi2GetFMUstate")) return fmi2Error;
    Snapshot *snapshot = *FMUstate ? (Snapshot *)*FMUstate : calloc(1, sizeof *snapshot);
    if (!snapshot) return fail(instance, "fmi2GetFMUstate: out of memory.");
    snapshot->mark = SNAPSHOT_MARK;
    snapshot->owner = instance;
    snapshot->state = instance->state;
    if (!CONTAINER(save)(&instance->state.system, &snapshot->state.system, snapshot->saved)) {
        if (!*FMUstate) {
            CONTAINER(forget)(&instance->state.system, snapshot->saved);
            free(snapshot);
        }
        return fail(instance, "fmi2GetFMUstate: a component does not save its state.");
    }
    *FMUstate = snapshot;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2SetFMUstate");
    const Snapshot *snapshot = (const Snapshot *)FMUstate;
    if (!instance) return fmi2Error;
    if (!is_own(instance, snapshot, "fmi2SetFMUstate")) return fmi2Error;
    State *s = &instance->state;
    if (!CONTAINER(restore)(&s->system, &snapshot->state.system, snapshot->saved)) {
        s->phase = FAILED;
        return fail(instance, "fmi2SetFMUstate: a component does not restore its state.");
    }
    s->start_time = snapshot->state.start_time;
    s->stop_time = snapshot->state.stop_time;
    s->time = snapshot->state.time;
    s->latest_end = snapshot->state.latest_end;
    s->phase = snapshot->state.phase;
    s->stop_time_defined = snapshot->state.stop_time_defined;
    s->experiment_defined = snapshot->state.experiment_defined;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2FreeFMUstate");
    if (!instance) return fmi2Error;
    if (!FMUstate || !*FMUstate) return fmi2OK;
    if (!is_own(instance, *FMUstate, "fmi2FreeFMUstate")) return fmi2Error;
    CONTAINER(forget)(&instance->state.system, ((Snapshot *)*FMUstate)->saved);
    free(*FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}
#else
/* Says that there are no states to get, set or free. */
static fmi2Status no_state(fmi2Component c, const char *function) {
    const Instance *instance = allowed(c, ALLOWED_ALWAYS, function);
    if (!instance) return fmi2Error;
    return fail(instance, "%s: canGetAndSetFMUstate is false; a component does not save its state.", function);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    (void)FMUstate;
    return no_state(c, "fmi2GetFMUstate");
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    (void)FMUstate;
    return no_state(c, "fmi2SetFMUstate");
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    (void)FMUstate;
    return no_state(c, "fmi2FreeFMUstate");
}
#endif

/* Says that there are no bytes of a state. */
static fmi2Status no_bytes(fmi2Component c, const char *function) {
    const Instance *instance = allowed(c, ALLOWED_ALWAYS, function);
    if (!instance) return fmi2Error;
    return fail(instance, "%s: canSerializeFMUstate is false; a component's state is not plain data.", function);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
    (void)FMUstate;
    (void)size;
    return no_bytes(c, "fmi2SerializedFMUstateSize");
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate,
                                 fmi2Byte serializedState[], size_t size) {
    (void)FMUstate;
    (void)serializedState;
    (void)size;
    return no_bytes(c, "fmi2SerializeFMUstate");
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate) {
    (void)serializedState;
    (void)size;
    (void)FMUstate;
    return no_bytes(c, "fmi2DeSerializeFMUstate");
}
