/* FMI's types and functions, under the names that the host chooses.
 *
 * In a shared library the functions have FMI's own names. A program that links several FMUs statically compiles each
 * of them with another FMI2_FUNCTION_PREFIX, such as Plant_, so that fmi2DoStep becomes Plant_fmi2DoStep (FMI 2.0.5,
 * section 2.1.1). FMI's header names every function by its macro fmi2FullName; some editions of the header ignore the
 * prefix there, so the macro is defined anew. */
#ifndef FUNCTIONS_H
#define FUNCTIONS_H

#include "fmi2Functions.h"

#ifdef FMI2_FUNCTION_PREFIX
#define JOINED_NAME(prefix, name) prefix##name
#define WITH_PREFIX(prefix, name) JOINED_NAME(prefix, name)
#undef fmi2FullName
#define fmi2FullName(name) WITH_PREFIX(FMI2_FUNCTION_PREFIX, name)
#endif

#endif
