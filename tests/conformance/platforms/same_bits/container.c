/* Runs a system that was exported as C for a number of steps, and writes its rows to standard output.
 *
 *     container STEPS
 *
 * SYSTEM is the prefix of the system's names. A row has all outputs as float64; the first one shows them
 * after initialization. */
#include <stdio.h>
#include <stdlib.h>

#include "step.h"

#define JOINED(prefix, name) prefix##name
#define WITH_PREFIX(prefix, name) JOINED(prefix, name)
#define OF(name) WITH_PREFIX(SYSTEM, name)

static OF(_System) loop;
static Failure failure;

static void require(int done) {
    if (done) return;
    fprintf(stderr, "%s: %s\n", failure.component ? failure.component : "system", failure.sentence);
    exit(1);
}

static void write_row(void) {
    const uint32_t first = OF(_N_PARAMETERS) + OF(_N_INPUTS);
    for (uint32_t i = 0; i < OF(_N_OUTPUTS); ++i) {
        const double value = OF(_get)(&loop, first + i);
        if (fwrite(&value, sizeof value, 1, stdout) != 1) exit(2);
    }
}

int main(int argc, char *argv[]) {
    const long steps = argc == 2 ? strtol(argv[1], NULL, 10) : 0;
    OF(_reset)(&loop);
    require(OF(_initialize)(&loop, 0.0, &failure));
    write_row();
    for (long k = 0; k < steps; ++k) {
        require(OF(_step)(&loop, 1, &failure));
        write_row();
    }
    return fclose(stdout) == 0 ? 0 : 2;
}
