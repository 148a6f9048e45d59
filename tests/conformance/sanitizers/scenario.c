/* Two instances, one in its scene, through all 34 functions, so many steps (argument), and resets. */
#include "drive.h"

static void read_all(fmi2Component c) {
    for (fmi2ValueReference r = 0; r < MODEL_N_VARIABLES; ++r) {
        double real = real_nan();
        int whole = 0;
        switch (model_variables[r].type) {
            case TYPE_REAL: OK(fmi2GetReal(c, &r, 1, &real)); break;
            case TYPE_INTEGER: OK(fmi2GetInteger(c, &r, 1, &whole)); break;
            default: OK(fmi2GetBoolean(c, &r, 1, &whole));
        }
        CHECK(real_is_finite(real) || model_variables[r].type != TYPE_REAL);
    }
    OK(fmi2GetString(c, NULL, 0, NULL));
}

/* Of every Real output along every Real input, and in time. */
static void read_derivatives(fmi2Component c, int in_time) {
    if (!DIFFERENTIATES) return;
    const fmi2Integer order = 1;
    for (fmi2ValueReference y = MODEL_FIRST_OUTPUT; y < MODEL_N_VARIABLES; ++y) {
        double dy = 0, direction = 1;
        if (model_variables[y].type != TYPE_REAL) continue;
        for (fmi2ValueReference u = MODEL_FIRST_INPUT; u < MODEL_FIRST_OUTPUT; ++u) {
            if (model_variables[u].type != TYPE_REAL) continue;
            OK(fmi2GetDirectionalDerivative(c, &y, 1, &u, 1, &direction, &dy));
            CHECK(real_is_finite(dy));
        }
        if (in_time) OK(fmi2GetRealOutputDerivatives(c, &y, 1, &order, &dy));
        CHECK(real_is_finite(dy));
    }
}

/* The first Real input, continued in the coming step; a sampled unit refuses. */
static void set_derivative(fmi2Component c) {
    const fmi2ValueReference u = MODEL_FIRST_INPUT;
    const fmi2Integer order = 1;
    const double rate = 0.5;
    const fmi2Status status = fmi2SetRealInputDerivatives(c, &u, 1, &order, &rate);
    CHECK((status == fmi2OK) == (INTERPOLATES && model_variables[u].type == TYPE_REAL));
}

static void ask_status(fmi2Component c) {
    fmi2Status status;
    double time;
    int whole;
    fmi2String text;
    OK(fmi2GetStatus(c, fmi2DoStepStatus, &status));
    OK(fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time));
    OK(fmi2GetBooleanStatus(c, fmi2Terminated, &whole));
    OK(fmi2GetStringStatus(c, fmi2PendingStatus, &text));
    CHECK(fmi2GetIntegerStatus(c, fmi2DoStepStatus, &whole) == fmi2Error);
    CHECK(fmi2CancelStep(c) == fmi2Error);
}

static void live(fmi2Component c, int in_scene, int steps, uint64_t seed) {
    const fmi2String category = "logStatusError";
    double start[MODEL_N_VARIABLES];
    if (in_scene) set_scene(c);
    OK(fmi2SetDebugLogging(c, fmi2True, 1, &category));
    OK(fmi2SetString(c, NULL, 0, NULL));
    read_values(c, start);
    OK(fmi2SetupExperiment(c, fmi2False, 0, 0, fmi2False, 0));
    OK(fmi2EnterInitializationMode(c));
    read_all(c);
    read_derivatives(c, 0);
    OK(fmi2ExitInitializationMode(c));
    for (int i = 0; i < steps; ++i) {
        set_inputs(c, start, &seed);
        if (i % 10 == 0) set_derivative(c);
        step(c, &seed);
        read_all(c);
        if (i % 50 == 0) through_bytes(c), read_derivatives(c, 1), ask_status(c);
    }
    OK(fmi2Terminate(c));
    CHECK(fmi2DoStep(c, 0, 1, fmi2True) == fmi2Error);
    OK(fmi2Reset(c));
}

int main(int argc, char **argv) {
    const int steps = argc > 1 ? atoi(argv[1]) : 2000;
    CHECK(strcmp(fmi2GetVersion(), "2.0") == 0 && strcmp(fmi2GetTypesPlatform(), "default") == 0);
    CHECK(!fmi2Instantiate("unit", fmi2CoSimulation, "wrong", NULL, &with_logger, fmi2False, fmi2True));
    fmi2Component one = create(&with_logger), other = create(&without_logger);
    live(one, 1, steps, 1);
    live(other, 0, steps / 4, 2);
    live(one, 0, steps / 4, 3);
    live(other, 1, steps / 4, 4);
    fmi2FreeInstance(one);
    fmi2FreeInstance(other);
    fmi2FreeInstance(NULL);
    printf("%d messages\n", messages);
    return 0;
}
