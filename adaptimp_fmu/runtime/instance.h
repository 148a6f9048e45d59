/* One instance: all that the instance remembers, in memory of its own.
 *
 * There are three kinds: sampled and continuous models, and containers, which are systems of such models; those define
 * MODEL_CONTAINER. An FMU allocates its instance. A model that is compiled with CONTAINED is a part of a larger program, which has
 * the memory and calls the functions of contained.h instead of FMI's. PREFIXED(name) is then the model's own name
 * for a function or type that others see. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <stdint.h>

#include "real_numbers.h"
#include "model.h"
#ifdef CONTAINED
/* Two functions of the compiler, which calls them itself: the library's header need not exist. */
void *memcpy(void *restrict to, const void *restrict from, size_t size);
void *memset(void *at, int byte, size_t size);
#else
#include <string.h>

#include "functions.h"
#endif

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

#ifdef CONTAINED
typedef PREFIXED(State) State;                     /* declared by the program around the model */

typedef struct {
    State *state;
    Failure *failure;
} Instance;
#define STATE_OF(instance) ((instance)->state)
#define IN_PLACE INLINED                           /* in a contained model, which has one step of one length */
#else
#define IN_PLACE
#ifdef MODEL_CONTAINER
#include "container.h"
#else
#include "state.h"
#define SLOT(s, reference) ((s)->values[reference])  /* the value of a variable */
#endif

typedef struct {
    State state;
    fmi2CallbackFunctions callbacks;
    char *name;
    int logged;                                    /* categories that are on */
} Instance;
#define STATE_OF(instance) (&(instance)->state)
#endif

#ifndef MODEL_CONTAINER
static double *parameters(State *s) { return s->values; }
static double *inputs(State *s) { return s->values + MODEL_FIRST_INPUT; }
static double *outputs(State *s) { return s->values + MODEL_FIRST_OUTPUT; }

/* Implemented by sampled.c or continuous.c. They return 1, or 0 after saying what is wrong. */
static void initialize_states(State *s);
static void constants_changed(State *s);
static void show_initial_outputs(State *s, double *checks);
static int advance(Instance *instance, double t, double h);
#endif

#endif
