/* Plant: sizes. Generated; do not edit. There is no guard, since a program may contain several models. */
#define MODEL_SAMPLED 0
#define MODEL_N_PARAMETERS 22
#define MODEL_N_INPUTS 2
#define MODEL_N_OUTPUTS 14
#define MODEL_N_STATES 4
#define MODEL_N_CONSTANTS 13
#define MODEL_N_SHARED 17
#define MODEL_N_EVENTS 2
#define MODEL_N_NOISE 0
#define MODEL_N_STATIC_CHECKS 1
#define MODEL_N_CHECKS 0
#define MODEL_PERIOD 0 /* value reference of dt_max */
