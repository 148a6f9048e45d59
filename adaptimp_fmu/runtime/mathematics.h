/* The mathematics of the equations and of the runtime: the same bits on every machine.
 *
 * Everything here is made of + - * / and square roots of doubles, of comparisons and of integers, each
 * of which IEEE 754 and C define to the last bit. No function of the C library is called. For each finite
 * argument the error is at most 1 unit in the last place (docs/mathematics.md has what was measured); values
 * at infinities, zeros and NaN are those of C11, annex F. Each NaN that a function returns is the same one.
 */
#ifndef MATHEMATICS_H
#define MATHEMATICS_H

#include <float.h>

#if FLT_EVAL_METHOD != 0
#error "Compile so that doubles are computed as doubles (on x86 with SSE2: -m64, or -msse2 -mfpmath=sse); otherwise results differ from machine to machine."
#endif

/* a * b + c is two operations, with two roundings. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && defined(__FP_FAST_FMA)
#pragma GCC optimize("fp-contract=off")
#elif defined(_MSC_VER)
#pragma fp_contract(off)
#endif

#include "mathematics_tables.h"
#include "real_numbers.h"
#include "real_pairs.h"
#include "trigonometry.h"
#include "inverse_trigonometry.h"
#include "exponential.h"
#include "logarithm.h"

#endif
