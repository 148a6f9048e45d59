/* Eight threads with eight instances each, all stepping at once, end in the state of a lone run. */
#define _POSIX_C_SOURCE 200112L /* barriers */
#include "drive.h"

#include <pthread.h>

enum { N_THREADS = 8, N_EACH = 8, STEPS = 150 };

static State together[N_THREADS][N_EACH];
static pthread_barrier_t barrier;

static void initialize(fmi2Component c) {
    OK(fmi2SetupExperiment(c, fmi2True, 1e-6, 0.125, fmi2True, 10));
    OK(fmi2EnterInitializationMode(c));
    OK(fmi2ExitInitializationMode(c));
}

static void run_instances(uint64_t first, State *ends) {
    fmi2Component components[N_EACH];
    uint64_t seeds[N_EACH];
    double start[MODEL_N_VARIABLES];
    for (uint64_t i = 0; i < N_EACH; ++i) {
        seeds[i] = first + i;
        components[i] = create(&without_logger);
        set_scene(components[i]);
        read_values(components[i], start);
        initialize(components[i]);
    }
    for (int k = 0; k < STEPS; ++k) {
        for (int i = 0; i < N_EACH; ++i) {
            set_inputs(components[i], start, &seeds[i]);
            step(components[i], &seeds[i]);
            if (k % 50 == 0) through_bytes(components[i]);
        }
    }
    for (int i = 0; i < N_EACH; ++i) {
        ends[i] = ((Instance *)components[i])->state;
        fmi2FreeInstance(components[i]);
    }
}

static void *run_thread(void *argument) {
    const size_t thread = (size_t)argument;
    pthread_barrier_wait(&barrier);
    run_instances(thread * N_EACH, together[thread]);
    return NULL;
}

int main(void) {
    pthread_t threads[N_THREADS];
    State alone[N_EACH];
    pthread_barrier_init(&barrier, NULL, N_THREADS);
    for (size_t i = 0; i < N_THREADS; ++i) CHECK(pthread_create(&threads[i], NULL, run_thread, (void *)i) == 0);
    for (size_t i = 0; i < N_THREADS; ++i) CHECK(pthread_join(threads[i], NULL) == 0);
    for (size_t i = 0; i < N_THREADS; ++i) {
        run_instances(i * N_EACH, alone);
        CHECK(memcmp(alone, together[i], sizeof alone) == 0);
    }
    CHECK(memcmp(&together[0][0], &together[7][7], sizeof alone[0]) != 0); /* inputs differed */
    return 0;
}
