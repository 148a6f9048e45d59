/* What a number is, on every platform alike. */
#include <limits.h>

#include "instance.h"

/* How a number that is not finite reads. */
static const char *not_finite(double value) {
    return real_is_nan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

#if defined(MODEL_INTEGER_OUTPUTS) || !defined(CONTAINED)
/* 1 if the value is a whole number that an Integer holds. */
static int is_integer(double value) {
    return value >= INT_MIN && value <= INT_MAX && value == (double)(int)value;
}
#endif
