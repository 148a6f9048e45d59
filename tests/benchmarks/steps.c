/* Steps of one FMU in a loop of C, without anything else. */
#include <stdint.h>

#define EXPORT __attribute__((visibility("default")))

typedef int (*do_step)(void *component, double t, double h, int no_set_state);

/* Makes the steps first to first + n - 1 of length h; gives the status of the first one that failed, else 0. */
EXPORT int steps(do_step step, void *component, double h, int64_t first, int64_t n) {
    for (int64_t k = first; k < first + n; ++k) {
        const int status = step(component, (double)k * h, h, 1);
        if (status) return status;
    }
    return 0;
}
