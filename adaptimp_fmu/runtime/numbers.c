/* What a number is, on every platform alike. */
#include <limits.h>

#include "instance.h"

/* How a number that is not finite reads. */
static const char *not_finite(double value) {
    return real_is_nan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}

#if defined(MODEL_INTEGER_OUTPUTS) || defined(MODEL_WHOLE_REALS) || !defined(CONTAINED)
/* 1 if the value is a whole number that an Integer holds. */
static int is_integer(double value) {
    return value >= INT_MIN && value <= INT_MAX && value == (double)(int)value;
}
#endif

#if defined(MODEL_WHOLE_REALS) || !defined(CONTAINED)
/* 1 for a Real that stands for a Boolean or an Integer. */
static int is_whole_real(size_t reference) {
#ifdef MODEL_WHOLE_REALS
    return model_whole[reference];
#else
    (void)reference;
    return 0;
#endif
}

/* 0 if a Real stands for a Boolean or an Integer, and the value is none. */
static int may_be(const ModelVariable *variable, double value) {
    return !is_whole_real((size_t)(variable - model_variables)) ||
           (is_integer(value) && value >= variable->min && value <= variable->max);
}
#endif
