/* libFuzzer harness of one unit: the input is a sequence of legal and illegal calls on up to three
 * instances.
 *
 * Checked: every status is fmi2OK or fmi2Error; a refused call says why in one safe message and
 * changes nothing (fmi2ExitInitializationMode may refresh outputs, fmi2DoStep may end in the error
 * state); outputs after a step are finite; a step is replayed bitwise from a saved state; exactly the
 * bytes of a serialized state are accepted. The sanitizers check the rest.
 */
#include "fuzz_input.h"

enum { N_INSTANCES = 3, N_SAVED = 3, MAX_CALLS = 200, BLOB = sizeof(Snapshot), CANARY = 77 };

static fmi2Component components[N_INSTANCES];
static fmi2FMUstate saved[N_SAVED];

static fmi2Status step(Instance *instance) {
    if (!instance) return fmi2DoStep(NULL, 0, 1, fmi2True);
    fmi2FMUstate origin = NULL;
    const double t = one_in(16) ? number(instance->state.time) : instance->state.time;
    const double h = bounded_step(instance);
    if (work > MAX_WORK) return fmi2OK;
    const int replay = one_in(4);
    if (replay) CHECK(fmi2GetFMUstate(instance, &origin) == fmi2OK);
    const fmi2Status status = fmi2DoStep(instance, t, h, byte() & 1);
    if (replay) {
        const State after = instance->state;
        const int told = messages;
        CHECK(fmi2SetFMUstate(instance, origin) == fmi2OK);
        CHECK(fmi2DoStep(instance, t, h, fmi2False) == status);
        CHECK(memcmp(&after, &instance->state, sizeof after) == 0);
        CHECK(fmi2FreeFMUstate(instance, &origin) == fmi2OK && !origin);
        messages = told;
    }
    if (status != fmi2OK) return status;
    for (fmi2ValueReference r = MODEL_FIRST_OUTPUT; r < MODEL_N_VARIABLES; ++r) {
        double value = real_nan();
        if (model_variables[r].type != TYPE_REAL) continue;
        CHECK(fmi2GetReal(instance, &r, 1, &value) == fmi2OK && real_is_finite(value));
    }
    double time = real_nan();
    CHECK(fmi2GetRealStatus(instance, fmi2LastSuccessfulTime, &time) == fmi2OK && time == t + h && real_is_finite(time));
    return status;
}

/* One call that leads on. */
static fmi2Status proceed(Instance *instance) {
    if (!instance) return fmi2Reset(NULL);
    switch (instance->state.phase) {
        case INSTANTIATED:
            if (instance->state.experiment_defined) return fmi2EnterInitializationMode(instance);
            return fmi2SetupExperiment(instance, byte() & 1, number(1e-6), number(0), one_in(3), number(1));
        case INITIALIZATION: return fmi2ExitInitializationMode(instance);
        case STEP_COMPLETE: return step(instance);
        default: return fmi2Reset(instance);
    }
}

static void replace_instance(void) {
    static const char *const names[] = {NULL, "", " \t", "100 %s %n", "unit", "unit", "unit", "unit"};
    const unsigned slot = byte() % N_INSTANCES, name = byte() % 8, guid = byte(), kind = byte(), functions = byte();
    const int valid = name >= 3 && guid < 240 && kind < 250 && functions < 250;
    fmi2FreeInstance(components[slot]);
    messages = 0;
    components[slot] = fmi2Instantiate(
        names[name], kind < 250 ? fmi2CoSimulation : (fmi2Type)(kind == 255 ? -1 : kind % 2 * 2),
        guid < 240 ? model_guid : guid < 244 ? NULL : "{100%-wrong}", byte() & 1 ? NULL : "file:///nowhere",
        functions < 250 ? (functions < 200 ? &with_logger : &without_logger) : NULL, fmi2False, functions & 1);
    CHECK(!components[slot] == !valid);
    CHECK(valid ? !messages : messages <= 1);
}

static fmi2Status deserialize(Instance *instance, fmi2FMUstate *place) {
    fmi2FMUstate state = NULL, result = NULL;
    char blob[BLOB];
    const size_t size = one_in(8) ? byte() * (size_t)BLOB / 200 : BLOB;
    char *bytes = calloc(size + 1, 1); /* on the heap, so that the sanitizer sees its ends */
    CHECK(fmi2GetFMUstate(instance, &state) == fmi2OK);
    CHECK(fmi2SerializeFMUstate(instance, state, blob, BLOB) == fmi2OK);
    CHECK(fmi2FreeFMUstate(instance, &state) == fmi2OK);
    memcpy(bytes, blob, size < BLOB ? size : BLOB);
    for (unsigned flips = byte() % 4; flips && size; --flips) {
        const unsigned at = byte() << 8 | byte();
        bytes[at % size] ^= (char)byte();
    }
    const int same = size == BLOB && memcmp(bytes, blob, BLOB) == 0;
    const fmi2Status status = fmi2DeSerializeFMUstate(instance, bytes, size, &result);
    free(bytes);
    CHECK((status == fmi2OK) == same && !result == !same);
    if (result) {
        CHECK(fmi2FreeFMUstate(instance, place) == fmi2OK);
        *place = result;
    }
    return status;
}

static fmi2Status on_state(Instance *instance) {
    static Snapshot foreign; /* all zero: no mark of ours */
    static char buffer[BLOB];
    size_t size = 0;
    fmi2FMUstate *place = &saved[byte() % N_SAVED], none = NULL, other = &foreign;
    if (one_in(16)) place = byte() & 1 ? &none : &other;
    const int there = place != &other && *place;
    switch (byte() % 6) {
        case 0: return place == &none ? fmi2GetFMUstate(instance, NULL) : fmi2GetFMUstate(instance, place);
        case 1: return fmi2SetFMUstate(instance, *place);
        case 2: return fmi2FreeFMUstate(instance, one_in(8) ? NULL : place);
        case 3: return fmi2SerializedFMUstateSize(instance, *place, one_in(8) ? NULL : &size);
        case 4: return fmi2SerializeFMUstate(instance, *place, one_in(8) ? NULL : buffer, BLOB - one_in(8));
        default: return instance && (there || place == &saved[0]) ? deserialize(instance, place)
                                                                  : fmi2DeSerializeFMUstate(instance, NULL, 0, place);
    }
}

static fmi2Status on_values(Instance *instance) {
    fmi2ValueReference vr[MAX_N];
    double reals[MAX_N];
    int whole[MAX_N];
    fmi2String texts[MAX_N] = {"text"};
    const unsigned kind = byte() % 8;
    const size_t first = byte() & 1 ? MODEL_FIRST_INPUT : 0, n = references(vr, first, first ? MODEL_N_INPUTS : 0);
    const fmi2ValueReference *r = one_in(32) ? NULL : vr;
    for (size_t i = 0; i < n; ++i) {
        reals[i] = kind < 4 ? number(vr[i] < MODEL_N_VARIABLES ? model_variables[vr[i]].start : 0) : CANARY;
        whole[i] = kind >= 4 ? CANARY : one_in(4) ? (int)(byte() << 24) : (int)byte() % 8;
    }
    fmi2Status status = fmi2OK;
    switch (kind) {
        case 0: return fmi2SetReal(instance, r, n, reals);
        case 1: return fmi2SetInteger(instance, r, n, whole);
        case 2: return fmi2SetBoolean(instance, r, n, whole);
        case 3: return fmi2SetString(instance, r, n, texts);
        case 4: status = fmi2GetReal(instance, r, n, reals); break;
        case 5: status = fmi2GetInteger(instance, r, n, whole); break;
        case 6: status = fmi2GetBoolean(instance, r, n, whole); break;
        default: return fmi2GetString(instance, r, n, texts);
    }
    for (size_t i = 0; i < n && status != fmi2OK; ++i) CHECK(reals[i] == CANARY && whole[i] == CANARY);
    return status;
}

static fmi2Status on_derivatives(Instance *instance) {
    fmi2ValueReference vr[MAX_N], known[MAX_N];
    double values[MAX_N], results[MAX_N] = {0};
    int order[MAX_N];
    const unsigned kind = byte() % 3;
    const size_t first = kind ? MODEL_FIRST_OUTPUT : MODEL_FIRST_INPUT;
    const size_t n = references(vr, first, kind ? MODEL_N_OUTPUTS : MODEL_N_INPUTS);
    const fmi2ValueReference *r = one_in(32) ? NULL : vr;
    for (size_t i = 0; i < MAX_N; ++i) {
        values[i] = number(0);
        order[i] = one_in(16) ? (int)(byte() << 24) : kind ? 1 : 1 + (int)byte() % 2;
    }
    if (kind == 0) return fmi2SetRealInputDerivatives(instance, r, n, one_in(32) ? NULL : order, values);
    if (kind == 1) return fmi2GetRealOutputDerivatives(instance, r, n, one_in(32) ? NULL : order, results);
    const size_t n_known = references(known, byte() & 1 ? MODEL_FIRST_INPUT : 0, MODEL_N_INPUTS);
    return fmi2GetDirectionalDerivative(instance, r, n, known, n_known, one_in(32) ? NULL : values, results);
}

static fmi2Status on_status(Instance *instance) {
    fmi2Status status;
    fmi2Real real;
    fmi2Integer whole;
    fmi2String text;
    const fmi2StatusKind kind = (fmi2StatusKind)(byte() % 4);
    const int nowhere = one_in(8);
    switch (byte() % 6) {
        case 0: return fmi2GetStatus(instance, kind, nowhere ? NULL : &status);
        case 1: return fmi2GetRealStatus(instance, kind, nowhere ? NULL : &real);
        case 2: return fmi2GetIntegerStatus(instance, kind, nowhere ? NULL : &whole);
        case 3: return fmi2GetBooleanStatus(instance, kind, nowhere ? NULL : &whole);
        case 4: return fmi2GetStringStatus(instance, kind, nowhere ? NULL : &text);
        default: return fmi2CancelStep(instance);
    }
}

static fmi2Status on_phase(Instance *instance) {
    static const fmi2String categories[] = {"logStatusError", "logAll", "logStatusWarning", "100 %", NULL};
    const unsigned n = byte() % 3, first = byte() % 4;
    switch (byte() % 6) {
        case 0: return fmi2SetupExperiment(instance, fmi2False, 0, number(0), byte() & 1, number(1));
        case 1: return fmi2EnterInitializationMode(instance);
        case 2: return fmi2ExitInitializationMode(instance);
        case 3: return fmi2Terminate(instance);
        case 4: return fmi2Reset(instance);
        default: return fmi2SetDebugLogging(instance, !one_in(4), n, one_in(8) ? NULL : categories + first);
    }
}

/* Zero, or derive anew, what is derived before it is used: constants; in initialization mode outputs and states. */
#ifdef MODEL_CONTAINER
static void forget_derived(State *s) {
    if (s->phase != INITIALIZATION) return;
    s->system.run.outputs_stale = 1;
    CONTAINER(show)(&s->system);
}
#else
static void forget_derived(State *s) {
    memset(s->constants, 0, sizeof s->constants);
    s->ticks_per_draw = s->constants_stale = s->outputs_stale = 0;
    if (s->phase != INITIALIZATION) return;
    memset(outputs(s), 0, MODEL_N_OUTPUTS * sizeof(double));
    memset(s->states, 0, sizeof s->states);
    memset(s->modes, 0, sizeof s->modes);
    memset(s->shared, 0, sizeof s->shared);
#if !MODEL_SAMPLED
    memset(s->end_inputs, 0, sizeof s->end_inputs);
#endif
}
#endif

static void check_refusal(Instance before, Instance after) {
    CHECK(messages == (before.callbacks.logger && before.logged & LOG_ERROR ? 1 : 0));
    CHECK(before.name == after.name && before.logged == after.logged);
    if (after.state.phase == FAILED && before.state.phase == STEP_COMPLETE) return; /* a step that failed */
    forget_derived(&before.state);
    forget_derived(&after.state);
    CHECK(memcmp(&before.state, &after.state, sizeof(State)) == 0);
}

static void call_once(void) {
    static fmi2Status (*const groups[])(Instance *) = {proceed,   proceed,   step,           on_values, on_values,
                                                       on_status, on_state, on_derivatives, on_phase};
    const unsigned choice = byte();
    if (choice >= 250) {
        replace_instance();
        return;
    }
    Instance *instance = components[byte() % 8 < 6 ? 0 : 1 + choice % 2];
    static Instance before;
    if (instance) before = *instance;
    messages = 0;
    const fmi2Status status = groups[choice % (sizeof groups / sizeof *groups)](instance);
    CHECK(status == fmi2OK || status == fmi2Error);
    CHECK(instance || status == fmi2Error || work > MAX_WORK);
    if (status == fmi2OK) CHECK(messages == 0);
    if (status == fmi2Error && instance) check_refusal(before, *instance);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    next_byte = data, last_byte = data + size, work = 0;
    components[0] = create(&with_logger);
    if (one_in(2)) set_scene(components[0]);
    CHECK(strcmp(fmi2GetVersion(), "2.0") == 0 && strcmp(fmi2GetTypesPlatform(), "default") == 0);
    for (int i = 0; i < MAX_CALLS && next_byte < last_byte; ++i) call_once();
    fmi2Component owner = create(&with_logger);
    for (int i = 0; i < N_SAVED; ++i) CHECK(fmi2FreeFMUstate(owner, &saved[i]) == fmi2OK && !saved[i]);
    fmi2FreeInstance(owner);
    for (int i = 0; i < N_INSTANCES; ++i) fmi2FreeInstance(components[i]), components[i] = NULL;
    return 0;
}
