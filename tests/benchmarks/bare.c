/* The five units of the paper's loop as plain C calls, values passed by copying arrays. The inputs
 * of the controller are q, dq, ddq, F_hat, x_v, dx_v, ddx_v and, with CONTROLLER_SEES_SATURATION, the
 * actuator's second output, saturated; outputs of the plant begin with q, dq, ddq, x, dx, F_ext. The
 * benchmark checks the result against the real run, bit by bit. */
#include <stdint.h>
#include <string.h>

#define UNIT(name)                                                                                 \
    extern double *const name##_inputs, *const name##_outputs;                                     \
    extern const int64_t name##_n_inputs;                                                          \
    void name##_step(double t, double h);                                                          \
    void name##_start(const double *given, double t0);
UNIT(trajectory)
UNIT(sensor)
UNIT(controller)
UNIT(actuator)
UNIT(plant)

typedef struct {
    double *const *inputs, *const *outputs;
    const int64_t *n_inputs;
    void (*step)(double t, double h);
    void (*start)(const double *given, double t0);
} Unit;

#define ENTRY(name)                                                                                \
    {&name##_inputs, &name##_outputs, &name##_n_inputs, name##_step, name##_start}
static const Unit units[] = {ENTRY(trajectory), ENTRY(sensor), ENTRY(controller), ENTRY(actuator),
                             ENTRY(plant)};

#define EXPORT __attribute__((visibility("default")))
#define COPY(target, source, n) memcpy((target), (source), (n) * sizeof(double))

EXPORT void bare_start(int64_t unit, const double *given, double t0) {
    units[unit].start(given, t0);
}

EXPORT const double *bare_outputs(int64_t unit) { return *units[unit].outputs; }

static void copy_to_sensor(void) { COPY(sensor_inputs, plant_outputs + 10, 2); }

static void copy_to_controller(void) {
    COPY(controller_inputs, plant_outputs, 6);
    COPY(controller_inputs + 6, sensor_outputs, 2);
    COPY(controller_inputs + 8, trajectory_outputs, 6);
#if CONTROLLER_SEES_SATURATION
    COPY(controller_inputs + 14, actuator_outputs + 2, 2);
#endif
}

static void copy_to_actuator(void) { COPY(actuator_inputs, controller_outputs, 2); }

static void copy_to_plant(void) { COPY(plant_inputs, actuator_outputs, 2); }

EXPORT void bare_run(const double *times, double h, int64_t first, int64_t last) {
    for (int64_t k = first; k < last; ++k) {
        const double t = times[k];
        trajectory_step(t, h);
        copy_to_sensor();
        sensor_step(t, h);
        copy_to_controller();
        controller_step(t, h);
        copy_to_actuator();
        actuator_step(t, h);
        copy_to_plant();
        plant_step(t, h);
    }
}

/* The copies of a step alone, n times. The barrier keeps the compiler from making them once. */
EXPORT void bare_copies(int64_t n) {
    for (int64_t k = 0; k < n; ++k) {
        copy_to_sensor();
        copy_to_controller();
        copy_to_actuator();
        copy_to_plant();
        __asm__ volatile("" ::: "memory");
    }
}

/* One unit alone, with the inputs it had in a run (n rows of them); without `step`, the copying. */
EXPORT void bare_replay(int64_t unit, const double *times, double h, int64_t n,
                        const double *inputs, int32_t step) {
    const Unit *u = &units[unit];
    const int64_t width = *u->n_inputs;
    for (int64_t k = 0; k < n; ++k) {
        COPY(*u->inputs, inputs + k * width, width);
        if (step) u->step(times[k], h);
    }
}
