/* What an instance of a container remembers: the states of all components, and where the host is. */
#ifndef CONTAINER_H
#define CONTAINER_H

/* All that a rollback restores. */
typedef struct {
    CONTAINER_SYSTEM system;
    double start_time, stop_time, time;
    double latest_end;                             /* the stop time, or the largest number */
    int32_t phase;
    int32_t stop_time_defined;
    int32_t experiment_defined;
} State;

/* The value of a variable, which lies within the state of a component. */
#define SLOT(s, reference) (((double *)(uintptr_t)&(s)->system)[model_variables[reference].place])

#endif
