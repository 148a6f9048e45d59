/* What all drivers share. One translation unit with the unit's own model.c (found by -I, as is
 * scene.h with start values by name), so that the state behind a component can be compared bit by bit. */
#ifndef UNIT_H
#define UNIT_H

#include <math.h>

#include "model.c"
#include "scene.h"

#include <stdio.h>

#define CHECK(condition)                                                                           \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: violated: %s\n", __FILE__, __LINE__, #condition);              \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

/* What kinds of FMUs differ in: lengths of steps of a random run, in ticks, and whether inputs continue in a step. */
#ifdef MODEL_CONTAINER
#define PARTS {1, 2, 1, 3, 5, 1}
#define INTERPOLATES 0
#define DIFFERENTIATES 0
#else
#define PARTS {1, 0.5, 0.7, 2, 3.3, 0.25}
#define INTERPOLATES (!MODEL_SAMPLED)
#define DIFFERENTIATES 1
#endif

static int messages;

/* Counts messages and demands: safe as a printf format, one line, declared category. */
static void receive(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                    fmi2String category, fmi2String message, ...) {
    (void)environment;
    ++messages;
    CHECK(name && status == fmi2Error && strcmp(category, "logStatusError") == 0);
    CHECK(*message && message[strlen(message) - 1] != '\n');
    for (const char *c = message; *c; ++c)
        if (*c == '%') CHECK(*++c == '%');
}

static const fmi2CallbackFunctions with_logger = {.logger = receive}, without_logger = {0};

static fmi2Component create(const fmi2CallbackFunctions *callbacks) {
    fmi2Component c = fmi2Instantiate("unit", fmi2CoSimulation, model_guid, NULL, callbacks, fmi2False, fmi2True);
    CHECK(c);
    return c;
}

static void set_number(fmi2Component c, fmi2ValueReference r, double value) {
    const int whole = (int)value;
    switch (model_variables[r].type) {
        case TYPE_REAL: CHECK(fmi2SetReal(c, &r, 1, &value) == fmi2OK); break;
        case TYPE_INTEGER: CHECK(fmi2SetInteger(c, &r, 1, &whole) == fmi2OK); break;
        default: CHECK(fmi2SetBoolean(c, &r, 1, &whole) == fmi2OK);
    }
}

/* Start values that bring the unit's equations to life: contact, noise, limits. */
static void set_scene(fmi2Component c) {
    for (const SceneValue *s = scene_values; s->name; ++s)
        for (fmi2ValueReference r = 0; r < MODEL_FIRST_OUTPUT; ++r)
            if (strcmp(model_variables[r].name, s->name) == 0) set_number(c, r, s->value);
}

#endif
