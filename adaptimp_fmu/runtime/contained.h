/* The functions of a model that is contained in a larger program, without FMI.
 *
 * This file has no guard and is included once for each model, as state.h is. Functions that return int
 * return 1, or 0 after recording why not. Nothing here allocates, reads or writes anything but its arguments. */

/* Every value at its start, as after fmi2Instantiate and after fmi2Reset. */
void PREFIXED(reset)(PREFIXED(State) *s);

/* fmi2SetupExperiment and fmi2EnterInitializationMode: a run begins at start_time, s. */
void PREFIXED(begin)(PREFIXED(State) *s, double start_time);

/* In initialization mode: computes the outputs for the present inputs and parameters. */
void PREFIXED(show)(PREFIXED(State) *s);

/* fmi2ExitInitializationMode. */
int PREFIXED(finish)(PREFIXED(State) *s, Failure *failure);

/* fmi2DoStep from t to t + h, s. */
int PREFIXED(step)(PREFIXED(State) *s, double t, double h, Failure *failure);

/* To be called after parameters were stored into `values`. */
void PREFIXED(changed)(PREFIXED(State) *s);

/* The sizes end here, so that those of the next model can follow. */
#undef MODEL_SAMPLED
#undef MODEL_N_PARAMETERS
#undef MODEL_N_INPUTS
#undef MODEL_N_OUTPUTS
#undef MODEL_N_STATES
#undef MODEL_N_CONSTANTS
#undef MODEL_N_SHARED
#undef MODEL_N_EVENTS
#undef MODEL_N_NOISE
#undef MODEL_N_STATIC_CHECKS
#undef MODEL_N_CHECKS
#undef MODEL_PERIOD
#undef MODEL_DIVISOR
#undef MODEL_INTEGER_OUTPUTS

/* What no run leaves behind in a state, in words; a null pointer if there is no such thing. */
const char *PREFIXED(fault)(const PREFIXED(State) *s);
