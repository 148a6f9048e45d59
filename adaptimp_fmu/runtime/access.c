/* The FMI functions that get and set variables. A call that is refused changes nothing. */
#include <string.h>

#include "instance.h"

static const char *const type_names[] = {"Real", "Integer", "Boolean", "String"};

static int is_variable(const Instance *instance, fmi2ValueReference reference, VariableType type,
                       const char *function) {
    if (reference < MODEL_N_VARIABLES && model_variables[reference].type == type) return 1;
    if (reference >= MODEL_N_VARIABLES)
        fail(instance, "%s: there is no variable with value reference %u.", function,
             (unsigned)reference);
    else
        fail(instance, "%s: %s (value reference %u) is a %s, not a %s.", function,
             model_variables[reference].name, (unsigned)reference,
             type_names[model_variables[reference].type], type_names[type]);
    return 0;
}

static int is_settable(const Instance *instance, const ModelVariable *variable, double value,
                       const char *function) {
    if (variable->role == ROLE_INPUT) return 1;
    if (variable->role == ROLE_OUTPUT) {
        fail(instance, "%s: %s is an output.", function, variable->name);
        return 0;
    }
    if (variable->role == ROLE_FIXED_PARAMETER && instance->state.phase == STEP_COMPLETE) {
        fail(instance, "%s: %s is a fixed parameter; it can be set until initialization ends.",
             function, variable->name);
        return 0;
    }
    if (!real_is_finite(value)) {
        fail(instance, "%s: %s = %s is not finite.", function, variable->name, not_finite(value));
        return 0;
    }
    if (!(value >= variable->min && value <= variable->max) || !may_be(variable, value)) {
        fail(instance, "%s: %s = %.17g must be %s.", function, variable->name, value, variable->range);
        return 0;
    }
#ifdef MODEL_DIVISOR
    if (variable == &model_variables[MODEL_DIVISOR] && value < 1) {
        fail(instance, "%s: %s = %.17g must be at least 1, since it divides the number of ticks.",
             function, variable->name, value);
        return 0;
    }
#endif
    return 1;
}

/* An Integer output is any number until initialization ends or a step has succeeded; C must not
 * convert one that no Integer can hold. */
static int is_gettable(const Instance *instance, fmi2ValueReference reference, const char *function) {
    const ModelVariable *variable = &model_variables[reference];
    const double value = SLOT(&instance->state, reference);
    if (variable->type != TYPE_INTEGER || is_integer(value)) return 1;
    fail(instance, "%s: %s = %.17g is not an Integer.", function, variable->name, value);
    return 0;
}

static int arrays_present(const Instance *instance, size_t n, const void *references,
                          const void *values, const char *function) {
    if (n == 0 || (references && values)) return 1;
    fail(instance, "%s: an array is missing.", function);
    return 0;
}

static int stepping(const Instance *instance) {
    return instance && instance->state.phase == STEP_COMPLETE;
}

static int is_of_kind(const ModelRun *run, VariableType type, int only_inputs) {
    return run->type == type && (!only_inputs || run->role == ROLE_INPUT);
}

/* 1 if the references are n neighbours of one kind, counting up: what most hosts ask for at every step,
 * needing no more checks. */
static int are_neighbours(const fmi2ValueReference vr[], size_t n, VariableType type, int only_inputs) {
    if (n == 0 || !vr || vr[0] >= MODEL_N_VARIABLES) return 0;
    const ModelRun *run = &model_runs[vr[0]];
    if (!is_of_kind(run, type, only_inputs) || n > run->length) return 0;
    if (n <= 2) return vr[n - 1] == vr[0] + n - 1;
    return memcmp(vr, model_references + vr[0], n * sizeof *vr) == 0;
}

/* The same in any order. */
static int are_of_kind(const fmi2ValueReference vr[], size_t n, VariableType type, int only_inputs) {
    if (!vr) return 0;
    for (size_t i = 0; i < n; ++i)
        if (vr[i] >= MODEL_N_VARIABLES || !is_of_kind(&model_runs[vr[i]], type, only_inputs)) return 0;
    return 1;
}

/* 1 if the references count up by one and are of a kind, in any number of runs: what hosts ask of a container, whose
 * components lie apart. Other FMUs have one run of each kind. */
static int are_runs(const fmi2ValueReference vr[], size_t n, VariableType type, int only_inputs) {
#ifdef MODEL_CONTAINER
    if (n == 0 || !vr || vr[0] >= MODEL_N_VARIABLES || n > MODEL_N_VARIABLES - vr[0]) return 0;
    if (memcmp(vr, model_references + vr[0], n * sizeof *vr) != 0) return 0;
    for (size_t i = 0; i < n; i += model_runs[vr[i]].length)
        if (!is_of_kind(&model_runs[vr[i]], type, only_inputs)) return 0;
    return 1;
#else
    (void)vr;
    (void)n;
    (void)type;
    (void)only_inputs;
    return 0;
#endif
}

/* Where the run of reference i ends among n references. */
static size_t end_of_run(const fmi2ValueReference vr[], size_t i, size_t n) {
    const size_t end = i + model_runs[vr[i]].length;
    return end < n ? end : n;
}

/* to[i] = from[i] for i < n <= COPIED_AT_ONCE, with one jump. A loop ends with a branch that the processor
 * mispredicts, a memcpy reads several numbers at once that were written one by one, and waits for all
 * (docs/decisions/009). */
#define COPIED_AT_ONCE 24
#define COPY_1(i, to, from, CONVERT) case (i) + 1: (to)[i] = CONVERT((from)[i]); FALL_THROUGH
#define COPY_4(i, ...)                                                                             \
    COPY_1((i) + 3, __VA_ARGS__) COPY_1((i) + 2, __VA_ARGS__)                                      \
    COPY_1((i) + 1, __VA_ARGS__) COPY_1(i, __VA_ARGS__)
#define COPY(n, ...)                                                                               \
    switch (n) {                                                                                   \
        COPY_4(20, __VA_ARGS__) COPY_4(16, __VA_ARGS__) COPY_4(12, __VA_ARGS__)                    \
        COPY_4(8, __VA_ARGS__) COPY_4(4, __VA_ARGS__) COPY_4(0, __VA_ARGS__)                       \
        default: break;                                                                            \
    }

/* What a host does at every step comes first, in a function so small that it saves no register; the
 * rest are others: variables in any order, and all that needs more checks. */
#define DEFINE_SETTER(FUNCTION, VALUE, TYPE, CONVERT)                                              \
    static RARE fmi2Status FUNCTION##_checked(Instance *component, const fmi2ValueReference vr[],  \
                                              size_t nvr, const VALUE value[]) {                   \
        Instance *instance = allowed(component, ALLOWED_SET, #FUNCTION);                           \
        int parameter_changed = 0;                                                                 \
        if (!instance || !arrays_present(instance, nvr, vr, value, #FUNCTION)) return fmi2Error;   \
        for (size_t i = 0; i < nvr; ++i) {                                                         \
            if (!is_variable(instance, vr[i], TYPE, #FUNCTION) ||                                  \
                !is_settable(instance, &model_variables[vr[i]], CONVERT(value[i]), #FUNCTION))     \
                return fmi2Error;                                                                  \
            parameter_changed |= vr[i] < MODEL_FIRST_INPUT;                                        \
        }                                                                                          \
        for (size_t i = 0; i < nvr; ++i)                                                           \
            if (!store(instance, vr[i], CONVERT(value[i]))) return fmi2Error;                      \
        note_change(&instance->state, parameter_changed);                                          \
        return fmi2OK;                                                                             \
    }                                                                                              \
                                                                                                   \
    static APART fmi2Status FUNCTION##_scattered(Instance *instance, const fmi2ValueReference vr[],\
                                                 size_t nvr, const VALUE value[]) {                \
        if (stepping(instance) && value && are_runs(vr, nvr, TYPE, 1)) {                           \
            for (size_t i = 0, end; i < nvr; i = end) {                                            \
                double *own = &SLOT(&instance->state, vr[i]);                                      \
                end = end_of_run(vr, i, nvr);                                                      \
                for (size_t k = i; k < end; ++k) *own++ = CONVERT(value[k]);                       \
            }                                                                                      \
            return fmi2OK;                                                                         \
        }                                                                                          \
        if (!stepping(instance) || !value || !are_of_kind(vr, nvr, TYPE, 1))                       \
            return FUNCTION##_checked(instance, vr, nvr, value);                                   \
        for (size_t i = 0; i < nvr; ++i) SLOT(&instance->state, vr[i]) = CONVERT(value[i]);        \
        return fmi2OK;                                                                             \
    }                                                                                              \
                                                                                                   \
    fmi2Status FUNCTION(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,                \
                        const VALUE value[]) {                                                     \
        Instance *instance = (Instance *)c;                                                        \
        if (!stepping(instance) || !value || nvr > COPIED_AT_ONCE ||                               \
            !are_neighbours(vr, nvr, TYPE, 1))                                                     \
            return FUNCTION##_scattered(instance, vr, nvr, value);                                 \
        double *own = &SLOT(&instance->state, vr[0]);                                              \
        COPY(nvr, own, value, CONVERT)                                                             \
        return fmi2OK;                                                                             \
    }

#define DEFINE_GETTER(FUNCTION, VALUE, TYPE, CONVERT)                                              \
    static RARE fmi2Status FUNCTION##_checked(Instance *component, const fmi2ValueReference vr[],  \
                                              size_t nvr, VALUE value[]) {                         \
        Instance *instance = allowed(component, ALLOWED_GET, #FUNCTION);                           \
        if (!instance || !arrays_present(instance, nvr, vr, value, #FUNCTION)) return fmi2Error;   \
        for (size_t i = 0; i < nvr; ++i)                                                           \
            if (!is_variable(instance, vr[i], TYPE, #FUNCTION)) return fmi2Error;                  \
        if (instance->state.phase == INITIALIZATION) refresh_outputs(&instance->state);            \
        for (size_t i = 0; i < nvr; ++i)                                                           \
            if (!is_gettable(instance, vr[i], #FUNCTION)) return fmi2Error;                        \
        for (size_t i = 0; i < nvr; ++i) value[i] = CONVERT(SLOT(&instance->state, vr[i]));        \
        return fmi2OK;                                                                             \
    }                                                                                              \
                                                                                                   \
    static APART fmi2Status FUNCTION##_scattered(Instance *instance, const fmi2ValueReference vr[],\
                                                 size_t nvr, VALUE value[]) {                      \
        if (stepping(instance) && value && are_runs(vr, nvr, TYPE, 0)) {                           \
            for (size_t i = 0, end; i < nvr; i = end) {                                            \
                const double *own = &SLOT(&instance->state, vr[i]);                                \
                end = end_of_run(vr, i, nvr);                                                      \
                for (size_t k = i; k < end; ++k) value[k] = CONVERT(*own++);                       \
            }                                                                                      \
            return fmi2OK;                                                                         \
        }                                                                                          \
        if (!stepping(instance) || !value || !are_of_kind(vr, nvr, TYPE, 0))                       \
            return FUNCTION##_checked(instance, vr, nvr, value);                                   \
        for (size_t i = 0; i < nvr; ++i) value[i] = CONVERT(SLOT(&instance->state, vr[i]));        \
        return fmi2OK;                                                                             \
    }                                                                                              \
                                                                                                   \
    fmi2Status FUNCTION(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,                \
                        VALUE value[]) {                                                           \
        Instance *instance = (Instance *)c;                                                        \
        if (!stepping(instance) || !value || nvr > COPIED_AT_ONCE ||                               \
            !are_neighbours(vr, nvr, TYPE, 0))                                                     \
            return FUNCTION##_scattered(instance, vr, nvr, value);                                 \
        const double *own = &SLOT(&instance->state, vr[0]);                                        \
        COPY(nvr, value, own, CONVERT)                                                             \
        return fmi2OK;                                                                             \
    }

#define AS_IT_IS(x) ((double)(x))
#define AS_BOOLEAN(x) ((x) ? 1.0 : 0.0)
#define TO_INTEGER(x) ((fmi2Integer)(x))
#define TO_BOOLEAN(x) ((x) != 0)

DEFINE_SETTER(fmi2SetReal, fmi2Real, TYPE_REAL, AS_IT_IS)
DEFINE_SETTER(fmi2SetInteger, fmi2Integer, TYPE_INTEGER, AS_IT_IS)
DEFINE_SETTER(fmi2SetBoolean, fmi2Boolean, TYPE_BOOLEAN, AS_BOOLEAN)
DEFINE_GETTER(fmi2GetReal, fmi2Real, TYPE_REAL, AS_IT_IS)
DEFINE_GETTER(fmi2GetInteger, fmi2Integer, TYPE_INTEGER, TO_INTEGER)
DEFINE_GETTER(fmi2GetBoolean, fmi2Boolean, TYPE_BOOLEAN, TO_BOOLEAN)

/* A model has no string variables, so every reference is refused. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         fmi2String value[]) {
    Instance *instance = allowed(c, ALLOWED_GET, "fmi2GetString");
    if (!instance || !arrays_present(instance, nvr, vr, value, "fmi2GetString")) return fmi2Error;
    return nvr && !is_variable(instance, vr[0], TYPE_STRING, "fmi2GetString") ? fmi2Error : fmi2OK;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         const fmi2String value[]) {
    Instance *instance = allowed(c, ALLOWED_SET, "fmi2SetString");
    if (!instance || !arrays_present(instance, nvr, vr, value, "fmi2SetString")) return fmi2Error;
    return nvr && !is_variable(instance, vr[0], TYPE_STRING, "fmi2SetString") ? fmi2Error : fmi2OK;
}
