/* Steps of a continuous model: the classical Runge-Kutta method of order 4, in equal sub-steps no longer
 * than dt_max, with location of events.
 *
 * Between events the right-hand side is evaluated in fixed modes, so it is smooth there even when
 * a stage lies beyond the event. When an indicator has changed sign at the end of a sub-step, the
 * length of the sub-step that ends on the crossing is found by bracketing (Illinois' variant of
 * regula falsi with a smallest step, so that both ends close in), the mode flips, and the rest of
 * the sub-step follows. Each piece is a Runge-Kutta step of its own: order 4 survives the event.
 */
#include <float.h>

#include "instance.h"

/* 1e7 sub-steps take seconds; more than that in one doStep is a mistake, not a step. */
#define MAX_SUBSTEPS 1e7
/* A doStep of n sub-steps may locate 64 + 2 n events: a contact that begins and ends in every
 * sub-step is physics, more is chatter. */
#define FIRST_EVENTS 64
#define EVENTS_PER_SUBSTEP 2
#define MAX_ITERATIONS 200

/* Whether inputs move in the step. Those of a contained model do not. */
static int rates_given(const State *s) {
#ifdef CONTAINED
    (void)s;
    return 0;
#else
    return s->rates_given;
#endif
}

/* The inputs at time t: held, or continued from the start of the step by their derivatives. */
static const double *inputs_at(const State *s, double t, double *continued) {
    const double *u = s->values + MODEL_FIRST_INPUT, dt = t - s->step_start;
    if (!rates_given(s)) return u;
    for (int i = 0; i < MODEL_N_INPUTS; ++i)
        continued[i] = u[i] + dt * (s->input_rates[0][i] + 0.5 * dt * s->input_rates[1][i]);
    return continued;
}

/* The rate of change of a state for which `shared` is prepared. */
static INLINED void slope(const State *s, double t, const double *x, const double *shared, double *k) {
    double continued[AT_LEAST_ONE(MODEL_N_INPUTS)];
    model_derivative(t, x, inputs_at(s, t, continued), s->values, s->constants, s->modes, shared, k);
}

/* The stages are a loop, not three copies of it: what runs at every step should fit into the cache. */
static INLINED void runge_kutta_4(const State *s, double t, double dt, double *end) {
    static const double fractions[] = {0.5, 0.5, 1.0};
    double k[4][AT_LEAST_ONE(MODEL_N_STATES)];
    slope(s, t, s->states, s->shared, k[0]);
    for (int stage = 0; stage < 3; ++stage) {
        const double step = fractions[stage] * dt;
        double x[AT_LEAST_ONE(MODEL_N_STATES)], shared[AT_LEAST_ONE(MODEL_N_SHARED)];
        for (int i = 0; i < MODEL_N_STATES; ++i) x[i] = s->states[i] + step * k[stage][i];
        model_prepare(x, s->values, s->constants, shared);
        slope(s, t + step, x, shared, k[stage + 1]);
    }
    for (int i = 0; i < MODEL_N_STATES; ++i)
        end[i] = s->states[i] + dt * ((k[0][i] + k[3][i]) + 2.0 * (k[1][i] + k[2][i])) / 6.0;
}

#if MODEL_N_EVENTS
static double indicator(State *s, double t, const double *x, int event) {
    double z[MODEL_N_EVENTS], shared[AT_LEAST_ONE(MODEL_N_SHARED)];
    model_prepare(x, parameters(s), s->constants, shared);
    model_event_indicators(t, x, parameters(s), s->constants, shared, z);
    return z[event];
}

static void set_modes(State *s) {
    double z[MODEL_N_EVENTS];
    model_event_indicators(s->time, s->states, parameters(s), s->constants, s->shared, z);
    for (int i = 0; i < MODEL_N_EVENTS; ++i) s->modes[i] = z[i] > 0;
}

/* An event other than `known` whose indicator disagrees with its mode at (t, x), or -1. */
static INLINED int crossed_event(State *s, double t, const double *x, const double *shared, int known) {
    double z[MODEL_N_EVENTS];
    model_event_indicators(t, x, parameters(s), s->constants, shared, z);
    for (int i = 0; i < MODEL_N_EVENTS; ++i)
        if (i != known && (z[i] > 0) != (s->modes[i] > 0)) return i;
    return -1;
}

/* The shortest step from (t, states), at most dt, after which `event` has just crossed; `end`
 * holds the state after dt on entry and the state after the returned step on exit. */
static double locate_crossing(State *s, double t, double dt, int event, double *end) {
    const double smallest = 4 * DBL_EPSILON * dt;
    double lower = 0, upper = dt, trial_end[AT_LEAST_ONE(MODEL_N_STATES)];
    double z_lower = indicator(s, t, s->states, event), z_upper = indicator(s, t + dt, end, event);
    int side = 0;
    if ((z_lower > 0) != (s->modes[event] > 0)) {   /* already across: flip at once */
        memcpy(end, s->states, sizeof s->states);
        return 0;
    }
    for (int i = 0; i < MAX_ITERATIONS && upper - lower > smallest; ++i) {
        double trial = (lower * z_upper - upper * z_lower) / (z_upper - z_lower);
        if (i % 8 == 7 || !real_is_finite(trial)) trial = 0.5 * (lower + upper);
        trial = real_fmin(real_fmax(trial, lower + 0.5 * smallest), upper - 0.5 * smallest);
        runge_kutta_4(s, t, trial, trial_end);
        double z = indicator(s, t + trial, trial_end, event);
        if ((z > 0) == (s->modes[event] > 0)) {
            lower = trial, z_lower = z;
            if (side == 1) z_upper *= 0.5;
            side = 1;
        } else {
            upper = trial, z_upper = z;
            memcpy(end, trial_end, sizeof trial_end);
            if (side == -1) z_lower *= 0.5;
            side = -1;
        }
    }
    return upper;
}
#endif

#if MODEL_N_EVENTS
/* The first event within the step, or -1; on return `step` and `end` stop at it, and what the state
 * shares is prepared for `end`. */
static int first_event(State *s, double t, double *step, double *end) {
    int first = -1;
    model_prepare(end, parameters(s), s->constants, s->shared);
    for (int tries = 0; tries <= MODEL_N_EVENTS; ++tries) {
        const int event = crossed_event(s, t + *step, end, s->shared, first);
        if (event < 0) break;
        model_prepare(s->states, parameters(s), s->constants, s->shared);
        *step = locate_crossing(s, t, *step, event, end);
        model_prepare(end, parameters(s), s->constants, s->shared);
        first = event;
    }
    return first;
}
#endif

#if MODEL_N_EVENTS
/* A sub-step in which an event happens, from its beginning; each event takes one of `events_left`. */
static RARE int substep_with_events(Instance *instance, double t, double dt, int64_t *events_left) {
    State *s = STATE_OF(instance);
    double end[AT_LEAST_ONE(MODEL_N_STATES)], rest = dt;
    model_prepare(s->states, parameters(s), s->constants, s->shared);
    for (;;) {
        double step = rest;
        runge_kutta_4(s, t, rest, end);
        if (!states_valid(instance, end, t + rest)) return 0;
        const int event = first_event(s, t, &step, end);
        memcpy(s->states, end, sizeof end);
        if (event < 0) return 1;
        s->modes[event] = !(s->modes[event] > 0);
        t += step;
        rest -= step;
        if (!(rest > 0)) return 1;
        if (--*events_left < 0) {
            fail(instance, "Too many events, the last at t = %.17g s: the model chatters; a smaller "
                           "dt_max may separate them.",
                 t);
            return 0;
        }
    }
}
#endif

/* One sub-step. */
static INLINED int substep(Instance *instance, double t, double dt, int64_t *events_left) {
    State *s = STATE_OF(instance);
    double end[AT_LEAST_ONE(MODEL_N_STATES)];
    runge_kutta_4(s, t, dt, end);
    model_prepare(end, parameters(s), s->constants, s->shared);
#if MODEL_N_EVENTS
    if (crossed_event(s, t + dt, end, s->shared, -1) >= 0)
        return substep_with_events(instance, t, dt, events_left);
#else
    (void)events_left;
#endif
    for (int i = 0; i < MODEL_N_STATES; ++i) s->states[i] = end[i];
    return states_valid(instance, s->states, t + dt);
}

static void initialize_states(State *s) {
    model_initial(s->time, inputs(s), parameters(s), s->constants, s->states);
    model_prepare(s->states, parameters(s), s->constants, s->shared);
#if MODEL_N_EVENTS
    set_modes(s);
#endif
}

static void constants_changed(State *s) {
    model_prepare(s->states, parameters(s), s->constants, s->shared);
}

/* The inputs when the step ends. */
static const double *inputs_at_end(const State *s) {
#ifdef CONTAINED
    return s->values + MODEL_FIRST_INPUT;
#else
    return s->end_inputs;
#endif
}

static void show_outputs(State *s, double t, double *checks) {
    model_output(t, s->states, inputs_at_end(s), parameters(s), s->constants, s->modes, s->shared,
                 outputs(s), checks);
}

static void show_initial_outputs(State *s, double *checks) {
#ifndef CONTAINED
    memcpy(s->end_inputs, inputs(s), sizeof s->end_inputs);
#endif
    show_outputs(s, s->time, checks);
}

#ifndef CONTAINED
/* Where the inputs are, and how they move, when the step ends; derivatives serve one step only. */
static void end_inputs(State *s, double t) {
    double continued[AT_LEAST_ONE(MODEL_N_INPUTS)];
    memcpy(s->end_inputs, inputs_at(s, t, continued), sizeof s->end_inputs);
    if (!rates_given(s)) {
        memset(s->end_rates, 0, sizeof s->end_rates);
        return;
    }
    for (int i = 0; i < MODEL_N_INPUTS; ++i)
        s->end_rates[i] = s->input_rates[0][i] + (t - s->step_start) * s->input_rates[1][i];
    memset(s->input_rates, 0, sizeof s->input_rates);
    s->rates_given = 0;
}
#endif

static int advance(Instance *instance, double t, double h) {
    State *s = STATE_OF(instance);
    const double dt_max = s->values[MODEL_PERIOD];
    const double ratio = h / dt_max - 1e-6;
    double checks[AT_LEAST_ONE(MODEL_N_CHECKS)];
    if (!(ratio <= MAX_SUBSTEPS)) {
        fail(instance, "A step of %.17g s needs %g sub-steps of dt_max = %.17g s, more than %g.", h,
             ratio, dt_max, MAX_SUBSTEPS);
        return 0;
    }
    const int64_t n = ratio > 1 ? (int64_t)ratio + ((double)(int64_t)ratio < ratio) : 1;
    int64_t events_left = FIRST_EVENTS + EVENTS_PER_SUBSTEP * n;
    s->step_start = t;
    if (n > 1) {
        const double dt = h / (double)n;
        for (int64_t i = 0; i < n; ++i)
            if (!substep(instance, t + (double)i * dt, dt, &events_left)) return 0;
    } else if (!substep(instance, t, h, &events_left)) {   /* not waiting for a division */
        return 0;
    }
#ifndef CONTAINED
    end_inputs(s, t + h);
#endif
    show_outputs(s, t + h, checks);
    return checks_pass(instance, checks, MODEL_N_CHECKS, model_checks) &&
           outputs_valid(instance, outputs(s), t + h);
}

#ifndef CONTAINED
static void rates_of_outputs(const State *s, double *dy) {
    model_output_rate(s->time, s->states, s->end_inputs, s->values, s->modes, s->end_rates, dy);
}

static void sensitivity_of_outputs(const State *s, const double *v, double *dy) {
    model_output_sensitivity(s->time, s->states, s->end_inputs, s->values, s->modes, v, dy);
}
#endif
