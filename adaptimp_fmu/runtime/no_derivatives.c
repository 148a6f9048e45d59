/* The FMI functions for derivatives, which a container does not provide. */
#include "instance.h"

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    static const char name[] = "fmi2SetRealInputDerivatives";
    Instance *instance = allowed(c, ALLOWED_SET, name);
    (void)vr;
    (void)nvr;
    (void)order;
    (void)value;
    if (!instance) return fmi2Error;
    return fail(instance, "%s: canInterpolateInputs is false; a container holds its inputs.", name);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[]) {
    static const char name[] = "fmi2GetRealOutputDerivatives";
    Instance *instance = allowed(c, ALLOWED_STATUS, name);
    (void)vr;
    (void)nvr;
    (void)order;
    (void)value;
    if (!instance) return fmi2Error;
    return fail(instance, "%s: maxOutputDerivativeOrder is 0; a container knows no derivatives.", name);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[],
                                        size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[]) {
    static const char name[] = "fmi2GetDirectionalDerivative";
    Instance *instance = allowed(c, ALLOWED_GET, name);
    (void)vUnknown_ref;
    (void)nUnknown;
    (void)vKnown_ref;
    (void)nKnown;
    (void)dvKnown;
    (void)dvUnknown;
    if (!instance) return fmi2Error;
    return fail(instance, "%s: providesDirectionalDerivative is false; a container knows no derivatives.", name);
}
