/* The system inside of a container, as the functions of FMI see it. step.c knows the components; here are
 * initialization, the communication step of several inner steps, and the messages of components. */
#include <float.h>
#include <string.h>

#include "instance.h"

#if CONTAINER_IS_PLAIN
/* Defined with the variables: what no run leaves behind, in words. */
static const char *position_fault(const State *s);
#endif

/* 1e7 inner steps take seconds; more than that in one doStep is a mistake, not a step. */
#define MAX_INNER_STEPS 1e7

#define DEFAULT_DIGITS 6                           /* of %g */

/* Writes an argument of a failure as a conversion such as %s, %d or %.17g wants; returns its number of characters. */
static int write_argument(char *text, size_t size, const char *conversion, const FailureArgument *argument) {
    int digits = 0;
    for (const char *c = conversion + 1; *c == '.' || (*c >= '0' && *c <= '9'); ++c)
        if (*c != '.') digits = 10 * digits + (*c - '0');
    if (argument->kind == 's') return snprintf(text, size, "%s", argument->text);
    if (argument->kind == 'd') return snprintf(text, size, "%.0f", argument->number);
    return snprintf(text, size, "%.*g", digits ? digits : DEFAULT_DIGITS, argument->number);
}

/* The sentence of a failure with its arguments. */
static void write_failure(const Failure *failure, char *text, size_t size) {
    size_t used = 0;
    int next = 0;
    for (const char *s = failure->sentence; *s && used + 1 < size; ++s) {
        if (s[0] != '%' || s[1] == '%' || next == failure->n) {
            text[used++] = *s;
            s += s[0] == '%' && s[1] == '%';
            continue;
        }
        used += (size_t)write_argument(text + used, size - used, s, &failure->arguments[next++]);
        while (s[1] && strspn(s, ".%0123456789")) ++s;
    }
    text[used < size ? used : size - 1] = '\0';
}

/* Logs what a component has refused. */
static RARE int fail_in_component(const Instance *instance, const Failure *failure) {
    char text[MESSAGE_LENGTH];
    write_failure(failure, text, sizeof text);
    if (failure->component)
        fail(instance, "%s: %s", failure->component, text);
    else
        fail(instance, "%s", text);
    return 0;
}

/* The memory of a new instance is zero; FMUs of other tools keep what they hold. */
static void start_afresh(State *s) {
#if CONTAINER_IS_PLAIN
    memset(s, 0, sizeof *s);
#endif
    CONTAINER(reset)(&s->system);
    s->start_time = s->stop_time = s->time = s->latest_end = 0;
    s->stop_time_defined = s->experiment_defined = 0;
    s->phase = INSTANTIATED;
}

/* The experiment begins at a time, s, and has no end. */
static void begin_at(State *s, double start_time) {
    s->start_time = s->time = start_time;
    s->stop_time_defined = 0;
    s->stop_time = 0;
    s->latest_end = DBL_MAX;
    s->experiment_defined = 1;
}

static void enter_initialization(State *s) {
    CONTAINER(begin)(&s->system, s->start_time);
    s->phase = INITIALIZATION;
}

/* Gives back what the system holds besides its memory. */
static void release(State *s) {
#if CONTAINER_IS_PLAIN
    (void)s;
#else
    CONTAINER(free)(&s->system);
#endif
}

/* Stores a value that is_settable has found right. Its component learns of it. */
static int store(Instance *instance, fmi2ValueReference reference, double value) {
    Failure failure;
    return CONTAINER(set)(&instance->state.system, reference, value, &failure) ||
           fail_in_component(instance, &failure);
}

static void note_change(State *s, int parameter_changed) {
    (void)s;
    (void)parameter_changed;
}

static int inputs_valid(const Instance *instance) {
    for (uint32_t i = MODEL_FIRST_INPUT; i < MODEL_FIRST_OUTPUT; ++i) {
        const ModelVariable *input = &model_variables[i];
        const double value = SLOT(&instance->state, i);
        if (!real_is_finite(value))
            fail(instance, "Input %s is %s; it must be finite.", input->name, not_finite(value));
        else if (!may_be(input, value))
            fail(instance, "Input %s is %.17g; it must be %s.", input->name, value, input->range);
        else
            continue;
        return 0;
    }
    return 1;
}

/* Components derive their constants themselves. */
static int calibrated(const Instance *instance) {
    (void)instance;
    return 1;
}

static void refresh_outputs(State *s) { CONTAINER(show)(&s->system); }

/* The end of initialization mode, of all components or of none; returns 0 after saying what is wrong. FMUs of other
 * tools cannot go back into initialization mode, so that the instance fails with them. */
static int initialized(Instance *instance) {
#if CONTAINER_IS_PLAIN
    const State before = instance->state;
#endif
    Failure failure;
    if (!inputs_valid(instance)) return 0;
    if (!CONTAINER(finish)(&instance->state.system, &failure)) {
#if CONTAINER_IS_PLAIN
        instance->state = before;
#else
        instance->state.phase = FAILED;
#endif
        return fail_in_component(instance, &failure);
    }
    instance->state.phase = STEP_COMPLETE;
    return 1;
}

/* Whether a step is a whole number of inner steps; how many is left to `advance`. */
static RARE int is_multiple(const Instance *instance, double t, double h) {
    const double ratio = h / CONTAINER(step_size), nearest = real_floor(ratio + 0.5);
    const double rounding = 1e-9 + 4 * DBL_EPSILON * real_fabs(t + h) / CONTAINER(step_size);
    if (!(ratio <= MAX_INNER_STEPS) || (nearest >= 1 && real_fabs(ratio - nearest) <= rounding)) return 1;
    fail(instance, "fmi2DoStep: the step of h = %.17g s is not a whole multiple of the inner step, %.17g s.", h,
         CONTAINER(step_size));
    return 0;
}

static int step_fits(const Instance *instance, double t, double h) {
    return h == CONTAINER(step_size) || is_multiple(instance, t, h);
}

static RARE int too_many_inner_steps(const Instance *instance, double h) {
    fail(instance, "A step of %.17g s holds %g inner steps of %.17g s, more than %g.", h, h / CONTAINER(step_size),
         CONTAINER(step_size), MAX_INNER_STEPS);
    return 0;
}

static int advance(Instance *instance, double t, double h) {
    const double ratio = h / CONTAINER(step_size);
    Failure failure;
    (void)t;
    if (!(ratio <= MAX_INNER_STEPS)) return too_many_inner_steps(instance, h);
    return CONTAINER(step)(&instance->state.system, (uint64_t)(ratio + 0.5), &failure) ||
           fail_in_component(instance, &failure);
}
