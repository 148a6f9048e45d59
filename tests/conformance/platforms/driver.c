/* Steps units as a master in C would and writes what they show; one source for every platform.
 *
 *     driver PLAN NAME LIBRARY GUID [NAME LIBRARY GUID ...]
 *
 * Compiled with LINKED_UNITS, which names a header, it steps units that are linked into it: LIBRARY is a prefix then.
 *
 * It reads and writes float64 numbers only. PLAN (tests/conformance/platforms/plan.py writes it): the counts of
 * units, steps, given signals, signals and initialization passes; for each unit the counts of its start
 * values, inputs and outputs, then these as (type, value reference, value or number of the signal); for each
 * step the time, its length and the given signals, which are the first ones. Standard output gets all signals
 * after initialization and after each step. In the middle all units save their state; at the end they go back
 * to it, repeat the second half, and must show the same bits. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#endif
#if defined LINKED_UNITS
/* Units that are linked into this program. */
#elif defined _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include "fmi2FunctionTypes.h"

#define FUNCTIONS(X)                                                                                         \
    X(fmi2Instantiate) X(fmi2SetupExperiment) X(fmi2EnterInitializationMode) X(fmi2ExitInitializationMode)   \
    X(fmi2SetReal) X(fmi2SetInteger) X(fmi2SetBoolean) X(fmi2GetReal) X(fmi2GetInteger) X(fmi2GetBoolean)    \
    X(fmi2DoStep) X(fmi2GetFMUstate) X(fmi2SetFMUstate) X(fmi2FreeFMUstate) X(fmi2Terminate)                 \
    X(fmi2FreeInstance)
#define MEMBER(name) name##TYPE *name;

typedef enum { REAL_TYPE, INTEGER_TYPE, BOOLEAN_TYPE } Type;
typedef struct {
    double type, reference, value; /* of an input or output: the signal's number */
} Item;
typedef struct {
    const Item *items;
    size_t count;
} Items;
typedef struct {
    FUNCTIONS(MEMBER)
    fmi2Component instance;
    Items starts, inputs, outputs;
} Unit;

static void stop(const char *what, const char *which) {
    fprintf(stderr, "driver: %s: %s\n", what, which);
    exit(1);
}

static void require(fmi2Status status, const char *function) {
    if (status > fmi2Warning) stop("failed", function);
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String message, ...) {
    va_list arguments;
    (void)environment;
    fprintf(stderr, "%s: %d %s: ", name, (int)status, category);
    va_start(arguments, message);
    vfprintf(stderr, message, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static const fmi2CallbackFunctions CALLBACKS = {log_message, calloc, free, NULL, NULL};

#ifdef LINKED_UNITS
typedef struct {
    const char *unit, *function;
    void (*address)(void);
} Linked;

#include LINKED_UNITS /* defines the array `linked` of all functions of all units; the last row is empty */

/* A unit is called by its prefix where others are by their library. */
static void *open_library(char *prefix) { return prefix; }

static void *find(void *library, const char *function) {
    const Linked *row = linked;
    while (row->unit && (strcmp(row->unit, library) != 0 || strcmp(row->function, function) != 0)) ++row;
    if (!row->unit) stop("is not linked", library);
    return (void *)row->address;
}
#else
static void *open_library(const char *path) {
#ifdef _WIN32
    void *library = (void *)LoadLibraryA(path);
#else
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
#endif
    if (library == NULL) stop("cannot be loaded", path);
    return library;
}

static void *find(void *library, const char *function) {
#ifdef _WIN32
    void *address = (void *)GetProcAddress((HMODULE)library, function);
#else
    void *address = dlsym(library, function);
#endif
    if (address == NULL) stop("is not exported", function);
    return address;
}
#endif

static void set(const Unit *unit, const Item *item, double value) {
    fmi2ValueReference reference = (fmi2ValueReference)item->reference;
    int number = (int)value;
    switch ((Type)item->type) {
    case REAL_TYPE: require(unit->fmi2SetReal(unit->instance, &reference, 1, &value), "fmi2SetReal"); break;
    case INTEGER_TYPE: require(unit->fmi2SetInteger(unit->instance, &reference, 1, &number), "fmi2SetInteger"); break;
    case BOOLEAN_TYPE: require(unit->fmi2SetBoolean(unit->instance, &reference, 1, &number), "fmi2SetBoolean"); break;
    }
}

static double get(const Unit *unit, const Item *item) {
    fmi2ValueReference reference = (fmi2ValueReference)item->reference;
    double value = 0;
    int number = 0;
    switch ((Type)item->type) {
    case REAL_TYPE: require(unit->fmi2GetReal(unit->instance, &reference, 1, &value), "fmi2GetReal"); return value;
    case INTEGER_TYPE: require(unit->fmi2GetInteger(unit->instance, &reference, 1, &number), "fmi2GetInteger"); break;
    case BOOLEAN_TYPE: require(unit->fmi2GetBoolean(unit->instance, &reference, 1, &number), "fmi2GetBoolean"); break;
    }
    return number;
}

static void take(const Unit *unit, const double *signals) {
    for (size_t i = 0; i < unit->inputs.count; ++i)
        set(unit, &unit->inputs.items[i], signals[(size_t)unit->inputs.items[i].value]);
}

static void show(const Unit *unit, double *signals) {
    for (size_t i = 0; i < unit->outputs.count; ++i)
        signals[(size_t)unit->outputs.items[i].value] = get(unit, &unit->outputs.items[i]);
}

/* One row: every unit in turn takes its inputs, steps and shows its outputs. */
static void step(const Unit *units, size_t n, const double *given, size_t n_given, double *signals) {
    memcpy(signals, given + 2, n_given * sizeof *signals);
    for (size_t i = 0; i < n; ++i) {
        take(&units[i], signals);
        require(units[i].fmi2DoStep(units[i].instance, given[0], given[1], fmi2False), "fmi2DoStep");
        show(&units[i], signals);
    }
}

static void load(Unit *unit, char *const names[]) {
    void *library = open_library(names[1]);
#define LOAD(name) unit->name = (name##TYPE *)find(library, #name);
    FUNCTIONS(LOAD)
    unit->instance = unit->fmi2Instantiate(names[0], fmi2CoSimulation, names[2], "", &CALLBACKS, fmi2False, fmi2True);
    if (unit->instance == NULL) stop("is not instantiated", names[0]);
}

static void initialize(const Unit *units, size_t n, size_t passes, double *signals) {
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = 0; j < units[i].starts.count; ++j)
            set(&units[i], &units[i].starts.items[j], units[i].starts.items[j].value);
        require(units[i].fmi2SetupExperiment(units[i].instance, fmi2False, 0, 0, fmi2False, 0), "fmi2SetupExperiment");
        require(units[i].fmi2EnterInitializationMode(units[i].instance), "fmi2EnterInitializationMode");
    }
    for (size_t i = 0; i < n; ++i) show(&units[i], signals);
    for (size_t pass = 0; pass < passes; ++pass) {
        for (size_t i = 0; i < n; ++i) take(&units[i], signals);
        for (size_t i = 0; i < n; ++i) show(&units[i], signals);
    }
    for (size_t i = 0; i < n; ++i) {
        require(units[i].fmi2ExitInitializationMode(units[i].instance), "fmi2ExitInitializationMode");
        show(&units[i], signals);
    }
}

static const double *read_plan(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL || fseek(file, 0, SEEK_END) != 0) stop("cannot be read", path);
    size_t size = (size_t)ftell(file);
    double *numbers = malloc(size);
    rewind(file);
    if (numbers == NULL || fread(numbers, 1, size, file) != size) stop("cannot be read", path);
    fclose(file);
    return numbers;
}

static Items read_items(const double **cursor, double count) {
    Items items = {(const Item *)*cursor, (size_t)count};
    *cursor += 3 * items.count;
    return items;
}

static void *allocate(size_t count, size_t size) {
    void *memory = calloc(count, size);
    if (memory == NULL) stop("no memory for", "the result");
    return memory;
}

static void write_row(const double *row, size_t width) {
    if (fwrite(row, sizeof *row, width, stdout) != width) stop("cannot be written", "a row");
}

/* Goes back to the saved states and makes the steps from `first` on again, which must show the same rows. */
static void repeat(const Unit *units, size_t n, fmi2FMUstate *states, const double *steps, size_t n_given,
                   const double *rows, size_t width, size_t first, size_t last) {
    double *again = allocate(width, sizeof *again);
    for (size_t i = 0; i < n; ++i) {
        require(units[i].fmi2SetFMUstate(units[i].instance, states[i]), "fmi2SetFMUstate");
        require(units[i].fmi2FreeFMUstate(units[i].instance, &states[i]), "fmi2FreeFMUstate");
    }
    memcpy(again, rows + first * width, width * sizeof *again);
    for (size_t k = first; k < last; ++k) {
        step(units, n, steps + k * (2 + n_given), n_given, again);
        if (memcmp(again, rows + (k + 1) * width, width * sizeof *again) != 0) stop("differs", "the repeated half");
    }
}

int main(int argc, char *argv[]) {
    if (argc < 5) stop("usage", "driver PLAN NAME LIBRARY GUID [NAME LIBRARY GUID ...]");
#ifdef _WIN32
    _setmode(_fileno(stdout), _O_BINARY); /* bytes, without line ends */
#endif
    const double *cursor = read_plan(argv[1]);
    const size_t n = (size_t)cursor[0], steps = (size_t)cursor[1], n_given = (size_t)cursor[2];
    const size_t width = (size_t)cursor[3], passes = (size_t)cursor[4], middle = steps / 2;
    if (argc != (int)(2 + 3 * n)) stop("as many units must be given as has", argv[1]);
    cursor += 5;
    Unit *units = allocate(n, sizeof *units);
    fmi2FMUstate *states = allocate(n, sizeof *states);
    for (size_t i = 0; i < n; ++i) {
        const double *counts = cursor;
        cursor += 3;
        units[i].starts = read_items(&cursor, counts[0]);
        units[i].inputs = read_items(&cursor, counts[1]);
        units[i].outputs = read_items(&cursor, counts[2]);
        load(&units[i], argv + 2 + 3 * i);
    }

    double *rows = allocate((steps + 1) * width, sizeof *rows);
    memcpy(rows, cursor + 2, n_given * sizeof *rows);
    initialize(units, n, passes, rows);
    write_row(rows, width);
    for (size_t k = 0; k < steps; ++k) {
        double *row = rows + (k + 1) * width;
        if (k == middle)
            for (size_t i = 0; i < n; ++i)
                require(units[i].fmi2GetFMUstate(units[i].instance, &states[i]), "fmi2GetFMUstate");
        memcpy(row, row - width, width * sizeof *row);
        step(units, n, cursor + k * (2 + n_given), n_given, row);
        write_row(row, width);
    }
    repeat(units, n, states, cursor, n_given, rows, width, middle, steps);

    for (size_t i = 0; i < n; ++i) {
        require(units[i].fmi2Terminate(units[i].instance), "fmi2Terminate");
        units[i].fmi2FreeInstance(units[i].instance);
    }
    if (fclose(stdout) != 0) stop("cannot be written", "the last rows");
    return 0;
}
