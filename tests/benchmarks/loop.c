/* The Gauss-Seidel loop as a C program would have it, on the tables of the compiled loop
 * (orchestration/loop.py): same calls, same order, same records. */
#include <stddef.h>
#include <stdint.h>

typedef int32_t (*Transfer)(void *instance, const uint32_t *references, size_t n, void *values);
typedef int32_t (*DoStep)(void *instance, double t, double h, int32_t no_rollback);

typedef struct {
    Transfer function;
    const uint32_t *references;
    size_t count;
    void *values;
} Call;

typedef enum { SET_REAL, SET_INTEGER, SET_BOOLEAN, GET_REAL, GET_INTEGER, GET_BOOLEAN } Kind;

typedef struct {
    void *instance;
    DoStep do_step;
    int64_t first_real, end_real, first_discrete, end_discrete;
    Call calls[GET_BOOLEAN + 1];
} Component;

_Static_assert(sizeof(Component) == 30 * sizeof(int64_t), "a row of the table has 30 columns");

typedef struct {
    int64_t from, to;
} Pair;

typedef struct {
    const Component *components;
    int64_t n_components;
    const Pair *real_links, *discrete_links;
    double *reals;
    int32_t *discretes;
    const Pair *recorded_reals, *recorded_discretes;
    int64_t n_recorded_reals, n_recorded_discretes, n_columns;
} Plan;

#define EXPORT __attribute__((visibility("default")))

static int32_t transfer(const Component *c, Kind first, Kind last) {
    for (int kind = first; kind <= (int)last; ++kind) {
        const Call *call = &c->calls[kind];
        if (call->count == 0) continue;
        int32_t status = call->function(c->instance, call->references, call->count, call->values);
        if (status > 1) return status;
    }
    return 0;
}

/* Steps first to last - 1; returns the worst status that ended the run, or 0. */
EXPORT int32_t fmi_run(const Plan *plan, const double *times, double h, int64_t first, int64_t last,
                       double *rows) {
    double *reals = plan->reals;
    int32_t *discretes = plan->discretes;
    for (int64_t k = first; k < last; ++k) {
        for (int64_t i = 0; i < plan->n_components; ++i) {
            const Component *c = &plan->components[i];
            int32_t status;
            for (int64_t j = c->first_real; j < c->end_real; ++j)
                reals[plan->real_links[j].to] = reals[plan->real_links[j].from];
            for (int64_t j = c->first_discrete; j < c->end_discrete; ++j)
                discretes[plan->discrete_links[j].to] = discretes[plan->discrete_links[j].from];
            if ((status = transfer(c, SET_REAL, SET_BOOLEAN)) > 1) return status;
            if ((status = c->do_step(c->instance, times[k], h, 1)) > 1) return status;
            if ((status = transfer(c, GET_REAL, GET_BOOLEAN)) > 1) return status;
        }
        double *row = rows + (k + 1) * plan->n_columns;
        for (int64_t j = 0; j < plan->n_recorded_reals; ++j)
            row[plan->recorded_reals[j].to] = reals[plan->recorded_reals[j].from];
        for (int64_t j = 0; j < plan->n_recorded_discretes; ++j)
            row[plan->recorded_discretes[j].to] = discretes[plan->recorded_discretes[j].from];
    }
    return 0;
}

/* One component alone, n times, with the inputs it had in a run (n rows of them): the calls that
 * `set`, `step` and `get` ask for. */
EXPORT int32_t fmi_replay(const Component *c, const double *times, double h, int64_t n,
                          const double *inputs, int32_t set, int32_t step, int32_t get) {
    const int64_t width = (int64_t)c->calls[SET_REAL].count;
    double *target = c->calls[SET_REAL].values;
    for (int64_t k = 0; k < n; ++k) {
        int32_t status;
        for (int64_t j = 0; j < width; ++j) target[j] = inputs[k * width + j];
        if (set && (status = transfer(c, SET_REAL, SET_BOOLEAN)) > 1) return status;
        if (step && (status = c->do_step(c->instance, times[k], h, 1)) > 1) return status;
        if (get && (status = transfer(c, GET_REAL, GET_BOOLEAN)) > 1) return status;
    }
    return 0;
}
