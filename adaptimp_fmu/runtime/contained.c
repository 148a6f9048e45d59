/* The functions of a contained model (contained.h), made of the same parts as FMI's functions. */

void PREFIXED(reset)(State *s) { start_afresh(s); }

void PREFIXED(begin)(State *s, double start_time) {
    begin_at(s, start_time);
    s->phase = INITIALIZATION;
}

void PREFIXED(show)(State *s) {
    s->outputs_stale = 1;
    refresh_outputs(s);
}

int PREFIXED(finish)(State *s, Failure *failure) {
    Instance instance = {s, failure};
    return initialized(&instance);
}

int PREFIXED(step)(State *s, double t, double h, Failure *failure) {
    Instance instance = {s, failure};
#ifndef INPUTS_ARE_FINITE
    if (!inputs_valid(&instance)) return 0;
#endif
    s->time = t + h;   /* a program in which a step fails does not go on */
    return calibrated(&instance) && advance(&instance, t, h);
}

void PREFIXED(changed)(State *s) { note_change(s, 1); }

const char *PREFIXED(fault)(const State *s) { return position_fault(s); }
