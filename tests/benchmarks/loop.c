/* The loop of the fixed-step algorithms as a C program would have it, on the operations of the compiled
 * loop (orchestration/master/kernel/step_program.py): same calls, same order, same records. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

_Static_assert(sizeof(Component) == 30 * sizeof(int64_t), "a row of the table begins with 30 columns");

enum { TRANSFER, STEP, COPY_REALS, COPY_DISCRETES };

typedef struct {
    int64_t kind;
    union {
        Transfer transfer;
        DoStep do_step;
    } function;
    void *instance;
    union {
        const uint32_t *references;
        int64_t from;
    } first;
    int64_t count;
    union {
        void *values;
        int64_t to;
    } place;
    int64_t subject, call;
} Operation;

_Static_assert(sizeof(Operation) == 8 * sizeof(int64_t), "a row of the operations has 8 columns");

typedef struct {
    int64_t from, to;
} Pair;

typedef struct {
    int64_t from, to, n;
} Run;

typedef struct {
    const Operation *operations;
    int64_t n_operations;
    double *reals;
    int32_t *discretes;
    const Run *recorded_reals;
    const Pair *recorded_discretes;
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

static void copy(const Plan *plan, const Operation *o) {
    for (int64_t i = 0; i < o->count; ++i) {
        if (o->kind == COPY_REALS)
            plan->reals[o->place.to + i] = plan->reals[o->first.from + i];
        else
            plan->discretes[o->place.to + i] = plan->discretes[o->first.from + i];
    }
}

static int32_t operate(const Plan *plan, const Operation *o, double t, double h) {
    if (o->kind == TRANSFER)
        return o->function.transfer(o->instance, o->first.references, (size_t)o->count, o->place.values);
    if (o->kind == STEP) return o->function.do_step(o->instance, t, h, 1);
    copy(plan, o);
    return 0;
}

static void record(const Plan *plan, double *row) {
    for (int64_t j = 0; j < plan->n_recorded_reals; ++j) {
        const Run *run = &plan->recorded_reals[j];
        memcpy(row + run->to, plan->reals + run->from, (size_t)run->n * sizeof *row);
    }
    for (int64_t j = 0; j < plan->n_recorded_discretes; ++j)
        row[plan->recorded_discretes[j].to] = plan->discretes[plan->recorded_discretes[j].from];
}

/* Steps first to last - 1; a row, one behind the other, after each step k for which k + 1 is a
 * multiple of `every`. Returns the worst status that ended the run, or 0. */
EXPORT int32_t fmi_run(const Plan *plan, const double *times, double h, int64_t first, int64_t last,
                       double *rows, int64_t every) {
    int64_t until_record = every - first % every;
    for (int64_t k = first; k < last; ++k) {
        const double t = times[k];
        for (int64_t j = 0; j < plan->n_operations; ++j) {
            const int32_t status = operate(plan, &plan->operations[j], t, h);
            if (status > 1) return status;
        }
        if (--until_record == 0) {
            record(plan, rows);
            rows += plan->n_columns;
            until_record = every;
        }
    }
    return 0;
}

/* What a step does besides its calls, n times: the copies between buffers, the records. */
EXPORT void fmi_copies(const Plan *plan, int64_t n, double *rows, int32_t links, int32_t records) {
    for (int64_t k = 0; k < n; ++k) {
        for (int64_t j = 0; links && j < plan->n_operations; ++j)
            if (plan->operations[j].kind > STEP) copy(plan, &plan->operations[j]);
        if (records) record(plan, rows + k * plan->n_columns);
    }
}

/* One component alone, n times, with the Real and Boolean inputs it had in a run (n rows of each):
 * the calls that `set`, `step` and `get` ask for. */
EXPORT int32_t fmi_replay(const Component *c, const double *times, double h, int64_t n,
                          const double *reals, const int32_t *booleans, int32_t set, int32_t step,
                          int32_t get) {
    const size_t n_reals = c->calls[SET_REAL].count, n_booleans = c->calls[SET_BOOLEAN].count;
    double *real_inputs = c->calls[SET_REAL].values;
    int32_t *boolean_inputs = c->calls[SET_BOOLEAN].values;
    for (int64_t k = 0; k < n; ++k) {
        int32_t status;
        for (size_t j = 0; j < n_reals; ++j) real_inputs[j] = *reals++;
        for (size_t j = 0; j < n_booleans; ++j) boolean_inputs[j] = *booleans++;
        if (set && (status = transfer(c, SET_REAL, SET_BOOLEAN)) > 1) return status;
        if (step && (status = c->do_step(c->instance, times[k], h, 1)) > 1) return status;
        if (get && (status = transfer(c, GET_REAL, GET_BOOLEAN)) > 1) return status;
    }
    return 0;
}
