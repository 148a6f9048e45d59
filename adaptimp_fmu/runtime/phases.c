/* What an instance does in each phase of its life, whoever calls: FMI's functions (lifecycle.c, step.c) or
 * those of a contained model (contained.c). */
#include <float.h>

#include "instance.h"

static void start_afresh(State *s) {
    memset(s, 0, sizeof *s);
    for (size_t i = 0; i < MODEL_N_VARIABLES; ++i) s->values[i] = model_variables[i].start;
    s->phase = INSTANTIATED;
    s->constants_stale = 1;
    s->outputs_stale = 1;
}

/* The experiment begins at a time, s, and has no end. */
static void begin_at(State *s, double start_time) {
    s->start_time = s->time = start_time;
    s->stop_time_defined = 0;
    s->stop_time = 0;
    s->latest_end = DBL_MAX;
    s->experiment_defined = 1;
}

/* Bookkeeping after values have been stored. */
static void note_change(State *s, int parameter_changed) {
    s->constants_stale |= parameter_changed;
    s->outputs_stale = 1;
}

/* Outputs as functions of inputs and parameters during initialization. Numbers that cannot be
 * (NaN, a singular arm) are kept; the end of initialization reports them. */
static void refresh_outputs(State *s) {
    double static_checks[AT_LEAST_ONE(MODEL_N_STATIC_CHECKS)];
    double checks[AT_LEAST_ONE(MODEL_N_CHECKS)];
    if (!s->outputs_stale) return;
    model_calibrate(parameters(s), s->constants, static_checks, &s->ticks_per_draw);
    initialize_states(s);
    show_initial_outputs(s, checks);
    s->outputs_stale = 0;
}

static int initialization_valid(Instance *instance) {
    State *s = STATE_OF(instance);
    double checks[AT_LEAST_ONE(MODEL_N_CHECKS)];
    if (!calibrated(instance) || !inputs_valid(instance)) return 0;
    initialize_states(s);
    show_initial_outputs(s, checks);
    return checks_pass(instance, checks, MODEL_N_CHECKS, model_checks) &&
           outputs_valid(instance, outputs(s), s->time);
}

#define MOST_TICKS (INT64_C(1) << 53)              /* up to here a double counts ticks */

/* What no run leaves behind, in words; NULL if there is no such thing. */
static const char *position_fault(const State *s) {
    if (s->tick < 0 || s->tick > MOST_TICKS) return "its number of ticks is impossible";
    if (!(s->tick_fraction >= 0 && s->tick_fraction < 1)) return "its position between ticks is impossible";
    return NULL;
}

/* The end of initialization mode; returns 0 after saying what is wrong. */
static int initialized(Instance *instance) {
    if (!initialization_valid(instance)) return 0;
    STATE_OF(instance)->outputs_stale = 0;
    STATE_OF(instance)->phase = STEP_COMPLETE;
    return 1;
}

#ifndef CONTAINED
/* Nothing happens before outputs are asked for, or initialization ends. */
static void enter_initialization(State *s) { s->phase = INITIALIZATION; }

/* Stores a value that is_settable has found right. */
static int store(Instance *instance, uint32_t reference, double value) {
    instance->state.values[reference] = value;
    return 1;
}

/* An instance holds nothing besides its memory. */
static void release(State *s) { (void)s; }

/* A step may have any size. */
static int step_fits(const Instance *instance, double t, double h) {
    (void)instance;
    (void)t;
    (void)h;
    return 1;
}
#endif
