/* All that one instance remembers, as a type. Plain numbers, so a copy is a snapshot.
 *
 * This file has no guard: a program that contains several models includes it once for each of them, after
 * the sizes of the model (sizes.h), and with PREFIXED(name) as the model's name for the type. */
#ifndef AT_LEAST_ONE
#define AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)        /* arrays in C have at least one element */
#endif
#ifndef MAX_INPUT_ORDER
#define MAX_INPUT_ORDER 2                          /* of input derivatives that are used */
#endif

typedef struct {
    double values[MODEL_N_PARAMETERS + MODEL_N_INPUTS + MODEL_N_OUTPUTS]; /* by value reference */
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
    double ticks_per_draw;                         /* of the noise; 0 while it is off */
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
} PREFIXED(State);
