/* CartesianImpedance: conventional impedance control of a planar arm, an FMU written by hand.
 *
 * Written from the FMI 2.0 standard alone, with names and units of its own (deg, N.mm, N/mm): nothing
 * here comes from adaptimp. The law is eq. (5) of Lu & Meng (1991), with the mobility W = J H^-1 J':
 *
 *     a   = ddx_v - (B (dx - dx_v) + K (x - x_v) + F) / M
 *     tau = J' [ F + W^-1 (a - dJ/dt dq + J H^-1 (C dq + g)) ]
 *
 * F is the force of the tip on its surroundings. A step computes the torque from the inputs set before
 * it; the torque holds until the next step. The whole state is `Core`, which is saved, restored and
 * serialized byte by byte.
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#define GUID "{7f0c9a52-3f0e-4c58-9d21-5b8a6e4f1c03}"
#define UNUSED(x) (void)(x)
#define API FMI2_Export fmi2Status

static const double RADIANS = 0.017453292519943295; /* in a degree */
static const double TORQUE_UNIT = 1e-3;             /* N.m in a N.mm */
static const double STIFFNESS_UNIT = 1e3;           /* N/m in a N/mm */

/* Value references; a vector takes two. */
enum {
    JOINT_ANGLE = 0, JOINT_RATE = 2, FORCE = 4, REFERENCE = 6, REFERENCE_RATE = 8, REFERENCE_ACCELERATION = 10,
    TORQUE = 12, /* inputs before, parameters behind */
    TARGET_MASS = 14, DAMPING = 16, STIFFNESS = 18, LINK_LENGTH = 20, LINK_MASS = 22, GRAVITY = 24,
    N_VALUES
};

enum { INSTANTIATED = 1, INITIALIZING = 2, STEPPING = 4, TERMINATED = 8, FAILED = 16 };
enum { ALIVE = INSTANTIATED | INITIALIZING | STEPPING | TERMINATED | FAILED };

typedef struct {
    long long mark; /* tells a saved state from other bytes */
    int mode;
    int stops;
    double time, stop;
    double value[N_VALUES];
} Core;

typedef struct {
    Core core;
    fmi2CallbackFunctions callbacks;
    fmi2Boolean logging;
    char name[128];
} Unit;

static const Core FRESH = {
    .mark = 0x31454e4f43LL,
    .mode = INSTANTIATED,
    .value = {[JOINT_ANGLE] = -41.409622, 82.819244, [JOINT_RATE] = 120, 0, [REFERENCE] = 1.5, 0,
              [REFERENCE_RATE] = 0, 3.141592653589793, [REFERENCE_ACCELERATION] = -14.804406601634037, 0,
              [TARGET_MASS] = 2, 2, [DAMPING] = 340, 340, [STIFFNESS] = 4, 4, [LINK_LENGTH] = 1, 1,
              [LINK_MASS] = 2, 1, [GRAVITY] = 0},
};

/* ---- the law --------------------------------------------------------------------------------- */

typedef struct {
    double a, b, c, d; /* [a b; c d] */
} Matrix;

static Matrix inverse(Matrix m) {
    const double det = m.a * m.d - m.b * m.c;
    return (Matrix){m.d / det, -m.b / det, -m.c / det, m.a / det};
}

static Matrix transpose(Matrix m) { return (Matrix){m.a, m.c, m.b, m.d}; }

static Matrix product(Matrix m, Matrix n) {
    return (Matrix){m.a * n.a + m.b * n.c, m.a * n.b + m.b * n.d, m.c * n.a + m.d * n.c, m.c * n.b + m.d * n.d};
}

static void apply(Matrix m, const double x[2], double y[2]) {
    const double first = m.a * x[0] + m.b * x[1];
    y[1] = m.c * x[0] + m.d * x[1];
    y[0] = first;
}

/* Tip acceleration that the target impedance asks for, less dJ/dt dq. */
static void demand(const double *v, const double x[2], const double dx[2], const double drift[2], double a[2]) {
    for (int i = 0; i < 2; i++) {
        const double damped = v[DAMPING + i] * (dx[i] - v[REFERENCE_RATE + i]);
        const double sprung = STIFFNESS_UNIT * v[STIFFNESS + i] * (x[i] - v[REFERENCE + i]);
        a[i] = v[REFERENCE_ACCELERATION + i] - (damped + sprung + v[FORCE + i]) / v[TARGET_MASS + i] - drift[i];
    }
}

static void compute_torque(double v[N_VALUES]) {
    const double l1 = v[LINK_LENGTH], l2 = v[LINK_LENGTH + 1], m1 = v[LINK_MASS], m2 = v[LINK_MASS + 1];
    const double q1 = RADIANS * v[JOINT_ANGLE], q2 = RADIANS * v[JOINT_ANGLE + 1];
    const double w1 = RADIANS * v[JOINT_RATE], w2 = RADIANS * v[JOINT_RATE + 1], w12 = w1 + w2;
    const double c1 = l1 * cos(q1), s1 = l1 * sin(q1), c12 = l2 * cos(q1 + q2), s12 = l2 * sin(q1 + q2);
    const double dq[2] = {w1, w2}, x[2] = {c1 + c12, s1 + s12};
    const Matrix J = {-s1 - s12, -s12, c1 + c12, c12};
    const double drift[2] = {-c1 * w1 * w1 - c12 * w12 * w12, -s1 * w1 * w1 - s12 * w12 * w12};
    const double couple = m2 * l1 * l2 * cos(q2), h = m2 * l1 * l2 * sin(q2), outer = m2 * l2 * l2;
    const Matrix H = {(m1 + m2) * l1 * l1 + outer + 2 * couple, outer + couple, outer + couple, outer};
    const double bias[2] = {-h * w2 * w1 - h * w12 * w2 + v[GRAVITY] * ((m1 + m2) * c1 + m2 * c12),
                            h * w1 * w1 + v[GRAVITY] * m2 * c12};
    const Matrix falls = product(J, inverse(H)); /* tip acceleration by joint torque */
    double dx[2], a[2], free_fall[2], force[2];
    apply(J, dq, dx);
    demand(v, x, dx, drift, a);
    apply(falls, bias, free_fall);
    for (int i = 0; i < 2; i++) a[i] += free_fall[i];
    apply(inverse(product(falls, transpose(J))), a, force);
    for (int i = 0; i < 2; i++) force[i] += v[FORCE + i];
    apply(transpose(J), force, &v[TORQUE]);
    for (int i = 0; i < 2; i++) v[TORQUE + i] /= TORQUE_UNIT;
}

/* ---- messages and modes ---------------------------------------------------------------------- */

static fmi2Status failed(Unit *unit, const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (unit->callbacks.logger && unit->logging)
        unit->callbacks.logger(unit->callbacks.componentEnvironment, unit->name, fmi2Error, "logStatusError", "%s",
                               text);
    return fmi2Error;
}

static fmi2Status require(Unit *unit, int modes, const char *function) {
    if (unit == NULL) return fmi2Error;
    return unit->core.mode & modes ? fmi2OK : failed(unit, "%s is not allowed now.", function);
}

#define REQUIRE(modes)                                             \
    Unit *unit = c;                                                \
    if (require(unit, modes, __func__) != fmi2OK) return fmi2Error

API fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    REQUIRE(ALIVE);
    UNUSED(n), UNUSED(categories);
    unit->logging = on;
    return fmi2OK;
}

FMI2_Export const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
FMI2_Export const char *fmi2GetVersion(void) { return fmi2Version; }

/* ---- life ------------------------------------------------------------------------------------ */

FMI2_Export fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
    UNUSED(resources), UNUSED(visible);
    if (callbacks == NULL || name == NULL || !*name || type != fmi2CoSimulation) return NULL;
    Unit *unit = calloc(1, sizeof *unit);
    if (unit == NULL) return NULL;
    unit->core = FRESH;
    unit->callbacks = *callbacks;
    unit->logging = logging;
    snprintf(unit->name, sizeof unit->name, "%s", name);
    if (guid != NULL && strcmp(guid, GUID) == 0) return unit;
    unit->logging = fmi2True; /* this must be heard */
    failed(unit, "The GUID %s is not %s, that of the binary.", guid ? guid : "NULL", GUID);
    free(unit);
    return NULL;
}

FMI2_Export void fmi2FreeInstance(fmi2Component c) { free(c); }

API fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_given, fmi2Real tolerance, fmi2Real start,
                        fmi2Boolean stops, fmi2Real stop) {
    REQUIRE(INSTANTIATED);
    UNUSED(tolerance_given), UNUSED(tolerance);
    unit->core.time = start;
    unit->core.stops = stops;
    unit->core.stop = stop;
    return fmi2OK;
}

API fmi2EnterInitializationMode(fmi2Component c) {
    REQUIRE(INSTANTIATED);
    unit->core.mode = INITIALIZING;
    return fmi2OK;
}

API fmi2ExitInitializationMode(fmi2Component c) {
    REQUIRE(INITIALIZING);
    compute_torque(unit->core.value);
    unit->core.mode = STEPPING;
    return fmi2OK;
}

API fmi2Terminate(fmi2Component c) {
    REQUIRE(STEPPING);
    unit->core.mode = TERMINATED;
    return fmi2OK;
}

API fmi2Reset(fmi2Component c) {
    REQUIRE(ALIVE);
    unit->core = FRESH;
    return fmi2OK;
}

static fmi2Status stepped(Unit *unit, double t, double h) {
    Core *core = &unit->core;
    if (!(h > 0) || !isfinite(h)) return failed(unit, "The step of %.17g s is not positive.", h);
    if (!(fabs(t - core->time) <= 1e-9 * fmax(1, fabs(t))))
        return failed(unit, "The step begins at %.17g s, but this unit is at %.17g s.", t, core->time);
    if (core->stops && t + h > core->stop + 1e-9 * fmax(1, fabs(core->stop)))
        return failed(unit, "The step to %.17g s leads beyond the stop time %.17g s.", t + h, core->stop);
    for (int i = 0; i < TORQUE; i++)
        if (!isfinite(core->value[i])) return failed(unit, "Input %d is %g.", i, core->value[i]);
    compute_torque(core->value);
    core->time = t + h;
    return fmi2OK;
}

API fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_return) {
    REQUIRE(STEPPING);
    UNUSED(no_return);
    return stepped(unit, t, h);
}

API fmi2CancelStep(fmi2Component c) {
    REQUIRE(0); /* steps are never pending */
    return fmi2OK;
}

/* ---- values ---------------------------------------------------------------------------------- */

API fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    REQUIRE(ALIVE);
    if (unit->core.mode == INITIALIZING) compute_torque(unit->core.value);
    for (size_t i = 0; i < n; i++) {
        if (vr[i] >= N_VALUES) return failed(unit, "There is no Real with the value reference %u.", vr[i]);
        value[i] = unit->core.value[vr[i]];
    }
    return fmi2OK;
}

API fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    REQUIRE(INSTANTIATED | INITIALIZING | STEPPING);
    for (size_t i = 0; i < n; i++) {
        const int input = vr[i] < TORQUE, parameter = vr[i] >= TARGET_MASS && vr[i] < N_VALUES;
        if (!input && !(parameter && unit->core.mode != STEPPING))
            return failed(unit, "The Real with the value reference %u cannot be set now.", vr[i]);
        unit->core.value[vr[i]] = value[i];
    }
    return fmi2OK;
}

#define NONE(type)                                                                                                    \
    API fmi2Get##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2##type value[]) {                 \
        REQUIRE(ALIVE);                                                                                               \
        UNUSED(vr), UNUSED(value);                                                                                    \
        return n ? failed(unit, "There is no " #type ".") : fmi2OK;                                                   \
    }                                                                                                                 \
    API fmi2Set##type(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2##type value[]) {           \
        REQUIRE(ALIVE);                                                                                               \
        UNUSED(vr), UNUSED(value);                                                                                    \
        return n ? failed(unit, "There is no " #type ".") : fmi2OK;                                                   \
    }
NONE(Integer)
NONE(Boolean)
NONE(String)

/* ---- states ---------------------------------------------------------------------------------- */

API fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    REQUIRE(ALIVE);
    if (*state == NULL) *state = malloc(sizeof(Core));
    if (*state == NULL) return failed(unit, "There is no memory for a state.");
    memcpy(*state, &unit->core, sizeof(Core));
    return fmi2OK;
}

API fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    REQUIRE(ALIVE);
    if (state == NULL) return failed(unit, "There is no state to set.");
    memcpy(&unit->core, state, sizeof(Core));
    return fmi2OK;
}

API fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    REQUIRE(ALIVE);
    if (state != NULL) free(*state), *state = NULL;
    return fmi2OK;
}

API fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    REQUIRE(ALIVE);
    UNUSED(state);
    *size = sizeof(Core);
    return fmi2OK;
}

API fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    REQUIRE(ALIVE);
    if (size < sizeof(Core)) return failed(unit, "%zu bytes do not hold a state.", size);
    memcpy(bytes, state, sizeof(Core));
    return fmi2OK;
}

API fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    Core core;
    REQUIRE(ALIVE);
    if (size != sizeof core) return failed(unit, "A state has %zu bytes, not %zu.", sizeof core, size);
    memcpy(&core, bytes, sizeof core);
    if (core.mark != FRESH.mark) return failed(unit, "These bytes are no state.");
    if (*state == NULL) *state = malloc(sizeof core);
    if (*state == NULL) return failed(unit, "There is no memory for a state.");
    memcpy(*state, &core, sizeof core);
    return fmi2OK;
}

/* ---- what this unit does not offer ----------------------------------------------------------- */

API fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t n,
                                 const fmi2ValueReference knowns[], size_t m, const fmi2Real seed[],
                                 fmi2Real derivative[]) {
    REQUIRE(ALIVE);
    UNUSED(unknowns), UNUSED(n), UNUSED(knowns), UNUSED(m), UNUSED(seed), UNUSED(derivative);
    return failed(unit, "There are no directional derivatives.");
}

API fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                const fmi2Real value[]) {
    REQUIRE(ALIVE);
    UNUSED(vr), UNUSED(n), UNUSED(order), UNUSED(value);
    return failed(unit, "Inputs are not interpolated.");
}

API fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[],
                                 fmi2Real value[]) {
    REQUIRE(ALIVE);
    UNUSED(vr), UNUSED(n), UNUSED(order), UNUSED(value);
    return failed(unit, "Outputs have no derivatives.");
}

#define STATUS(name, type)                                                       \
    API fmi2Get##name(fmi2Component c, const fmi2StatusKind kind, type *value) { \
        REQUIRE(ALIVE);                                                          \
        UNUSED(kind), UNUSED(value);                                             \
        return fmi2Discard; /* steps are never pending */                        \
    }
STATUS(Status, fmi2Status)
STATUS(RealStatus, fmi2Real)
STATUS(IntegerStatus, fmi2Integer)
STATUS(BooleanStatus, fmi2Boolean)
STATUS(StringStatus, fmi2String)
