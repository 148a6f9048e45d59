/* Tests of inputs, parameters, states and outputs; each failure is a sentence that names the variable. */
#include <float.h>

#include "instance.h"

static size_t first_not_finite(const double *values, size_t n) {
    size_t i = 0;
    while (i < n && real_is_finite(values[i])) ++i;
    return i;
}

static RARE int each_finite(const double *values, size_t n) { return first_not_finite(values, n) == n; }

/* 1 if every number is finite. Their sum tells: it is not finite if one of them is not. (It also
 * overflows if they are huge; then each is looked at.) Four sums, so that none waits for another. */
static int all_finite(const double *values, size_t n) {
    double sums[4] = {0};
    size_t i = 0;
    for (; i + 4 <= n; i += 4)
        for (size_t j = 0; j < 4; ++j) sums[j] += values[i + j];
    for (; i < n; ++i) sums[i % 4] += values[i];
    const double sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    return real_fabs(sum) <= DBL_MAX ? 1 : each_finite(values, n);
}

static RARE int input_invalid(const Instance *instance, const double *u) {
    size_t i = first_not_finite(u, MODEL_N_INPUTS);
    fail(instance, "Input %s is %s; it must be finite.", model_variables[MODEL_FIRST_INPUT + i].name,
         not_finite(u[i]));
    return 0;
}

#ifdef MODEL_WHOLE_REALS
/* 1 if each of n neighbours from a reference on may have its value; else says which may not. */
static int wholes_valid(const Instance *instance, size_t first, size_t n, const double *values,
                        const char *kind) {
    for (size_t i = 0; i < n; ++i)
        if (!may_be(&model_variables[first + i], values[i])) {
            fail(instance, "%s %s is %.17g; it must be %s.", kind, model_variables[first + i].name,
                 values[i], model_variables[first + i].range);
            return 0;
        }
    return 1;
}
#endif

static int inputs_valid(const Instance *instance) {
    const double *u = STATE_OF(instance)->values + MODEL_FIRST_INPUT;
    if (!all_finite(u, MODEL_N_INPUTS)) return input_invalid(instance, u);
#ifdef MODEL_WHOLE_REALS
    return wholes_valid(instance, MODEL_FIRST_INPUT, MODEL_N_INPUTS, u, "Input");
#else
    return 1;
#endif
}

static RARE int check_fails(const Instance *instance, double check, const char *sentence) {
    fail(instance, "%s (value %.17g, must be positive).", sentence, check);
    return 0;
}

static INLINED int checks_pass(const Instance *instance, const double *checks, size_t n,
                       const char *const *sentences) {
    for (size_t i = 0; i < n; ++i)
        if (!(checks[i] > 0)) return check_fails(instance, checks[i], sentences[i]);
    return 1;
}

static RARE int output_invalid(const Instance *instance, const double *y, double t) {
    size_t i = first_not_finite(y, MODEL_N_OUTPUTS);
    fail(instance, "Output %s is %s at t = %.17g s; the inputs describe a state the model cannot "
                   "compute (divergence or a singular configuration).",
         model_variables[MODEL_FIRST_OUTPUT + i].name, not_finite(y[i]), t);
    return 0;
}

#ifdef MODEL_INTEGER_OUTPUTS
static int integers_valid(const Instance *instance, const double *y, double t) {
    for (size_t i = 0; i < MODEL_N_OUTPUTS; ++i) {
        const ModelVariable *variable = &model_variables[MODEL_FIRST_OUTPUT + i];
        if (variable->type == TYPE_INTEGER && !is_integer(y[i])) {
            fail(instance, "Output %s is %.17g at t = %.17g s; an Integer is a whole number of at most "
                           "32 bits.",
                 variable->name, y[i], t);
            return 0;
        }
    }
    return 1;
}
#endif

static IN_PLACE int outputs_valid(const Instance *instance, const double *y, double t) {
    if (!all_finite(y, MODEL_N_OUTPUTS)) return output_invalid(instance, y, t);
#if defined(MODEL_WHOLE_REALS)
    return wholes_valid(instance, MODEL_FIRST_OUTPUT, MODEL_N_OUTPUTS, y, "Output");
#elif defined(MODEL_INTEGER_OUTPUTS)
    return integers_valid(instance, y, t);
#else
    return 1;
#endif
}

static RARE int state_invalid(const Instance *instance, const double *x, double t) {
    size_t i = first_not_finite(x, MODEL_N_STATES);
    fail(instance, "State %s is %s at t = %.17g s; it diverges.", model_states[i], not_finite(x[i]), t);
    return 0;
}

static IN_PLACE int states_valid(const Instance *instance, const double *x, double t) {
    return MODEL_N_STATES == 0 || all_finite(x, MODEL_N_STATES) ? 1 : state_invalid(instance, x, t);
}

static RARE int recalibrated(Instance *instance) {
    State *s = STATE_OF(instance);
    double checks[AT_LEAST_ONE(MODEL_N_STATIC_CHECKS)];
    model_calibrate(parameters(s), s->constants, checks, &s->ticks_per_draw);
    if (!checks_pass(instance, checks, MODEL_N_STATIC_CHECKS, model_static_checks)) return 0;
    s->constants_stale = 0;
    constants_changed(s);
    return 1;
}

/* Derives the constants if a parameter has changed. Returns 0 if the parameters contradict. */
static int calibrated(Instance *instance) {
    return STATE_OF(instance)->constants_stale ? recalibrated(instance) : 1;
}
