/* fmi2DoStep, and the FMI functions that ask for its status. */
#include <float.h>

#include "instance.h"

/* A host's clock is summed or rounded to a nanosecond: so much may its time differ from ours. */
#define CLOCK_TOLERANCE 1e-9
static double time_tolerance(double t, double h) {
    const double scale = real_fabs(t) > 1 ? real_fabs(t) : 1;
    return 1e-6 * h + CLOCK_TOLERANCE * scale;
}

/* How far a step may begin from the end of the previous one. Far from zero the tolerance of the time
 * would hide a step that the host has left out, so it is a quarter of the step there; but a clock that
 * is rounded to a nanosecond, and then to a double, is always right. */
static double start_tolerance(double t, double h) {
    const double rounding = CLOCK_TOLERANCE + 4 * DBL_EPSILON * real_fabs(t);
    const double most = h / 4 > rounding ? h / 4 : rounding;
    const double usual = time_tolerance(t, h);
    return usual < most ? usual : most;
}

/* Whether a step is valid, by the whole rule; says what is wrong if it is not. */
static RARE int step_valid_within(const Instance *instance, double t, double h) {
    const State *s = &instance->state;
    const int continues = real_fabs(t - s->time) <= start_tolerance(t, h);
    const int ends_late = s->stop_time_defined && t + h > s->stop_time + time_tolerance(s->stop_time, h);
    if (!(h > 0 && real_is_finite(t + h)))
        fail(instance, "fmi2DoStep: the step from t = %.17g s of h = %.17g s is not a positive finite "
                       "step.",
             t, h);
    else if (!continues)
        fail(instance, "fmi2DoStep: the communication point %.17g s is not the end of the previous "
                       "step, %.17g s.",
             t, s->time);
    else if (ends_late)
        fail(instance, "fmi2DoStep: the step ends at %.17g s, after the stop time %.17g s.", t + h,
             s->stop_time);
    else
        return 1;
    return 0;
}

/* Most steps begin within the smallest tolerance and end before the stop time. */
static int step_valid(const Instance *instance, double t, double h) {
    const State *s = &instance->state;
    if (h > 0 && real_fabs(t - s->time) <= CLOCK_TOLERANCE && t + h <= s->latest_end) return 1;
    return step_valid_within(instance, t, h);
}

/* A step that is wrong for its time, size or inputs changes nothing; one that fails on the way, or
 * would take seconds, leaves the instance in the error state, from which reset and fmi2SetFMUstate
 * lead back. */
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    Instance *instance = allowed(c, ALLOWED_STEP, "fmi2DoStep");
    const double t = currentCommunicationPoint, h = communicationStepSize;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!instance || !step_valid(instance, t, h) || !step_fits(instance, t, h)) return fmi2Error;
    if (!inputs_valid(instance) || !calibrated(instance)) return fmi2Error;
    if (!advance(instance, t, h)) {
        instance->state.phase = FAILED;
        return fmi2Error;
    }
    instance->state.time = t + h;
    return fmi2OK;
}

/* doStep is synchronous: there is never a step to cancel. */
fmi2Status fmi2CancelStep(fmi2Component c) {
    Instance *instance = allowed(c, ALLOWED_ALWAYS, "fmi2CancelStep");
    if (!instance) return fmi2Error;
    return fail(instance, "fmi2CancelStep: no step is in progress (fmi2DoStep is synchronous).");
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value) {
    Instance *instance = allowed(c, ALLOWED_STATUS, "fmi2GetStatus");
    if (!instance) return fmi2Error;
    if (s != fmi2DoStepStatus || !value)
        return fail(instance, "fmi2GetStatus: only fmi2DoStepStatus is of this type.");
    *value = instance->state.phase == FAILED ? fmi2Error : fmi2OK;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value) {
    Instance *instance = allowed(c, ALLOWED_STATUS, "fmi2GetRealStatus");
    if (!instance) return fmi2Error;
    if (s != fmi2LastSuccessfulTime || !value)
        return fail(instance, "fmi2GetRealStatus: only fmi2LastSuccessfulTime is of this type.");
    *value = instance->state.time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value) {
    Instance *instance = allowed(c, ALLOWED_STATUS, "fmi2GetIntegerStatus");
    (void)s;
    (void)value;
    if (!instance) return fmi2Error;
    return fail(instance, "fmi2GetIntegerStatus: FMI 2.0 defines no status of this type.");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value) {
    Instance *instance = allowed(c, ALLOWED_STATUS, "fmi2GetBooleanStatus");
    if (!instance) return fmi2Error;
    if (s != fmi2Terminated || !value)
        return fail(instance, "fmi2GetBooleanStatus: only fmi2Terminated is of this type.");
    *value = fmi2False;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value) {
    Instance *instance = allowed(c, ALLOWED_STATUS, "fmi2GetStringStatus");
    if (!instance) return fmi2Error;
    if (s != fmi2PendingStatus || !value)
        return fail(instance, "fmi2GetStringStatus: only fmi2PendingStatus is of this type.");
    *value = "";
    return fmi2OK;
}
