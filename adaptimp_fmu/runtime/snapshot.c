/* The FMI functions that save, restore and serialize the state of an instance.
 *
 * A serialized state is a header (format, GUID, size, checksum) and the bytes of State, which
 * holds numbers only: it works in another instance or process of the same FMU. All platforms are
 * little-endian.
 */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

#define SNAPSHOT_MARK 0x54415453494D4946u   /* "FIMISTAT" */
#define GUID_LENGTH 40

typedef struct {
    uint64_t mark;
    uint64_t checksum;                             /* of all that follows, set when serialized */
    char guid[GUID_LENGTH];
    uint64_t size;
    State state;
} Snapshot;

/* FNV-1a, 64 bits: finds corruption, not malice. */
static uint64_t checksum_of(const Snapshot *snapshot) {
    const unsigned char *bytes = (const unsigned char *)snapshot;
    uint64_t hash = 0xCBF29CE484222325u;
    for (size_t i = offsetof(Snapshot, guid); i < sizeof *snapshot; ++i)
        hash = (hash ^ bytes[i]) * 0x100000001B3u;
    return hash;
}

/* The head of a state says which FMU it belongs to. The head is the same in all FMUs of this runtime. */
static const char *snapshot_owner_fault(const Snapshot *snapshot) {
    if (snapshot->mark != SNAPSHOT_MARK) return "it is not a state of an FMU of this runtime";
    if (strncmp(snapshot->guid, model_guid, GUID_LENGTH) != 0) return "it is of another FMU (GUID)";
    return NULL;
}

static int parameter_valid(const ModelVariable *variable, double value) {
#ifdef MODEL_DIVISOR
    if (variable == &model_variables[MODEL_DIVISOR] && !(value >= 1)) return 0;
#endif
    if (variable->type == TYPE_INTEGER && !is_integer(value)) return 0;
    return value >= variable->min && value <= variable->max && real_is_finite(value) && may_be(variable, value);
}

/* What no run leaves behind. The checksum finds corruption; bytes that somebody has made up pass it, and
 * must not lead to a division by zero or to an index outside of its array. */
static const char *state_fault(const State *s) {
    for (int i = 0; i < MODEL_N_PARAMETERS; ++i)
        if (!parameter_valid(&model_variables[i], SLOT(s, i))) return "a parameter is out of its range";
    if (s->phase != INSTANTIATED && s->phase != INITIALIZATION && s->phase != STEP_COMPLETE &&
        s->phase != TERMINATED && s->phase != FAILED)
        return "its phase is none of FMI";
    if (!real_is_finite(s->start_time) || !real_is_finite(s->stop_time) || !real_is_finite(s->time))
        return "a time is not finite";
    return position_fault(s);
}

static const char *snapshot_fault(const Snapshot *snapshot) {
    const char *fault = snapshot_owner_fault(snapshot);
    if (fault) return fault;
    if (snapshot->size != sizeof snapshot->state) return "its size is wrong";
    if (snapshot->checksum != checksum_of(snapshot)) return "its checksum is wrong";
    return state_fault(&snapshot->state);
}

/* 1 if a state is there and of this FMU; a foreign one may point to less memory than ours. */
static int is_own(const Instance *instance, const Snapshot *snapshot, const char *function) {
    const char *fault = snapshot ? snapshot_owner_fault(snapshot) : "there is none";
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
    strncpy(snapshot->guid, model_guid, GUID_LENGTH);
    snapshot->size = sizeof snapshot->state;
    snapshot->state = instance->state;
    *FMUstate = snapshot;
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2SetFMUstate");
    if (!instance) return fmi2Error;
    if (!is_own(instance, FMUstate, "fmi2SetFMUstate")) return fmi2Error;
    instance->state = ((const Snapshot *)FMUstate)->state;
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2FreeFMUstate");
    if (!instance) return fmi2Error;
    if (!FMUstate || !*FMUstate) return fmi2OK;
    if (!is_own(instance, *FMUstate, "fmi2FreeFMUstate")) return fmi2Error;
    free(*FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2SerializedFMUstateSize");
    if (!instance) return fmi2Error;
    if (!is_own(instance, FMUstate, "fmi2SerializedFMUstateSize")) return fmi2Error;
    if (!size) return fail(instance, "fmi2SerializedFMUstateSize: no place for the size.");
    *size = sizeof(Snapshot);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate,
                                 fmi2Byte serializedState[], size_t size) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2SerializeFMUstate");
    Snapshot *snapshot = (Snapshot *)FMUstate;
    if (!instance) return fmi2Error;
    if (!is_own(instance, snapshot, "fmi2SerializeFMUstate")) return fmi2Error;
    if (!serializedState) return fail(instance, "fmi2SerializeFMUstate: no place for the bytes.");
    if (size < sizeof *snapshot)
        return fail(instance, "fmi2SerializeFMUstate: %zu bytes are too few, %zu are needed.", size,
                    sizeof *snapshot);
    snapshot->checksum = checksum_of(snapshot);
    memcpy(serializedState, snapshot, sizeof *snapshot);
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2DeSerializeFMUstate");
    if (!instance) return fmi2Error;
    if (!serializedState || !FMUstate)
        return fail(instance, "fmi2DeSerializeFMUstate: no bytes, or no place for the state.");
    if (size != sizeof(Snapshot))
        return fail(instance, "fmi2DeSerializeFMUstate: %zu bytes given, a state has %zu.", size,
                    sizeof(Snapshot));
    Snapshot *snapshot = malloc(sizeof *snapshot);
    if (!snapshot) return fail(instance, "fmi2DeSerializeFMUstate: out of memory.");
    memcpy(snapshot, serializedState, sizeof *snapshot);
    const char *fault = snapshot_fault(snapshot);
    if (fault) {
        free(snapshot);
        return fail(instance, "fmi2DeSerializeFMUstate: the bytes are refused: %s.", fault);
    }
    *FMUstate = snapshot;
    return fmi2OK;
}
