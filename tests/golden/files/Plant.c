/* Plant: tables and equations. Generated; do not edit. */

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
    {"dt_max", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0001, 1e-12, REAL_INFINITY, "at least 1e-12 s" },
    {"q_start[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     -0.7227342478, -REAL_INFINITY, REAL_INFINITY, "" },
    {"q_start[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.4454684956, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dq_start[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     2.0943951024, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dq_start[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"m[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     2.0, 1e-12, REAL_INFINITY, "at least 1e-12 kg" },
    {"m[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.0, 1e-12, REAL_INFINITY, "at least 1e-12 kg" },
    {"l[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.0, 1e-12, REAL_INFINITY, "at least 1e-12 m" },
    {"l[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.0, 1e-12, REAL_INFINITY, "at least 1e-12 m" },
    {"viscous[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m.s/rad" },
    {"viscous[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m.s/rad" },
    {"coulomb[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m" },
    {"coulomb[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 N.m" },
    {"coulomb_velocity", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.01, 1e-12, REAL_INFINITY, "at least 1e-12 rad/s" },
    {"gravity", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"wall_normal[1]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     -1.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"wall_normal[2]", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"wall_offset", TYPE_REAL, ROLE_FIXED_PARAMETER,
     1.45, -REAL_INFINITY, REAL_INFINITY, "" },
    {"K_f", TYPE_REAL, ROLE_FIXED_PARAMETER,
     100000.0, 0.0, REAL_INFINITY, "at least 0 N/m" },
    {"D_f", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0 s/m" },
    {"mu", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.0, 0.0, REAL_INFINITY, "at least 0" },
    {"friction_velocity", TYPE_REAL, ROLE_FIXED_PARAMETER,
     0.01, 1e-12, REAL_INFINITY, "at least 1e-12 m/s" },
    {"tau[1]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"tau[2]", TYPE_REAL, ROLE_INPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"q[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"q[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dq[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dq[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"ddq[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"ddq[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"x[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"x[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dx[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"dx[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"F_ext[1]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"F_ext[2]", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"gap", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
    {"penetration", TYPE_REAL, ROLE_OUTPUT,
     0.0, -REAL_INFINITY, REAL_INFINITY, "" },
};

#ifndef CONTAINED
static const char *const model_guid = "{guid}";

static const uint32_t model_references[MODEL_N_VARIABLES] = {
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
    32, 33, 34, 35, 36, 37,
};

static const ModelRun model_runs[MODEL_N_VARIABLES] = {
    {22, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {21, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {20, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {19, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {18, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {17, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {16, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {15, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {14, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {13, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {12, TYPE_REAL, ROLE_FIXED_PARAMETER},
    {11, TYPE_REAL, ROLE_FIXED_PARAMETER},
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
    "wall_normal must have length 1",
};

static const char *const model_checks[] = {
    0,
};

static const char *const model_states[] = {
    "q[1]",
    "q[2]",
    "dq[1]",
    "dq[2]",
};

static void model_calibrate(const double *p, double *restrict constants, double *restrict checks, double *restrict ticks) {
    const double *arguments[] = {p};
    double *results[] = {constants, checks, ticks};
    calibrate(arguments, results, 0, 0, 0);
}

static void model_prepare(const double *x, const double *p, const double *c, double *restrict shared) {
    const double *arguments[] = {x, p, c};
    double *results[] = {shared};
    prepare(arguments, results, 0, 0, 0);
}

static void model_initial(double t, const double *u, const double *p, const double *c, double *restrict states) {
    const double *arguments[] = {&t, u, p, c};
    double *results[] = {states};
    initial(arguments, results, 0, 0, 0);
}

static void model_derivative(double t, const double *x, const double *u, const double *p, const double *c, const double *m, const double *s, double *restrict dx) {
    const double *arguments[] = {&t, x, u, m, p, c, s};
    double *results[] = {dx};
    derivative(arguments, results, 0, 0, 0);
}

static void model_output(double t, const double *x, const double *u, const double *p, const double *c, const double *m, const double *s, double *restrict y, double *restrict checks) {
    const double *arguments[] = {&t, x, u, m, p, c, s};
    double *results[] = {y, checks};
    output(arguments, results, 0, 0, 0);
}

static void model_event_indicators(double t, const double *x, const double *p, const double *c, const double *s, double *restrict z) {
    const double *arguments[] = {&t, x, p, c, s};
    double *results[] = {z};
    event_indicators(arguments, results, 0, 0, 0);
}

#ifndef CONTAINED
static void model_initial_sensitivity(double t, const double *u, const double *p, const double *r, const double *v, const double *q, double *restrict dy) {
    const double *arguments[] = {&t, u, p, r, v, q};
    double *results[] = {dy};
    initial_sensitivity(arguments, results, 0, 0, 0);
}
#endif

#ifndef CONTAINED
static void model_output_rate(double t, const double *x, const double *u, const double *p, const double *m, const double *v, double *restrict dy) {
    const double *arguments[] = {&t, x, u, p, m, v};
    double *results[] = {dy};
    output_rate(arguments, results, 0, 0, 0);
}
#endif

#ifndef CONTAINED
static void model_output_sensitivity(double t, const double *x, const double *u, const double *p, const double *m, const double *v, double *restrict dy) {
    const double *arguments[] = {&t, x, u, p, m, v};
    double *results[] = {dy};
    output_sensitivity(arguments, results, 0, 0, 0);
}
#endif

#include "runtime.c"
