/* Steps of a sampled model, which is updated every sample_time and holds its outputs in between.
 *
 * The instance keeps its own position in ticks, since a host's clock is summed or rounded: k ticks
 * have run, and `tick_fraction` in [0, 1) says how far behind the last one the present lies. A
 * step of h covers h / sample_time ticks; a position within rounding of a whole tick is that tick.
 * A tick at the start of a step uses the inputs just set. Slow states are updated at every n-th tick.
 */
#include <float.h>

#include "instance.h"
#if MODEL_N_NOISE
#include "philox.h"
#endif

/* 1e7 ticks take seconds; more than that in one doStep is a mistake, not a step. */
#define MAX_TICKS 1e7

static double tick_time(const State *s) {
    return s->start_time + (double)s->tick * s->values[MODEL_PERIOD];
}

#if MODEL_N_NOISE || !defined(CONTAINED)
/* Uniform numbers of the present draw, which serves `ticks_per_draw` ticks: a function of seed and tick
 * alone, so a rollback replays them. */
static void draw_uniforms(const State *s, double uniforms[4]) {
#if MODEL_N_NOISE
    uint64_t block[4];
    const int64_t n = (int64_t)s->ticks_per_draw;
    philox4x64((uint64_t)(n <= 1 ? s->tick : s->tick / n), model_seed(s->values), block);
    for (int i = 0; i < 4; ++i) uniforms[i] = uniform(block[i]);
#else
    (void)s;
    memset(uniforms, 0, 4 * sizeof *uniforms);
#endif
}
#endif

static void draw_noise(const State *s, double *w) {
#if MODEL_N_NOISE
    double uniforms[4];
    if (!(s->ticks_per_draw > 0)) {
        memset(w, 0, MODEL_N_NOISE * sizeof *w);
        return;
    }
    draw_uniforms(s, uniforms);
    model_noise(uniforms, s->values, s->constants, w);
#else
    (void)s;
    (void)w;
#endif
}

#ifdef MODEL_DIVISOR
/* 1 at every n-th tick. A divisor below 1 is refused when it is set; whatever comes here, nothing is
 * divided by zero. */
static INLINED int slow_states_move(const State *s) {
    const int64_t n = (int64_t)s->values[MODEL_DIVISOR];
    return n <= 1 || s->tick % n == 0;
}
#endif

static void compute_tick(State *s, double *y, double *next, double *checks) {
    double w[AT_LEAST_ONE(MODEL_N_NOISE)];
    draw_noise(s, w);
#ifdef MODEL_DIVISOR
    if (slow_states_move(s)) {
        model_tick_update(tick_time(s), s->states, inputs(s), parameters(s), s->constants, w, y, next,
                          checks);
        return;
    }
#endif
    model_tick(tick_time(s), s->states, inputs(s), parameters(s), s->constants, w, y, next, checks);
}

static RARE void initialize_states(State *s) {
    model_initial(tick_time(s), inputs(s), parameters(s), s->constants, s->states);
}

static void constants_changed(State *s) { (void)s; }

/* What the first tick would give; the state does not advance. */
static RARE void show_initial_outputs(State *s, double *checks) {
    double next[AT_LEAST_ONE(MODEL_N_STATES)];
    compute_tick(s, outputs(s), next, checks);
}

/* A tick that is refused leaves the outputs as they were. Those of a contained model need not be copied:
 * nobody shows them before the whole program has made its step. */
static INLINED int run_tick(Instance *instance) {
    State *s = STATE_OF(instance);
    double next[AT_LEAST_ONE(MODEL_N_STATES)], checks[AT_LEAST_ONE(MODEL_N_CHECKS)];
#ifdef CONTAINED
    double *y = outputs(s);
#else
    double y[AT_LEAST_ONE(MODEL_N_OUTPUTS)];
#endif
    if (s->tick == 0) initialize_states(s);
    compute_tick(s, y, next, checks);
    if (!checks_pass(instance, checks, MODEL_N_CHECKS, model_checks)) return 0;
    if (!outputs_valid(instance, y, tick_time(s))) return 0;
    if (!states_valid(instance, next, tick_time(s))) return 0;
#ifndef CONTAINED
    memcpy(outputs(s), y, MODEL_N_OUTPUTS * sizeof *y);
#endif
    memcpy(s->states, next, MODEL_N_STATES * sizeof *next);
    ++s->tick;
    return 1;
}

/* floor and ceil of a number in [0, 2^62) without a call: baseline x86-64 has no instruction. */
static double floor_of(double x) { return (double)(int64_t)x; }

static double ceil_of(double x) { return floor_of(x) + (floor_of(x) < x); }

static RARE int too_many_ticks(const Instance *instance, double h, double end) {
    fail(instance, "A step of %.17g s holds %g ticks of sample_time = %.17g s, more than %g.", h, end,
         STATE_OF(instance)->values[MODEL_PERIOD], MAX_TICKS);
    return 0;
}

/* A step of any size, from any position. */
static RARE int advance_by(Instance *instance, double t, double h) {
    State *s = STATE_OF(instance);
    const double period = s->values[MODEL_PERIOD];
    double end = s->tick_fraction + h / period;
    if (!(end <= MAX_TICKS)) return too_many_ticks(instance, h, end);
    const double nearest = floor_of(end + 0.5);
    if (real_fabs(end - nearest) <= 1e-9 + 4 * DBL_EPSILON * real_fabs(t + h) / period) end = nearest;
    const int64_t ticks = (int64_t)(ceil_of(end) - ceil_of(s->tick_fraction));
    for (int64_t i = 0; i < ticks; ++i)
        if (!run_tick(instance)) return 0;
    s->tick_fraction = end - floor_of(end);
    return 1;
}

/* A step of one period holds one tick, wherever it begins, and does not move the position. */
static int advance(Instance *instance, double t, double h) {
    return h == STATE_OF(instance)->values[MODEL_PERIOD] ? run_tick(instance) : advance_by(instance, t, h);
}

#ifndef CONTAINED
/* Between ticks outputs are held, and inputs do not reach them. */
static void rates_of_outputs(const State *s, double *dy) {
    (void)s;
    memset(dy, 0, AT_LEAST_ONE(MODEL_N_OUTPUTS) * sizeof *dy);
}

static void sensitivity_of_outputs(const State *s, const double *v, double *dy) {
    (void)v;
    rates_of_outputs(s, dy);
}
#endif
