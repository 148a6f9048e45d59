/* The FMI functions that save and restore the state of a container with FMUs of other tools, which save their parts
 * themselves. Such a state works in its own instance only, so it is not serialized. */
#include <stdlib.h>
#include <string.h>

#include "instance.h"

#ifdef CONTAINER_SAVES
#define SNAPSHOT_MARK 0x4E474945524F46u            /* "FOREIGN" */

typedef struct {
    uint64_t mark;
    const Instance *owner;
    State state;
    void *saved[CONTAINER_SAVES];
} Snapshot;

/* 1 if a state is there and of this instance. */
static int is_own(const Instance *instance, const Snapshot *snapshot, const char *function) {
    const char *fault = NULL;
    if (!snapshot) fault = "there is none";
    else if (snapshot->mark != SNAPSHOT_MARK) fault = "it is not a state of this FMU";
    else if (snapshot->owner != instance) fault = "it is of another instance";
    if (fault) fail(instance, "%s: the state is refused: %s.", function, fault);
    return !fault;
}

static void forget(Instance *instance, Snapshot *snapshot) {
    CONTAINER(forget)(&instance->state.system, snapshot->saved);
    free(snapshot);
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
        if (!*FMUstate) forget(instance, snapshot);
        return fail(instance, "fmi2GetFMUstate: a component does not save its state now.");
    }
    *FMUstate = snapshot;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2SetFMUstate");
    const Snapshot *snapshot = (const Snapshot *)FMUstate;
    if (!instance) return fmi2Error;
    if (!is_own(instance, snapshot, "fmi2SetFMUstate")) return fmi2Error;
    if (!CONTAINER(restore)(&instance->state.system, &snapshot->state.system, snapshot->saved)) {
        instance->state.phase = FAILED;
        return fail(instance, "fmi2SetFMUstate: a component does not restore its state.");
    }
    restore_position(&instance->state, &snapshot->state);
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2FreeFMUstate");
    if (!instance) return fmi2Error;
    if (!FMUstate || !*FMUstate) return fmi2OK;
    if (!is_own(instance, *FMUstate, "fmi2FreeFMUstate")) return fmi2Error;
    forget(instance, *FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}
#else
static fmi2Status does_not_save(fmi2Component c, const char *function) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, function);
    if (!instance) return fmi2Error;
    return fail(instance, "%s: canGetAndSetFMUstate is false, because a component does not save its state.", function);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    (void)FMUstate;
    return does_not_save(c, "fmi2GetFMUstate");
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    (void)FMUstate;
    return does_not_save(c, "fmi2SetFMUstate");
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    return FMUstate && *FMUstate ? does_not_save(c, "fmi2FreeFMUstate") : fmi2OK;
}
#endif

static fmi2Status does_not_serialize(fmi2Component c, const char *function) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, function);
    if (!instance) return fmi2Error;
    return fail(instance, "%s: canSerializeFMUstate is false, because a component is an FMU of another tool.", function);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
    (void)FMUstate;
    (void)size;
    return does_not_serialize(c, "fmi2SerializedFMUstateSize");
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size) {
    (void)FMUstate;
    (void)serializedState;
    (void)size;
    return does_not_serialize(c, "fmi2SerializeFMUstate");
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate) {
    (void)serializedState;
    (void)size;
    (void)FMUstate;
    return does_not_serialize(c, "fmi2DeSerializeFMUstate");
}
