/* The runtime of a container, in order of use: that of all FMUs (runtime.c), with a system in the place of the
 * equations. A generated file includes this one after the variables. */
#include "instance.h"

#include "log.c"
#include "numbers.c"
#include "container.c"
#include "lifecycle.c"
#include "access.c"
#include "step.c"
#include "no_derivatives.c"
#if CONTAINER_IS_PLAIN
#include "snapshot.c"
#else
#include "snapshot_of_parts.c"
#endif
