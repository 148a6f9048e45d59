/* The interface between a generated model and the runtime.
 *
 * The generated file sizes.h defines the sizes MODEL_N_*, the index MODEL_PERIOD and MODEL_SAMPLED (and the
 * index MODEL_DIVISOR, if there are slow states, and MODEL_INTEGER_OUTPUTS and MODEL_WHOLE_REALS, if there are
 * any). The generated file model.c includes this header and defines the tables and functions that are declared
 * here. The model never sees FMI, the runtime never sees physics. What no contained model needs stands behind CONTAINED.
 *
 * A variable's value reference is its index in model_variables; parameters come first, then
 * inputs, then outputs, so each group is one run of doubles. Booleans and Integers are stored as
 * doubles too (both are exact).
 */
#ifndef MODEL_H
#define MODEL_H

#if defined(__FAST_MATH__) || defined(_M_FP_FAST) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "Compile without -ffast-math, -Ofast, -ffinite-math-only and /fp:fast. They remove the tests for NaN and infinity, so that an FMU would go on with numbers that mean nothing."
#endif

#include <stddef.h>
#include <stdint.h>

#include "sizes.h"

#ifndef CONTAINED
#define PREFIXED(name) name                        /* of the types and functions of an instance */
#endif

/* Arrays in C have at least one element. */
#ifndef AT_LEAST_ONE
#define AT_LEAST_ONE(n) ((n) > 0 ? (n) : 1)
#endif

#define MODEL_N_VARIABLES (MODEL_N_PARAMETERS + MODEL_N_INPUTS + MODEL_N_OUTPUTS)
#define MODEL_FIRST_INPUT MODEL_N_PARAMETERS
#define MODEL_FIRST_OUTPUT (MODEL_N_PARAMETERS + MODEL_N_INPUTS)

#ifdef MODEL_CONTAINER
/* A container shows the variables of its system, which step.h declares. */
typedef CONTAINER(Type) VariableType;
typedef CONTAINER(Role) VariableRole;
typedef CONTAINER(Variable) ModelVariable;
#define TYPE_REAL CONTAINER(REAL)
#define TYPE_INTEGER CONTAINER(INTEGER)
#define TYPE_BOOLEAN CONTAINER(BOOLEAN)
#define TYPE_STRING ((VariableType)(CONTAINER(BOOLEAN) + 1))
#define ROLE_FIXED_PARAMETER CONTAINER(FIXED_PARAMETER)
#define ROLE_TUNABLE_PARAMETER CONTAINER(TUNABLE_PARAMETER)
#define ROLE_INPUT CONTAINER(INPUT)
#define ROLE_OUTPUT CONTAINER(OUTPUT)
#define model_variables CONTAINER(variables)
#else
typedef enum { TYPE_REAL, TYPE_INTEGER, TYPE_BOOLEAN, TYPE_STRING } VariableType;
typedef enum { ROLE_FIXED_PARAMETER, ROLE_TUNABLE_PARAMETER, ROLE_INPUT, ROLE_OUTPUT } VariableRole;

typedef struct {
    const char *name;
    VariableType type;
    VariableRole role;
    double start, min, max;
    const char *range; /* min and max in words, such as "at least 0 N/m" */
} ModelVariable;

static const ModelVariable model_variables[MODEL_N_VARIABLES];
#endif

#ifndef CONTAINED
static const char *const model_guid;

/* From each variable on, how many neighbours in memory have its type and role, itself included. */
typedef struct {
    uint32_t length;
    unsigned char type, role;
} ModelRun;

static const ModelRun model_runs[MODEL_N_VARIABLES];
static const uint32_t model_references[MODEL_N_VARIABLES]; /* 0, 1, 2, ... */
#endif

#ifdef MODEL_WHOLE_REALS
/* 1 for the Reals that stand for Booleans and Integers: they hold whole numbers only. */
static const unsigned char model_whole[MODEL_N_VARIABLES];
#endif

#ifndef MODEL_CONTAINER
/* One sentence per check; a check fails when its value is not > 0. */
static const char *const model_static_checks[AT_LEAST_ONE(MODEL_N_STATIC_CHECKS)];
static const char *const model_checks[AT_LEAST_ONE(MODEL_N_CHECKS)];
static const char *const model_states[AT_LEAST_ONE(MODEL_N_STATES)];

/* t: time, x: states, u: inputs, p: parameters, c: constants derived from p alone,
 * m: modes of the events (1 while the indicator is positive), w: noise, y: outputs,
 * ticks_per_draw: ticks for which a draw of the noise is held, 0 while the noise is off. */
static void model_calibrate(const double *p, double *c, double *checks, double *ticks_per_draw);
static void model_initial(double t, const double *u, const double *p, const double *c, double *x);
#ifndef CONTAINED
/* Outputs in initialization mode along the directions v of the inputs and q of the parameters, with
 * the uniform numbers r of the first tick. */
static void model_initial_sensitivity(double t, const double *u, const double *p, const double *r,
                                      const double *v, const double *q, double *dy);
#endif
#if MODEL_SAMPLED
static void model_tick(double t, const double *x, const double *u, const double *p, const double *c,
                       const double *w, double *y, double *next, double *checks);
#ifdef MODEL_DIVISOR
/* The same as model_tick, and the slow states of `next` as well; model_tick holds those. */
static void model_tick_update(double t, const double *x, const double *u, const double *p,
                              const double *c, const double *w, double *y, double *next,
                              double *checks);
#endif
#if MODEL_N_NOISE
static uint64_t model_seed(const double *p);
static void model_noise(const double *uniforms, const double *p, const double *c, double *w);
#endif
#else
/* s: what the three functions below share, prepared for the same x. */
static void model_prepare(const double *x, const double *p, const double *c, double *s);
static void model_derivative(double t, const double *x, const double *u, const double *p,
                             const double *c, const double *m, const double *s, double *dx);
static void model_output(double t, const double *x, const double *u, const double *p,
                         const double *c, const double *m, const double *s, double *y,
                         double *checks);
#ifndef CONTAINED
/* dy/dt for inputs that change at the rates v, and (dy/du) v at fixed states. */
static void model_output_rate(double t, const double *x, const double *u, const double *p,
                              const double *m, const double *v, double *dy);
static void model_output_sensitivity(double t, const double *x, const double *u, const double *p,
                                     const double *m, const double *v, double *dy);
#endif
#if MODEL_N_EVENTS
static void model_event_indicators(double t, const double *x, const double *p, const double *c,
                                   const double *s, double *z);
#endif
#endif
#endif

#endif
