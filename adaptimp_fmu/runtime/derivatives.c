/* The FMI functions for derivatives: of inputs, which continue within a step; of outputs in time; and
 * of outputs along given directions. */
#include <string.h>

#include "instance.h"

/* The largest order of input derivatives that is used. A sampled model holds its inputs. */
#define INPUT_ORDER (MODEL_SAMPLED ? 0 : MAX_INPUT_ORDER)

static int is_real_input(const Instance *instance, fmi2ValueReference reference, const char *function) {
    if (!is_variable(instance, reference, TYPE_REAL, function)) return 0;
    if (model_variables[reference].role != ROLE_INPUT) {
        fail(instance, "%s: %s is not an input.", function, model_variables[reference].name);
        return 0;
    }
    if (!is_whole_real(reference)) return 1;
    fail(instance, "%s: %s must be %s, so it has no derivative.", function,
         model_variables[reference].name, model_variables[reference].range);
    return 0;
}

static int is_real_output(const Instance *instance, fmi2ValueReference reference, const char *function) {
    if (!is_variable(instance, reference, TYPE_REAL, function)) return 0;
    if (model_variables[reference].role == ROLE_OUTPUT) return 1;
    fail(instance, "%s: %s is not an output.", function, model_variables[reference].name);
    return 0;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    static const char name[] = "fmi2SetRealInputDerivatives";
    Instance *instance = allowed(c, ALLOWED_SET, name);
    if (!instance) return fmi2Error;
    if (INPUT_ORDER == 0)
        return fail(instance, "%s: canInterpolateInputs is false; a sampled model holds its inputs.", name);
    if (!arrays_present(instance, nvr, vr, value, name) ||
        !arrays_present(instance, nvr, vr, order, name))
        return fmi2Error;
    for (size_t i = 0; i < nvr; ++i) {
        if (!is_real_input(instance, vr[i], name)) return fmi2Error;
        if (order[i] < 1 || order[i] > INPUT_ORDER)
            return fail(instance, "%s: order %d of %s; orders 1 to %d are used.", name, (int)order[i],
                        model_variables[vr[i]].name, INPUT_ORDER);
        if (!all_finite(&value[i], 1))
            return fail(instance, "%s: the derivative of %s is %s; it must be finite.", name,
                        model_variables[vr[i]].name, not_finite(value[i]));
    }
#if !MODEL_SAMPLED
    for (size_t i = 0; i < nvr; ++i)
        instance->state.input_rates[order[i] - 1][vr[i] - MODEL_FIRST_INPUT] = value[i];
    if (nvr) instance->state.rates_given = 1;
#endif
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
    static const char name[] = "fmi2GetRealOutputDerivatives";
    Instance *instance = allowed(c, ALLOWED_STATUS, name);
    double dy[AT_LEAST_ONE(MODEL_N_OUTPUTS)];
    if (!instance || !arrays_present(instance, nvr, vr, value, name) ||
        !arrays_present(instance, nvr, vr, order, name))
        return fmi2Error;
    for (size_t i = 0; i < nvr; ++i) {
        if (!is_real_output(instance, vr[i], name)) return fmi2Error;
        if (order[i] != 1)
            return fail(instance, "%s: order %d of %s; only order 1 is known.", name, (int)order[i],
                        model_variables[vr[i]].name);
    }
    rates_of_outputs(&instance->state, dy);
    for (size_t i = 0; i < nvr; ++i) value[i] = dy[vr[i] - MODEL_FIRST_OUTPUT];
    return fmi2OK;
}

/* Directions by value reference; during initialization of parameters too. */
static int fill_direction(const Instance *instance, const fmi2ValueReference vr[], size_t n,
                          const fmi2Real dv[], double *direction) {
    static const char name[] = "fmi2GetDirectionalDerivative";
    for (size_t i = 0; i < n; ++i) {
        if (!is_variable(instance, vr[i], TYPE_REAL, name)) return 0;
        const VariableRole role = model_variables[vr[i]].role;
        if (role == ROLE_OUTPUT || (role != ROLE_INPUT && instance->state.phase != INITIALIZATION)) {
            fail(instance, "%s: %s is not a known variable in this state (inputs are; parameters during "
                           "initialization).",
                 name, model_variables[vr[i]].name);
            return 0;
        }
        direction[vr[i]] += dv[i];
    }
    return 1;
}

static void sensitivity_at_start(Instance *instance, const double *direction, double *dy) {
    State *s = &instance->state;
    double uniforms[4] = {0};
#if MODEL_SAMPLED
    draw_uniforms(s, uniforms);
#endif
    model_initial_sensitivity(s->time, inputs(s), parameters(s), uniforms,
                              direction + MODEL_FIRST_INPUT, direction, dy);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[],
                                        size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
    static const char name[] = "fmi2GetDirectionalDerivative";
    Instance *instance = allowed(c, ALLOWED_GET, name);
    double direction[MODEL_N_VARIABLES] = {0}, dy[AT_LEAST_ONE(MODEL_N_OUTPUTS)] = {0};
    if (!instance || !arrays_present(instance, nUnknown, vUnknown_ref, dvUnknown, name) ||
        !arrays_present(instance, nKnown, vKnown_ref, dvKnown, name))
        return fmi2Error;
    for (size_t i = 0; i < nUnknown; ++i)
        if (!is_real_output(instance, vUnknown_ref[i], name)) return fmi2Error;
    if (!fill_direction(instance, vKnown_ref, nKnown, dvKnown, direction)) return fmi2Error;
    if (instance->state.phase == INITIALIZATION)
        sensitivity_at_start(instance, direction, dy);
    else
        sensitivity_of_outputs(&instance->state, direction + MODEL_FIRST_INPUT, dy);
    for (size_t i = 0; i < nUnknown; ++i) dvUnknown[i] = dy[vUnknown_ref[i] - MODEL_FIRST_OUTPUT];
    return fmi2OK;
}
