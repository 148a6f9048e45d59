/* One instance of an FMU: all that the instance remembers, in memory of its own. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdint.h>

#include "functions.h"
#include "model.h"

/* States of FMI 2.0.5, figure 11 (co-simulation); bits, so that a set of them is a mask. */
typedef enum {
    INSTANTIATED = 1 << 0,
    INITIALIZATION = 1 << 1,
    STEP_COMPLETE = 1 << 2,
    TERMINATED = 1 << 3,
    FAILED = 1 << 4
} Phase;

enum { LOG_ERROR = 1 << 0, LOG_WARNING = 1 << 1, LOG_ALL = LOG_ERROR | LOG_WARNING };

/* What is not to be inlined into what runs at every step, rare or not, and what is. */
#if defined(__GNUC__) || defined(__clang__)
#define RARE __attribute__((noinline, cold))
#define APART __attribute__((noinline))
#define INLINED inline __attribute__((always_inline))
#define FALL_THROUGH __attribute__((fallthrough));
#else
#define RARE
#define APART
#define INLINED inline
#define FALL_THROUGH
#endif

#define MAX_INPUT_ORDER 2                          /* of input derivatives that are used */

/* All that a rollback restores. Plain numbers, so a copy is a snapshot. */
typedef struct {
    double values[MODEL_N_VARIABLES];              /* by value reference */
    double states[AT_LEAST_ONE(MODEL_N_STATES)];
    double constants[AT_LEAST_ONE(MODEL_N_CONSTANTS)];
    double modes[AT_LEAST_ONE(MODEL_N_EVENTS)];
    double shared[AT_LEAST_ONE(MODEL_N_SHARED)];   /* prepared for the states */
#if !MODEL_SAMPLED
    double input_rates[MAX_INPUT_ORDER][AT_LEAST_ONE(MODEL_N_INPUTS)]; /* for the next step */
    double end_inputs[AT_LEAST_ONE(MODEL_N_INPUTS)];                   /* at the communication point */
    double end_rates[AT_LEAST_ONE(MODEL_N_INPUTS)];
    double step_start;
#endif
    double noise_active;
    double start_time, stop_time, time;
    double latest_end;                             /* the stop time, or the largest number */
    int64_t tick;                                  /* ticks run since the start */
    double tick_fraction;                          /* position after the last tick, [0, 1) */
    int32_t phase;
    int32_t stop_time_defined;
    int32_t experiment_defined;
    int32_t constants_stale;                       /* a parameter was set since calibration */
    int32_t outputs_stale;                         /* only during initialization */
    int32_t rates_given;                           /* input_rates are not all zero */
} State;

typedef struct {
    State state;
    fmi2CallbackFunctions callbacks;
    char *name;
    int logged;                                    /* categories that are on */
} Instance;

static double *parameters(State *s) { return s->values; }
static double *inputs(State *s) { return s->values + MODEL_FIRST_INPUT; }
static double *outputs(State *s) { return s->values + MODEL_FIRST_OUTPUT; }

/* Implemented by sampled.c or continuous.c. They return 1, or 0 after logging what is wrong. */
static void initialize_states(State *s);
static void constants_changed(State *s);
static void show_initial_outputs(State *s, double *checks);
static int advance(Instance *instance, double t, double h);

#endif
