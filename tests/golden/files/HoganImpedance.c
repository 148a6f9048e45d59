/* HoganImpedance: tables and equations. Generated; do not edit. */

#include "model.h"

/* CasADi's functions come with companions and arguments that nobody uses. */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wconversion"
#endif
#define CASADI_SYMBOL_EXPORT static
#include "casadi_names.h"
#include "equations.h"
#include "casadi_names_end.h"
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static const ModelVariable model_variables[MODEL_N_VARIABLES] = {
    {"sample_time", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0001, 1e-12, REAL_INFINITY, "at least 1e-12 s" },
    {"M[1]", TYPE_REAL, ROLE_TUNABLE_PARAMETER,
     2.0, 1e-12, REAL_INFINITY, "at least 1e-12 kg" },
    {"M[2]", TYPE_REAL, ROLE_TUNABLE_PARAMETER,
     2.0, 1e-12, REAL_INFINITY, "at least 1e-12 kg" },
    {"B[1]", TYPE_REAL, ROLE_TUNABLE_PARAMETER,
     340.0, 1e-12, REAL_INFINITY, "at least 1e-12 N.s/m" },
    {"B[2]", TYPE_REAL, ROLE_TUNABLE_PARAMETER,
     340.0, 1e-12, REAL_INFINITY, "at least 1e-12 N.s/m" },
    {"K[1]", TYPE_REAL, ROLE_TUNABLE_PARAMETER,
     4000.0, 1e-12, REAL_INFINITY, "at least 1e-12 N/m" },
    {"K[2]", TYPE_REAL, ROLE_TUNABLE_PARAMETER,
     4000.0, 1e-12, REAL_INFINITY, "at least 1e-12 N/m" },
    {"l[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.0, 1e-12, REAL_INFINITY, "at least 1e-12 m" },
    {"l[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.0, 1e-12, REAL_INFINITY, "at least 1e-12 m" },
    {"gravity", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"coulomb_velocity", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.01, 1e-12, REAL_INFINITY, "at least 1e-12 rad/s" },
    {"p_start[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     2.0, 0.0, REAL_INFINITY, "at least 0 kg" },
    {"p_start[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.0, 0.0, REAL_INFINITY, "at least 0 kg" },
    {"p_start[3]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m.s/rad" },
    {"p_start[4]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m.s/rad" },
    {"p_start[5]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m" },
    {"p_start[6]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m" },
    {"q[1]", TYPE_REAL, ROLE_INPUT,
     -0.7227342478, -REAL_INFINITY, REAL_INFINITY, "" },
    {"q[2]", TYPE_REAL, ROLE_INPUT,
     1.4454684956, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dq[1]", TYPE_REAL, ROLE_INPUT,
     2.0943951024, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dq[2]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"ddq[1]", TYPE_REAL, ROLE_INPUT,
     1.6405770964, -REAL_INFINITY, REAL_INFINITY, "" },
    {"ddq[2]", TYPE_REAL, ROLE_INPUT,
     -6.1977356975, -REAL_INFINITY, REAL_INFINITY, "" },
    {"F_hat[1]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"F_hat[2]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"x_v[1]", TYPE_REAL, ROLE_INPUT,
     1.5, -REAL_INFINITY, REAL_INFINITY, "" },
    {"x_v[2]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dx_v[1]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dx_v[2]", TYPE_REAL, ROLE_INPUT,
     3.141592653589793, -REAL_INFINITY, REAL_INFINITY, "" },
    {"ddx_v[1]", TYPE_REAL, ROLE_INPUT,
     -14.804406601634037, -REAL_INFINITY, REAL_INFINITY, "" },
    {"ddx_v[2]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"tau_cmd[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"tau_cmd[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"x_t[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"x_t[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dx_t[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dx_t[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"e[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"e[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"p_hat[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"p_hat[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"p_hat[3]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"p_hat[4]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"p_hat[5]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"p_hat[6]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
};

#ifndef CONTAINED
static const char *const model_guid = "{guid}";

static const uint32_t model_references[MODEL_N_VARIABLES] = {
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
    32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44,
};

static const ModelRun model_runs[MODEL_N_VARIABLES] = {
    {1, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {6, TYPE_REAL, ROLE_TUNABLE_PARAMETER},
    {5, TYPE_REAL, ROLE_TUNABLE_PARAMETER},
    {4, TYPE_REAL, ROLE_TUNABLE_PARAMETER},
    {3, TYPE_REAL, ROLE_TUNABLE_PARAMETER},
    {2, TYPE_REAL, ROLE_TUNABLE_PARAMETER},
    {1, TYPE_REAL, ROLE_TUNABLE_PARAMETER},
    {10, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {9, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {8, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {7, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {6, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {5, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {4, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {3, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {2, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {1, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {14, TYPE_REAL, ROLE_INPUT},
    {13, TYPE_REAL, ROLE_INPUT},
    {12, TYPE_REAL, ROLE_INPUT},
    {11, TYPE_REAL, ROLE_INPUT},
    {10, TYPE_REAL, ROLE_INPUT},
    {9, TYPE_REAL, ROLE_INPUT},
    {8, TYPE_REAL, ROLE_INPUT},
    {7, TYPE_REAL, ROLE_INPUT},
    {6, TYPE_REAL, ROLE_INPUT},
    {5, TYPE_REAL, ROLE_INPUT},
    {4, TYPE_REAL, ROLE_INPUT},
    {3, TYPE_REAL, ROLE_INPUT},
    {2, TYPE_REAL, ROLE_INPUT},
    {1, TYPE_REAL, ROLE_INPUT},
    {14, TYPE_REAL, ROLE_OUTPUT},
    {13, TYPE_REAL, ROLE_OUTPUT},
    {12, TYPE_REAL, ROLE_OUTPUT},
    {11, TYPE_REAL, ROLE_OUTPUT},
    {10, TYPE_REAL, ROLE_OUTPUT},
    {9, TYPE_REAL, ROLE_OUTPUT},
    {8, TYPE_REAL, ROLE_OUTPUT},
    {7, TYPE_REAL, ROLE_OUTPUT},
    {6, TYPE_REAL, ROLE_OUTPUT},
    {5, TYPE_REAL, ROLE_OUTPUT},
    {4, TYPE_REAL, ROLE_OUTPUT},
    {3, TYPE_REAL, ROLE_OUTPUT},
    {2, TYPE_REAL, ROLE_OUTPUT},
    {1, TYPE_REAL, ROLE_OUTPUT},
};
#endif

static const char *const model_static_checks[] = {
    0,
};

static const char *const model_checks[] = {
    "The arm is singular: q is stretched or folded, det(J J') / (sum of l)^4 must exceed 1e-12",
};

static const char *const model_states[] = {
    "x_t[1]",
    "x_t[2]",
    "dx_t[1]",
    "dx_t[2]",
};

static void model_calibrate(const double *p, double *restrict constants, double *restrict checks, double *restrict ticks) {
    const double *arguments[] = {p};
    double *results[] = {constants, checks, ticks};
    calibrate(arguments, results, 0, 0, 0);
}

static void model_initial(double t, const double *u, const double *p, const double *c, double *restrict states) {
    const double *arguments[] = {&t, u, p, c};
    double *results[] = {states};
    initial(arguments, results, 0, 0, 0);
}

static void model_tick(double t, const double *x, const double *u, const double *p, const double *c, const double *w, double *restrict y, double *restrict next, double *restrict checks) {
    const double *arguments[] = {&t, x, u, w, p, c};
    double *results[] = {y, next, checks};
    tick(arguments, results, 0, 0, 0);
}

#ifndef CONTAINED
static void model_initial_sensitivity(double t, const double *u, const double *p, const double *r, const double *v, const double *q, double *restrict dy) {
    const double *arguments[] = {&t, u, p, r, v, q};
    double *results[] = {dy};
    initial_sensitivity(arguments, results, 0, 0, 0);
}
#endif

#include "runtime.c"
