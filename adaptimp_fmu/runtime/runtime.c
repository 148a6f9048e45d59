/* The whole runtime, in order of use. A generated file includes this one after its model, so that
 * the compiler sees model and runtime as one file and exports nothing but FMI's functions, or those of
 * contained.h. */
#include "instance.h"
#include "mathematics.h"

#ifdef CONTAINED
#include "record.c"
#else
#include "log.c"
#endif
#include "numbers.c"
#include "validate.c"
#if MODEL_SAMPLED
#include "sampled.c"
#else
#include "continuous.c"
#endif
#include "phases.c"
#ifdef CONTAINED
#include "contained.c"
#else
#include "lifecycle.c"
#include "access.c"
#include "step.c"
#include "derivatives.c"
#include "snapshot.c"
#endif
