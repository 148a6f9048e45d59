/* A unit without FMI: takes the place of the runtime in a unit's sources, so the adapters to the
 * generated functions are the very same. NAME(x) puts the component's name before x.
 *
 * A step calls what the runtime calls in a step, without its checks: the noise and the tick, or the
 * tick with update of the slow states, of a sampled unit; four derivatives, the preparations for
 * them, the event indicators and the outputs of a continuous one. An event flips its mode at the end
 * of the step in which it happens; it is not located, so a run equals the real one until the first
 * event.
 */
#include <string.h>

#if MODEL_N_NOISE
#include "philox.h"
#endif

static double values[MODEL_N_VARIABLES];
static double states[AT_LEAST_ONE(MODEL_N_STATES)], constants[AT_LEAST_ONE(MODEL_N_CONSTANTS)];
static double checks[AT_LEAST_ONE(MODEL_N_CHECKS) + AT_LEAST_ONE(MODEL_N_STATIC_CHECKS)];
static const double *const p = values, *const c = constants;
static double start_time, ticks_per_draw;
static int64_t ticks_run;
double *const NAME(inputs) = values + MODEL_FIRST_INPUT;
double *const NAME(outputs) = values + MODEL_FIRST_OUTPUT;
const int64_t NAME(n_inputs) = MODEL_N_INPUTS;

#if MODEL_SAMPLED
static void begin(void) {}

/* The runtime's draw: the generator's block of the present tick, nothing if the noise is off. */
static void draw_noise(double *w) {
#if MODEL_N_NOISE
    uint64_t block[4];
    double uniforms[4];
    if (!(ticks_per_draw > 0)) {
        memset(w, 0, MODEL_N_NOISE * sizeof *w);
        return;
    }
    const int64_t n = (int64_t)ticks_per_draw;
    philox4x64((uint64_t)(n <= 1 ? ticks_run : ticks_run / n), model_seed(p), block);
    for (int i = 0; i < 4; ++i) uniforms[i] = uniform(block[i]);
    model_noise(uniforms, p, c, w);
#else
    (void)w;
#endif
}

static void compute_tick(double now, double *y, double *next) {
    double w[AT_LEAST_ONE(MODEL_N_NOISE)];
    draw_noise(w);
#ifdef MODEL_DIVISOR
    if (ticks_run % (int64_t)values[MODEL_DIVISOR] == 0) {
        model_tick_update(now, states, NAME(inputs), p, c, w, y, next, checks);
        return;
    }
#endif
    model_tick(now, states, NAME(inputs), p, c, w, y, next, checks);
}

void NAME(step)(double t, double h) {
    double y[AT_LEAST_ONE(MODEL_N_OUTPUTS)], next[AT_LEAST_ONE(MODEL_N_STATES)];
    const double now = start_time + (double)ticks_run * values[MODEL_PERIOD];
    (void)t, (void)h;
    if (ticks_run == 0) model_initial(now, NAME(inputs), p, c, states);
    compute_tick(now, y, next);
    memcpy(NAME(outputs), y, MODEL_N_OUTPUTS * sizeof *y);
    memcpy(states, next, MODEL_N_STATES * sizeof *next);
    ++ticks_run;
}
#else
static double modes[AT_LEAST_ONE(MODEL_N_EVENTS)], shared[AT_LEAST_ONE(MODEL_N_SHARED)];

static void set_modes(double t) {
    model_prepare(states, p, c, shared);
#if MODEL_N_EVENTS
    double z[MODEL_N_EVENTS];
    model_event_indicators(t, states, p, c, shared, z);
    for (int i = 0; i < MODEL_N_EVENTS; ++i) modes[i] = z[i] > 0;
#endif
}

static void begin(void) {
    model_initial(start_time, NAME(inputs), p, c, states);
    set_modes(start_time);
}

static void stage_slope(double t, double step, const double *before, double *k) {
    double stage[MODEL_N_STATES], prepared[AT_LEAST_ONE(MODEL_N_SHARED)];
    for (int i = 0; i < MODEL_N_STATES; ++i) stage[i] = states[i] + step * before[i];
    model_prepare(stage, p, c, prepared);
    model_derivative(t, stage, NAME(inputs), p, c, modes, prepared, k);
}

/* The runtime's formula, for a step no longer than dt_max. */
void NAME(step)(double t, double h) {
    double k1[MODEL_N_STATES], k2[MODEL_N_STATES], k3[MODEL_N_STATES], k4[MODEL_N_STATES];
    model_derivative(t, states, NAME(inputs), p, c, modes, shared, k1);
    stage_slope(t + 0.5 * h, 0.5 * h, k1, k2);
    stage_slope(t + 0.5 * h, 0.5 * h, k2, k3);
    stage_slope(t + h, h, k3, k4);
    for (int i = 0; i < MODEL_N_STATES; ++i)
        states[i] += h * ((k1[i] + k4[i]) + 2.0 * (k2[i] + k3[i])) / 6.0;
    set_modes(t + h);
    model_output(t + h, states, NAME(inputs), p, c, modes, shared, NAME(outputs), checks);
}
#endif

/* Back to the start; `given` are the values of all variables after initialization. */
void NAME(start)(const double *given, double t0) {
    memcpy(values, given, sizeof values);
    start_time = t0;
    ticks_run = 0;
    model_calibrate(p, constants, checks, &ticks_per_draw);
    begin();
}
