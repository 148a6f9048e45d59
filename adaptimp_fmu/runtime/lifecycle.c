/* The life of an instance from fmi2Instantiate to fmi2FreeInstance, and which FMI function may be
 * called in which state. */
#include <stdlib.h>
#include <string.h>

#include "instance.h"

/* Where each group of functions is allowed (FMI 2.0.5, section 4.2.4), as data. */
enum {
    ALLOWED_ALWAYS = INSTANTIATED | INITIALIZATION | STEP_COMPLETE | TERMINATED | FAILED,
    ALLOWED_SETUP = INSTANTIATED,
    ALLOWED_ENTER = INSTANTIATED,
    ALLOWED_EXIT = INITIALIZATION,
    ALLOWED_GET = INITIALIZATION | STEP_COMPLETE | TERMINATED | FAILED,
    ALLOWED_SET = INSTANTIATED | INITIALIZATION | STEP_COMPLETE,
    ALLOWED_STEP = STEP_COMPLETE,
    ALLOWED_STATUS = STEP_COMPLETE | TERMINATED | FAILED,
    ALLOWED_TERMINATE = STEP_COMPLETE
};

static const char *phase_name(int phase) {
    switch (phase) {
        case INSTANTIATED: return "instantiated";
        case INITIALIZATION: return "initialization mode";
        case STEP_COMPLETE: return "step complete";
        case TERMINATED: return "terminated";
        default: return "error";
    }
}

static RARE Instance *not_allowed(const Instance *instance, const char *function) {
    fail(instance, "%s is not allowed in state \"%s\".", function,
         phase_name(instance->state.phase));
    return NULL;
}

/* The instance behind a component, or NULL after saying why the call is not allowed. */
static Instance *allowed(fmi2Component component, int phases, const char *function) {
    Instance *instance = (Instance *)component;
    if (!instance) return NULL;
    return instance->state.phase & phases ? instance : not_allowed(instance, function);
}

static int is_blank(const char *text) { return !text || text[strspn(text, " \t\r\n")] == '\0'; }

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn) {
    (void)fmuResourceLocation;
    (void)visible;
    if (!functions) return NULL;
    if (is_blank(instanceName))
        return refuse(functions, instanceName, loggingOn, "The instance name is missing or blank.");
    if (fmuType != fmi2CoSimulation)
        return refuse(functions, instanceName, loggingOn,
                      "fmuType is %d; this FMU is for co-simulation (%d).", (int)fmuType,
                      (int)fmi2CoSimulation);
    if (!fmuGUID || strcmp(fmuGUID, model_guid) != 0)
        return refuse(functions, instanceName, loggingOn,
                      "The GUID \"%s\" is not this binary's \"%s\": modelDescription.xml and binary "
                      "do not belong together.",
                      fmuGUID ? fmuGUID : "(null)", model_guid);
    Instance *instance = calloc(1, sizeof *instance);
    char *name = malloc(strlen(instanceName) + 1);
    if (!instance || !name) {
        free(instance);
        free(name);
        return refuse(functions, instanceName, loggingOn, "Out of memory.");
    }
    instance->name = strcpy(name, instanceName);
    instance->callbacks = *functions;
    instance->logged = loggingOn ? LOG_ALL : 0;
    start_afresh(&instance->state);
    return instance;
}

void fmi2FreeInstance(fmi2Component c) {
    Instance *instance = (Instance *)c;
    if (!instance) return;
    release(&instance->state);
    free(instance->name);
    free(instance);
}

fmi2Status fmi2Reset(fmi2Component c) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2Reset");
    if (!instance) return fmi2Error;
    start_afresh(&instance->state);
    return fmi2OK;
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[]) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2SetDebugLogging");
    int mask = nCategories ? 0 : LOG_ALL;
    if (!instance) return fmi2Error;
    if (nCategories && !categories)
        return fail(instance, "fmi2SetDebugLogging: the array of categories is missing.");
    for (size_t i = 0; i < nCategories; ++i) {
        int category = category_mask(categories[i]);
        if (!category)
            return fail(instance, "fmi2SetDebugLogging: unknown category \"%s\"; known are "
                                  "logStatusError, logStatusWarning, logAll.",
                        categories[i] ? categories[i] : "(null)");
        mask |= category;
    }
    /* On with categories means these only (FMI 2.0.5, 2.1.5). */
    instance->logged = loggingOn ? mask : instance->logged & ~mask;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
    Instance *instance = allowed(c, ALLOWED_SETUP, "fmi2SetupExperiment");
    (void)toleranceDefined;
    (void)tolerance;
    if (!instance) return fmi2Error;
    if (!real_is_finite(startTime))
        return fail(instance, "fmi2SetupExperiment: the start time is %g.", startTime);
    if (stopTimeDefined && !(stopTime >= startTime && real_is_finite(stopTime)))
        return fail(instance, "fmi2SetupExperiment: the stop time %.17g s does not follow the start "
                              "time %.17g s.",
                    stopTime, startTime);
    State *s = &instance->state;
    begin_at(s, startTime);
    if (stopTimeDefined) {
        s->stop_time_defined = 1;
        s->stop_time = s->latest_end = stopTime;
    }
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    Instance *instance = allowed(c, ALLOWED_ENTER, "fmi2EnterInitializationMode");
    if (!instance) return fmi2Error;
    if (!instance->state.experiment_defined)
        return fail(instance, "fmi2EnterInitializationMode: fmi2SetupExperiment was not called.");
    enter_initialization(&instance->state);
    return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    Instance *instance = allowed(c, ALLOWED_EXIT, "fmi2ExitInitializationMode");
    if (!instance) return fmi2Error;
    return initialized(instance) ? fmi2OK : fmi2Error;
}

fmi2Status fmi2Terminate(fmi2Component c) {
    Instance *instance = allowed(c, ALLOWED_TERMINATE, "fmi2Terminate");
    if (!instance) return fmi2Error;
    instance->state.phase = TERMINATED;
    return fmi2OK;
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }
