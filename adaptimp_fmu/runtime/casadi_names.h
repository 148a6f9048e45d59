/* The functions that CasADi's code calls are those of mathematics.h. */
#ifndef CASADI_NAMES_H
#define CASADI_NAMES_H

#include "mathematics.h"

#define casadi_inf REAL_INFINITY

#define fabs(x) real_fabs(x)
#define floor(x) real_floor(x)
#define ceil(x) real_ceil(x)
#define fmin(x, y) real_fmin(x, y)
#define fmax(x, y) real_fmax(x, y)
#define copysign(x, y) real_copysign(x, y)
#define fmod(x, y) real_fmod(x, y)
#define remainder(x, y) real_remainder(x, y)
#define sqrt(x) real_sqrt(x)
#define hypot(x, y) real_hypot(x, y)
#define exp(x) real_exp(x)
#define expm1(x) real_expm1(x)
#define log(x) real_log(x)
#define log1p(x) real_log1p(x)
#define pow(x, y) real_pow(x, y)
#define sin(x) real_sin(x)
#define cos(x) real_cos(x)
#define tan(x) real_tan(x)
#define asin(x) real_asin(x)
#define acos(x) real_acos(x)
#define atan(x) real_atan(x)
#define atan2(y, x) real_atan2(y, x)
#define sinh(x) real_sinh(x)
#define cosh(x) real_cosh(x)
#define tanh(x) real_tanh(x)
#define asinh(x) real_asinh(x)
#define acosh(x) real_acosh(x)
#define atanh(x) real_atanh(x)

#endif
